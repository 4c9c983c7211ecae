//! Names with brackets: elements of arrays, and families by one index or more.
//!
//! In: `link[i in 1..N]`, `p[i in 0..N][1]`, `r[0]`. Out: the name, and what stands in each pair of brackets.

use proc_macro2::{Delimiter, Group, Ident, Span, TokenTree};

use super::affine::{Integer, affine};
use super::expression::Expression;
use super::item::{identifier, split_at_commas};
use crate::budget::MOST_UNROLLED_EQUATIONS;
use crate::diagnostics::Diagnostics;

/// A name with what stands in brackets behind it.
#[derive(Clone)]
pub(crate) struct Indexed {
    pub(crate) name: Ident,
    pub(crate) brackets: Vec<Bracket>,
}

/// What stands in brackets.
#[derive(Clone)]
pub(crate) enum Bracket {
    /// One element.
    At(Expression),
    /// One for every value of an index.
    Each(Range),
}

/// `NAME in FROM..TO`; the ends are missing where they did not parse.
#[derive(Clone)]
pub(crate) struct Range {
    pub(crate) index: Ident,
    pub(crate) ends: Option<Expression>,
}

impl Indexed {
    /// The ranges of a family, outermost first.
    pub(crate) fn ranges(&self) -> Vec<&Range> {
        let mut ranges = Vec::new();
        for bracket in &self.brackets {
            if let Bracket::Each(range) = bracket {
                ranges.push(range);
            }
        }
        ranges
    }

    pub(crate) fn span(&self) -> Span {
        self.name.span()
    }
}

impl Range {
    /// Its values, where both ends are literals.
    pub(crate) fn literal(&self) -> Option<std::ops::Range<i64>> {
        let syn::Expr::Range(syn::ExprRange { start: Some(start), end: Some(end), limits, .. }) =
            self.ends.as_ref()?.root()
        else {
            return None;
        };
        let number = |end: &syn::Expr| {
            let mut unknown = |_: &Ident, _: &mut Diagnostics| Integer::Unknown;
            affine(end, &mut unknown, &mut Diagnostics::default())?.as_number()
        };
        let behind = i64::from(matches!(limits, syn::RangeLimits::Closed(_)));
        let range = number(start)?..number(end)?.checked_add(behind)?;
        (range.end.checked_sub(range.start)? <= MOST_UNROLLED_EQUATIONS).then_some(range)
    }
}

/// Parses the brackets behind a name; a pair may hold several entries between commas.
pub(super) fn brackets(name: &Ident, groups: &[Group], diagnostics: &mut Diagnostics) -> Indexed {
    let mut brackets = Vec::new();
    for group in groups {
        let entries = split_at_commas(group.stream());
        if entries.is_empty() {
            let message = format!("write an index, `{name}[0]`, or a range of them, `{name}[i in 0..N]`");
            diagnostics.report(group.span(), message);
        }
        for entry in entries {
            brackets.extend(bracket(&entry, diagnostics));
        }
    }
    Indexed { name: name.clone(), brackets }
}

fn bracket(entry: &[TokenTree], diagnostics: &mut Diagnostics) -> Option<Bracket> {
    match entry {
        [TokenTree::Ident(index), TokenTree::Ident(word), ends @ ..] if word == "in" => {
            let index = identifier(index, diagnostics)?;
            let ends = Expression::parse(ends.iter().cloned().collect(), word.span(), diagnostics);
            Some(Bracket::Each(Range { index, ends }))
        }
        entry => {
            let before = entry[0].span();
            Expression::parse(entry.iter().cloned().collect(), before, diagnostics).map(Bracket::At)
        }
    }
}

/// The groups of brackets at the beginning of the tokens.
pub(super) fn leading_brackets(tokens: &[TokenTree]) -> Vec<Group> {
    let bracket = |token: &TokenTree| match token {
        TokenTree::Group(group) if group.delimiter() == Delimiter::Bracket => Some(group.clone()),
        _ => None,
    };
    tokens.iter().map_while(bracket).collect()
}
