//! Methods to compare with: not variational ([`Rk4`], [`ImplicitMidpoint`], [`GeneralizedAlpha`]), variational but written the
//! classical way ([`Rattle`], [`Shake`]), or the same but without what the structure of a scene saves ([`Dense`]).
//!
//! Other classical methods are members of the families of this crate. Gauss' collocation in `(q, p)` without constraints is
//! [`Evi::midpoint`](crate::integrator::Evi::midpoint) for one stage; the Lobatto IIIA-IIIB pair with `K + 1` stages, constrained or not
//! (Jay, SIAM J. Numer. Anal. 33 (1996) 368), is `Galerkin::<K>` with polynomials for constant mass matrices, of which RATTLE is the
//! first, `K = 1`; Störmer and Verlet's leapfrog is `Evi::trapezoid` without constraints.

mod constrained_drift;
mod dense;
mod equations_of_motion;
mod generalized_alpha;
mod implicit_midpoint;
mod prediction;
mod rattle;
mod rk4;
mod shake;

pub use dense::Dense;
pub use generalized_alpha::{GeneralizedAlpha, GeneralizedAlphaStep};
pub use implicit_midpoint::{ImplicitMidpoint, ImplicitMidpointStep};
pub use rattle::{Rattle, RattleStep};
pub use rk4::{Rk4, Rk4Step};
pub use shake::{Shake, ShakeStep};
