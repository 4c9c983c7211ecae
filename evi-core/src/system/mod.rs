//! What the derive emits for a scene: the contract between the symbolic compiler and the integrators.
//!
//! A scene is a Lagrangian `L(t, q, v)` with `n` coordinates `q`, velocities `v`, and `m` holonomic constraints
//! `φ(t, q) = 0` with Jacobian `G = ∂φ/∂q` (`m × n`). The derive emits its kernels, its structure and the storage
//! types of its index sets; nothing here loops over nodes or iterates.

mod classification;
mod forces;
mod operations;
mod pattern;
mod report;
mod structure;
mod wrapped;

pub use classification::{Block, CentralForce, ConstraintStructure, HessianBlocks, MassShape, Potential};
pub use forces::{ForceStructure, HasFrequencies};
pub use operations::{KernelOperations, Operations};
pub use pattern::{Entry, EntryValue, HessianPattern, JacobianPattern};
pub use report::{Equation, Formula, KernelReport, SystemReport};
pub use structure::{Dependence, Structure};
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

    /// `φ(t, q)` and the varying entries of its derivatives over their [content](JacobianPattern::content), fused.
    fn constraint_slopes<T: Scalar>(
        constants: &Self::PerConstant<T>,
        t: T,
        q: &Self::PerCoordinate<T>,
    ) -> (Self::PerConstraint<T>, Self::PerJacobianEntry<T>);

    /// `φ(t, q)` and the varying entries of its derivatives, fused.
    #[inline(always)]
    fn constraint_derivatives<T: Scalar>(
        constants: &Self::PerConstant<T>,
        t: T,
        q: &Self::PerCoordinate<T>,
    ) -> (Self::PerConstraint<T>, Self::PerJacobianEntry<T>) {
        let (residuals, slopes) = Self::constraint_slopes(constants, t, q);
        let content = const { Self::STRUCTURE.jacobian.content };
        if content == 1.0 {
            return (residuals, slopes);
        }
        (residuals, Array::from_fn(|entry| slopes[entry] * T::from_f64(content)))
    }

    /// `γ(t, q, v) = vᵀ φ_qq v + 2 φ_qt v + φ_tt`, so that `d²φ/dt² = G q̈ + γ`.
    fn constraint_curvature<T: Scalar>(
        constants: &Self::PerConstant<T>,
        t: T,
        q: &Self::PerCoordinate<T>,
        v: &Self::PerCoordinate<T>,
    ) -> Self::PerConstraint<T>;

    /// Calls `visit(row, col, G[row][col])` for every entry of the Jacobian that is not zero, in the order of its pattern. The derive writes the calls
    /// out, so that inlined they know their places: products with `G` are straight-line code.
    #[inline(always)]
    fn for_each_slope<T: Copy>(
        constants: &Self::PerConstant<T>,
        jacobian: &Self::PerJacobianEntry<T>,
        mut visit: impl FnMut(usize, usize, T),
    ) {
        for entry in Self::STRUCTURE.jacobian.q {
            visit(entry.row, entry.col, entry.value(constants.as_ref(), jacobian.as_ref()));
        }
    }

    /// Calls `visit(row, other, col, G[row][col], G[other][col])` for every pair of entries of the Jacobian in one column with `other ≤ row`: what the
    /// lower triangle of `G D Gᵀ` with a diagonal `D` is the sum of. Written out as [`for_each_slope`](Self::for_each_slope) is.
    #[inline(always)]
    fn for_each_gram_product<T: Copy>(
        constants: &Self::PerConstant<T>,
        jacobian: &Self::PerJacobianEntry<T>,
        mut visit: impl FnMut(usize, usize, usize, T, T),
    ) {
        let value = |entry: &Entry| entry.value(constants.as_ref(), jacobian.as_ref());
        for entry in Self::STRUCTURE.jacobian.q {
            let is_paired = |other: &&Entry| other.col == entry.col && other.row <= entry.row;
            for other in Self::STRUCTURE.jacobian.q.iter().filter(is_paired) {
                visit(entry.row, other.row, entry.col, value(entry), value(other));
            }
        }
    }

    /// Calls `visit(row, other, col, G[row][col])` for every pair of entries of the Jacobian in one column, the second of them in the row `other`: what
    /// the entry `(row, other)` of `G D Gᵀ` with a diagonal `D` is the sum of. Written out as [`for_each_slope`](Self::for_each_slope) is.
    #[inline(always)]
    fn for_each_slope_pair<T: Copy>(
        constants: &Self::PerConstant<T>,
        jacobian: &Self::PerJacobianEntry<T>,
        mut visit: impl FnMut(usize, usize, usize, T),
    ) {
        for entry in Self::STRUCTURE.jacobian.q {
            let slope = entry.value(constants.as_ref(), jacobian.as_ref());
            for other in Self::STRUCTURE.jacobian.q.iter().filter(|other| other.col == entry.col) {
                visit(entry.row, other.row, entry.col, slope);
            }
        }
    }

    /// Calls `visit(row, col, ∂²L/∂v[row]∂v[col])` for every entry that is not zero, above the diagonal too. Written out as
    /// [`for_each_slope`](Self::for_each_slope) is.
    #[inline(always)]
    fn for_each_vv<T: Copy>(
        constants: &Self::PerConstant<T>,
        hessian: &Self::PerHessianEntry<T>,
        visit: impl FnMut(usize, usize, T),
    ) {
        pattern::for_each_of_both(Self::STRUCTURE.hessian.vv, constants.as_ref(), hessian.as_ref(), visit);
    }

    /// Calls `visit(row, col, ∂²L/∂q[row]∂q[col])` in the same way.
    #[inline(always)]
    fn for_each_qq<T: Copy>(
        constants: &Self::PerConstant<T>,
        hessian: &Self::PerHessianEntry<T>,
        visit: impl FnMut(usize, usize, T),
    ) {
        pattern::for_each_of_both(Self::STRUCTURE.hessian.qq, constants.as_ref(), hessian.as_ref(), visit);
    }

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

    /// `r²` and `r ∂r/∂q`, where `r` is the distance of the central force ([`Structure::central_force`]); these four functions are zero for scenes
    /// without one.
    #[inline]
    fn squared_distance<T: Scalar>(
        _constants: &Self::PerConstant<T>,
        _q: &Self::PerCoordinate<T>,
    ) -> (T, Self::PerCoordinate<T>) {
        (T::from_f64(0.0), Array::from_fn(|_| T::from_f64(0.0)))
    }

    /// `½ ∂²r²/∂q²`, by rows.
    #[inline]
    fn distance_metric<T: Scalar>(
        _constants: &Self::PerConstant<T>,
    ) -> Self::PerCoordinate<Self::PerCoordinate<T>> {
        Array::from_fn(|_| Array::from_fn(|_| T::from_f64(0.0)))
    }

    /// `F'(r)` and `F''(r)`: the central force is `−F' ∂r/∂q`.
    #[inline]
    fn central_force<T: Scalar>(_constants: &Self::PerConstant<T>, _r: T) -> [T; 2] {
        [T::from_f64(0.0); 2]
    }

    /// `f`: the uniform force beside the central one.
    #[inline]
    fn uniform_force<T: Scalar>(_constants: &Self::PerConstant<T>) -> Self::PerCoordinate<T> {
        Array::from_fn(|_| T::from_f64(0.0))
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
