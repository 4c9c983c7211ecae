//! Scenes of many bodies: against the specialised path, certified digits, and what steps keep.

mod agreement;
mod galerkin;
mod kept;
mod order;
mod refusals;
mod watched;
