//! Constraints that follow from others: refused by name, or integrated where that is stated, like the scene without them.

use evi_core::baseline::{ImplicitMidpoint, Rattle, Rk4};
use evi_core::integrator::{ConstraintLabel, OfRank};
use evi_core::mechanics::Mechanics;
use evi_core::prelude::*;
use evi_examples::DoublePendulum;
use evi_tests::largest_difference;
use nalgebra::DMatrix;

const G: f64 = 9.81;

/// The double pendulum, each rod twice: the outer one in another unit, the inner one of a length of its own, which may grow.
#[derive(MechanicalSystem, Clone, Copy)]
#[evi(
    coordinates(x1, y1, x2, y2),
    kinetic   = 0.5 * m1 * (der(x1).powi(2) + der(y1).powi(2))
              + 0.5 * m2 * (der(x2).powi(2) + der(y2).powi(2)),
    potential = g * (m1 * y1 + m2 * y2),
    constraint(rod1: x1.powi(2) + y1.powi(2) == l1.powi(2)),
    constraint(rod2: (x2 - x1).powi(2) + (y2 - y1).powi(2) == l2.powi(2)),
    constraint(again1: x1.powi(2) + y1.powi(2) == (again + growth * t.powi(2)).powi(2)),
    constraint(again2: unit * ((x2 - x1).powi(2) + (y2 - y1).powi(2)) == unit * l2.powi(2)),
)]
struct HeldTwice {
    m1: f64,
    m2: f64,
    l1: f64,
    l2: f64,
    g: f64,
    again: f64,
    growth: f64,
    unit: f64,
}

const ONCE: DoublePendulum = DoublePendulum { m1: 1.0, m2: 0.5, l1: 1.0, l2: 0.8, g: G };
const TWICE: HeldTwice =
    HeldTwice { m1: 1.0, m2: 0.5, l1: 1.0, l2: 0.8, g: G, again: 1.0, growth: 0.0, unit: 1.0 };
/// Rods at 3-4-5 triangles.
const BENT: [f64; 4] = [0.6, -0.8, 1.08, -1.44];

/// A platform on three parallel cranks; its ends are the coordinates, the third crank holds it in the fraction `at` of its length.
#[derive(MechanicalSystem, Clone, Copy)]
#[evi(
    coordinates(x1, y1, x2, y2),
    kinetic   = 0.5 * m1 * (der(x1).powi(2) + der(y1).powi(2))
              + 0.5 * m2 * (der(x2).powi(2) + der(y2).powi(2)),
    potential = g * (m1 * y1 + m2 * y2),
    constraint(left: x1.powi(2) + y1.powi(2) == l.powi(2)),
    constraint(right: (x2 - d).powi(2) + y2.powi(2) == l.powi(2)),
    constraint(platform: (x2 - x1).powi(2) + (y2 - y1).powi(2) == d.powi(2)),
    constraint(middle: (x1 + at * (x2 - x1) - at * d).powi(2) + (y1 + at * (y2 - y1)).powi(2) == third.powi(2)),
)]
struct Parallelogram {
    m1: f64,
    m2: f64,
    l: f64,
    d: f64,
    g: f64,
    at: f64,
    third: f64,
}

const OVERCONSTRAINED: Parallelogram =
    Parallelogram { m1: 1.0, m2: 0.4, l: 0.8, d: 1.5, g: G, at: 0.3, third: 0.8 };
const CRANKED: [f64; 4] = [0.48, -0.64, 1.98, -0.64];

/// The platform on two cranks.
#[derive(MechanicalSystem, Clone, Copy)]
#[evi(
    coordinates(x1, y1, x2, y2),
    kinetic   = 0.5 * m1 * (der(x1).powi(2) + der(y1).powi(2))
              + 0.5 * m2 * (der(x2).powi(2) + der(y2).powi(2)),
    potential = g * (m1 * y1 + m2 * y2),
    constraint(left: x1.powi(2) + y1.powi(2) == l.powi(2)),
    constraint(right: (x2 - d).powi(2) + y2.powi(2) == l.powi(2)),
    constraint(platform: (x2 - x1).powi(2) + (y2 - y1).powi(2) == d.powi(2)),
)]
struct TwoCranks {
    m1: f64,
    m2: f64,
    l: f64,
    d: f64,
    g: f64,
}

