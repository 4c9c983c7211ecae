//! The kernels of a central force, and what is known of it. Nothing is emitted for a scene without one: the trait's defaults stand for that.

use proc_macro2::TokenStream;
use quote::quote;

use super::functions::{Kernels, compiled};
use crate::schedule::{CentralForcePrograms, Programs};

/// `Structure::central_force`.
pub(super) fn structure(programs: &Programs) -> TokenStream {
    let Some(&CentralForcePrograms { is_linear, is_beside_uniform_force, .. }) =
        programs.central_force.as_ref()
    else {
        return quote!(::core::option::Option::None);
    };
    quote! {
        ::core::option::Option::Some(::evi_core::__private::CentralForce {
            is_linear: #is_linear,
            is_beside_uniform_force: #is_beside_uniform_force,
        })
    }
}

impl Kernels<'_> {
    pub(super) fn central_force(&self, programs: &CentralForcePrograms) -> TokenStream {
        let CentralForcePrograms { squared_distance, force, metric, uniform, .. } = programs;
        let (statements, outputs) = self.writer_of(self.positions()).body(squared_distance);
        let (square, radial) = (&outputs[0], &outputs[1..]);
        let (distance_inlining, distance) =
            compiled(squared_distance, quote!(#statements (#square, [#(#radial),*])));
        let (statements, outputs) = self.writer_of((quote!(r: T), quote!(r))).body(force);
        let (force_inlining, force) = compiled(force, quote!(#statements [#(#outputs),*]));
        let rows = metric.chunks(uniform.len()).map(|row| {
            let entries = row.iter().map(|&entry| self.constant(entry));
            quote!([#(#entries),*])
        });
        let uniform = uniform.iter().map(|&force| self.constant(force));
        quote! {
            #distance_inlining
            fn squared_distance<T: ::evi_core::__private::Scalar>(
                c: &Self::PerConstant<T>,
                q: &Self::PerCoordinate<T>,
            ) -> (T, Self::PerCoordinate<T>) {
                #distance
            }
            #force_inlining
            fn central_force<T: ::evi_core::__private::Scalar>(c: &Self::PerConstant<T>, r: T) -> [T; 2] {
                #force
            }
            #[inline]
            fn distance_metric<T: ::evi_core::__private::Scalar>(
                c: &Self::PerConstant<T>,
            ) -> Self::PerCoordinate<Self::PerCoordinate<T>> {
                [#(#rows),*]
            }
            #[inline]
            fn uniform_force<T: ::evi_core::__private::Scalar>(
                c: &Self::PerConstant<T>,
            ) -> Self::PerCoordinate<T> {
                [#(#uniform),*]
            }
        }
    }
}
