//! Expressions as they are parsed, what they are asked for, and whom they ask about names. How they become nodes of the graph is `lowering`.

use std::rc::Rc;

use proc_macro2::{Delimiter, Group, Ident, Span, TokenStream, TokenTree};
use syn::parse::{ParseStream, Parser};

use super::spine::{Tree, first_span, last_span};
use crate::diagnostics::Diagnostics;
use crate::expr::{Affine, ExprId, Graph, Value, View};

/// An expression as the user wrote it.
#[derive(Clone)]
pub(crate) struct Expression {
    syntax: Rc<Tree>,
    /// Its tokens, for the copy that rustc evaluates.
    pub(crate) tokens: TokenStream,
}

/// How sums and families become equations.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Expansion {
    /// Term by term: sizes are literals, and small.
    Unrolled,
    /// As loops over one element.
    Looped,
    /// As they are written, to be printed.
    Written,
}

/// What names mean; knows the scope that an expression stands in.
pub(crate) trait Resolver {
    fn expansion(&self) -> Expansion;
    /// The value of a name, or `None` for a name that is unknown.
    fn name(&mut self, graph: &mut Graph, name: &Ident, diagnostics: &mut Diagnostics) -> Resolved;
    /// The value of `der(name)`; reports what is wrong with it.
    fn velocity(
        &mut self,
        graph: &mut Graph,
        der: Span,
        name: &Ident,
        diagnostics: &mut Diagnostics,
    ) -> Option<Value>;
    /// The node of an element of an array.
    fn element(&mut self, graph: &mut Graph, view: &View) -> ExprId;
    /// The node of an index that stands where a number does.
    fn index_as_number(&mut self, graph: &mut Graph, index: &Affine) -> ExprId;
    /// Leaves to rustc whether an index that is not known here is below `size`.
    fn check_bounds(&mut self, index: &Affine, size: &Affine, array: &str, first: Span, last: Span);
    /// Opens an index that goes through a range; returns its level and what it is worth.
    fn enter_index(&mut self, name: &Ident, from: &Affine, to: &Affine) -> (usize, Affine);
    /// Closes the innermost index.
    fn leave_index(&mut self);
    /// Says where a sum that stays a loop is written.
    fn place_of_sum(&mut self, sum: ExprId, place: Span);
    /// The node of a constant that rustc resolves.
    fn constant(&mut self, graph: &mut Graph, path: TokenStream) -> ExprId;
    /// Gives a name to the value of a `let` in a block, until the block ends.
    fn define(&mut self, name: &Ident, value: Option<Value>, diagnostics: &mut Diagnostics);
    /// Opens a block.
    fn enter_block(&mut self);
    /// Closes the innermost block.
    fn leave_block(&mut self);
    /// Reports a name without meaning.
    fn report_unknown(&self, name: &Ident, diagnostics: &mut Diagnostics);
}

/// What a name stands for.
pub(crate) enum Resolved {
    Value(Value),
    /// Known, but its definition or its use here is wrong and has been reported.
    Mistaken,
    Unknown,
}

impl Expression {
    pub(super) fn root(&self) -> &syn::Expr {
        self.syntax.root()
    }

    /// Whether it is this number as a literal.
    pub(super) fn is_number(&self, number: f64) -> bool {
        matches!(self.root(), syn::Expr::Lit(syn::ExprLit { lit: syn::Lit::Float(literal), .. })
            if literal.base10_parse::<f64>().is_ok_and(|value| value == number))
    }

    /// Whether it has neither vectors nor indices.
    pub(crate) fn is_of_numbers(&self) -> bool {
        !has_vectors(&self.tokens)
    }

    /// The span of the first token.
    pub(crate) fn first_span(&self) -> Span {
        first_span(self.syntax.root())
    }

    /// The span of the last token.
    pub(crate) fn last_span(&self) -> Span {
        last_span(self.syntax.root())
    }

    /// Parses the tokens behind the token at `before`.
    pub(crate) fn parse(tokens: TokenStream, before: Span, diagnostics: &mut Diagnostics) -> Option<Self> {
        let Some(last) = tokens.clone().into_iter().last() else {
            diagnostics.report(before, "expected an expression");
            return None;
        };
        // In parentheses that lie on the last token, an expression that breaks off is reported there.
        let mut group = Group::new(Delimiter::Parenthesis, tokens.clone());
        group.set_span(last.span());
        let whole = |input: ParseStream| {
            let inside;
            syn::parenthesized!(inside in input);
            let expression = inside.parse()?;
            if inside.is_empty() {
                Ok(expression)
            } else {
                Err(inside.error("expected an operator before this"))
            }
        };
        match whole.parse2(TokenTree::Group(group).into()) {
            Ok(syntax) => Some(Self { syntax: Rc::new(Tree::new(syntax)), tokens }),
            Err(error) => {
                diagnostics.report(error.span(), error.to_string());
                None
            }
        }
    }
}

/// Builds the value of an expression, its elements known; `None` where mistakes were reported.
pub(crate) fn lower(
    expression: &Expression,
    graph: &mut Graph,
    resolver: &mut impl Resolver,
    diagnostics: &mut Diagnostics,
) -> Option<Value> {
    let mut lowering = Lowering { graph, resolver, diagnostics };
    let root = expression.syntax.root();
    let value = lowering.value(root)?;
    match lowering.known(value) {
        Ok(value) => Some(value),
        Err(message) => lowering.mistake_between(first_span(root), last_span(root), message),
    }
}

/// The ends of the range that an expression is; `None` where mistakes were reported.
pub(crate) fn lower_range(
    expression: &Expression,
    graph: &mut Graph,
    resolver: &mut impl Resolver,
    diagnostics: &mut Diagnostics,
) -> Option<(Affine, Affine)> {
    Lowering { graph, resolver, diagnostics }.range(expression.syntax.root())
}

/// The index that an expression is; `None` where mistakes were reported.
pub(crate) fn lower_index(
    expression: &Expression,
    graph: &mut Graph,
    resolver: &mut impl Resolver,
    diagnostics: &mut Diagnostics,
) -> Option<Affine> {
    Lowering { graph, resolver, diagnostics }.index(expression.syntax.root())
}

pub(super) struct Lowering<'a, R> {
    pub(super) graph: &'a mut Graph,
    pub(super) resolver: &'a mut R,
    pub(super) diagnostics: &'a mut Diagnostics,
}

/// Whether there are brackets or sums.
fn has_vectors(tokens: &TokenStream) -> bool {
    tokens.clone().into_iter().any(|token| match token {
        TokenTree::Group(group) => group.delimiter() == Delimiter::Bracket || has_vectors(&group.stream()),
        TokenTree::Ident(name) => name == "sum",
        TokenTree::Punct(_) | TokenTree::Literal(_) => false,
    })
}
