//! Steps that are found by the distance alone, beside those of the equations in all coordinates, which the pivoted dense solve finds.

use evi_core::baseline::Dense;
use evi_core::integrator::Statistics;
use evi_core::prelude::*;
use evi_examples::{GRAVITY, Kepler, Start, StiffSpringPendulum};
use evi_tests::largest_difference;

use crate::scenes::{Cup, DoubleStar, Dumbbell, Elliptic, Line, Morse, OffCentre, Softened};

/// Both paths from the start to `t`.
struct Compared {
    /// Largest difference, in positions and velocities each relative to the largest on the way, in ε.
    roundings: f64,
    /// Corrections of the reduced steps, by steps.
    corrections: f64,
}

fn compare<const N: usize, S, F>(system: S, scheme: F, start: Start<N>, steps: u64) -> Compared
where
    S: MechanicalSystem<PerCoordinate<f64> = [f64; N]> + Copy,
    F: Scheme<S> + Scheme<Dense<S>> + Copy,
{
    let run = Simulation::new(system, scheme).start(start.q, start.v).expect("a start");
    let mut reduced = run.with_tally(Statistics::default());
    let mut dense = Simulation::new(Dense(system), scheme).start(start.q, start.v).expect("a start");
    let (mut differences, mut sizes, mut travelled) = ([0.0; 2], [0.0; 2], 0.0);
    for _ in 0..steps {
        let (reduced, dense) = (reduced.advance().expect("a step"), dense.advance().expect("a step"));
        for (k, (a, b)) in [(reduced.q(), dense.q()), (reduced.v(), dense.v())].into_iter().enumerate() {
            differences[k] = larger(differences[k], largest_difference(a, b));
            sizes[k] = larger(sizes[k], largest_difference(b, &[0.0; N]));
        }
        travelled = larger(travelled, largest_difference(dense.q(), &start.q));
    }
    assert!(travelled > 0.05 * sizes[0], "the motion is not vacuous: {travelled}");
    Compared {
        roundings: larger(differences[0] / sizes[0], differences[1] / sizes[1]) / f64::EPSILON,
        corrections: reduced.tally().corrections as f64 / steps as f64,
    }
}

/// The larger of two magnitudes; NaN if one is.
fn larger(a: f64, b: f64) -> f64 {
    if a <= b || b.is_nan() { b } else { a }
}

/// Both paths agree over 100 steps to `bound` ε (round-off of 100 steps: 11 ε measured), and the reduced steps take that many corrections at most.
#[track_caller]
fn check<const N: usize, S>(system: S, h: f64, start: Start<N>, bound: f64, corrections: f64)
where
    S: MechanicalSystem<PerCoordinate<f64> = [f64; N]> + Copy,
{
    let found = compare(system, Evi::midpoint(h), start, 100);
    let at = core::panic::Location::caller();
    println!("{at}: {:.1} ε, {} corrections", found.roundings, found.corrections);
    assert!(found.roundings <= bound, "{} ε", found.roundings);
    assert!(found.corrections > 0.0 && found.corrections <= corrections, "{}", found.corrections);
}

pub(crate) const OFF_CENTRE: OffCentre = OffCentre { m: 0.7, k: 40.0, l: 0.6, a: 0.4, b: -0.3, g: GRAVITY };
pub(crate) const SWING: Start<2> = Start { q: [1.1, -0.2], v: [0.3, -1.4] };
pub(crate) const DUMBBELL: Dumbbell = Dumbbell { m1: 1.3, m2: 0.4, k: 90.0, l: 0.8, g: GRAVITY };
pub(crate) const TUMBLE: Start<6> =
    Start { q: [0.1, -0.2, 0.3, 0.8, 0.1, -0.1], v: [0.5, 1.0, -0.4, -1.2, 0.3, 2.0] };
pub(crate) const STARS: DoubleStar = DoubleStar { m1: 1.4, m2: 0.5, gamma: 0.9 };
pub(crate) const ORBIT: Start<4> = Start { q: [0.3, 0.0, -0.8, 0.1], v: [0.1, 0.2, -0.2, -1.1] };
pub(crate) const BOND: Morse = Morse { m: 0.8, depth: 3.0, steepness: 1.7, l: 1.1 };
pub(crate) const TURN: Start<3> = Start { q: [0.9, 0.3, -0.6], v: [-0.4, 1.3, 0.5] };

