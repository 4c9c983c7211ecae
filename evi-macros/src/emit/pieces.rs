//! Long sums, products and chains of methods in pieces that rustc parses and drops without running out of stack.
//!
//! `a + b + c + …` nests as deep as it is long; between 4,000 and 8,000 operands rustc crashes. Here
//! `{ let __piece = a + b; __piece + c + … }` takes its place: the same operations in the same order, to the last bit.

use proc_macro2::{TokenStream, TokenTree};
use quote::quote;

/// Operations of one piece: far from rustc's limits, and long enough to be rare.
const LONGEST_PIECE: usize = 100;

/// The tokens of one delimiter's contents, with what is long in them in pieces: expressions between commas, or the
/// statements of a block.
pub(super) fn in_pieces(tokens: &[TokenTree]) -> TokenStream {
    let mut split = TokenStream::new();
    for segment in tokens.split_inclusive(|token| is_one_of(token, ";,")) {
        let (expression, end) = match segment.split_last() {
            Some((end, rest)) if is_one_of(end, ";,") => (rest, Some(end.clone())),
            _ => (segment, None),
        };
        let head = match expression.first() {
            Some(TokenTree::Ident(word)) if word == "let" => {
                expression.iter().position(|token| is_one_of(token, "=")).map_or(0, |equals| equals + 1)
            }
            _ => 0,
        };
        split.extend(expression[..head].iter().cloned());
        split.extend(pieces_of(Operation::Sum, &expression[head..]));
        split.extend(end);
    }
    split
}

/// Operations that nest to the left, from the loosest to the tightest.
#[derive(Clone, Copy)]
enum Operation {
    Sum,
    Product,
    Call,
}

impl Operation {
    fn marks(self) -> &'static str {
        match self {
            Self::Sum => "+-",
            Self::Product => "*/",
            Self::Call => ".",
        }
    }

    fn tighter(self) -> Option<Self> {
        match self {
            Self::Sum => Some(Self::Product),
            Self::Product => Some(Self::Call),
            Self::Call => None,
        }
    }
}

/// An expression whose `operation`s, and those that bind tighter, are in pieces.
fn pieces_of(operation: Operation, tokens: &[TokenTree]) -> TokenStream {
    // A sign binds looser than a method, tighter than a product: `-x.sin() * y` is `(-(x.sin())) * y`.
    let is_sign = |token: &&TokenTree| matches!(operation, Operation::Call) && is_one_of(token, "-");
    let (signs, tokens) = tokens.split_at(tokens.iter().take_while(is_sign).count());
    let operand = |tokens: &[TokenTree]| match operation.tighter() {
        Some(tighter) => pieces_of(tighter, tokens),
        None => tokens.iter().cloned().collect(),
    };
    let operators = operators(operation, tokens);
    let ends = operators.iter().copied().skip(1).chain([tokens.len()]);
    // Every operator with the operand behind it.
    let operations: Vec<TokenStream> = std::iter::zip(&operators, ends)
        .map(|(&start, end)| (&tokens[start], operand(&tokens[start + 1..end])))
        .map(|(operator, operand)| quote!(#operator #operand))
        .collect();
    let first = operand(&tokens[..operators.first().copied().unwrap_or(tokens.len())]);
    if operations.len() <= LONGEST_PIECE {
        return quote!(#(#signs)* #first #(#operations)*);
    }
    let mut chunks = operations.chunks(LONGEST_PIECE);
    let last = chunks.next_back().expect("there are more operations than one piece has");
    let mut value = first;
    let mut lets = TokenStream::new();
    for chunk in chunks {
        lets.extend(quote!(let __piece = #value #(#chunk)*;));
        value = quote!(__piece);
    }
    // In parentheses, for a block may begin a statement.
    quote!(#(#signs)* ({ #lets #value #(#last)* }))
}

/// Places of the infix operators outside of groups.
fn operators(operation: Operation, tokens: &[TokenTree]) -> Vec<usize> {
    let is_infix = |&at: &usize| {
        is_one_of(&tokens[at], operation.marks()) && !matches!(tokens[at - 1], TokenTree::Punct(_))
    };
    (1..tokens.len()).filter(is_infix).collect()
}

fn is_one_of(token: &TokenTree, marks: &str) -> bool {
    matches!(token, TokenTree::Punct(punct) if marks.contains(punct.as_char()))
}
