//! Sizes of arrays: of coordinates as `p: [N, 2]`, of fields as Rust types.

use proc_macro2::{Delimiter, Group, Ident, TokenStream, TokenTree};
use syn::parse::{ParseStream, Parser};
use syn::punctuated::Punctuated;

use super::affine::{Integer, affine};
use crate::budget::MOST_SIZES;
use crate::diagnostics::Diagnostics;
use crate::expr::Affine;

/// A coordinate, or an array of them: `x`, `r: [3]`, `p: [N, 2]`.
pub(crate) struct Coordinate {
    pub(crate) name: Ident,
    /// Empty for one number.
    pub(crate) shape: Vec<Affine>,
}

impl Coordinate {
    /// How many coordinates it is, where that is known.
    pub(crate) fn count(&self) -> Option<usize> {
        self.shape
            .iter()
            .try_fold(1_usize, |count, size| count.checked_mul(usize::try_from(size.as_number()?).ok()?))
    }
}

/// The sizes between the brackets of `[N, 2]`; `None` where a mistake was reported.
pub(super) fn sizes(name: &Ident, group: &Group, diagnostics: &mut Diagnostics) -> Option<Vec<Affine>> {
    if group.delimiter() != Delimiter::Bracket || group.stream().is_empty() {
        let message =
            format!("the sizes of an array stand in brackets: write `{name}: [3]` or `{name}: [N, 2]`");
        diagnostics.report(group.span(), message);
        return None;
    }
    // With its brackets, so that a size that breaks off is reported there.
    let parser = |input: ParseStream| {
        let inside;
        syn::bracketed!(inside in input);
        Punctuated::<syn::Expr, syn::Token![,]>::parse_terminated(&inside)
    };
    match parser.parse2(TokenTree::Group(group.clone()).into()) {
        Ok(sizes) if sizes.len() > MOST_SIZES => {
            let message = format!("`{name}` has {} sizes, an array at most {MOST_SIZES}", sizes.len());
            diagnostics.report(group.span(), message);
            None
        }
        Ok(sizes) => sizes.iter().map(|expression| size(expression, diagnostics)).collect(),
        Err(error) => {
            // `[f64; 3]`, the type of a field.
            let message = format!("a coordinate has sizes, no type: write `{name}: [3]` or `{name}: [N, 2]`");
            diagnostics.report(error.span(), message);
            None
        }
    }
}

/// A size: at least 1 where it is a number.
pub(super) fn size(expression: &syn::Expr, diagnostics: &mut Diagnostics) -> Option<Affine> {
    let mut unknown = |_: &Ident, _: &mut Diagnostics| Integer::Unknown;
    let size = affine(expression, &mut unknown, diagnostics)?;
    if size.as_number().is_some_and(|number| number < 1) {
        let span = super::spine::first_span(expression);
        diagnostics.report(span, "an array has at least one element");
        return None;
    }
    Some(size)
}

/// The sizes of a field of numbers: `f64` has none, `[f64; N]`, `[[f64; 2]; N]`, `Vector3<f64>` and `SVector<f64, N>` have some. `None` for
/// another type.
pub(super) fn shape_of_type(field: &syn::Type) -> Option<Vec<Affine>> {
    match field {
        syn::Type::Array(array) => {
            let mut shape = shape_of_type(&array.elem)?;
            shape.insert(0, size(&array.len, &mut Diagnostics::default())?);
            Some(shape)
        }
        syn::Type::Paren(inner) => shape_of_type(&inner.elem),
        syn::Type::Group(inner) => shape_of_type(&inner.elem),
        syn::Type::Path(path) if path.path.is_ident("f64") => Some(Vec::new()),
        syn::Type::Path(path) => vector_of_numbers(path.path.segments.last()?),
        _ => None,
    }
}

/// The size of nalgebra's `Vector3<f64>` or `SVector<f64, N>`.
fn vector_of_numbers(segment: &syn::PathSegment) -> Option<Vec<Affine>> {
    let syn::PathArguments::AngleBracketed(arguments) = &segment.arguments else { return None };
    let arguments: Vec<&syn::GenericArgument> = arguments.args.iter().collect();
    let is_f64 = |argument: &syn::GenericArgument| matches!(argument, syn::GenericArgument::Type(syn::Type::Path(path)) if path.path.is_ident("f64"));
    let name = segment.ident.to_string();
    let length = match (name.as_str(), arguments.as_slice()) {
        ("SVector", [number, syn::GenericArgument::Const(length)]) if is_f64(number) => {
            size(length, &mut Diagnostics::default())?
        }
        // A constant by its name parses as a type.
        ("SVector", [number, syn::GenericArgument::Type(syn::Type::Path(length))]) if is_f64(number) => {
            let path: TokenStream = quote::ToTokens::to_token_stream(&length.path);
            Affine::size(path)
        }
        (_, [number]) if is_f64(number) => {
            let length: i64 = name.strip_prefix("Vector")?.parse().ok()?;
            (1..=6).contains(&length).then(|| Affine::number(length))?
        }
        _ => return None,
    };
    Some(vec![length])
}

/// The entry of `coordinates(..)` that begins with a name and a colon.
pub(super) fn array_of_coordinates(
    name: &Ident,
    rest: &[TokenTree],
    diagnostics: &mut Diagnostics,
) -> Option<Vec<Affine>> {
    match rest {
        [TokenTree::Group(group)] => sizes(name, group, diagnostics),
        [TokenTree::Group(_), extra, ..] => {
            diagnostics.report(extra.span(), format!("a comma is missing before `{extra}`"));
            None
        }
        _ => None,
    }
}