#[test]
fn linear_springs_take_one_correction() {
    check(OFF_CENTRE, 0.01, SWING, 16.0, 1.0);
    check(DUMBBELL, 0.01, TUMBLE, 16.0, 1.0);
    check(
        StiffSpringPendulum::with_stiffness(100.0),
        0.01,
        Start { q: [1.2, 0.1], v: [0.0, -0.5] },
        32.0,
        1.0,
    );
}

#[test]
fn nonlinear_forces_take_two_or_three() {
    check(Kepler { m: 1.7, mu: 1.2 }, 0.01, Start { q: [0.4, 0.1], v: [-0.2, 2.0] }, 16.0, 3.0);
    check(STARS, 0.01, ORBIT, 16.0, 3.0);
    check(BOND, 0.01, TURN, 16.0, 3.0);
    check(Softened { m: 1.2, mu: 0.9, size: 0.3 }, 0.02, Start { q: [0.5, -0.2], v: [0.2, 1.0] }, 16.0, 3.0);
    check(Cup { m: 1.3, k: 2.0 }, 0.02, Start { q: [0.5, -0.8], v: [1.0, 1.0] }, 16.0, 3.0);
}

#[test]
fn stages_of_compositions_go_back_in_time_too() {
    let composed = Evi::midpoint(0.05).composed(Composition::kahan_li_8());
    for found in [compare(OFF_CENTRE, composed, SWING, 40), compare(BOND, composed, TURN, 40)] {
        println!("{:.1} ε, {} corrections", found.roundings, found.corrections);
        // Round-off of 680 stages: 67 ε measured.
        assert!(found.roundings <= 128.0 && found.corrections >= 17.0, "{} ε", found.roundings);
    }
}

/// Every step of a run and the dense one from the same state: largest differences of positions in ε of the reach, and of velocities in ε of the reach over `h`.
fn compare_each<const N: usize, S>(system: S, h: f64, start: Start<N>) -> [f64; 2]
where
    S: MechanicalSystem<PerCoordinate<f64> = [f64; N]> + Copy,
{
    let scheme = Evi::midpoint(h);
    let mut run = Simulation::new(system, scheme).start(start.q, start.v).expect("a start");
    let (mut differences, mut reach, mut speed) = ([0.0; 2], 0.0, 0.0);
    for _ in 0..100 {
        let before = run.state().clone();
        let dense = Simulation::new(Dense(system), scheme).start_at(before.t(), *before.q(), *before.v());
        let mut dense = dense.expect("a state is a start");
        let (end, expected) = (run.advance().expect("a step"), dense.advance().expect("a step"));
        differences[0] = larger(differences[0], largest_difference(end.q(), expected.q()));
        differences[1] = larger(differences[1], largest_difference(end.v(), expected.v()));
        reach = larger(reach, largest_difference(expected.q(), &[0.0; N]));
        speed = larger(speed, largest_difference(expected.v(), &[0.0; N]));
    }
    assert!(speed > 0.5, "the motion is not vacuous: {speed}");
    [differences[0] / reach / f64::EPSILON, h * differences[1] / reach / f64::EPSILON]
}

#[test]
fn every_step_is_that_of_all_coordinates() {
    #[track_caller]
    fn check<const N: usize, S>(system: S, start: Start<N>)
    where
        S: MechanicalSystem<PerCoordinate<f64> = [f64; N]> + Copy,
    {
        let [positions, velocities] = compare_each(system, 0.01, start);
        println!("{}: {positions:.1} ε, {velocities:.1} ε / h", core::panic::Location::caller());
        assert!(positions <= 4.0 && velocities <= 4.0, "{positions} ε, {velocities} ε / h");
    }
    // h ω = 1 of both springs: stiffer ones are beside references, since the path in all coordinates rounds forces.
    let rate = 1.0 / 0.01_f64;
    let spring = OffCentre { k: OFF_CENTRE.m * rate.powi(2), ..OFF_CENTRE };
    check(spring, Start { q: [0.76, -0.78], v: [0.8, 0.6] });
    let dumbbell = Dumbbell { k: rate.powi(2) / (1.0 / 1.3 + 1.0 / 0.4), ..DUMBBELL };
    check(dumbbell, Start { q: [0.1, 0.1, 0.1, 0.9, 0.1, 0.1], v: [0.1, 0.2, 0.3, 0.1, 1.2, -0.9] });
    check(Kepler { m: 1.7, mu: 1.2 }, Start { q: [0.4, 0.1], v: [-0.2, 2.0] });
    check(STARS, ORBIT);
    check(BOND, TURN);
}

