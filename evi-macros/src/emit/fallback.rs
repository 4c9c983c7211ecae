//! What stands in for the implementation where the struct has mistakes.

use proc_macro2::{Delimiter, Group, TokenStream};
use quote::{quote, quote_spanned};

use super::storage::{Sizes, associated_types, dense_solvers};
use crate::diagnostics::{Diagnostics, Mistake};
use crate::model::{constraint_names, coordinate_names, has_frequencies, input_names, observable_names};
use crate::syntax::Declaration;

/// The mistakes as compile errors, and a stub with the true sizes: code that uses the system type-checks as
/// it will when they are mended, so that no second wave of errors hides the first. The compile errors keep the stub from ever
/// running, hence `unimplemented!` and arguments that nothing uses. Its scalar is called
/// `__T`: a struct that is generic by mistake has most likely a `T` of its own.
pub(crate) fn fallback(declaration: &Declaration, diagnostics: &Diagnostics) -> TokenStream {
    let errors = compile_errors(diagnostics);
    let struct_name = &declaration.name;
    let generics = &declaration.generics;
    let (impl_generics, type_generics, where_clause) =
        (&generics.impl_generics, &generics.type_generics, &generics.where_clause);
    let coordinates = coordinate_names(declaration);
    let constraints = constraint_names(declaration);
    let inputs: Vec<String> = input_names(declaration).map(ToString::to_string).collect();
    let observables = observable_names(declaration);
    let sizes = Sizes {
        n_inputs: inputs.len(),
        n_observables: observables.len(),
        n_force_entries: 0,
        n_coordinates: coordinates.len(),
        n_constraints: constraints.len(),
        n_parameters: 0,
        n_constants: 0,
        n_hessian_entries: 0,
        n_jacobian_entries: 0,
    };
    let types = associated_types(&sizes);
    let solvers = dense_solvers(sizes.n_coordinates, sizes.n_constraints);
    let (n_coordinates, n_constraints) = (sizes.n_coordinates, sizes.n_constraints);
    let frequencies = has_frequencies(declaration).then(|| {
        quote! {
            #[automatically_derived]
            #[allow(unused)]
            impl #impl_generics ::evi_core::__private::HasFrequencies for #struct_name #type_generics
            #where_clause
            {
                fn frequencies<__T: ::evi_core::__private::Scalar>(
                    c: &Self::PerConstant<__T>,
                ) -> Self::PerCoordinate<__T> {
                    ::core::unimplemented!()
                }
            }
        }
    });
    quote! {
        #errors
        const _: () = {
            #[automatically_derived]
            #[allow(unused)]
            impl #impl_generics ::evi_core::__private::MechanicalSystem for #struct_name #type_generics
            #where_clause
            {
                const COORDINATES: &'static [&'static str] = &[#(#coordinates),*];
                const CONSTRAINTS: &'static [&'static str] = &[#(#constraints),*];
                const PARAMETERS: &'static [&'static str] = &[];
                const INPUTS: &'static [&'static str] = &[#(#inputs),*];
                const OBSERVABLES: &'static [&'static str] = &[#(#observables),*];
                const STRUCTURE: ::evi_core::__private::Structure = ::evi_core::__private::Structure::UNKNOWN;
                const REPORT: ::evi_core::__private::SystemReport =
                    ::evi_core::__private::SystemReport::UNKNOWN;
                #types
                #solvers

                fn parameters(&self) -> Self::PerParameter<f64> {
                    ::core::unimplemented!()
                }
                fn constants<__T: ::evi_core::__private::Scalar>(
                    p: &Self::PerParameter<__T>,
                ) -> Self::PerConstant<__T> {
                    ::core::unimplemented!()
                }
                fn lagrangian<__T: ::evi_core::__private::Scalar>(
                    c: &Self::PerConstant<__T>,
                    t: __T,
                    q: &Self::PerCoordinate<__T>,
                    v: &Self::PerCoordinate<__T>,
                ) -> __T {
                    ::core::unimplemented!()
                }
                fn lagrangian_gradient<__T: ::evi_core::__private::Scalar>(
                    c: &Self::PerConstant<__T>,
                    t: __T,
                    q: &Self::PerCoordinate<__T>,
                    v: &Self::PerCoordinate<__T>,
                ) -> ::evi_core::__private::LagrangianGradient<Self, __T> {
                    ::core::unimplemented!()
                }
                fn lagrangian_derivatives<__T: ::evi_core::__private::Scalar>(
                    c: &Self::PerConstant<__T>,
                    t: __T,
                    q: &Self::PerCoordinate<__T>,
                    v: &Self::PerCoordinate<__T>,
                ) -> (::evi_core::__private::LagrangianGradient<Self, __T>, Self::PerHessianEntry<__T>) {
                    ::core::unimplemented!()
                }
                fn constraints<__T: ::evi_core::__private::Scalar>(
                    c: &Self::PerConstant<__T>,
                    t: __T,
                    q: &Self::PerCoordinate<__T>,
                ) -> Self::PerConstraint<__T> {
                    ::core::unimplemented!()
                }
                fn constraint_slopes<__T: ::evi_core::__private::Scalar>(
                    c: &Self::PerConstant<__T>,
                    t: __T,
                    q: &Self::PerCoordinate<__T>,
                ) -> (Self::PerConstraint<__T>, Self::PerJacobianEntry<__T>) {
                    ::core::unimplemented!()
                }
                fn constraint_curvature<__T: ::evi_core::__private::Scalar>(
                    c: &Self::PerConstant<__T>,
                    t: __T,
                    q: &Self::PerCoordinate<__T>,
                    v: &Self::PerCoordinate<__T>,
                ) -> Self::PerConstraint<__T> {
                    ::core::unimplemented!()
                }
            }

            #frequencies

            #[automatically_derived]
            #[allow(unused)]
            impl #impl_generics ::evi_core::__private::GenericSystem for #struct_name #type_generics
            #where_clause
            {
                fn n_coordinates(&self) -> usize {
                    #n_coordinates
                }
                fn n_constraints(&self) -> usize {
                    #n_constraints
                }
                fn lagrangian<__T: ::evi_core::__private::Scalar>(
                    &self,
                    t: __T,
                    q: &[__T],
                    v: &[__T],
                ) -> __T {
                    ::core::unimplemented!()
                }
                fn constraints<__T: ::evi_core::__private::Scalar>(
                    &self,
                    t: __T,
                    q: &[__T],
                    residuals: &mut [__T],
                ) {
                    ::core::unimplemented!()
                }
            }
        };
    }
}

/// The mistakes as compile errors, and a stub of a scene of loops.
pub(crate) fn assembled_fallback(declaration: &Declaration, diagnostics: &Diagnostics) -> TokenStream {
    let errors = compile_errors(diagnostics);
    let struct_name = &declaration.name;
    quote! {
        #errors
        const _: () = {
            #[automatically_derived]
            #[allow(unused)]
            impl ::evi_core::__private::AssembledSystem for #struct_name {
                fn n_coordinates(&self) -> usize {
                    ::core::unimplemented!()
                }
                fn visit_families<V: ::evi_core::__private::FamilyVisitor<Self>>(&self, visitor: &mut V) {}
            }
        };
    }
}

/// The mistakes as compile errors, each at its tokens.
pub(crate) fn compile_errors(diagnostics: &Diagnostics) -> TokenStream {
    let error = |mistake: &Mistake| {
        let message = &mistake.message;
        let mut argument = Group::new(Delimiter::Brace, quote_spanned!(mistake.last=> #message));
        argument.set_span(mistake.last);
        // The compiler marks an invocation from its first to its last token.
        quote_spanned!(mistake.first=> ::core::compile_error! #argument)
    };
    diagnostics.mistakes().into_iter().map(error).collect()
}
