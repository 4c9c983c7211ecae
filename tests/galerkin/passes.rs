//! The passes that solve Galerkin steps, a node per vector lane: the same steps as Newton's iteration on every kind of scene, what they
//! keep, and their rescue.

use evi_core::integrator::{Iteration, Statistics};
use evi_core::prelude::*;
use evi_examples::{
    AndrewsSqueezer, CarAxis, DoublePendulum, DrivenPendulum, FermiPastaUlam, Pendulum, SliderCrank,
    SphericalPendulum, Start, StiffSpringPendulum,
};
use evi_tests::agreement::roundings_between;
use evi_tests::conservation::{largest_residuals, there_and_back};
use evi_tests::scenes::{
    ChargedSphericalPendulum, DampedOscillator, DoublePendulumInAngles, KapitzaPendulum,
    KapitzaPendulumInAngle, MotorisedDoublePendulum, PushedDumbbell, RelativisticBead,
};

/// Two coupled pendulums on carts that share inertia: a constant mass matrix that is full, and two constraints.
#[derive(Clone, Copy, MechanicalSystem)]
#[evi(
    coordinates(x, y, z, w),
    kinetic = 0.5 * a * der(x).powi(2) + 0.5 * b * der(y).powi(2) + 0.5 * c * (der(z).powi(2) + der(w).powi(2))
            + d * der(x) * der(y) + d * der(y) * der(z) + 0.3 * d * der(z) * der(w),
    potential = g * (y + 2.0 * w) + 0.5 * k * (x - z).powi(2),
    constraint(near: x.powi(2) + y.powi(2) == 1.0),
    constraint(far: (z - x).powi(2) + (w - y).powi(2) == 2.0),
)]
struct SharedInertia {
    a: f64,
    b: f64,
    c: f64,
    d: f64,
    g: f64,
    k: f64,
}

const SHARED: SharedInertia = SharedInertia { a: 1.5, b: 0.9, c: 1.2, d: 0.3, g: 9.81, k: 4.0 };
const SHARED_START: Start<4> = Start { q: [0.6, -0.8, 1.6, -1.8], v: [0.0; 4] };

/// A string of five beads of unequal masses: Gram matrices that are factored within their envelope, by loops.
#[derive(Clone, Copy, MechanicalSystem)]
#[evi(
    coordinates(x1, y1, x2, y2, x3, y3, x4, y4, x5, y5),
    kinetic = 0.5 * m1 * (der(x1).powi(2) + der(y1).powi(2)) + 0.5 * m2 * (der(x2).powi(2) + der(y2).powi(2)) + 0.5 * m3 * (der(x3).powi(2) + der(y3).powi(2)) + 0.5 * m4 * (der(x4).powi(2) + der(y4).powi(2)) + 0.5 * m5 * (der(x5).powi(2) + der(y5).powi(2)),
    potential = g * (m1 * y1 + m2 * y2 + m3 * y3 + m4 * y4 + m5 * y5),
    constraint(rod1: x1.powi(2) + y1.powi(2) == 1.0),
    constraint(rod2: (x2 - x1).powi(2) + (y2 - y1).powi(2) == 1.0),
    constraint(rod3: (x3 - x2).powi(2) + (y3 - y2).powi(2) == 1.0),
    constraint(rod4: (x4 - x3).powi(2) + (y4 - y3).powi(2) == 1.0),
    constraint(rod5: (x5 - x4).powi(2) + (y5 - y4).powi(2) == 1.0),
)]
struct Beads {
    m1: f64,
    m2: f64,
    m3: f64,
    m4: f64,
    m5: f64,
    g: f64,
}

/// The double pendulum of unequal masses and lengths, on a swing of moderate size.
fn swing() -> (DoublePendulum, Start<4>) {
    let angles = DoublePendulumInAngles::UNEQUAL;
    let Start { q, v } = DoublePendulumInAngles::MODERATE;
    (angles.constrained(), angles.cartesian(q, v))
}

mod agreement {
    use super::*;

    #[track_caller]
    fn check<S, const K: usize, const N: usize>(system: S, start: Start<N>, h: f64)
    where
        S: MechanicalSystem<PerCoordinate<f64> = [f64; N]> + Clone,
    {
        let scheme = Galerkin::<K>::new(h);
        let both = [scheme, scheme.by_newton()];
        let roundings = roundings_between(&system, start, h, both, |step| step.iteration());
        // Two iterations: 5 measured.
        assert!(roundings <= 8.0, "{roundings:.0} roundings");
    }