const TWO_CRANKS: TwoCranks = TwoCranks { m1: 1.0, m2: 0.4, l: 0.8, d: 1.5, g: G };

/// A bead that two nearly parallel planes hold on their common line, `angle` apart.
#[derive(MechanicalSystem, Clone, Copy)]
#[evi(
    coordinates(x, y, z),
    kinetic = 0.5 * m * (der(x).powi(2) + der(y).powi(2) + der(z).powi(2)),
    potential = m * g * (y + x + 0.5 * z.powi(2)),
    constraint(plane: x == 0.0),
    constraint(tilted: angle.cos() * x + angle.sin() * y == 0.0),
)]
struct Wedge {
    m: f64,
    g: f64,
    angle: f64,
}

fn start<S, F>(simulation: &Simulation<S, F>, q: [f64; 4]) -> Result<Run<S, F::Step>, StartError>
where
    S: MechanicalSystem<PerCoordinate<f64> = [f64; 4]>,
    F: Scheme<S>,
{
    simulation.start(q, [0.0; 4])
}

/// The largest difference of positions over steps of two runs from rest.
#[track_caller]
fn difference<A, B, F>(one: Simulation<A, F>, other: Simulation<B, F>, q: [f64; 4], steps: usize) -> f64
where
    A: MechanicalSystem<PerCoordinate<f64> = [f64; 4]>,
    B: MechanicalSystem<PerCoordinate<f64> = [f64; 4]>,
    F: Scheme<A> + Scheme<B>,
{
    let mut one = start(&one, q).expect("consistent");
    let mut other = start(&other, q).expect("consistent");
    let mut largest = 0.0_f64;
    for _ in 0..steps {
        one.advance().expect("solvable");
        other.advance().expect("solvable");
        largest = largest.max(largest_difference(one.state().q(), other.state().q()));
    }
    let moved = largest_difference(one.state().q(), &q);
    assert!(moved > 0.01, "nothing moves: {moved:e}");
    println!("positions differ by {largest:.2e}");
    largest
}

mod motion {
    use super::*;

    /// 0.1 rad from hanging, where the motion is regular.
    const MILD: [f64; 4] = [0.28, -0.96, 0.504, -1.728];

    /// Round-off of 1,000 steps, which takes another way through another elimination: 4e-15 measured.
    const SAME: f64 = 1e-13;

    #[test]
    fn of_a_double_pendulum_held_twice_is_that_of_one_held_once() {
        for unit in [1.0, 1e6] {
            let twice =
                Simulation::new(HeldTwice { unit, ..TWICE }, Evi::midpoint(0.01)).constraints_of_rank::<2>();
            assert!(difference(twice, Simulation::new(ONCE, Evi::midpoint(0.01)), MILD, 1_000) <= SAME);
        }
    }

    #[test]
    fn on_other_nodes_and_curves_composed_and_back_in_time() {
        let twice = |scheme| Simulation::new(TWICE, scheme).constraints_of_rank::<2>();
        let simpson = Evi::simpson(0.01).frequency(3.13);
        assert!(difference(twice(simpson), Simulation::new(ONCE, simpson), MILD, 1_000) <= SAME);
        let order_4 = Evi::midpoint(-0.02).composed(Composition::suzuki_4());
        let twice = Simulation::new(TWICE, order_4).constraints_of_rank::<2>();
        assert!(difference(twice, Simulation::new(ONCE, order_4), MILD, 200) <= SAME);
    }

    #[test]
    fn of_a_platform_on_three_cranks_is_that_on_two() {
        let three = Simulation::new(OVERCONSTRAINED, Evi::midpoint(0.01)).constraints_of_rank::<3>();
        let two = Simulation::new(TWO_CRANKS, Evi::midpoint(0.01));
        assert!(difference(three, two, CRANKED, 1_000) <= SAME);
    }

    #[test]
    fn of_independent_constraints_is_what_it_was() {
        let stated = Simulation::new(ONCE, Evi::midpoint(0.01)).constraints_of_rank::<2>();
        assert!(difference(stated, Simulation::new(ONCE, Evi::midpoint(0.01)), MILD, 1_000) <= SAME);
    }

