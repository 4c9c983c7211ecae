//! Every standard motion, by two families of order 8 that share no step equations: it ends where the gallery says, and conserves what
//! the gallery says and nothing else.

use evi_core::prelude::*;
use evi_examples::{Reference, Scene, Visitor, visit_all};
use evi_tests::largest_difference;

/// Steps of every run: enough for order 8 to come near round-off.
const STEPS: u32 = 1600;

/// Largest distances from the end in positions and velocities, relative to the largest on the way, of the composed member and of the
/// Galerkin member: measured, rounded up to a round number. Most are round-off, with the sensitivity of the motion; the error of the steps
/// is seen where they are long for the motion, on stiff springs (a third of an oscillation), the top (an eighth of a radian) and the
/// double pendulum. A Galerkin step by Newton's iteration, which compensation serves best, solves one dense system for all points, 240 unknowns for the
/// long chain, which is left out.
const BOUNDS: [(&str, f64, Option<f64>); 19] = [
    ("andrews_squeezer", 2e-15, Some(2e-15)),
    ("car_axis", 5e-14, Some(2e-15)),
    ("chain_20", 2e-15, None),
    ("chain_5", 1e-15, Some(2e-16)),
    ("double_pendulum", 1e-12, Some(5e-13)),
    ("double_pendulum_angles", 1e-13, Some(5e-13)),
    ("driven_pendulum", 2e-15, Some(5e-16)),
    ("fermi_pasta_ulam", 5e-8, Some(5e-10)),
    ("four_bar", 5e-14, Some(5e-14)),
    ("harmonic_oscillator", 5e-15, Some(5e-15)),
    ("heavy_top", 5e-10, Some(1e-12)),
    ("henon_heiles", 5e-14, Some(1e-14)),
    ("kapitza_pendulum", 5e-16, Some(5e-16)),
    ("kepler", 5e-13, Some(5e-14)),
    ("pendulum", 2e-14, Some(5e-15)),
    ("pendulum_cartesian", 5e-14, Some(2e-14)),
    ("slider_crank", 1e-15, Some(5e-16)),
    ("spherical_pendulum", 1e-14, Some(1e-14)),
    ("stiff_spring_pendulum", 5e-15, Some(1e-15)),
];

/// Largest change of the energy on the way over the largest `v·p`, where it is conserved: 1e-12 on the chain with stiff springs,
/// 1.7e-13 on the double pendulum, elsewhere at most 3e-15.
const ENERGY: f64 = 2e-12;

/// Smallest such change where the energy is not conserved: 7e-2 for the driven pendulum.
const NO_CONSERVATION: f64 = 1e-2;

/// Largest relative change of a momentum: round-off, 8 ε measured on the top.
const MOMENTUM: f64 = 16.0 * f64::EPSILON;

/// Largest magnitude; NaN if one is.
fn largest(values: &[f64]) -> f64 {
    largest_difference(values, &vec![0.0; values.len()])
}

/// The larger of two magnitudes; NaN if one is.
fn larger(a: f64, b: f64) -> f64 {
    if a <= b || b.is_nan() { b } else { a }
}

/// Runs the standard motion of `S` and compares it with what the gallery says.
fn check<S: Scene, F: Scheme<S>>(family: &str, scheme: F, bound: f64) {
    let system = S::standard();
    let (q, v) = system.standard_motion();
    let mut run = Simulation::new(system.clone(), scheme).start(q, v).expect("consistent");
    let momenta = |state: &State<S>| -> Vec<f64> {
        S::MOMENTA.iter().map(|m| (m.value)(&system, state.q().as_ref(), state.p().as_ref())).collect()
    };
    let (energy_at_start, momenta_at_start) = (run.energy(), momenta(run.state()));
    assert!(momenta_at_start.iter().all(|value| *value != 0.0), "{}: vacuous momenta", S::NAME);
    // Largest on the way.
    let (mut position, mut velocity, mut twice_kinetic) = (0.0, 0.0, 0.0);
    let (mut energy, mut momentum) = (0.0, 0.0);
    for _ in 0..STEPS {
        run.advance().expect("solvable");
        energy = larger(energy, (run.energy() - energy_at_start).abs());
        let state = run.state();
        let (v, p) = (state.v().as_ref(), state.p().as_ref());
        position = larger(position, largest(state.q().as_ref()));
        velocity = larger(velocity, largest(v));
        twice_kinetic = larger(twice_kinetic, v.iter().zip(p).map(|(v, p)| v * p).sum());
        for (now, then) in momenta(state).iter().zip(&momenta_at_start) {
            momentum = larger(momentum, (now / then - 1.0).abs());
        }
    }
    energy /= twice_kinetic;
    let Reference { q, v, .. } = S::reference();
    let positions = largest_difference(run.state().q().as_ref(), q.as_ref()) / position;
    let velocities = largest_difference(run.state().v().as_ref(), v.as_ref()) / velocity;
    let measured = format!(
        "{:<23}{family}: positions {positions:.1e}, velocities {velocities:.1e}, energy {energy:.1e}, momenta {momentum:.1e}",
        S::NAME
    );
    println!("{measured}");
    assert!(positions <= bound && velocities <= bound, "{measured}, bound {bound:e}");
    assert!(if S::CONSERVES_ENERGY { energy <= ENERGY } else { energy >= NO_CONSERVATION }, "{measured}");
    assert!(momentum <= MOMENTUM, "{measured}");
}

struct Runs;

impl Visitor for Runs {
    fn visit<S: Scene>(&mut self) {
        let row = BOUNDS.iter().find(|(name, ..)| *name == S::NAME);
        let (_, composed, galerkin) = row.expect("a row of the table for every scene");
        let h = S::HORIZON / f64::from(STEPS);
        let composition = Evi::midpoint(h).composed(Composition::kahan_li_8()).compensated();
        check::<S, _>("composed", composition, *composed);
        if let Some(galerkin) = galerkin {
            check::<S, _>("Galerkin", Galerkin::<4>::new(h).by_newton().compensated(), *galerkin);
        }
    }
}

#[test]
fn and_invariants_of_every_scene() {
    /// The prepared maps of a composition take 1.6 MB for the long chain, and are moved; a test has 2 MB of stack otherwise.
    const STACK: usize = 1 << 27;
    let runs = std::thread::Builder::new().stack_size(STACK).spawn(|| visit_all(&mut Runs));
    runs.expect("a thread").join().expect("every scene as the gallery says");
}
