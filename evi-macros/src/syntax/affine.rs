//! From a Rust expression to an affine integer expression: indices, ends of ranges, sizes.

use proc_macro2::{Ident, TokenTree};
use quote::ToTokens;

use super::lowering::is_screaming_case;
use crate::diagnostics::Diagnostics;
use crate::expr::Affine;

/// What a name is where an integer stands.
pub(super) enum Integer {
    Affine(Affine),
    /// Another thing than an integer, which has been reported.
    Mistaken,
    Unknown,
}

/// The affine expression in the names that `integer` knows and in named constants; `None` where a mistake was reported.
pub(super) fn affine(
    expression: &syn::Expr,
    integer: &mut dyn FnMut(&Ident, &mut Diagnostics) -> Integer,
    diagnostics: &mut Diagnostics,
) -> Option<Affine> {
    // Along sums in a loop, for they may be as long as the user likes.
    let mut operations = Vec::new();
    let mut first = expression;
    while let syn::Expr::Binary(binary) = first {
        operations.push(binary);
        first = &binary.left;
    }
    let mut value = operand(first, integer, diagnostics);
    for binary in operations.into_iter().rev() {
        let right = affine(&binary.right, integer, diagnostics);
        let (Some(left), Some(right)) = (value, right) else { return None };
        value = match binary.op {
            syn::BinOp::Add(_) => left.plus(1, &right),
            syn::BinOp::Sub(_) => left.plus(-1, &right),
            syn::BinOp::Mul(_) => left.times(&right),
            _ => None,
        };
        if value.is_none() {
            return not_affine(binary, diagnostics);
        }
    }
    value
}

fn operand(
    expression: &syn::Expr,
    integer: &mut dyn FnMut(&Ident, &mut Diagnostics) -> Integer,
    diagnostics: &mut Diagnostics,
) -> Option<Affine> {
    match expression {
        syn::Expr::Lit(syn::ExprLit { lit: syn::Lit::Int(number), .. })
            if matches!(number.suffix(), "" | "usize") =>
        {
            match number.base10_parse() {
                Ok(number) => Some(Affine::number(number)),
                Err(_) => not_affine(expression, diagnostics),
            }
        }
        syn::Expr::Unary(syn::ExprUnary { op: syn::UnOp::Neg(_), expr, .. }) => {
            let negative = Affine::default().plus(-1, &affine(expr, integer, diagnostics)?);
            negative.or_else(|| not_affine(expression, diagnostics))
        }
        syn::Expr::Paren(inner) => affine(&inner.expr, integer, diagnostics),
        syn::Expr::Group(inner) => affine(&inner.expr, integer, diagnostics),
        syn::Expr::Path(path) if path.qself.is_none() => {
            let Some(name) = path.path.get_ident() else {
                return Some(Affine::size(path.to_token_stream()));
            };
            match integer(name, diagnostics) {
                Integer::Affine(value) => Some(value),
                Integer::Mistaken => None,
                Integer::Unknown if is_screaming_case(name) => Some(Affine::size(path.to_token_stream())),
                Integer::Unknown => {
                    let message = format!(
                        "unknown index `{name}`: indices come from `sum(0..N, |{name}| ..)` or \
                         `constraint(name[{name} in 0..N]: ..)`, sizes are constants such as `N`"
                    );
                    diagnostics.report(name.span(), message);
                    None
                }
            }
        }
        other => not_affine(other, diagnostics),
    }
}

fn not_affine<X>(syntax: &impl ToTokens, diagnostics: &mut Diagnostics) -> Option<X> {
    let tokens: Vec<TokenTree> = syntax.to_token_stream().into_iter().collect();
    let (first, last) = (tokens.first().expect("syntax has tokens"), tokens.last().expect("as above"));
    let message = "not an affine index: write indices and constants times integers, such as `i`, `i - 1`, `2 * i + 1`, `N - 1`";
    diagnostics.report_range(first.span(), last.span(), message);
    None
}
