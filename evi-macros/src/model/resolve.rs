//! What names mean, and equations as nodes.

use std::collections::{BTreeSet, HashMap};

use proc_macro2::{Ident, Span, TokenStream};

use super::families::Named;
use super::sizes::{coordinate_entries, coordinates, input_names, plain};
use super::tables::{Bound, IndexRange, ParameterSource, Place, Tables, element_name};
use super::variables::Variables;
use super::{SourceLet, check};
use crate::diagnostics::{Diagnostics, suggestion};
use crate::expr::{Affine, ArrayKind, Composite, Dependence, ExprId, Graph, Symbol, Value, View};
use crate::syntax::{
    Constraint, Coordinate, Declaration, Expansion, Expression, Field, Item, Let, Resolved, Resolver, lower,
};

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

    /// The value of an array, of which no index is given yet; of a number its node.
    fn array(
        &mut self,
        graph: &mut Graph,
        kind: ArrayKind,
        number: usize,
        name: &str,
        shape: Vec<Affine>,
    ) -> Value {
        let view = View { kind, number, name: name.to_owned(), indices: Vec::new(), shape };
        if view.shape.is_empty() { Value::Scalar(self.element(graph, &view)) } else { Value::Array(view) }
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

    /// The symbol of the time or an input, where it may stand.
    fn variable(
        &self,
        graph: &mut Graph,
        name: &Ident,
        (what, symbol): (&str, Symbol),
        diagnostics: &mut Diagnostics,
    ) -> Resolved {
        let node = graph.symbol(symbol);
        if self.refuses(name, what, graph.dependence(node), diagnostics) {
            return Resolved::Mistaken;
        }
        Resolved::Value(Value::Scalar(node))
    }

    /// Whether a variable has no place here, which is reported.
    fn refuses(&self, name: &Ident, what: &str, on: Dependence, diagnostics: &mut Diagnostics) -> bool {
        let message = self.variables.refuse_symbol(&name.to_string(), what, on);
        let is_refused = message.is_some();
        if let Some(message) = message {
            diagnostics.report(name.span(), message);
        }
        is_refused
    }

    pub(super) fn named_constants(&self) -> Vec<TokenStream> {
        self.named_constants.iter().map(|(_, path)| path.clone()).collect()
    }
}

