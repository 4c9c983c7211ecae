//! What names mean, and equations as nodes.

use std::collections::HashMap;

use proc_macro2::{Ident, Span, TokenStream};

use super::{SourceLet, coordinate_names};
use crate::diagnostics::{Diagnostics, suggestion};
use crate::expr::{ExprId, Graph, Symbol};
use crate::syntax::{Constraint, Declaration, Expression, Field, Item, Let, Resolved, Resolver, lower};

/// The names in reach of an equation.
pub(super) struct Scope<'a> {
    fields: &'a [Field],
    coordinates: Vec<String>,
    /// Shared subexpressions so far; `None` where the definition is mistaken.
    lets: HashMap<String, Option<ExprId>>,
    /// Names of all shared subexpressions, those further below included.
    all_lets: Vec<String>,
    /// Names in the open blocks, innermost last.
    locals: Vec<Vec<(String, Option<ExprId>)>>,
    named_constants: Vec<(String, TokenStream)>,
    /// What is being resolved, for messages.
    context: String,
    in_constraint: bool,
}

impl<'a> Scope<'a> {
    pub(super) fn new(declaration: &'a Declaration) -> Self {
        let all_lets = declaration.items.iter().filter_map(|item| match item {
            Item::Let(definition) => Some(definition.name.to_string()),
            _ => None,
        });
        Self {
            fields: &declaration.fields,
            coordinates: coordinate_names(declaration).iter().map(Ident::to_string).collect(),
            lets: HashMap::new(),
            all_lets: all_lets.collect(),
            locals: Vec::new(),
            named_constants: Vec::new(),
            context: String::new(),
            in_constraint: false,
        }
    }

    /// The node of an expression of the Lagrangian, with its source.
    pub(super) fn equation(
        &mut self,
        context: &str,
        value: &Expression,
        graph: &mut Graph,
        diagnostics: &mut Diagnostics,
    ) -> Option<(ExprId, Expression)> {
        self.context = context.to_owned();
        self.in_constraint = false;
        Some((lower(value, graph, self, diagnostics)?, value.clone()))
    }

    /// Adds a shared subexpression to the scope.
    pub(super) fn shared(
        &mut self,
        definition: &Let,
        graph: &mut Graph,
        diagnostics: &mut Diagnostics,
    ) -> Option<SourceLet> {
        let name = definition.name.to_string();
        let value = definition.value.as_ref();
        let resolved =
            value.and_then(|value| self.equation(&format!("`let {name}`"), value, graph, diagnostics));
        self.lets.insert(name, resolved.as_ref().map(|(value, _)| *value));
        let (value, source) = resolved?;
        let has_velocity = graph.dependence(value).on_v;
        Some(SourceLet { name: definition.name.clone(), value: source, has_velocity })
    }

    /// The residual `LHS − RHS` of a constraint, with its sides.
    pub(super) fn constraint(
        &mut self,
        constraint: &Constraint,
        graph: &mut Graph,
        diagnostics: &mut Diagnostics,
    ) -> Option<(Ident, ExprId, (Expression, Expression))> {
        let (left, right) = constraint.sides.as_ref()?;
        self.context = format!("constraint `{}`", constraint.name);
        self.in_constraint = true;
        let (left_value, right_value) =
            (lower(left, graph, self, diagnostics), lower(right, graph, self, diagnostics));
        let residual = graph.sub(left_value?, right_value?);
        Some((constraint.name.clone(), residual, (left.clone(), right.clone())))
    }

    pub(super) fn into_named_constants(self) -> Vec<TokenStream> {
        self.named_constants.into_iter().map(|(_, path)| path).collect()
    }

    fn field_names(&self) -> impl Iterator<Item = String> {
        self.fields.iter().map(|field| field.name.to_string())
    }
}

