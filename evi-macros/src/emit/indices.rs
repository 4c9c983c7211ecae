//! Places in arrays as Rust: affine expressions over named sizes and open indices, and checks of their bounds.

use proc_macro2::{Ident, Literal, TokenStream};
use quote::{format_ident, quote, quote_spanned};

use crate::expr::{Affine, Notation, Variable};
use crate::model::{Bound, Parameter, ParameterSource};
use crate::syntax::Declaration;

/// The variable of an index.
pub(super) fn index_variable(level: usize) -> Ident {
    format_ident!("i{level}")
}

/// An affine expression of type `isize`.
pub(super) fn integer(affine: &Affine) -> TokenStream {
    let constant = Literal::isize_suffixed(affine.constant.unsigned_abs() as isize);
    let constant = if affine.constant < 0 { quote!(-#constant) } else { quote!(#constant) };
    let terms = affine.terms.iter().map(|(variable, coefficient)| {
        let value = match variable {
            Variable::Index { level, .. } => {
                let index = index_variable(*level);
                quote!(#index)
            }
            Variable::Size(size) => {
                let path = &size.path;
                quote!((#path as isize))
            }
        };
        let magnitude = Literal::i64_unsuffixed(coefficient.abs());
        let sign = if *coefficient < 0 { quote!(-) } else { quote!(+) };
        if coefficient.abs() == 1 { quote!(#sign #value) } else { quote!(#sign #magnitude * #value) }
    });
    // No cast: before `<` rustc would take it for generic arguments.
    quote!((#constant #(#terms)*))
}

/// An affine expression of type `usize`, which is not negative.
pub(super) fn size(affine: &Affine) -> TokenStream {
    match affine.as_number() {
        Some(number) => {
            let number = Literal::i64_unsuffixed(number);
            quote!(#number)
        }
        None => {
            let value = integer(affine);
            quote!((#value) as usize)
        }
    }
}

/// The value of a parameter of `owner`, a struct of the user's.
pub(super) fn parameter(
    declaration: &Declaration,
    owner: &TokenStream,
    parameter: &Parameter,
) -> TokenStream {
    match &parameter.source {
        ParameterSource::Field { field, indices } => {
            let name = &declaration.fields[*field].name;
            let indices = indices.iter().map(|index| {
                let index = size(index);
                quote!([#index])
            });
            quote!(#owner.#name #(#indices)*)
        }
        ParameterSource::Index(index) => {
            let value = integer(index);
            quote!((#value) as f64)
        }
    }
}

/// Assertions that indices are within their arrays, for what only rustc knows.
pub(super) fn bounds(bounds: &[Bound]) -> TokenStream {
    bounds.iter().filter_map(bound).collect()
}

fn bound(bound: &Bound) -> Option<TokenStream> {
    let Bound { index, size, array, ranges, first, last } = bound;
    let (mut smallest, mut largest) = (index.clone(), index.clone());
    let mut is_empty = quote!(false);
    // From the innermost range outwards: its ends may depend on the indices around it.
    for range in ranges.iter().rev() {
        let end = range.to.plus(-1, &Affine::number(1))?;
        let extreme = |affine: &Affine, is_largest: bool| {
            let at_end = (affine.coefficient(range.level) > 0) == is_largest;
            affine.with_index(range.level, if at_end { &end } else { &range.from })
        };
        (smallest, largest) = (extreme(&smallest, false)?, extreme(&largest, true)?);
        let is_outermost = range.from.levels().chain(range.to.levels()).next().is_none();
        if is_outermost {
            let (from, to) = (integer(&range.from), integer(&range.to));
            is_empty = quote!(#is_empty || #from >= #to);
        }
    }
    let message = format!(
        "index {} is out of range: `{array}` has {} elements, from 0",
        index.print(Notation::Unicode),
        size.print(Notation::Unicode)
    );
    let (smallest, largest, size) = (integer(&smallest), integer(&largest), integer(size));
    let message = quote_spanned!(*last=> #message);
    let condition = quote!(#is_empty || (#smallest >= 0 && #largest < #size));
    Some(quote_spanned!(*first=> const _: () = ::core::assert!(#condition, #message);))
}
