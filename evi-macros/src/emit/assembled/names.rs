//! The names of coordinates and constraints, put together when they are asked for.

use proc_macro2::{Ident, TokenStream};
use quote::quote;

use super::count;
use super::elements::{indices_of_element, number_of_elements};
use crate::emit::indices::{self, index_variable};
use crate::expr::Affine;
use crate::model::{Family, coordinate_entries};
use crate::syntax::Declaration;

/// `AssembledSystem::coordinate_name`: `p[3, 1]`.
pub(super) fn coordinate_name(declaration: &Declaration) -> TokenStream {
    let entries = coordinate_entries(declaration).iter().map(|entry| {
        let (name, count) = (entry.name.to_string(), count(entry));
        let name = name.trim_start_matches("r#").to_owned();
        let text = element_text(&name, &entry.shape);
        quote! {
            if rest < #count {
                return #text;
            }
            rest -= #count;
        }
    });
    quote! {
        fn coordinate_name(&self, index: usize) -> ::std::string::String {
            let mut rest = index;
            #(#entries)*
            ::std::format!("coordinate {index}")
        }
    }
}

/// The text of element number `rest` of an array.
fn element_text(name: &str, shape: &[Affine]) -> TokenStream {
    if shape.is_empty() {
        return quote!(::std::string::String::from(#name));
    }
    let format = format!("{name}[{}]", vec!["{}"; shape.len()].join(", "));
    let indices = (0..shape.len()).map(|k| {
        let size = indices::size(&shape[k]);
        let below = shape[k + 1..].iter().map(indices::size);
        quote!((rest / (1 #(* (#below))*)) % (#size))
    });
    quote!(::std::format!(#format, #(#indices),*))
}

/// `AssembledSystem::constraint_name`: `link[7]`, with the indices of the family.
pub(super) fn constraint_name(families: &[Family]) -> TokenStream {
    let constrained = families.iter().filter(|family| !family.constraints.is_empty());
    let entries = constrained.map(|Family { ranges, constraints, .. }| {
        let (count, n_constraints) = (number_of_elements(ranges), constraints.len());
        let indices = indices_of_element(ranges);
        let variables: Vec<Ident> = ranges.iter().map(|range| index_variable(range.level)).collect();
        let texts = constraints.iter().map(|name| family_text(name, &variables));
        let rows = 0..n_constraints;
        quote! {
            let count = #count * #n_constraints;
            if place < count {
                let index = place / #n_constraints;
                #indices
                return match place % #n_constraints {
                    #(#rows => #texts,)*
                    _ => ::core::unreachable!("a remainder is below its divisor"),
                };
            }
            place -= count;
        }
    });
    quote! {
        fn constraint_name(&self, index: usize) -> ::std::string::String {
            let mut place = index;
            #(#entries)*
            ::std::format!("constraint {index}")
        }
    }
}

/// The text of a constraint: `link[7]`, and `weld[7, 0]` for an equation of vectors, `weld[0]`.
fn family_text(name: &str, variables: &[Ident]) -> TokenStream {
    if variables.is_empty() {
        return quote!(::std::string::String::from(#name));
    }
    let (name, element) =
        name.split_once('[').map_or((name, "]".to_owned()), |(name, rest)| (name, format!(", {rest}")));
    let format = format!("{name}[{}{element}", vec!["{}"; variables.len()].join(", "));
    quote!(::std::format!(#format, #(#variables),*))
}
