//! Entries of `G M⁻¹ Gᵀ` that are the same at every configuration on the constraints.
//!
//! In: equations with a constant, diagonal mass matrix, and constraints of degree two in `q` at most, without time. Out: the entries, lower
//! triangle, that are a combination of the constraints but for a constant, with that constant:
//!
//! ```text
//! (G M⁻¹ Gᵀ)ᵢⱼ = κ₀ + Σ κ_c φ_c(q)
//! ```
//!
//! A rod between two masses has such an entry, `4 l² (1/m₁ + 1/m₂)`; of a rigid body in directors all are. A factor `κ_c` is read off at a product of two
//! coordinates that no other of the constraints has; that the equation is an identity is asked of [`vanishes`].

use std::collections::{BTreeMap, BTreeSet};

use super::{Calculus, Equations, Partial};
use crate::differentiate::partial;
use crate::expr::{ExprId, Symbol, substitute, vanishes};

/// Beyond so many entries none is looked for: they cost more to find than they save.
const MOST_ENTRIES: usize = 500;

/// A constraint of degree two in the coordinates.
struct Quadratic {
    residual: ExprId,
    /// The nonzero second derivatives, by the pair of coordinates.
    curvature: BTreeMap<(usize, usize), ExprId>,
    coordinates: BTreeSet<usize>,
}

/// `κ₀` of every such entry.
pub(super) fn steady_gram(calculus: &mut Calculus, equations: &Equations) -> Vec<Partial> {
    let Some(inverse_mass) = inverse_mass(calculus, equations) else { return Vec::new() };
    let constraints: Vec<Option<Quadratic>> =
        (0..equations.constraints.len()).map(|row| quadratic(calculus, equations, row)).collect();
    let slopes = |row: usize| equations.jacobian_q.iter().filter(move |partial| partial.row == row);
    let pairs: Vec<(usize, usize)> = (0..constraints.len())
        .flat_map(|row| (0..=row).map(move |col| (row, col)))
        .filter(|&(row, col)| constraints[row].is_some() && constraints[col].is_some())
        .filter(|&(row, col)| slopes(row).any(|a| slopes(col).any(|b| a.col == b.col)))
        .collect();
    if pairs.len() > MOST_ENTRIES {
        return Vec::new();
    }
    let mut steady = Vec::new();
    for (row, col) in pairs {
        let terms: Vec<ExprId> = slopes(row)
            .flat_map(|a| slopes(col).filter(|b| a.col == b.col).map(move |b| (a.col, a.value, b.value)))
            .map(|(k, a, b)| {
                let slopes = calculus.graph.mul(a, b);
                calculus.graph.mul(slopes, inverse_mass[k])
            })
            .collect();
        let entry =
            terms.into_iter().reduce(|sum, term| calculus.graph.add(sum, term)).expect("they share one");
        let value = constant_on(calculus, entry, &constraints);
        steady.extend(value.map(|value| Partial { row, col, value }));
    }
    steady
}

/// `1/M`, where the mass matrix is constant and diagonal.
fn inverse_mass(calculus: &mut Calculus, equations: &Equations) -> Option<Vec<ExprId>> {
    let masses = &equations.hessian_vv;
    let is_diagonal =
        masses.iter().all(|mass| mass.row == mass.col && calculus.graph.is_constant(mass.value));
    // In the order of the coordinates.
    let is_regular = masses.len() == equations.momentum.len();
    (is_diagonal && is_regular)
        .then(|| masses.iter().map(|mass| calculus.graph.reciprocal(mass.value)).collect())
}

fn quadratic(calculus: &mut Calculus, equations: &Equations, row: usize) -> Option<Quadratic> {
    let residual = equations.constraints[row];
    let is_quadratic = !calculus.graph.dependence(equations.curvature[row]).on_q;
    if !is_quadratic || calculus.graph.dependence(residual).on_t {
        return None;
    }
    let slopes: Vec<&Partial> = equations.jacobian_q.iter().filter(|slope| slope.row == row).collect();
    let coordinates: BTreeSet<usize> = slopes.iter().map(|slope| slope.col).collect();
    let mut curvature = BTreeMap::new();
    for slope in slopes {
        for &other in coordinates.range(..=slope.col) {
            let second = calculus.partial(slope.value, Symbol::Coordinate(other));
            curvature.extend(second.map(|second| ((slope.col, other), second)));
        }
    }
    Some(Quadratic { residual, curvature, coordinates })
}

/// `κ₀` of an `entry` that is a combination of the constraints but for that.
fn constant_on(calculus: &mut Calculus, entry: ExprId, constraints: &[Option<Quadratic>]) -> Option<ExprId> {
    let coordinate = |symbol: Symbol| match symbol {
        Symbol::Coordinate(i) => Some(i),
        _ => None,
    };
    let within: BTreeSet<usize> =
        calculus.graph.symbols(&[entry]).into_iter().filter_map(coordinate).collect();
    let candidates =
        constraints.iter().flatten().filter(|constraint| constraint.coordinates.is_subset(&within));
    let mut combination = calculus.graph.number(0.0);
    let mut known: Vec<(&Quadratic, ExprId)> = Vec::new();
    for (constraint, (a, b)) in with_own_products(candidates.collect()) {
        let mut second = second_derivative(calculus, entry, a, b);
        for (other, factor) in &known {
            if let Some(&curvature) = other.curvature.get(&(a, b)) {
                let part = calculus.graph.mul(*factor, curvature);
                second = calculus.graph.sub(second, part);
            }
        }
        let factor = calculus.graph.div(second, constraint.curvature[&(a, b)]);
        let part = calculus.graph.mul(factor, constraint.residual);
        combination = calculus.graph.add(combination, part);
        known.push((constraint, factor));
    }
    let rest = calculus.graph.sub(entry, combination);
    let at_origin = substitute(calculus.graph, &[rest], |graph, symbol| {
        matches!(symbol, Symbol::Coordinate(_)).then(|| graph.number(0.0))
    })[0];
    let change = calculus.graph.sub(rest, at_origin);
    vanishes(calculus.graph, change).then(|| calculus.simplified(at_origin))
}

/// The constraints in an order in which each has a product of two coordinates that none of those behind it has; those without one are left out.
fn with_own_products(mut candidates: Vec<&Quadratic>) -> Vec<(&Quadratic, (usize, usize))> {
    let mut ordered = Vec::new();
    loop {
        let own = candidates.iter().enumerate().find_map(|(index, candidate)| {
            let is_own = |product: &&(usize, usize)| {
                candidates.iter().filter(|other| other.curvature.contains_key(*product)).count() == 1
            };
            candidate.curvature.keys().find(is_own).map(|&product| (index, product))
        });
        let Some((index, product)) = own else { return ordered };
        ordered.push((candidates.remove(index), product));
    }
}

fn second_derivative(calculus: &mut Calculus, entry: ExprId, a: usize, b: usize) -> ExprId {
    let graph = &mut *calculus.graph;
    let second = partial(graph, entry, Symbol::Coordinate(a))
        .and_then(|first| partial(graph, first, Symbol::Coordinate(b)));
    second.unwrap_or_else(|| graph.number(0.0))
}
