//! The trait that methods are compared by.

use super::*;

#[test]
fn solvers_of_every_kind_stand_in_one_list() {
    fn start(scheme: impl Scheme<DoublePendulum, Step: 'static>) -> Box<dyn Solver> {
        let Start { q, v } = moving();
        Box::new(Simulation::new(UNEQUAL, scheme).start(q, v).expect("the start is consistent"))
    }
    let mut solvers: Vec<Box<dyn Solver>> = vec![
        start(Evi::midpoint(0.001)),
        start(Evi::simpson(0.002)),
        start(Evi::simpson(0.001).frequency(2.4)),
        start(Rattle::new(0.001)),
        start(Rk4::new(0.005)),
    ];
    for solver in &mut solvers {
        assert_eq!((solver.t(), solver.steps()), (0.0, 0));
        solver.advance_to(1.0).expect("every step has a solution");
    }
    assert_eq!(solvers.iter().map(|solver| solver.steps()).collect::<Vec<_>>(), [1000, 500, 1000, 1000, 200]);
    let [reference, others @ ..] = solvers.as_slice() else { unreachable!("five solvers") };
    assert!(largest_difference(reference.q(), &moving().q) > 0.1, "the reference stood still");
    for solver in others {
        assert_eq!(solver.t(), reference.t());
        // Truncation errors of order 2 at h = 0.002: 5e-6 and 4e-5 measured.
        check_near(solver.q(), reference.q(), 2e-5);
        check_near(solver.v(), reference.v(), 2e-4);
        check_near(solver.p(), reference.p(), 2e-4);
    }
}

#[test]
fn a_solver_in_a_list_reports_errors_and_stands_before_them() {
    let system = DoublePendulum::UNIT;
    let Start { q, v } = system.horizontal();
    let run = Simulation::new(system, Evi::midpoint(0.3)).start(q, v).unwrap();
    let mut solver: Box<dyn Solver> = Box::new(run);
    let mut visited = 0;
    let failure = solver.advance_visiting(10.0, &mut |_| visited += 1).expect_err("steps far too long");
    assert!(matches!(failure.downcast_ref(), Some(StepError::NoSolution { .. })), "{failure}");
    assert_eq!((solver.steps(), visited), (2, 2));
    assert!(solver.q().iter().all(|q| q.is_finite()));
}
