//! Items that give an expression to names, and items that only give names.
//!
//! In: the tokens behind a keyword. Out: `force(x: EXPR)`, `frequency(x, y: EXPR)`, `observe(name: EXPR)` as names with an
//! expression, `input(u, w)` as names. What the names mean is left to `model`.

use proc_macro2::{Ident, Spacing, TokenTree};

use super::expression::Expression;
use super::indexed::{Indexed, brackets, leading_brackets};
use super::item::{identifier, parenthesized, split_at_commas};
use crate::diagnostics::Diagnostics;

/// `keyword(NAME, ..: EXPR)`, with brackets behind names; names and value are missing where they did not parse.
pub(crate) struct Labelled {
    pub(crate) names: Vec<Indexed>,
    pub(crate) value: Option<Expression>,
}

/// `keyword(NAME, ..)`
pub(crate) struct NameList {
    pub(crate) names: Vec<Ident>,
}

/// How an item of this kind is written, for messages.
#[derive(Clone, Copy)]
pub(super) struct Form {
    /// The whole item.
    pub(super) example: &'static str,
    /// What is missing where no name stands before a colon.
    pub(super) unnamed: &'static str,
    /// What the item is called.
    pub(super) label: &'static str,
    /// What to do about a second name, where only one may stand.
    pub(super) second_name: Option<&'static str>,
}

/// Parses the names and the expression behind `keyword`.
pub(super) fn labelled(
    keyword: &Ident,
    form: Form,
    rest: &[TokenTree],
    diagnostics: &mut Diagnostics,
) -> Labelled {
    let nothing = Labelled { names: Vec::new(), value: None };
    let Some(group) = parenthesized(keyword, form.example, rest, diagnostics) else {
        return nothing;
    };
    let tokens: Vec<TokenTree> = group.stream().into_iter().collect();
    let Some(colon) = colon(&tokens).filter(|&colon| colon > 0) else {
        let span = tokens.first().map_or(keyword.span(), TokenTree::span);
        diagnostics.report(span, format!("{}: `{}`", form.unnamed, form.example));
        return nothing;
    };
    let names = names(&tokens[..colon], form.label, diagnostics);
    let has_comma = split_at_commas(tokens[..colon].iter().cloned().collect()).len() > 1;
    if let (Some(message), Some(second), true) = (form.second_name, names.get(1), has_comma) {
        diagnostics.report(second.span(), message);
    }
    let value = tokens[colon + 1..].iter().cloned().collect();
    Labelled { names, value: Expression::parse(value, tokens[colon].span(), diagnostics) }
}

/// Parses the names behind `keyword`.
pub(super) fn name_list(
    keyword: &Ident,
    example: &str,
    rest: &[TokenTree],
    diagnostics: &mut Diagnostics,
) -> NameList {
    let Some(group) = parenthesized(keyword, example, rest, diagnostics) else {
        return NameList { names: Vec::new() };
    };
    let tokens: Vec<TokenTree> = group.stream().into_iter().collect();
    if tokens.is_empty() {
        diagnostics.report(keyword.span(), format!("write `{example}`"));
    }
    let names = names(&tokens, "an input", diagnostics);
    for indexed in names.iter().filter(|indexed| !indexed.brackets.is_empty()) {
        let message = format!("an input is a number: write `{0}0, {0}1, ..`", indexed.name);
        diagnostics.report(indexed.span(), message);
    }
    NameList { names: names.into_iter().map(|indexed| indexed.name).collect() }
}

/// Names between commas, each with its brackets.
fn names(tokens: &[TokenTree], what: &str, diagnostics: &mut Diagnostics) -> Vec<Indexed> {
    let mut names = Vec::new();
    for entry in split_at_commas(tokens.iter().cloned().collect()) {
        let mut rest = entry.as_slice();
        while let Some((token, behind)) = rest.split_first() {
            let TokenTree::Ident(name) = token else {
                diagnostics.report(token.span(), format!("{what} is a name"));
                break;
            };
            if rest.len() < entry.len() {
                diagnostics.report(name.span(), format!("a comma is missing before `{name}`"));
            }
            let groups = leading_brackets(behind);
            let name = identifier(name, diagnostics);
            names.extend(name.map(|name| brackets(&name, &groups, diagnostics)));
            rest = &behind[groups.len()..];
        }
    }
    names
}

/// The place of the first `:` that is not half of a `::`.
fn colon(tokens: &[TokenTree]) -> Option<usize> {
    let is_colon = |token: &TokenTree| matches!(token, TokenTree::Punct(punct) if punct.as_char() == ':');
    let is_joint =
        |token: &TokenTree| matches!(token, TokenTree::Punct(punct) if punct.spacing() == Spacing::Joint);
    let first = tokens.iter().position(is_colon)?;
    let is_path = is_joint(&tokens[first]) && tokens.get(first + 1).is_some_and(is_colon);
    (!is_path).then_some(first)
}
