//! What the programs of this package share: steps written by hand for one scene each, and methods beside methods on the scenes of the
//! gallery, and solvers of other projects.

pub mod comparison;
pub mod external;
pub mod hand_written;
