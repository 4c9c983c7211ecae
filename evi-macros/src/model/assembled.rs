//! Scenes whose sums and families stay loops: from equations to families of elements, each a small model of its own.
//!
//! In: a [`Declaration`] whose arrays have named or large sizes. Out: an [`Assembled`], or `None` with mistakes reported. An energy is taken apart along
//! its sums: `a Σᵢ bᵢ + c` is the family of `a bᵢ` and the family of the one element `c`. Terms with the same ranges are one family; every
//! constraint is one of its own.

use std::collections::{BTreeMap, BTreeSet, HashMap};

use proc_macro2::TokenStream;

use super::found::Found;
use super::resolve::Scope;
use super::tables::{Tables, element_name};
use super::{
    Bound, Energy, Forces, IndexRange, Model, Named, Place, coordinate_entries, equations, input_names,
};
use crate::diagnostics::Diagnostics;
use crate::expr::{Binary, Composite, ExprId, Graph, Node, Symbol, Unary, substitute};
use crate::syntax::{Declaration, Expansion};

/// A scene as a sum of families.
pub(crate) struct Assembled {
    /// The elements that are different, each a scene in coordinates of its own.
    pub(crate) elements: Vec<Model>,
    pub(crate) families: Vec<Family>,
    /// Names of the observed quantities.
    pub(crate) observables: Vec<String>,
    /// What they are sums of: which of them, and terms over ranges.
    pub(crate) observed: Vec<(usize, Family)>,
    /// What gives curves their frequency: elements that observe it, in the coordinates that take it.
    pub(crate) frequencies: Vec<Family>,
    /// Indices that rustc checks.
    pub(crate) bounds: Vec<Bound>,
}

/// An element that is repeated.
pub(crate) struct Family {
    /// The indices, outermost first; none for a single element.
    pub(crate) ranges: Vec<IndexRange>,
    /// Which of the elements.
    pub(crate) element: usize,
    /// Where each coordinate of the element lies.
    pub(crate) places: Vec<Place>,
    /// The names of its constraints.
    pub(crate) constraints: Vec<String>,
}

/// What a family is made of so far, in the coordinates of the scene.
#[derive(Default)]
struct Parts {
    lagrangian: Vec<ExprId>,
    dissipation: Vec<ExprId>,
    forces: Vec<(usize, Named)>,
    constraints: Vec<Named>,
    observed: Option<Named>,
    /// A coordinate whatever the expressions name.
    coordinate: Option<usize>,
}

