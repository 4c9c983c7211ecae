//! What emitted code names. Not part of the public API.

pub use crate::generic::GenericSystem;
pub use crate::linear::DenseLu;
pub use crate::scalar::Scalar;
pub use crate::system::{
    Block, ConstraintStructure, Dependence, Entry, EntryValue, Equation, Formula, HessianBlocks,
    HessianPattern, JacobianPattern, KernelOperations, KernelReport, LagrangianGradient, MassShape,
    MechanicalSystem, Operations, Potential, Structure, SystemReport,
};
