//! A scene without what is known about its structure: every step solves the whole saddle-point system by pivoted dense elimination.

use crate::scalar::Scalar;
use crate::system::{
    Dependence, HasFrequencies, LagrangianGradient, MechanicalSystem, Structure, SystemReport,
};

/// The scene `S` with its emitted kernels, but stepped as by a solver that knows only sizes: nothing is folded or eliminated, every
/// Newton correction assembles the `(n + m) × (n + m)` matrix `[hA G₀ᵀ; G₁ 0]` and factors it by the pivoted dense
/// elimination. Its motions are those of `S` to round-off.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dense<S>(pub S);

impl<S: MechanicalSystem> MechanicalSystem for Dense<S> {
    const COORDINATES: &'static [&'static str] = S::COORDINATES;
    const CONSTRAINTS: &'static [&'static str] = S::CONSTRAINTS;
    const PARAMETERS: &'static [&'static str] = S::PARAMETERS;
    const INPUTS: &'static [&'static str] = S::INPUTS;
    const OBSERVABLES: &'static [&'static str] = S::OBSERVABLES;
    // Patterns stay, since the kernels fill them. Where the Lagrangian and its mass matrix might depend on time, nothing is folded.
    const STRUCTURE: Structure = Structure {
        lagrangian: Dependence { on_t: true, ..S::STRUCTURE.lagrangian },
        mass: Dependence { on_t: true, ..S::STRUCTURE.mass },
        ..S::STRUCTURE
    };
    const REPORT: SystemReport = SystemReport { structure: Self::STRUCTURE, ..S::REPORT };
    const SOURCE: Option<&'static str> = S::SOURCE;

    type PerCoordinate<X: Clone> = S::PerCoordinate<X>;
    type PerConstraint<X: Clone> = S::PerConstraint<X>;
    type PerUnknown<X: Clone> = S::PerUnknown<X>;
    type PerParameter<X: Clone> = S::PerParameter<X>;
    type PerConstant<X: Clone> = S::PerConstant<X>;
    type PerHessianEntry<X: Clone> = S::PerHessianEntry<X>;
    type PerJacobianEntry<X: Clone> = S::PerJacobianEntry<X>;
    type PerInput<X: Clone> = S::PerInput<X>;
    type PerObservable<X: Clone> = S::PerObservable<X>;
    type PerForceEntry<X: Clone> = S::PerForceEntry<X>;

    type KktFactors = S::DenseKktFactors;
    type DenseKktFactors = S::DenseKktFactors;
    type MassFactors = S::MassFactors;
    type GramFactors = S::GramFactors;

    #[inline]
    fn parameters(&self) -> Self::PerParameter<f64> {
        self.0.parameters()
    }

    #[inline]
    fn constants<T: Scalar>(parameters: &Self::PerParameter<T>) -> Self::PerConstant<T> {
        S::constants(parameters)
    }

    #[inline]
    fn lagrangian<T: Scalar>(
        constants: &Self::PerConstant<T>,
        t: T,
        q: &Self::PerCoordinate<T>,
        v: &Self::PerCoordinate<T>,
    ) -> T {
        S::lagrangian(constants, t, q, v)
    }

    #[inline]
    fn lagrangian_gradient<T: Scalar>(
        constants: &Self::PerConstant<T>,
        t: T,
        q: &Self::PerCoordinate<T>,
        v: &Self::PerCoordinate<T>,
    ) -> LagrangianGradient<Self, T> {
        let LagrangianGradient { force, momentum } = S::lagrangian_gradient(constants, t, q, v);
        LagrangianGradient { force, momentum }
    }

    #[inline]
    fn lagrangian_derivatives<T: Scalar>(
        constants: &Self::PerConstant<T>,
        t: T,
        q: &Self::PerCoordinate<T>,
        v: &Self::PerCoordinate<T>,
    ) -> (LagrangianGradient<Self, T>, Self::PerHessianEntry<T>) {
        let (LagrangianGradient { force, momentum }, hessian) = S::lagrangian_derivatives(constants, t, q, v);
        (LagrangianGradient { force, momentum }, hessian)
    }

    #[inline]
    fn constraints<T: Scalar>(
        constants: &Self::PerConstant<T>,
        t: T,
        q: &Self::PerCoordinate<T>,
    ) -> Self::PerConstraint<T> {
        S::constraints(constants, t, q)
    }

    #[inline]
    fn constraint_derivatives<T: Scalar>(
        constants: &Self::PerConstant<T>,
        t: T,
        q: &Self::PerCoordinate<T>,
    ) -> (Self::PerConstraint<T>, Self::PerJacobianEntry<T>) {
        S::constraint_derivatives(constants, t, q)
    }

    #[inline]
    fn constraint_curvature<T: Scalar>(
        constants: &Self::PerConstant<T>,
        t: T,
        q: &Self::PerCoordinate<T>,
        v: &Self::PerCoordinate<T>,
    ) -> Self::PerConstraint<T> {
        S::constraint_curvature(constants, t, q, v)
    }

    #[inline]
    fn forces<T: Scalar>(
        constants: &Self::PerConstant<T>,
        t: T,
        q: &Self::PerCoordinate<T>,
        v: &Self::PerCoordinate<T>,
        inputs: &Self::PerInput<T>,
    ) -> Self::PerCoordinate<T> {
        S::forces(constants, t, q, v, inputs)
    }

    #[inline]
    fn force_derivatives<T: Scalar>(
        constants: &Self::PerConstant<T>,
        t: T,
        q: &Self::PerCoordinate<T>,
        v: &Self::PerCoordinate<T>,
        inputs: &Self::PerInput<T>,
    ) -> (Self::PerCoordinate<T>, Self::PerForceEntry<T>) {
        S::force_derivatives(constants, t, q, v, inputs)
    }

    #[inline]
    fn observables<T: Scalar>(
        constants: &Self::PerConstant<T>,
        t: T,
        q: &Self::PerCoordinate<T>,
        v: &Self::PerCoordinate<T>,
        inputs: &Self::PerInput<T>,
    ) -> Self::PerObservable<T> {
        S::observables(constants, t, q, v, inputs)
    }
}

impl<S: HasFrequencies> HasFrequencies for Dense<S> {
    #[inline]
    fn frequencies<T: Scalar>(constants: &Self::PerConstant<T>) -> Self::PerCoordinate<T> {
        S::frequencies(constants)
    }
}
