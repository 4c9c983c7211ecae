//! Positions eliminated: a scene's own eliminations against pivoted dense ones, and the folded step of a quadratic
//! Lagrangian against the general step.

use evi_core::linear::{Factorization, Guarded};
use evi_core::prelude::*;
use evi_examples::{DoublePendulum, Start};
use evi_tests::{Random, largest_difference};

/// Four links in the plane and a spring between the first and the last bob, with more potential energy.
macro_rules! chain {
    ($name:ident, $($potential:tt)*) => {
        #[derive(MechanicalSystem, Clone, Copy)]
        #[evi(
            coordinates(x1, y1, x2, y2, x3, y3, x4, y4),
            kinetic = 0.5 * m1 * (der(x1).powi(2) + der(y1).powi(2)) + 0.5 * m2 * (der(x2).powi(2) + der(y2).powi(2))
                    + 0.5 * m1 * (der(x3).powi(2) + der(y3).powi(2)) + 0.5 * m2 * (der(x4).powi(2) + der(y4).powi(2)),
            potential = 9.81 * (m1 * y1 + m2 * y2 + m1 * y3 + m2 * y4)
                    + 0.5 * k * ((x4 - x1).powi(2) + (y4 - y1).powi(2)) $($potential)*,
            constraint(link1: x1.powi(2) + y1.powi(2) == 1.0),
            constraint(link2: (x2 - x1).powi(2) + (y2 - y1).powi(2) == 1.0),
            constraint(link3: (x3 - x2).powi(2) + (y3 - y2).powi(2) == 1.0),
            constraint(link4: (x4 - x3).powi(2) + (y4 - y3).powi(2) == 1.0),
        )]
        struct $name {
            m1: f64,
            m2: f64,
            k: f64,
            quartic: f64,
        }
    };
}

// A scene with `quartic = 0` moves as one whose Lagrangian is quadratic, but its steps are not folded.
chain!(QuadraticChain, + 0.0 * quartic);
chain!(Chain, + quartic * (x1.powi(4) + y4.powi(4)));

/// A saddle-point matrix with the pattern of the chain: couplings within a bob and between bobs 1 and 4.
fn saddle_point(random: &mut Random, inertia: impl Fn(usize) -> f64) -> [[f64; 12]; 12] {
    let mut matrix = [[0.0; 12]; 12];
    for i in 0..8 {
        matrix[i][i] = inertia(i);
    }
    for axis in 0..2 {
        let coupling = 0.1 * random.between(-1.0, 1.0) * (inertia(axis) * inertia(6 + axis)).sqrt();
        matrix[axis][6 + axis] = coupling;
        matrix[6 + axis][axis] = coupling;
    }
    for entry in Chain::STRUCTURE.jacobian.q {
        // Unlike on both sides, as at the start and the end of a step.
        matrix[entry.col][8 + entry.row] = 1.0 + random.between(-1.0, 1.0);
        matrix[8 + entry.row][entry.col] =
            matrix[entry.col][8 + entry.row] * (1.0 + 0.1 * random.between(-1.0, 1.0));
    }
    matrix
}

/// The solution of the system, and how well it satisfies it: `max |K x − b| / (max |K| max |x|)`.
fn solved<F>(matrix: &[[f64; 12]; 12], rhs: &[f64; 12]) -> (F, f64)
where
    F: Factorization<[f64; 12], [[f64; 12]; 12]>,
{
    let factors = F::factor(matrix).expect("the matrix is regular");
    let mut x = *rhs;
    factors.solve(&mut x);
    let mut residual = 0.0_f64;
    for row in 0..12 {
        let terms = || (0..12).map(|col| matrix[row][col] * x[col]);
        let scale: f64 = terms().map(f64::abs).sum::<f64>() + rhs[row].abs();
        residual = residual.max((terms().sum::<f64>() - rhs[row]).abs() / scale);
    }
    (factors, residual)
}

type Own = <Chain as MechanicalSystem>::KktFactors;

#[test]
fn own_elimination_of_well_scaled_matrices_is_backward_stable() {
    let mut random = Random::new(1);
    let mut largest = 0.0_f64;
    for _ in 0..1_000 {
        let matrix = saddle_point(&mut random, |i| 1.0 + 0.3 * (i as f64).sin());
        let rhs = random.array(-1.0, 1.0);
        let (own, residual) = solved::<Own>(&matrix, &rhs);
        assert!(matches!(own, Guarded::Own(_)));
        assert!(residual.is_finite());
        largest = largest.max(residual);
    }
    println!("own elimination: {:.0} ε", largest / f64::EPSILON);
    // Row by row, against the row's terms: pivots may lose digits, here up to 244 ε.
    assert!(largest < 1000.0 * f64::EPSILON, "{largest:e}");
}

