//! Scenes without forces hold nothing of them.

use evi_core::array::Array;
use evi_core::prelude::*;

use evi_core::mechanics::State;
use evi_examples::DoublePendulum;

/// Nothing is stored, and nothing is known of a force.
#[test]
fn hold_nothing_of_them() {
    // Time, four positions, velocities and momenta; aligned in pairs.
    assert_eq!(size_of::<State<DoublePendulum>>(), 14 * size_of::<f64>());
    assert!(!DoublePendulum::STRUCTURE.forces.exist());
    assert_eq!(<DoublePendulum as MechanicalSystem>::PerForceEntry::<f64>::LEN, 0);
    assert_eq!((DoublePendulum::N_INPUTS, DoublePendulum::OBSERVABLES.len()), (0, 0));
    assert!(DoublePendulum::REPORT.kernels.iter().all(|kernel| !kernel.name.contains("force")));
}
