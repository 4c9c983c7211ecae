//! From items to a mechanical system: names resolved, equations in the graph, mistakes of meaning found.
//!
//! In: a [`Declaration`]. Out: a [`Model`], or `None` with mistakes reported. Everything is looked at before
//! giving up.

mod check;
mod resolve;
mod written;

pub(crate) use written::{Formula, WrittenEquation, written};

use proc_macro2::{Ident, TokenStream};

use crate::diagnostics::Diagnostics;
use crate::expr::{ExprId, Graph, Symbol};
use crate::syntax::{Constraint, Coordinates, Declaration, Expression, Item};
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
    /// The user's expressions, for the copy that is generic over the scalar.
    pub(crate) source: Source,
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
}

/// A shared subexpression.
pub(crate) struct SourceLet {
    pub(crate) name: Ident,
    pub(crate) value: Expression,
    pub(crate) root: ExprId,
    /// Whether it depends on velocities, and so has no place among the constraints.
    pub(crate) has_velocity: bool,
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
    let mut lets = Vec::new();
    let (mut whole, mut kinetic, mut potential) = (None, None, None);
    let (mut energies, mut constraints) = (Vec::new(), Vec::new());
    for item in &declaration.items {
        match item {
            Item::Coordinates(_) | Item::Unknown => {}
            Item::Lagrangian { keyword, value } => {
                let equation = scope.equation("the Lagrangian", value.as_ref(), graph, diagnostics);
                energies.extend(Energy::of(keyword, &equation));
                whole = whole.or(equation);
            }
            Item::Kinetic { keyword, value } => {
                let equation = scope.equation("the kinetic energy", value.as_ref(), graph, diagnostics);
                energies.extend(Energy::of(keyword, &equation));
                kinetic = kinetic.or(equation);
            }
            Item::Potential { keyword, value } => {
                let equation = scope.equation("the potential", value.as_ref(), graph, diagnostics);
                energies.extend(Energy::of(keyword, &equation));
                potential = potential.or(equation);
            }
            Item::Let(definition) => {
                lets.extend(scope.shared(definition, graph, diagnostics));
            }
            Item::Constraint(constraint) => {
                constraints.extend(scope.constraint(constraint, graph, diagnostics));
            }
        }
    }
    check::every_coordinate_has_inertia(declaration, &kinetic, &whole, graph, diagnostics);
    for (name, residual, _) in &constraints {
        check::constraint_moves_with_coordinates(name, *residual, graph, diagnostics);
    }
    if !diagnostics.is_empty() {
        return None;
    }
    energies.sort_by_key(|energy| energy.keyword == "potential");
    let (lagrangian, source) = match (whole, kinetic, potential) {
        (Some((value, source)), None, None) => (value, LagrangianSource::Whole(source)),
        (None, Some((kinetic, kinetic_source)), Some((potential, potential_source))) => (
            graph.sub(kinetic, potential),
            LagrangianSource::Difference { kinetic: kinetic_source, potential: potential_source },
        ),
        _ => return None,
    };
    let roots: Vec<ExprId> =
        std::iter::once(lagrangian).chain(constraints.iter().map(|(_, residual, _)| *residual)).collect();
    let parameters = graph.symbols(&roots).into_iter().filter_map(|symbol| match symbol {
        Symbol::Parameter(field) => Some(field),
        _ => None,
    });
    Some(Model {
        coordinates: coordinate_names(declaration).to_vec(),
        parameters: parameters.collect(),
        named_constants: scope.into_named_constants(),
        lagrangian,
        energies,
        source: Source {
            lets,
            lagrangian: source,
            constraints: constraints.iter().map(|(_, _, sides)| sides.clone()).collect(),
        },
        constraints: constraints.into_iter().map(|(name, residual, _)| (name, residual)).collect(),
    })
}