#[test]
fn a_pivot_that_is_round_off_falls_back_on_pivoting() {
    let mut random = Random::new(3);
    let rhs = random.array(-1.0, 1.0);
    let mut matrix = saddle_point(&mut random, |_| 1.0);
    // The first bob moves with the last: their two by two block is singular but for the constraints.
    for (row, col) in [(0, 0), (0, 6), (6, 0), (6, 6)] {
        matrix[row][col] = 1.0;
    }
    matrix[6][6] += 1e-13;
    let (own, residual) = solved::<Own>(&matrix, &rhs);
    assert!(matches!(own, Guarded::Dense(_)));
    assert!(residual < 1e-13, "{residual:e}");
}

#[test]
fn a_singular_matrix_is_reported_by_the_fallback() {
    let mut matrix = saddle_point(&mut Random::new(4), |_| 1.0);
    matrix[9] = matrix[8];
    for row in 0..12 {
        matrix[row][9] = matrix[row][8];
    }
    let singular = Own::factor(&matrix).err().expect("two constraints are one");
    assert!(singular.pivot_ratio < 1e-14, "{singular}");
}

/// Two bobs without springs, every matrix of whose step is diagonal, and the same with a vanishing quartic potential.
macro_rules! double_pendulum {
    ($name:ident, $($potential:tt)*) => {
        #[derive(MechanicalSystem, Clone, Copy)]
        #[evi(
            coordinates(x1, y1, x2, y2),
            kinetic = 0.5 * m1 * (der(x1).powi(2) + der(y1).powi(2)) + 0.5 * m2 * (der(x2).powi(2) + der(y2).powi(2)),
            potential = 9.81 * (m1 * y1 + m2 * y2) + 0.5 * k * x2.powi(2) $($potential)*,
            constraint(rod1: x1.powi(2) + y1.powi(2) == 1.0),
            constraint(rod2: (x2 - x1).powi(2) + (y2 - y1).powi(2) == 0.49),
        )]
        struct $name {
            m1: f64,
            m2: f64,
            k: f64,
            quartic: f64,
        }
    };
}

double_pendulum!(QuadraticPendulum, + 0.0 * quartic);
double_pendulum!(QuarticPendulum, + quartic * x1.powi(4));

/// Both scenes move alike over one unit of time.
#[track_caller]
fn check_alike<const N: usize, A, B, F>(folded: A, general: B, scheme: F, start: [f64; N])
where
    A: MechanicalSystem<PerCoordinate<f64> = [f64; N]>,
    B: MechanicalSystem<PerCoordinate<f64> = [f64; N]>,
    F: Scheme<A> + Scheme<B> + Copy,
{
    assert!(A::STRUCTURE.hessian.is_constant() && !B::STRUCTURE.hessian.is_constant());
    let mut folded = Simulation::new(folded, scheme).start(start, [0.0; N]).expect("consistent");
    let mut general = Simulation::new(general, scheme).start(start, [0.0; N]).expect("consistent");
    let mut largest = 0.0_f64;
    for _ in 0..100 {
        let (folded, general) = (folded.advance().expect("solvable"), general.advance().expect("solvable"));
        let difference =
            largest_difference(folded.q(), general.q()).max(largest_difference(folded.v(), general.v()));
        assert!(difference.is_finite());
        largest = largest.max(difference);
    }
    println!("{}: {largest:.1e}", core::panic::Location::caller());
    // Round-off of 100 steps with velocities of size 5, grown by the motion: 8e-14 with springs, 1e-14 without.
    assert!(largest < 2e-13, "{largest:e}");
    assert!(largest_difference(folded.state().q(), &start) > 0.1, "the motion is not vacuous");
}

#[track_caller]
fn check_schemes<const N: usize, A, B>(folded: A, general: B, start: [f64; N])
where
    A: MechanicalSystem<PerCoordinate<f64> = [f64; N], PerCoordinate<Frequency> = [Frequency; N]> + Copy,
    B: MechanicalSystem<PerCoordinate<f64> = [f64; N], PerCoordinate<Frequency> = [Frequency; N]> + Copy,
{
    let h = 0.01;
    let mixed = core::array::from_fn(|i| Frequency::from(1.0 + (i / 2) as f64));
    check_alike(folded, general, Evi::midpoint(h), start);
    check_alike(folded, general, Evi::simpson(h), start);
    check_alike(folded, general, Evi::new(Quadrature::<2>::lobatto(), h), start);
    check_alike(folded, general, Evi::midpoint(h).frequency(3.0), start);
    check_alike(folded, general, Evi::simpson(h).frequency(Frequency::Hyperbolic(2.0)), start);
    check_alike(folded, general, Evi::simpson(h).frequencies(mixed), start);
    check_alike(folded, general, Evi::simpson(-h).frequencies(mixed), start);
}

