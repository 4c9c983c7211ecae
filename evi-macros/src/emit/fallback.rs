//! What stands in for the implementation where the struct has mistakes.

use proc_macro2::TokenStream;
use quote::{quote, quote_spanned};

use super::storage::{Sizes, associated_types};
use crate::diagnostics::Diagnostics;
use crate::model::{constraint_names, coordinate_names};
use crate::syntax::Declaration;

/// The mistakes as compile errors, and a stub with the true sizes: code that uses the system type-checks as it will
/// when they are mended, so that no second wave of errors hides the first.
pub(crate) fn fallback(declaration: &Declaration, diagnostics: &Diagnostics) -> TokenStream {
    let errors = compile_errors(diagnostics);
    let struct_name = &declaration.name;
    let generics = &declaration.generics;
    let (impl_generics, type_generics, where_clause) =
        (&generics.impl_generics, &generics.type_generics, &generics.where_clause);
    let coordinates: Vec<String> = coordinate_names(declaration).iter().map(ToString::to_string).collect();
    let constraints: Vec<String> = constraint_names(declaration).iter().map(ToString::to_string).collect();
    let sizes = Sizes {
        n_coordinates: coordinates.len(),
        n_constraints: constraints.len(),
        n_parameters: 0,
        n_constants: 0,
        n_hessian_entries: 0,
        n_jacobian_entries: 0,
    };
    let types = associated_types(&sizes);
    let (n_coordinates, n_constraints) = (sizes.n_coordinates, sizes.n_constraints);
    quote! {
        #errors
        const _: () = {
            #[automatically_derived]
            #[allow(unused)]
            impl #impl_generics ::evi_core::__private::MechanicalSystem for #struct_name #type_generics #where_clause {
                const COORDINATES: &'static [&'static str] = &[#(#coordinates),*];
                const CONSTRAINTS: &'static [&'static str] = &[#(#constraints),*];
                const PARAMETERS: &'static [&'static str] = &[];
                const STRUCTURE: ::evi_core::__private::Structure = ::evi_core::__private::Structure::UNKNOWN;
                #types

                fn parameters(&self) -> Self::PerParameter<f64> {
                    ::core::unimplemented!()
                }
                fn constants<T: ::evi_core::__private::Scalar>(p: &Self::PerParameter<T>) -> Self::PerConstant<T> {
                    ::core::unimplemented!()
                }
                fn lagrangian<T: ::evi_core::__private::Scalar>(
                    c: &Self::PerConstant<T>, t: T, q: &Self::PerCoordinate<T>, v: &Self::PerCoordinate<T>,
                ) -> T {
                    ::core::unimplemented!()
                }
                fn lagrangian_gradient<T: ::evi_core::__private::Scalar>(
                    c: &Self::PerConstant<T>, t: T, q: &Self::PerCoordinate<T>, v: &Self::PerCoordinate<T>,
                ) -> ::evi_core::__private::LagrangianGradient<Self, T> {
                    ::core::unimplemented!()
                }
                fn lagrangian_derivatives<T: ::evi_core::__private::Scalar>(
                    c: &Self::PerConstant<T>, t: T, q: &Self::PerCoordinate<T>, v: &Self::PerCoordinate<T>,
                ) -> (::evi_core::__private::LagrangianGradient<Self, T>, Self::PerHessianEntry<T>) {
                    ::core::unimplemented!()
                }
                fn constraints<T: ::evi_core::__private::Scalar>(
                    c: &Self::PerConstant<T>, t: T, q: &Self::PerCoordinate<T>,
                ) -> Self::PerConstraint<T> {
                    ::core::unimplemented!()
                }
                fn constraint_derivatives<T: ::evi_core::__private::Scalar>(
                    c: &Self::PerConstant<T>, t: T, q: &Self::PerCoordinate<T>,
                ) -> (Self::PerConstraint<T>, Self::PerJacobianEntry<T>) {
                    ::core::unimplemented!()
                }
                fn constraint_curvature<T: ::evi_core::__private::Scalar>(
                    c: &Self::PerConstant<T>, t: T, q: &Self::PerCoordinate<T>, v: &Self::PerCoordinate<T>,
                ) -> Self::PerConstraint<T> {
                    ::core::unimplemented!()
                }
            }

            #[automatically_derived]
            #[allow(unused)]
            impl #impl_generics ::evi_core::__private::GenericSystem for #struct_name #type_generics #where_clause {
                fn n_coordinates(&self) -> usize {
                    #n_coordinates
                }
                fn n_constraints(&self) -> usize {
                    #n_constraints
                }
                fn lagrangian<T: ::evi_core::__private::Scalar>(&self, t: T, q: &[T], v: &[T]) -> T {
                    ::core::unimplemented!()
                }
                fn constraints<T: ::evi_core::__private::Scalar>(&self, t: T, q: &[T], residuals: &mut [T]) {
                    ::core::unimplemented!()
                }
            }
        };
    }
}

/// The mistakes as compile errors, each at its token.
pub(crate) fn compile_errors(diagnostics: &Diagnostics) -> TokenStream {
    let error = |mistake: &crate::diagnostics::Mistake| {
        let message = &mistake.message;
        quote_spanned!(mistake.span=> ::core::compile_error!(#message);)
    };
    diagnostics.mistakes().iter().map(error).collect()
}
