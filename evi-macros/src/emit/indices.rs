//! Places in arrays as Rust: affine expressions over named sizes and open indices, and checks of their bounds.

use proc_macro2::{Ident, Literal, TokenStream};
use quote::{ToTokens, format_ident, quote, quote_spanned};

use crate::expr::{Affine, Notation, Variable};
use crate::model::{Bound, IndexRange, Parameter, ParameterSource};
use crate::syntax::Declaration;

/// The variable of an index.
pub(super) fn index_variable(level: usize) -> Ident {
    format_ident!("i{level}")
}

/// An affine expression of type `isize`.
pub(super) fn integer(affine: &Affine) -> TokenStream {
    let literal = |value: i64| Literal::isize_suffixed(isize::try_from(value).unwrap_or(isize::MAX));
    let constant = literal(affine.constant.saturating_abs());
    let constant = if affine.constant < 0 { quote!(-#constant) } else { quote!(#constant) };
    let terms = affine.terms.iter().map(|(product, coefficient)| {
        let sign = if *coefficient < 0 { quote!(-) } else { quote!(+) };
        let magnitude = literal(coefficient.saturating_abs());
        let factors = product.iter().map(|variable| match variable {
            Variable::Index { level, .. } => index_variable(*level).to_token_stream(),
            Variable::Size(size) => {
                let path = &size.path;
                quote!((#path as isize))
            }
        });
        let product = factors.fold(quote!(#magnitude), |product, factor| quote!(#product * #factor));
        quote!(#sign #product)
    });
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
            quote!(#value as usize)
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
            quote!(#value as f64)
        }
    }
}

/// Assertions that indices are within their arrays, for what only rustc knows.
pub(super) fn bounds(bounds: &[Bound]) -> TokenStream {
    bounds.iter().filter_map(bound).collect()
}

fn bound(bound: &Bound) -> Option<TokenStream> {
    let Bound { index, size, array, ranges, first, last } = bound;
    let message = format!(
        "index {} is out of range: `{array}` has {} elements, from 0",
        index.print(Notation::Unicode),
        size.print(Notation::Unicode)
    );
    let message = quote_spanned!(*last=> #message);
    let is_within = if are_independent(ranges) {
        within_corners(index, size, ranges)?
    } else {
        within_everywhere(index, size, ranges)?
    };
    Some(quote_spanned! {*first=>
        #[allow(trivial_numeric_casts, clippy::all)]
        const _: () = ::core::assert!(#is_within, #message);
    })
}

/// Whether the ends of every range are known without other indices.
pub(super) fn are_independent(ranges: &[IndexRange]) -> bool {
    ranges.iter().all(|range| range.from.levels().chain(range.to.levels()).next().is_none())
}

/// Affine expressions are largest and smallest at the corners of their ranges, if none of these is empty.
fn within_corners(index: &Affine, size: &Affine, ranges: &[IndexRange]) -> Option<TokenStream> {
    let mut corners = vec![index.clone()];
    let mut is_empty = quote!(false);
    for range in ranges {
        let last = range.to.plus(-1, &Affine::number(1))?;
        let ends = |corner: Affine| {
            [corner.with_index(range.level, &range.from), corner.with_index(range.level, &last)]
        };
        corners = corners.into_iter().flat_map(ends).collect::<Option<_>>()?;
        corners.sort();
        corners.dedup();
        let (from, to) = (integer(&range.from), integer(&range.to));
        is_empty = quote!(#is_empty || #from >= #to);
    }
    let (corners, size) = (corners.iter().map(integer).collect::<Vec<_>>(), integer(size));
    Some(quote!((#is_empty || (true #(&& 0 <= #corners && #corners < #size)*))))
}

/// Where ranges depend on the indices around them, all values of these are looked at.
fn within_everywhere(index: &Affine, size: &Affine, ranges: &[IndexRange]) -> Option<TokenStream> {
    let (innermost, outer) = ranges.split_last()?;
    let last = innermost.to.plus(-1, &Affine::number(1))?;
    let (at_first, at_last) =
        (index.with_index(innermost.level, &innermost.from)?, index.with_index(innermost.level, &last)?);
    let [at_first, at_last, size] = [&at_first, &at_last, size].map(integer);
    let (from, to) = (integer(&innermost.from), integer(&innermost.to));
    let looked_at = quote! {
        if #from < #to && !(0 <= #at_first && #at_first < #size && 0 <= #at_last && #at_last < #size) {
            is_within = false;
        }
    };
    let looked_at = outer.iter().rev().fold(looked_at, |body, range| {
        let (variable, from, to) = (index_variable(range.level), integer(&range.from), integer(&range.to));
        quote! {
            let mut #variable = #from;
            while #variable < #to {
                #body
                #variable += 1;
            }
        }
    });
    Some(quote!({
        let mut is_within = true;
        #looked_at
        is_within
    }))
}
