//! What there is to tell about a system, as constants.

use proc_macro2::TokenStream;
use quote::quote;

use super::structure::operations;
use crate::model::{Formula, WrittenEquation};
use crate::schedule::Programs;

/// `MechanicalSystem::REPORT`.
pub(super) fn report(name: &str, written: &[WrittenEquation], programs: &Programs) -> TokenStream {
    let equations = equations(written);
    let kernels = programs.kernels().into_iter().map(|(name, program)| {
        let operations = operations(program.operations);
        let (temporaries, statements) = (program.n_temporaries(), program.n_statements());
        quote!(::evi_core::__private::KernelReport {
            name: #name,
            operations: #operations,
            temporaries: #temporaries,
            statements: #statements,
        })
    });
    quote! {
        const REPORT: ::evi_core::__private::SystemReport = ::evi_core::__private::SystemReport {
            name: #name,
            coordinates: Self::COORDINATES,
            constraints: Self::CONSTRAINTS,
            parameters: Self::PARAMETERS,
            inputs: Self::INPUTS,
            observables: Self::OBSERVABLES,
            equations: #equations,
            structure: Self::STRUCTURE,
            kernels: &[#(#kernels),*],
        };
    }
}

/// The equations as a constant list.
pub(super) fn equations(written: &[WrittenEquation]) -> TokenStream {
    let equations = written.iter().map(|WrittenEquation { name, left, right }| {
        let (left, right) = (formula(left), formula(right));
        quote!(::evi_core::__private::Equation { name: #name, left: #left, right: #right })
    });
    quote!(&[#(#equations),*])
}

/// `MechanicalSystem::SOURCE` with the feature `source`, otherwise nothing: the text of `expansion`.
pub(super) fn source(expansion: impl Fn() -> TokenStream) -> TokenStream {
    // The snapshots of this crate's tests are the same with every feature.
    if cfg!(test) || !cfg!(feature = "source") {
        return TokenStream::new();
    }
    let text = expansion().to_string();
    quote! {
        const SOURCE: ::core::option::Option<&'static str> = ::core::option::Option::Some(#text);
    }
}

fn formula(formula: &Formula) -> TokenStream {
    let Formula { unicode, latex } = formula;
    quote!(::evi_core::__private::Formula { unicode: #unicode, latex: #latex })
}
