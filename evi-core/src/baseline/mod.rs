//! Methods to compare with: not variational ([`Rk4`]), or variational but written the classical way ([`Rattle`]).

mod rattle;
mod rk4;

pub use rattle::{Rattle, RattleStep};
pub use rk4::{Rk4, Rk4Step};
