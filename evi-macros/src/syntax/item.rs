//! The items of `#[evi(...)]`, each parsed by itself.
//!
//! A mistaken item keeps its place, with what could be read of it, so that it is not reported as missing.

use proc_macro2::{Delimiter, Group, Ident, Punct, Spacing, Span, TokenStream, TokenTree};

use super::expression::Expression;
use super::indexed::{Bracket, Indexed, brackets, leading_brackets};
use super::labelled::{Form, Labelled, NameList, labelled, name_list};
use super::rigid_body::{ItemOrBody, rigid_body};
use super::shape::{Coordinate, array_of_coordinates};
use crate::diagnostics::{Diagnostics, closest, suggestion};

/// One item of the attribute. A value is missing where it did not parse.
pub(crate) enum Item {
    Coordinates(Coordinates),
    Lagrangian {
        keyword: Ident,
        value: Option<Expression>,
    },
    Kinetic {
        keyword: Ident,
        value: Option<Expression>,
    },
    Potential {
        keyword: Ident,
        value: Option<Expression>,
    },
    Constraint(Constraint),
    /// `dissipation = EXPR`
    Dissipation {
        keyword: Ident,
        value: Option<Expression>,
    },
    /// `force(COORDINATE: EXPR)`
    Force(Labelled),
    /// `input(NAME, ..)`
    Inputs(NameList),
    /// `frequency(COORDINATE, ..: EXPR)`
    Frequency(Labelled),
    /// `observe(NAME: EXPR)`
    Observe(Labelled),
    Let(Let),
    /// None of these, which has been reported.
    Unknown,
}

/// `coordinates(x, y)`, `coordinates(r: [3], p: [N, 2])`
pub(crate) struct Coordinates {
    pub(crate) keyword: Ident,
    pub(crate) entries: Vec<Coordinate>,
    /// Whether every entry is known.
    pub(crate) is_complete: bool,
}

/// `constraint(NAME: LHS == RHS)`, `constraint(NAME[i in 0..N]: LHS == RHS)`; name and sides are missing where they did not parse.
pub(crate) struct Constraint {
    pub(crate) name: Option<Indexed>,
    pub(crate) left: Option<Expression>,
    pub(crate) right: Option<Expression>,
}

/// `let NAME = EXPR`
pub(crate) struct Let {
    pub(crate) name: Ident,
    pub(crate) value: Option<Expression>,
}

/// The items, as the user writes them.
const KEYWORDS: [&str; 12] = [
    "coordinates",
    "lagrangian",
    "kinetic",
    "potential",
    "constraint",
    "dissipation",
    "force",
    "input",
    "frequency",
    "observe",
    "rigid_body",
    "let",
];

const FORCE: Form = Form {
    example: "force(coordinate: expression)",
    unnamed: "a force names its coordinate",
    label: "a force",
    second_name: Some("a force acts on one coordinate: write one `force(..)` for each"),
};
const FREQUENCY: Form = Form {
    example: "frequency(coordinate, ..: expression)",
    unnamed: "a frequency names its coordinates",
    label: "a frequency",
    second_name: None,
};
const OBSERVE: Form = Form {
    example: "observe(name: expression)",
    unnamed: "an observed quantity has a name",
    label: "an observed quantity",
    second_name: Some("an observed quantity has one name: write one `observe(..)` for each"),
};

/// Parses the items between the parentheses of an attribute.
pub(super) fn parse_items(tokens: TokenStream, diagnostics: &mut Diagnostics) -> Vec<ItemOrBody> {
    let mut items = Vec::new();
    for between_commas in split_at_commas(tokens) {
        let mut rest = between_commas.as_slice();
        while !rest.is_empty() {
            let next = (1..rest.len()).find(|&k| begins_item(&rest[..k], &rest[k..]));
            if let Some(next) = next {
                let message = format!("a comma is missing before `{}`", rest[next]);
                diagnostics.report(rest[next].span(), message);
            }
            let (item, behind) = rest.split_at(next.unwrap_or(rest.len()));
            let is_body = matches!(item.first(), Some(TokenTree::Ident(keyword)) if keyword == "rigid_body");
            match (is_body, item) {
                (true, [TokenTree::Ident(keyword), rest @ ..]) => {
                    let body = rigid_body(keyword, rest, diagnostics);
                    items.push(body.map_or(ItemOrBody::Item(Item::Unknown), ItemOrBody::Body));
                }
                _ => items.extend(parse_item(item, diagnostics).map(ItemOrBody::Item)),
            }
            rest = behind;
        }
    }
    items
}

