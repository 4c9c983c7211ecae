//! How much nearer the motion the multiplier shift leads: the double pendulum near its hanging rest.

use evi_core::integrator::{LinearisedAt, MatrixEvi};
use evi_core::prelude::*;
use evi_examples::{DoublePendulum, FermiPastaUlam, GRAVITY, Start};
use evi_tests::references::{self, Certified};
use evi_tests::scenes::DoublePendulumInAngles;
use evi_tests::{distance, integrate_by_hand, observed_order};

use super::fixtures::Bead;

const HANGING: [f64; 4] = [0.0, -1.0, 0.0, -2.0];

fn shifted<const K: usize>(rule: Quadrature<K>, h: f64) -> MatrixEvi<K, LinearisedAt<[f64; 4]>> {
    Evi::new(rule, h).linearised_at(HANGING)
}

/// Distance in `(q, v)` at the end of a run.
#[track_caller]
fn error<S, F, const N: usize>(system: S, scheme: F, start: Start<N>, (t, q, v): (f64, &[f64], &[f64])) -> f64
where
    S: MechanicalSystem<PerCoordinate<f64> = [f64; N]>,
    F: Scheme<S>,
{
    let mut run = Simulation::new(system, scheme).start(start.q, start.v).expect("a start");
    let state = run.advance_to(t).expect("every step");
    assert!((state.t() - t).abs() < 1e-9, "not there");
    distance(state.q(), q).hypot(distance(state.v(), v))
}

#[track_caller]
fn mild_error<F: Scheme<DoublePendulum>>(scheme: F) -> f64 {
    let Certified { t, q, v, .. } = references::DOUBLE_PENDULUM_MILD[1];
    error(DoublePendulum::UNIT, scheme, DoublePendulum::UNIT.at_angles(0.1, 0.1), (t, q, v))
}

#[test]
fn at_a_tenth_of_a_radian_the_error_is_eighty_times_smaller() {
    let h = 10.0 / 400.0;
    let (straight, shifted) =
        (mild_error(Evi::midpoint(h)), mild_error(shifted(Quadrature::<2>::uniform(), h)));
    println!("straight {straight:.2e}, shifted {shifted:.2e}, {:.0} times", straight / shifted);
    // 83 measured.
    assert!(straight / shifted >= 75.0, "{}", straight / shifted);
    // A frequency alone, without the curvature of the constraints, gains nothing.
    let frequency = mild_error(Evi::simpson(h).frequency(GRAVITY.sqrt()));
    println!("frequency alone {frequency:.2e}");
    assert!(frequency > 0.3 * straight);
}

/// At equal steps, hence equal stages.
#[test]
fn composed_to_high_order_the_gain_is_larger() {
    #[track_caller]
    fn check<const D: usize>(composition: Composition<D>, steps: u32, least: f64) {
        let h = 10.0 / f64::from(steps);
        let straight = mild_error(Evi::midpoint(h).composed(composition));
        let shifted = mild_error(shifted(Quadrature::<2>::uniform(), h).composed(composition));
        println!(
            "{}: straight {straight:.2e}, shifted {shifted:.2e}, {:.0} times",
            core::panic::Location::caller(),
            straight / shifted
        );
        assert!(shifted > 1e-12, "at round-off");
        assert!(straight / shifted >= least, "{}", straight / shifted);
    }
    check(Composition::triple_jump_4(), 133, 300.0);
    check(Composition::suzuki_4(), 80, 300.0);
    check(Composition::yoshida_6(), 57, 300.0);
    check(Composition::kahan_li_6(), 44, 300.0);
    check(Composition::kahan_li_8(), 30, 300.0);
}

#[test]
fn the_gain_goes_with_the_square_of_the_amplitude() {
    let (h, t) = (0.025, 5.0);
    let amplitudes = [0.02, 0.05, 0.1, 0.2, 0.3];
    let unit = DoublePendulumInAngles { m1: 1.0, m2: 1.0, l1: 1.0, l2: 1.0, g: GRAVITY };
    let quotients = amplitudes.map(|amplitude| {
        let motion =
            integrate_by_hand(|_, q, v| unit.acceleration(q, v), ([amplitude; 2], [0.0; 2]), t, 40_000);
        let end = unit.cartesian(motion.0, motion.1);
        let start = DoublePendulum::UNIT.at_angles(amplitude, amplitude);
        let end = (t, end.q.as_slice(), end.v.as_slice());
        let straight = error(DoublePendulum::UNIT, Evi::midpoint(h), start, end);
        let shifted = error(DoublePendulum::UNIT, shifted(Quadrature::<2>::uniform(), h), start, end);
        println!(
            "{amplitude}: straight {straight:.2e}, shifted {shifted:.2e}, {:.0} times",
            straight / shifted
        );
        shifted / straight
    });
    let slope = observed_order(&amplitudes, &quotients);
    println!("slope {slope:.3}");
    assert!((slope - 2.0).abs() <= 0.1, "{slope}");
}

