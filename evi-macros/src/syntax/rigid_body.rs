//! `rigid_body(NAME, mass = .., center = [..], inertia = [..])`: a body in directors, spelled out in the items that it stands for.
//!
//! The body `b` is the array of coordinates `b: [4, 3]`: the position `b[0]` of the origin of its frame, and the directors `b[1]`, `b[2]`, `b[3]`, the
//! axes of the frame. A point `X` of the body lies at `b[0] + X₁ b[1] + X₂ b[2] + X₃ b[3]`. With the mass `m`, the centre of mass `c` in the frame,
//! and the moments of inertia `J` about it, of which the directors are principal axes, its kinetic energy is
//!
//! ```text
//! T = ½ m |ḃ₀ + Σ cₖ ḃₖ|² + ½ Σ Eₖ |ḃₖ|²,   E₁ = ½ (J₂ + J₃ − J₁) and so on (Euler's tensor)
//! ```
//!
//! (P. Betsch, S. Leyendecker, Int. J. Numer. Meth. Eng. 67 (2006) 499), whose mass matrix is constant. Six constraints keep the directors
//! orthonormal. The bodies `b[i in 0..N]` are the array `b: [N, 4, 3]`, their energies a sum and their constraints families.

use proc_macro2::{Delimiter, Ident, Literal, TokenStream, TokenTree};
use quote::{format_ident, quote_spanned};

use super::expression::Expression;
use super::indexed::{Bracket, Indexed, Range, brackets, leading_brackets};
use super::item::{Constraint, Coordinates, Item, identifier, parenthesized, split_at_commas};
use super::shape::{Coordinate, size};
use crate::diagnostics::{Diagnostics, suggestion};
use crate::expr::Affine;

const FORM: &str = "rigid_body(name, mass = m, center = [a, b, c], inertia = [j1, j2, j3])";
const PROPERTIES: [&str; 3] = ["mass", "center", "inertia"];

/// A body in directors; the tokens of a property are missing where they did not parse.
pub(crate) struct RigidBody {
    keyword: Ident,
    name: Ident,
    /// Of several bodies their index, and how many they are.
    family: Option<(Range, Affine)>,
    properties: [Option<TokenStream>; 3],
}

/// Parses the body behind `keyword`.
pub(super) fn rigid_body(
    keyword: &Ident,
    rest: &[TokenTree],
    diagnostics: &mut Diagnostics,
) -> Option<RigidBody> {
    let group = parenthesized(keyword, FORM, rest, diagnostics)?;
    let entries = split_at_commas(group.stream());
    let Some(([TokenTree::Ident(name), behind @ ..], given)) = entries
        .split_first()
        .map(|(name, given)| (name.as_slice(), given))
        .filter(|(name, _)| !matches!(name, [_, TokenTree::Punct(_), ..]))
    else {
        let span = entries.first().map_or(keyword.span(), |entry| entry[0].span());
        diagnostics.report(span, format!("a body has a name: write `{FORM}`"));
        return None;
    };
    let name = identifier(name, diagnostics)?;
    let family = match behind {
        [] => None,
        behind => Some(family(&name, behind, diagnostics)?),
    };
    let mut properties = [const { None }; 3];
    let mut is_mistaken = false;
    for entry in given {
        match entry.as_slice() {
            [TokenTree::Ident(property), TokenTree::Punct(equals), value @ ..]
                if equals.as_char() == '=' && PROPERTIES.iter().any(|known| property == known) =>
            {
                let index = PROPERTIES.iter().position(|known| property == known).expect("one of them");
                if properties[index].is_some() {
                    diagnostics.report(property.span(), format!("`{property}` is given twice"));
                }
                let tokens: TokenStream = value.iter().cloned().collect();
                if let ([TokenTree::Group(group)], true) = (value, property != "mass")
                    && group.delimiter() == Delimiter::Bracket
                    && split_at_commas(group.stream()).len() != 3
                {
                    let message = format!("`{property}` has three elements, along the axes of the body");
                    diagnostics.report(group.span(), message);
                    is_mistaken = true;
                    continue;
                }
                let parsed = Expression::parse(tokens.clone(), equals.span(), diagnostics);
                is_mistaken |= parsed.is_none();
                properties[index] = parsed.map(|_| tokens);
            }
            other => {
                let text = other[0].to_string();
                let similar = suggestion(&text, PROPERTIES);
                let message =
                    format!("a body has `mass = ..`, `center = [..]` and `inertia = [..]`{similar}");
                diagnostics.report(other[0].span(), message);
                is_mistaken = true;
            }
        }
    }
    for (property, value) in PROPERTIES.iter().zip(&properties) {
        if value.is_none() && !is_mistaken {
            diagnostics.report(name.span(), format!("body `{name}` has no `{property}`: write `{FORM}`"));
        }
    }
    Some(RigidBody { keyword: keyword.clone(), name, family, properties })
}

