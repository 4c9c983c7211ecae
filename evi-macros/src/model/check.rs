//! Mistakes of meaning that no single name shows.

use std::collections::HashMap;

use proc_macro2::{Ident, Span};

use super::coordinate_names;
use crate::diagnostics::Diagnostics;
use crate::expr::{ExprId, Graph, Symbol};
use crate::syntax::{Constraint, Declaration, Expression, Item};

/// Reports names that are reserved or given twice.
pub(super) fn names(declaration: &Declaration, diagnostics: &mut Diagnostics) {
    let fields = declaration.fields.iter().map(|field| ("field", &field.name));
    let coordinates = coordinate_names(declaration);
    let coordinates = coordinates.iter().map(|name| ("coordinate", name));
    let lets = declaration.items.iter().filter_map(|item| match item {
        Item::Let(definition) => Some(("shared expression", &definition.name)),
        _ => None,
    });
    let mut owners: HashMap<String, &str> = HashMap::new();
    for (kind, name) in fields.chain(coordinates).chain(lets) {
        let text = name.to_string();
        if matches!(text.as_str(), "t" | "der") {
            let meaning = if text == "t" { "the time" } else { "the time derivative" };
            diagnostics.report(name.span(), format!("`{text}` is {meaning}: a {kind} needs another name"));
        } else if let Some(owner) = owners.insert(text, kind) {
            diagnostics.report(name.span(), format!("the name `{name}` is taken by a {owner}"));
        }
    }
    let mut constraints: HashMap<String, ()> = HashMap::new();
    for constraint in super::constraints(declaration) {
        if constraints.insert(constraint.name.to_string(), ()).is_some() {
            let message =
                format!("there is a constraint `{}` already: each needs a name of its own", constraint.name);
            diagnostics.report(constraint.name.span(), message);
        }
    }
}

/// Reports items that are missing or given twice.
pub(super) fn items(declaration: &Declaration, diagnostics: &mut Diagnostics) {
    let struct_name = declaration.name.span();
    if declaration.items.is_empty() {
        // Every item was mistaken, or there is no attribute: reported already.
        if diagnostics.is_empty() {
            diagnostics.report(
                struct_name,
                "the attribute is empty: write #[evi(coordinates(..), lagrangian = ..)]",
            );
        }
        return;
    }
    let only = |keyword: fn(&Item) -> Option<&Ident>, diagnostics: &mut Diagnostics| -> Option<Span> {
        let mut keywords = declaration.items.iter().filter_map(keyword);
        let first = keywords.next()?;
        for again in keywords {
            diagnostics.report(again.span(), format!("`{again}` is given twice"));
        }
        Some(first.span())
    };
    let coordinates = only(
        |item| if let Item::Coordinates { keyword, .. } = item { Some(keyword) } else { None },
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
    match coordinates {
        None => diagnostics.report(struct_name, "the coordinates are missing: write `coordinates(x, y, ..)`"),
        Some(keyword) if coordinate_names(declaration).is_empty() && diagnostics.is_empty() => {
            diagnostics.report(keyword, "a mechanical system has at least one coordinate");
        }
        Some(_) => {}
    }
    match (lagrangian, kinetic, potential) {
        (Some(_), None, None) | (None, Some(_), Some(_)) => {}
        (Some(_), Some(energy), _) | (Some(_), None, Some(energy)) => diagnostics.report(
            energy,
            "the Lagrangian is given twice: write either `lagrangian = ..` or `kinetic = .., potential = ..`",
        ),
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
    declaration: &Declaration,
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
    let symbols = graph.symbols(&[root]);
    for (index, name) in coordinate_names(declaration).iter().enumerate() {
        if !symbols.contains(&Symbol::Velocity(index)) {
            let message = format!("coordinate `{name}` has no mass: `der({name})` is missing in {place}");
            diagnostics.report(name.span(), message);
        }
    }
}

/// Reports a constraint that no motion can change.
pub(super) fn constraint_moves_with_coordinates(
    constraint: &Constraint,
    residual: ExprId,
    graph: &Graph,
    diagnostics: &mut Diagnostics,
) {
    if !graph.dependence(residual).on_q {
        let message = format!("constraint `{}` contains no coordinate", constraint.name);
        diagnostics.report(constraint.name.span(), message);
    }
}
