//! Proposals of an integrator for a wanted error: what they promise is kept, and what they cannot promise is refused.

use evi_core::integrator::{Member, ProposalError, Statistics, propose};
use evi_core::prelude::*;
use evi_examples::{DoublePendulum, Pendulum, SphericalPendulum, Start};
use evi_tests::scenes::DoublePendulumInAngles;

/// Position at the horizon and the passes there.
fn end<S, F, const N: usize>(system: S, scheme: F, start: Start<N>, horizon: f64) -> ([f64; N], f64)
where
    S: MechanicalSystem<PerCoordinate<f64> = [f64; N]>,
    F: Scheme<S>,
{
    let run = Simulation::new(system, scheme).start(start.q, start.v).expect("a start");
    let mut run = run.with_tally(Statistics::default());
    run.advance_to(horizon).expect("a run");
    (*run.state().q(), run.tally().corrections as f64)
}

fn by<S, const N: usize>(system: &S, member: Member, h: f64, start: Start<N>, horizon: f64) -> ([f64; N], f64)
where
    S: MechanicalSystem<PerCoordinate<f64> = [f64; N]> + Clone,
{
    match member {
        Member::Galerkin(4) => end(system.clone(), Galerkin::<4>::new(h), start, horizon),
        Member::Galerkin(8) => end(system.clone(), Galerkin::<8>::new(h), start, horizon),
        Member::Gauss(4) => end(system.clone(), Gauss::<4>::new(h), start, horizon),
        Member::Gauss(8) => end(system.clone(), Gauss::<8>::new(h), start, horizon),
        other => panic!("{other:?}"),
    }
}

/// Takes the proposal for every error of `wanted`, and holds the error reached against it: against steps of a quarter of its size.
#[track_caller]
fn check<S, const N: usize>(system: &S, start: Start<N>, horizon: f64, wanted: &[f64])
where
    S: MechanicalSystem<PerCoordinate<f64> = [f64; N]> + Clone,
{
    for &error in wanted {
        let proposal = propose(system, start.q, start.v, horizon, error).expect("a proposal");
        let (q, passes) = by(system, proposal.member, proposal.h, start, horizon);
        let (exact, _) = by(system, proposal.member, 0.25 * proposal.h, start, horizon);
        let reached = q.iter().zip(exact).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt();
        println!("{error:e}: {proposal:?}: {reached:.1e}, {passes} passes");
        assert!((proposal.h * proposal.steps as f64 / horizon - 1.0).abs() < 1e-12);
        // A third of what is wanted is aimed at, and errors are no smooth function of the step size.
        assert!(reached <= 3.0 * error, "{error:e}: {reached:e}");
        assert!(reached <= 10.0 * proposal.expected_error, "{reached:e} of {:e}", proposal.expected_error);
        assert!(reached >= 1e-3 * proposal.expected_error, "{reached:e} of {:e}", proposal.expected_error);
        let share = passes / proposal.expected_passes;
        assert!((0.7..1.4).contains(&share), "{passes} passes of {}", proposal.expected_passes);
    }
}

const WANTED: [f64; 4] = [1e-3, 1e-6, 1e-9, 1e-12];

#[test]
fn constraints_in_a_plane_and_in_space() {
    let double = DoublePendulum::UNIT;
    check(&double, double.horizontal(), 5.0, &WANTED);
    let spherical = SphericalPendulum::UNIT;
    check(&spherical, spherical.one_radian(), 5.0, &WANTED);
}

#[test]
fn a_mass_that_varies_without_constraints() {
    check(&DoublePendulumInAngles::UNEQUAL, DoublePendulumInAngles::MODERATE, 5.0, &WANTED);
}

/// Two thousand swings: the trial covers the first ones.
#[test]
fn a_horizon_longer_than_the_trial() {
    let pendulum = Pendulum { m: 1.3, l: 0.8, g: 9.81 };
    check(&pendulum, Start { q: [1.0], v: [0.4] }, 4e3, &[1e-6, 1e-9]);
}

#[test]
fn more_exact_is_more_work() {
    let system = DoublePendulum::UNIT;
    let Start { q, v } = system.horizontal();
    let passes = WANTED.map(|error| propose(&system, q, v, 5.0, error).expect("a proposal").expected_passes);
    assert!(passes.windows(2).all(|pair| pair[0] < pair[1]), "{passes:?}");
}

mod refused {
    use super::*;

    #[track_caller]
    fn refusal<S, const N: usize>(system: &S, start: Start<N>, horizon: f64, error: f64) -> ProposalError
    where
        S: MechanicalSystem<PerCoordinate<f64> = [f64; N]> + Clone,
    {
        let refusal = propose(system, start.q, start.v, horizon, error).expect_err("no proposal");
        println!("{refusal}");
        refusal
    }

    #[test]
    fn what_is_no_positive_number() {
        let system = DoublePendulum::UNIT;
        for (horizon, error) in [(0.0, 1e-6), (-1.0, 1e-6), (1.0, 0.0), (f64::NAN, 1.0), (1.0, f64::INFINITY)]
        {
            let refusal = refusal(&system, system.horizontal(), horizon, error);
            assert!(matches!(refusal, ProposalError::Wanted { .. }));
        }
    }

    #[test]
    fn a_start_beside_the_constraints() {
        let refusal = refusal(&DoublePendulum::UNIT, Start { q: [2.0; 4], v: [0.0; 4] }, 1.0, 1e-6);
        assert!(matches!(refusal, ProposalError::Start(_)));
    }

    #[test]
    fn an_error_below_round_off() {
        let system = DoublePendulum::UNIT;
        let refusal = refusal(&system, system.horizontal(), 2.0, 1e-17);
        let ProposalError::RoundOff { reached, .. } = refusal else { panic!("{refusal}") };
        assert!(reached < 1e-12);
    }

    /// Chaos: the error of the first steps says nothing of that at the end.
    #[test]
    fn an_error_that_grows_faster_than_time() {
        let system = DoublePendulum::UNIT;
        let refusal = refusal(&system, system.horizontal(), 1e4, 1e-6);
        assert!(matches!(refusal, ProposalError::Growth { .. }), "{refusal}");
    }

    /// A bead at the end of its rail, where the force is infinite.
    #[derive(Clone, Copy, MechanicalSystem)]
    #[evi(coordinates(x), kinetic = 0.5 * m * der(x).powi(2), potential = k * x.sqrt())]
    struct Well {
        m: f64,
        k: f64,
    }

    #[test]
    fn a_motion_without_a_first_step() {
        let refusal = refusal(&Well { m: 1.0, k: 3.0 }, Start { q: [0.0], v: [1.0] }, 1.0, 1e-6);
        assert!(matches!(refusal, ProposalError::Step { .. }), "{refusal}");
    }
}