/// Resolves every name and finds the families.
pub(crate) fn resolve_assembled(
    declaration: &Declaration,
    graph: &mut Graph,
    diagnostics: &mut Diagnostics,
) -> Option<Assembled> {
    let (mut found, scope) = equations(declaration, Expansion::Looped, graph, diagnostics)?;
    refuse(&found, diagnostics);
    let mut families: Vec<(Vec<IndexRange>, Parts)> = Vec::new();
    let mut sums = Sums { scope: &scope, graph, diagnostics };
    let whole = found.whole.as_ref().or(found.kinetic.as_ref()).map(|(root, _)| (*root, false));
    let potential = found.potential.as_ref().map(|(root, _)| (*root, true));
    for (root, is_negative) in whole.into_iter().chain(potential) {
        for (ranges, term) in sums.terms(root, is_negative, ENERGY) {
            family(&mut families, &ranges).lagrangian.push(term);
        }
    }
    if let Some((_, root, _)) = &found.dissipation {
        for (ranges, term) in sums.terms(*root, false, ENERGY) {
            family(&mut families, &ranges).dissipation.push(term);
        }
    }
    for (place, force) in std::mem::take(&mut found.forces) {
        sums.refuse_in(force.root, "a force of a family names its elements, not a sum over all");
        family(&mut families, &force.ranges).forces.push((place, force));
    }
    let mut observed: Vec<(usize, Vec<IndexRange>, Parts)> = Vec::new();
    for (quantity, named) in found.observables.iter().enumerate() {
        for (ranges, root) in sums.terms(named.root, false, QUANTITY) {
            let term = Named { root, ..named.clone() };
            observed.push((quantity, ranges, Parts { observed: Some(term), ..Parts::default() }));
        }
    }
    for (_, frequency) in &found.frequencies {
        sums.refuse_in(
            frequency.root,
            "a frequency of curves is made of parameters by their names and indices, not of sums over them",
        );
    }
    for constraint in &found.constraints {
        sums.refuse_in(
            constraint.root,
            "a constraint that joins all elements of a loop would couple everything with everything",
        );
    }
    for group in found.constraint_groups.clone() {
        let constraints: Vec<Named> = found.constraints[group].to_vec();
        let ranges = constraints.first().map(|first| first.ranges.clone()).unwrap_or_default();
        families.push((ranges, Parts { constraints, ..Parts::default() }));
    }
    if !diagnostics.is_empty() {
        return None;
    }
    let named_constants = scope.named_constants();
    let tables = scope.tables;
    let mut elements: Vec<Model> = Vec::new();
    let mut repeated = |ranges, parts| {
        let (model, places) = element(declaration, parts, &found, &tables, &named_constants, graph);
        let constraints = model.constraints.iter().map(|constraint| constraint.name.clone()).collect();
        // Branches of a tree differ in their places alone.
        let known = elements.iter().position(|known| are_equal(known, &model));
        let element = known.unwrap_or_else(|| {
            elements.push(model);
            elements.len() - 1
        });
        Family { ranges, element, places, constraints }
    };
    let families = families.into_iter().map(|(ranges, parts)| repeated(ranges, parts)).collect();
    let observed =
        observed.into_iter().map(|(quantity, ranges, parts)| (quantity, repeated(ranges, parts))).collect();
    let frequencies = found.frequencies.iter().map(|(coordinate, frequency)| {
        let parts =
            Parts { observed: Some(frequency.clone()), coordinate: Some(*coordinate), ..Parts::default() };
        repeated(frequency.ranges.clone(), parts)
    });
    let frequencies = frequencies.collect();
    let observables = found.observables.iter().map(|named| named.name.clone()).collect();
    Some(Assembled { elements, families, observables, observed, frequencies, bounds: tables.bounds })
}

/// What a sum is refused in, and what to write there.
type Linear = (&'static str, &'static str);

const ENERGY: Linear = ("couple everything with everything", "an energy is a sum of terms");
const QUANTITY: Linear = (
    "be no sum over elements",
    "an observed quantity is a sum of terms: observe the sums, and compute with what is recorded",
);

/// Whether two elements have the same equations in the same parameters: equal expressions are one node.
fn are_equal(a: &Model, b: &Model) -> bool {
    let roots = |model: &Model| -> Vec<ExprId> {
        let constraints = model.constraints.iter().map(|constraint| constraint.root);
        let dissipation = model.forces.dissipation.iter().map(|(_, root)| *root);
        let forces = model.forces.generalized.iter().map(|(_, force)| force.root);
        let observed = model.observables.iter().map(|observed| observed.root);
        let others = constraints.chain(dissipation).chain(forces).chain(observed);
        std::iter::once(model.lagrangian).chain(others).collect()
    };
    let shape = |model: &Model| {
        let forced: Vec<usize> = model.forces.generalized.iter().map(|(coordinate, _)| *coordinate).collect();
        let (n, has_dissipation) = (model.coordinates.len(), model.forces.dissipation.is_some());
        (n, model.constraints.len(), has_dissipation, forced, model.observables.len())
    };
    shape(a) == shape(b) && roots(a) == roots(b)
}

/// Reports items that a sum of elements does not have.
fn refuse(found: &Found, diagnostics: &mut Diagnostics) {
    for observed in found.observables.iter().filter(|observed| !observed.ranges.is_empty()) {
        let message = "a quantity of a family is one number per element where sums stay loops: observe a `sum(..)`, or one element, `p[0]`; \
                       `StateWriter::of` records coordinates";
        diagnostics.report(observed.span, message);
    }
}

/// The parts of the family with these ranges, the energies' own.
fn family<'f>(families: &'f mut Vec<(Vec<IndexRange>, Parts)>, ranges: &[IndexRange]) -> &'f mut Parts {
    let known = families.iter().position(|(known, _)| known == ranges);
    let index = known.unwrap_or_else(|| {
        families.push((ranges.to_vec(), Parts::default()));
        families.len() - 1
    });
    &mut families[index].1
}

