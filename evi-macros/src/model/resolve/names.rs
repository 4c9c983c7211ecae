//! What names mean in an equation.

use proc_macro2::{Ident, Span, TokenStream};

use super::elements::{dependence, flat_index};
use super::{INDEX_NAMES, Scope, let_context};
use crate::diagnostics::{Diagnostics, suggestion};
use crate::expr::{Affine, ArrayKind, Composite, Dependence, ExprId, Graph, Symbol, Value, View};
use crate::model::check;
use crate::model::sizes::plain;
use crate::model::tables::{Bound, IndexRange, ParameterSource, Place};
use crate::syntax::{Expansion, Resolved, Resolver};

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

impl Scope<'_> {
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
}
