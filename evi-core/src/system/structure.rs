//! What the compiler knows about a scene's equations, as constants to branch on.

use super::pattern::{has_column, has_row, is_diagonal};
use super::{
    Block, CentralForce, ConstraintStructure, ForceStructure, HessianBlocks, HessianPattern, JacobianPattern,
    KernelOperations, MassShape, Operations, Potential,
};

/// The variables that a quantity depends on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Dependence {
    /// Depends on the coordinates.
    pub on_q: bool,
    /// Depends on the velocities.
    pub on_v: bool,
    /// Depends on time.
    pub on_t: bool,
}

impl Dependence {
    /// Whether the quantity depends on parameters alone.
    pub const fn is_constant(&self) -> bool {
        !(self.on_q || self.on_v || self.on_t)
    }
}

/// What the compiler knows about a scene's equations.
#[derive(Clone, Copy, Debug)]
pub struct Structure {
    /// Nonzero second derivatives of `L`.
    pub hessian: HessianPattern,
    /// Nonzero derivatives of `φ`.
    pub jacobian: JacobianPattern,
    /// What each block of the Hessian depends on.
    pub blocks: HessianBlocks,
    /// On what the mass matrix `∂²L/∂v²` depends.
    pub mass: Dependence,
    /// Pattern of the mass matrix.
    pub mass_shape: MassShape,
    /// The potential as a function of `q`.
    pub potential: Potential,
    /// Whether `∂L/∂v(t, q, 0) = 0`: a system at rest has no momentum.
    pub momentum_vanishes_at_rest: bool,
    /// On what `L` depends.
    pub lagrangian: Dependence,
    /// On what `φ` depends.
    pub constraints: Dependence,
    /// Each constraint by itself.
    pub each_constraint: &'static [ConstraintStructure],
    /// Pairs of constraints that share a coordinate, `(smaller, larger)` index.
    pub constraint_graph: &'static [(usize, usize)],
    /// Forces that are no derivatives of `L`.
    pub forces: ForceStructure,
    /// The one force that acts along a distance, in a scene that has no other but a uniform one.
    pub central_force: Option<CentralForce>,
    /// Operations of each kernel of `L` and `φ`.
    pub operations: KernelOperations,
}

impl Structure {
    /// Stands where the derive found mistakes and the equations are not known.
    #[doc(hidden)]
    pub const UNKNOWN: Self = {
        const NOTHING: Dependence = Dependence { on_q: false, on_v: false, on_t: false };
        const NONE: Operations = Operations::NONE;
        Self {
            hessian: HessianPattern { qq: &[], vq: &[], vv: &[], vt: &[] },
            jacobian: JacobianPattern { q: &[], t: &[], content: 1.0 },
            blocks: HessianBlocks { qq: Block::Zero, vq: Block::Zero, vv: Block::Zero, vt: Block::Zero },
            mass: NOTHING,
            mass_shape: MassShape::Diagonal,
            potential: Potential::Zero,
            momentum_vanishes_at_rest: false,
            lagrangian: NOTHING,
            constraints: NOTHING,
            each_constraint: &[],
            constraint_graph: &[],
            forces: ForceStructure::NONE,
            central_force: None,
            operations: KernelOperations {
                constants: NONE,
                lagrangian: NONE,
                lagrangian_gradient: NONE,
                lagrangian_derivatives: NONE,
                constraints: NONE,
                constraint_slopes: NONE,
                constraint_curvature: NONE,
            },
        }
    };

    /// Whether `L` is a polynomial of degree at most two in `v`, so that the Legendre transform is linear.
    pub const fn is_quadratic_in_velocity(&self) -> bool {
        !self.mass.on_v
    }

    /// Whether no second derivative of `L` couples two coordinates: every matrix of a step without other forces is diagonal.
    pub const fn is_uncoupled(&self) -> bool {
        is_diagonal(self.hessian.qq) && is_diagonal(self.hessian.vq) && is_diagonal(self.hessian.vv)
    }

    /// Whether nothing holds a coordinate: neither a constraint nor a force depends on it, and `L` by a uniform force at most. Its velocity may be
    /// coupled to anything.
    pub const fn is_free(&self, coordinate: usize) -> bool {
        !(has_column(self.hessian.qq, coordinate)
            || has_row(self.hessian.qq, coordinate)
            || has_column(self.hessian.vq, coordinate)
            || has_column(self.jacobian.q, coordinate)
            || has_column(self.forces.q, coordinate))
    }

    /// Whether every constraint is a polynomial of degree at most two in `q`, and does not depend on time.
    pub const fn has_quadratic_constraints(&self) -> bool {
        let mut row = 0;
        while row < self.each_constraint.len() {
            if !self.each_constraint[row].is_quadratic || self.each_constraint[row].on_t {
                return false;
            }
            row += 1;
        }
        true
    }

    /// Whether some constraint depends on each of the coordinates.
    pub const fn constrains_every(&self, n_coordinates: usize) -> bool {
        let mut coordinate = 0;
        while coordinate < n_coordinates {
            if !has_column(self.jacobian.q, coordinate) {
                return false;
            }
            coordinate += 1;
        }
        true
    }

    /// Whether every constraint holds a mass of its own at a distance of the origin: `G M⁻¹ Gᵀ` is then the same for every configuration on the
    /// constraints, to the round-off that they hold to, and diagonal.
    pub const fn has_constant_gram(&self) -> bool {
        let mut row = 0;
        while row < self.each_constraint.len() {
            if !self.each_constraint[row].is_sphere {
                return false;
            }
            row += 1;
        }
        row > 0 && self.constraint_graph.is_empty() && is_diagonal(self.hessian.vv)
    }

    /// Whether neither `L` nor `φ` nor a force depends on time.
    pub const fn is_autonomous(&self) -> bool {
        !(self.lagrangian.on_t || self.constraints.on_t || self.forces.on.on_t)
    }

    /// Whether `L = ½ vᵀ M v − V(t, q)` with constant `M`.
    pub const fn is_separable_with_constant_mass(&self) -> bool {
        self.mass.is_constant() && self.hessian.vq.is_empty() && self.hessian.vt.is_empty()
    }
}
