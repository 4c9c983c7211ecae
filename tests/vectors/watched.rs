//! Inputs, observed quantities and reports of scenes whose sums stay loops.

use evi_core::assembled::{AssembledSimulation, AssembledSystem, StateWriter};
use evi_core::prelude::*;
use evi_tests::largest_difference;

const BODIES: usize = 4;

/// A chain that hangs from a slider; one input pushes the slider, another all bodies, each by its index.
macro_rules! pushed {
    ($name:ident, $n:tt) => {
        #[derive(MechanicalSystem, Clone, Debug)]
        #[evi(
            coordinates(x, p: [$n, 2]),
            kinetic = 0.5 * slider * der(x).powi(2) + sum(0..$n, |i| 0.5 * m[i] * der(p[i]).norm_squared()),
            potential = sum(0..$n, |i| m[i] * g * p[i][1]),
            constraint(first: (p[0] - [x, 0.0]).norm_squared() == l.powi(2)),
            constraint(link[i in 1..$n]: (p[i] - p[i - 1]).norm_squared() == l.powi(2)),
            input(push, wind),
            force(x: push),
            force(p[i in 0..$n][0]: wind * (i + 1)),
            observe(height: sum(0..$n, |i| m[i] * p[i][1]) / sum_of_masses),
            observe(power: push * der(x) + wind * sum(0..$n, |i| (i + 1) * der(p[i][0]))),
            observe(tip: p[$n - 1][0] - x),
        )]
        struct $name {
            slider: f64,
            m: [f64; $n],
            sum_of_masses: f64,
            g: f64,
            l: f64,
        }

        impl $name {
            fn unequal() -> Self {
                let m = std::array::from_fn(|i| 0.3 + 0.1 * i as f64);
                Self { slider: 0.8, m, sum_of_masses: m.iter().sum(), g: 9.81, l: 0.25 }
            }
        }
    };
}

pushed!(Unrolled, 4);
pushed!(Looped, BODIES);

fn hanging_askew() -> [f64; 9] {
    let mut q = [0.1; 9];
    for i in 0..BODIES {
        let share = 0.25 * (i + 1) as f64;
        (q[1 + 2 * i], q[2 + 2 * i]) = (0.1 + 0.6 * share, -0.8 * share);
    }
    q
}

/// The same inputs at the same times move both scenes alike, and both observe the same.
#[track_caller]
fn check<F>(scheme: F)
where
    F: Scheme<Unrolled> + evi_core::assembled::AssembledScheme + Clone,
{
    let q = hanging_askew();
    let mut one = Simulation::new(Unrolled::unequal(), scheme.clone()).start(q, [0.0; 9]).expect("a start");
    let mut other = AssembledSimulation::new(Looped::unequal(), scheme).start(q, [0.0; 9]).expect("a start");
    let mut unpushed = None;
    for (number, inputs) in [[0.0, 0.0], [2.0, -0.1], [-3.0, 0.4]].into_iter().enumerate() {
        one.set_inputs(inputs);
        other.set_inputs(&inputs);
        for _ in 0..8 {
            one.advance().expect("a step");
            other.advance().expect("a step");
        }
        let difference = largest_difference(one.state().q(), other.state().q())
            .max(largest_difference(one.state().v(), other.state().v()))
            .max(largest_difference(&one.observe(), &other.observe()));
        println!("{number}: {difference:e}, {:?}", other.observe());
        // 1.1e-14 measured, of a power of 6 after 24 steps of five stages.
        assert!(difference < 1.5e-14, "{difference:e}");
        unpushed = unpushed.or_else(|| Some(other.state().q().to_vec()));
    }
    let moved = largest_difference(&unpushed.expect("three rounds"), other.state().q());
    assert!(moved > 0.05 && other.observe()[1].abs() > 0.1, "the inputs act: {moved}");
}

#[test]
fn inputs_act_and_quantities_are_observed_as_in_the_unrolled_scene() {
    assert_eq!((Looped::INPUTS, Looped::OBSERVABLES), (Unrolled::INPUTS, Unrolled::OBSERVABLES));
    check(Evi::midpoint(0.01));
    check(Evi::simpson(0.01));
    check(Evi::trapezoid(0.01).composed(Composition::suzuki_4()));
    check(Galerkin::<3>::new(0.02));
}

#[test]
fn observed_quantities_are_written_beside_the_energy() {
    let simulation = AssembledSimulation::new(Looped::unequal(), Evi::midpoint(0.01));
    let run = simulation.start(hanging_askew(), [0.0; 9]).expect("a start");
    let mut rows = Vec::new();
    let mut writer = StateWriter::of(&run, &mut rows, [0]).expect("it has that coordinate");
    writer.write(&run).expect("memory");
    let rows = String::from_utf8(rows).expect("text");
    let mut lines = rows.lines();
    assert_eq!(lines.next(), Some("t,energy,height,power,tip,x,der(x)"));
    let row: Vec<f64> =
        lines.next().expect("a row").split(',').map(|x| x.parse().expect("a number")).collect();
    assert_eq!(row[2..5], run.observe());
}

#[test]
fn a_report_has_equations_families_and_what_a_run_solves() {
    let report = Looped::REPORT.to_string();
    println!("{report}");
    for text in [
        "coordinates  x, p[BODIES, 2]",
        "inputs       push, wind",
        "observed     height, power, tip",
        "For i in 0..BODIES",
        "For i in 1..BODIES",
        "One element",
        "coordinates  p[i − 1, 0], p[i − 1, 1], p[i, 0], p[i, 1]",
        "link",
    ] {
        assert!(report.contains(text), "{text}");
    }
    let simulation = AssembledSimulation::new(Looped::unequal(), Evi::midpoint(0.01));
    let run = simulation.start(hanging_askew(), [0.0; 9]).expect("a start");
    let report = run.report();
    println!("{report}");
    assert!(report.has_constant_mass && (report.n_coordinates, report.n_constraints) == (9, 4));
    // A chain fills in nothing.
    assert_eq!((report.systems[0].1.unknowns, report.systems[0].1.below), (4, 3));
    assert!(report.to_string().contains("multipliers: 4 unknowns, 3 entries below the diagonal"), "{report}");
}