    /// Index-1 methods know the constraint forces alone.
    #[test]
    fn by_other_methods() {
        let twice = Simulation::new(TWICE, Rk4::new(0.01)).constraints_of_rank::<2>();
        assert!(difference(twice, Simulation::new(ONCE, Rk4::new(0.01)), MILD, 200) <= SAME);
        let twice = Simulation::new(TWICE, ImplicitMidpoint::new(0.01)).constraints_of_rank::<2>();
        assert!(difference(twice, Simulation::new(ONCE, ImplicitMidpoint::new(0.01)), MILD, 200) <= SAME);
    }

    #[test]
    fn keeps_every_constraint() {
        let simulation = Simulation::new(OVERCONSTRAINED, Evi::midpoint(0.01)).constraints_of_rank::<3>();
        let mut run = start(&simulation, CRANKED).unwrap();
        let (mut positions, mut velocities) = (0.0_f64, 0.0_f64);
        for _ in 0..1_000 {
            let state = run.advance().expect("solvable").clone();
            let residuals = run.mechanics().constraint_residual(&state);
            positions = residuals.iter().fold(positions, |x, y| x.max(y.abs()));
            let residuals = run.mechanics().hidden_constraint_residual(&state);
            velocities = residuals.iter().fold(velocities, |x, y| x.max(y.abs()));
        }
        println!("constraints {positions:.1e}, hidden constraints {velocities:.1e}");
        // A few roundings of squares of size 4; the third crank's follow from three others.
        assert!(positions <= 1e-14 && velocities <= 1e-13, "{positions:e} {velocities:e}");
    }
}

mod multipliers {
    use super::*;

    #[test]
    fn are_half_each_where_a_constraint_is_written_twice() {
        let simulation = Simulation::new(TWICE, Evi::midpoint(0.01)).constraints_of_rank::<2>();
        let mut run = start(&simulation, BENT).unwrap();
        run.advance_to(1.0).unwrap();
        let state = run.state().clone();
        let [rod1, rod2, again1, again2] =
            run.mechanics().acceleration(state.t(), state.q(), state.v()).unwrap().multipliers;
        let [once1, once2] =
            Mechanics::new(&ONCE).acceleration(state.t(), state.q(), state.v()).unwrap().multipliers;
        println!("{rod1} {again1} of {once1}, {rod2} {again2} of {once2}");
        for (half, whole) in [(rod1, once1), (again1, once1), (rod2, once2), (again2, once2)] {
            assert!((half - 0.5 * whole).abs() <= 1e-14 * whole.abs(), "{half} of {whole}");
        }
    }

    #[test]
    fn share_the_force_whatever_the_unit() {
        let simulation =
            Simulation::new(HeldTwice { unit: 1e6, ..TWICE }, Evi::midpoint(0.01)).constraints_of_rank::<2>();
        let run = start(&simulation, BENT).unwrap();
        let state = run.state();
        let [_, rod2, _, again2] =
            run.mechanics().acceleration(0.0, state.q(), state.v()).unwrap().multipliers;
        assert!((rod2 - 1e6 * again2).abs() <= 1e-14 * rod2.abs(), "{rod2} {again2}");
    }

