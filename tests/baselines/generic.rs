//! The methods on the generic path.

use super::*;

/// The generic path takes the steps of the specialised one.
#[track_caller]
fn check<const N: usize>(composition: Composition<N>) {
    let (system, start) = swing();
    let scheme = GenericEvi::midpoint(0.05).composed(composition);
    let mut generic = scheme.start(system, &start.q, &start.v).expect("consistent");
    let scheme = Evi::midpoint(0.05).composed(composition);
    let mut specialised = Simulation::new(system, scheme).start(start.q, start.v).expect("consistent");
    assert_eq!(generic.h(), 0.05);
    generic.advance_to(2.0).expect("every stage");
    let state = specialised.advance_to(2.0).expect("every stage");
    assert_eq!((generic.t(), generic.steps()), (state.t(), 40));
    let difference =
        largest_difference(generic.q(), state.q()).max(largest_difference(generic.v(), state.v()));
    println!("{}: {:.0} ε", core::panic::Location::caller(), difference / f64::EPSILON);
    assert!(difference <= 1024.0 * f64::EPSILON, "{difference:e}");
    // Another scheme than the stages' own.
    assert!(largest_difference(state.q(), &start.q) > 0.1);
}

#[test]
fn compositions_are_those_of_the_specialised_path() {
    check(Composition::suzuki_4());
    check(Composition::yoshida_6());
    check(Composition::kahan_li_8());
}

#[test]
fn a_stage_that_fails_leaves_the_run_where_it_stood() {
    let pendulum = DoublePendulum::UNIT;
    let start = pendulum.horizontal();
    let scheme = GenericEvi::midpoint(1.0).composed(Composition::triple_jump_4());
    let mut run = scheme.start(pendulum, &start.q, &start.v).expect("consistent");
    let error = loop {
        let before = (run.t(), run.q().to_vec(), run.v().to_vec(), run.steps());
        if let Err(error) = run.advance() {
            assert_eq!(before, (run.t(), run.q().to_vec(), run.v().to_vec(), run.steps()));
            break error;
        }
        assert!(run.steps() < 1_000, "never fails");
    };
    assert!(matches!(error, StepError::NoSolution { .. }), "{error}");
}

#[test]
fn nodes_that_do_not_mirror_each_other_are_refused() {
    let left = Quadrature::interpolatory([0.0]).expect("a rule");
    let start = DoublePendulum::UNIT.horizontal();
    let refused = |scheme: GenericEvi| scheme.start(DoublePendulum::UNIT, &start.q, &start.v).err();
    assert_eq!(refused(GenericEvi::new(&left, 0.01)), None);
    let composed = GenericEvi::new(&left, 0.01).composed(Composition::suzuki_4());
    let error = refused(composed);
    assert!(
        matches!(error, Some(StartError::Scheme(SchemeError::AsymmetricNodes { node: 0, .. }))),
        "{error:?}"
    );
}
