//! Momenta change by the discrete impulse, to round-off.

use evi_core::prelude::*;
use evi_core::scheme::NodeCoefficients;
use evi_tests::scenes::PushedDumbbell;

/// Linear and angular momentum of the dumbbell.
fn momenta(q: &[f64; 4], p: &[f64; 4]) -> [f64; 3] {
    [p[0] + p[2], p[1] + p[3], q[0] * p[1] - q[1] * p[0] + q[2] * p[3] - q[3] * p[2]]
}

/// What 200 steps add to the momenta, less the discrete impulse `f⁻·ξ(q₀) + f⁺·ξ(q₁)` of translations and rotations ξ, computed
/// here from the interpolating curves; over the largest momentum.
fn defects<F: Scheme<PushedDumbbell>, const K: usize>(
    scheme: F,
    (quadrature, frequency, h): (Quadrature<K>, Frequency, f64),
) -> [f64; 3] {
    let system = PushedDumbbell::STANDARD;
    let start = system.turning();
    let mut run = Simulation::new(system, scheme).start(start.q, start.v).expect("a consistent start");
    let begin = momenta(run.state().q(), run.state().p());
    let mut impulse = [0.0; 3];
    let mut largest = 0.0_f64;
    for step in 0..200 {
        let push = [0.4 * f64::from(step % 7) - 1.0, 0.3 * f64::from(step % 3)];
        run.set_inputs(push);
        let q0 = *run.state().q();
        run.advance().expect("a step");
        let q1 = *run.state().q();
        for (&offset, weight) in quadrature.offsets().iter().zip(quadrature.weights()) {
            let c = NodeCoefficients::new(frequency, h, offset);
            let at = |even: f64, odd: f64| -> [f64; 4] {
                core::array::from_fn(|i| even * 0.5 * (q0[i] + q1[i]) + odd * (q1[i] - q0[i]))
            };
            let (x, v) = (at(c.even, c.odd), at(c.even_rate / h, c.odd_rate / h));
            let drag = [system.c1, system.c1, system.c2, system.c2];
            let force: [f64; 4] =
                core::array::from_fn(|i| if i < 2 { push[i] } else { 0.0 } - drag[i] * v[i]);
            // A rotation of both ends rotates the curve; a translation moves it by g₁ + g₂ as far.
            let [along_x, along_y, around] = momenta(&x, &force);
            let parts = [c.even * along_x, c.even * along_y, around];
            for (sum, part) in impulse.iter_mut().zip(parts) {
                *sum += h * weight * part;
            }
        }
        let now = momenta(run.state().q(), run.state().p());
        largest = now.iter().fold(largest, |largest, momentum| largest.max(momentum.abs()));
    }
    let now = momenta(run.state().q(), run.state().p());
    assert!((0..3).all(|k| (now[k] - begin[k]).abs() > 0.1), "nothing has changed: {begin:?} {now:?}");
    core::array::from_fn(|k| (now[k] - begin[k] - impulse[k]).abs() / largest)
}

/// Sums of 200 steps: 2.6e-15 measured.
const ROUND_OFF: f64 = 5e-15;

#[test]
fn is_the_change_of_linear_and_angular_momentum_on_straight_curves() {
    for h in [0.02, -0.02] {
        let (midpoint, simpson) = (Quadrature::midpoint(), Quadrature::<3>::uniform());
        let defects = [
            defects(Evi::midpoint(h), (midpoint, Frequency::ZERO, h)),
            defects(Evi::simpson(h), (simpson, Frequency::ZERO, h)),
        ];
        println!("{defects:?}");
        assert!(defects.iter().flatten().all(|defect| *defect <= ROUND_OFF), "{defects:?}");
    }
}

/// Trigonometric curves keep rotations as a symmetry of the action, and with one node translations, too.
#[test]
fn is_the_change_of_angular_momentum_on_trigonometric_curves() {
    let (h, omega) = (0.02, Frequency::from(3.0));
    let (midpoint, simpson) = (Quadrature::midpoint(), Quadrature::<3>::uniform());
    let one = defects(Evi::midpoint(h).frequency(omega), (midpoint, omega, h));
    let three = defects(Evi::simpson(h).frequency(omega), (simpson, omega, h));
    println!("{one:?} {three:?}");
    assert!(one.iter().all(|defect| *defect <= ROUND_OFF) && three[2] <= ROUND_OFF, "{one:?} {three:?}");
    // A known limitation: with three nodes a translation changes the velocities of the curve.
    assert!(three[0] > 1e-6, "{three:?}");
}
