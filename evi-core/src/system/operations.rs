//! What evaluating a kernel costs.

/// Operations of each emitted kernel.
#[derive(Clone, Copy, Debug)]
pub struct KernelOperations {
    /// [`MechanicalSystem::constants`](super::MechanicalSystem::constants).
    pub constants: Operations,
    /// [`MechanicalSystem::lagrangian`](super::MechanicalSystem::lagrangian).
    pub lagrangian: Operations,
    /// [`MechanicalSystem::lagrangian_gradient`](super::MechanicalSystem::lagrangian_gradient).
    pub lagrangian_gradient: Operations,
    /// [`MechanicalSystem::lagrangian_derivatives`](super::MechanicalSystem::lagrangian_derivatives).
    pub lagrangian_derivatives: Operations,
    /// [`MechanicalSystem::constraints`](super::MechanicalSystem::constraints).
    pub constraints: Operations,
    /// [`MechanicalSystem::constraint_slopes`](super::MechanicalSystem::constraint_slopes).
    pub constraint_slopes: Operations,
    /// [`MechanicalSystem::constraint_curvature`](super::MechanicalSystem::constraint_curvature).
    pub constraint_curvature: Operations,
}

/// Operations of straight-line code, by kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Operations {
    /// Additions and subtractions.
    pub additions: usize,
    /// Multiplications.
    pub multiplications: usize,
    /// Divisions.
    pub divisions: usize,
    /// Elementary functions and square roots.
    pub functions: usize,
}

impl Operations {
    /// Nothing to compute.
    pub const NONE: Self = Self { additions: 0, multiplications: 0, divisions: 0, functions: 0 };

    /// All operations together.
    pub const fn total(&self) -> usize {
        self.additions + self.multiplications + self.divisions + self.functions
    }
}
