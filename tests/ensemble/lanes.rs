//! Eight members side by side: the same motion as alone, to round-off of the same steps, and to the last bit in any company.

use evi_core::ensemble::{ByIndex, LaneScheme, Member, Members};
use evi_core::mechanics::Mechanics;
use evi_core::prelude::*;
use evi_examples::{Chain5, DoublePendulum, Scene, StiffSpringPendulum};
use evi_tests::largest_difference;
use evi_tests::scenes::{ChargedSphericalPendulum, DoublePendulumInAngles, MotorisedDoublePendulum};

use crate::members::{COUNT, ends, fraction, pendulum, pendulums};

/// The largest difference between ends in lanes and ends of single runs.
fn difference<S, F>(scheme: F, members: &impl Members<S>, alone: impl Fn(&Member<S>) -> S, steps: u64) -> f64
where
    S: MechanicalSystem,
    F: LaneScheme<S> + Clone + Sync,
{
    let mut largest = 0.0_f64;
    for row in ends(scheme.clone(), members, steps) {
        let member = members.member(row[0] as usize);
        let simulation = Simulation::new(alone(&member), scheme.clone());
        let mut run = simulation.start(member.q, member.v).expect("a start");
        let part = scheme.member(run.mechanics(), run.state()).expect("a scheme for the scene");
        assert!(part.is_some(), "vacuous: it is moved alone");
        for _ in 0..steps {
            run.advance().expect("a step");
        }
        assert_eq!(row[2].to_bits(), run.state().t().to_bits());
        let n = S::N_COORDINATES;
        largest = largest.max(largest_difference(&row[3..3 + n], run.state().q().as_ref()));
        largest = largest.max(largest_difference(&row[3 + n..], run.state().v().as_ref()));
    }
    largest
}

fn pendulum_alone(member: &Member<DoublePendulum>) -> DoublePendulum {
    let [m1, m2, l1, l2, g] = member.parameters;
    DoublePendulum { m1, m2, l1, l2, g }
}

/// A swing of the spring pendulum, whose potential is not quadratic.
fn springs(count: usize) -> impl Members<StiffSpringPendulum> {
    ByIndex::new(count, |index| {
        let system = StiffSpringPendulum::with_stiffness(50.0 + 100.0 * fraction(index, 0.2));
        Member::of(&system, [1.0 + 0.1 * fraction(index, 0.4), 0.0], [0.0, 0.3])
    })
}

/// Chains of five rods under unequal gravity: matrices of five rows, within their band.
fn chains(count: usize) -> impl Members<Chain5> {
    ByIndex::new(count, |index| {
        let system = chain(5.0 + 5.0 * fraction(index, 0.2));
        let (q, v) = system.standard_motion();
        Member::of(&system, q, v)
    })
}

fn chain(g: f64) -> Chain5 {
    Chain5 { g, ..Chain5::standard() }
}

// Bounds: round-off of the steps, in another order in lanes, which motions amplify; measured 8e-14, 1.3e-13, 1.6e-14 and 4e-15.
#[test]
fn midpoint_steps_are_those_of_single_runs() {
    let found = difference(Evi::midpoint(0.01), &pendulums(COUNT), pendulum_alone, 200);
    assert!(found < 1e-13, "{found:e}");
}

#[test]
fn galerkin_steps_are_those_of_single_runs() {
    let found = difference(Galerkin::<4>::new(0.05), &pendulums(COUNT), pendulum_alone, 60);
    assert!(found < 2e-13, "{found:e}");
}

/// Passes that end early are off by little more than their tolerance, alone as in lanes; constraints and hidden constraints hold to round-off all
/// the same.
#[test]
fn passes_to_a_tolerance_stay_within_it_and_on_the_constraints() {
    let scheme = Galerkin::<4>::new(0.05);
    let rough = scheme.solved_to(1e-6);
    let solved = ends(scheme, &pendulums(COUNT), 60);
    let mut largest = [0.0_f64; 2];
    for (row, solved) in ends(rough, &pendulums(COUNT), 60).iter().zip(&solved) {
        largest[0] = largest[0].max(largest_difference(&row[3..], &solved[3..]));
        let system = pendulum_alone(&pendulum(row[0] as usize));
        let mechanics = Mechanics::new(&system);
        let (q, v) = ([row[3], row[4], row[5], row[6]], [row[7], row[8], row[9], row[10]]);
        let [x1, y1, x2, y2] = q;
        let rates = [x1 * v[0] + y1 * v[1], (x2 - x1) * (v[2] - v[0]) + (y2 - y1) * (v[3] - v[1])];
        let residuals = mechanics.constraint_residual_at(0.0, &q);
        largest[1] = rates.iter().chain(&residuals).fold(largest[1], |largest, x| largest.max(x.abs()));
    }
    let [off, beside] = largest;
    // The motion amplifies what a step is off by: measured 1.4e-5.
    assert!((1e-9..2e-5).contains(&off), "{off:e}");
    // Terms of up to 4, of positions and of velocities: measured 1e-15.
    assert!(beside < 2e-15, "{beside:e}");
    let alone = difference(rough, &pendulums(COUNT), pendulum_alone, 60);
    // Measured 1.6e-5.
    assert!(alone < 2e-5, "{alone:e}");
}

