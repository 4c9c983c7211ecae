//! Orders in phase and momentum.

use super::*;

const MU: f64 = 1.0;
/// Not a multiple of the half period, where an exact phase would hide every error.
const T: f64 = 10.0;
const START: (f64, f64) = (1.0, 0.5);

/// Orders of `q`, `p` and `H` at time 10 from `(q₀, p₀)`, over steps that all end there.
#[track_caller]
fn check<const K: usize>(rule: Quadrature<K>, omega: f64, steps: [u32; 5], order: f64) {
    let system = HarmonicOscillator { m: 1.0, k: MU * MU };
    let (q, p) = system.exact(T, START.0, START.1);
    let energy = 0.5 * (START.1.powi(2) + START.0.powi(2));
    let h = steps.map(|n| T / f64::from(n));
    let errors: [[f64; 3]; 5] = h.map(|h| {
        let simulation = Simulation::new(system, Evi::new(rule, h).frequency(omega));
        let mut run = simulation.start([START.0], [START.1]).expect("a start");
        run.advance_to(T).expect("every step");
        let state = run.state();
        [(state.q()[0] - q).abs(), (state.p()[0] - p).abs(), (run.energy() - energy).abs()]
    });
    for (quantity, name) in ["q", "p", "H"].into_iter().enumerate() {
        let errors = errors.map(|errors| errors[quantity]);
        // A hundred times the round-off of the longest run.
        assert!(errors.iter().all(|error| *error > 1e-12), "{name}: round-off in {errors:?}");
        let observed = observed_order(&h, &errors);
        println!("{}: {name} {observed:.4}", core::panic::Location::caller());
        assert!((observed - order).abs() <= 0.05, "order of {name}: {observed:.3}, not {order}; {errors:?}");
    }
}

const FINE: [u32; 5] = [200, 400, 800, 1600, 3200];
const COARSE: [u32; 5] = [40, 60, 80, 120, 160];
const COARSEST: [u32; 5] = [16, 20, 24, 32, 40];

#[test]
fn at_the_own_frequency_is_the_order_of_the_quadrature() {
    check(left_rectangle(), MU, FINE, 1.0);
    check(Quadrature::midpoint(), MU, FINE, 2.0);
    check(Quadrature::<2>::uniform(), MU, FINE, 2.0);
    check(Quadrature::<3>::uniform(), MU, COARSE, 4.0);
    check(Quadrature::<2>::gauss(), MU, COARSE, 4.0);
    check(Quadrature::<3>::gauss(), MU, COARSEST, 6.0);
    check(Quadrature::<4>::lobatto(), MU, COARSEST, 6.0);
}

#[test]
fn at_any_other_frequency_is_2() {
    check(Quadrature::midpoint(), 1.1 * MU, FINE, 2.0);
    check(Quadrature::<2>::uniform(), 1.1 * MU, FINE, 2.0);
    check(Quadrature::<3>::uniform(), 1.1 * MU, FINE, 2.0);
    check(Quadrature::<3>::gauss(), 1.1 * MU, FINE, 2.0);
    check(Quadrature::<4>::lobatto(), 1.1 * MU, FINE, 2.0);
    check(left_rectangle(), 1.1 * MU, FINE, 1.0);
}
