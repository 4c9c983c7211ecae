//! What emitted code names. Not part of the public API.

pub use crate::generic::GenericSystem;
pub use crate::linear::{DenseLu, Elimination, Guarded, Inverse0, Inverse1, Inverse2, reciprocal_pivot};
pub use crate::scalar::Scalar;
pub use crate::system::{
    Dependence, Entry, EntryValue, HessianPattern, JacobianPattern, KernelOperations, LagrangianGradient,
    MechanicalSystem, Operations, Structure,
};
