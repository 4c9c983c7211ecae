//! What names mean, and equations as nodes.

use std::collections::HashMap;

use proc_macro2::{Ident, Span, TokenStream};

use super::variables::Variables;
use super::{SourceLet, check, coordinate_names, coordinates, input_names};
use crate::diagnostics::{Diagnostics, suggestion};
use crate::expr::{ExprId, Graph, Symbol};
use crate::syntax::{Constraint, Declaration, Expression, Field, Item, Let, Resolved, Resolver, lower};

/// The names in reach of an equation.
pub(super) struct Scope<'a> {
    fields: &'a [Field],
    /// Fields of another type than f64 that have been reported.
    reported_fields: Vec<usize>,
    coordinates: Vec<String>,
    inputs: Vec<String>,
    /// Whether all coordinates are known; otherwise a mistake has been reported there, and any name may be
    /// one.
    has_all_coordinates: bool,
    /// Shared subexpressions so far; `None` where the definition is mistaken.
    lets: HashMap<String, Option<ExprId>>,
    /// Names of all shared subexpressions, those further below included.
    all_lets: Vec<String>,
    /// Names in the open blocks, innermost last.
    locals: Vec<Vec<(String, Option<ExprId>)>>,
    named_constants: Vec<(String, TokenStream)>,
    /// What is being resolved, for messages.
    context: String,
    variables: Variables,
}

impl<'a> Scope<'a> {
    pub(super) fn new(declaration: &'a Declaration) -> Self {
        let all_lets = declaration.items.iter().filter_map(|item| match item {
            Item::Let(definition) => Some(definition.name.to_string()),
            _ => None,
        });
        let names = coordinate_names(declaration);
        let inputs: Vec<String> = input_names(declaration).map(Ident::to_string).collect();
        let is_complete = coordinates(declaration).is_some_and(|coordinates| coordinates.is_complete);
        Self {
            fields: &declaration.fields,
            reported_fields: Vec::new(),
            coordinates: names.iter().map(Ident::to_string).collect(),
            inputs,
            has_all_coordinates: is_complete && !names.is_empty(),
            lets: HashMap::new(),
            all_lets: all_lets.collect(),
            locals: Vec::new(),
            named_constants: Vec::new(),
            context: String::new(),
            variables: Variables::All,
        }
    }

    /// The node of an expression in the given variables, with its source.
    pub(super) fn equation(
        &mut self,
        context: &str,
        variables: Variables,
        value: Option<&Expression>,
        graph: &mut Graph,
        diagnostics: &mut Diagnostics,
    ) -> Option<(ExprId, Expression)> {
        let value = value?;
        self.context = context.to_owned();
        self.variables = variables;
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
        let resolved = self.equation(&let_context(&name), Variables::All, value, graph, diagnostics);
        self.lets.insert(name, resolved.as_ref().map(|(value, _)| *value));
        let (value, source) = resolved?;
        let on = graph.dependence(value);
        Some(SourceLet { name: definition.name.clone(), value: source, root: value, on })
    }

    /// The residual `LHS − RHS` of a constraint, with its sides.
    pub(super) fn constraint(
        &mut self,
        constraint: &Constraint,
        graph: &mut Graph,
        diagnostics: &mut Diagnostics,
    ) -> Option<(Ident, ExprId, (Expression, Expression))> {
        let name = constraint.name.as_ref()?;
        self.context = format!("constraint `{name}`");
        self.variables = Variables::OfPlace;
        // Both sides before either is given up, so that the mistakes of both are reported.
        let mut side = |side: &Option<Expression>| {
            let expression = side.as_ref()?;
            Some((lower(expression, graph, self, diagnostics)?, expression.clone()))
        };
        let (left, right) = (side(&constraint.left), side(&constraint.right));
        let ((left_value, left), (right_value, right)) = (left?, right?);
        let residual = graph.sub(left_value, right_value);
        Some((name.clone(), residual, (left, right)))
    }

    /// The index of the coordinate that an item stands for.
    pub(super) fn coordinate(
        &self,
        name: &Ident,
        item: &str,
        diagnostics: &mut Diagnostics,
    ) -> Option<usize> {
        let text = name.to_string();
        let index = self.coordinates.iter().position(|coordinate| *coordinate == text);
        if index.is_some() || !self.has_all_coordinates {
            return index;
        }
        let message = match self.other_kind(&text) {
            Some(kind) => format!("{item} belongs to a coordinate, `{text}` is {kind}"),
            None => {
                let similar = suggestion(&text, self.coordinates.iter().map(String::as_str));
                format!("unknown coordinate `{text}`{similar}")
            }
        };
        diagnostics.report(name.span(), format!("{message}\ncoordinates: {}", self.coordinates.join(", ")));
        None
    }

