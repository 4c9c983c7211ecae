//! How deep the tokens of a struct may nest.
//!
//! In: the tokens of a struct. Out: the same tokens, or, where something nests deeper than the stages recurse safely, a
//! mistake at its token and a number in its place.

use proc_macro2::{Group, Literal, Span, TokenStream, TokenTree};

use crate::diagnostics::Diagnostics;

/// Levels of parentheses, brackets, braces and signs, the attribute's own among them. So many need at most 1.3 MB of stack when
/// `syn` is compiled without optimisation, as it is for derives; rust-analyzer gives them 2 MB, rustc 8 MB.
pub(super) const DEEPEST_NESTING: usize = 64;

/// The tokens without what nests too deep, which is reported.
pub(super) fn bounded(tokens: TokenStream, diagnostics: &mut Diagnostics) -> TokenStream {
    if is_bounded(&tokens, DEEPEST_NESTING) { tokens } else { pruned(tokens, DEEPEST_NESTING, diagnostics) }
}

fn is_bounded(tokens: &TokenStream, allowed: usize) -> bool {
    let mut levels = Levels::default();
    tokens.clone().into_iter().all(|token| {
        let open = levels.take(&token);
        match token {
            TokenTree::Group(group) => open < allowed && is_bounded(&group.stream(), allowed - open - 1),
            _ => open <= allowed,
        }
    })
}

fn pruned(tokens: TokenStream, allowed: usize, diagnostics: &mut Diagnostics) -> TokenStream {
    let mut levels = Levels::default();
    let mut kept = TokenStream::new();
    let mut is_reported = false;
    for token in tokens {
        let open = levels.take(&token);
        let is_too_deep = open + usize::from(matches!(token, TokenTree::Group(_))) > allowed;
        if is_too_deep && !is_reported {
            let message = format!(
                "nested too deeply: at most {DEEPEST_NESTING} levels of parentheses and signs; give what is inside a `let`"
            );
            diagnostics.report(opening_span(&token), message);
        }
        is_reported = is_too_deep;
        match token {
            TokenTree::Group(group) => {
                let inside = if is_too_deep {
                    TokenTree::from(Literal::f64_unsuffixed(0.0)).into()
                } else {
                    pruned(group.stream(), allowed - open - 1, diagnostics)
                };
                let mut shallow = Group::new(group.delimiter(), inside);
                shallow.set_span(group.span());
                kept.extend([TokenTree::Group(shallow)]);
            }
            // What is left out is behind a mistake that has been reported.
            token if !is_too_deep => kept.extend([token]),
            _ => {}
        }
    }
    kept
}

fn opening_span(token: &TokenTree) -> Span {
    match token {
        TokenTree::Group(group) => group.span_open(),
        other => other.span(),
    }
}

/// Levels that the tokens of one stream open in front of each other, without parentheses.
#[derive(Default)]
struct Levels {
    /// Signs and other operators in front of the operand to come: each nests what is behind it.
    prefixes: usize,
    /// What has no place in an equation, and may nest as it likes: `a = b = c`, `|a| |b| c`, `return return x`.
    others: usize,
    behind: Behind,
}

/// What stands before a token.
#[derive(Default, PartialEq)]
enum Behind {
    #[default]
    Nothing,
    Name,
    Operand,
    Operator,
}

impl Levels {
    /// Takes up the next token; returns the levels that are open at it.
    fn take(&mut self, token: &TokenTree) -> usize {
        match token {
            TokenTree::Punct(punct) => match punct.as_char() {
                ';' | ',' | '#' => *self = Self::default(),
                // Paths are flat.
                ':' => self.behind = Behind::Operator,
                _ if self.behind == Behind::Operator || self.behind == Behind::Nothing => self.prefixes += 1,
                '+' | '-' | '*' | '/' | '.' => self.behind = Behind::Operator,
                _ => {
                    self.others += 1;
                    self.behind = Behind::Operator;
                }
            },
            TokenTree::Ident(_) if self.behind == Behind::Name => self.others += 1,
            TokenTree::Ident(_) => self.operand(Behind::Name),
            TokenTree::Group(_) if self.behind == Behind::Operand => self.others += 1,
            TokenTree::Literal(_) | TokenTree::Group(_) => {}
        }
        let levels = self.prefixes + self.others;
        if matches!(token, TokenTree::Literal(_) | TokenTree::Group(_)) {
            self.operand(Behind::Operand);
        }
        levels
    }

    fn operand(&mut self, behind: Behind) {
        self.prefixes = 0;
        self.behind = behind;
    }
}