    #[test]
    fn every_number_of_intervals() {
        let (system, start) = swing();
        check::<_, 1, 4>(system, start, 0.02);
        check::<_, 2, 4>(system, start, 0.02);
        check::<_, 3, 4>(system, start, 0.05);
        check::<_, 4, 4>(system, start, 0.05);
        check::<_, 5, 4>(system, start, 0.05);
        check::<_, 6, 4>(system, start, 0.05);
        check::<_, 7, 4>(system, start, 0.05);
        check::<_, 8, 4>(system, start, 0.05);
    }

    #[test]
    fn without_constraints() {
        let spring = StiffSpringPendulum::with_stiffness(1e3);
        check::<_, 8, 2>(spring, spring.horizontal(), 0.02);
        let chain = FermiPastaUlam::STANDARD;
        check::<_, 8, 6>(chain, chain.one_spring_excited(), 0.02);
        check::<_, 3, 1>(Pendulum { m: 1.3, l: 0.8, g: 9.81 }, Start { q: [1.0], v: [0.4] }, 0.05);
    }

    #[test]
    fn one_constraint_in_space_and_a_full_mass_matrix_with_two() {
        let spherical = SphericalPendulum::UNIT;
        check::<_, 8, 3>(spherical, spherical.one_radian(), 0.05);
        check::<_, 8, 4>(SHARED, SHARED_START, 0.05);
        check::<_, 3, 4>(SHARED, SHARED_START, 0.02);
    }

    #[test]
    fn a_string_of_beads() {
        let beads = Beads { m1: 0.7, m2: 1.1, m3: 0.4, m4: 0.9, m5: 1.6, g: 9.81 };
        let q = [0.6, -0.8, 1.2, 0.0, 1.8, -0.8, 2.4, 0.0, 3.0, -0.8];
        check::<_, 8, 10>(beads, Start { q, v: [0.0; 10] }, 0.02);
    }

    #[test]
    fn constraints_that_move() {
        let moving = KapitzaPendulum::STANDARD;
        check::<_, 5, 2>(moving, moving.near_inverted(), 0.002);
        check::<_, 8, 4>(CarAxis::STANDARD, CarAxis::STANDARD.standard_start(), 0.01);
    }

    #[test]
    fn mass_that_depends_on_the_configuration() {
        let (angles, moderate) = (DoublePendulumInAngles::UNEQUAL, DoublePendulumInAngles::MODERATE);
        check::<_, 1, 2>(angles, moderate, 0.02);
        check::<_, 8, 2>(angles, moderate, 0.05);
        check::<_, 3, 2>(MotorisedDoublePendulum::STANDARD, moderate, 0.02);
        let moving = KapitzaPendulumInAngle::of(KapitzaPendulum::STANDARD);
        check::<_, 5, 1>(moving, Start { q: [3.0], v: [0.2] }, 0.002);
    }

    #[test]
    fn mass_that_depends_on_the_configuration_with_constraints() {
        let crank = SliderCrank::STANDARD;
        check::<_, 4, 3>(crank, crank.stretched_out(15.0), 0.01);
        check::<_, 7, 3>(crank, crank.stretched_out(15.0), 0.03);
        let squeezer = AndrewsSqueezer::STANDARD;
        check::<_, 8, 7>(squeezer, squeezer.standard_start(), 6e-4);
    }

    #[test]
    fn gyroscopic_coupling_and_what_is_not_quadratic_in_the_velocity() {
        let charged = ChargedSphericalPendulum::STANDARD;
        check::<_, 8, 3>(charged, charged.one_radian(), 0.05);
        check::<_, 4, 2>(RelativisticBead::STANDARD, RelativisticBead::at_angle(1.0, -2.0), 0.02);
    }

    #[test]
    fn forces_with_velocities_and_time() {
        let driven = DrivenPendulum::STANDARD;
        check::<_, 8, 2>(driven, driven.horizontal(), 0.05);
        check::<_, 2, 2>(driven, driven.horizontal(), 0.02);
        check::<_, 4, 1>(DampedOscillator::STANDARD, Start { q: [1.0], v: [0.3] }, 0.05);
        check::<_, 6, 4>(PushedDumbbell::STANDARD, PushedDumbbell::STANDARD.turning(), 0.05);
    }
}