impl Resolver for Scope<'_> {
    fn name(&mut self, graph: &mut Graph, name: &Ident, diagnostics: &mut Diagnostics) -> Resolved {
        let text = name.to_string();
        let local =
            self.locals.iter().rev().flat_map(|block| block.iter().rev()).find(|(local, _)| *local == text);
        let shared = || self.lets.get(&text).map(|value| (text.clone(), *value));
        if let Some((_, value)) = local.cloned().or_else(shared) {
            return match value {
                Some(value) if self.in_constraint && graph.dependence(value).on_v => {
                    let message = format!("`{text}` contains der(..), which a holonomic constraint cannot");
                    diagnostics.report(name.span(), message);
                    Resolved::Mistaken
                }
                Some(value) => Resolved::Value(value),
                None => Resolved::Mistaken,
            };
        }
        if let Some(index) = self.coordinates.iter().position(|coordinate| *coordinate == text) {
            return Resolved::Value(graph.symbol(Symbol::Coordinate(index)));
        }
        if text == "t" {
            return Resolved::Value(graph.symbol(Symbol::Time));
        }
        if let Some(index) = self.field_names().position(|field| field == text) {
            return match &self.fields[index].other_type {
                None => Resolved::Value(graph.symbol(Symbol::Parameter(index))),
                Some(other) => {
                    let message =
                        format!("`{text}` has the type `{other}`; a parameter of an equation is an f64");
                    diagnostics.report(name.span(), message);
                    Resolved::Mistaken
                }
            };
        }
        if self.all_lets.contains(&text) {
            let message = format!("`{text}` is defined further below: move its `let` above this use");
            diagnostics.report(name.span(), message);
            return Resolved::Mistaken;
        }
        Resolved::Unknown
    }

    fn velocity(
        &mut self,
        graph: &mut Graph,
        der: Span,
        name: &Ident,
        diagnostics: &mut Diagnostics,
    ) -> Option<ExprId> {
        if self.in_constraint {
            let message = format!(
                "der() in a holonomic constraint: {} may relate positions and `t` only",
                self.context
            );
            diagnostics.report(der, message);
            return None;
        }
        let text = name.to_string();
        if let Some(index) = self.coordinates.iter().position(|coordinate| *coordinate == text) {
            return Some(graph.symbol(Symbol::Velocity(index)));
        }
        let similar = suggestion(&text, self.coordinates.iter().map(String::as_str));
        let message = format!(
            "`der` takes a coordinate, `{text}` is none{similar}\ncoordinates: {}",
            self.coordinates.join(", ")
        );
        diagnostics.report(name.span(), message);
        None
    }

    fn constant(&mut self, graph: &mut Graph, path: TokenStream) -> ExprId {
        let text = path.to_string();
        let known = self.named_constants.iter().position(|(name, _)| *name == text);
        let index = known.unwrap_or_else(|| {
            self.named_constants.push((text, path));
            self.named_constants.len() - 1
        });
        graph.symbol(Symbol::NamedConstant(index))
    }

    fn define(&mut self, name: &Ident, value: Option<ExprId>) {
        self.locals.last_mut().expect("a `let` stands in a block").push((name.to_string(), value));
    }

    fn enter_block(&mut self) {
        self.locals.push(Vec::new());
    }

    fn leave_block(&mut self) {
        self.locals.pop();
    }

    fn report_unknown(&self, name: &Ident, diagnostics: &mut Diagnostics) {
        let fields: Vec<String> = self.field_names().collect();
        let lets: Vec<&str> =
            self.all_lets.iter().map(String::as_str).filter(|name| self.lets.contains_key(*name)).collect();
        let known = self.coordinates.iter().chain(&fields).map(String::as_str).chain(lets.iter().copied());
        let similar = suggestion(&name.to_string(), known);
        let mut message = format!("unknown name `{name}` in {}{similar}", self.context);
        message.push_str(&format!("\ncoordinates: {}", self.coordinates.join(", ")));
        for (kind, names) in [("parameters", fields.join(", ")), ("shared", lets.join(", "))] {
            if !names.is_empty() {
                message.push_str(&format!("; {kind}: {names}"));
            }
        }
        diagnostics.report(name.span(), message);
    }
}
