//! What the items of a declaration have given so far, one after the other.

use proc_macro2::Ident;

use super::families::Named;
use super::resolve::Scope;
use super::sizes::{coordinate_names, input_names, is_of_numbers};
use super::variables::Variables;
use super::{Energy, Forces, LagrangianSource, Model, Source, SourceLet};
use crate::diagnostics::Diagnostics;
use crate::expr::{ExprId, Graph, Node, Symbol};
use crate::syntax::{Declaration, Expression, Indexed, Item, Labelled};

/// Equations with their sources, in the order of the items.
#[derive(Default)]
pub(super) struct Found {
    pub(super) whole: Option<(ExprId, Expression)>,
    pub(super) kinetic: Option<(ExprId, Expression)>,
    pub(super) potential: Option<(ExprId, Expression)>,
    pub(super) constraints: Vec<Named>,
    pub(super) dissipation: Option<(Ident, ExprId, Expression)>,
    pub(super) lets: Vec<SourceLet>,
    pub(super) energies: Vec<Energy>,
    pub(super) forces: Vec<(usize, Named)>,
    pub(super) frequencies: Vec<(usize, Named)>,
    pub(super) observables: Vec<Named>,
    /// The user's expressions, in the order of the items.
    sides: Vec<(Expression, Expression)>,
    /// The constraints of each item.
    pub(super) constraint_groups: Vec<std::ops::Range<usize>>,
    force_sources: Vec<(usize, Expression)>,
    /// Names without brackets that have a force, or a frequency.
    forced: Vec<Ident>,
    with_frequency: Vec<Ident>,
}

impl Found {
    /// Resolves one item.
    pub(super) fn add(
        &mut self,
        item: &Item,
        scope: &mut Scope<'_>,
        graph: &mut Graph,
        diagnostics: &mut Diagnostics,
    ) {
        use Variables::{All, OfMotion};

        match item {
            Item::Coordinates(_) | Item::Inputs(_) | Item::Unknown => {}
            Item::Lagrangian { keyword, value } => {
                let equation = scope.equation("the Lagrangian", OfMotion, value.as_ref(), graph, diagnostics);
                self.energies.extend(Energy::of(keyword, &equation));
                self.whole = self.whole.take().or(equation);
            }
            Item::Kinetic { keyword, value } => {
                let equation =
                    scope.equation("the kinetic energy", OfMotion, value.as_ref(), graph, diagnostics);
                self.energies.extend(Energy::of(keyword, &equation));
                self.kinetic = self.kinetic.take().or(equation);
            }
            Item::Potential { keyword, value } => {
                let equation = scope.equation("the potential", OfMotion, value.as_ref(), graph, diagnostics);
                self.energies.extend(Energy::of(keyword, &equation));
                self.potential = self.potential.take().or(equation);
            }
            Item::Let(definition) => {
                self.lets.extend(scope.shared(definition, graph, diagnostics));
            }
            Item::Constraint(constraint) => {
                let first = self.constraints.len();
                self.constraints.extend(scope.constraint(constraint, graph, diagnostics));
                self.constraint_groups.push(first..self.constraints.len());
                self.sides.extend(constraint.left.clone().zip(constraint.right.clone()));
            }
            Item::Dissipation { keyword, value } => {
                let equation =
                    scope.equation("the dissipation", OfMotion, value.as_ref(), graph, diagnostics);
                let equation = equation.map(|(root, source)| (keyword.clone(), root, source));
                self.dissipation = self.dissipation.take().or(equation);
            }
            Item::Force(Labelled { names, value }) => {
                let context = format!("the force{}", on(names.first()));
                let Some(target) = names.first() else {
                    scope.value(&context, All, value.as_ref(), graph, diagnostics);
                    return;
                };
                let labelled =
                    Paired { what: "a force", context: &context, variables: All, is_for_all: false };
                let found = labelled.resolve(target, value.as_ref(), scope, graph, diagnostics);
                if let ([(coordinate, _)], Some(source)) = (found.as_slice(), value) {
                    self.force_sources.push((*coordinate, source.clone()));
                }
                let target = (target, &mut self.forced);
                distinct(&self.forces, &found, target, graph.is_as_written(), diagnostics, |name| {
                    format!("there is a force on `{name}` already: write one force, the sum of both")
                });
                self.forces.extend(found);
            }
            Item::Frequency(Labelled { names, value }) => {
                let context = format!("the frequency{}", of(names.first()));
                let variables = Variables::Nothing;
                let labelled = Paired { what: "a frequency", context: &context, variables, is_for_all: true };
                // Of several coordinates the mistakes of their one expression are told once.
                let mut unheard = Diagnostics::default();
                let n_mistakes = diagnostics.len();
                for target in names {
                    let heard = if diagnostics.len() > n_mistakes { &mut unheard } else { &mut *diagnostics };
                    let found = labelled.resolve(target, value.as_ref(), scope, graph, heard);
                    let target = (target, &mut self.with_frequency);
                    distinct(&self.frequencies, &found, target, graph.is_as_written(), diagnostics, |name| {
                        format!("`{name}` has a frequency already")
                    });
                    self.frequencies.extend(found);
                }
            }
            Item::Observe(Labelled { names, value }) => {
                let name = names.first();
                let context = name
                    .map_or_else(String::new, |indexed| format!("the observed quantity `{}`", indexed.name));
                let Some(indexed) = name else {
                    scope.value(&context, All, value.as_ref(), graph, diagnostics);
                    return;
                };
                let observables = &mut self.observables;
                scope.each(
                    &indexed.ranges(),
                    graph,
                    diagnostics,
                    &mut |scope, graph, diagnostics, indices| {
                        let value = scope.value(&context, All, value.as_ref(), graph, diagnostics)?;
                        observables.extend(scope.named(indexed, indices, &value));
                        Some(())
                    },
                );
            }
        }
    }

