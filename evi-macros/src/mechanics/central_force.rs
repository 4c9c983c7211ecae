//! The one force of a scene, where it acts along a distance.
//!
//! In: [`Equations`]. Out: for `L = ½ vᵀM v + fᵀq − F(r)` with constant `M` and `f`, and a distance `r = √(Σ wₖ eₖ²)` of affine `eₖ`, that
//! distance, the force along it, and `f`; nothing for other scenes, and for those whose potential is quadratic in `q`.
//!
//! In one coordinate there is nothing to eliminate. Every square has a coordinate of its own, so that the `eₖ` are independent: `r` vanishes
//! exactly where its gradient times `r` does.

use std::collections::BTreeSet;

use super::squares::{Key, Square, Squares, affine_nodes};
use super::{Calculus, Equations};
use crate::expr::{Binary, ExprId, Graph, Node, Symbol, Unary, replace};

/// Distances that are tried, each in the time that the potential takes to be simplified. One force has few sums of squares.
const MOST_DISTANCES: usize = 4;

/// A force along a distance `r`, with a uniform one beside it.
pub(crate) struct CentralForce {
    /// `r²`.
    pub(crate) square: ExprId,
    /// `r ∂r/∂q`.
    pub(crate) radial: Vec<ExprId>,
    /// `½ ∂²r²/∂q²`, by rows, all of them constants.
    pub(crate) metric: Vec<ExprId>,
    /// `F'(r)`.
    pub(crate) force: ExprId,
    /// `F''(r)`.
    pub(crate) slope: ExprId,
    /// `f`.
    pub(crate) uniform: Vec<ExprId>,
}

/// A force along a distance, and the one beside it.
struct Along {
    force: ExprId,
    slope: ExprId,
    uniform: Vec<ExprId>,
}

impl CentralForce {
    /// `r²` and `r ∂r/∂q`.
    pub(crate) fn distance_roots(&self) -> Vec<ExprId> {
        std::iter::once(self.square).chain(self.radial.iter().copied()).collect()
    }

    /// Everything that is evaluated.
    pub(crate) fn roots(&self) -> Vec<ExprId> {
        let others = [self.force, self.slope].into_iter().chain(self.metric.iter().copied());
        self.distance_roots().into_iter().chain(others).chain(self.uniform.iter().copied()).collect()
    }
}

