//! The items of `#[evi(...)]` and the fields of the struct that carries them.

use proc_macro2::{Delimiter, Group, Ident, Span, TokenStream, TokenTree};
use quote::ToTokens;

use super::expression::Expression;
use crate::diagnostics::{Diagnostics, suggestion};

/// A struct with its attribute.
pub(crate) struct Declaration {
    pub(crate) name: Ident,
    pub(crate) generics: Generics,
    pub(crate) fields: Vec<Field>,
    pub(crate) items: Vec<Item>,
}

/// The three places where generics are written in an impl; all empty for a struct that is well-formed here.
pub(crate) struct Generics {
    pub(crate) impl_generics: TokenStream,
    pub(crate) type_generics: TokenStream,
    pub(crate) where_clause: TokenStream,
}

/// A named field.
pub(crate) struct Field {
    pub(crate) name: Ident,
    /// The type as written, if it is not `f64`.
    pub(crate) other_type: Option<String>,
}

/// One item of the attribute.
pub(crate) enum Item {
    Coordinates { keyword: Ident, names: Vec<Ident> },
    Lagrangian { keyword: Ident, value: Expression },
    Kinetic { keyword: Ident, value: Expression },
    Potential { keyword: Ident, value: Expression },
    Constraint(Constraint),
    Let(Let),
}

/// `constraint(NAME: LHS == RHS)`; the sides are missing where they did not parse.
pub(crate) struct Constraint {
    pub(crate) name: Ident,
    pub(crate) sides: Option<(Expression, Expression)>,
}

/// `let NAME = EXPR`; the value is missing where it did not parse.
pub(crate) struct Let {
    pub(crate) name: Ident,
    pub(crate) value: Option<Expression>,
}

/// The derive stands on something that Rust itself will complain about.
pub(crate) struct NotAnItem;

/// The items, as the user writes them.
const ITEMS: [&str; 6] = ["coordinates", "lagrangian", "kinetic", "potential", "constraint", "let"];

/// Parses a struct and its `#[evi(...)]` attributes.
pub(crate) fn parse(input: TokenStream, diagnostics: &mut Diagnostics) -> Result<Declaration, NotAnItem> {
    let input: syn::DeriveInput = syn::parse2(input).map_err(|error| {
        diagnostics.report(error.span(), error.to_string());
        NotAnItem
    })?;
    let fields = fields(&input, diagnostics);
    if let Some(parameter) = input.generics.params.first() {
        let span = first_span(parameter.to_token_stream(), input.ident.span());
        diagnostics.report(
            span,
            "a mechanical system has no generic parameters: its parameters are f64 fields, and the generated \
             code is generic over the scalar by itself",
        );
    }
    let (impl_generics, type_generics, where_clause) = input.generics.split_for_impl();
    let generics = Generics {
        impl_generics: impl_generics.to_token_stream(),
        type_generics: type_generics.to_token_stream(),
        where_clause: where_clause.to_token_stream(),
    };
    let mut items = Vec::new();
    let mut has_attribute = false;
    for attribute in input.attrs.iter().filter(|attribute| attribute.path().is_ident("evi")) {
        has_attribute = true;
        match attribute.meta.require_list() {
            Ok(list) => {
                let tokens = list.tokens.clone();
                items.extend(
                    split_at_commas(tokens).into_iter().filter_map(|item| parse_item(item, diagnostics)),
                );
            }
            Err(error) => {
                diagnostics.report(error.span(), "the attribute lists items: #[evi(coordinates(..), ..)]")
            }
        }
    }
    if !has_attribute {
        diagnostics.report(
            input.ident.span(),
            "the equations of motion are missing: write \
             #[evi(coordinates(..), kinetic = .., potential = ..)] above the struct",
        );
    }
    Ok(Declaration { name: input.ident, generics, fields, items })
}