/// Splits at the commas outside of groups; a trailing comma adds nothing.
pub(super) fn split_at_commas(tokens: TokenStream) -> Vec<Vec<TokenTree>> {
    let mut items = vec![Vec::new()];
    for token in tokens {
        match &token {
            TokenTree::Punct(punct) if punct.as_char() == ',' => items.push(Vec::new()),
            _ => items.last_mut().expect("there is always an open item").push(token),
        }
    }
    items.retain(|item| !item.is_empty());
    items
}

/// Whether an item begins where an expression cannot go on: a comma is missing.
fn begins_item(before: &[TokenTree], tokens: &[TokenTree]) -> bool {
    let is_named = matches!(before.last(), Some(TokenTree::Ident(previous)) if previous == "let");
    match tokens {
        [TokenTree::Ident(keyword), TokenTree::Group(_), ..] => {
            let lists = ["coordinates", "constraint", "force", "input", "frequency", "observe", "rigid_body"];
            lists.iter().any(|list| keyword == list)
        }
        [TokenTree::Ident(keyword), TokenTree::Punct(equals), rest @ ..] => {
            let is_energy =
                ["lagrangian", "kinetic", "potential", "dissipation"].iter().any(|energy| keyword == energy);
            is_energy && equals.as_char() == '=' && joined(equals, rest).is_none() && !is_named
        }
        [TokenTree::Ident(keyword), ..] => keyword == "let",
        _ => false,
    }
}

fn parse_item(tokens: &[TokenTree], diagnostics: &mut Diagnostics) -> Option<Item> {
    let (first, rest) = tokens.split_first()?;
    let TokenTree::Ident(keyword) = first else {
        diagnostics.report(first.span(), format!("an item begins with one of {}", KEYWORDS.join(", ")));
        return Some(Item::Unknown);
    };
    let keyword = keyword.clone();
    let name = keyword.to_string();
    let meant = KEYWORDS.into_iter().find(|known| *known == name).or_else(|| {
        let similar = suggestion(&name, KEYWORDS);
        let message = format!("unknown item `{name}`{similar}\nitems: {}", KEYWORDS.join(", "));
        diagnostics.report(keyword.span(), message);
        // Read as what it is similar to, for the mistakes inside.
        closest(&name, KEYWORDS)
    });
    Some(match meant {
        Some("coordinates") => Item::Coordinates(coordinates(keyword, rest, diagnostics)),
        Some("lagrangian") => {
            let value = assigned(&keyword, "lagrangian = expression", rest, diagnostics);
            Item::Lagrangian { keyword, value }
        }
        Some("kinetic") => {
            let value = assigned(&keyword, "kinetic = expression", rest, diagnostics);
            Item::Kinetic { keyword, value }
        }
        Some("potential") => {
            let value = assigned(&keyword, "potential = expression", rest, diagnostics);
            Item::Potential { keyword, value }
        }
        Some("constraint") => Item::Constraint(constraint(&keyword, rest, diagnostics)),
        Some("dissipation") => {
            let value = assigned(&keyword, "dissipation = expression", rest, diagnostics);
            Item::Dissipation { keyword, value }
        }
        Some("force") => Item::Force(labelled(&keyword, FORCE, rest, diagnostics)),
        Some("input") => Item::Inputs(name_list(&keyword, "input(name, ..)", rest, diagnostics)),
        Some("frequency") => Item::Frequency(labelled(&keyword, FREQUENCY, rest, diagnostics)),
        Some("observe") => Item::Observe(labelled(&keyword, OBSERVE, rest, diagnostics)),
        Some("let") => return let_item(&keyword, rest, diagnostics).map(Item::Let),
        _ => Item::Unknown,
    })
}

/// The contents of the parentheses that follow a keyword.
pub(super) fn parenthesized(
    keyword: &Ident,
    form: &str,
    rest: &[TokenTree],
    diagnostics: &mut Diagnostics,
) -> Option<Group> {
    match rest {
        [TokenTree::Group(group), extra @ ..] if group.delimiter() == Delimiter::Parenthesis => {
            if let Some(extra) = extra.first() {
                diagnostics.report(extra.span(), format!("a comma is missing before `{extra}`"));
            }
            Some(group.clone())
        }
        _ => {
            let span = rest.first().map_or(keyword.span(), TokenTree::span);
            diagnostics.report(span, format!("write `{form}`"));
            None
        }
    }
}

