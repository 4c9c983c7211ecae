//! Units, axes and the origin are conventions: a problem in others has the same trajectory.
//!
//! Powers of two scale every number of a step exactly, and no bit changes: there is no constant with a unit in it.

use evi_core::baseline::Rattle;
use evi_core::prelude::*;
use evi_examples::{DoublePendulum, StiffSpringPendulum};
use evi_tests::largest_difference;

mod axes;
mod company;

const STEPS: u32 = 200;
/// Step size in seconds.
const H: f64 = 0.02;
/// A frequency in 1/s that bends the curves visibly.
const OMEGA: f64 = 3.1;
/// Round-off of 200 steps in multiples of `ε` times the growth of a relative change of a parameter: 28 measured.
const ROUND_OFF: f64 = 64.0;

/// Units of length, mass and time, as multiples of metre, kilogram and second; the numbers of a problem are divided by them.
#[derive(Clone, Copy, Debug)]
struct Units {
    length: f64,
    mass: f64,
    time: f64,
    /// Gravitational acceleration in SI units.
    g: f64,
}

impl Units {
    const fn new(length: f64, mass: f64, time: f64) -> Self {
        Self { length, mass, time, g: 9.81 }
    }

    const SI: Self = Self::new(1.0, 1.0, 1.0);

    fn gravity(&self) -> f64 {
        self.g / self.length * self.time * self.time
    }

    fn velocity(&self, v: f64) -> f64 {
        v / self.length * self.time
    }

    /// `(q, v)` in SI units after a run that starts at `q`, `v` in SI units.
    fn end<S, F, const N: usize>(&self, system: S, scheme: F, q: [f64; N], v: [f64; N]) -> Vec<f64>
    where
        S: MechanicalSystem<PerCoordinate<f64> = [f64; N]>,
        F: Scheme<S>,
    {
        let (q, v) = (q.map(|q| q / self.length), v.map(|v| self.velocity(v)));
        let mut run = Simulation::new(system, scheme).start(q, v).expect("a start");
        for _ in 0..STEPS {
            run.advance().expect("a step");
        }
        let state = run.state();
        [state.q().map(|q| q * self.length), state.v().map(|v| v * self.length / self.time)].concat()
    }
}

/// What the end of a run makes of a relative change of gravity, which it is given.
fn growth(end: impl Fn(f64) -> Vec<f64>) -> f64 {
    const CHANGE: f64 = 1e-8;
    let growth = largest_difference(&end(9.81 * (1.0 + CHANGE)), &end(9.81)) / CHANGE;
    assert!(growth > 1.0, "vacuous: gravity does nothing");
    growth
}

#[track_caller]
fn check(end: impl Fn(Units) -> Vec<f64>) {
    let si = end(Units::SI);
    for (length, mass, time) in
        [(6, 0, 0), (-5, 0, 0), (0, 19, 0), (0, -20, 0), (0, 0, 3), (0, 0, -7), (-13, 11, 5), (9, -3, -1)]
    {
        let units = Units::new(2.0_f64.powi(length), 2.0_f64.powi(mass), 2.0_f64.powi(time));
        assert_eq!(end(units), si, "{units:?}");
    }
    let growth = growth(|g| end(Units { g, ..Units::SI }));
    for (length, mass, time) in [
        (1e-6, 1.0, 1.0),
        (1e6, 1.0, 1.0),
        (1.0, 1e-6, 1.0),
        (1.0, 1e6, 1.0),
        (1.0, 1.0, 1e-6),
        (1.0, 1.0, 1e6),
        (1e3, 1e-6, 7e-2),
        (0.3048, 0.4536, 60.0),
    ] {
        let units = Units::new(length, mass, time);
        let difference = largest_difference(&end(units), &si) / (f64::EPSILON * growth);
        println!("{}: {difference:.2} ε × growth {growth:.1}", core::panic::Location::caller());
        assert!(difference <= ROUND_OFF, "{difference:.1} ε × growth in {units:?}");
    }
}

fn double_pendulum<F: Scheme<DoublePendulum>>(units: Units, scheme: F) -> Vec<f64> {
    let [l1, l2] = [0.9, 1.1].map(|l| l / units.length);
    let [m1, m2] = [1.3, 0.7].map(|m| m / units.mass);
    let start = DoublePendulum { m1: 1.3, m2: 0.7, l1: 0.9, l2: 1.1, g: 9.81 }.at_angles(0.5, -0.2);
    units.end(DoublePendulum { m1, m2, l1, l2, g: units.gravity() }, scheme, start.q, start.v)
}

fn stiff_spring<F: Scheme<StiffSpringPendulum>>(units: Units, scheme: F) -> Vec<f64> {
    let k = 300.0 / units.mass * units.time * units.time;
    let system = StiffSpringPendulum { m: 1.3 / units.mass, l: 0.9 / units.length, k, g: units.gravity() };
    units.end(system, scheme, [0.9, 0.1], [0.2, -0.5])
}

#[test]
fn of_units_with_constraints() {
    check(|units| double_pendulum(units, Evi::midpoint(H / units.time)));
    check(|units| double_pendulum(units, Evi::midpoint(H / units.time).frequency(OMEGA * units.time)));
    check(|units| double_pendulum(units, Evi::simpson(H / units.time).frequency(OMEGA * units.time)));
}

/// Masses whose products are no numbers: `G M⁻¹ Gᵀ` is, its determinant is not.
#[track_caller]
fn check_extreme_masses(end: impl Fn(Units) -> Vec<f64>) {
    let si = end(Units::SI);
    let growth = growth(|g| end(Units { g, ..Units::SI }));
    for mass in [1e-300, 1e-200, 1e-157, 1e-80, 1e80, 1e157, 1e200, 1e300] {
        let units = Units::new(1.0, mass, 1.0);
        let difference = largest_difference(&end(units), &si) / (f64::EPSILON * growth);
        println!("{}: {mass:e} kg: {difference:.2} ε × growth", core::panic::Location::caller());
        assert!(difference <= ROUND_OFF, "{difference:.1} ε × growth in units of {mass:e} kg");
    }
}

#[test]
fn of_masses_whose_products_are_no_numbers() {
    check_extreme_masses(|units| double_pendulum(units, Evi::midpoint(H)));
    check_extreme_masses(|units| double_pendulum(units, Evi::simpson(H).frequency(OMEGA)));
    check_extreme_masses(|units| double_pendulum(units, Galerkin::<2>::new(H)));
    check_extreme_masses(|units| double_pendulum(units, Rattle::new(H)));
}

#[test]
fn of_units_without_constraints() {
    check(|units| stiff_spring(units, Evi::midpoint(H / units.time)));
    check(|units| stiff_spring(units, Evi::trapezoid(H / units.time)));
    check(|units| stiff_spring(units, Evi::simpson(H / units.time).frequency(OMEGA * units.time)));
    check(|units| stiff_spring(units, Galerkin::<2>::new(H / units.time)));
}
