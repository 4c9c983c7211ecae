//! How many constraints are independent, and what is refused.

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
    let StartError::DependentConstraints { rank: 2, constraints: 4, smallest_kept, largest_dropped, .. } =
        error
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