    /// The equations that may name inputs.
    pub(super) fn roots_with_inputs(&self) -> Vec<ExprId> {
        let forces = self.forces.iter().map(|(_, force)| force.root);
        forces.chain(self.observables.iter().map(|observed| observed.root)).collect()
    }

    /// The model of items without mistakes.
    pub(super) fn into_model(
        mut self,
        declaration: &Declaration,
        scope: Scope<'_>,
        graph: &mut Graph,
    ) -> Option<Model> {
        self.energies.sort_by_key(|energy| energy.keyword == "potential");
        let (lagrangian, source) = match (self.whole, self.kinetic, self.potential) {
            (Some((value, source)), None, None) => (value, LagrangianSource::Whole(source)),
            (None, Some((kinetic, kinetic_source)), Some((potential, potential_source))) => (
                graph.sub(kinetic, potential),
                LagrangianSource::Difference { kinetic: kinetic_source, potential: potential_source },
            ),
            _ => return None,
        };
        let roots: Vec<ExprId> = std::iter::once(lagrangian)
            .chain(self.constraints.iter().map(|constraint| constraint.root))
            .chain(self.dissipation.iter().map(|(_, root, _)| *root))
            .chain(self.forces.iter().map(|(_, force)| force.root))
            .chain(self.frequencies.iter().map(|(_, frequency)| frequency.root))
            .chain(self.observables.iter().map(|observed| observed.root))
            .collect();
        let parameters = graph.symbols(&roots).into_iter().filter_map(|symbol| match symbol {
            Symbol::Parameter(index) => Some(index),
            _ => None,
        });
        let source = Source {
            lagrangian: source,
            constraints: self.sides,
            dissipation: self.dissipation.as_ref().map(|(_, _, source)| source.clone()),
            forces: self.force_sources,
        };
        Some(Model {
            coordinates: coordinate_names(declaration),
            parameters: scope.tables.sorted_parameters(parameters),
            named_constants: scope.named_constants(),
            lagrangian,
            energies: self.energies,
            inputs: input_names(declaration).cloned().collect(),
            lets: self.lets,
            source: is_of_numbers(declaration).then_some(source),
            constraints: self.constraints,
            forces: Forces {
                dissipation: self.dissipation.map(|(keyword, root, _)| (keyword, root)),
                generalized: self.forces,
            },
            frequencies: self.frequencies,
            observables: self.observables,
            bounds: scope.tables.bounds,
        })
    }
}

/// An item that gives coordinates an expression.
struct Paired<'c> {
    what: &'c str,
    context: &'c str,
    variables: Variables,
    /// Whether one number may stand for all elements of an array.
    is_for_all: bool,
}

impl Paired<'_> {
    /// The coordinates of `target` with what each is given.
    fn resolve(
        &self,
        target: &Indexed,
        source: Option<&Expression>,
        scope: &mut Scope<'_>,
        graph: &mut Graph,
        diagnostics: &mut Diagnostics,
    ) -> Vec<(usize, Named)> {
        let mut found = Vec::new();
        scope.each(&target.ranges(), graph, diagnostics, &mut |scope, graph, diagnostics, indices| {
            let part = scope.part(target, self.what, indices, graph, diagnostics);
            let value = scope.value(self.context, self.variables, source, graph, diagnostics);
            match scope.paired(part?, &value?, self.is_for_all, graph) {
                Ok(pairs) => found.extend(pairs.into_iter().map(|(coordinate, name, root)| {
                    let named = Named { name, span: target.span(), root, ranges: scope.open_ranges() };
                    (index_of(graph, coordinate), named)
                })),
                Err(message) => {
                    diagnostics.report(target.span(), message);
                    return None;
                }
            }
            Some(())
        });
        found
    }
}

/// The number of a coordinate; in a graph that is printed no one reads it.
fn index_of(graph: &Graph, coordinate: ExprId) -> usize {
    match graph.node(coordinate) {
        Node::Symbol(Symbol::Coordinate(index)) => index,
        _ => 0,
    }
}

/// Reports elements that have been given something before. Repeated names without brackets have been reported where names are checked.
fn distinct(
    known: &[(usize, Named)],
    found: &[(usize, Named)],
    (target, plain): (&Indexed, &mut Vec<Ident>),
    // Elements have no numbers there.
    is_printed: bool,
    diagnostics: &mut Diagnostics,
    message: impl Fn(&str) -> String,
) {
    if is_printed {
        return;
    }
    if target.brackets.is_empty() {
        if plain.contains(&target.name) {
            return;
        }
        plain.push(target.name.clone());
    }
    let is_known = |(coordinate, _): &&(usize, Named)| known.iter().any(|(other, _)| coordinate == other);
    if let Some((_, named)) = found.iter().find(is_known) {
        diagnostics.report(target.span(), message(&named.name));
    }
}

fn on(coordinate: Option<&Indexed>) -> String {
    coordinate.map(|indexed| format!(" on `{}`", indexed.name)).unwrap_or_default()
}

fn of(coordinate: Option<&Indexed>) -> String {
    coordinate.map(|indexed| format!(" of `{}`", indexed.name)).unwrap_or_default()
}
