//! Tokens gone wrong: dropped, duplicated, moved, in other parentheses, nested, from another place, or soup.
//!
//! Groups without delimiters are among the parentheses: that is what a `macro_rules!` puts around what it has captured.

use proc_macro2::{Delimiter, Group, TokenStream, TokenTree};

use super::super::random_choices::Choices;

/// Tokens that something may be replaced by; each line is lexed as a whole.
const VOCABULARY: &[&str] = &[
    "x",
    "y",
    "der",
    "t",
    "sum",
    "in",
    "i",
    "p[i]",
    "[x, 1.0]",
    "N",
    "999999999999",
    ",",
    "=",
    "==",
    ":",
    "::",
    ".",
    "..",
    "..=",
    ";",
    "+",
    "-",
    "*",
    "/",
    "^",
    "%",
    "&",
    "&&",
    "|",
    "!",
    "!=",
    "<",
    "<=",
    "=>",
    "->",
    "?",
    "@",
    "#",
    "$",
    "_",
    "1",
    "0.5",
    "1e999",
    "1.",
    "0x",
    "b'a'",
    "\"s\"",
    "'c'",
    "'a",
    "c\"s\"",
    "r#\"s\"#",
    "let",
    "fn",
    "self",
    "crate",
    "r#let",
    "θ",
    "struct",
    "enum",
    "match",
    "if",
    "else",
    "return",
    "move",
    "async",
    "unsafe",
    "const",
    "coordinates",
    "kinetic",
    "potential",
    "lagrangian",
    "constraint",
    "force",
    "input",
    "frequency",
    "observe",
    "dissipation",
    "powi",
    "sin",
    "evi",
    "derive",
    "f64",
    "PI",
    "where",
    "for",
    "dyn",
    "impl",
    "as",
    "()",
    "[]",
    "{}",
    "(x)",
    "[x]",
    "{ x }",
    "let x = x;",
    "x: x",
    "(x == y)",
    "= x",
    "#[evi(x)]",
    "#![x]",
    "<T>",
    "|x| x",
    "x => x",
];
const DELIMITERS: [Delimiter; 4] =
    [Delimiter::Parenthesis, Delimiter::Bracket, Delimiter::Brace, Delimiter::None];

/// Tokens with some of them gone wrong.
pub(super) fn mutated(tokens: TokenStream, choices: &mut Choices) -> TokenStream {
    let mut trees: Vec<TokenTree> = tokens.into_iter().collect();
    for _ in 0..=choices.below(3) {
        mutate(&mut trees, choices);
    }
    trees.into_iter().collect()
}

/// Any tokens.
pub(super) fn soup(choices: &mut Choices, depth: usize) -> TokenStream {
    let mut trees = Vec::new();
    for _ in 0..choices.below(12) {
        if depth > 0 && choices.once_in(4) {
            let delimiter = choices.pick(&DELIMITERS);
            let inside = soup(choices, depth - 1);
            trees.push(group(delimiter, inside));
        } else {
            trees.extend(words(choices));
        }
    }
    trees.into_iter().collect()
}

/// A struct, whose attribute goes on with these tokens.
pub(super) fn with_attribute(structure: TokenStream, behind: TokenStream) -> TokenStream {
    let mut trees: Vec<TokenTree> = structure.into_iter().collect();
    let appended = |tree: &TokenTree, behind: TokenStream| match tree {
        TokenTree::Group(group) => {
            let mut longer =
                Group::new(group.delimiter(), group.stream().into_iter().chain(behind).collect());
            longer.set_span(group.span());
            TokenTree::Group(longer)
        }
        other => other.clone(),
    };
    // `#`, and `[evi(..)]`, whose last token is the list of items.
    let TokenTree::Group(attribute) = &trees[1] else { unreachable!("an attribute stands in brackets") };
    let mut inside: Vec<TokenTree> = attribute.stream().into_iter().collect();
    inside[1] = appended(&inside[1], behind);
    trees[1] = appended(
        &TokenTree::Group(Group::new(Delimiter::Bracket, TokenStream::new())),
        inside.into_iter().collect(),
    );
    trees.into_iter().collect()
}

fn words(choices: &mut Choices) -> Vec<TokenTree> {
    let text = choices.pick(VOCABULARY);
    // What is no token by itself, as `0x`, is left out.
    text.parse::<TokenStream>().map(|tokens| tokens.into_iter().collect()).unwrap_or_default()
}

/// A group with a place of its own, as the compiler gives it.
fn group(delimiter: Delimiter, inside: TokenStream) -> TokenTree {
    let place: Group = syn::parse_str("()").expect("a group");
    let mut group = Group::new(delimiter, inside);
    group.set_span(place.span());
    TokenTree::Group(group)
}

/// One mutation, at any depth.
fn mutate(trees: &mut Vec<TokenTree>, choices: &mut Choices) {
    if trees.is_empty() {
        trees.extend(words(choices));
        return;
    }
    let at = choices.below(trees.len());
    if let TokenTree::Group(inner) = &trees[at]
        && !choices.once_in(4)
    {
        let mut inside: Vec<TokenTree> = inner.stream().into_iter().collect();
        mutate(&mut inside, choices);
        let mut changed = Group::new(inner.delimiter(), inside.into_iter().collect());
        changed.set_span(inner.span());
        trees[at] = TokenTree::Group(changed);
        return;
    }
    match choices.below(9) {
        0 => {
            trees.remove(at);
        }
        1 => trees.insert(at, trees[at].clone()),
        2 => {
            let other = choices.below(trees.len());
            trees.swap(at, other);
        }
        3 => {
            trees.splice(at..=at, words(choices));
        }
        4 => {
            trees.splice(at..at, words(choices));
        }
        5 => {
            let end = at + 1 + choices.below(trees.len() - at);
            let inside = trees[at..end].iter().cloned().collect();
            trees.splice(at..end, [group(choices.pick(&DELIMITERS), inside)]);
        }
        6 => match trees[at].clone() {
            // Other delimiters, or none.
            TokenTree::Group(inner) if choices.once_in(2) => {
                trees[at] = group(choices.pick(&DELIMITERS), inner.stream());
            }
            TokenTree::Group(inner) => {
                trees.splice(at..=at, inner.stream());
            }
            _ => trees.truncate(at),
        },
        7 => {
            let delimiter = choices.pick(&DELIMITERS);
            for _ in 0..choices.below(80) {
                trees[at] = group(delimiter, trees[at].clone().into());
            }
        }
        _ => {
            let repeated = trees[at].clone();
            trees.splice(at..at, std::iter::repeat_n(repeated, choices.below(300)));
        }
    }
}