#[test]
fn folded_and_general_step_agree_where_nothing_is_coupled() {
    let (m1, m2, k, quartic) = (1.3, 0.7, 2.0, 0.0);
    let (folded, general) =
        (QuadraticPendulum { m1, m2, k, quartic }, QuarticPendulum { m1, m2, k, quartic });
    check_schemes(folded, general, [0.6, -0.8, 1.3, -0.8]);
}

#[test]
fn folded_and_general_step_agree_where_a_spring_couples_coordinates() {
    let (m1, m2, k, quartic) = (1.3, 0.7, 20.0, 0.0);
    let (folded, general) = (QuadraticChain { m1, m2, k, quartic }, Chain { m1, m2, k, quartic });
    check_schemes(folded, general, [0.6, -0.8, 1.6, -0.8, 1.6, -1.8, 2.4, -2.4]);
}

#[test]
fn the_impulses_of_earlier_steps_are_a_first_guess_only() {
    let pendulum = QuadraticPendulum { m1: 1.3, m2: 0.7, k: 2.0, quartic: 0.0 };
    let simulation = Simulation::new(pendulum, Evi::midpoint(0.01));
    let mut run = simulation.start([0.6, -0.8, 1.3, -0.8], [0.0; 4]).expect("consistent");
    run.advance_to(1.0).expect("solvable");
    let (q, v) = (*run.state().q(), *run.state().v());
    let mut again = simulation.start_at(1.0, q, v).expect("a state is consistent");
    run.advance_to(2.0).expect("solvable");
    again.advance_to(2.0).expect("solvable");
    // A hundred steps that differ in their last bits.
    let difference = largest_difference(run.state().q(), again.state().q());
    println!("restarted: {difference:.1e}");
    assert!(difference < 1e-14, "{difference:e}");
}

#[test]
fn constraints_hold_where_the_frozen_matrix_is_a_bad_guess() {
    let pendulum = DoublePendulum::UNIT;
    let Start { q, v } = pendulum.horizontal();
    // Whips that turn the rods by more than a radian per step.
    let mut run = Simulation::new(pendulum, Evi::midpoint(0.1)).start(q, v).expect("consistent");
    for _ in 0..100 {
        run.advance().expect("solvable without frequency");
        let residual = run.mechanics().constraint_residual(run.state());
        // Round-off of squares of coordinates up to 2: 3 ε measured.
        assert!(residual.iter().all(|residual| residual.abs() <= 8.0 * f64::EPSILON), "{residual:?}");
    }
}

/// A crank and a connecting rod whose end slides on the x axis: its coordinate y2 is zero, and so is its constraint's scale.
#[derive(MechanicalSystem, Clone, Copy)]
#[evi(
    coordinates(x1, y1, x2, y2),
    kinetic = 0.5 * m1 * (der(x1).powi(2) + der(y1).powi(2)) + 0.5 * m2 * (der(x2).powi(2) + der(y2).powi(2)),
    potential = 9.81 * (m1 * y1 + m2 * y2),
    constraint(crank: x1.powi(2) + y1.powi(2) == 0.09),
    constraint(rod: (x2 - x1).powi(2) + (y2 - y1).powi(2) == 1.0),
    constraint(slider: y2 == 0.0),
)]
struct SliderCrank {
    m1: f64,
    m2: f64,
}

#[test]
fn one_constraint_that_converges_at_once_does_not_hide_the_others() {
    let simulation = Simulation::new(SliderCrank { m1: 1.0, m2: 2.0 }, Evi::midpoint(0.01));
    // The crank turns with 8 rad/s.
    let mut run = simulation.start([0.3, 0.0, 1.3, 0.0], [0.0, 2.4, 0.0, 0.0]).expect("consistent");
    for step in 0..20_000 {
        run.advance().expect("solvable");
        let residual = run.mechanics().constraint_residual(run.state());
        // Round-off of squares of coordinates up to 1.3.
        assert!(residual.iter().all(|residual| residual.abs() <= 8.0 * f64::EPSILON), "{step}: {residual:?}");
        if step % 100 == 0 {
            let state = run.state();
            simulation.start_at(state.t(), *state.q(), *state.v()).expect("a state is a consistent start");
        }
    }
}

#[test]
fn a_velocity_that_is_round_off_is_a_consistent_start() {
    let simulation = Simulation::new(SliderCrank { m1: 1.0, m2: 2.0 }, Evi::midpoint(0.01));
    assert!(simulation.start([0.3, 0.0, 1.3, 1e-17], [0.0, 0.0, 0.0, -4e-34]).is_ok());
    assert!(simulation.start([0.3, 0.0, 1.3, 1e-14], [0.0; 4]).is_err());
    assert!(simulation.start([0.3, 0.0, 1.3, 0.0], [0.0, 0.0, 0.0, 1e-9]).is_err());
}
