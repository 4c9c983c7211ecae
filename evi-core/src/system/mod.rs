//! What the derive emits for a scene: the contract between the symbolic compiler and the integrators.
//!
//! A scene is a Lagrangian `L(t, q, v)` with `n` coordinates `q`, velocities `v`, and `m` holonomic constraints
//! `φ(t, q) = 0` with Jacobian `G = ∂φ/∂q` (`m × n`). The derive emits its kernels, its structure and the storage
//! types of its index sets; nothing here loops over nodes or iterates.

mod classification;
mod forces;
mod report;
mod wrapped;

pub use classification::{Block, ConstraintStructure, HessianBlocks, MassShape, Potential};
pub use forces::{ForceStructure, HasFrequencies};
pub use report::{Equation, Formula, KernelReport, SystemReport};
pub(crate) use wrapped::unfolded_scene_of_inner;

use crate::array::Array;
use crate::linear::Factorization;
use crate::scalar::Scalar;

/// A mechanical system with compile-time structure; implemented by `#[derive(MechanicalSystem)]`.
///
/// Kernels take the scene's *constants*: every subexpression of the equations that depends on parameters alone,
/// computed once by [`constants`](Self::constants) and never again during a run.
#[diagnostic::on_unimplemented(
    message = "`{Self}` is not a `MechanicalSystem`",
    note = "a struct with a size that is a constant's name, or with a large one, is an `AssembledSystem`: `AssembledSimulation` starts it",
    note = "any other derives `MechanicalSystem`"
)]
pub trait MechanicalSystem: Sized {
    /// Number of coordinates, `n`.
    const N_COORDINATES: usize = Self::COORDINATES.len();
    /// Number of constraints, `m`.
    const N_CONSTRAINTS: usize = Self::CONSTRAINTS.len();
    /// Names of the coordinates, in the order of `q`.
    const COORDINATES: &'static [&'static str];
    /// Names of the constraints, in the order of `φ`.
    const CONSTRAINTS: &'static [&'static str];
    /// How many of the constraints are independent, where that is stated: of scenes of `integrator::OfRank` alone. Elsewhere all of them are.
    const STATED_RANK: Option<usize> = None;
    /// Names of the struct's fields that the equations use, in the order of [`parameters`](Self::parameters).
    const PARAMETERS: &'static [&'static str];
    /// Number of inputs.
    const N_INPUTS: usize = Self::INPUTS.len();
    /// Names of the inputs: values that forces depend on and that the caller sets from step to step.
    const INPUTS: &'static [&'static str] = &[];
    /// Names of the observed quantities, in the order of [`observables`](Self::observables).
    const OBSERVABLES: &'static [&'static str] = &[];
    /// What is zero, constant, or varying in the derivatives of `L` and `φ`, and what evaluating them costs.
    const STRUCTURE: Structure;
    /// The equations and what became of them, to print and read.
    const REPORT: SystemReport;
    /// The text of the generated code but for [`REPORT`](Self::REPORT), with the feature `source`.
    const SOURCE: Option<&'static str> = None;

    /// One value per coordinate.
    type PerCoordinate<X: Clone>: Array<X>;
    /// One value per constraint.
    type PerConstraint<X: Clone>: Array<X>;
    /// One value per unknown of the step: coordinates, then constraints.
    type PerUnknown<X: Clone>: Array<X>;
    /// One value per parameter.
    type PerParameter<X: Clone>: Array<X>;
    /// One value per constant subexpression.
    type PerConstant<X: Clone>: Array<X>;
    /// One value per varying entry of the Hessian of `L`.
    type PerHessianEntry<X: Clone>: Array<X>;
    /// One value per varying entry of the Jacobian of `φ`.
    type PerJacobianEntry<X: Clone>: Array<X>;
    /// One value per input.
    type PerInput<X: Clone>: Array<X>;
    /// One value per observed quantity.
    type PerObservable<X: Clone>: Array<X>;
    /// One value per varying entry of the derivatives of the forces.
    type PerForceEntry<X: Clone>: Array<X>;

    /// Solver of the saddle-point systems of the scene, `(n + m) × (n + m)`.
    type KktFactors: Factorization<Self::PerUnknown<f64>, Self::PerUnknown<Self::PerUnknown<f64>>>;
    /// Solver of systems of that size with any pattern, with pivoting.
    type DenseKktFactors: Factorization<Self::PerUnknown<f64>, Self::PerUnknown<Self::PerUnknown<f64>>>;
    /// Solver of systems with the mass matrix, `n × n`.
    type MassFactors: Factorization<Self::PerCoordinate<f64>, Self::PerCoordinate<Self::PerCoordinate<f64>>>;
    /// Solver of systems with the Gram matrix `G M⁻¹ Gᵀ` of the constraints, `m × m`.
    type GramFactors: Factorization<Self::PerConstraint<f64>, Self::PerConstraint<Self::PerConstraint<f64>>>;

    /// The parameters: values of the struct's fields.
    fn parameters(&self) -> Self::PerParameter<f64>;

    /// Every subexpression of the kernels that depends on parameters alone.
    fn constants<T: Scalar>(parameters: &Self::PerParameter<T>) -> Self::PerConstant<T>;

    /// `L(t, q, v)`.
    fn lagrangian<T: Scalar>(
        constants: &Self::PerConstant<T>,
        t: T,
        q: &Self::PerCoordinate<T>,
        v: &Self::PerCoordinate<T>,
    ) -> T;

    /// First derivatives of `L`.
    fn lagrangian_gradient<T: Scalar>(
        constants: &Self::PerConstant<T>,
        t: T,
        q: &Self::PerCoordinate<T>,
        v: &Self::PerCoordinate<T>,
    ) -> LagrangianGradient<Self, T>;

    /// First and second derivatives of `L`, fused.
    fn lagrangian_derivatives<T: Scalar>(
        constants: &Self::PerConstant<T>,
        t: T,
        q: &Self::PerCoordinate<T>,
        v: &Self::PerCoordinate<T>,
    ) -> (LagrangianGradient<Self, T>, Self::PerHessianEntry<T>);

    /// `φ(t, q)`.
    fn constraints<T: Scalar>(
        constants: &Self::PerConstant<T>,
        t: T,
        q: &Self::PerCoordinate<T>,
    ) -> Self::PerConstraint<T>;

    /// `φ(t, q)` and the varying entries of its derivatives, fused.
    fn constraint_derivatives<T: Scalar>(
        constants: &Self::PerConstant<T>,
        t: T,
        q: &Self::PerCoordinate<T>,
    ) -> (Self::PerConstraint<T>, Self::PerJacobianEntry<T>);

    /// `γ(t, q, v) = vᵀ φ_qq v + 2 φ_qt v + φ_tt`, so that `d²φ/dt² = G q̈ + γ`.
    fn constraint_curvature<T: Scalar>(
        constants: &Self::PerConstant<T>,
        t: T,
        q: &Self::PerCoordinate<T>,
        v: &Self::PerCoordinate<T>,
    ) -> Self::PerConstraint<T>;

    /// `f(t, q, v, u)`: the generalized forces that are no derivatives of `L`, so that
    /// `d/dt ∂L/∂v − ∂L/∂q + Gᵀλ = f`. The sum of the items `force` and of `−∂D/∂v` for the item `dissipation`; zero
    /// without such items.
    #[inline]
    fn forces<T: Scalar>(
        _constants: &Self::PerConstant<T>,
        _t: T,
        _q: &Self::PerCoordinate<T>,
        _v: &Self::PerCoordinate<T>,
        _inputs: &Self::PerInput<T>,
    ) -> Self::PerCoordinate<T> {
        Array::from_fn(|_| T::from_f64(0.0))
    }

    /// `f(t, q, v, u)` and the varying entries of `∂f/∂q` and `∂f/∂v`, fused.
    #[inline]
    fn force_derivatives<T: Scalar>(
        constants: &Self::PerConstant<T>,
        t: T,
        q: &Self::PerCoordinate<T>,
        v: &Self::PerCoordinate<T>,
        inputs: &Self::PerInput<T>,
    ) -> (Self::PerCoordinate<T>, Self::PerForceEntry<T>) {
        (Self::forces(constants, t, q, v, inputs), Array::from_fn(|_| T::from_f64(0.0)))
    }

    /// The quantities of the items `observe`.
    #[inline]
    fn observables<T: Scalar>(
        _constants: &Self::PerConstant<T>,
        _t: T,
        _q: &Self::PerCoordinate<T>,
        _v: &Self::PerCoordinate<T>,
        _inputs: &Self::PerInput<T>,
    ) -> Self::PerObservable<T> {
        Array::from_fn(|_| T::from_f64(0.0))
    }
}

