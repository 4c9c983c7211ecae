//! What each method keeps.

use super::*;

/// Largest `|φ|` and `|G v|` along a run of 10 units of time.
fn residuals<F: Scheme<DoublePendulum>>(scheme: F) -> [f64; 2] {
    let (system, start) = swing();
    let mut run = Simulation::new(system, scheme).start(start.q, start.v).unwrap();
    let mut largest = [0.0_f64; 2];
    while run.state().t() < 10.0 {
        run.advance().expect("a step");
        let (mechanics, state) = (run.mechanics(), run.state());
        let of = [mechanics.constraint_residual(state), mechanics.hidden_constraint_residual(state)];
        for (largest, residuals) in largest.iter_mut().zip(of) {
            *largest = residuals.iter().fold(*largest, |x, residual| x.max(residual.abs()));
        }
    }
    println!("{}: {largest:?}", core::any::type_name::<F>());
    largest
}

#[test]
fn each_method_keeps_the_constraints_that_it_solves() {
    let [positions, velocities] = residuals(Shake::new(0.01));
    // Squares of coordinates up to 2, measured: 1.3e-15. The hidden constraints are off by O(h²).
    assert!(positions <= 4e-15 && (1e-5..1e-2).contains(&velocities));
    let [positions, velocities] = residuals(GeneralizedAlpha::new(0.01));
    assert!(positions <= 4e-15 && (1e-5..1e-2).contains(&velocities));
    // Quadratic constraints: G v is a quadratic first integral, kept but for the round-off of 1,000 steps; φ drifts.
    let [positions, velocities] = residuals(ImplicitMidpoint::new(0.01));
    assert!((1e-5..1e-1).contains(&positions) && velocities <= 1e-11);
}

#[test]
fn implicit_midpoint_is_reversible() {
    let Start { q, v } = DoublePendulumInAngles::MODERATE;
    let angles = DoublePendulumInAngles::UNEQUAL;
    let distance = there_and_back(angles, ImplicitMidpoint::new, Start { q, v }, 0.01, 200);
    // The motion is chaotic: round-off of 400 steps, 1.1e-13 measured.
    assert!(distance <= 1e-12);
    // With constraints the turning point is no start, since φ has drifted: maps take the steps.
    let (system, start) = swing();
    let mut run = Simulation::new(system, ImplicitMidpoint::new(0.01)).start(start.q, start.v).unwrap();
    let first = run.state().clone();
    let mut state = run.advance_to(2.0).unwrap().clone();
    let mut back = ImplicitMidpoint::new(-0.01).prepare(Mechanics::new(&system)).unwrap();
    for _ in 0..run.steps() {
        back.advance(&mut state, &mut ()).expect("a step back");
    }
    let distance = largest_difference(state.q(), first.q()).max(largest_difference(state.v(), first.v()));
    println!("{distance:e}");
    assert!(distance <= 1e-12);
}

/// Largest position and velocity times h of an oscillator after steps that do not resolve it at all.
fn unresolved<F: Scheme<HarmonicOscillator>>(scheme: F, h: f64, steps: usize) -> f64 {
    let oscillator = HarmonicOscillator { m: 2.0, k: 2e8 };
    let mut run = Simulation::new(oscillator, scheme).start([1.0], [0.0]).unwrap();
    (0..steps).for_each(|_| assert!(run.advance().is_ok()));
    run.state().q()[0].abs().max(h * run.state().v()[0].abs())
}

#[test]
fn generalized_alpha_damps_what_it_does_not_resolve_by_its_spectral_radius() {
    // h ω = 1000.
    let h = 0.1;
    for radius in [0.5, 0.8] {
        let scheme = || GeneralizedAlpha::new(h).spectral_radius(radius);
        let (early, late) = (unresolved(scheme(), h, 40), unresolved(scheme(), h, 80));
        let rate = (late / early).powf(1.0 / 40.0);
        println!("{rate:.3} per step at ρ = {radius}");
        // Eigenvalues of −ρ that are defective: ρⁿ times a polynomial in n.
        assert!((rate / radius - 1.0).abs() <= 0.06, "{rate:.3} per step");
    }
    assert!(unresolved(ImplicitMidpoint::new(h), h, 80) > 0.5);
}
