//! What a step costs: steps written by hand for one scene each, and the programs that time steps beside them (the bench
//! targets and `step_cost`); and solvers of other projects, to compare with.

pub mod external;
pub mod hand_written;
