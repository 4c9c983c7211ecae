//! Symmetric compositions: their orders, and that they keep what their base keeps.

use evi_core::baseline::Rattle;
use evi_core::prelude::*;
use evi_examples::{DoublePendulum, SphericalPendulum, Start};
use evi_tests::conservation::{angular_momentum, largest_change, largest_residuals, there_and_back};
use evi_tests::convergence::check_orders;
use evi_tests::largest_difference;
use evi_tests::motions::{
    Motion, charged_spherical_pendulum, gentle_double_pendulum, kapitza_pendulum,
    long_double_pendulum_in_angles, modulated_pendulum, relativistic_bead,
};
use evi_tests::scenes::{ChargedSphericalPendulum, DoublePendulumInAngles, KapitzaPendulum};
use evi_tests::tangent::{Action, DiscreteAction, TangentSpace, symplectic_defect};

/// The double pendulum of unequal masses and lengths, on a swing of moderate size.
fn swing() -> (DoublePendulum, Start<4>) {
    let angles = DoublePendulumInAngles::UNEQUAL;
    let Start { q, v } = DoublePendulumInAngles::MODERATE;
    (angles.constrained(), angles.cartesian(q, v))
}

mod order {
    use super::*;

    /// Every composition of one base, from about as many steps of the base on.
    #[track_caller]
    fn check_all<S, B>(motion: &Motion<S>, coarsest: u32, base: impl Fn(f64) -> B)
    where
        S: MechanicalSystem + Clone,
        B: Symmetric + Scheme<S>,
    {
        check_orders(motion, coarsest, |h| base(h).composed(Composition::triple_jump_4()), 4.0);
        check_orders(motion, coarsest / 3, |h| base(h).composed(Composition::suzuki_4()), 4.0);
        check_orders(motion, coarsest / 2, |h| base(h).composed(Composition::yoshida_6()), 6.0);
        check_orders(motion, coarsest / 3, |h| base(h).composed(Composition::kahan_li_6()), 6.0);
        check_orders(motion, coarsest / 10, |h| base(h).composed(Composition::kahan_li_8()), 8.0);
    }

    #[test]
    fn midpoint_on_the_constrained_double_pendulum() {
        check_all(&gentle_double_pendulum(), 30, Evi::midpoint);
    }

    #[test]
    fn simpson_with_a_frequency_on_the_constrained_double_pendulum() {
        check_all(&gentle_double_pendulum(), 30, |h| Evi::simpson(h).frequency(3.13));
    }

    #[test]
    fn the_multiplier_shift_on_the_constrained_double_pendulum() {
        let motion = gentle_double_pendulum();
        let DoublePendulum { l1, l2, .. } = motion.system;
        let hanging = [0.0, -l1, 0.0, -l1 - l2];
        check_all(&motion, 30, |h| Evi::trapezoid(h).linearised_at(hanging));
        check_all(&motion, 30, |h| Evi::midpoint(h).linearised_at(hanging));
    }

    #[test]
    fn rattle_on_the_constrained_double_pendulum() {
        check_all(&gentle_double_pendulum(), 30, Rattle::new);
    }

    #[test]
    fn midpoint_where_the_mass_depends_on_the_configuration() {
        check_all(&long_double_pendulum_in_angles(), 30, Evi::midpoint);
    }

    #[test]
    fn gyroscopic_coupling_with_a_constraint() {
        check_all(&charged_spherical_pendulum(), 30, |h| Evi::simpson(h).frequency(2.0));
    }

    #[test]
    fn not_quadratic_in_velocity_with_a_constraint() {
        check_all(&relativistic_bead(), 30, Evi::midpoint);
    }

    #[test]
    fn time_passes_through_the_stages_of_a_moving_constraint() {
        check_all(&kapitza_pendulum(), 60, Evi::midpoint);
    }

    #[test]
    fn time_passes_through_the_stages_of_a_time_dependent_potential() {
        check_all(&modulated_pendulum(), 30, Evi::simpson);
    }

    #[test]
    fn a_composition_of_a_composition_keeps_its_order() {
        let scheme = |h| Evi::midpoint(h).composed(Composition::suzuki_4()).composed(Composition::suzuki_4());
        check_orders(&gentle_double_pendulum(), 20, scheme, 4.0);
    }
}

mod kept {
    use super::*;

    /// 64 roundings of velocities of size 4 (8.9e-16), in up to 1,700 stages; measured 18 of them.
    const ROUND_OFF: f64 = 64.0 * 4.0 * f64::EPSILON;