/// The expression behind `keyword =`.
fn assigned(
    keyword: &Ident,
    form: &str,
    rest: &[TokenTree],
    diagnostics: &mut Diagnostics,
) -> Option<Expression> {
    match rest {
        [TokenTree::Punct(equals), value @ ..]
            if equals.as_char() == '=' && joined(equals, value).is_none() =>
        {
            Expression::parse(value.iter().cloned().collect(), equals.span(), diagnostics)
        }
        _ => {
            let span = rest.first().map_or(keyword.span(), TokenTree::span);
            diagnostics.report(span, format!("write `{form}`"));
            None
        }
    }
}

fn coordinates(keyword: Ident, rest: &[TokenTree], diagnostics: &mut Diagnostics) -> Coordinates {
    let Some(group) = parenthesized(&keyword, "coordinates(x, y, ..)", rest, diagnostics) else {
        return Coordinates { keyword, entries: Vec::new(), is_complete: false };
    };
    let mut entries = Vec::new();
    let mut is_complete = true;
    let scalar = |name| Coordinate { name, shape: Vec::new() };
    for entry in split_at_commas(group.stream()) {
        match entry.as_slice() {
            [TokenTree::Ident(name), TokenTree::Punct(colon), sizes @ ..]
                if colon.as_char() == ':' && matches!(sizes.first(), Some(TokenTree::Group(_))) =>
            {
                let shape = array_of_coordinates(name, sizes, diagnostics);
                is_complete &= shape.is_some();
                let name = identifier(name, diagnostics);
                entries.extend(name.zip(shape).map(|(name, shape)| Coordinate { name, shape }));
            }
            [TokenTree::Ident(name), TokenTree::Punct(colon), ..] if colon.as_char() == ':' => {
                let message =
                    format!("a coordinate has no type, write `{name}`, or `{name}: [3]` for a vector");
                diagnostics.report(colon.span(), message);
                entries.extend(identifier(name, diagnostics).map(scalar));
            }
            [TokenTree::Ident(first), others @ ..] => {
                entries.extend(identifier(first, diagnostics).map(scalar));
                for other in others {
                    match other {
                        TokenTree::Ident(name) => {
                            diagnostics.report(name.span(), format!("a comma is missing before `{name}`"));
                            entries.extend(identifier(name, diagnostics).map(scalar));
                        }
                        other => {
                            diagnostics.report(other.span(), "a coordinate is a name");
                            is_complete = false;
                            break;
                        }
                    }
                }
            }
            other => {
                diagnostics.report(other[0].span(), "a coordinate is a name");
                is_complete = false;
            }
        }
    }
    Coordinates { keyword, entries, is_complete }
}

/// A name that Rust accepts for a variable.
pub(super) fn identifier(name: &Ident, diagnostics: &mut Diagnostics) -> Option<Ident> {
    // `syn` parses what is not a keyword.
    let parsed = syn::parse2::<Ident>(TokenTree::Ident(name.clone()).into());
    parsed
        .map_err(|_| diagnostics.report(name.span(), format!("`{name}` is a keyword of Rust, not a name")))
        .ok()
}

fn constraint(keyword: &Ident, rest: &[TokenTree], diagnostics: &mut Diagnostics) -> Constraint {
    let Some(group) = parenthesized(keyword, "constraint(name: lhs == rhs)", rest, diagnostics) else {
        return Constraint { name: None, left: None, right: None };
    };
    let tokens: Vec<TokenTree> = group.stream().into_iter().collect();
    let brackets = leading_brackets(tokens.get(1..).unwrap_or_default());
    match (tokens.first(), tokens.get(1 + brackets.len()..)) {
        (Some(TokenTree::Ident(name)), Some([TokenTree::Punct(colon), equation @ ..]))
            if colon.as_char() == ':' && !is_punct(equation.first(), ':') && name != "_" =>
        {
            let indexed = family(name, &brackets, diagnostics);
            let (left, right) = equation_sides(name, equation, diagnostics);
            Constraint { name: Some(indexed), left, right }
        }
        _ => {
            let span = tokens.first().map_or(keyword.span(), TokenTree::span);
            diagnostics.report(span, "a constraint has a name: `constraint(name: lhs == rhs)`");
            Constraint { name: None, left: None, right: None }
        }
    }
}

