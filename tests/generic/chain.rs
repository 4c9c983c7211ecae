//! A chain whose number of links no type knows.

use super::*;

/// A plane chain of point masses on massless rods, y upwards; as many as `links` has entries.
#[derive(Clone)]
pub(super) struct Chain {
    /// Mass and length of each link.
    pub(super) links: Vec<(f64, f64)>,
    pub(super) g: f64,
}

impl Chain {
    pub(super) fn alternating(n_links: usize) -> Self {
        Self {
            links: (0..n_links).map(|i| if i % 2 == 0 { (1.0, 0.5) } else { (0.3, 0.8) }).collect(),
            g: 9.81,
        }
    }

    /// At rest, every link at `angle` from the downward vertical.
    pub(super) fn at_angle(&self, angle: f64) -> Vec<f64> {
        let mut end = (0.0, 0.0);
        let mut q = vec![];
        for (_, length) in &self.links {
            end = (end.0 + length * angle.sin(), end.1 - length * angle.cos());
            q.extend([end.0, end.1]);
        }
        q
    }

    pub(super) fn run(&self, scheme: &GenericEvi) -> GenericRun<Self> {
        let q = self.at_angle(0.4);
        scheme.start(self.clone(), &q, &vec![0.0; q.len()]).expect("the start is consistent")
    }
}

impl GenericSystem for Chain {
    fn n_coordinates(&self) -> usize {
        2 * self.links.len()
    }

    fn n_constraints(&self) -> usize {
        self.links.len()
    }

    fn lagrangian<T: Scalar>(&self, _t: T, q: &[T], v: &[T]) -> T {
        let mut lagrangian = T::from_f64(0.0);
        for (i, &(mass, _)) in self.links.iter().enumerate() {
            let kinetic = T::from_f64(0.5 * mass) * (v[2 * i].powi(2) + v[2 * i + 1].powi(2));
            lagrangian = lagrangian + kinetic - T::from_f64(mass * self.g) * q[2 * i + 1];
        }
        lagrangian
    }

    fn constraints<T: Scalar>(&self, _t: T, q: &[T], residuals: &mut [T]) {
        let mut start = [T::from_f64(0.0); 2];
        for (i, &(_, length)) in self.links.iter().enumerate() {
            let end = [q[2 * i], q[2 * i + 1]];
            let (dx, dy) = (end[0] - start[0], end[1] - start[1]);
            residuals[i] = dx.powi(2) + dy.powi(2) - T::from_f64(length * length);
            start = end;
        }
    }
}