    /// What a name is that is no coordinate.
    fn other_kind(&self, text: &str) -> Option<&'static str> {
        let is_local = self.locals.iter().flatten().any(|(local, _)| local == text);
        if is_local || self.all_lets.iter().any(|name| name == text) {
            Some("a shared expression")
        } else if self.fields.iter().any(|field| field.name == text) {
            Some("a parameter")
        } else if self.inputs.iter().any(|input| input == text) {
            Some("an input")
        } else {
            (text == "t").then_some("the time")
        }
    }

    /// The node of a coordinate, the time or an input, where it may stand.
    fn variable(
        &self,
        graph: &mut Graph,
        name: &Ident,
        (what, symbol): (&str, Symbol),
        diagnostics: &mut Diagnostics,
    ) -> Resolved {
        let node = graph.symbol(symbol);
        match self.variables.refuse_symbol(&name.to_string(), what, graph.dependence(node)) {
            Some(message) => {
                diagnostics.report(name.span(), message);
                Resolved::Mistaken
            }
            None => Resolved::Value(node),
        }
    }

    pub(super) fn into_named_constants(self) -> Vec<TokenStream> {
        self.named_constants.into_iter().map(|(_, path)| path).collect()
    }
}

impl Resolver for Scope<'_> {
    fn name(&mut self, graph: &mut Graph, name: &Ident, diagnostics: &mut Diagnostics) -> Resolved {
        let text = name.to_string();
        let local =
            self.locals.iter().rev().flat_map(|block| block.iter().rev()).find(|(local, _)| *local == text);
        let shared = || self.lets.get(&text).map(|value| (text.clone(), *value));
        if let Some((_, value)) = local.cloned().or_else(shared) {
            let Some(value) = value else { return Resolved::Mistaken };
            return match self.variables.refuse_shared(&text, graph.dependence(value)) {
                Some(message) => {
                    diagnostics.report(name.span(), message);
                    Resolved::Mistaken
                }
                None => Resolved::Value(value),
            };
        }
        if let Some(index) = self.coordinates.iter().position(|coordinate| *coordinate == text) {
            return self.variable(graph, name, ("a coordinate", Symbol::Coordinate(index)), diagnostics);
        }
        if text == "t" {
            return self.variable(graph, name, ("the time", Symbol::Time), diagnostics);
        }
        if let Some(index) = self.fields.iter().position(|field| field.name == text) {
            if self.fields[index].is_f64 {
                return Resolved::Value(graph.symbol(Symbol::Parameter(index)));
            }
            if !self.reported_fields.contains(&index) {
                self.reported_fields.push(index);
                let message = format!("field `{text}` is a parameter of an equation: its type must be f64");
                diagnostics.report(name.span(), message);
            }
            return Resolved::Mistaken;
        }
        if let Some(index) = self.inputs.iter().position(|input| *input == text) {
            return self.variable(graph, name, ("an input", Symbol::Input(index)), diagnostics);
        }
        if self.all_lets.contains(&text) {
            let message = if self.context == let_context(&text) {
                format!("`{text}` is defined by itself")
            } else {
                format!("`{text}` is defined further below: move its `let` above this use")
            };
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
        if let Some(message) = self.variables.refuse_der(&self.context) {
            diagnostics.report(der, message);
            return None;
        }
        let text = name.to_string();
        if let Some(index) = self.coordinates.iter().position(|coordinate| *coordinate == text) {
            return Some(graph.symbol(Symbol::Velocity(index)));
        }
        if !self.has_all_coordinates {
            return None;
        }
        let message = match self.other_kind(&text) {
            Some(kind) => format!("`der` takes a coordinate, `{text}` is {kind}"),
            None => {
                let similar = suggestion(&text, self.coordinates.iter().map(String::as_str));
                format!("unknown name `{text}` in {}{similar}", self.context)
            }
        };
        let message = format!("{message}\ncoordinates: {}", self.coordinates.join(", "));
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

    fn define(&mut self, name: &Ident, value: Option<ExprId>, diagnostics: &mut Diagnostics) {
        check::reserved("a shared expression", name, diagnostics);
        self.locals.last_mut().expect("a `let` stands in a block").push((name.to_string(), value));
    }

    fn enter_block(&mut self) {
        self.locals.push(Vec::new());
    }

    fn leave_block(&mut self) {
        self.locals.pop();
    }

    fn report_unknown(&self, name: &Ident, diagnostics: &mut Diagnostics) {
        if !self.has_all_coordinates {
            return;
        }
        let parameters = self.fields.iter().filter(|field| field.is_f64);
        let parameters: Vec<String> = parameters.map(|field| field.name.to_string()).collect();
        let shared = self.all_lets.iter().filter(|name| self.lets.contains_key(*name)).cloned();
        let shared: Vec<String> =
            shared.chain(self.locals.iter().flatten().map(|(name, _)| name.clone())).collect();
        let known = [
            ("coordinates", &self.coordinates),
            ("inputs", &self.inputs),
            ("parameters", &parameters),
            ("shared", &shared),
        ];
        let names = known.iter().flat_map(|(_, names)| names.iter()).map(String::as_str);
        let similar = suggestion(&name.to_string(), names);
        let lists = known.iter().filter(|(_, names)| !names.is_empty());
        let lists: Vec<String> = lists.map(|(kind, names)| format!("{kind}: {}", names.join(", "))).collect();
        let message = format!("unknown name `{name}` in {}{similar}\n{}", self.context, lists.join("; "));
        diagnostics.report(name.span(), message);
    }
}

fn let_context(name: &str) -> String {
    format!("`let {name}`")
}