/// Takes expressions apart along their sums.
struct Sums<'s, 'a> {
    scope: &'s Scope<'a>,
    graph: &'s mut Graph,
    diagnostics: &'s mut Diagnostics,
}

/// Part of an expression that is still to be taken apart: a node, what it is multiplied by, and the ranges that it is summed over.
struct Pending {
    root: ExprId,
    factor: Option<ExprId>,
    ranges: Vec<IndexRange>,
}

impl Sums<'_, '_> {
    /// The terms of an energy or an observed quantity without sums in them, each with the ranges that it is summed over, in the order of the source.
    fn terms(&mut self, root: ExprId, is_negative: bool, kind: Linear) -> Vec<(Vec<IndexRange>, ExprId)> {
        let with_sums = self.with_sums(root);
        let factor = is_negative.then(|| self.graph.number(-1.0));
        let mut pending = vec![Pending { root, factor, ranges: Vec::new() }];
        let mut terms = Vec::new();
        while let Some(Pending { root, factor, ranges }) = pending.pop() {
            if !with_sums.contains(&root) {
                let term = factor.map_or(root, |factor| self.graph.mul(factor, root));
                terms.push((ranges, term));
                continue;
            }
            let mut go_on = |root, factor| pending.push(Pending { root, factor, ranges: ranges.clone() });
            match self.graph.node(root) {
                Node::Binary(Binary::Add, a, b) => {
                    go_on(b, factor);
                    go_on(a, factor);
                }
                Node::Binary(Binary::Sub, a, b) => {
                    let negative = self.scaled(factor, -1.0);
                    go_on(b, Some(negative));
                    go_on(a, factor);
                }
                Node::Unary(Unary::Neg, x) => {
                    let negative = self.scaled(factor, -1.0);
                    go_on(x, Some(negative));
                }
                Node::Binary(Binary::Mul, a, b) if !(with_sums.contains(&a) && with_sums.contains(&b)) => {
                    let (sum, other) = if with_sums.contains(&a) { (a, b) } else { (b, a) };
                    let factor = factor.map_or(other, |factor| self.graph.mul(factor, other));
                    go_on(sum, Some(factor));
                }
                Node::Binary(Binary::Div, a, b) if !with_sums.contains(&b) => {
                    let reciprocal = self.graph.reciprocal(b);
                    let factor = factor.map_or(reciprocal, |factor| self.graph.mul(factor, reciprocal));
                    go_on(a, Some(factor));
                }
                Node::Symbol(Symbol::Composite(index)) => {
                    let Composite::Sum { level, from, to, body, .. } = self.graph.composite_at(index).clone()
                    else {
                        unreachable!("vectors are taken apart where they are computed");
                    };
                    if level != ranges.len() {
                        self.report(root, "a sum that does not depend on the index of the sum around it: write it with `sum` inside of that one's `|i|`");
                        continue;
                    }
                    let mut inside = ranges.clone();
                    inside.push(IndexRange { level, from, to });
                    pending.push(Pending { root: body, factor, ranges: inside });
                }
                _ => {
                    let (would, instead) = kind;
                    let message = format!(
                        "a sum inside of a product of sums, a power or a function would {would}: where sums stay loops, {instead}"
                    );
                    self.report(root, &message);
                }
            }
        }
        terms
    }

    fn scaled(&mut self, factor: Option<ExprId>, by: f64) -> ExprId {
        let by = self.graph.number(by);
        factor.map_or(by, |factor| self.graph.mul(by, factor))
    }

    /// The nodes below a root that have sums in them.
    fn with_sums(&self, root: ExprId) -> BTreeSet<ExprId> {
        let mut with_sums = BTreeSet::new();
        // Operands stand before their users.
        for id in self.graph.reachable_in_loops(&[root]) {
            let is_sum = matches!(self.graph.node(id), Node::Symbol(Symbol::Composite(_)));
            if is_sum || self.graph.operands(id).any(|operand| with_sums.contains(&operand)) {
                with_sums.insert(id);
            }
        }
        with_sums
    }

    /// Reports the first sum in an expression.
    fn refuse_in(&mut self, root: ExprId, message: &str) {
        if !self.with_sums(root).is_empty() {
            self.report(root, message);
        }
    }

