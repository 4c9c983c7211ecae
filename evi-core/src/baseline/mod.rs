//! Methods to compare with: not variational ([`Rk4`]), variational but written the classical way ([`Rattle`]), or the same
//! but without what the structure of a scene saves ([`Dense`]).

mod dense;
mod rattle;
mod rk4;

pub use dense::Dense;
pub use rattle::{Rattle, RattleStep};
pub use rk4::{Rk4, Rk4Step};
