//! How many of everything a declaration has, and how it is expanded; known from names and sizes alone, right or wrong.

use proc_macro2::Ident;

use super::tables::element_name;
use crate::budget::MOST_UNROLLED_COORDINATES;
use crate::expr::Affine;
use crate::syntax::{
    Constraint, Coordinate, Coordinates, Declaration, Expansion, Indexed, Item, Labelled, Range,
};

/// Whether sums and families become terms or loops.
pub(crate) fn expansion(declaration: &Declaration) -> Expansion {
    let arrays = coordinate_entries(declaration).iter().filter(|entry| !entry.shape.is_empty());
    let count = arrays.map(Coordinate::count).try_fold(0_usize, |sum, count| sum.checked_add(count?));
    match count {
        Some(count) if count <= MOST_UNROLLED_COORDINATES => Expansion::Unrolled,
        _ => Expansion::Looped,
    }
}

/// The coordinates in the order of their declaration, right or wrong.
pub(crate) fn coordinate_entries(declaration: &Declaration) -> &[Coordinate] {
    coordinates(declaration).map_or(&[], |coordinates| &coordinates.entries)
}

/// The names of all coordinates, elements of arrays included: none where a size is not known.
pub(crate) fn coordinate_names(declaration: &Declaration) -> Vec<String> {
    let names = |entry: &Coordinate| {
        let name = plain(&entry.name);
        all_indices(&entry.shape).into_iter().map(move |indices| element_name(&name, &indices))
    };
    coordinate_entries(declaration).iter().flat_map(names).collect()
}

/// A name without the mark of a raw identifier.
pub(super) fn plain(name: &Ident) -> String {
    let name = name.to_string();
    name.strip_prefix("r#").map(str::to_owned).unwrap_or(name)
}

/// The indices of all elements of an array, the last index fastest.
fn all_indices(shape: &[Affine]) -> Vec<Vec<Affine>> {
    let mut all = vec![Vec::new()];
    for size in shape {
        let size = size.as_number().unwrap_or(0);
        let longer = |indices: Vec<Affine>| {
            (0..size).map(move |index| {
                let mut indices = indices.clone();
                indices.push(Affine::number(index));
                indices
            })
        };
        all = all.into_iter().flat_map(longer).collect();
    }
    all
}

/// The constraints in the order of their declaration, right or wrong, those without a name included. Of an equation of vectors it is known only
/// that it is one.
pub(crate) fn constraint_names(declaration: &Declaration) -> Vec<String> {
    let names =
        |constraint: &Constraint| constraint.name.as_ref().map_or_else(|| vec![String::new()], family_names);
    constraints(declaration).flat_map(names).collect()
}

/// The observed quantities in the order of their declaration, right or wrong.
pub(crate) fn observable_names(declaration: &Declaration) -> Vec<String> {
    observables(declaration).flat_map(family_names).collect()
}

/// The names of a family: as many as the ranges say, where they are literals.
fn family_names(indexed: &Indexed) -> Vec<String> {
    let ranges: Option<Vec<_>> = indexed.ranges().into_iter().map(Range::literal).collect();
    let mut all = vec![Vec::new()];
    for range in ranges.unwrap_or_default() {
        let longer = |indices: Vec<Affine>| {
            range.clone().map(move |index| {
                let mut indices = indices.clone();
                indices.push(Affine::number(index));
                indices
            })
        };
        all = all.into_iter().flat_map(longer).collect();
    }
    all.into_iter().map(|indices| element_name(&plain(&indexed.name), &indices)).collect()
}

/// The inputs in the order of their declaration, right or wrong.
pub(crate) fn input_names(declaration: &Declaration) -> impl Iterator<Item = &Ident> {
    let names = declaration.items.iter().filter_map(|item| match item {
        Item::Inputs(inputs) => Some(&inputs.names),
        _ => None,
    });
    names.flatten()
}

pub(super) fn observables(declaration: &Declaration) -> impl Iterator<Item = &Indexed> {
    declaration.items.iter().filter_map(|item| match item {
        Item::Observe(Labelled { names, .. }) => names.first(),
        _ => None,
    })
}

/// Whether some coordinate has a frequency, right or wrong.
pub(crate) fn has_frequencies(declaration: &Declaration) -> bool {
    declaration.items.iter().any(|item| matches!(item, Item::Frequency(_)))
}

/// Whether every value is a number: then the user's tokens are Rust that can be evaluated as they are.
pub(super) fn is_of_numbers(declaration: &Declaration) -> bool {
    let has_arrays = coordinate_entries(declaration).iter().any(|entry| !entry.shape.is_empty())
        || declaration.fields.iter().any(|field| field.shape.as_ref().is_some_and(|shape| !shape.is_empty()));
    let is_plain = |indexed: &Indexed| indexed.brackets.is_empty();
    let of_numbers = |item: &Item| match item {
        Item::Lagrangian { value, .. }
        | Item::Kinetic { value, .. }
        | Item::Potential { value, .. }
        | Item::Dissipation { value, .. } => value.iter().all(|value| value.is_of_numbers()),
        Item::Let(definition) => definition.value.iter().all(|value| value.is_of_numbers()),
        Item::Constraint(Constraint { name, left, right }) => {
            name.iter().all(is_plain) && left.iter().chain(right).all(|side| side.is_of_numbers())
        }
        Item::Force(Labelled { names, value })
        | Item::Frequency(Labelled { names, value })
        | Item::Observe(Labelled { names, value }) => {
            names.iter().all(is_plain) && value.iter().all(|value| value.is_of_numbers())
        }
        Item::Coordinates(_) | Item::Inputs(_) | Item::Unknown => true,
    };
    !has_arrays && declaration.items.iter().all(of_numbers)
}

pub(super) fn coordinates(declaration: &Declaration) -> Option<&Coordinates> {
    declaration.items.iter().find_map(|item| match item {
        Item::Coordinates(coordinates) => Some(coordinates),
        _ => None,
    })
}

pub(super) fn constraints(declaration: &Declaration) -> impl Iterator<Item = &Constraint> {
    declaration.items.iter().filter_map(|item| match item {
        Item::Constraint(constraint) => Some(constraint),
        _ => None,
    })
}