fn fields(input: &syn::DeriveInput, diagnostics: &mut Diagnostics) -> Vec<Field> {
    let shape = match &input.data {
        syn::Data::Struct(syn::DataStruct { fields: syn::Fields::Named(named), .. }) => {
            return named.named.iter().map(field).collect();
        }
        // Without parameters there is nothing to name.
        syn::Data::Struct(syn::DataStruct { fields: syn::Fields::Unit, .. }) => return Vec::new(),
        syn::Data::Struct(_) => "a tuple struct",
        syn::Data::Enum(_) => "an enum",
        syn::Data::Union(_) => "a union",
    };
    diagnostics.report(
        input.ident.span(),
        format!("{shape} cannot be a mechanical system: derive it on a struct with named f64 fields"),
    );
    Vec::new()
}

fn field(field: &syn::Field) -> Field {
    let name = field.ident.clone().expect("the fields of a struct with named fields have names");
    let is_f64 = matches!(&field.ty, syn::Type::Path(path) if path.path.is_ident("f64"));
    Field { name, other_type: (!is_f64).then(|| field.ty.to_token_stream().to_string()) }
}

/// Splits at the commas outside of groups; a trailing comma adds nothing.
fn split_at_commas(tokens: TokenStream) -> Vec<Vec<TokenTree>> {
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

fn parse_item(tokens: Vec<TokenTree>, diagnostics: &mut Diagnostics) -> Option<Item> {
    let Some(TokenTree::Ident(keyword)) = tokens.first().cloned() else {
        diagnostics.report(tokens[0].span(), format!("an item begins with one of {}", ITEMS.join(", ")));
        return None;
    };
    let rest = &tokens[1..];
    match keyword.to_string().as_str() {
        "coordinates" => {
            let names =
                coordinate_names(parenthesized(&keyword, rest, "(x, y, ..)", diagnostics)?, diagnostics);
            Some(Item::Coordinates { keyword, names })
        }
        "lagrangian" => {
            assigned(&keyword, rest, diagnostics).map(|value| Item::Lagrangian { keyword, value })
        }
        "kinetic" => assigned(&keyword, rest, diagnostics).map(|value| Item::Kinetic { keyword, value }),
        "potential" => assigned(&keyword, rest, diagnostics).map(|value| Item::Potential { keyword, value }),
        "constraint" => {
            let group = parenthesized(&keyword, rest, "(name: lhs == rhs)", diagnostics)?;
            constraint(&keyword, group, diagnostics)
        }
        "let" => let_item(&keyword, rest, diagnostics),
        unknown => {
            let similar = suggestion(unknown, ITEMS);
            let message = format!("unknown item `{unknown}`{similar}\nitems: {}", ITEMS.join(", "));
            diagnostics.report(keyword.span(), message);
            None
        }
    }
}

/// The contents of the parentheses that follow a keyword.
fn parenthesized(
    keyword: &Ident,
    rest: &[TokenTree],
    form: &str,
    diagnostics: &mut Diagnostics,
) -> Option<Group> {
    match rest {
        [TokenTree::Group(group)] if group.delimiter() == Delimiter::Parenthesis => Some(group.clone()),
        [TokenTree::Group(group), extra, ..] if group.delimiter() == Delimiter::Parenthesis => {
            diagnostics.report(extra.span(), "expected a comma before the next item");
            None
        }
        _ => {
            let span = rest.first().map_or(keyword.span(), TokenTree::span);
            diagnostics.report(span, format!("write `{keyword}{form}`"));
            None
        }
    }
}

/// The expression behind `keyword =`.
fn assigned(keyword: &Ident, rest: &[TokenTree], diagnostics: &mut Diagnostics) -> Option<Expression> {
    match rest {
        [TokenTree::Punct(equals), value @ ..] if equals.as_char() == '=' && !is_operator(equals, value) => {
            Expression::parse(value.iter().cloned().collect(), equals.span(), diagnostics)
        }
        _ => {
            let span = rest.first().map_or(keyword.span(), TokenTree::span);
            diagnostics.report(span, format!("write `{keyword} = expression`"));
            None
        }
    }
}

/// Whether a punctuation mark joins the next one to a longer operator.
fn is_operator(punct: &proc_macro2::Punct, rest: &[TokenTree]) -> bool {
    punct.spacing() == proc_macro2::Spacing::Joint
        && matches!(rest.first(), Some(TokenTree::Punct(next)) if "=<>".contains(next.as_char()))
}

fn coordinate_names(group: Group, diagnostics: &mut Diagnostics) -> Vec<Ident> {
    let mut names = Vec::new();
    for tokens in split_at_commas(group.stream()) {
        match tokens.as_slice() {
            [TokenTree::Ident(name)] => names.push(name.clone()),
            [TokenTree::Ident(name), colon, ..] if is_punct(colon, ':') => diagnostics.report(
                name.span(),
                format!(
                    "`{name}` is declared as a vector; coordinates are scalars: write `{name}1, {name}2, ..`"
                ),
            ),
            [TokenTree::Ident(_), extra, ..] => {
                diagnostics.report(extra.span(), "expected a comma before the next coordinate");
            }
            _ => diagnostics.report(tokens[0].span(), "a coordinate is a name"),
        }
    }
    names
}

fn constraint(keyword: &Ident, group: Group, diagnostics: &mut Diagnostics) -> Option<Item> {
    let tokens: Vec<TokenTree> = group.stream().into_iter().collect();
    let (name, equation) = match tokens.as_slice() {
        [TokenTree::Ident(name), colon, equation @ ..]
            if is_punct(colon, ':') && !equation.first().is_some_and(|next| is_punct(next, ':')) =>
        {
            (name.clone(), equation)
        }
        [TokenTree::Ident(name), TokenTree::Group(indices), ..]
            if indices.delimiter() == Delimiter::Bracket =>
        {
            diagnostics.report(
                indices.span(),
                format!("`{name}` is a family of constraints, but coordinates are scalars: write one constraint each"),
            );
            return Some(Item::Constraint(Constraint { name: name.clone(), sides: None }));
        }
        _ => {
            let span = tokens.first().map_or(keyword.span(), TokenTree::span);
            diagnostics.report(span, "a constraint has a name: `constraint(name: lhs == rhs)`");
            return None;
        }
    };
    let sides = equation_sides(&name, equation, diagnostics);
    Some(Item::Constraint(Constraint { name, sides }))
}

/// Splits an equation at its only `==` outside of groups.
fn equation_sides(
    name: &Ident,
    equation: &[TokenTree],
    diagnostics: &mut Diagnostics,
) -> Option<(Expression, Expression)> {
    let mut separator = None;
    let mut k = 0;
    while k < equation.len() {
        if let TokenTree::Punct(punct) = &equation[k] {
            let joint = is_operator(punct, &equation[k + 1..]);
            match punct.as_char() {
                '=' if joint && separator.is_none() => separator = Some(k),
                '=' if joint => {
                    diagnostics
                        .report(punct.span(), "a constraint is one equation: a second `==` needs its own");
                    return None;
                }
                '=' => {
                    diagnostics.report(punct.span(), "`=` in a constraint, write `==`");
                    return None;
                }
                '<' | '>' | '!' if joint || punct.as_char() != '!' => {
                    diagnostics.report(punct.span(), "a holonomic constraint is an equation, write `==`");
                    return None;
                }
                _ => {}
            }
            k += usize::from(joint);
        }
        k += 1;
    }
    let Some(separator) = separator else {
        diagnostics
            .report(name.span(), format!("a constraint is an equation: `constraint({name}: lhs == rhs)`"));
        return None;
    };
    let (left, right) = (&equation[..separator], &equation[separator + 2..]);
    let span = equation[separator].span();
    // Both sides are parsed before either is given up, so that the mistakes of both are reported.
    let left = Expression::parse(left.iter().cloned().collect(), span, diagnostics);
    let right = Expression::parse(right.iter().cloned().collect(), span, diagnostics);
    left.zip(right)
}

fn let_item(keyword: &Ident, rest: &[TokenTree], diagnostics: &mut Diagnostics) -> Option<Item> {
    match rest {
        [TokenTree::Ident(name), value @ ..] => {
            Some(Item::Let(Let { name: name.clone(), value: assigned(name, value, diagnostics) }))
        }
        _ => {
            diagnostics.report(keyword.span(), "write `let name = expression`");
            None
        }
    }
}

fn is_punct(token: &TokenTree, character: char) -> bool {
    matches!(token, TokenTree::Punct(punct) if punct.as_char() == character)
}

fn first_span(tokens: TokenStream, otherwise: Span) -> Span {
    tokens.into_iter().next().map_or(otherwise, |token| token.span())
}
