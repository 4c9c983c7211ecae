//! Members that fail are recorded with their errors, and hurt no other.

use evi_core::ensemble::{ByIndex, Ends, Ensemble, Family, FamilyError, Member, MemberError};
use evi_core::prelude::*;
use evi_examples::DoublePendulum;

use crate::members::{COUNT, ends, pendulum, pendulums};

/// Members of which number 3 violates a constraint, number 12 has a mass that is no number, and number 20 turns too fast for its step.
fn with_failures(index: usize) -> Member<DoublePendulum> {
    let mut member = pendulum(index);
    match index {
        3 => member.q[0] += 0.1,
        12 => member.parameters[0] = f64::NAN,
        20 => {
            let [x, y, ..] = member.q;
            member.v = [-60.0 * y, 60.0 * x, -60.0 * y, 60.0 * x];
        }
        _ => {}
    }
    member
}

#[test]
fn failures_have_their_errors_and_hurt_no_other() {
    let ensemble = Ensemble::new(Evi::midpoint(0.05)).sampled(1, 100);
    let outcome = ensemble.run(&ByIndex::new(COUNT, with_failures), &Ends).expect("a run");
    assert!(outcome.is_complete());
    let [start, parameter, step] = &outcome.failures[..] else { panic!("{:?}", outcome.failures) };
    assert!(matches!(start.error, MemberError::Start(StartError::InconsistentPosition { .. })), "{start:?}");
    assert!(matches!(parameter.error, MemberError::Start(StartError::Parameter { name: "m1", .. })));
    assert!(matches!(step.error, MemberError::Step(StepError::NoSolution { .. })), "{step:?}");
    assert_eq!([start, parameter, step].map(|failure| failure.member), [3, 12, 20]);
    let healthy = ends(Evi::midpoint(0.05), &pendulums(COUNT), 100);
    for row in outcome.gathered.rows() {
        let other = &healthy[row[0] as usize];
        assert!(row.iter().zip(other).all(|(a, b)| a.to_bits() == b.to_bits()), "member {}", row[0]);
    }
    assert_eq!(outcome.gathered.rows().len(), COUNT - 3);
}

#[test]
fn a_failure_is_that_of_the_single_run() {
    let member = with_failures(20);
    let [m1, m2, l1, l2, g] = member.parameters;
    let simulation = Simulation::new(DoublePendulum { m1, m2, l1, l2, g }, Evi::midpoint(0.05));
    let mut run = simulation.start(member.q, member.v).expect("a start");
    let (steps, error) =
        (0..100).find_map(|step| run.advance().err().map(|error| (step, error))).expect("a failure");
    let outcome = Ensemble::new(Evi::midpoint(0.05))
        .sampled(1, 100)
        .run(&ByIndex::new(COUNT, with_failures), &Ends)
        .expect("a run");
    let failure = &outcome.failures[2];
    assert_eq!(failure.steps, steps);
    let MemberError::Step(StepError::NoSolution { t, .. }) = failure.error else { panic!("{failure:?}") };
    let StepError::NoSolution { t: alone, .. } = error else { panic!("{error:?}") };
    assert!((t - alone).abs() < 1e-12);
}

#[test]
fn arrays_of_another_length_and_unknown_names_are_refused() {
    let start = DoublePendulum::UNIT.at_angles(0.4, 0.2);
    let family = || Family::new(&DoublePendulum::UNIT, 5, start.q, start.v);
    let error = family().parameter("m2", vec![1.0; 4]).err();
    assert_eq!(error, Some(FamilyError::Length { name: "m2".into(), expected: 5, found: 4 }));
    let error = family().parameter("mass", vec![1.0; 5]).err().expect("refused");
    assert_eq!(error.to_string(), "the scene has no parameter `mass`; it has: m1, m2, l1, l2, g");
    let error = family().starts(vec![start.q; 5], vec![start.v; 6]).err();
    assert_eq!(error, Some(FamilyError::Length { name: "v".into(), expected: 5, found: 6 }));
    let moved =
        ends(Evi::midpoint(0.05), &family().parameter("g", vec![1.0, 2.0, 3.0, 4.0, 5.0]).expect("five"), 10);
    assert!(moved.windows(2).all(|pair| pair[0][3] > pair[1][3]), "more gravity, further down the swing");
}