/// First derivatives of a Lagrangian.
pub struct LagrangianGradient<S: MechanicalSystem, T: Clone> {
    /// `∂L/∂q`: the generalized force.
    pub force: S::PerCoordinate<T>,
    /// `∂L/∂v`: the generalized momentum.
    pub momentum: S::PerCoordinate<T>,
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
            jacobian: JacobianPattern { q: &[], t: &[] },
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
            operations: KernelOperations {
                constants: NONE,
                lagrangian: NONE,
                lagrangian_gradient: NONE,
                lagrangian_derivatives: NONE,
                constraints: NONE,
                constraint_derivatives: NONE,
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

    /// Whether neither `L` nor `φ` nor a force depends on time.
    pub const fn is_autonomous(&self) -> bool {
        !(self.lagrangian.on_t || self.constraints.on_t || self.forces.on.on_t)
    }

    /// Whether `L = ½ vᵀ M v − V(t, q)` with constant `M`.
    pub const fn is_separable_with_constant_mass(&self) -> bool {
        self.mass.is_constant() && self.hessian.vq.is_empty() && self.hessian.vt.is_empty()
    }
}

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

/// The structurally nonzero second derivatives of `L`, block by block.
#[derive(Clone, Copy, Debug)]
pub struct HessianPattern {
    /// `∂²L/∂q²`, lower triangle (`row ≥ col`).
    pub qq: &'static [Entry],
    /// `∂²L/∂v∂q`: row of `v`, column of `q`.
    pub vq: &'static [Entry],
    /// `∂²L/∂v²`, lower triangle.
    pub vv: &'static [Entry],
    /// `∂²L/∂v∂t`: row of `v`, column 0.
    pub vt: &'static [Entry],
}

impl HessianPattern {
    /// Whether every second derivative of `L` is constant: `L` is a polynomial of degree two in `(q, v)`.
    pub const fn is_constant(&self) -> bool {
        is_constant(self.qq) && is_constant(self.vq) && is_constant(self.vv) && is_constant(self.vt)
    }
}

const fn has_column(entries: &[Entry], col: usize) -> bool {
    let mut k = 0;
    while k < entries.len() {
        if entries[k].col == col {
            return true;
        }
        k += 1;
    }
    false
}

const fn has_row(entries: &[Entry], row: usize) -> bool {
    let mut k = 0;
    while k < entries.len() {
        if entries[k].row == row {
            return true;
        }
        k += 1;
    }
    false
}

const fn is_diagonal(entries: &[Entry]) -> bool {
    let mut k = 0;
    while k < entries.len() {
        if entries[k].row != entries[k].col {
            return false;
        }
        k += 1;
    }
    true
}

const fn is_constant(entries: &[Entry]) -> bool {
    let mut k = 0;
    while k < entries.len() {
        if let EntryValue::Varying(_) = entries[k].value {
            return false;
        }
        k += 1;
    }
    true
}

/// The structurally nonzero derivatives of `φ`.
#[derive(Clone, Copy, Debug)]
pub struct JacobianPattern {
    /// `G = ∂φ/∂q`: row of the constraint, column of the coordinate.
    pub q: &'static [Entry],
    /// `∂φ/∂t`: row of the constraint, column 0.
    pub t: &'static [Entry],
}

/// Place and origin of one structurally nonzero matrix entry.
#[derive(Clone, Copy, Debug)]
pub struct Entry {
    /// Row in the block.
    pub row: usize,
    /// Column in the block.
    pub col: usize,
    /// Where its value comes from.
    pub value: EntryValue,
}

impl Entry {
    /// Whether a kernel computes it.
    pub const fn is_varying(&self) -> bool {
        matches!(self.value, EntryValue::Varying(_))
    }

