//! The struct that carries `#[evi(...)]`: its shape, its fields, and the items of all its attributes.

use proc_macro2::{Ident, Span, TokenStream};
use quote::ToTokens;

use super::item::{Item, parse_items};
use super::nesting;
use super::rigid_body::spell_out;
use super::shape::shape_of_type;
use crate::diagnostics::Diagnostics;
use crate::expr::Affine;

/// A struct with its attribute.
pub(crate) struct Declaration {
    pub(crate) name: Ident,
    pub(crate) generics: Generics,
    /// Empty where the shape is mistaken.
    pub(crate) fields: Vec<Field>,
    pub(crate) items: Vec<Item>,
    /// Whether it is something else than a struct with named fields, which has been reported: what its
    /// equations mean cannot be known.
    pub(crate) has_mistaken_shape: bool,
}

/// The three places where generics are written in an impl; all empty for a struct that is well-formed here.
pub(crate) struct Generics {
    pub(crate) impl_generics: TokenStream,
    pub(crate) type_generics: TokenStream,
    pub(crate) where_clause: TokenStream,
}

/// A named field.
pub(crate) struct Field {
    pub(crate) name: Ident,
    /// The sizes of an array, none for one number; `None` for a field of another type.
    pub(crate) shape: Option<Vec<Affine>>,
}

/// The derive stands on something that Rust itself will complain about.
pub(crate) struct NotAnItem;

/// Parses a struct and its `#[evi(...)]` attributes.
pub(crate) fn parse(input: TokenStream, diagnostics: &mut Diagnostics) -> Result<Declaration, NotAnItem> {
    let input = nesting::bounded(input, diagnostics);
    let input: syn::DeriveInput = syn::parse2(input).map_err(|error| {
        diagnostics.report(error.span(), error.to_string());
        NotAnItem
    })?;
    let fields = named_fields(&input, diagnostics);
    let has_mistaken_shape = fields.is_none();
    // What is written on something that is no system is read for its sizes, not for its mistakes.
    let mut unheard = Diagnostics::default();
    let diagnostics = if has_mistaken_shape { &mut unheard } else { diagnostics };
    let items = attribute_items(&input, diagnostics);
    let (impl_generics, type_generics, where_clause) = input.generics.split_for_impl();
    let generics = Generics {
        impl_generics: impl_generics.to_token_stream(),
        type_generics: type_generics.to_token_stream(),
        where_clause: where_clause.to_token_stream(),
    };
    let fields = fields.unwrap_or_default();
    Ok(Declaration { name: input.ident, generics, fields, items, has_mistaken_shape })
}

/// The fields of a struct of the right shape.
fn named_fields(input: &syn::DeriveInput, diagnostics: &mut Diagnostics) -> Option<Vec<Field>> {
    let shape = match &input.data {
        syn::Data::Struct(structure) => match &structure.fields {
            syn::Fields::Unnamed(_) => "a tuple struct",
            // Without parameters there is nothing to name.
            fields @ (syn::Fields::Named(_) | syn::Fields::Unit) => {
                if let Some(parameter) = input.generics.params.first() {
                    let span = first_span(parameter.to_token_stream(), input.ident.span());
                    diagnostics.report(
                        span,
                        "a mechanical system has no generic parameters: its parameters are f64 fields, and \
                         the generated code is generic over the scalar by itself",
                    );
                    return None;
                }
                return Some(fields.iter().map(|declared| field(declared, diagnostics)).collect());
            }
        },
        syn::Data::Enum(_) => "an enum",
        syn::Data::Union(_) => "a union",
    };
    diagnostics.report(
        input.ident.span(),
        format!("{shape} cannot be a mechanical system: derive it on a struct with named f64 fields"),
    );
    None
}

fn field(field: &syn::Field, diagnostics: &mut Diagnostics) -> Field {
    for attribute in field.attrs.iter().filter(|attribute| attribute.path().is_ident("evi")) {
        let span = first_span(attribute.path().to_token_stream(), attribute.pound_token.span);
        diagnostics.report(span, "#[evi(..)] stands above the struct: a field is a parameter without it");
    }
    let name = field.ident.clone().expect("the fields of a struct with named fields have names");
    Field { name, shape: shape_of_type(&field.ty) }
}

fn attribute_items(input: &syn::DeriveInput, diagnostics: &mut Diagnostics) -> Vec<Item> {
    let mut items = Vec::new();
    let (mut is_present, mut is_empty) = (false, true);
    for attribute in input.attrs.iter().filter(|attribute| attribute.path().is_ident("evi")) {
        is_present = true;
        match attribute.meta.require_list() {
            Ok(list) => {
                is_empty &= list.tokens.is_empty();
                items.extend(parse_items(list.tokens.clone(), diagnostics));
            }
            Err(error) => {
                is_empty = false;
                diagnostics.report(error.span(), "the attribute lists items: #[evi(coordinates(..), ..)]");
            }
        }
    }
    if !is_present {
        diagnostics.report(
            input.ident.span(),
            "the equations of motion are missing: write \
             #[evi(coordinates(..), kinetic = .., potential = ..)] above the struct",
        );
    } else if is_empty {
        diagnostics.report(
            input.ident.span(),
            "the attribute is empty: write #[evi(coordinates(..), kinetic = .., potential = ..)]",
        );
    }
    spell_out(items, diagnostics)
}

fn first_span(tokens: TokenStream, otherwise: Span) -> Span {
    tokens.into_iter().next().map_or(otherwise, |token| token.span())
}
