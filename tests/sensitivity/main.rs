//! Derivatives of runs: forward against central differences of the runs themselves, backwards against forward, both on the structures of `L`, of the
//! constraints and of the forces that steps branch on; what the tangent map keeps; what is refused.

mod derivatives;
mod exponents;
mod refusals;
mod tangent_space;