    /// Against the pseudoinverse of nalgebra.
    #[test]
    fn of_an_overconstrained_loop_have_the_least_norm_of_forces() {
        let run =
            start(&Simulation::new(OVERCONSTRAINED, Evi::midpoint(0.01)).constraints_of_rank::<3>(), CRANKED);
        let run = run.unwrap();
        let three = run.mechanics().acceleration(0.0, &CRANKED, &[0.0; 4]).unwrap();
        let two = Mechanics::new(&TWO_CRANKS).acceleration(0.0, &CRANKED, &[0.0; 4]).unwrap();
        assert!(largest_difference(&three.acceleration, &two.acceleration) < 1e-14);
        let [x1, y1, x2, y2] = CRANKED;
        let (at, d) = (0.3, 1.5);
        let middle = [x1 + at * (x2 - x1) - at * d, y1 + at * (y2 - y1)];
        let gradients = [
            [2.0 * x1, 2.0 * y1, 0.0, 0.0],
            [0.0, 0.0, 2.0 * (x2 - d), 2.0 * y2],
            [2.0 * (x1 - x2), 2.0 * (y1 - y2), 2.0 * (x2 - x1), 2.0 * (y2 - y1)],
            [
                2.0 * (1.0 - at) * middle[0],
                2.0 * (1.0 - at) * middle[1],
                2.0 * at * middle[0],
                2.0 * at * middle[1],
            ],
        ];
        let masses = [1.0_f64, 1.0, 0.4, 0.4];
        let scaled = DMatrix::from_fn(4, 4, |i, c| gradients[c][i] / masses[i].sqrt());
        let lengths: Vec<f64> = (0..4).map(|c| scaled.column(c).norm()).collect();
        let unit = DMatrix::from_fn(4, 4, |i, c| scaled[(i, c)] / lengths[c]);
        let force = DMatrix::from_fn(4, 1, |i, _| (0..3).map(|c| scaled[(i, c)] * two.multipliers[c]).sum());
        let least = unit.pseudo_inverse(1e-12).unwrap() * force;
        let expected: Vec<f64> = (0..4).map(|c| least[c] / lengths[c]).collect();
        println!("{:?} {expected:?}", three.multipliers);
        assert!(largest_difference(&three.multipliers, &expected) < 1e-13);
        assert!(expected.iter().filter(|x| x.abs() > 0.1).count() >= 3, "the loop shares no force");
    }
}

mod rank {
    use super::*;

    #[test]
    fn is_reported_with_singular_values_and_names() {
        let rank = Mechanics::new(&HeldTwice { unit: 1e6, ..TWICE }).constraint_rank(0.0, &BENT);
        println!("{rank}");
        assert_eq!((rank.rank(), rank.dependent().to_string()), (2, "`again1`, `again2`".to_string()));
        let values = rank.singular_values();
        // Two pairs of forces at one angle, and what is left of the pairs.
        assert!(values[0] >= values[1] && values[1] > 0.1 && values[2] < 1e-15, "{values:?}");
        assert!((values.iter().map(|x| x * x).sum::<f64>() - 4.0).abs() < 1e-14);
        let rank = Mechanics::new(&OVERCONSTRAINED).constraint_rank(0.0, &CRANKED);
        println!("{rank}");
        assert_eq!((rank.rank(), rank.dependent().names().collect::<Vec<_>>()), (3, vec!["middle"]));
        assert_eq!(Mechanics::new(&ONCE).constraint_rank(0.0, &BENT).rank(), 2);
    }

    #[track_caller]
    fn check<S, F>(simulation: Simulation<S, F>, q: [f64; 4], words: &[&str]) -> StartError
    where
        S: MechanicalSystem<PerCoordinate<f64> = [f64; 4]>,
        F: Scheme<S>,
    {
        let error = start(&simulation, q).err().expect("refused");
        let text = error.to_string();
        println!("{text}");
        assert!(words.iter().all(|word| text.contains(word)), "{text}");
        error
    }

    #[test]
    fn below_the_number_of_constraints_is_refused_by_name_with_what_to_do() {
        let error = check(
            Simulation::new(TWICE, Evi::midpoint(0.01)),
            BENT,
            &["of 4 constraints 2 are independent", "`again1`, `again2`", "constraints_of_rank::<2>()"],
        );
        let StartError::DependentConstraints {
            rank: 2, constraints: 4, smallest_kept, largest_dropped, ..
        } = error
        else {
            panic!("{error:?}");
        };
        assert!(smallest_kept > 0.1 && largest_dropped < 1e-15);
        let words = ["of 4 constraints 3 are independent", "`middle`"];
        check(Simulation::new(OVERCONSTRAINED, Evi::midpoint(0.01)), CRANKED, &words);
        check(Simulation::new(OVERCONSTRAINED, Rattle::new(0.01)), CRANKED, &words);
        check(Simulation::new(OVERCONSTRAINED, Galerkin::<2>::new(0.01)), CRANKED, &words);
        // The same where the start has to be projected first.
        let simulation = Simulation::new(TWICE, Evi::midpoint(0.01));
        let error = simulation.start_projected(0.0, [0.6, -0.8, 1.08, -1.45], [0.0; 4]).err().unwrap();
        assert!(matches!(error, StartError::DependentConstraints { rank: 2, .. }), "{error:?}");
    }

