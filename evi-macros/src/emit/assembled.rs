//! The implementation of `AssembledSystem`: one element per family, and loops that say where its copies lie.
//!
//! Its size does not depend on the number of bodies.

use proc_macro2::{Ident, TokenStream};
use quote::{format_ident, quote};

use super::generic_graph::generic_system;
use super::implementation::{Solvers, mechanical_system};
use super::indices::{self, are_independent, index_variable, integer};
use super::subject::{Subject, element_name};
use crate::expr::{Affine, Graph};
use crate::model::{Assembled, Family, IndexRange, Model, Place, coordinate_entries};
use crate::schedule::Programs;
use crate::syntax::{Coordinate, Declaration};

/// Everything that the derive emits for a scene of loops.
pub(crate) fn assembled(
    declaration: &Declaration,
    assembled: &Assembled,
    graph: &Graph,
    programs: &[Programs],
) -> TokenStream {
    let struct_name = &declaration.name;
    let bounds = indices::bounds(&assembled.bounds);
    let elements = std::iter::zip(&assembled.elements, programs)
        .enumerate()
        .map(|(number, (model, programs))| element(declaration, number, model, graph, programs));
    let families: Vec<TokenStream> = assembled
        .families
        .iter()
        .enumerate()
        .map(|(number, family)| {
            self::family(declaration, number, family, &assembled.elements[family.element])
        })
        .collect();
    let names: Vec<Ident> = (0..families.len()).map(family_name).collect();
    let n_coordinates = sum(coordinate_entries(declaration).iter().map(count));
    let coordinate_name = coordinate_name(declaration);
    let constraint_name = constraint_name(&assembled.families);
    let generic = generic(struct_name, &names, &n_coordinates);
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

                #coordinate_name
                #constraint_name

                fn visit_families<V: ::evi_core::__private::FamilyVisitor<Self>>(&self, visitor: &mut V) {
                    #(visitor.family::<#names>();)*
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

fn length(range: &IndexRange) -> TokenStream {
    let (from, to) = (integer(&range.from), integer(&range.to));
    quote!(::core::cmp::Ord::max(#to - #from, 0))
}

/// The number of values of all indices.
fn number_of_elements(ranges: &[IndexRange]) -> TokenStream {
    if are_independent(ranges) {
        let lengths = ranges.iter().map(length);
        return quote!((1 #(* #lengths)*) as usize);
    }
    let (innermost, outer) = ranges.split_last().expect("no ranges are independent");
    let length = length(innermost);
    let counted = nested(outer, quote!(count += #length;));
    quote!({
        let mut count: isize = 0;
        #counted
        count as usize
    })
}

/// The variables of the indices of element number `index`, the last index fastest.
fn indices_of_element(ranges: &[IndexRange]) -> TokenStream {
    let variables: Vec<Ident> = ranges.iter().map(|range| index_variable(range.level)).collect();
    if are_independent(ranges) {
        let lines = ranges.iter().zip(&variables).rev().map(|(range, variable)| {
            let (from, length) = (integer(&range.from), length(range));
            quote! {
                let #variable = #from + rest % #length;
                rest /= #length;
            }
        });
        return quote!(let mut rest = index as isize; #(#lines)*);
    }
    let (innermost, outer) = ranges.split_last().expect("no ranges are independent");
    let (from, length) = (integer(&innermost.from), length(innermost));
    let (last, before) = variables.split_last().expect("as many as ranges");
    let found = nested(
        outer,
        quote! {
            let length = #length;
            if rest < length {
                break 'found (#(#before,)* #from + rest);
            }
            rest -= length;
        },
    );
    quote! {
        let mut rest = index as isize;
        let (#(#before,)* #last) = 'found: {
            #found
            ::core::unreachable!("an element's number is below their count")
        };
    }
}

/// Loops over ranges, the first outermost.
fn nested(ranges: &[IndexRange], body: TokenStream) -> TokenStream {
    ranges.iter().rev().fold(body, |body, range| {
        let (variable, from, to) = (index_variable(range.level), integer(&range.from), integer(&range.to));
        quote!(for #variable in #from..#to { #body })
    })
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

/// `AssembledSystem::coordinate_name`: `p[3, 1]`.
fn coordinate_name(declaration: &Declaration) -> TokenStream {
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
fn constraint_name(families: &[Family]) -> TokenStream {
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

/// `GenericSystem` as loops over the generic copies of the elements.
fn generic(struct_name: &Ident, families: &[Ident], n_coordinates: &TokenStream) -> TokenStream {
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
