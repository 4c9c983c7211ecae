//! The members of the tests: unequal parameters, unequal starts.

use evi_core::ensemble::{ByIndex, Ends, Ensemble, LaneScheme, Member, Members};
use evi_core::prelude::*;
use evi_examples::DoublePendulum;

/// Number of members: groups that are full, and one that is not.
pub(crate) const COUNT: usize = 43;

/// A fraction that is different for every member.
pub(crate) fn fraction(index: usize, salt: f64) -> f64 {
    (index as f64 * 0.618_033_988_749_895 + salt).fract()
}

/// Double pendulums of unequal masses and lengths, from rest at moderate angles.
pub(crate) fn pendulums(count: usize) -> impl Members<DoublePendulum> {
    ByIndex::new(count, pendulum)
}

/// One of them.
pub(crate) fn pendulum(index: usize) -> Member<DoublePendulum> {
    let [a, b, c, d] = [0.1, 0.3, 0.5, 0.7].map(|salt| fraction(index, salt));
    let system = DoublePendulum { m1: 0.8 + a, m2: 1.5 - b, l1: 0.9 + 0.3 * c, l2: 1.2 - 0.4 * d, g: 9.81 };
    let start = system.at_angles(0.3 + a, 0.9 * b - 0.2);
    Member::of(&system, start.q, start.v)
}

/// Configurations and velocities at the end, a row per member, after so many steps.
pub(crate) fn ends<S: MechanicalSystem>(
    scheme: impl LaneScheme<S> + Sync,
    members: &impl Members<S>,
    steps: u64,
) -> Vec<Vec<f64>> {
    let outcome = Ensemble::new(scheme).sampled(1, steps).threads(1).run(members, &Ends).expect("a run");
    assert!(outcome.is_complete());
    assert_eq!(outcome.failures, [], "every member has an end");
    outcome.gathered.rows().map(<[f64]>::to_vec).collect()
}