/// Slopes of the error at the end of a run over four halvings of the step.
#[track_caller]
fn check_order<S, F, const N: usize>(
    system: S,
    scheme: impl Fn(f64) -> F,
    start: Start<N>,
    end: (f64, &[f64], &[f64]),
    coarsest: u32,
) where
    S: MechanicalSystem<PerCoordinate<f64> = [f64; N]> + Copy,
    F: Scheme<S>,
{
    let steps: Vec<f64> = (0..5).map(|k| end.0 / f64::from(coarsest << k)).collect();
    let errors: Vec<f64> = steps.iter().map(|&h| error(system, scheme(h), start, end)).collect();
    let slope = observed_order(&steps, &errors);
    println!("{}: slope {slope:.3}, errors {errors:?}", core::panic::Location::caller());
    assert!(errors[4] > 1e-11, "at round-off");
    assert!((slope - 2.0).abs() <= 0.06, "{slope}");
}

#[test]
fn the_order_is_2_far_from_the_equilibrium_too() {
    let angles = DoublePendulumInAngles::UNEQUAL;
    let Start { q, v } = DoublePendulumInAngles::MODERATE;
    let (qe, ve) = integrate_by_hand(|_, q, v| angles.acceleration(q, v), (q, v), 1.0, 8_000);
    let end = angles.cartesian(qe, ve);
    let end = (1.0, end.q.as_slice(), end.v.as_slice());
    let (system, start) = (angles.constrained(), angles.cartesian(q, v));
    let hanging = [0.0, -angles.l1, 0.0, -angles.l1 - angles.l2];
    check_order(system, |h| Evi::trapezoid(h).linearised_at(hanging), start, end, 50);
    check_order(system, |h| Evi::midpoint(h).linearised_at(hanging), start, end, 50);
    check_order(system, |h| Evi::simpson(h).linearised_at(hanging), start, end, 50);
    let mollified = |filter| move |h| Evi::trapezoid(h).linearised_at(hanging).mollified(filter);
    check_order(system, mollified(Mollifier::ShortAverage), start, end, 50);
    check_order(system, mollified(Mollifier::LongAverage), start, end, 50);
    check_order(system, mollified(Mollifier::LinearAverage), start, end, 50);
    check_order(system, |h| Evi::trapezoid(h).linearised_along(start.q, start.v), start, end, 50);
}

#[test]
fn the_order_is_2_with_a_curvature_that_varies() {
    let bead = Bead::STANDARD;
    let (qe, ve) = integrate_by_hand(|_, q, v| bead.acceleration(q, v), ([0.5], [0.4]), 1.5, 8_000);
    let end = bead.at(qe[0], ve[0]);
    let end = (1.5, end.q.as_slice(), end.v.as_slice());
    let start = bead.at(0.5, 0.4);
    check_order(bead, |h| Evi::trapezoid(h).linearised_at([0.1, 0.8]), start, end, 60);
    check_order(bead, |h| Evi::midpoint(h).linearised_at([0.1, 0.8]), start, end, 60);
    check_order(bead, |h| Evi::new(Quadrature::<3>::gauss(), h).linearised_at([0.1, 0.8]), start, end, 60);
    check_order(bead, |h| Evi::simpson(h).linearised_along(start.q, start.v), start, end, 60);
}

#[test]
fn the_order_is_2_with_a_stiffness() {
    let chain = FermiPastaUlam::STANDARD;
    let Certified { t, q, v, .. } = references::FERMI_PASTA_ULAM[0];
    let (start, end) = (chain.one_spring_excited(), (t, q, v));
    check_order(chain, |h| Evi::trapezoid(h).stiffness(chain.stiff_springs()), start, end, 800);
    check_order(chain, |h| Evi::midpoint(h).stiffness(chain.stiff_springs()), start, end, 800);
}
