//! A symbolic elimination as straight-line code.

use std::collections::BTreeMap;

use proc_macro2::{Ident, TokenStream};
use quote::quote;

use crate::structure::Elimination;

/// Places of the factors' entries in the array `e`.
struct Layout {
    places: BTreeMap<(usize, usize), usize>,
}

impl Layout {
    fn of(elimination: &Elimination) -> Self {
        let mut places = BTreeMap::new();
        let mut place = |entry| {
            let next = places.len();
            places.entry(entry).or_insert(next);
        };
        for (&pivot, coupled) in elimination.order.iter().zip(&elimination.coupled) {
            place((pivot, pivot));
            for &row in coupled {
                place((row, pivot));
                place((pivot, row));
            }
        }
        Self { places }
    }

    fn entry(&self, row: usize, col: usize) -> TokenStream {
        let place = self.places[&(row, col)];
        quote!(e[#place])
    }
}

/// The type `name`, which factors the matrix without pivoting in the order of `elimination`.
///
/// `e` holds the reciprocal pivots on the diagonal, `L` (unit diagonal) below and `U` above it, in the order of
/// elimination. `s` accumulates the magnitudes that each pivot is a sum of: a pivot far below is round-off.
pub(super) fn elimination_type(name: &Ident, elimination: &Elimination) -> TokenStream {
    let layout = Layout::of(elimination);
    let (n_entries, dimension) = (layout.places.len(), elimination.dimension);
    let loaded = elimination.entries.iter().map(|&(row, col)| {
        let entry = layout.entry(row, col);
        quote!(#entry = m[#row][#col];)
    });
    let magnitudes = (0..dimension).filter(|&row| elimination.entries.contains(&(row, row))).map(|row| {
        let diagonal = layout.entry(row, row);
        quote!(s[#row] = #diagonal.abs();)
    });
    let eliminated = elimination.order.iter().zip(&elimination.coupled).map(|(&pivot, coupled)| {
        let diagonal = layout.entry(pivot, pivot);
        let multipliers = coupled.iter().map(|&row| {
            let below = layout.entry(row, pivot);
            quote!(#below *= #diagonal;)
        });
        let updates =
            coupled.iter().flat_map(|&row| coupled.iter().map(move |&col| (row, col))).map(|(row, col)| {
                let (target, below, right) =
                    (layout.entry(row, col), layout.entry(row, pivot), layout.entry(pivot, col));
                if row == col {
                    quote!({ let update = #below * #right; #target -= update; s[#row] += update.abs(); })
                } else {
                    quote!(#target -= #below * #right;)
                }
            });
        quote! {
            #diagonal = ::evi_core::__private::reciprocal_pivot(#diagonal, s[#pivot])?;
            #(#multipliers)*
            #(#updates)*
        }
    });
    let forward = elimination.order.iter().zip(&elimination.coupled).flat_map(|(&pivot, coupled)| {
        let layout = &layout;
        coupled.iter().map(move |&row| {
            let below = layout.entry(row, pivot);
            quote!(b[#row] -= #below * b[#pivot];)
        })
    });
    let backward = elimination.order.iter().zip(&elimination.coupled).rev().map(|(&pivot, coupled)| {
        let diagonal = layout.entry(pivot, pivot);
        let terms = coupled.iter().map(|&col| {
            let right = layout.entry(pivot, col);
            quote!(- #right * b[#col])
        });
        quote!(b[#pivot] = (b[#pivot] #(#terms)*) * #diagonal;)
    });
    quote! {
        #[doc(hidden)]
        pub struct #name {
            e: [f64; #n_entries],
        }

        #[automatically_derived]
        #[allow(clippy::all)]
        impl ::evi_core::__private::Elimination<#dimension> for #name {
            #[inline]
            fn factor(m: &[[f64; #dimension]; #dimension]) -> ::core::option::Option<Self> {
                let mut e = [0.0_f64; #n_entries];
                let mut s = [0.0_f64; #dimension];
                #(#loaded)*
                #(#magnitudes)*
                #(#eliminated)*
                ::core::option::Option::Some(Self { e })
            }

            #[inline]
            fn solve(&self, b: &mut [f64; #dimension]) {
                let e = &self.e;
                #(#forward)*
                #(#backward)*
            }
        }
    }
}
