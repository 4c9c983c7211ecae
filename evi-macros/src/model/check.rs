//! Mistakes of meaning that no single name shows.

use std::collections::{HashMap, HashSet};

use proc_macro2::{Ident, Span};

use super::families::Named;
use super::resolve::Scope;
use super::sizes;
use crate::diagnostics::Diagnostics;
use crate::expr::{ExprId, Graph, Symbol};
use crate::syntax::{Declaration, Expression, Indexed, Item, Labelled};

/// Reports names that are reserved or given twice.
pub(super) fn names(declaration: &Declaration, diagnostics: &mut Diagnostics) {
    let fields = declaration.fields.iter().map(|field| ("a field", &field.name));
    let coordinates =
        sizes::coordinate_entries(declaration).iter().map(|entry| ("a coordinate", &entry.name));
    let inputs = sizes::input_names(declaration).map(|name| ("an input", name));
    let lets = declaration.items.iter().filter_map(|item| match item {
        Item::Let(definition) => Some(("a shared expression", &definition.name)),
        _ => None,
    });
    let mut owners: HashMap<String, &str> = HashMap::new();
    for (kind, name) in fields.chain(coordinates).chain(inputs).chain(lets) {
        if reserved(kind, name, diagnostics) {
            continue;
        }
        if let Some(owner) = owners.insert(name.to_string(), kind) {
            diagnostics.report(name.span(), format!("the name `{name}` is taken by {owner}"));
        }
    }
    let constraints = sizes::constraints(declaration)
        .filter_map(|constraint| constraint.name.as_ref().map(|indexed| &indexed.name));
    distinct(constraints, diagnostics, |name| {
        format!("there is a constraint `{name}` already: each needs a name of its own")
    });
    distinct(sizes::observables(declaration).map(|indexed| &indexed.name), diagnostics, |name| {
        format!("there is an observed quantity `{name}` already: each needs a name of its own")
    });
    let forces = declaration.items.iter().filter_map(|item| match item {
        Item::Force(Labelled { names, .. }) => names.first().and_then(without_brackets),
        _ => None,
    });
    distinct(forces, diagnostics, |name| {
        format!("there is a force on `{name}` already: write one force, the sum of both")
    });
    let frequencies = declaration.items.iter().filter_map(|item| match item {
        Item::Frequency(Labelled { names, .. }) => Some(names),
        _ => None,
    });
    distinct(frequencies.flatten().filter_map(without_brackets), diagnostics, |name| {
        format!("`{name}` has a frequency already")
    });
}

/// The name of what has no brackets: elements are told apart where their indices are known.
fn without_brackets(indexed: &Indexed) -> Option<&Ident> {
    indexed.brackets.is_empty().then_some(&indexed.name)
}

/// Reports every name that has stood before.
fn distinct<'n>(
    names: impl Iterator<Item = &'n Ident>,
    diagnostics: &mut Diagnostics,
    message: impl Fn(&Ident) -> String,
) {
    let mut known: HashSet<String> = HashSet::new();
    for name in names {
        if !known.insert(name.to_string()) {
            diagnostics.report(name.span(), message(name));
        }
    }
}

/// Reports a name that has a meaning of its own.
pub(super) fn reserved(kind: &str, name: &Ident, diagnostics: &mut Diagnostics) -> bool {
    let meaning = match name.to_string().as_str() {
        "t" => "the time",
        "der" => "the time derivative",
        _ => return false,
    };
    diagnostics.report(name.span(), format!("`{name}` is {meaning}: {kind} needs another name"));
    true
}

