//! From items to a mechanical system: names resolved, equations in the graph, mistakes of meaning found.
//!
//! In: a [`Declaration`]. Out: a [`Model`], or `None` with mistakes reported. Everything is looked at before
//! giving up.

mod assembled;
mod check;
mod families;
mod found;
mod resolve;
mod sizes;
mod tables;
mod variables;
mod written;

pub(crate) use assembled::{Assembled, Family, resolve_assembled};
pub(crate) use families::Named;
pub(crate) use sizes::{
    constraint_names, coordinate_entries, coordinate_names, expansion, has_frequencies, input_names,
    observable_names,
};
pub(crate) use tables::{Bound, IndexRange, Parameter, ParameterSource, Place};
pub(crate) use written::{Formula, WrittenEquation, written};

use proc_macro2::{Ident, TokenStream};

use crate::diagnostics::Diagnostics;
use crate::expr::{Dependence, ExprId, Graph};
use crate::syntax::{Declaration, Expansion, Expression};
use found::Found;
use resolve::Scope;

/// A Lagrangian system in the graph.
pub(crate) struct Model {
    /// The names of the coordinates, elements of arrays included.
    pub(crate) coordinates: Vec<String>,
    /// What the equations name of the fields, in their order.
    pub(crate) parameters: Vec<Parameter>,
    /// The constants that rustc resolves, as written.
    pub(crate) named_constants: Vec<TokenStream>,
    /// `L(t, q, v)`.
    pub(crate) lagrangian: ExprId,
    /// What `L` is made of, in the order kinetic, potential.
    pub(crate) energies: Vec<Energy>,
    /// `φ = LHS − RHS`, with their names.
    pub(crate) constraints: Vec<Named>,
    /// What the caller sets at every step.
    pub(crate) inputs: Vec<Ident>,
    /// What is no derivative of `L`.
    pub(crate) forces: Forces,
    /// Frequencies of the interpolating curves, by coordinate.
    pub(crate) frequencies: Vec<(usize, Named)>,
    /// Quantities to record, with their names.
    pub(crate) observables: Vec<Named>,
    /// Indices that rustc checks.
    pub(crate) bounds: Vec<Bound>,
    /// Shared subexpressions.
    pub(crate) lets: Vec<SourceLet>,
    /// The user's expressions, for the copy that is generic over the scalar; `None` where they hold vectors, which that copy has not.
    pub(crate) source: Option<Source>,
}

/// Forces beside those of `L`.
#[derive(Default)]
pub(crate) struct Forces {
    /// Rayleigh's function `D`, with its keyword: the force is `−∂D/∂v`.
    pub(crate) dissipation: Option<(Ident, ExprId)>,
    /// Generalized forces, by coordinate, with the name at which the user gives them.
    pub(crate) generalized: Vec<(usize, Named)>,
}

/// An energy as an item of its own.
pub(crate) struct Energy {
    /// `lagrangian`, `kinetic` or `potential`.
    pub(crate) keyword: Ident,
    pub(crate) root: ExprId,
}

/// The user's expressions in the user's order.
pub(crate) struct Source {
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
    /// Its number; `None` for a vector.
    pub(crate) root: Option<ExprId>,
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

/// Resolves every name and builds the equations in `graph`.
pub(crate) fn resolve(
    declaration: &Declaration,
    graph: &mut Graph,
    diagnostics: &mut Diagnostics,
) -> Option<Model> {
    let expansion = if graph.is_as_written() { Expansion::Written } else { Expansion::Unrolled };
    let (found, scope) = equations(declaration, expansion, graph, diagnostics)?;
    found.into_model(declaration, scope, graph)
}

/// What the items give, if they have no mistakes.
fn equations<'a>(
    declaration: &'a Declaration,
    expansion: Expansion,
    graph: &mut Graph,
    diagnostics: &mut Diagnostics,
) -> Option<(Found, Scope<'a>)> {
    if declaration.has_mistaken_shape {
        return None;
    }
    check::names(declaration, diagnostics);
    check::items(declaration, diagnostics);
    let mut scope = Scope::new(declaration, expansion);
    let mut found = Found::default();
    for item in &declaration.items {
        found.add(item, &mut scope, graph, diagnostics);
    }
    check::every_coordinate_has_inertia(&scope, &found.kinetic, &found.whole, graph, diagnostics);
    for constraint in &found.constraints {
        check::constraint_moves_with_coordinates(constraint, graph, diagnostics);
    }
    if let Some((keyword, dissipation, _)) = &found.dissipation {
        check::dissipation_has_velocities(keyword, *dissipation, graph, diagnostics);
    }
    if diagnostics.is_empty() {
        // Elsewhere, what names the input may be what is mistaken.
        check::inputs_are_used(declaration, &found.roots_with_inputs(), graph, diagnostics);
    }
    diagnostics.is_empty().then_some((found, scope))
}
