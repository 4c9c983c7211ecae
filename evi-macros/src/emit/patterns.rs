//! Loops over the entries of derivatives, written out.

use proc_macro2::TokenStream;
use quote::{format_ident, quote};

use crate::structure::{Entry, EntryValue, Structure};

/// Beyond so many calls a loop takes their place: the trait's default.
const LARGEST_UNROLLED: usize = 500;

/// `for_each_slope`, `for_each_slope_pair`, `for_each_gram_product`, `for_each_vv` and `for_each_qq`.
pub(super) fn loops(structure: &Structure) -> TokenStream {
    let slopes = slopes(structure);
    let vv = symmetric("for_each_vv", &structure.hessian_vv);
    let qq = symmetric("for_each_qq", &structure.hessian_qq);
    quote!(#slopes #vv #qq)
}

fn slopes(structure: &Structure) -> TokenStream {
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
        let (Entry { row, col, .. }, values) = (entry, [value(entry, &quote!(g)), value(other, &quote!(g))]);
        let other = other.row;
        quote!(visit(#row, #other, #col, #(#values),*);)
    });
    let slopes = entries.iter().map(|entry| {
        let (Entry { row, col, .. }, slope) = (entry, value(entry, &quote!(g)));
        quote!(visit(#row, #col, #slope);)
    });
    let pairs = pairs.iter().map(|(entry, other)| {
        let (Entry { row, col, .. }, slope, other) = (entry, value(entry, &quote!(g)), other.row);
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

/// A lower triangle, with what mirrors it.
fn symmetric(name: &str, entries: &[Entry]) -> TokenStream {
    if entries.is_empty() || entries.len() > LARGEST_UNROLLED {
        return TokenStream::new();
    }
    let calls = entries.iter().map(|entry| {
        let (&Entry { row, col, .. }, value) = (entry, value(entry, &quote!(h)));
        let mirrored = (row != col).then(|| quote!(visit(#col, #row, #value);));
        quote!(visit(#row, #col, #value); #mirrored)
    });
    let name = format_ident!("{name}");
    quote! {
        #[inline(always)]
        fn #name<T: ::core::marker::Copy>(
            c: &Self::PerConstant<T>,
            h: &Self::PerHessianEntry<T>,
            mut visit: impl ::core::ops::FnMut(usize, usize, T),
        ) {
            #(#calls)*
        }
    }
}

/// A constant, or what the kernel has returned in the array that is named.
fn value(entry: &Entry, kernel: &TokenStream) -> TokenStream {
    match entry.value {
        EntryValue::Constant(slot) => quote!(c[#slot]),
        EntryValue::Varying(index) => quote!(#kernel[#index]),
    }
}
