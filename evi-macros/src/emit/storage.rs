//! The index sets of a system as array types, shared by the implementation and the fallback.

use proc_macro2::TokenStream;
use quote::quote;

/// How many elements each index set has.
pub(super) struct Sizes {
    pub(super) n_coordinates: usize,
    pub(super) n_constraints: usize,
    pub(super) n_parameters: usize,
    pub(super) n_constants: usize,
    pub(super) n_hessian_entries: usize,
    pub(super) n_jacobian_entries: usize,
    pub(super) n_inputs: usize,
    pub(super) n_observables: usize,
    pub(super) n_force_entries: usize,
}

/// The associated types of `MechanicalSystem`.
pub(super) fn associated_types(sizes: &Sizes) -> TokenStream {
    let Sizes {
        n_coordinates,
        n_constraints,
        n_parameters,
        n_constants,
        n_hessian_entries,
        n_jacobian_entries,
        n_inputs,
        n_observables,
        n_force_entries,
    } = *sizes;
    let n_unknowns = n_coordinates + n_constraints;
    quote! {
        type PerCoordinate<X: ::core::clone::Clone> = [X; #n_coordinates];
        type PerConstraint<X: ::core::clone::Clone> = [X; #n_constraints];
        type PerUnknown<X: ::core::clone::Clone> = [X; #n_unknowns];
        type PerParameter<X: ::core::clone::Clone> = [X; #n_parameters];
        type PerConstant<X: ::core::clone::Clone> = [X; #n_constants];
        type PerHessianEntry<X: ::core::clone::Clone> = [X; #n_hessian_entries];
        type PerJacobianEntry<X: ::core::clone::Clone> = [X; #n_jacobian_entries];
        type PerInput<X: ::core::clone::Clone> = [X; #n_inputs];
        type PerObservable<X: ::core::clone::Clone> = [X; #n_observables];
        type PerForceEntry<X: ::core::clone::Clone> = [X; #n_force_entries];
        type DenseKktFactors = ::evi_core::__private::DenseLu<#n_unknowns>;
    }
}

/// The solvers of a system whose equations are not known, or that takes no steps.
pub(super) fn dense_solvers(n_coordinates: usize, n_constraints: usize) -> TokenStream {
    let n_unknowns = n_coordinates + n_constraints;
    quote! {
        type KktFactors = ::evi_core::__private::DenseLu<#n_unknowns>;
        type MassFactors = ::evi_core::__private::DenseLu<#n_coordinates>;
        type GramFactors = ::evi_core::__private::DenseLu<#n_constraints>;
    }
}
