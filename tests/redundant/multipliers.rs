//! Multipliers of least norm.

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
    let [_, rod2, _, again2] = run.mechanics().acceleration(0.0, state.q(), state.v()).unwrap().multipliers;
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
