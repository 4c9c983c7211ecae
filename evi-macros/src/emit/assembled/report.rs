//! What there is to tell about a scene of loops, as constants.

use proc_macro2::TokenStream;
use quote::quote;

use crate::emit::report::equations;
use crate::emit::subject::element_name;
use crate::expr::{Affine, Notation};
use crate::model::{Assembled, Family, IndexRange, WrittenEquation, coordinate_entries, input_names};
use crate::syntax::Declaration;

/// `INPUTS`, `OBSERVABLES` and `REPORT` of `AssembledSystem`.
pub(super) fn names_and_report(
    declaration: &Declaration,
    assembled: &Assembled,
    written: &[WrittenEquation],
) -> TokenStream {
    let name = declaration.name.to_string();
    let inputs = input_names(declaration).map(|input| input.to_string().trim_start_matches("r#").to_owned());
    let observables = &assembled.observables;
    let coordinates = coordinate_entries(declaration)
        .iter()
        .map(|entry| with_indices(entry.name.to_string().trim_start_matches("r#"), &entry.shape));
    let equations = equations(written);
    let families = assembled.families.iter().map(|family| self::family(declaration, family));
    quote! {
        const INPUTS: &'static [&'static str] = &[#(#inputs),*];
        const OBSERVABLES: &'static [&'static str] = &[#(#observables),*];
        const REPORT: ::evi_core::__private::AssembledReport = ::evi_core::__private::AssembledReport {
            name: #name,
            coordinates: &[#(#coordinates),*],
            inputs: Self::INPUTS,
            observables: Self::OBSERVABLES,
            equations: #equations,
            families: &[#(#families),*],
        };
    }
}

/// Its indices and where its coordinates lie, as text, and the report of its element.
fn family(declaration: &Declaration, family: &Family) -> TokenStream {
    let entries = coordinate_entries(declaration);
    let name = |level: usize| {
        let in_places = family.places.iter().flat_map(|place| &place.indices);
        let in_ranges = family.ranges.iter().flat_map(|range| [&range.from, &range.to]);
        in_places.chain(in_ranges).find_map(|index| index.name_of(level)).unwrap_or("i")
    };
    let range =
        |range: &IndexRange| format!("{} in {}..{}", name(range.level), text(&range.from), text(&range.to));
    let ranges: Vec<String> = family.ranges.iter().map(range).collect();
    let indices = ranges.join(", ");
    let places = family.places.iter().map(|place| {
        let name = entries[place.array].name.to_string();
        with_indices(name.trim_start_matches("r#"), &place.indices)
    });
    let element = element_name(family.element);
    quote!(::evi_core::__private::FamilyReport {
        indices: #indices,
        coordinates: &[#(#places),*],
        element: <#element as ::evi_core::__private::MechanicalSystem>::REPORT,
    })
}

/// `p[N, 2]`.
fn with_indices(name: &str, indices: &[Affine]) -> String {
    if indices.is_empty() {
        return name.to_owned();
    }
    let indices: Vec<String> = indices.iter().map(text).collect();
    format!("{name}[{}]", indices.join(", "))
}

fn text(index: &Affine) -> String {
    index.print(Notation::Unicode)
}
