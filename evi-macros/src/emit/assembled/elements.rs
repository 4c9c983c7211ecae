//! How many elements a family has, and the indices of each.

use proc_macro2::{Ident, TokenStream};
use quote::quote;

use crate::emit::indices::{are_independent, index_variable, integer};
use crate::model::IndexRange;

fn length(range: &IndexRange) -> TokenStream {
    let (from, to) = (integer(&range.from), integer(&range.to));
    quote!(::core::cmp::Ord::max(#to - #from, 0))
}

/// The number of values of all indices.
pub(super) fn number_of_elements(ranges: &[IndexRange]) -> TokenStream {
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
pub(super) fn indices_of_element(ranges: &[IndexRange]) -> TokenStream {
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