/// Three steps of h = 1/128 of a spring of so many radians per step, unstretched and turning at first: positions and velocities by Newton's iteration on
/// the equations in the plane, in 60 digits.
#[track_caller]
fn check_stiff(phase: f64, q: [f64; 2], v: [f64; 2]) {
    const H: f64 = 1.0 / 128.0;
    let system = OffCentre { m: 0.75, k: 0.75 * (phase / H).powi(2), l: 0.625, a: 0.5, b: -0.25, g: 9.75 };
    let run = Simulation::new(system, Evi::midpoint(H)).start([0.875, -0.75], [0.75, 0.5]).expect("a start");
    let mut run = run.with_tally(Statistics::default());
    let end = run.advance_to(3.0 * H).expect("steps");
    let positions = largest_difference(end.q(), &q) / f64::EPSILON;
    let velocities = largest_difference(end.v(), &v) * H / f64::EPSILON;
    println!("{phase}: {positions:.1} ε, {velocities:.1} ε / h");
    // Whatever the stiffness is: a rounding of a position is one of a velocity over h.
    assert!(positions <= 2.0 && velocities <= 8.0, "{positions} ε, {velocities} ε / h");
    assert_eq!(run.tally().corrections, 3);
}

#[test]
fn stiff_springs_leave_round_off_of_positions() {
    check_stiff(32.0, [0.8903976183995622, -0.7381002398148543], [0.5738676515065858, 0.499215476132121]);
    check_stiff(8192.0, [0.8903945882624789, -0.7380964934656948], [0.5714227707493649, 0.5022818591856149]);
}

/// Corrections per step, and agreement, of springs in a metric of their own.
#[test]
fn masses_that_turn_the_force_away_are_told_when_a_run_is_prepared() {
    let start = Start { q: [0.9, -0.4], v: [0.3, -1.4] };
    let system = |m2| Elliptic { m1: 0.7, m2, k: 40.0, l: 0.6, g: GRAVITY };
    // Where the masses have the proportions of the distance.
    check(system(1.4), 0.01, start, 16.0, 1.0);
    let turned = compare(system(0.7), Evi::midpoint(0.01), start, 100);
    assert!(turned.corrections > 1.5, "vacuous: {}", turned.corrections);
    assert!(turned.roundings <= 16.0, "{} ε", turned.roundings);
}

/// One step from `start` by both paths: corrections of the reduced one, and the largest difference relative to the largest coordinate and velocity.
fn one_step<const N: usize, S>(system: S, h: f64, start: Start<N>) -> (u64, f64)
where
    S: MechanicalSystem<PerCoordinate<f64> = [f64; N]> + Copy,
{
    let scheme = Evi::midpoint(h);
    let run = Simulation::new(system, scheme).start(start.q, start.v).expect("a start");
    let mut reduced = run.with_tally(Statistics::default());
    let mut dense = Simulation::new(Dense(system), scheme).start(start.q, start.v).expect("a start");
    let (end, expected) = (reduced.advance().cloned(), dense.advance().cloned());
    let (end, expected) = match (end, expected) {
        (Ok(end), Ok(expected)) => (end, expected),
        (Err(error), Err(expected)) => {
            assert_eq!(core::mem::discriminant(&error), core::mem::discriminant(&expected), "{error}");
            assert_eq!(*reduced.state().q(), start.q, "a step that fails changes nothing");
            return (0, 0.0);
        }
        (end, expected) => panic!("one path fails: {end:?}, {expected:?}"),
    };
    let size = |x: &[f64]| largest_difference(x, &[0.0; N]);
    let of = |a: &[f64; N], b: &[f64; N]| largest_difference(a, b) / size(b);
    let difference = larger(of(end.q(), expected.q()), of(end.v(), expected.v()));
    (reduced.tally().corrections, difference / f64::EPSILON)
}