/// Reports items that are missing or given twice.
pub(super) fn items(declaration: &Declaration, diagnostics: &mut Diagnostics) {
    let struct_name = declaration.name.span();
    let only = |keyword: fn(&Item) -> Option<&Ident>, diagnostics: &mut Diagnostics| -> Option<Span> {
        let mut keywords = declaration.items.iter().filter_map(keyword);
        let first = keywords.next()?;
        for again in keywords {
            diagnostics.report(again.span(), format!("`{again}` is given twice"));
        }
        Some(first.span())
    };
    only(
        |item| if let Item::Coordinates(coordinates) = item { Some(&coordinates.keyword) } else { None },
        diagnostics,
    );
    let lagrangian = only(
        |item| if let Item::Lagrangian { keyword, .. } = item { Some(keyword) } else { None },
        diagnostics,
    );
    let kinetic =
        only(|item| if let Item::Kinetic { keyword, .. } = item { Some(keyword) } else { None }, diagnostics);
    let potential = only(
        |item| if let Item::Potential { keyword, .. } = item { Some(keyword) } else { None },
        diagnostics,
    );
    only(|item| if let Item::Dissipation { keyword, .. } = item { Some(keyword) } else { None }, diagnostics);
    if let (Some(_), Some(energy), _) | (Some(_), None, Some(energy)) = (lagrangian, kinetic, potential) {
        let message =
            "the Lagrangian is given twice: write either `lagrangian = ..` or `kinetic = .., potential = ..`";
        diagnostics.report(energy, message);
    }
    let is_unknown = |item: &Item| matches!(item, Item::Unknown);
    if declaration.items.is_empty() || declaration.items.iter().any(is_unknown) {
        // Reported already: what seems to be missing may be what is unknown.
        return;
    }
    match sizes::coordinates(declaration) {
        None => diagnostics.report(struct_name, "the coordinates are missing: write `coordinates(x, y, ..)`"),
        Some(coordinates) if coordinates.is_complete && coordinates.entries.is_empty() => {
            diagnostics.report(coordinates.keyword.span(), "a mechanical system has at least one coordinate");
        }
        Some(_) => {}
    }
    match (lagrangian, kinetic, potential) {
        (Some(_), _, _) | (None, Some(_), Some(_)) => {}
        (None, Some(kinetic), None) => {
            diagnostics
                .report(kinetic, "the potential is missing: write `potential = ..` (0.0 if there is none)");
        }
        (None, None, Some(potential)) => {
            diagnostics.report(potential, "the kinetic energy is missing: write `kinetic = ..`");
        }
        (None, None, None) => diagnostics.report(
            struct_name,
            "the Lagrangian is missing: write `lagrangian = ..`, or `kinetic = .., potential = ..`",
        ),
    }
}

/// Reports coordinates whose velocity no energy contains: their mass would be zero.
pub(super) fn every_coordinate_has_inertia(
    scope: &Scope<'_>,
    kinetic: &Option<(ExprId, Expression)>,
    lagrangian: &Option<(ExprId, Expression)>,
    graph: &Graph,
    diagnostics: &mut Diagnostics,
) {
    let (root, place) = match (kinetic, lagrangian) {
        (Some((root, _)), _) => (*root, "the kinetic energy"),
        (None, Some((root, _))) => (*root, "the Lagrangian"),
        (None, None) => return,
    };
    let symbols = graph.symbols_in_loops(&[root]);
    for (array, entry) in scope.entries().iter().enumerate() {
        let is_repeated = scope.entries()[..array].iter().any(|earlier| earlier.name == entry.name);
        let missing = scope.without_velocity(array, &symbols);
        if let Some(name) = missing.filter(|_| !is_repeated) {
            let message = format!("coordinate `{name}` has no mass: `der({name})` is missing in {place}");
            diagnostics.report(entry.name.span(), message);
        }
    }
}

/// Reports a constraint that no motion can change.
pub(super) fn constraint_moves_with_coordinates(
    constraint: &Named,
    graph: &Graph,
    diagnostics: &mut Diagnostics,
) {
    if !graph.dependence(constraint.root).on_q {
        let message = format!("constraint `{}` contains no coordinate", constraint.name);
        diagnostics.report(constraint.span, message);
    }
}

/// Reports a dissipation that no motion changes.
pub(super) fn dissipation_has_velocities(
    keyword: &Ident,
    dissipation: ExprId,
    graph: &Graph,
    diagnostics: &mut Diagnostics,
) {
    if !graph.dependence(dissipation).on_v {
        let message = "the dissipation contains no `der(..)`: its force −∂D/∂(der q) vanishes";
        diagnostics.report(keyword.span(), message);
    }
}

/// Reports inputs that stand in none of the equations that may name them.
pub(super) fn inputs_are_used(
    declaration: &Declaration,
    equations: &[ExprId],
    graph: &Graph,
    diagnostics: &mut Diagnostics,
) {
    let symbols = graph.symbols(equations);
    for (index, input) in sizes::input_names(declaration).enumerate() {
        if !symbols.contains(&Symbol::Input(index)) {
            let message = format!("input `{input}` is named by no force and no observed quantity");
            diagnostics.report(input.span(), message);
        }
    }
}
