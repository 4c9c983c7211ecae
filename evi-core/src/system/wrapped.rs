//! Scenes that wrap another one: the same equations, solved differently.

/// The items of [`MechanicalSystem`](super::MechanicalSystem) that a wrapper `W(S)` takes from the scene `S` in it: names, storage, kernels,
/// and a structure of which nothing is folded. What is left to it are its solvers.
macro_rules! unfolded_scene_of_inner {
    () => {
        const COORDINATES: &'static [&'static str] = S::COORDINATES;
        const CONSTRAINTS: &'static [&'static str] = S::CONSTRAINTS;
        const PARAMETERS: &'static [&'static str] = S::PARAMETERS;
        const INPUTS: &'static [&'static str] = S::INPUTS;
        const OBSERVABLES: &'static [&'static str] = S::OBSERVABLES;
        // Patterns stay, since the kernels fill them. Where the Lagrangian and its mass matrix might depend on time, nothing is folded, and no force
        // is taken for a central one.
        const STRUCTURE: $crate::system::Structure = $crate::system::Structure {
            lagrangian: $crate::system::Dependence { on_t: true, ..S::STRUCTURE.lagrangian },
            mass: $crate::system::Dependence { on_t: true, ..S::STRUCTURE.mass },
            central_force: None,
            ..S::STRUCTURE
        };
        const REPORT: $crate::system::SystemReport =
            $crate::system::SystemReport { structure: Self::STRUCTURE, ..S::REPORT };
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

        #[inline]
        fn parameters(&self) -> Self::PerParameter<f64> {
            self.0.parameters()
        }

        #[inline]
        fn constants<T: $crate::scalar::Scalar>(parameters: &Self::PerParameter<T>) -> Self::PerConstant<T> {
            S::constants(parameters)
        }

        #[inline]
        fn lagrangian<T: $crate::scalar::Scalar>(
            constants: &Self::PerConstant<T>,
            t: T,
            q: &Self::PerCoordinate<T>,
            v: &Self::PerCoordinate<T>,
        ) -> T {
            S::lagrangian(constants, t, q, v)
        }

        #[inline]
        fn lagrangian_gradient<T: $crate::scalar::Scalar>(
            constants: &Self::PerConstant<T>,
            t: T,
            q: &Self::PerCoordinate<T>,
            v: &Self::PerCoordinate<T>,
        ) -> $crate::system::LagrangianGradient<Self, T> {
            let $crate::system::LagrangianGradient { force, momentum } =
                S::lagrangian_gradient(constants, t, q, v);
            $crate::system::LagrangianGradient { force, momentum }
        }

        #[inline]
        fn lagrangian_derivatives<T: $crate::scalar::Scalar>(
            constants: &Self::PerConstant<T>,
            t: T,
            q: &Self::PerCoordinate<T>,
            v: &Self::PerCoordinate<T>,
        ) -> ($crate::system::LagrangianGradient<Self, T>, Self::PerHessianEntry<T>) {
            let ($crate::system::LagrangianGradient { force, momentum }, hessian) =
                S::lagrangian_derivatives(constants, t, q, v);
            ($crate::system::LagrangianGradient { force, momentum }, hessian)
        }

        #[inline]
        fn constraints<T: $crate::scalar::Scalar>(
            constants: &Self::PerConstant<T>,
            t: T,
            q: &Self::PerCoordinate<T>,
        ) -> Self::PerConstraint<T> {
            S::constraints(constants, t, q)
        }

        #[inline]
        fn constraint_slopes<T: $crate::scalar::Scalar>(
            constants: &Self::PerConstant<T>,
            t: T,
            q: &Self::PerCoordinate<T>,
        ) -> (Self::PerConstraint<T>, Self::PerJacobianEntry<T>) {
            S::constraint_slopes(constants, t, q)
        }

        #[inline]
        fn constraint_curvature<T: $crate::scalar::Scalar>(
            constants: &Self::PerConstant<T>,
            t: T,
            q: &Self::PerCoordinate<T>,
            v: &Self::PerCoordinate<T>,
        ) -> Self::PerConstraint<T> {
            S::constraint_curvature(constants, t, q, v)
        }

        #[inline(always)]
        fn for_each_slope<T: Copy>(
            constants: &Self::PerConstant<T>,
            jacobian: &Self::PerJacobianEntry<T>,
            visit: impl FnMut(usize, usize, T),
        ) {
            S::for_each_slope(constants, jacobian, visit)
        }

        #[inline(always)]
        fn for_each_gram_product<T: Copy>(
            constants: &Self::PerConstant<T>,
            jacobian: &Self::PerJacobianEntry<T>,
            visit: impl FnMut(usize, usize, usize, T, T),
        ) {
            S::for_each_gram_product(constants, jacobian, visit)
        }

        #[inline(always)]
        fn for_each_slope_pair<T: Copy>(
            constants: &Self::PerConstant<T>,
            jacobian: &Self::PerJacobianEntry<T>,
            visit: impl FnMut(usize, usize, usize, T),
        ) {
            S::for_each_slope_pair(constants, jacobian, visit)
        }

        #[inline(always)]
        fn for_each_vv<T: Copy>(
            constants: &Self::PerConstant<T>,
            hessian: &Self::PerHessianEntry<T>,
            visit: impl FnMut(usize, usize, T),
        ) {
            S::for_each_vv(constants, hessian, visit)
        }

        #[inline(always)]
        fn for_each_qq<T: Copy>(
            constants: &Self::PerConstant<T>,
            hessian: &Self::PerHessianEntry<T>,
            visit: impl FnMut(usize, usize, T),
        ) {
            S::for_each_qq(constants, hessian, visit)
        }

        #[inline]
        fn forces<T: $crate::scalar::Scalar>(
            constants: &Self::PerConstant<T>,
            t: T,
            q: &Self::PerCoordinate<T>,
            v: &Self::PerCoordinate<T>,
            inputs: &Self::PerInput<T>,
        ) -> Self::PerCoordinate<T> {
            S::forces(constants, t, q, v, inputs)
        }

        #[inline]
        fn force_derivatives<T: $crate::scalar::Scalar>(
            constants: &Self::PerConstant<T>,
            t: T,
            q: &Self::PerCoordinate<T>,
            v: &Self::PerCoordinate<T>,
            inputs: &Self::PerInput<T>,
        ) -> (Self::PerCoordinate<T>, Self::PerForceEntry<T>) {
            S::force_derivatives(constants, t, q, v, inputs)
        }

        #[inline]
        fn observables<T: $crate::scalar::Scalar>(
            constants: &Self::PerConstant<T>,
            t: T,
            q: &Self::PerCoordinate<T>,
            v: &Self::PerCoordinate<T>,
            inputs: &Self::PerInput<T>,
        ) -> Self::PerObservable<T> {
            S::observables(constants, t, q, v, inputs)
        }
    };
}

pub(crate) use unfolded_scene_of_inner;