    /// The entry's value, from the scene's constants or from what its kernel returned.
    #[inline]
    pub fn value<T: Copy>(&self, constants: &[T], varying: &[T]) -> T {
        match self.value {
            EntryValue::Constant(slot) => constants[slot],
            EntryValue::Varying(index) => varying[index],
        }
    }

    /// The same of numbers, and none where there is no value: for loops over entries that are not unrolled, where the optimiser does not find out that
    /// there is one.
    #[inline]
    pub(crate) fn number(&self, constants: &[f64], varying: &[f64]) -> f64 {
        let value = match self.value {
            EntryValue::Constant(slot) => constants.get(slot),
            EntryValue::Varying(index) => varying.get(index),
        };
        value.copied().unwrap_or(f64::NAN)
    }
}

/// Where the value of a matrix entry comes from.
#[derive(Clone, Copy, Debug)]
pub enum EntryValue {
    /// Constant of the scene, at this index.
    Constant(usize),
    /// Varying entry, at this index of the kernel's output.
    Varying(usize),
}

/// Operations of each emitted kernel.
#[derive(Clone, Copy, Debug)]
pub struct KernelOperations {
    /// [`MechanicalSystem::constants`].
    pub constants: Operations,
    /// [`MechanicalSystem::lagrangian`].
    pub lagrangian: Operations,
    /// [`MechanicalSystem::lagrangian_gradient`].
    pub lagrangian_gradient: Operations,
    /// [`MechanicalSystem::lagrangian_derivatives`].
    pub lagrangian_derivatives: Operations,
    /// [`MechanicalSystem::constraints`].
    pub constraints: Operations,
    /// [`MechanicalSystem::constraint_derivatives`].
    pub constraint_derivatives: Operations,
    /// [`MechanicalSystem::constraint_curvature`].
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