    #[track_caller]
    fn check_returns<S, B, const N: usize>(system: S, start: Start<N>, base: impl Fn(f64) -> B, h: f64)
    where
        S: MechanicalSystem<PerCoordinate<f64> = [f64; N]> + Clone,
        B: Symmetric + Scheme<S>,
    {
        let returned = [
            there_and_back(system.clone(), |h| base(h).composed(Composition::triple_jump_4()), start, h, 50),
            there_and_back(system.clone(), |h| base(h).composed(Composition::suzuki_4()), start, h, 50),
            there_and_back(system.clone(), |h| base(h).composed(Composition::yoshida_6()), start, h, 50),
            there_and_back(system.clone(), |h| base(h).composed(Composition::kahan_li_6()), start, h, 50),
            there_and_back(system, |h| base(h).composed(Composition::kahan_li_8()), start, h, 50),
        ];
        assert!(returned.iter().all(|distance| *distance <= ROUND_OFF), "misses the start by {returned:?}");
    }

    #[test]
    fn a_step_back_undoes_a_step() {
        let (system, start) = swing();
        check_returns(system, start, Evi::midpoint, 0.02);
        check_returns(system, start, |h| Evi::simpson(h).frequency(3.13), 0.02);
        check_returns(system, start, Rattle::new, 0.02);
        let charged = ChargedSphericalPendulum::STANDARD;
        check_returns(charged, charged.one_radian(), Evi::midpoint, 0.02);
        let moving = KapitzaPendulum::STANDARD;
        check_returns(moving, moving.near_inverted(), Evi::midpoint, 0.002);
    }

    #[test]
    fn constraints_and_angular_momentum() {
        const STEPS: usize = 10_000;
        /// Momenta of size 4 on an arm of 1, rounded at random in each of 17 · 10⁴ stages: `ε · 4 · √170,000`;
        /// measured a seventh.
        const LONG_ROUND_OFF: f64 = 4.0 * 412.0 * f64::EPSILON;
        let system = SphericalPendulum::UNIT;
        let start = system.one_radian();
        let order_6 = Evi::midpoint(0.05).composed(Composition::kahan_li_6());
        let order_8 = Evi::simpson(0.05).frequency(2.0).composed(Composition::kahan_li_8());
        for change in [
            largest_change(system, order_6, start, STEPS, |q, p| angular_momentum(q, p, 0)),
            largest_change(system, order_8, start, STEPS, |q, p| angular_momentum(q, p, 0)),
        ] {
            assert!(change <= LONG_ROUND_OFF, "angular momentum changes by {change:e}");
        }
        let (double, swing) = swing();
        for [constraint, hidden] in [
            largest_residuals(system, order_6, start, STEPS),
            largest_residuals(system, order_8, start, STEPS),
            largest_residuals(double, order_6, swing, STEPS),
            largest_residuals(double, order_8, swing, STEPS),
        ] {
            // Squares of coordinates up to 2, each rounded, and scalar products of four terms: 9 ε and 1.0 ε measured.
            assert!(constraint <= 12.0 * f64::EPSILON, "φ: {constraint:e}");
            assert!(hidden <= 4.0 * f64::EPSILON, "G v: {hidden:e}");
        }
    }

    /// The stages by hand, and their tangent maps one after the other.
    #[track_caller]
    fn check_symplectic<const N: usize>(composition: Composition<N>) {
        const H: f64 = 0.05;
        let (system, start) = swing();
        let (rule, frequency) = (Quadrature::<3>::uniform(), Frequency::Trigonometric(3.13));
        let base = Evi::new(rule, H).frequency(frequency);
        let mut composed =
            Simulation::new(system, base.composed(composition)).start(start.q, start.v).unwrap();
        let mut state = composed.state().clone();
        let before = TangentSpace::at(&system, &state).momentum;
        let mut after = before.clone();
        for fraction in composition.fractions() {
            let h = fraction * H;
            let stage = Simulation::new(system, base.with_step_size(h));
            let mut stage = stage.start_at(state.t(), *state.q(), *state.v()).expect("a start");
            let next = stage.advance().expect("a stage").clone();
            after = Action::new(&rule, [frequency; 4], h).tangent_map(&system, &state, &next) * after;
            state = next;
        }
        let by_composition = composed.advance().expect("a step");
        // Predicted multipliers differ, hence last bits.
        let difference = largest_difference(by_composition.q(), state.q())
            .max(largest_difference(by_composition.p(), state.p()));
        assert!(difference <= ROUND_OFF, "the stages are other steps: {difference:e}");
        assert!((by_composition.t() - state.t()).abs() <= f64::EPSILON, "{}", state.t());
        let roundings = symplectic_defect(&before, &after);
        // The terms of a stage of length γh are 1/γ times as large as those of a step, down to γ = 0.08; 20 measured.
        assert!(roundings <= 32.0, "the form changes by {roundings:.0} roundings");
    }

