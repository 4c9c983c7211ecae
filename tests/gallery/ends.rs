//! Every standard motion, by two families of order 8 that share no step equations: it ends where the gallery says, and conserves what
//! the gallery says and nothing else.

use evi_core::prelude::*;
use evi_examples::{Reference, Scene, Visitor, visit_all};
use evi_tests::largest_difference;

/// Steps of every run: enough for order 8 to come near round-off.
const STEPS: u32 = 1600;

struct Runs;

/// Largest magnitude; NaN if one is.
fn largest(values: &[f64]) -> f64 {
    largest_difference(values, &vec![0.0; values.len()])
}

/// The larger of two magnitudes; NaN if one is.
fn larger(a: f64, b: f64) -> f64 {
    if a <= b || b.is_nan() { b } else { a }
}

/// Runs the standard motion of `S` and compares it with what the gallery says.
fn check<S: Scene, F: Scheme<S>>(family: &str, scheme: F) {
    let system = S::standard();
    let (q, v) = system.standard_motion();
    let mut run = Simulation::new(system.clone(), scheme).start(q, v).expect("consistent");
    let momenta = |run: &Run<S, F::Step>| -> Vec<f64> {
        let state = run.state();
        S::MOMENTA.iter().map(|m| (m.value)(&system, state.q().as_ref(), state.p().as_ref())).collect()
    };
    let (energy, at_start) = (run.energy(), momenta(&run));
    let (mut energy_change, mut energy_scale, mut momentum_change) = (0.0, 0.0, 0.0);
    for _ in 0..STEPS {
        run.advance().expect("solvable");
        energy_change = larger(energy_change, (run.energy() - energy).abs());
        let state = run.state();
        let twice_kinetic = state.p().as_ref().iter().zip(state.v().as_ref()).map(|(p, v)| p * v).sum();
        energy_scale = larger(energy_scale, twice_kinetic);
        for (now, then) in momenta(&run).iter().zip(&at_start) {
            momentum_change = larger(momentum_change, (now / then - 1.0).abs());
        }
    }
    energy_change /= energy_scale;
    let end = S::reference();
    let of = |here: &[f64], there: &[f64]| largest_difference(here, there) / largest(there);
    let positions = of(run.state().q().as_ref(), end.q.as_ref());
    let velocities = of(run.state().v().as_ref(), end.v.as_ref());
    println!(
        "{:24} {family}: q {positions:.1e}, v {velocities:.1e}, energy {energy_change:.1e}, momenta {momentum_change:.1e}",
        S::NAME
    );
}

impl Visitor for Runs {
    fn visit<S: Scene>(&mut self) {
        let h = S::HORIZON / f64::from(STEPS);
        check::<S, _>("composed", Evi::midpoint(h).composed(Composition::kahan_li_8()).compensated());
        // A Galerkin step solves one dense system for all points: 240 unknowns of the long chain.
        if S::N_COORDINATES <= 10 {
            check::<S, _>("Galerkin", Galerkin::<4>::new(h).compensated());
        }
    }
}

#[test]
fn of_every_scene() {
    /// The prepared maps of a composition take 1.6 MB for the long chain; a test has 2 MB of stack otherwise.
    const STACK: usize = 1 << 24;
    let runs = std::thread::Builder::new().stack_size(STACK).spawn(|| visit_all(&mut Runs));
    runs.expect("a thread").join().expect("no scene fails");
}
