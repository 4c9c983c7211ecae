//! What emitted code names. Not part of the public API.

#[cfg(feature = "std")]
pub use crate::assembled::{
    AssembledReport, AssembledSystem, Family, FamilyReport, FamilyVisitor, FrequencyVisitor, ObservedVisitor,
};
pub use crate::generic::GenericSystem;
pub use crate::linear::{DenseLu, Elimination, Guarded, Inverse0, Inverse1, Inverse2, reciprocal_pivot};
pub use crate::scalar::Scalar;
pub use crate::system::{
    Block, CentralForce, ConstraintStructure, Dependence, Entry, EntryValue, Equation, ForceStructure,
    Formula, HasFrequencies, HessianBlocks, HessianPattern, JacobianPattern, KernelOperations, KernelReport,
    LagrangianGradient, MassShape, MechanicalSystem, Operations, Potential, Structure, SystemReport,
};
