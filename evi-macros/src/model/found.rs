//! What the items of a declaration have given so far, one after the other.

use proc_macro2::{Ident, TokenStream};

use super::resolve::Scope;
use super::variables::Variables;
use super::{Energy, Forces, LagrangianSource, Model, Source, SourceLet, coordinate_names, input_names};
use crate::diagnostics::Diagnostics;
use crate::expr::{ExprId, Graph, Symbol};
use crate::syntax::{Declaration, Expression, Item, Labelled};

/// Equations with their sources, in the order of the items.
#[derive(Default)]
pub(super) struct Found {
    pub(super) whole: Option<(ExprId, Expression)>,
    pub(super) kinetic: Option<(ExprId, Expression)>,
    pub(super) potential: Option<(ExprId, Expression)>,
    pub(super) constraints: Vec<(Ident, ExprId, (Expression, Expression))>,
    pub(super) dissipation: Option<(Ident, ExprId, Expression)>,
    lets: Vec<SourceLet>,
    energies: Vec<Energy>,
    forces: Vec<(usize, Ident, ExprId, Expression)>,
    frequencies: Vec<(usize, ExprId)>,
    observables: Vec<(Ident, ExprId)>,
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
                self.constraints.extend(scope.constraint(constraint, graph, diagnostics));
            }
            Item::Dissipation { keyword, value } => {
                let equation =
                    scope.equation("the dissipation", OfMotion, value.as_ref(), graph, diagnostics);
                let equation = equation.map(|(root, source)| (keyword.clone(), root, source));
                self.dissipation = self.dissipation.take().or(equation);
            }
            Item::Force(Labelled { names, value }) => {
                let name = names.first();
                let coordinate = name.and_then(|name| scope.coordinate(name, "a force", diagnostics));
                let context = format!("the force{}", on(name));
                let equation = scope.equation(&context, All, value.as_ref(), graph, diagnostics);
                if let (Some(name), Some(coordinate), Some((root, source))) = (name, coordinate, equation) {
                    self.forces.push((coordinate, name.clone(), root, source));
                }
            }
            Item::Frequency(Labelled { names, value }) => {
                let context = format!("the frequency{}", of(names.first()));
                let equation =
                    scope.equation(&context, Variables::Nothing, value.as_ref(), graph, diagnostics);
                for name in names {
                    let coordinate = scope.coordinate(name, "a frequency", diagnostics);
                    let frequency = coordinate.zip(equation.as_ref());
                    self.frequencies.extend(frequency.map(|(coordinate, (root, _))| (coordinate, *root)));
                }
            }
            Item::Observe(Labelled { names, value }) => {
                let name = names.first();
                let context = name.map_or_else(String::new, |name| format!("the observed quantity `{name}`"));
                let equation = scope.equation(&context, All, value.as_ref(), graph, diagnostics);
                let observable = name.zip(equation);
                self.observables.extend(observable.map(|(name, (root, _))| (name.clone(), root)));
            }
        }
    }

    /// The equations that may name inputs.
    pub(super) fn roots_with_inputs(&self) -> Vec<ExprId> {
        let forces = self.forces.iter().map(|(_, _, root, _)| *root);
        forces.chain(self.observables.iter().map(|(_, root)| *root)).collect()
    }

    /// The model of items without mistakes.
    pub(super) fn into_model(
        mut self,
        declaration: &Declaration,
        named_constants: Vec<TokenStream>,
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
        let constraints = self.constraints.iter().map(|(_, residual, _)| *residual);
        let dissipation = self.dissipation.iter().map(|(_, root, _)| *root);
        let forces = self.forces.iter().map(|(_, _, root, _)| *root);
        let frequencies = self.frequencies.iter().map(|(_, root)| *root);
        let observables = self.observables.iter().map(|(_, root)| *root);
        let roots: Vec<ExprId> = std::iter::once(lagrangian)
            .chain(constraints)
            .chain(dissipation)
            .chain(forces)
            .chain(frequencies)
            .chain(observables)
            .collect();
        let parameters = graph.symbols(&roots).into_iter().filter_map(|symbol| match symbol {
            Symbol::Parameter(field) => Some(field),
            _ => None,
        });
        Some(Model {
            coordinates: coordinate_names(declaration).to_vec(),
            parameters: parameters.collect(),
            named_constants,
            lagrangian,
            energies: self.energies,
            inputs: input_names(declaration).cloned().collect(),
            source: Source {
                lets: self.lets,
                lagrangian: source,
                constraints: self.constraints.iter().map(|(_, _, sides)| sides.clone()).collect(),
                dissipation: self.dissipation.as_ref().map(|(_, _, source)| source.clone()),
                forces: self.forces.iter().map(|(i, _, _, source)| (*i, source.clone())).collect(),
            },
            constraints: self.constraints.into_iter().map(|(name, residual, _)| (name, residual)).collect(),
            forces: Forces {
                dissipation: self.dissipation.map(|(keyword, root, _)| (keyword, root)),
                generalized: self.forces.into_iter().map(|(i, name, root, _)| (i, name, root)).collect(),
            },
            frequencies: self.frequencies,
            observables: self.observables,
        })
    }
}

fn on(coordinate: Option<&Ident>) -> String {
    coordinate.map(|name| format!(" on `{name}`")).unwrap_or_default()
}

fn of(coordinate: Option<&Ident>) -> String {
    coordinate.map(|name| format!(" of `{name}`")).unwrap_or_default()
}
