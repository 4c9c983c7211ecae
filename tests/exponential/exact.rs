//! Motions that are reproduced to round-off.

use evi_core::prelude::*;
use evi_examples::{HarmonicOscillator, Start};

use super::fixtures::{Ring, distance_from};

mod oscillator {
    use super::*;

    /// 100 steps of half a unit of time.
    const H: f64 = 0.5;
    const T: f64 = 50.0;

    /// Largest error of `q`, `v` and relative energy over the run.
    #[track_caller]
    fn errors<F: Scheme<HarmonicOscillator> + Copy>(omega: f64, scheme: F) -> (f64, f64) {
        let system = HarmonicOscillator { m: 2.0, k: 2.0 * omega * omega };
        let start = Start { q: [1.0], v: [0.3] };
        let motion = |t: f64| {
            let (sine, cosine) = (omega * t).sin_cos();
            ([cosine + 0.3 / omega * sine], [0.3 * cosine - omega * sine])
        };
        let state = distance_from(system, scheme, start, T, motion);
        let mut run = Simulation::new(system, scheme).start(start.q, start.v).expect("a start");
        let before = run.energy();
        let mut energy = 0.0_f64;
        while run.state().t() < T {
            run.advance().expect("a step");
            energy = energy.max((run.energy() / before - 1.0).abs());
        }
        println!("{}: state {state:.1e}, energy {energy:.1e}", core::panic::Location::caller());
        (state, energy)
    }

    #[track_caller]
    fn check_exact<F: Scheme<HarmonicOscillator> + Copy>(omega: f64, scheme: F) {
        let (state, energy) = errors(omega, scheme);
        // Round-off of 100 steps: 8.4e-15 measured.
        assert!(state <= 1e-14 && energy <= 1e-14, "{state:e}, {energy:e}");
    }

    #[test]
    fn on_fitted_weights() {
        check_exact(1.0, Evi::simpson(H).frequency(1.0).fitted());
        check_exact(2.0, Evi::simpson(H).frequency(2.0).fitted());
        check_exact(1.0, Evi::new(Quadrature::<3>::gauss(), H).frequency(1.0).fitted());
        let own = Quadrature::interpolatory([0.125, 0.5, 0.875]).expect("a rule");
        check_exact(1.0, Evi::new(own, H).frequency(1.0).fitted());
        check_exact(1.0, Evi::simpson(H).frequency(1.0).fitted().about([0.0]));
    }

    #[test]
    fn on_a_stiffness_whatever_the_nodes() {
        check_exact(1.0, Evi::trapezoid(H).stiffness([[2.0]]));
        check_exact(1.0, Evi::midpoint(H).stiffness([[2.0]]));
        check_exact(1.0, Evi::simpson(H).stiffness([[2.0]]));
        check_exact(1.0, Evi::trapezoid(H).linearised_at([0.1]));
        check_exact(1.0, Evi::trapezoid(H).stiffness([[2.0]]).mollified(Mollifier::LongAverage));
    }

    #[test]
    fn but_not_on_the_weights_of_the_rule() {
        let (state, energy) = errors(1.0, Evi::simpson(H).frequency(1.0));
        assert!(state > 1e-4 && energy > 1e-4);
        let (state, _) = errors(1.0, Evi::trapezoid(H).stiffness([[1.9]]));
        assert!(state > 1e-4);
    }

    #[test]
    fn on_fitted_weights_that_grow() {
        // ÿ = y: exact in relative terms.
        let system = HarmonicOscillator { m: 1.0, k: -1.0 };
        let scheme = Evi::simpson(0.25).frequency(Frequency::Hyperbolic(1.0)).fitted();
        let motion = |t: f64| ([t.cosh()], [t.sinh()]);
        let error =
            distance_from(system, scheme, Start { q: [1.0], v: [0.0] }, 10.0, motion) / 10.0_f64.cosh();
        println!("{error:e}");
        // Forty multiplications by e^¼: 3e-15 measured.
        assert!(error <= 1e-14, "{error:e}");
    }
}

mod circle {
    use super::*;

    const RING: Ring = Ring { m: 1.3, r: 0.7 };
    const RATE: f64 = 5.0;
    const H: f64 = 0.1;
    const START: Start<2> = Start { q: [0.7, 0.0], v: [0.0, 0.7 * RATE] };

    fn error<F: Scheme<Ring>>(scheme: F) -> f64 {
        let motion = |t: f64| {
            let (sine, cosine) = (RATE * t).sin_cos();
            ([RING.r * cosine, RING.r * sine], [-RING.r * RATE * sine, RING.r * RATE * cosine])
        };
        distance_from(RING, scheme, START, 10.0, motion)
    }

    #[test]
    fn uniform_rotation_is_exact_with_the_multiplier_of_the_motion() {
        let (q, v) = (START.q, START.v);
        for error in [
            error(Evi::trapezoid(H).linearised_along(q, v)),
            error(Evi::midpoint(H).linearised_along(q, v)),
            error(Evi::simpson(H).linearised_along(q, v)),
            error(Evi::trapezoid(H).linearised_along(q, v).mollified(Mollifier::ShortAverage)),
        ] {
            println!("{error:e}");
            // 50 radians in 100 steps: 6e-14 measured.
            assert!(error <= 1e-12, "{error:e}");
        }
    }

    /// The reference is the centre, to which the quadratic model leads from any point of the circle.
    #[test]
    fn any_point_of_the_motion_gives_the_same_split() {
        let mechanics = evi_core::mechanics::Mechanics::new(&RING);
        let (sine, cosine) = 0.9_f64.sin_cos();
        let (q, v) = ([0.7 * cosine, 0.7 * sine], [-3.5 * sine, 3.5 * cosine]);
        let linearisation = mechanics.linearised_along(&q, &v).expect("a linearisation");
        for (row, stiffness) in linearisation.stiffness().iter().enumerate() {
            for (col, stiffness) in stiffness.iter().enumerate() {
                let expected = if row == col { RING.m * RATE * RATE } else { 0.0 };
                assert!((stiffness - expected).abs() < 1e-13, "{stiffness}");
            }
        }
        assert!(linearisation.reference().iter().all(|x| x.abs() < 1e-15), "{:?}", linearisation.reference());
        let scheme = Evi::trapezoid(H).linearised_along(q, v);
        assert!(error(scheme) <= 1e-12);
    }

    /// A rotation that a constraint enforces is none that a frequency fits.
    #[test]
    fn neither_straight_curves_nor_the_rate_as_a_frequency_come_near() {
        let (straight, frequency) = (error(Evi::midpoint(H)), error(Evi::midpoint(H).frequency(RATE)));
        println!("{straight} {frequency}");
        assert!(straight > 1.0 && frequency > 1.0);
    }
}