    #[test]
    fn other_than_stated_is_refused() {
        let three = Simulation::new(TWICE, Evi::midpoint(0.01)).constraints_of_rank::<3>();
        let error = check(three, BENT, &["rank 3 are stated, 2 are independent", "`again2`"]);
        assert!(matches!(error, StartError::Rank { stated: 3, rank: 2, .. }));
        let one = Simulation::new(TWICE, Evi::midpoint(0.01)).constraints_of_rank::<1>();
        check(one, BENT, &["rank 1 are stated, 2 are independent"]);
    }

    /// Stretched out, the outer crank and the platform pull along one line.
    #[test]
    fn that_falls_on_the_way_ends_the_run() {
        let folding = |q: [f64; 4], v: [f64; 4]| {
            Simulation::new(OVERCONSTRAINED, Evi::midpoint(0.01)).constraints_of_rank::<3>().start(q, v)
        };
        let flat = folding([0.8, 0.0, 2.3, 0.0], [0.0; 4]).err().expect("a singular configuration");
        assert!(matches!(flat, StartError::Rank { stated: 3, rank: 2, .. }), "{flat:?}");
    }

    #[test]
    fn schemes_that_cannot_share_forces_refuse() {
        check(Simulation::new(TWICE, Rattle::new(0.01)).constraints_of_rank::<2>(), BENT, &["RATTLE"]);
        let galerkin = Simulation::new(TWICE, Galerkin::<3>::new(0.01)).constraints_of_rank::<2>();
        check(galerkin, BENT, &["Galerkin needs", "constraints that are independent"]);
        let matrix = Simulation::new(TWICE, Evi::trapezoid(0.01).linearised_at([0.0, -1.0, 0.0, -1.8]));
        let error = check(matrix.constraints_of_rank::<2>(), BENT, &[]);
        assert!(matches!(error, StartError::Scheme(_)), "{error:?}");
    }
}

mod contradictions {
    use super::*;

    #[test]
    fn of_lengths_are_refused_with_the_residual() {
        let twice = HeldTwice { again: 1.1, ..TWICE };
        let simulation = Simulation::new(twice, Evi::midpoint(0.01)).constraints_of_rank::<2>();
        for error in [
            start(&simulation, BENT).err().unwrap(),
            simulation.start_projected(0.0, BENT, [0.0; 4]).err().unwrap(),
        ] {
            let StartError::ContradictoryConstraints { constraint, residual, allowed } = error else {
                panic!("{error:?}");
            };
            println!("{error}");
            assert_eq!(constraint, ConstraintLabel::Name("again1"));
            assert!((residual + 0.21).abs() < 1e-14 && allowed < 1e-11, "{error}");
        }
        // Beside agreeing constraints, a start is beside the constraints and nothing else.
        let agreeing = Simulation::new(TWICE, Evi::midpoint(0.01)).constraints_of_rank::<2>();
        let error = start(&agreeing, [0.6, -0.8, 1.08, -1.45]).err().unwrap();
        assert!(matches!(error, StartError::InconsistentPosition { .. }), "{error:?}");
        assert!(agreeing.start_projected(0.0, [0.6, -0.8, 1.08, -1.45], [0.0; 4]).is_ok());
    }

    #[test]
    fn that_begin_at_the_start_are_refused_by_its_velocity() {
        let growing = HeldTwice { growth: 0.1, again: 0.9, ..TWICE };
        let simulation = Simulation::new(growing, Evi::midpoint(0.01)).constraints_of_rank::<2>();
        let error = simulation.start_at(1.0, BENT, [0.0; 4]).err().unwrap();
        assert!(matches!(error, StartError::InconsistentVelocity { .. }), "{error:?}");
    }