fn spring_alone(member: &Member<StiffSpringPendulum>) -> StiffSpringPendulum {
    let [m, l, k, g] = member.parameters;
    StiffSpringPendulum { m, l, k, g }
}

/// Double pendulums in angles under forces: a mass that depends on the configuration, and derivatives of forces that are not symmetric.
fn motorised(count: usize) -> impl Members<MotorisedDoublePendulum> {
    ByIndex::new(count, |index| {
        let system =
            MotorisedDoublePendulum { m2: 0.5 + fraction(index, 0.2), ..MotorisedDoublePendulum::STANDARD };
        let start = DoublePendulumInAngles::MODERATE;
        Member::of(&system, [start.q[0] + fraction(index, 0.4), start.q[1]], start.v)
    })
}

fn motorised_alone(member: &Member<MotorisedDoublePendulum>) -> MotorisedDoublePendulum {
    let m2 = MotorisedDoublePendulum::PARAMETERS.iter().position(|name| *name == "m2").expect("a mass");
    MotorisedDoublePendulum { m2: member.parameters[m2], ..MotorisedDoublePendulum::STANDARD }
}

/// Charged pendulums in a magnetic field: velocities and positions are coupled, and a constraint holds.
fn charged(count: usize) -> impl Members<ChargedSphericalPendulum> {
    ByIndex::new(count, |index| {
        let system =
            ChargedSphericalPendulum { b: fraction(index, 0.2), ..ChargedSphericalPendulum::STANDARD };
        let start = system.one_radian();
        Member::of(&system, start.q, start.v)
    })
}

fn charged_alone(member: &Member<ChargedSphericalPendulum>) -> ChargedSphericalPendulum {
    let b = ChargedSphericalPendulum::PARAMETERS.iter().position(|name| *name == "b").expect("a field");
    ChargedSphericalPendulum { b: member.parameters[b], ..ChargedSphericalPendulum::STANDARD }
}

// Of the same make: measured 3e-14, 8e-15, 9e-15 and, over the five stages of 40 steps, 8e-14.
#[test]
fn steps_by_newton_s_iteration_are_those_of_single_runs() {
    let found = difference(Evi::midpoint(0.01), &springs(COUNT), spring_alone, 200);
    assert!(found < 4e-14, "{found:e}");
    let found = difference(Evi::simpson(0.02), &motorised(COUNT), motorised_alone, 100);
    assert!(found < 1e-14, "{found:e}");
    let found = difference(Evi::simpson(0.02).frequency(3.0), &charged(COUNT), charged_alone, 100);
    assert!(found < 1e-14, "{found:e}");
}

#[test]
fn stages_of_a_composition_are_those_of_single_runs() {
    let scheme = Evi::midpoint(0.05).composed(Composition::suzuki_4());
    let found = difference(scheme, &pendulums(COUNT), pendulum_alone, 40);
    assert!(found < 1e-13, "{found:e}");
}

#[test]
fn leapfrog_steps_are_those_of_single_runs() {
    let found = difference(Evi::trapezoid(0.01), &springs(COUNT), spring_alone, 200);
    assert!(found < 2e-14, "{found:e}");
}

#[test]
fn steps_of_many_constraints_are_those_of_single_runs() {
    let alone = |member: &Member<Chain5>| {
        let g = Chain5::PARAMETERS.iter().position(|name| *name == "g").expect("gravity");
        chain(member.parameters[g])
    };
    let found = difference(Evi::midpoint(0.005), &chains(9), alone, 60);
    assert!(found < 1e-14, "{found:e}");
}

/// The ends of some members alone, and in the company of all.
#[track_caller]
fn check_company<S: MechanicalSystem>(
    scheme: impl LaneScheme<S> + Clone + Sync,
    members: &impl Members<S>,
    steps: u64,
) {
    let all = ends(scheme.clone(), members, steps);
    for index in [0, 5, 17, COUNT - 1] {
        let alone = ends(scheme.clone(), &ByIndex::new(1, |_| members.member(index)), steps);
        let bits = |row: &[f64]| row[2..].iter().map(|x| x.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(&alone[0]), bits(&all[index]), "member {index}");
    }
}

#[test]
fn company_changes_no_bit_of_midpoint_steps() {
    check_company(Evi::midpoint(0.05), &pendulums(COUNT), 400);
}

#[test]
fn company_changes_no_bit_of_galerkin_steps() {
    check_company(Galerkin::<4>::new(0.1), &pendulums(COUNT), 100);
    // The metric of the masses does not see the second bob of every third one.
    let light = ByIndex::new(COUNT, |index| {
        let mut member = pendulum(index);
        if index % 3 == 0 {
            member.parameters[1] *= 1e-12;
        }
        member
    });
    check_company(Galerkin::<4>::new(0.1), &light, 100);
    let found = difference(Galerkin::<4>::new(0.05), &light, pendulum_alone, 60);
    assert!(found < 2e-13, "{found:e}");
}

#[test]
fn company_changes_no_bit_of_steps_by_newton_s_iteration() {
    check_company(Evi::simpson(0.02).frequency(3.0), &charged(COUNT), 100);
    check_company(Evi::midpoint(0.01), &springs(COUNT), 200);
}

#[test]
fn company_changes_no_bit_of_a_composition() {
    check_company(Evi::midpoint(0.05).composed(Composition::suzuki_4()), &pendulums(COUNT), 100);
}