    #[test]
    fn the_symplectic_form() {
        check_symplectic(Composition::triple_jump_4());
        check_symplectic(Composition::suzuki_4());
        check_symplectic(Composition::yoshida_6());
        check_symplectic(Composition::kahan_li_6());
        check_symplectic(Composition::kahan_li_8());
    }
}

mod refusals {
    use super::*;

    fn refusal<S: MechanicalSystem, F: Scheme<S>, const N: usize>(
        system: S,
        scheme: F,
        start: Start<N>,
    ) -> Option<SchemeError>
    where
        [f64; N]: Into<S::PerCoordinate<f64>>,
    {
        match Simulation::new(system, scheme).start(start.q, start.v) {
            Ok(_) => None,
            Err(StartError::Scheme(error)) => Some(error),
            Err(error) => panic!("{error}"),
        }
    }

    #[test]
    fn nodes_that_do_not_mirror_each_other() {
        let (system, start) = swing();
        let left = Evi::new(Quadrature::interpolatory([0.0]).expect("a rule"), 0.01);
        assert_eq!(refusal(system, left, start), None);
        let error = refusal(system, left.composed(Composition::suzuki_4()), start).expect("a refusal");
        let expected = SchemeError::AsymmetricNodes {
            node: 0,
            offset: -0.5,
            weight: 1.0,
            mirrored_offset: -0.5,
            mirrored_weight: 1.0,
        };
        assert_eq!(error, expected);
        let nested = left.composed(Composition::suzuki_4()).composed(Composition::suzuki_4());
        assert_eq!(refusal(system, nested, start), Some(expected));
        let rule = Quadrature::interpolatory([0.0, 0.3, 1.0]).expect("a rule");
        let error = refusal(system, Evi::new(rule, 0.01).composed(Composition::yoshida_6()), start);
        assert!(matches!(error, Some(SchemeError::AsymmetricNodes { node: 0, .. })), "{error:?}");
    }

    /// The longest stage of the triple jump is 1.70 steps: at `ω h = 2` it meets the resonance at π that the step itself does not.
    #[test]
    fn a_frequency_that_is_resonant_in_the_longest_stage() {
        let (system, start) = swing();
        let longest = Composition::triple_jump_4().fractions()[1].abs();
        let omega = core::f64::consts::PI / (0.1 * longest);
        let base = Evi::midpoint(0.1).frequency(omega);
        assert_eq!(refusal(system, base, start), None);
        let error = refusal(system, base.composed(Composition::triple_jump_4()), start);
        assert!(matches!(error, Some(SchemeError::ResonantFrequency { .. })), "{error:?}");
        assert_eq!(refusal(system, base.composed(Composition::kahan_li_8()), start), None);
    }

    #[test]
    fn a_step_size_that_defines_no_step() {
        let (system, start) = swing();
        for h in [0.0, f64::NAN, f64::INFINITY] {
            let error = refusal(system, Evi::midpoint(h).composed(Composition::suzuki_4()), start);
            assert!(matches!(error, Some(SchemeError::StepSize { .. })), "{error:?}");
        }
    }

    #[test]
    fn a_stage_without_solution_leaves_the_state() {
        let system = DoublePendulum::UNIT;
        let Start { q, v } = system.horizontal();
        let scheme = Evi::simpson(0.2).frequency(3.13).composed(Composition::kahan_li_8());
        let mut run = Simulation::new(system, scheme).start(q, v).expect("a start");
        let mut last = run.state().clone();
        let failure = loop {
            match run.advance() {
                Ok(state) => last = state.clone(),
                Err(failure) => break failure,
            }
            assert!(run.steps() < 1_000, "vacuous: every step has a solution");
        };
        println!("after {} steps: {failure}", run.steps());
        assert!(matches!(failure, StepError::NoSolution { .. }), "{failure}");
        assert_eq!(*run.state(), last);
        let again = run.advance().expect_err("nothing has changed");
        assert!(matches!(again, StepError::NoSolution { .. }), "{again}");
        assert_eq!(*run.state(), last);
    }
}
