//! The implementation of `AssembledSystem`: one element per family, and loops that say where its copies lie.
//!
//! Its size does not depend on the number of bodies.

mod elements;
mod generic;
mod names;
mod report;

use proc_macro2::{Ident, TokenStream};
use quote::{format_ident, quote};

use super::generic_graph::generic_system;
use super::implementation::{Solvers, mechanical_system};
use super::indices;
use super::subject::{Subject, element_name};
use crate::expr::Graph;
use crate::model::{Assembled, Family, Model, Place, WrittenEquation, coordinate_entries, input_names};
use crate::schedule::Programs;
use crate::syntax::{Coordinate, Declaration};
use elements::{indices_of_element, number_of_elements};
use generic::generic;
use names::{constraint_name, coordinate_name};
use report::names_and_report;

/// Everything that the derive emits for a scene of loops.
pub(crate) fn assembled(
    declaration: &Declaration,
    assembled: &Assembled,
    graph: &Graph,
    programs: &[Programs],
    written: &[WrittenEquation],
) -> TokenStream {
    let struct_name = &declaration.name;
    let bounds = indices::bounds(&assembled.bounds);
    let elements = std::iter::zip(&assembled.elements, programs)
        .enumerate()
        .map(|(number, (model, programs))| element(declaration, number, model, graph, programs));
    let observed = assembled.observed.iter().map(|(_, family)| family);
    let frequencies = assembled.frequencies.iter();
    let families: Vec<TokenStream> = assembled
        .families
        .iter()
        .chain(observed)
        .chain(frequencies)
        .enumerate()
        .map(|(number, family)| {
            self::family(declaration, number, family, &assembled.elements[family.element])
        })
        .collect();
    let mut names: Vec<Ident> = (0..families.len()).map(family_name).collect();
    let mut terms = names.split_off(assembled.families.len());
    let frequencies = terms.split_off(assembled.observed.len());
    let quantities = assembled.observed.iter().map(|(quantity, _)| quantity);
    let names_and_report = names_and_report(declaration, assembled, written);
    let n_coordinates = sum(coordinate_entries(declaration).iter().map(count));
    let coordinate_name = coordinate_name(declaration);
    let constraint_name = constraint_name(&assembled.families);
    let generic = generic(struct_name, &names, &n_coordinates, input_names(declaration).count());
    quote! {
        const _: () = {
            #bounds
            #(#elements)*
            #(#families)*

            #[automatically_derived]
            #[allow(unused, trivial_numeric_casts, clippy::all)]
            impl ::evi_core::__private::AssembledSystem for #struct_name {
                fn n_coordinates(&self) -> usize {
                    #n_coordinates
                }

                #names_and_report
                #coordinate_name
                #constraint_name

                fn visit_families<V: ::evi_core::__private::FamilyVisitor<Self>>(&self, visitor: &mut V) {
                    #(visitor.family::<#names>();)*
                }

                fn visit_observed<V: ::evi_core::__private::ObservedVisitor<Self>>(&self, visitor: &mut V) {
                    #(visitor.term::<#terms>(#quantities);)*
                }

                fn visit_frequencies<V: ::evi_core::__private::FrequencyVisitor<Self>>(&self, visitor: &mut V) {
                    #(visitor.frequency::<#frequencies>();)*
                }
            }

            #generic
        };
    }
}

fn family_name(number: usize) -> Ident {
    format_ident!("Family{number}")
}

/// An element as a scene of its own. It never steps by itself: no elimination is written for it.
fn element(
    declaration: &Declaration,
    number: usize,
    model: &Model,
    graph: &Graph,
    programs: &Programs,
) -> TokenStream {
    let subject = Subject::of_element(number, declaration, model);
    let generic = generic_system(&subject, model, graph);
    let implementation = mechanical_system(&subject, model, graph, programs, &[], Solvers::Dense, &generic);
    let name = &subject.name;
    let n_parameters = model.parameters.len();
    quote! {
        #[allow(missing_docs, missing_debug_implementations, unreachable_pub)]
        pub struct #name {
            p: [f64; #n_parameters],
        }
        #implementation
    }
}

/// Where the copies of an element lie, and their parameters.
fn family(declaration: &Declaration, number: usize, family: &Family, model: &Model) -> TokenStream {
    let Family { ranges, element, places, .. } = family;
    let (element_name, family_name) = (element_name(*element), family_name(number));
    let struct_name = &declaration.name;
    let values =
        model.parameters.iter().map(|parameter| indices::parameter(declaration, &quote!(system), parameter));
    let places = places.iter().map(|place| flat(declaration, place));
    let indices = indices_of_element(ranges);
    let count = number_of_elements(ranges);
    quote! {
        #[allow(missing_docs, missing_debug_implementations, unreachable_pub)]
        pub struct #family_name;

        #[automatically_derived]
        #[allow(unused, trivial_numeric_casts, clippy::all)]
        impl ::evi_core::__private::Family<#struct_name> for #family_name {
            type Element = #element_name;

            fn count(_: &#struct_name) -> usize {
                #count
            }

            fn element(system: &#struct_name, index: usize) -> #element_name {
                #indices
                #element_name { p: [#(#values),*] }
            }

            fn coordinates(
                _: &#struct_name,
                index: usize,
            ) -> <#element_name as ::evi_core::__private::MechanicalSystem>::PerCoordinate<usize> {
                #indices
                [#(#places),*]
            }
        }
    }
}

/// Number of coordinates of an entry.
fn count(entry: &Coordinate) -> TokenStream {
    let sizes = entry.shape.iter().map(indices::size);
    quote!((1 #(* (#sizes))*))
}

fn sum(terms: impl Iterator<Item = TokenStream>) -> TokenStream {
    quote!((0 #(+ #terms)*))
}

/// The place of a coordinate among those of the scene, the last index fastest.
fn flat(declaration: &Declaration, place: &Place) -> TokenStream {
    let entries = coordinate_entries(declaration);
    let first = sum(entries[..place.array].iter().map(count));
    let within =
        std::iter::zip(&entries[place.array].shape, &place.indices).fold(quote!(0), |flat, (size, index)| {
            let (size, index) = (indices::size(size), indices::size(index));
            quote!((#flat) * (#size) + (#index))
        });
    quote!(#first + #within)
}
