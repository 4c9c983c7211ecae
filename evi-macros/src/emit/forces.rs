//! What a scene has beside a Lagrangian and constraints: forces, observed quantities, frequencies. Nothing is emitted of
//! what it has not: the trait's defaults stand for that.

use proc_macro2::{Ident, TokenStream};
use quote::quote;

use super::functions::{Kernels, compiled};
use super::structure::{dependence, entries, operations};
use crate::model::Model;
use crate::schedule::{ForcePrograms, Program, Programs};
use crate::structure::Structure;

/// The names of inputs and observed quantities.
pub(super) fn names(model: &Model) -> TokenStream {
    let list = |constant: TokenStream, names: Vec<String>| {
        (!names.is_empty()).then(|| quote!(const #constant: &'static [&'static str] = &[#(#names),*];))
    };
    let text = |name: &Ident| name.to_string().trim_start_matches("r#").to_owned();
    let inputs = list(quote!(INPUTS), model.inputs.iter().map(text).collect());
    let observables = model.observables.iter().map(|observed| observed.name.clone());
    let observables = list(quote!(OBSERVABLES), observables.collect());
    quote!(#inputs #observables)
}

/// `Structure::forces`.
pub(super) fn structure(programs: &Programs) -> TokenStream {
    let Some(ForcePrograms { values, derivatives }) = &programs.forces else {
        return quote!(::evi_core::__private::ForceStructure::NONE);
    };
    let Structure { forced, force_q, force_v, forces, .. } = &programs.structure;
    let (q, v, on) = (entries(force_q), entries(force_v), dependence(*forces));
    let on_inputs = forces.on_inputs;
    let (values, derivatives) = (operations(values.operations), operations(derivatives.operations));
    quote! {
        ::evi_core::__private::ForceStructure {
            forced: &[#(#forced),*],
            q: #q,
            v: #v,
            on: #on,
            on_inputs: #on_inputs,
            values: #values,
            derivatives: #derivatives,
        }
    }
}

/// `HasFrequencies`, for a scene that gives some.
pub(super) fn frequencies(struct_name: &Ident, kernels: &Kernels<'_>, programs: &Programs) -> TokenStream {
    if programs.frequencies.is_empty() {
        return TokenStream::new();
    }
    let values = programs.frequencies.iter().map(|&frequency| kernels.constant(frequency));
    quote! {
        #[automatically_derived]
        #[allow(unused_variables, trivial_numeric_casts, clippy::all)]
        impl ::evi_core::__private::HasFrequencies for #struct_name {
            #[inline]
            fn frequencies<T: ::evi_core::__private::Scalar>(
                c: &Self::PerConstant<T>,
            ) -> Self::PerCoordinate<T> {
                [#(#values),*]
            }
        }
    }
}

impl Kernels<'_> {
    pub(super) fn forces(&self, ForcePrograms { values, derivatives }: &ForcePrograms) -> TokenStream {
        let writer = self.writer_with_inputs();
        let (statements, outputs) = writer.body(values);
        let (of_values, body) = compiled(values, quote!(#statements [#(#outputs),*]));
        let of_derivatives = quote!(#[inline]);
        let values = self.function_with_inputs("forces", of_values, quote!(Self::PerCoordinate<T>), body);
        let (statements, outputs) = writer.body(derivatives);
        let (forces, entries) = outputs.split_at(self.model.coordinates.len());
        let derivatives = self.function_with_inputs(
            "force_derivatives",
            of_derivatives,
            quote!((Self::PerCoordinate<T>, Self::PerForceEntry<T>)),
            quote!(#statements ([#(#forces),*], [#(#entries),*])),
        );
        quote!(#values #derivatives)
    }

    pub(super) fn observables(&self, program: &Program) -> TokenStream {
        let (statements, outputs) = self.writer_with_inputs().body(program);
        let returned = quote!(Self::PerObservable<T>);
        self.function_with_inputs(
            "observables",
            quote!(#[inline]),
            returned,
            quote!(#statements [#(#outputs),*]),
        )
    }
}
