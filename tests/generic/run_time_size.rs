//! Systems of a size that no type knows.

use super::*;

#[test]
fn a_chain_of_any_length_keeps_its_rods_and_its_energy() {
    for n_links in [1, 2, 3, 5, 8] {
        let chain = Chain::alternating(n_links);
        let mut run = chain.run(&GenericEvi::midpoint(0.005));
        let energy = run.energy();
        let (mut early, mut late) = (0.0_f64, 0.0_f64);
        for step in 0..4_000 {
            run.advance().expect("the step exists");
            let error = (run.energy() - energy).abs();
            if step < 1_000 {
                early = early.max(error)
            } else {
                late = late.max(error)
            }
            // Three terms of the size of the squared coordinates, up to 5² for the longest chain.
            let residual = largest_difference(&run.constraint_residual(), &vec![0.0; n_links]);
            assert!(residual <= 64.0 * f64::EPSILON, "{n_links} links, step {step}: {residual:e}");
            let hidden = largest_difference(&run.hidden_constraint_residual(), &vec![0.0; n_links]);
            assert!(hidden <= 64.0 * f64::EPSILON, "{n_links} links, step {step}: {hidden:e}");
        }
        assert!(early > 1e-6 && late < 3.0 * early, "{n_links} links: {early:e}, later {late:e}");
    }
}

#[test]
fn a_chain_of_two_links_is_the_double_pendulum() {
    let [(m1, l1), (m2, l2)] = Chain::alternating(2).links[..] else { panic!("two links") };
    let derived = DoublePendulum { m1, m2, l1, l2, g: 9.81 };
    let mut chain = Chain::alternating(2).run(&GenericEvi::simpson(H).frequency(OMEGA));
    let mut run = Simulation::new(derived, Evi::simpson(H).frequency(OMEGA))
        .start(derived.at_angles(0.4, 0.4).q, [0.0; 4])
        .expect("the start is consistent");
    chain.advance_to(1.0).expect("the steps exist");
    run.advance_to(1.0).expect("the steps exist");
    let difference = largest_difference(chain.q(), run.state().q());
    assert!(difference <= 1e3 * f64::EPSILON, "{difference:e}");
}

#[test]
fn steps_back_return_to_the_start() {
    let chain = Chain::alternating(6);
    let mut there = chain.run(&GenericEvi::simpson(H));
    let start = there.q().to_vec();
    there.advance_to(0.5).expect("the steps exist");
    assert!(largest_difference(there.q(), &start) > 0.1, "the chain stood still");
    let mut back = GenericEvi::simpson(-H)
        .start_at(chain, there.t(), there.q(), there.v())
        .expect("a state is consistent");
    back.advance_to(0.0).expect("the steps exist");
    let difference = largest_difference(back.q(), &start);
    assert!(difference <= 1e4 * f64::EPSILON && back.t().abs() < 1e-15, "{difference:e}");
}

#[test]
fn solvers_of_both_paths_stand_in_one_list() {
    let Start { q, v } = SPHERICAL.one_radian();
    let specialised = Simulation::new(SPHERICAL, Evi::midpoint(H)).start(q, v).expect("consistent");
    let generic = GenericEvi::midpoint(H).start(SPHERICAL, &q, &v).expect("consistent");
    let mut solvers: Vec<Box<dyn Solver>> = vec![Box::new(specialised), Box::new(generic)];
    for solver in &mut solvers {
        solver.advance_to(0.5).expect("the steps exist");
    }
    let [a, b] = &solvers[..] else { panic!("two solvers") };
    assert_eq!((a.t(), a.steps()), (b.t(), b.steps()));
    assert_ne!(a.q(), q);
    for (a, b) in [(a.q(), b.q()), (a.v(), b.v()), (a.p(), b.p())] {
        assert!(largest_difference(a, b) <= 1e3 * f64::EPSILON, "{a:?} and {b:?}");
    }
}
