//! Loops over the entries of the constraint Jacobian, written out.

use proc_macro2::TokenStream;
use quote::quote;

use crate::structure::{Entry, EntryValue, Structure};

/// Beyond so many calls a loop takes their place: the trait's default.
const LARGEST_UNROLLED: usize = 500;

/// `for_each_slope`, `for_each_slope_pair` and `for_each_gram_product`.
pub(super) fn slopes(structure: &Structure) -> TokenStream {
    let entries = &structure.jacobian_q;
    let pairs: Vec<(&Entry, &Entry)> = entries
        .iter()
        .flat_map(|entry| entries.iter().map(move |other| (entry, other)))
        .filter(|(entry, other)| entry.col == other.col)
        .collect();
    if entries.is_empty() || pairs.len() > LARGEST_UNROLLED {
        return TokenStream::new();
    }
    let products = pairs.iter().filter(|(entry, other)| other.row <= entry.row).map(|(entry, other)| {
        let (Entry { row, col, .. }, values) = (entry, [slope(entry), slope(other)]);
        let other = other.row;
        quote!(visit(#row, #other, #col, #(#values),*);)
    });
    let slopes = entries.iter().map(|entry| {
        let (Entry { row, col, .. }, slope) = (entry, slope(entry));
        quote!(visit(#row, #col, #slope);)
    });
    let pairs = pairs.iter().map(|(entry, other)| {
        let (Entry { row, col, .. }, slope, other) = (entry, slope(entry), other.row);
        quote!(visit(#row, #other, #col, #slope);)
    });
    quote! {
        #[inline(always)]
        fn for_each_slope<T: ::core::marker::Copy>(
            c: &Self::PerConstant<T>,
            g: &Self::PerJacobianEntry<T>,
            mut visit: impl ::core::ops::FnMut(usize, usize, T),
        ) {
            #(#slopes)*
        }

        #[inline(always)]
        fn for_each_slope_pair<T: ::core::marker::Copy>(
            c: &Self::PerConstant<T>,
            g: &Self::PerJacobianEntry<T>,
            mut visit: impl ::core::ops::FnMut(usize, usize, usize, T),
        ) {
            #(#pairs)*
        }

        #[inline(always)]
        fn for_each_gram_product<T: ::core::marker::Copy>(
            c: &Self::PerConstant<T>,
            g: &Self::PerJacobianEntry<T>,
            mut visit: impl ::core::ops::FnMut(usize, usize, usize, T, T),
        ) {
            #(#products)*
        }
    }
}

fn slope(entry: &Entry) -> TokenStream {
    match entry.value {
        EntryValue::Constant(slot) => quote!(c[#slot]),
        EntryValue::Varying(index) => quote!(g[#index]),
    }
}
