//! From items to a mechanical system: names resolved, equations in the graph, mistakes of meaning found.
//!
//! In: a [`Declaration`]. Out: a [`Model`], or `None` with mistakes reported. Everything is looked at before
//! giving up.

mod check;
mod found;
mod resolve;
mod variables;
mod written;

pub(crate) use written::{Formula, WrittenEquation, written};

use proc_macro2::{Ident, TokenStream};

use crate::diagnostics::Diagnostics;
use crate::expr::{Dependence, ExprId, Graph};
use crate::syntax::{Constraint, Coordinates, Declaration, Expression, Item, Labelled};
use found::Found;
use resolve::Scope;

/// A Lagrangian system in the graph.
pub(crate) struct Model {
    pub(crate) coordinates: Vec<Ident>,
    /// The fields that the equations name, by their index in the struct.
    pub(crate) parameters: Vec<usize>,
    /// The constants that rustc resolves, as written.
    pub(crate) named_constants: Vec<TokenStream>,
    /// `L(t, q, v)`.
    pub(crate) lagrangian: ExprId,
    /// What `L` is made of, in the order kinetic, potential.
    pub(crate) energies: Vec<Energy>,
    /// `φ = LHS − RHS`, with their names.
    pub(crate) constraints: Vec<(Ident, ExprId)>,
    /// What the caller sets at every step.
    pub(crate) inputs: Vec<Ident>,
    /// What is no derivative of `L`.
    pub(crate) forces: Forces,
    /// Frequencies of the interpolating curves, by coordinate.
    pub(crate) frequencies: Vec<(usize, ExprId)>,
    /// Quantities to record, with their names.
    pub(crate) observables: Vec<(Ident, ExprId)>,
    /// The user's expressions, for the copy that is generic over the scalar.
    pub(crate) source: Source,
}

/// Forces beside those of `L`.
#[derive(Default)]
pub(crate) struct Forces {
    /// Rayleigh's function `D`, with its keyword: the force is `−∂D/∂v`.
    pub(crate) dissipation: Option<(Ident, ExprId)>,
    /// Generalized forces, by coordinate, with the name at which the user gives them.
    pub(crate) generalized: Vec<(usize, Ident, ExprId)>,
}

/// An energy as an item of its own.
pub(crate) struct Energy {
    /// `lagrangian`, `kinetic` or `potential`.
    pub(crate) keyword: Ident,
    pub(crate) root: ExprId,
}

/// The user's expressions in the user's order.
pub(crate) struct Source {
    pub(crate) lets: Vec<SourceLet>,
    pub(crate) lagrangian: LagrangianSource,
    /// Left and right sides.
    pub(crate) constraints: Vec<(Expression, Expression)>,
    pub(crate) dissipation: Option<Expression>,
    /// By coordinate.
    pub(crate) forces: Vec<(usize, Expression)>,
}

/// A shared subexpression.
pub(crate) struct SourceLet {
    pub(crate) name: Ident,
    pub(crate) value: Expression,
    pub(crate) root: ExprId,
    /// What it depends on: with velocities it has no place among the constraints, with inputs only among the forces.
    pub(crate) on: Dependence,
}

/// How the user wrote the Lagrangian.
pub(crate) enum LagrangianSource {
    Whole(Expression),
    Difference { kinetic: Expression, potential: Expression },
}

impl Energy {
    fn of(keyword: &Ident, equation: &Option<(ExprId, Expression)>) -> Option<Self> {
        equation.as_ref().map(|(root, _)| Self { keyword: keyword.clone(), root: *root })
    }
}

/// The coordinates in the order of their declaration, right or wrong.
pub(crate) fn coordinate_names(declaration: &Declaration) -> &[Ident] {
    coordinates(declaration).map_or(&[], |coordinates| &coordinates.names)
}

/// The constraints in the order of their declaration, right or wrong, those without a name included.
pub(crate) fn constraint_names(declaration: &Declaration) -> Vec<String> {
    let name = |constraint: &Constraint| constraint.name.as_ref().map_or_else(String::new, Ident::to_string);
    constraints(declaration).map(name).collect()
}

/// The inputs in the order of their declaration, right or wrong.
pub(crate) fn input_names(declaration: &Declaration) -> impl Iterator<Item = &Ident> {
    let names = declaration.items.iter().filter_map(|item| match item {
        Item::Inputs(inputs) => Some(&inputs.names),
        _ => None,
    });
    names.flatten()
}

/// The observed quantities in the order of their declaration, right or wrong.
pub(crate) fn observable_names(declaration: &Declaration) -> impl Iterator<Item = &Ident> {
    declaration.items.iter().filter_map(|item| match item {
        Item::Observe(Labelled { names, .. }) => names.first(),
        _ => None,
    })
}

/// Whether some coordinate has a frequency, right or wrong.
pub(crate) fn has_frequencies(declaration: &Declaration) -> bool {
    declaration.items.iter().any(|item| matches!(item, Item::Frequency(_)))
}

fn coordinates(declaration: &Declaration) -> Option<&Coordinates> {
    declaration.items.iter().find_map(|item| match item {
        Item::Coordinates(coordinates) => Some(coordinates),
        _ => None,
    })
}

fn constraints(declaration: &Declaration) -> impl Iterator<Item = &Constraint> {
    declaration.items.iter().filter_map(|item| match item {
        Item::Constraint(constraint) => Some(constraint),
        _ => None,
    })
}

/// Resolves every name and builds the equations in `graph`.
pub(crate) fn resolve(
    declaration: &Declaration,
    graph: &mut Graph,
    diagnostics: &mut Diagnostics,
) -> Option<Model> {
    if declaration.has_mistaken_shape {
        return None;
    }
    check::names(declaration, diagnostics);
    check::items(declaration, diagnostics);
    let mut scope = Scope::new(declaration);
    let mut found = Found::default();
    for item in &declaration.items {
        found.add(item, &mut scope, graph, diagnostics);
    }
    check::every_coordinate_has_inertia(declaration, &found.kinetic, &found.whole, graph, diagnostics);
    for (name, residual, _) in &found.constraints {
        check::constraint_moves_with_coordinates(name, *residual, graph, diagnostics);
    }
    if let Some((keyword, dissipation, _)) = &found.dissipation {
        check::dissipation_has_velocities(keyword, *dissipation, graph, diagnostics);
    }
    if diagnostics.is_empty() {
        // Elsewhere, what names the input may be what is mistaken.
        check::inputs_are_used(declaration, &found.roots_with_inputs(), graph, diagnostics);
    }
    if !diagnostics.is_empty() {
        return None;
    }
    found.into_model(declaration, scope.into_named_constants(), graph)
}