impl Resolver for Scope<'_> {
    fn expansion(&self) -> Expansion {
        self.expansion
    }

    fn name(&mut self, graph: &mut Graph, name: &Ident, diagnostics: &mut Diagnostics) -> Resolved {
        let text = name.to_string();
        let local =
            self.locals.iter().rev().flat_map(|block| block.iter().rev()).find(|(local, _)| *local == text);
        let shared = || self.lets.get(&text).map(|value| (text.clone(), value.clone()));
        if let Some((_, value)) = local.cloned().or_else(shared) {
            let Some(value) = value else { return Resolved::Mistaken };
            return match self.variables.refuse_shared(&text, dependence(graph, &value)) {
                Some(message) => {
                    diagnostics.report(name.span(), message);
                    Resolved::Mistaken
                }
                None => Resolved::Value(value),
            };
        }
        if let Some(number) = self.coordinates.iter().position(|coordinate| *coordinate == text) {
            let on = Dependence { on_q: true, ..Dependence::default() };
            if self.refuses(name, "a coordinate", on, diagnostics) {
                return Resolved::Mistaken;
            }
            let shape = self.entries[number].shape.clone();
            return Resolved::Value(self.array(graph, ArrayKind::Coordinate, number, &text, shape));
        }
        if text == "t" {
            return self.variable(graph, name, ("the time", Symbol::Time), diagnostics);
        }
        if let Some(index) = self.fields.iter().position(|field| field.name == text) {
            if let Some(shape) = self.fields[index].shape.clone() {
                return Resolved::Value(self.array(graph, ArrayKind::Parameter, index, &text, shape));
            }
            if !self.reported_fields.contains(&index) {
                self.reported_fields.push(index);
                let message = format!(
                    "field `{text}` is a parameter of an equation: its type must be f64, an array such as [f64; 3], or a \
                     vector such as Vector3<f64>"
                );
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
    ) -> Option<Value> {
        if let Some(message) = self.variables.refuse_der(&self.context) {
            diagnostics.report(der, message);
            return None;
        }
        let text = name.to_string();
        if let Some(number) = self.coordinates.iter().position(|coordinate| *coordinate == text) {
            let shape = self.entries[number].shape.clone();
            return Some(self.array(graph, ArrayKind::Velocity, number, &text, shape));
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

    fn element(&mut self, graph: &mut Graph, view: &View) -> ExprId {
        let View { kind, number, indices, .. } = view;
        let is_array = match kind {
            ArrayKind::Parameter => {
                self.fields[*number].shape.as_ref().is_some_and(|shape| !shape.is_empty())
            }
            _ => !self.entries[*number].shape.is_empty(),
        };
        if self.expansion == Expansion::Written && is_array {
            let (on_q, on_v) = (*kind == ArrayKind::Coordinate, *kind == ArrayKind::Velocity);
            let element =
                Composite::Element { name: view.name.clone(), is_velocity: on_v, indices: indices.clone() };
            return graph.composite(element, Dependence { on_q, on_v, ..Dependence::default() });
        }
        let coordinate = |scope: &mut Self| match scope.expansion {
            Expansion::Unrolled => {
                scope.first_coordinate(*number) + flat_index(&scope.entries[*number].shape, indices)
            }
            Expansion::Looped => scope.tables.place(Place { array: *number, indices: indices.clone() }),
            Expansion::Written => *number,
        };
        let symbol = match kind {
            ArrayKind::Coordinate => Symbol::Coordinate(coordinate(self)),
            ArrayKind::Velocity => Symbol::Velocity(coordinate(self)),
            ArrayKind::Parameter => {
                let source = ParameterSource::Field { field: *number, indices: indices.clone() };
                Symbol::Parameter(self.tables.parameter(source))
            }
        };
        graph.symbol(symbol)
    }

    fn index_as_number(&mut self, graph: &mut Graph, index: &Affine) -> ExprId {
        match index.as_number() {
            Some(number) => graph.number(number as f64),
            None if self.expansion == Expansion::Written => {
                graph.composite(Composite::Index(index.clone()), Dependence::default())
            }
            None => {
                graph.symbol(Symbol::Parameter(self.tables.parameter(ParameterSource::Index(index.clone()))))
            }
        }
    }

    fn check_bounds(&mut self, index: &Affine, size: &Affine, array: &str, first: Span, last: Span) {
        if self.expansion != Expansion::Written {
            let (index, size, array) = (index.clone(), size.clone(), array.to_owned());
            self.tables.bounds.push(Bound { index, size, array, ranges: self.ranges.clone(), first, last });
        }
    }

    fn enter_index(&mut self, name: &Ident, from: &Affine, to: &Affine) -> (usize, Affine) {
        let level = self.ranges.len();
        self.ranges.push(IndexRange { level, from: from.clone(), to: to.clone() });
        let name = match self.expansion {
            Expansion::Written => plain(name),
            _ => INDEX_NAMES.get(level).map_or_else(|| format!("i{level}"), |name| (*name).to_owned()),
        };
        (level, Affine::index(level, name))
    }

    fn leave_index(&mut self) {
        self.ranges.pop();
    }

    fn place_of_sum(&mut self, sum: ExprId, place: Span) {
        self.tables.sums.push((sum, place));
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

    fn define(&mut self, name: &Ident, value: Option<Value>, diagnostics: &mut Diagnostics) {
        let kind = if matches!(value, Some(Value::Index(_))) { "an index" } else { "a shared expression" };
        check::reserved(kind, name, diagnostics);
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
        let parameters = self.fields.iter().filter(|field| field.shape.is_some());
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

/// What the numbers in a value depend on.
fn dependence(graph: &Graph, value: &Value) -> Dependence {
    match value {
        Value::Scalar(root) => graph.dependence(*root),
        Value::Vector(parts) => {
            parts.iter().fold(Dependence::default(), |union, part| union.union(dependence(graph, part)))
        }
        Value::Array(view) => Dependence {
            on_q: view.kind == ArrayKind::Coordinate,
            on_v: view.kind == ArrayKind::Velocity,
            ..Dependence::default()
        },
        Value::Index(_) => Dependence::default(),
    }
}

/// `left − right`, element by element.
fn residual(graph: &mut Graph, left: Value, right: Value) -> Result<Value, String> {
    match (left, right) {
        (Value::Scalar(left), Value::Scalar(right)) => Ok(Value::Scalar(graph.sub(left, right))),
        (Value::Vector(left), Value::Vector(right)) if left.len() == right.len() => {
            let parts = std::iter::zip(left, right).map(|(left, right)| residual(graph, left, right));
            parts.collect::<Result<_, _>>().map(Value::Vector)
        }
        (Value::Vector(left), Value::Vector(right)) => {
            let (left, right) = (left.len(), right.len());
            Err(format!("vectors of {left} and of {right} elements: both sides of `==` have the same length"))
        }
        (left, _) => {
            let (left, right) =
                if matches!(left, Value::Vector(_)) { ("vector", "number") } else { ("number", "vector") };
            Err(format!("a {left} on the left of `==`, a {right} on its right: both sides are of a kind"))
        }
    }
}

/// The place of an element among all of an array, the last index fastest.
fn flat_index(shape: &[Affine], indices: &[Affine]) -> usize {
    let number =
        |value: &Affine| value.as_number().and_then(|number| usize::try_from(number).ok()).unwrap_or(0);
    std::iter::zip(shape, indices).fold(0, |flat, (size, index)| flat * number(size) + number(index))
}

/// The indices of an element from its place among all.
fn indices_of(shape: &[Affine], mut flat: usize) -> Vec<Affine> {
    let mut indices = Vec::new();
    for size in shape.iter().rev() {
        let size = size.as_number().and_then(|size| usize::try_from(size).ok()).unwrap_or(1);
        indices.push(Affine::number(i64::try_from(flat % size).unwrap_or(0)));
        flat /= size;
    }
    indices.reverse();
    indices
}