/// The index of bodies that are counted, and how many they are.
fn family(name: &Ident, behind: &[TokenTree], diagnostics: &mut Diagnostics) -> Option<(Range, Affine)> {
    let groups = leading_brackets(behind);
    let indexed = brackets(name, &groups, diagnostics);
    let counted = match indexed.brackets.as_slice() {
        [Bracket::Each(range)] if groups.len() == behind.len() => {
            let ends = range.ends.as_ref()?;
            let size = match ends.root() {
                syn::Expr::Range(syn::ExprRange {
                    start: Some(start),
                    end: Some(end),
                    limits: syn::RangeLimits::HalfOpen(_),
                    ..
                }) if is_zero(start) => Some(size(end, diagnostics)?),
                _ => None,
            };
            size.map(|size| (range.clone(), size))
        }
        _ => None,
    };
    if counted.is_none() {
        let message = format!(
            "several bodies are counted from 0 by one index: write `rigid_body({name}[i in 0..N], ..)`"
        );
        diagnostics.report(behind[0].span(), message);
    }
    counted
}

fn is_zero(expression: &syn::Expr) -> bool {
    matches!(expression, syn::Expr::Lit(syn::ExprLit { lit: syn::Lit::Int(number), .. }) if number.base10_digits() == "0")
}

/// Adds what bodies stand for to the other items: their coordinates behind those of the user, their energies to the kinetic energy, their
/// constraints at their places.
pub(super) fn spell_out(items: Vec<ItemOrBody>, diagnostics: &mut Diagnostics) -> Vec<Item> {
    let mut spelled = Vec::new();
    let mut bodies = Vec::new();
    for item in items {
        match item {
            ItemOrBody::Item(item) => spelled.push(item),
            ItemOrBody::Body(body) => {
                spelled.extend(body.constraints(diagnostics));
                bodies.push(body);
            }
        }
    }
    let Some(first) = bodies.first() else { return spelled };
    let is_coordinates = |item: &Item| matches!(item, Item::Coordinates(_));
    if !spelled.iter().any(is_coordinates) {
        let keyword = first.keyword.clone();
        spelled.insert(0, Item::Coordinates(Coordinates { keyword, entries: Vec::new(), is_complete: true }));
    }
    let is_energy = |item: &Item| matches!(item, Item::Kinetic { .. } | Item::Lagrangian { .. });
    if !spelled.iter().any(is_energy) {
        let value = Expression::parse(first.zero(), first.keyword.span(), diagnostics);
        let keyword = Ident::new("kinetic", first.keyword.span());
        spelled.push(Item::Kinetic { keyword, value });
    }
    for body in &bodies {
        for item in &mut spelled {
            match item {
                Item::Coordinates(coordinates) => coordinates.entries.push(body.coordinate()),
                Item::Kinetic { value, .. } | Item::Lagrangian { value, .. } => {
                    body.add_energy_to(value, diagnostics);
                }
                _ => {}
            }
        }
    }
    spelled
}

/// What an attribute lists.
pub(super) enum ItemOrBody {
    Item(Item),
    Body(RigidBody),
}

impl RigidBody {
    fn coordinate(&self) -> Coordinate {
        let count = self.family.as_ref().map(|(_, count)| count.clone());
        let shape = count.into_iter().chain([Affine::number(4), Affine::number(3)]).collect();
        Coordinate { name: self.name.clone(), shape }
    }