impl Calculus<'_> {
    /// The central force of a scene that has no other but a uniform one.
    pub(super) fn central_force(&mut self, equations: &Equations) -> Option<CentralForce> {
        let graph = &*self.graph;
        let is_zero = |&root: &ExprId| graph.as_number(root) == Some(0.0);
        let on = graph.dependence(equations.lagrangian);
        let has_constant_mass = equations.hessian_vv.iter().all(|entry| graph.is_constant(entry.value));
        let is_quadratic = equations.hessian_qq.iter().all(|entry| graph.is_constant(entry.value));
        let n = equations.force.len();
        let is_of_this_kind = n > 1
            && equations.constraints.is_empty()
            && equations.forces.values.is_empty()
            && equations.hessian_vq.is_empty()
            && equations.at_rest.momentum.iter().all(is_zero)
            && has_constant_mass
            && !(is_quadratic || on.on_t || on.on_inputs);
        if !is_of_this_kind {
            return None;
        }
        let at_rest = self.at_rest(&[equations.lagrangian])[0];
        let affine = affine_nodes(self.graph, at_rest);
        let squares_of = |graph: &Graph, id| Squares::of(graph, &affine, id, n);
        // The distance changes with every coordinate that the force changes with.
        let coupled: BTreeSet<Symbol> = equations
            .hessian_qq
            .iter()
            .flat_map(|entry| [entry.row, entry.col])
            .map(Symbol::Coordinate)
            .collect();
        let mut tried: Vec<Key> = Vec::new();
        // The largest sums first.
        for id in self.graph.reachable(&[at_rest], |id| affine.contains(&id)).into_iter().rev() {
            let Some(found) = squares_of(self.graph, id) else {
                continue;
            };
            let key = found.key(self.graph);
            let bases: Vec<ExprId> = found.squares.iter().map(|square| square.base).collect();
            if !self.graph.symbols(&bases).is_superset(&coupled) || tried.contains(&key) {
                continue;
            }
            let slopes = self.slopes(&found.squares, n);
            let is_distance =
                |graph: &Graph, id| squares_of(graph, id).filter(|found| found.key(graph) == key);
            if are_independent(self.graph, &slopes)
                && let Some(along) = self.along(at_rest, is_distance, n)
            {
                return Some(self.with_distance(along, &found.squares, &slopes));
            }
            tried.push(key);
            if tried.len() == MOST_DISTANCES {
                return None;
            }
        }
        None
    }

    /// `∂eₖ/∂qᵢ` where it does not vanish, by squares.
    fn slopes(&mut self, squares: &[Square], n: usize) -> Vec<Vec<Option<ExprId>>> {
        let of_base = |base| (0..n).map(|i| self.partial(base, Symbol::Coordinate(i))).collect();
        squares.iter().map(|square| square.base).map(of_base).collect()
    }

    /// The force along a distance, if with that as a variable of its own the Lagrangian at rest is the sum of an affine function of the coordinates
    /// and a function of the distance. `is_distance` takes nodes apart that are the distance squared but for constants.
    fn along(
        &mut self,
        at_rest: ExprId,
        is_distance: impl Fn(&Graph, ExprId) -> Option<Squares>,
        n: usize,
    ) -> Option<Along> {
        let in_distance = replace(self.graph, &[at_rest], |graph, id| distance_for(graph, id, &is_distance));
        let in_distance = self.simplified(in_distance[0]);
        let uniform: Vec<ExprId> =
            (0..n).map(|i| self.partial_or_zero(in_distance, Symbol::Coordinate(i))).collect();
        let potential = self.graph.neg(in_distance);
        let force = self.partial(potential, Symbol::Distance)?;
        let slope = self.partial_or_zero(force, Symbol::Distance);
        let is_coordinate = |symbol: &Symbol| matches!(symbol, Symbol::Coordinate(_));
        let is_apart = uniform.iter().all(|&force| self.graph.is_constant(force))
            && !self.graph.symbols(&[force, slope]).iter().any(is_coordinate);
        is_apart.then_some(Along { force, slope, uniform })
    }

    /// The force with its distance: `r² = Σ w e²`, `r ∂r/∂q = Σ w e ∂e/∂q` and `½ ∂²r²/∂q² = Σ w ∂e/∂q ∂e/∂q`, so that nothing is halved.
    fn with_distance(
        &mut self,
        Along { force, slope, uniform }: Along,
        squares: &[Square],
        slopes: &[Vec<Option<ExprId>>],
    ) -> CentralForce {
        let n = uniform.len();
        let square = self.weighted_sum(squares, |_, base| Some((base, base)));
        let radial = (0..n).map(|i| self.weighted_sum(squares, |k, base| Some((slopes[k][i]?, base))));
        let radial = radial.collect();
        let places = (0..n).flat_map(|row| (0..n).map(move |col| (row, col)));
        let metric = places
            .map(|(row, col)| self.weighted_sum(squares, |k, _| Some((slopes[k][row]?, slopes[k][col]?))))
            .collect();
        CentralForce { square, radial, metric, force, slope, uniform }
    }

    /// `Σ wₖ aₖ bₖ` over the squares for which `factors(k, eₖ)` are there.
    fn weighted_sum(
        &mut self,
        squares: &[Square],
        factors: impl Fn(usize, ExprId) -> Option<(ExprId, ExprId)>,
    ) -> ExprId {
        let mut sum = self.graph.number(0.0);
        for (k, &Square { weight, base }) in squares.iter().enumerate() {
            if let Some((a, b)) = factors(k, base) {
                let weight = self.graph.number(weight);
                let product = self.graph.mul(a, b);
                let term = self.graph.mul(weight, product);
                sum = self.graph.add(sum, term);
            }
        }
        self.simplified(sum)
    }
}

/// Whether every base has a coordinate, with a number as its slope, that no other one has.
fn are_independent(graph: &Graph, slopes: &[Vec<Option<ExprId>>]) -> bool {
    let has_number = |slope: Option<ExprId>| slope.is_some_and(|slope| graph.as_number(slope).is_some());
    let is_own = |k: usize, i: usize| {
        has_number(slopes[k][i])
            && slopes.iter().enumerate().all(|(other, slopes)| other == k || slopes[i].is_none())
    };
    (0..slopes.len()).all(|k| (0..slopes[k].len()).any(|i| is_own(k, i)))
}

/// The node in terms of the distance `r ≥ 0`, if it is `r²` but for constants, or a root or real power of `r²`.
fn distance_for(
    graph: &mut Graph,
    id: ExprId,
    is_distance: impl Fn(&Graph, ExprId) -> Option<Squares>,
) -> Option<ExprId> {
    let is_pure = |graph: &Graph, id| is_distance(graph, id).is_some_and(|squares| squares.is_pure());
    match graph.node(id) {
        Node::Unary(Unary::Sqrt, x) if is_pure(graph, x) => Some(graph.symbol(Symbol::Distance)),
        Node::Binary(Binary::Powf, x, exponent) if is_pure(graph, x) => {
            let (distance, two) = (graph.symbol(Symbol::Distance), graph.number(2.0));
            // As it stands: one that varies leaves coordinates beside the distance, and nothing is found.
            let doubled = graph.mul(two, exponent);
            Some(graph.binary(Binary::Powf, distance, doubled))
        }
        _ => {
            let Squares { added, subtracted, .. } = is_distance(graph, id)?;
            let distance = graph.symbol(Symbol::Distance);
            let square = graph.mul(distance, distance);
            let sum = added.into_iter().fold(square, |sum, constant| graph.add(sum, constant));
            Some(subtracted.into_iter().fold(sum, |sum, constant| graph.sub(sum, constant)))
        }
    }
}