    /// Reports at the first sum below `root`.
    fn report(&mut self, root: ExprId, message: &str) {
        let below = self.graph.reachable_in_loops(&[root]);
        let place = self.scope.tables.sums.iter().find(|(sum, _)| below.contains(sum));
        if let Some((_, span)) = place {
            self.diagnostics.report(*span, message);
        }
    }
}

/// The model of an element, in coordinates of its own, and where these lie.
fn element(
    declaration: &Declaration,
    parts: Parts,
    found: &Found,
    tables: &Tables,
    named_constants: &[TokenStream],
    graph: &mut Graph,
) -> (Model, Vec<Place>) {
    let total =
        |graph: &mut Graph, terms: &[ExprId]| terms.iter().copied().reduce(|sum, term| graph.add(sum, term));
    let lagrangian = total(graph, &parts.lagrangian).unwrap_or_else(|| graph.number(0.0));
    let dissipation = total(graph, &parts.dissipation);
    let roots: Vec<ExprId> = [lagrangian]
        .into_iter()
        .chain(dissipation)
        .chain(parts.forces.iter().map(|(_, force)| force.root))
        .chain(parts.constraints.iter().map(|constraint| constraint.root))
        .chain(parts.observed.iter().map(|observed| observed.root))
        .collect();
    let symbols = graph.symbols(&roots);
    let forced = parts.forces.iter().map(|(place, _)| *place);
    let coordinate = |symbol: &Symbol| match *symbol {
        Symbol::Coordinate(place) | Symbol::Velocity(place) => Some(place),
        _ => None,
    };
    let used: BTreeSet<usize> =
        symbols.iter().filter_map(coordinate).chain(forced).chain(parts.coordinate).collect();
    // In the order of the arrays and their indices, whatever the order of the terms.
    let sorted: BTreeMap<&Place, usize> = used.iter().map(|&place| (&tables.places[place], place)).collect();
    let local: HashMap<usize, usize> =
        sorted.values().enumerate().map(|(local, place)| (*place, local)).collect();
    let roots = substitute(graph, &roots, |graph, symbol| match symbol {
        Symbol::Coordinate(place) => Some(graph.symbol(Symbol::Coordinate(local[&place]))),
        Symbol::Velocity(place) => Some(graph.symbol(Symbol::Velocity(local[&place]))),
        _ => None,
    });
    let parameters = symbols.iter().filter_map(|symbol| match *symbol {
        Symbol::Parameter(parameter) => Some(parameter),
        _ => None,
    });
    let mut roots = roots.into_iter();
    let mut next = || roots.next().expect("as many as before");
    let lagrangian = next();
    let energies =
        found.energies.first().map(|energy| Energy { keyword: energy.keyword.clone(), root: lagrangian });
    let energies = energies.into_iter().collect();
    let keyword = found.dissipation.as_ref().map(|(keyword, ..)| keyword.clone());
    let dissipation = dissipation.map(|_| (keyword.expect("a dissipation has its keyword"), next()));
    let forces =
        parts.forces.into_iter().map(|(place, force)| (local[&place], Named { root: next(), ..force }));
    let generalized = forces.collect();
    let constraints: Vec<Named> =
        parts.constraints.into_iter().map(|constraint| Named { root: next(), ..constraint }).collect();
    let observables = parts.observed.into_iter().map(|observed| Named { root: next(), ..observed }).collect();
    // All of them, so that they keep their numbers.
    let has_inputs = symbols.iter().any(|symbol| matches!(symbol, Symbol::Input(_)));
    let inputs = if has_inputs { input_names(declaration).cloned().collect() } else { Vec::new() };
    let entries = coordinate_entries(declaration);
    let name = |place: &Place| element_name(&entries[place.array].name.to_string(), &place.indices);
    let model = Model {
        coordinates: sorted.keys().map(|place| name(place)).collect(),
        parameters: tables.sorted_parameters(parameters),
        named_constants: named_constants.to_vec(),
        lagrangian,
        energies,
        constraints,
        inputs,
        forces: Forces { dissipation, generalized },
        frequencies: Vec::new(),
        observables,
        bounds: Vec::new(),
        lets: Vec::new(),
        source: None,
    };
    (model, sorted.into_keys().cloned().collect())
}
