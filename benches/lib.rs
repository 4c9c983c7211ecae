//! What the programs of this package share: steps written by hand for one scene each, and methods beside methods on the scenes of the
//! gallery, solvers of other projects, numbers with 71 digits, and what programs that measure have in common.

pub mod comparison;
pub mod external;
pub mod hand_written;
pub mod octuple;
pub mod program;