/// A name of which each pair of brackets holds ranges.
fn family(name: &Ident, groups: &[Group], diagnostics: &mut Diagnostics) -> Indexed {
    let mut indexed = brackets(name, groups, diagnostics);
    for bracket in &indexed.brackets {
        if let Bracket::At(index) = bracket {
            let message = format!("a family of constraints names its range: `{name}[i in 0..N]`");
            diagnostics.report_range(index.first_span(), index.last_span(), message);
        }
    }
    indexed.brackets.retain(|bracket| matches!(bracket, Bracket::Each(_)));
    indexed
}

/// Splits an equation at its only `==` outside of groups. What stands for it by mistake splits, too, for the
/// mistakes on both sides.
fn equation_sides(
    name: &Ident,
    equation: &[TokenTree],
    diagnostics: &mut Diagnostics,
) -> (Option<Expression>, Option<Expression>) {
    let mut relations = relations(equation).into_iter();
    let Some(relation) = relations.next() else {
        let message = format!("a constraint is an equation: `constraint({name}: lhs == rhs)`");
        diagnostics.report(name.span(), message);
        // Whether it is an expression at all does not matter any more, but the mistakes in one do.
        let tokens = equation.iter().cloned().collect();
        return (Expression::parse(tokens, name.span(), &mut Diagnostics::default()), None);
    };
    match relation.operator.as_str() {
        "==" => {}
        "=" => diagnostics.report(relation.first, "`=` in a constraint, write `==`"),
        other => {
            let message =
                format!("`{other}` in a constraint: a holonomic constraint is an equation, write `==`");
            diagnostics.report_range(relation.first, relation.last, message);
        }
    }
    let second = relations.next();
    if let Some(second) = &second {
        let message = "a constraint is one equation: write a second constraint for the second `==`";
        diagnostics.report_range(second.first, second.last, message);
    }
    let end = second.map_or(equation.len(), |second| second.position);
    let (left, right) =
        (&equation[..relation.position], &equation[relation.position + relation.operator.len()..end]);
    let left = Expression::parse(left.iter().cloned().collect(), relation.first, diagnostics);
    let right = Expression::parse(right.iter().cloned().collect(), relation.last, diagnostics);
    (left, right)
}

/// `==`, or what a user may have written for it.
struct Relation {
    operator: String,
    /// Of its first token in the equation; it has as many tokens as characters.
    position: usize,
    first: Span,
    last: Span,
}

/// The relations outside of groups.
fn relations(equation: &[TokenTree]) -> Vec<Relation> {
    let mut relations = Vec::new();
    let mut position = 0;
    while position < equation.len() {
        let mut length = 1;
        if let TokenTree::Punct(first) = &equation[position] {
            let second = joined(first, &equation[position + 1..]);
            let operator: String = [Some(first), second].into_iter().flatten().map(Punct::as_char).collect();
            length = operator.len();
            if ["=", "==", "!=", "<", "<=", ">", ">=", "=>", "=<"].contains(&operator.as_str()) {
                let (first, last) = (first.span(), second.unwrap_or(first).span());
                relations.push(Relation { operator, position, first, last });
            }
        }
        position += length;
    }
    relations
}

/// The mark that a punctuation mark joins to an operator of comparison or assignment.
fn joined<'t>(punct: &Punct, rest: &'t [TokenTree]) -> Option<&'t Punct> {
    match rest.first() {
        Some(TokenTree::Punct(next))
            if punct.spacing() == Spacing::Joint && "=<>".contains(next.as_char()) =>
        {
            Some(next)
        }
        _ => None,
    }
}

fn is_punct(token: Option<&TokenTree>, character: char) -> bool {
    matches!(token, Some(TokenTree::Punct(punct)) if punct.as_char() == character)
}

fn let_item(keyword: &Ident, rest: &[TokenTree], diagnostics: &mut Diagnostics) -> Option<Let> {
    let [TokenTree::Ident(name), value @ ..] = rest else {
        diagnostics.report(keyword.span(), "write `let name = expression`");
        return None;
    };
    let name = identifier(name, diagnostics)?;
    let value = assigned(&name, &format!("let {name} = expression"), value, diagnostics);
    Some(Let { name, value })
}