    #[test]
    fn on_the_way_end_the_run_where_it_stands() {
        // Of position and velocity at the start nothing tells.
        let growing = HeldTwice { growth: 1e-10, ..TWICE };
        let simulation = Simulation::new(growing, Evi::midpoint(0.01)).constraints_of_rank::<2>();
        let mut run = start(&simulation, BENT).expect("consistent within its digits");
        let error = loop {
            let before = run.state().clone();
            match run.advance() {
                Ok(_) => assert!(run.state().t() < 1.0, "no contradiction found"),
                Err(error) => {
                    assert_eq!(run.state(), &before);
                    break error;
                }
            }
        };
        println!("{error}");
        let StepError::ContradictoryConstraints { constraint, residual, allowed, .. } = error else {
            panic!("{error:?}");
        };
        assert_eq!(constraint, ConstraintLabel::Name("again1"));
        assert!(residual.abs() > allowed && allowed > 0.0 && run.steps() > 1);
    }
}

mod nearly_dependent {
    use super::*;

    fn wedge(angle: f64) -> Simulation<Wedge, Evi<1>> {
        Simulation::new(Wedge { m: 2.0, g: G, angle }, Evi::midpoint(0.01))
    }

    #[test]
    fn constraints_are_refused_or_solved_without_squaring_their_angle() {
        let angle = 1e-8_f64;
        let rank = Mechanics::new(&Wedge { m: 2.0, g: G, angle }).constraint_rank(0.0, &[0.0; 3]);
        println!("{rank}");
        assert_eq!(rank.rank(), 2);
        let error = wedge(angle).start([0.0, 0.0, 0.3], [0.0; 3]).err().expect("squares are round-off");
        println!("{error}");
        let StartError::NearlyDependentConstraints { constraint, rank: 2, smallest } = error else {
            panic!("{error:?}");
        };
        assert_eq!(constraint, ConstraintLabel::Name("tilted"));
        assert!((smallest / (0.5 * angle) - 1.0).abs() < 1e-6, "{smallest:e}");

        let mut run = wedge(angle).constraints_of_rank::<2>().start([0.0, 0.0, 0.3], [0.0; 3]).unwrap();
        run.advance_to(1.0).expect("solvable");
        let mut right = wedge(0.5 * std::f64::consts::PI).start([0.0, 0.0, 0.3], [0.0; 3]).unwrap();
        right.advance_to(1.0).unwrap();
        let ([x, y, z], expected) = (*run.state().q(), right.state().q()[2]);
        println!("x = {x:e}, y = {y:e}, z off by {:e}", z - expected);
        // Along the planes nothing is lost, across them what round-off over the angle leaves.
        assert!((z - expected).abs() < 1e-14 && x.abs() < 1e-15 && y.abs() < 1e-8);
        let state = run.state().clone();
        let [plane, tilted] =
            run.mechanics().acceleration(state.t(), state.q(), state.v()).unwrap().multipliers;
        // m g (1, 1) + (plane + cos tilted, sin tilted) = 0.
        let force = 2.0 * G;
        println!("{plane:e} {tilted:e}");
        assert!((tilted * angle.sin() / force + 1.0).abs() < 1e-7 && (plane / tilted + 1.0).abs() < 1e-7);
    }

    #[test]
    fn an_angle_within_the_tolerance_of_a_start_is_none() {
        let rank = Mechanics::new(&Wedge { m: 2.0, g: G, angle: 1e-12 }).constraint_rank(0.0, &[0.0; 3]);
        assert_eq!(rank.rank(), 1);
        let error = wedge(1e-12).start([0.0; 3], [0.0; 3]).err().unwrap();
        assert!(matches!(error, StartError::DependentConstraints { rank: 1, .. }), "{error:?}");
    }
}

/// What is stated is a type: `OfRank(scene)` is a scene like any other.
#[test]
fn a_scene_of_stated_rank_is_a_scene() {
    let simulation = Simulation::new(OfRank::<_, 2>(TWICE), Evi::midpoint(0.01));
    let mut run = start(&simulation, BENT).unwrap();
    let trajectory = run.integrate(0.1).expect("solvable");
    assert_eq!(trajectory.states().len(), 11);
    assert_eq!(<OfRank<HeldTwice, 2> as MechanicalSystem>::CONSTRAINTS, HeldTwice::CONSTRAINTS);
}
