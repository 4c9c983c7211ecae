//! Rotations and translations.

use evi_core::prelude::*;
use evi_tests::largest_difference;

use super::{H, OMEGA, ROUND_OFF, STEPS, growth};

/// A bob on a rod at a pivot, and a second one that hangs from the first on a spring, in space; gravity is a vector.
#[derive(MechanicalSystem, Clone, Copy, Debug)]
#[evi(
    coordinates(x1, y1, z1, x2, y2, z2),
    let stretch = ((x2 - x1).powi(2) + (y2 - y1).powi(2) + (z2 - z1).powi(2)).sqrt() - l2,
    kinetic = 0.5 * m1 * (der(x1).powi(2) + der(y1).powi(2) + der(z1).powi(2))
            + 0.5 * m2 * (der(x2).powi(2) + der(y2).powi(2) + der(z2).powi(2)),
    potential = 0.5 * k * stretch.powi(2)
              - gx * (m1 * x1 + m2 * x2) - gy * (m1 * y1 + m2 * y2) - gz * (m1 * z1 + m2 * z2),
    constraint(rod: (x1 - px).powi(2) + (y1 - py).powi(2) + (z1 - pz).powi(2) == l1.powi(2)),
)]
struct HangingPair {
    m1: f64,
    m2: f64,
    l1: f64,
    l2: f64,
    k: f64,
    gx: f64,
    gy: f64,
    gz: f64,
    px: f64,
    py: f64,
    pz: f64,
}

type Vector = [f64; 3];

/// A rotation, by the images of the axes, then a translation.
#[derive(Clone, Copy, Debug)]
struct Axes {
    images: [Vector; 3],
    shift: Vector,
}

impl Axes {
    const SAME: Self = Self { images: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], shift: [0.0; 3] };

    const fn shifted(shift: Vector) -> Self {
        Self { shift, ..Self::SAME }
    }

    /// By `angle` about an axis of unit length (Rodrigues).
    fn turned(axis: Vector, angle: f64) -> Self {
        let (sine, cosine) = angle.sin_cos();
        let images = core::array::from_fn(|i| {
            let mut e = [0.0; 3];
            e[i] = 1.0;
            let [a, b, c] = axis;
            let cross = [b * e[2] - c * e[1], c * e[0] - a * e[2], a * e[1] - b * e[0]];
            core::array::from_fn(|j| cosine * e[j] + sine * cross[j] + (1.0 - cosine) * axis[i] * axis[j])
        });
        Self { images, shift: [0.0; 3] }
    }

    fn vector(&self, x: Vector) -> Vector {
        core::array::from_fn(|j| (0..3).map(|i| self.images[i][j] * x[i]).sum())
    }

    fn point(&self, x: Vector) -> Vector {
        let turned = self.vector(x);
        core::array::from_fn(|j| turned[j] + self.shift[j])
    }

    fn point_back(&self, x: Vector) -> Vector {
        self.vector_back(core::array::from_fn(|j| x[j] - self.shift[j]))
    }

    fn vector_back(&self, x: Vector) -> Vector {
        core::array::from_fn(|i| (0..3).map(|j| self.images[i][j] * x[j]).sum())
    }
}

/// Both halves of six numbers through `map`.
fn halves(map: impl Fn(Vector) -> Vector, [a, b, c, d, e, f]: [f64; 6]) -> [f64; 6] {
    let ([a, b, c], [d, e, f]) = (map([a, b, c]), map([d, e, f]));
    [a, b, c, d, e, f]
}

/// The end of a run in other axes, brought back.
fn end<F: Scheme<HangingPair>>(axes: Axes, scheme: F, gravity: f64) -> Vec<f64> {
    let [gx, gy, gz] = axes.vector([0.0, 0.0, -gravity]);
    let [px, py, pz] = axes.point([0.2, -0.1, 0.3]);
    let system = HangingPair { m1: 1.3, m2: 0.7, l1: 0.9, l2: 1.1, k: 60.0, gx, gy, gz, px, py, pz };
    let q = halves(|x| axes.point(x), [0.74, 0.62, 0.3, 0.8, 0.5, -0.8]);
    // Across the rod (0.54, 0.72, 0).
    let v = halves(|x| axes.vector(x), [-0.4, 0.3, 0.5, 0.3, 0.6, -0.2]);
    let mut run = Simulation::new(system, scheme).start(q, v).expect("a start");
    for _ in 0..STEPS {
        run.advance().expect("a step");
    }
    let state = run.state();
    [halves(|x| axes.point_back(x), *state.q()), halves(|x| axes.vector_back(x), *state.v())].concat()
}

/// Distance from the run in the axes of before, in multiples of `ε` times the growth of a relative change of gravity.
#[track_caller]
fn difference<F: Scheme<HangingPair> + Copy>(scheme: F, axes: Axes) -> f64 {
    let growth = growth(|gravity| end(Axes::SAME, scheme, gravity));
    let distance = largest_difference(&end(axes, scheme, 9.81), &end(Axes::SAME, scheme, 9.81));
    let difference = distance / (f64::EPSILON * growth);
    println!("{}: {difference:.2} ε × growth {growth:.1}", core::panic::Location::caller());
    difference
}

#[track_caller]
fn check_turned<F: Scheme<HangingPair> + Copy>(scheme: F) {
    for axes in [
        Axes::turned([0.0, 0.0, 1.0], 0.7),
        Axes::turned([1.0, 0.0, 0.0], core::f64::consts::FRAC_PI_2),
        Axes::turned([0.48, -0.6, 0.64], 2.1),
    ] {
        let difference = difference(scheme, axes);
        assert!(difference <= ROUND_OFF, "{difference:.1} ε × growth in {axes:?}");
    }
}

/// One frequency for all axes commutes with rotations.
#[test]
fn turned_about_any_axis() {
    check_turned(Evi::midpoint(H));
    check_turned(Evi::trapezoid(H));
    check_turned(Evi::midpoint(H).frequency(OMEGA));
    check_turned(Evi::simpson(H).frequency(OMEGA));
    check_turned(Galerkin::<2>::new(H).frequency(OMEGA));
}

/// A shift rounds positions of its own size.
#[track_caller]
fn check_shifted<F: Scheme<HangingPair> + Copy>(scheme: F) {
    for (shift, size) in [([1.0, -2.0, 0.5], 3.0), ([30.0, 50.0, -20.0], 50.0)] {
        let difference = difference(scheme, Axes::shifted(shift));
        println!("{:.2} of {size}", difference / size);
        assert!(difference <= ROUND_OFF * size, "{difference:.1} ε × growth by {shift:?}");
    }
}

/// Straight curves contain the constants, and so do the curves of a Galerkin step; the midpoint does not see that its curve
/// bends.
#[test]
fn shifted() {
    check_shifted(Evi::midpoint(H));
    check_shifted(Evi::simpson(H));
    check_shifted(Evi::midpoint(H).frequency(OMEGA));
    check_shifted(Galerkin::<2>::new(H).frequency(OMEGA));
}

/// The control: on more nodes the curves of a frequency swing about the origin.
#[test]
fn a_frequency_on_more_nodes_has_an_origin() {
    let difference = difference(Evi::simpson(H).frequency(OMEGA), Axes::shifted([1.0, -2.0, 0.5]));
    assert!(difference > 1e6, "{difference:.1} ε × growth only");
}
