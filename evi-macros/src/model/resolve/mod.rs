//! What names mean, and equations as nodes.

mod elements;
mod names;

use std::collections::{BTreeSet, HashMap};

use proc_macro2::{Ident, TokenStream};

use super::SourceLet;
use super::families::Named;
use super::sizes::{coordinate_entries, coordinates, input_names, plain};
use super::tables::{IndexRange, Tables, element_name};
use super::variables::Variables;
use crate::diagnostics::{Diagnostics, suggestion};
use crate::expr::{ArrayKind, ExprId, Graph, Symbol, Value, View};
use crate::syntax::{Constraint, Coordinate, Declaration, Expansion, Expression, Field, Item, Let, lower};
use elements::{dependence, indices_of, residual};

/// The names in reach of an equation.
pub(super) struct Scope<'a> {
    fields: &'a [Field],
    /// Fields of another type than numbers that have been reported.
    reported_fields: Vec<usize>,
    entries: &'a [Coordinate],
    coordinates: Vec<String>,
    inputs: Vec<String>,
    /// Whether all coordinates are known; otherwise a mistake has been reported there, and any name may be
    /// one.
    has_all_coordinates: bool,
    /// Shared subexpressions so far; `None` where the definition is mistaken.
    lets: HashMap<String, Option<Value>>,
    /// Names of all shared subexpressions, those further below included.
    all_lets: Vec<String>,
    /// Names in the open blocks, innermost last.
    locals: Vec<Vec<(String, Option<Value>)>>,
    named_constants: Vec<(String, TokenStream)>,
    /// What is being resolved, for messages.
    context: String,
    variables: Variables,
    expansion: Expansion,
    /// Ranges of the open indices that stay loops, outermost first.
    ranges: Vec<IndexRange>,
    pub(super) tables: Tables,
}

/// What indices of loops are called in equations that are computed, so that sums over one range share their elements whatever the user calls
/// their indices.
const INDEX_NAMES: [&str; 6] = ["i", "j", "k", "l", "m", "n"];

impl<'a> Scope<'a> {
    pub(super) fn new(declaration: &'a Declaration, expansion: Expansion) -> Self {
        let all_lets = declaration.items.iter().filter_map(|item| match item {
            Item::Let(definition) => Some(definition.name.to_string()),
            _ => None,
        });
        let entries = coordinate_entries(declaration);
        let inputs: Vec<String> = input_names(declaration).map(Ident::to_string).collect();
        let is_complete = coordinates(declaration).is_some_and(|coordinates| coordinates.is_complete);
        Self {
            fields: &declaration.fields,
            reported_fields: Vec::new(),
            entries,
            coordinates: entries.iter().map(|entry| entry.name.to_string()).collect(),
            inputs,
            has_all_coordinates: is_complete && !entries.is_empty(),
            lets: HashMap::new(),
            all_lets: all_lets.collect(),
            locals: Vec::new(),
            named_constants: Vec::new(),
            context: String::new(),
            variables: Variables::All,
            expansion,
            ranges: Vec::new(),
            tables: Tables::new(declaration.fields.len()),
        }
    }

