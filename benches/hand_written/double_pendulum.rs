//! The double pendulum's RATTLE step (= the midpoint member at `u = 0`) as an expert would write it for this scene alone:
//! two multipliers, extrapolated from the previous steps, one inverse per step, chord iterations to round-off.

use evi_examples::{DoublePendulum, Start};

/// The run: positions, velocities, and what is constant or remembered.
pub(crate) struct HandWritten {
    q: [f64; 4],
    v: [f64; 4],
    /// `2 h² / m` of the two bobs: displacement per multiplier and unit of the rod vector.
    reach: [f64; 2],
    inverse_mass: [f64; 2],
    squared_length: [f64; 2],
    h: f64,
    /// Displacement and velocity change by gravity in half a step.
    fall: f64,
    kick: f64,
    /// Multipliers of the last three steps, newest first.
    previous: [[f64; 2]; 3],
    tolerance: f64,
}

impl HandWritten {
    /// A run from rest.
    pub(crate) fn new(system: &DoublePendulum, start: Start<4>, h: f64) -> Self {
        Self {
            q: start.q,
            v: start.v,
            reach: [2.0 * h * h / system.m1, 2.0 * h * h / system.m2],
            inverse_mass: [1.0 / system.m1, 1.0 / system.m2],
            squared_length: [system.l1 * system.l1, system.l2 * system.l2],
            h,
            fall: 0.5 * h * h * system.g,
            kick: 0.5 * h * system.g,
            previous: [[0.0; 2]; 3],
            tolerance: 0.25 * f64::EPSILON * (system.l1 + system.l2).powi(2),
        }
    }

    /// Positions.
    pub(crate) fn q(&self) -> &[f64; 4] {
        &self.q
    }

    /// One step; `false` if the multipliers did not converge.
    #[inline]
    pub(crate) fn advance(&mut self) -> bool {
        let [x1, y1, x2, y2] = self.q;
        let (dx, dy) = (x2 - x1, y2 - y1);
        let (a1, a2) = (self.reach[0], self.reach[1]);
        let free = [
            x1 + self.h * self.v[0],
            y1 + self.h * self.v[1] - self.fall,
            x2 + self.h * self.v[2],
            y2 + self.h * self.v[3] - self.fall,
        ];
        let [p0, p1, p2] = self.previous;
        let mut l = [3.0 * (p0[0] - p1[0]) + p2[0], 3.0 * (p0[1] - p1[1]) + p2[1]];
        let mut inverse = [0.0; 4];
        let mut previous_size = 0.0;
        let mut iteration = 0;
        let (q, ex, ey) = loop {
            let q = [
                free[0] - a1 * (l[0] * x1 - l[1] * dx),
                free[1] - a1 * (l[0] * y1 - l[1] * dy),
                free[2] - a2 * l[1] * dx,
                free[3] - a2 * l[1] * dy,
            ];
            let (ex, ey) = (q[2] - q[0], q[3] - q[1]);
            let f1 = q[0] * q[0] + q[1] * q[1] - self.squared_length[0];
            let f2 = ex * ex + ey * ey - self.squared_length[1];
            let size = f1.abs().max(f2.abs());
            if iteration == 0 {
                let j11 = 2.0 * a1 * (q[0] * x1 + q[1] * y1);
                let j12 = -2.0 * a1 * (q[0] * dx + q[1] * dy);
                let j21 = -2.0 * a1 * (ex * x1 + ey * y1);
                let j22 = 2.0 * (a1 + a2) * (ex * dx + ey * dy);
                let r = 1.0 / (j11 * j22 - j12 * j21);
                inverse = [j22 * r, -j12 * r, -j21 * r, j11 * r];
            }
            // The correction after this one would be below round-off.
            let last = size <= self.tolerance || size * size <= self.tolerance * previous_size;
            l[0] += inverse[0] * f1 + inverse[1] * f2;
            l[1] += inverse[2] * f1 + inverse[3] * f2;
            if last {
                let q = [
                    free[0] - a1 * (l[0] * x1 - l[1] * dx),
                    free[1] - a1 * (l[0] * y1 - l[1] * dy),
                    free[2] - a2 * l[1] * dx,
                    free[3] - a2 * l[1] * dy,
                ];
                break (q, q[2] - q[0], q[3] - q[1]);
            }
            previous_size = size;
            iteration += 1;
            if iteration > 20 {
                return false;
            }
        };
        let inverse_h = 1.0 / self.h;
        let mut v = [
            (q[0] - x1) * inverse_h,
            (q[1] - y1) * inverse_h - self.kick,
            (q[2] - x2) * inverse_h,
            (q[3] - y2) * inverse_h - self.kick,
        ];
        let (i1, i2) = (self.inverse_mass[0], self.inverse_mass[1]);
        let g1 = q[0] * v[0] + q[1] * v[1];
        let g2 = ex * (v[2] - v[0]) + ey * (v[3] - v[1]);
        let s11 = i1 * (q[0] * q[0] + q[1] * q[1]);
        let s12 = -i1 * (q[0] * ex + q[1] * ey);
        let s22 = (i1 + i2) * (ex * ex + ey * ey);
        let r = 1.0 / (s11 * s22 - s12 * s12);
        let n1 = (s22 * g1 - s12 * g2) * r;
        let n2 = (s11 * g2 - s12 * g1) * r;
        v[0] -= i1 * (n1 * q[0] - n2 * ex);
        v[1] -= i1 * (n1 * q[1] - n2 * ey);
        v[2] -= i2 * n2 * ex;
        v[3] -= i2 * n2 * ey;
        self.q = q;
        self.v = v;
        self.previous = [l, p0, p1];
        true
    }
}
