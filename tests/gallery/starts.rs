//! Every standard motion starts on the constraints and on the hidden ones.

use evi_core::mechanics::Mechanics;
use evi_examples::{Scene, Visitor, visit_all};
use evi_tests::largest_difference;

struct Starts;

/// Largest magnitude; NaN if one is.
fn largest(values: &[f64]) -> f64 {
    largest_difference(values, &vec![0.0; values.len()])
}

impl Visitor for Starts {
    fn visit<S: Scene>(&mut self) {
        let system = S::standard();
        let (q, v) = system.standard_motion();
        let mechanics = Mechanics::new(&system);
        let speed = largest(v.as_ref()).max(1.0);
        let position = largest(mechanics.constraint_residual_at(0.0, &q).as_ref()) / f64::EPSILON;
        let velocity =
            largest(mechanics.hidden_constraint_residual_at(0.0, &q, &v).as_ref()) / speed / f64::EPSILON;
        println!("{}: {position} ε, hidden {velocity} ε", S::NAME);
        assert!(position <= 1.0 && velocity <= 1.0, "{}: {position} ε, hidden {velocity} ε", S::NAME);
    }
}

#[test]
fn satisfy_constraints_and_hidden_constraints() {
    visit_all(&mut Starts);
}