    pub(super) fn entries(&self) -> &'a [Coordinate] {
        self.entries
    }

    /// The ranges of the open indices that are not written out.
    pub(super) fn ranges(&self) -> &[IndexRange] {
        &self.ranges
    }

    /// Those of them that an equation is repeated over.
    pub(super) fn open_ranges(&self) -> Vec<IndexRange> {
        if self.expansion == Expansion::Looped { self.ranges.clone() } else { Vec::new() }
    }

    /// The number of the first coordinate of an entry.
    fn first_coordinate(&self, array: usize) -> usize {
        self.entries[..array].iter().map(|entry| entry.count().unwrap_or(0)).sum()
    }

    /// A coordinate of an entry, by its name, whose velocity is not among the symbols.
    pub(super) fn without_velocity(&self, array: usize, symbols: &BTreeSet<Symbol>) -> Option<String> {
        let entry = &self.entries[array];
        let name = entry.name.to_string();
        if self.expansion != Expansion::Unrolled {
            let is_of_entry = |symbol: &Symbol| match *symbol {
                Symbol::Velocity(place) if self.expansion == Expansion::Looped => {
                    self.tables.places[place].array == array
                }
                _ => self.expansion == Expansion::Written,
            };
            return (!symbols.iter().any(is_of_entry)).then_some(name);
        }
        let (first, count) = (self.first_coordinate(array), entry.count().unwrap_or(0));
        let is_missing = |k: &usize| !symbols.contains(&Symbol::Velocity(first + k));
        let missing: Vec<usize> = (0..count).filter(is_missing).collect();
        match missing.first() {
            None => None,
            Some(_) if missing.len() == count => Some(name),
            Some(&element) => Some(element_name(&name, &indices_of(&entry.shape, element))),
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
        match lower(value, graph, self, diagnostics)? {
            Value::Scalar(root) => Some((root, value.clone())),
            vector => {
                self.report_vector(&vector, value, diagnostics);
                None
            }
        }
    }

    /// The value of an expression in the given variables, a number or a vector.
    pub(super) fn value(
        &mut self,
        context: &str,
        variables: Variables,
        value: Option<&Expression>,
        graph: &mut Graph,
        diagnostics: &mut Diagnostics,
    ) -> Option<Value> {
        self.context = context.to_owned();
        self.variables = variables;
        lower(value?, graph, self, diagnostics)
    }

    fn report_vector(&self, vector: &Value, source: &Expression, diagnostics: &mut Diagnostics) {
        let length = if let Value::Vector(parts) = vector { parts.len() } else { 0 };
        let message = format!(
            "{} is a number, this is a vector of {length}: write `.dot(..)` or `.norm_squared()`",
            self.context
        );
        diagnostics.report_range(source.first_span(), source.last_span(), message);
    }

    /// Adds a shared subexpression to the scope.
    pub(super) fn shared(
        &mut self,
        definition: &Let,
        graph: &mut Graph,
        diagnostics: &mut Diagnostics,
    ) -> Option<SourceLet> {
        let name = definition.name.to_string();
        let source = definition.value.as_ref();
        let value = self.value(&let_context(&name), Variables::All, source, graph, diagnostics);
        self.lets.insert(name, value.clone());
        let (value, source) = (value?, source?.clone());
        let on = dependence(graph, &value);
        let root = if let Value::Scalar(root) = value { Some(root) } else { None };
        Some(SourceLet { name: definition.name.clone(), value: source, root, on })
    }

    /// The residuals `LHS − RHS` of a constraint, of every value of its indices and every element of its equation.
    pub(super) fn constraint(
        &mut self,
        constraint: &Constraint,
        graph: &mut Graph,
        diagnostics: &mut Diagnostics,
    ) -> Vec<Named> {
        let mut found = Vec::new();
        let Some(indexed) = &constraint.name else { return found };
        self.context = format!("constraint `{}`", indexed.name);
        self.variables = Variables::OfPlace;
        self.each(&indexed.ranges(), graph, diagnostics, &mut |scope, graph, diagnostics, indices| {
            // Both sides before either is given up, so that the mistakes of both are reported.
            let mut side = |side: &Option<Expression>| lower(side.as_ref()?, graph, scope, diagnostics);
            let (left, right) = (side(&constraint.left), side(&constraint.right));
            match residual(graph, left?, right?) {
                Ok(residual) => {
                    let mut named = scope.named(indexed, indices, &residual);
                    if scope.expansion == Expansion::Written {
                        let name = scope.name_with_ranges(indexed, indices);
                        named.iter_mut().for_each(|constraint| constraint.name.clone_from(&name));
                    }
                    found.extend(named);
                }
                Err(message) => diagnostics.report(indexed.span(), message),
            }
            Some(())
        });
        found
    }

    /// The coordinates that an item stands for.
    pub(super) fn coordinate(&self, name: &Ident, item: &str, diagnostics: &mut Diagnostics) -> Option<View> {
        let text = name.to_string();
        let index = self.coordinates.iter().position(|coordinate| *coordinate == text);
        if let Some(number) = index {
            let shape = self.entries[number].shape.clone();
            return Some(View {
                kind: ArrayKind::Coordinate,
                number,
                name: plain(name),
                indices: Vec::new(),
                shape,
            });
        }
        if !self.has_all_coordinates {
            return None;
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

    pub(super) fn named_constants(&self) -> Vec<TokenStream> {
        self.named_constants.iter().map(|(_, path)| path.clone()).collect()
    }
}

fn let_context(name: &str) -> String {
    format!("`let {name}`")
}
