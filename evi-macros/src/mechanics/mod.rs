//! What a Lagrangian system needs to be integrated: the only stage that knows what a Lagrangian is.
//!
//! In: a [`Model`]. Out: [`Equations`], every derivative that the integrators evaluate, simplified; entries that vanish
//! structurally are absent.

mod central_force;
mod content;
mod squares;

pub(crate) use central_force::CentralForce;

use crate::differentiate::{partial, rate};
use crate::expr::{ExprId, Graph, Symbol, substitute};
use crate::model::{Forces, Model, Named};
use crate::simplify::Simplifier;

/// The Lagrangian, the constraints, and their derivatives.
pub(crate) struct Equations {
    pub(crate) lagrangian: ExprId,
    /// `∂L/∂q`.
    pub(crate) force: Vec<ExprId>,
    /// `∂L/∂v`.
    pub(crate) momentum: Vec<ExprId>,
    /// `∂²L/∂q²`, lower triangle.
    pub(crate) hessian_qq: Vec<Partial>,
    /// `∂²L/∂v∂q`.
    pub(crate) hessian_vq: Vec<Partial>,
    /// `∂²L/∂v²`, lower triangle.
    pub(crate) hessian_vv: Vec<Partial>,
    /// `∂²L/∂v∂t`, column 0.
    pub(crate) hessian_vt: Vec<Partial>,
    /// `φ`.
    pub(crate) constraints: Vec<ExprId>,
    /// The number that the derivatives of `φ` have in common: 2 where each of them is twice something, else 1.
    pub(crate) content: f64,
    /// `∂φ/∂q` over the content.
    pub(crate) jacobian_q: Vec<Partial>,
    /// `∂φ/∂t` over the content, column 0.
    pub(crate) jacobian_t: Vec<Partial>,
    /// `d²φ/dt²` without its acceleration term.
    pub(crate) curvature: Vec<ExprId>,
    /// What is no derivative of `L`.
    pub(crate) forces: ForceEquations,
    /// Frequency of every coordinate; empty where none has one.
    pub(crate) frequencies: Vec<ExprId>,
    /// Quantities to record.
    pub(crate) observables: Vec<ExprId>,
    /// `∂L/∂q` and `∂L/∂v` at `v = 0`; no kernel evaluates them.
    pub(crate) at_rest: AtRest,
    /// The one force that acts along a distance, where there is no other.
    pub(crate) central_force: Option<CentralForce>,
}

/// Forces beside those of `L`, and their derivatives; all empty where every force vanishes.
#[derive(Default)]
pub(crate) struct ForceEquations {
    /// `f = generalized forces − ∂D/∂v`, one per coordinate.
    pub(crate) values: Vec<ExprId>,
    /// `∂f/∂q`.
    pub(crate) by_q: Vec<Partial>,
    /// `∂f/∂v`.
    pub(crate) by_v: Vec<Partial>,
}

/// First derivatives of `L` at `v = 0`.
pub(crate) struct AtRest {
    pub(crate) force: Vec<ExprId>,
    pub(crate) momentum: Vec<ExprId>,
}

/// A derivative that does not vanish, and its place.
#[derive(Clone, Copy)]
pub(crate) struct Partial {
    pub(crate) row: usize,
    pub(crate) col: usize,
    pub(crate) value: ExprId,
}

/// Differentiates the model's equations.
pub(crate) fn differentiate_equations(graph: &mut Graph, model: &Model) -> Equations {
    let n = model.coordinates.len();
    let mut calculus = Calculus { graph, simplifier: Simplifier::default() };
    let lagrangian = calculus.simplified(model.lagrangian);
    let force: Vec<ExprId> =
        (0..n).map(|i| calculus.partial_or_zero(lagrangian, Symbol::Coordinate(i))).collect();
    let momentum: Vec<ExprId> =
        (0..n).map(|i| calculus.partial_or_zero(lagrangian, Symbol::Velocity(i))).collect();
    let constraints: Vec<ExprId> =
        model.constraints.iter().map(|constraint| calculus.simplified(constraint.root)).collect();
    let mut equations = Equations {
        hessian_qq: calculus.jacobian(&force, n, Symbol::Coordinate, is_lower),
        hessian_vq: calculus.jacobian(&momentum, n, Symbol::Coordinate, |_, _| true),
        hessian_vv: calculus.jacobian(&momentum, n, Symbol::Velocity, is_lower),
        hessian_vt: calculus.jacobian(&momentum, 1, |_| Symbol::Time, |_, _| true),
        content: 1.0,
        jacobian_q: calculus.jacobian(&constraints, n, Symbol::Coordinate, |_, _| true),
        jacobian_t: calculus.jacobian(&constraints, 1, |_| Symbol::Time, |_, _| true),
        curvature: constraints.iter().map(|&residual| calculus.second_rate(residual)).collect(),
        lagrangian,
        force,
        momentum,
        constraints,
        forces: ForceEquations::default(),
        frequencies: Vec::new(),
        observables: Vec::new(),
        at_rest: AtRest { force: Vec::new(), momentum: Vec::new() },
        central_force: None,
    };
    if let Some([by_q, by_t]) =
        content::halves(calculus.graph, [&equations.jacobian_q, &equations.jacobian_t])
    {
        (equations.content, equations.jacobian_q, equations.jacobian_t) = (2.0, by_q, by_t);
    }
    equations.forces = calculus.forces(&model.forces, n);
    equations.frequencies = calculus.frequencies(&model.frequencies, n);
    equations.observables =
        model.observables.iter().map(|observed| calculus.simplified(observed.root)).collect();
    // Last: nodes that are read for the structure only do not change the order of those that are computed.
    equations.at_rest =
        AtRest { force: calculus.at_rest(&equations.force), momentum: calculus.at_rest(&equations.momentum) };
    equations
}