    /// The body, of several the one with their index.
    fn body(&self) -> TokenStream {
        let name = &self.name;
        match &self.family {
            None => quote_spanned!(name.span()=> #name),
            Some((Range { index, .. }, _)) => quote_spanned!(name.span()=> #name[#index]),
        }
    }

    fn zero(&self) -> TokenStream {
        quote_spanned!(self.keyword.span()=> 0.0)
    }

    /// Adds the kinetic energy to an energy, unless one of them is mistaken.
    fn add_energy_to(&self, energy: &mut Option<Expression>, diagnostics: &mut Diagnostics) {
        let (Some(written), [Some(mass), Some(_), Some(_)]) = (&*energy, &self.properties) else { return };
        let (span, body) = (self.keyword.span(), self.body());
        let center = (1..4_usize).filter_map(|k| {
            let (element, k) = (self.element(1, k - 1)?, Literal::usize_unsuffixed(k));
            Some(quote_spanned!(span=> + #element * der(#body[#k])))
        });
        let tensor = (1..4_usize).map(|k| {
            let [own, second, third] = [k, k % 3 + 1, (k + 1) % 3 + 1]
                .map(|axis| self.element(2, axis - 1).unwrap_or_else(|| self.zero()));
            let k = Literal::usize_unsuffixed(k);
            quote_spanned!(span=> + 0.25 * (#second + #third - #own) * der(#body[#k]).norm_squared())
        });
        let own =
            quote_spanned!(span=> 0.5 * (#mass) * (der(#body[0]) #(#center)*).norm_squared() #(#tensor)*);
        let own = match &self.family {
            Some((Range { index, ends: Some(ends) }, _)) => {
                let ends = &ends.tokens;
                quote_spanned!(span=> sum(#ends, |#index| #own))
            }
            _ => own,
        };
        let tokens = if written.is_number(0.0) {
            own
        } else {
            let written = &written.tokens;
            quote_spanned!(span=> (#written) + #own)
        };
        *energy = Expression::parse(tokens, span, diagnostics);
    }

    /// An element of a property that is a vector; nothing for one that is written as zero.
    fn element(&self, property: usize, index: usize) -> Option<TokenStream> {
        let tokens = self.properties[property].clone()?;
        let span = self.keyword.span();
        let trees: Vec<TokenTree> = tokens.clone().into_iter().collect();
        if let [TokenTree::Group(group)] = trees.as_slice()
            && group.delimiter() == Delimiter::Bracket
        {
            let elements = split_at_commas(group.stream());
            if elements.len() == 3 {
                let element: TokenStream = elements[index].iter().cloned().collect();
                let is_zero = matches!(element.to_string().as_str(), "0" | "0.0" | "0.");
                return (!is_zero).then(|| quote_spanned!(span=> (#element)));
            }
        }
        let index = Literal::usize_unsuffixed(index);
        // At what the user wrote: that may be no vector.
        let span = trees.first().map_or(span, TokenTree::span);
        Some(quote_spanned!(span=> (#tokens)[#index]))
    }

    /// The directors have length one and are orthogonal.
    fn constraints(&self, diagnostics: &mut Diagnostics) -> Vec<Item> {
        let span = self.keyword.span();
        let mut constraint = |label: String, left: TokenStream, right: TokenStream| {
            let name = format_ident!("{}_{label}", self.name, span = self.name.span());
            let (left, right) =
                (Expression::parse(left, span, diagnostics), Expression::parse(right, span, diagnostics));
            let brackets = self.family.iter().map(|(range, _)| Bracket::Each(range.clone())).collect();
            Item::Constraint(Constraint { name: Some(Indexed { name, brackets }), left, right })
        };
        let body = self.body();
        let mut constraints = Vec::new();
        for k in 1..4_usize {
            let place = Literal::usize_unsuffixed(k);
            let length = quote_spanned!(span=> #body[#place].norm_squared());
            constraints.push(constraint(format!("unit{k}"), length, quote_spanned!(span=> 1.0)));
        }
        for (j, k) in [(1_usize, 2_usize), (1, 3), (2, 3)] {
            let (first, second) = (Literal::usize_unsuffixed(j), Literal::usize_unsuffixed(k));
            let product = quote_spanned!(span=> #body[#first].dot(#body[#second]));
            constraints.push(constraint(format!("right{j}{k}"), product, self.zero()));
        }
        constraints
    }
}
