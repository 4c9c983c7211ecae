//! What a gradient costs: instructions beside those of a run, counted by valgrind's callgrind, and states that are kept.

use std::process::Command;

use evi_core::prelude::*;
use evi_core::sensitivity::{Course, Differentiable, ParameterChoice, StateGradient};
use evi_tests::scenes::{DoublePendulumInAngles, MotorisedDoublePendulum};

/// The first coordinate of all states, added up.
fn first_coordinate<S: MechanicalSystem>(_: u64, state: &State<S>, gradient: &mut StateGradient<S>) -> f64 {
    gradient.q[0] += 1.0;
    state.q()[0]
}

/// The states that a gradient keeps of so many steps, and the steps that it takes.
fn kept(steps: u64) -> (usize, u64) {
    let angles = DoublePendulumInAngles::UNEQUAL;
    let start = angles.cartesian([0.9, -0.4], [1.1, 2.3]);
    let simulation = Simulation::new(angles.constrained(), Evi::midpoint(0.01));
    let gradient =
        simulation.gradient_of(&Course::new(start.q, start.v, steps), &first_coordinate).expect("a gradient");
    (gradient.states_kept, gradient.steps_taken)
}

#[test]
fn the_states_kept_grow_with_the_root_of_the_steps() {
    for steps in [0, 1, 2, 3, 10, 99, 100, 101, 1_000, 10_000] {
        let (kept, taken) = kept(steps);
        let root = (steps as f64).sqrt();
        assert!(kept as f64 <= 2.0 * root + 2.0, "{kept} states of {steps} steps");
        assert!(steps <= taken && taken <= 2 * steps, "{taken} steps for {steps}");
    }
    assert!(kept(10_000).0 > 100, "vacuous: something is kept");
}

/// A run without and with its gradient.
#[derive(Clone, Copy)]
struct Counted {
    name: &'static str,
    run: fn(u64) -> f64,
    gradient: fn(u64) -> f64,
    /// Runs that the gradient costs at most.
    most: f64,
}

const COUNTED: [Counted; 3] = [
    Counted {
        name: "double pendulum with constraints, by five parameters",
        run: |steps| counted_run(&constrained(), steps),
        gradient: |steps| counted_gradient(&constrained(), steps),
        most: 5.0,
    },
    Counted {
        name: "motorised double pendulum, by nine parameters",
        run: |steps| counted_run(&motorised(), steps),
        gradient: |steps| counted_gradient(&motorised(), steps),
        most: 5.0,
    },
    Counted {
        name: "double pendulum with constraints, Galerkin steps, by five parameters",
        run: |steps| counted_run(&by_passes(), steps),
        gradient: |steps| counted_gradient(&by_passes(), steps),
        most: 5.0,
    },
];

type Prepared<S, F, const N: usize> = (Simulation<S, F>, [f64; N], [f64; N]);

fn constrained() -> Prepared<evi_examples::DoublePendulum, Evi<1>, 4> {
    let angles = DoublePendulumInAngles::UNEQUAL;
    let start = angles.cartesian([0.9, -0.4], [1.1, 2.3]);
    (Simulation::new(angles.constrained(), Evi::midpoint(0.05)), start.q, start.v)
}

fn by_passes() -> Prepared<evi_examples::DoublePendulum, Galerkin<3>, 4> {
    let (_, q, v) = constrained();
    (Simulation::new(DoublePendulumInAngles::UNEQUAL.constrained(), Galerkin::<3>::new(0.05)), q, v)
}

fn motorised() -> Prepared<MotorisedDoublePendulum, Evi<3>, 2> {
    let start = DoublePendulumInAngles::MODERATE;
    (Simulation::new(MotorisedDoublePendulum::STANDARD, Evi::simpson(0.05)), start.q, start.v)
}

#[inline(never)]
fn counted_run<S, F, const N: usize>((simulation, q, v): &Prepared<S, F, N>, steps: u64) -> f64
where
    S: MechanicalSystem<PerCoordinate<f64> = [f64; N]>,
    F: Scheme<S, Step: Differentiable<S>>,
{
    simulation.cost_of(&Course::new(*q, *v, steps), &first_coordinate).expect("a run")
}

#[inline(never)]
fn counted_gradient<S, F, const N: usize>((simulation, q, v): &Prepared<S, F, N>, steps: u64) -> f64
where
    S: MechanicalSystem<PerCoordinate<f64> = [f64; N]>,
    F: Scheme<S, Step: Differentiable<S>>,
{
    let course = Course::new(*q, *v, steps).by_parameters(ParameterChoice::all::<S>());
    simulation.gradient_of(&course, &first_coordinate).expect("a gradient").start.parameters[0]
}

/// Enough of them that preparations do not count.
const STEPS: u64 = 2_000;
/// Tells the program under valgrind which case to take, and whether with its gradient.
const CASE: &str = "EVI_COUNTED_GRADIENT";

#[test]
#[ignore = "takes the steps that the other test counts"]
fn steps_to_count() {
    let Ok(case) = std::env::var(CASE) else { return };
    let numbers: Vec<u64> = case.split(' ').map(|number| number.parse().expect("a number")).collect();
    let counted = COUNTED[numbers[0] as usize];
    let take = if numbers[1] == 0 { counted.run } else { counted.gradient };
    println!("{}", take(STEPS));
}

/// Instructions of a run, or of its gradient; `None` where valgrind does not run.
fn instructions(case: usize, with_gradient: bool) -> Option<u64> {
    let output = Command::new("valgrind")
        .args(["--tool=callgrind", "--callgrind-out-file=/dev/null", "--toggle-collect=*counted_*"])
        .arg(std::env::current_exe().ok()?)
        .args(["--exact", "steps_to_count", "--ignored", "--test-threads=1"])
        .env(CASE, format!("{case} {}", u64::from(with_gradient)))
        .output()
        .ok()?;
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let report = String::from_utf8(output.stderr).ok()?;
    let line = report.lines().find(|line| line.contains("Collected"))?;
    line.split_whitespace().last()?.parse().ok()
}

#[test]
fn a_gradient_costs_a_few_runs() {
    for (case, counted) in COUNTED.iter().enumerate() {
        let (Some(run), Some(gradient)) = (instructions(case, false), instructions(case, true)) else {
            println!("skipped: valgrind does not run here");
            return;
        };
        assert!(run > 100 * STEPS, "vacuous: {run} instructions are counted");
        let ratio = gradient as f64 / run as f64;
        println!("{}: {ratio:.2} runs", counted.name);
        assert!(ratio <= counted.most, "{}: a gradient costs {ratio:.2} runs", counted.name);
    }
}