mod kept {
    use super::*;

    #[track_caller]
    fn check_returns<S, const K: usize, const N: usize>(system: S, start: Start<N>, h: f64)
    where
        S: MechanicalSystem<PerCoordinate<f64> = [f64; N]> + Clone,
    {
        let distance = there_and_back(system, Galerkin::<K>::new, start, h, 40);
        println!("{}: misses the start by {distance:e}", core::panic::Location::caller());
        assert!(distance <= 1e-14, "misses the start by {distance:e}");
    }

    #[test]
    fn forty_steps_back_undo_forty_steps() {
        let (system, start) = swing();
        check_returns::<_, 8, 4>(system, start, 0.05);
        check_returns::<_, 4, 4>(system, start, 0.02);
        check_returns::<_, 8, 4>(SHARED, SHARED_START, 0.02);
        let spherical = SphericalPendulum::UNIT;
        check_returns::<_, 8, 3>(spherical, spherical.one_radian(), 0.05);
        let (angles, moderate) = (DoublePendulumInAngles::UNEQUAL, DoublePendulumInAngles::MODERATE);
        check_returns::<_, 8, 2>(angles, moderate, 0.05);
        let crank = SliderCrank::STANDARD;
        check_returns::<_, 4, 3>(crank, crank.stretched_out(5.0), 0.01);
    }

    #[test]
    fn constraints_and_hidden_constraints() {
        let system = DoublePendulum::UNIT;
        let [constraint, hidden] =
            largest_residuals(system, Galerkin::<8>::new(0.05), system.horizontal(), 20_000);
        println!("φ {:.1} ε, G v {:.1} ε", constraint / f64::EPSILON, hidden / f64::EPSILON);
        // Squares of coordinates of size 1, 2.5 ε measured; projections on gradients of size 2, 1.2 ε measured.
        assert!(constraint <= 4.0 * f64::EPSILON, "φ: {constraint:e}");
        assert!(hidden <= 2.0 * f64::EPSILON, "G v: {hidden:e}");
    }
}

mod rescue {
    use super::*;

    /// Every step of the chaotic double pendulum is taken; those that passes do not find from the past are counted.
    #[track_caller]
    fn check(h: f64, steps: u64) -> Statistics {
        let system = DoublePendulum::UNIT;
        let Start { q, v } = system.horizontal();
        let run = Simulation::new(system, Galerkin::<8>::new(h)).start(q, v).expect("a start");
        let mut run = run.with_tally(Statistics::default());
        let energy = run.energy();
        for _ in 0..steps {
            run.advance().expect("every step is rescued");
        }
        let tally = *run.tally();
        println!(
            "h = {h}: {:.2} passes, {tally:?}, energy off by {:e}",
            tally.corrections as f64 / steps as f64,
            run.energy() - energy
        );
        tally
    }

    #[test]
    fn of_two_hundred_thousand_steps_of_chaos() {
        let [small, large] = [check(0.05, 200_000), check(0.06, 200_000)];
        assert!(large.restarts > 0, "vacuous: no step needs a rescue");
        assert!(small.restarts <= large.restarts);
    }

    /// Springs far too stiff for passes: Newton's iteration takes their place, and is counted.
    #[test]
    fn by_newton_where_passes_cannot_converge() {
        let spring = StiffSpringPendulum::with_stiffness(1e6);
        let Start { q, v } = spring.horizontal();
        let run = Simulation::new(spring, Galerkin::<3>::new(0.01)).start(q, v).expect("a start");
        let mut run = run.with_tally(Statistics::default());
        for _ in 0..20 {
            run.advance().expect("a step of Newton");
        }
        assert_eq!(run.tally().newton_steps, 20, "{:?}", run.tally());
    }
}

#[test]
fn the_instructions_have_a_name() {
    let (system, start) = swing();
    let run = Simulation::new(system, Galerkin::<8>::new(0.1)).start(start.q, start.v).expect("a start");
    let Iteration::Passes(instructions) = run.map().iteration() else { panic!("not by passes") };
    println!("{instructions}");
    assert!(instructions.vector_width() >= 1 && !instructions.name().is_empty());
    let mixed = Galerkin::<8>::new(0.1).frequency(3.0);
    let run = Simulation::new(system, mixed).start(start.q, start.v).expect("a start");
    assert_eq!(run.map().iteration().to_string(), "Newton's iteration");
}