/// Looks for a central force, of whose distance whole scenes can take advantage.
pub(crate) fn find_central_force(graph: &mut Graph, equations: &mut Equations) {
    let mut calculus = Calculus { graph, simplifier: Simplifier::default() };
    equations.central_force = calculus.central_force(equations);
}

fn is_lower(row: usize, col: usize) -> bool {
    row >= col
}

/// Differentiation followed by simplification.
struct Calculus<'a> {
    graph: &'a mut Graph,
    simplifier: Simplifier,
}

impl Calculus<'_> {
    fn simplified(&mut self, root: ExprId) -> ExprId {
        self.simplifier.simplify(self.graph, root)
    }

    /// `∂ root / ∂ symbol`, or `None` if it vanishes.
    fn partial(&mut self, root: ExprId, symbol: Symbol) -> Option<ExprId> {
        let derivative = partial(self.graph, root, symbol)?;
        let simplified = self.simplified(derivative);
        (self.graph.as_number(simplified) != Some(0.0)).then_some(simplified)
    }

    fn partial_or_zero(&mut self, root: ExprId, symbol: Symbol) -> ExprId {
        self.partial(root, symbol).unwrap_or_else(|| self.graph.number(0.0))
    }

    /// The nonzero derivatives of `rows` by `n_columns` symbols, at the places where `wanted(row, col)`.
    fn jacobian(
        &mut self,
        rows: &[ExprId],
        n_columns: usize,
        column: impl Fn(usize) -> Symbol,
        wanted: impl Fn(usize, usize) -> bool,
    ) -> Vec<Partial> {
        let mut partials = Vec::new();
        for (row, &root) in rows.iter().enumerate() {
            for col in (0..n_columns).filter(|&col| wanted(row, col)) {
                partials.extend(self.partial(root, column(col)).map(|value| Partial { row, col, value }));
            }
        }
        partials
    }

    /// The sum of the generalized forces and that of the dissipation, with its derivatives.
    fn forces(&mut self, forces: &Forces, n: usize) -> ForceEquations {
        let mut values: Vec<Option<ExprId>> = vec![None; n];
        for (i, force) in &forces.generalized {
            values[*i] = Some(force.root);
        }
        if let Some((_, dissipation)) = forces.dissipation {
            for (i, value) in values.iter_mut().enumerate() {
                if let Some(slope) = partial(self.graph, dissipation, Symbol::Velocity(i)) {
                    *value = Some(match *value {
                        Some(force) => self.graph.sub(force, slope),
                        None => self.graph.neg(slope),
                    });
                }
            }
        }
        let mut nonzero = |value: ExprId| {
            let value = self.simplified(value);
            (self.graph.as_number(value) != Some(0.0)).then_some(value)
        };
        let values: Vec<Option<ExprId>> =
            values.into_iter().map(|value| value.and_then(&mut nonzero)).collect();
        if values.iter().all(Option::is_none) {
            return ForceEquations::default();
        }
        let zero = self.graph.number(0.0);
        let values: Vec<ExprId> = values.into_iter().map(|value| value.unwrap_or(zero)).collect();
        ForceEquations {
            by_q: self.jacobian(&values, n, Symbol::Coordinate, |_, _| true),
            by_v: self.jacobian(&values, n, Symbol::Velocity, |_, _| true),
            values,
        }
    }

    /// One frequency per coordinate, zero where none is given; empty if all are missing.
    fn frequencies(&mut self, frequencies: &[(usize, Named)], n: usize) -> Vec<ExprId> {
        if frequencies.is_empty() {
            return Vec::new();
        }
        let mut values = vec![self.graph.number(0.0); n];
        for (i, frequency) in frequencies {
            values[*i] = self.simplified(frequency.root);
        }
        values
    }

    /// The roots at `v = 0`.
    fn at_rest(&mut self, roots: &[ExprId]) -> Vec<ExprId> {
        let roots = substitute(self.graph, roots, |graph, symbol| {
            matches!(symbol, Symbol::Velocity(_)).then(|| graph.number(0.0))
        });
        roots.into_iter().map(|root| self.simplified(root)).collect()
    }

    /// `d² root / dt²` along a motion without acceleration: `vᵀ φ_qq v + 2 φ_qt v + φ_tt`.
    fn second_rate(&mut self, root: ExprId) -> ExprId {
        let second = rate(self.graph, root)
            .map(|first| self.simplified(first))
            .and_then(|first| rate(self.graph, first))
            .map(|second| self.simplified(second));
        second.unwrap_or_else(|| self.graph.number(0.0))
    }
}