#[test]
fn a_distance_of_zero_is_left_to_all_coordinates() {
    // The free midpoint is the centre, to the last bit: a force without a direction is reported, one that vanishes is not.
    let through = Start { q: [1.0, -0.5], v: [-4.0, 2.0] };
    let spring = StiffSpringPendulum { m: 1.0, l: 1.0, k: 3.0, g: 0.0 };
    assert_eq!(one_step(spring, 0.5, through), (0, 0.0));
    let (corrections, roundings) = one_step(Cup { m: 1.3, k: 2.0 }, 0.5, through);
    assert!(corrections > 0 && roundings <= 8.0, "{corrections}, {roundings} ε");
}

#[test]
fn a_force_that_one_distance_does_not_determine_is_left_to_all_coordinates() {
    // A spring that would push through its centre: no distance above zero is a solution.
    let spring = StiffSpringPendulum { m: 1.0, l: -2.0, k: 30.0, g: 0.0 };
    let (_, roundings) = one_step(spring, 0.5, Start { q: [0.4, 0.1], v: [0.1, 0.2] });
    assert!(roundings <= 16.0, "{roundings} ε");
    // Where a bond turns soft, with a step so long that r + χF' = r̂ has several roots, and all coordinates take more corrections than the
    // distance is given.
    let bond = Morse { m: 0.05, depth: 3.0, steepness: 4.0, l: 1.0 };
    for (h, x) in [(0.15, 1.2), (0.2, 1.6), (0.3, 1.7)] {
        let (corrections, roundings) = one_step(bond, h, Start { q: [x, 0.2, 0.1], v: [0.1, -0.3, 0.2] });
        println!("{corrections} corrections, {roundings:.1} ε");
        assert!(corrections > 8 && roundings <= 64.0, "{corrections}, {roundings} ε");
    }
}

#[test]
fn scales_beyond_the_squares_of_numbers_are_left_to_all_coordinates() {
    for scale in [1e-150, 1e-100, 1e100, 1e150] {
        let system =
            OffCentre { l: 0.6 * scale, a: 0.4 * scale, b: -0.3 * scale, g: GRAVITY * scale, ..OFF_CENTRE };
        let start = Start { q: SWING.q.map(|x| scale * x), v: SWING.v.map(|x| scale * x) };
        let (_, roundings) = one_step(system, 0.01, start);
        assert!(roundings <= 16.0, "lengths of {scale:e}: {roundings} ε");
        let system = OffCentre { m: 0.7 * scale, k: 40.0 * scale, ..OFF_CENTRE };
        let (corrections, roundings) = one_step(system, 0.01, SWING);
        assert!(corrections == 1 && roundings <= 16.0, "masses of {scale:e}: {corrections}, {roundings} ε");
    }
}

/// A line of two masses, on which the distance has a sign that the path in all coordinates does not know of.
#[test]
fn a_distance_on_a_line_has_a_side() {
    let line = Line { m1: 0.7, m2: 1.9, k: 30.0, l: 0.4 };
    check(line, 0.01, Start { q: [0.1, 0.9], v: [0.5, -0.4] }, 16.0, 4.0);
    check(line, 0.01, Start { q: [0.9, 0.1], v: [0.5, -0.4] }, 16.0, 3.0);
}

#[test]
fn digits_that_are_lost_are_kept_for_the_next_step() {
    fn end<S: MechanicalSystem<PerCoordinate<f64> = [f64; 2]>>(
        system: S,
        scheme: impl Scheme<S>,
    ) -> [f64; 2] {
        let mut run = Simulation::new(system, scheme).start(SWING.q, SWING.v).expect("a start");
        *run.advance_to(1.0).expect("steps").q()
    }
    let scheme = Evi::midpoint(1e-4);
    let plain = end(OFF_CENTRE, scheme);
    let compensated = end(OFF_CENTRE, scheme.compensated());
    let dense = end(Dense(OFF_CENTRE), scheme.compensated());
    let [lost, kept] = [plain, compensated].map(|q| largest_difference(&q, &dense) / f64::EPSILON);
    println!("lost {lost:.1} ε, kept {kept:.1} ε");
    // Of 10⁴ steps: 19 ε and 1.2 ε measured.
    assert!(lost > 8.0 && kept <= 4.0, "{lost} ε, {kept} ε");
}
