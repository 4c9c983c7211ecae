//! The generic copy of a scene of loops: a sum of those of its elements.

use proc_macro2::{Ident, TokenStream};
use quote::quote;

/// `GenericSystem` as loops over the generic copies of the elements.
pub(super) fn generic(
    struct_name: &Ident,
    families: &[Ident],
    n_coordinates: &TokenStream,
    n_inputs: usize,
) -> TokenStream {
    quote! {
        #[allow(unused, trivial_numeric_casts, clippy::all)]
        #[automatically_derived]
        impl ::evi_core::__private::GenericSystem for #struct_name {
            const HAS_DISSIPATION: bool = false #(|| <<#families as ::evi_core::__private::Family<#struct_name>>::Element
                as ::evi_core::__private::GenericSystem>::HAS_DISSIPATION)*;
            const HAS_FORCES: bool = false #(|| <<#families as ::evi_core::__private::Family<#struct_name>>::Element
                as ::evi_core::__private::GenericSystem>::HAS_FORCES)*;

            fn n_coordinates(&self) -> usize {
                #n_coordinates
            }

            fn n_inputs(&self) -> usize {
                #n_inputs
            }

            fn n_constraints(&self) -> usize {
                0 #(+ <#families as ::evi_core::__private::Family<Self>>::count(self)
                    * <<#families as ::evi_core::__private::Family<Self>>::Element
                        as ::evi_core::__private::MechanicalSystem>::N_CONSTRAINTS)*
            }

            fn lagrangian<T: ::evi_core::__private::Scalar>(&self, t: T, q: &[T], v: &[T]) -> T {
                let mut sum = T::from_f64(0.0);
                #(for index in 0..<#families as ::evi_core::__private::Family<Self>>::count(self) {
                    let element = <#families as ::evi_core::__private::Family<Self>>::element(self, index);
                    let places = <#families as ::evi_core::__private::Family<Self>>::coordinates(self, index);
                    let (q, v) = (places.map(|place| q[place]), places.map(|place| v[place]));
                    sum = sum + ::evi_core::__private::GenericSystem::lagrangian(&element, t, &q, &v);
                })*
                sum
            }

            fn constraints<T: ::evi_core::__private::Scalar>(&self, t: T, q: &[T], residuals: &mut [T]) {
                let mut first = 0;
                #(for index in 0..<#families as ::evi_core::__private::Family<Self>>::count(self) {
                    let element = <#families as ::evi_core::__private::Family<Self>>::element(self, index);
                    let places = <#families as ::evi_core::__private::Family<Self>>::coordinates(self, index);
                    let q = places.map(|place| q[place]);
                    let behind = first + ::evi_core::__private::GenericSystem::n_constraints(&element);
                    ::evi_core::__private::GenericSystem::constraints(&element, t, &q, &mut residuals[first..behind]);
                    first = behind;
                })*
            }

            fn dissipation<T: ::evi_core::__private::Scalar>(&self, t: T, q: &[T], v: &[T]) -> T {
                let mut sum = T::from_f64(0.0);
                #(for index in 0..<#families as ::evi_core::__private::Family<Self>>::count(self) {
                    let element = <#families as ::evi_core::__private::Family<Self>>::element(self, index);
                    let places = <#families as ::evi_core::__private::Family<Self>>::coordinates(self, index);
                    let (q, v) = (places.map(|place| q[place]), places.map(|place| v[place]));
                    sum = sum + ::evi_core::__private::GenericSystem::dissipation(&element, t, &q, &v);
                })*
                sum
            }

            fn add_forces<T: ::evi_core::__private::Scalar>(
                &self,
                t: T,
                q: &[T],
                v: &[T],
                inputs: &[T],
                forces: &mut [T],
            ) {
                #(for index in 0..<#families as ::evi_core::__private::Family<Self>>::count(self) {
                    let element = <#families as ::evi_core::__private::Family<Self>>::element(self, index);
                    let places = <#families as ::evi_core::__private::Family<Self>>::coordinates(self, index);
                    let (q, v) = (places.map(|place| q[place]), places.map(|place| v[place]));
                    let mut of_element = places.map(|_| T::from_f64(0.0));
                    ::evi_core::__private::GenericSystem::add_forces(&element, t, &q, &v, inputs, &mut of_element);
                    for (place, force) in places.into_iter().zip(of_element) {
                        forces[place] = forces[place] + force;
                    }
                })*
            }
        }
    }
}
