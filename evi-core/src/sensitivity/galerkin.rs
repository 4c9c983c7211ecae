//! Derivatives of Galerkin steps: of all points at once.

use super::evaluation::Point;
use super::nodes::{NodeAction, OnNodes};
use super::parameters::Seeds;
use super::points::{PerPoint, Points as AlongPoints, StepDerivative, TakenStep, zero};
use super::{Backwards, DerivativeError, Differentiable, StateGradient, StateTangent};
use crate::array::Array;
use crate::integrator::{GalerkinStep, NewtonSolve, OneStep, Tally};
use crate::mechanics::{Arrival, BackStep, GalerkinAction, Mechanics, Points, State};
use crate::newton::NotConverged;
use crate::scheme::{NodalCurves, NodalTables};
use crate::system::MechanicalSystem;

impl<S: MechanicalSystem, T: NodalTables<K>, const K: usize> NodeAction<S, K> for GalerkinAction<S, T, K> {
    fn mechanics(&self) -> &Mechanics<S> {
        &self.mechanics
    }

    fn h(&self) -> f64 {
        Self::h(self)
    }

    fn n_nodes(&self) -> usize {
        K + 1
    }

    fn weight(&self, node: usize) -> f64 {
        self.nodes.weights[node]
    }

    fn node_time(&self, t: f64, node: usize) -> f64 {
        self.time(t, node)
    }

    fn point_time(&self, t: f64, point: usize) -> f64 {
        self.time(t, point)
    }

    fn node(
        &self,
        q: &S::PerCoordinate<f64>,
        differences: &PerPoint<S, K>,
        node: usize,
    ) -> (S::PerCoordinate<f64>, S::PerCoordinate<f64>) {
        let points = Points::<S, K> { differences: differences.clone(), ..Points::none() };
        let x = Array::from_fn(|i| if node == 0 { q[i] } else { q[i] + differences[node - 1][i] });
        (x, self.velocity(q, &points, node))
    }

    fn shares(&self, node: usize, point: usize, coordinate: usize) -> (f64, f64) {
        (if node == point { 1.0 } else { 0.0 }, self.rate(node, point, coordinate))
    }
}

/// The points as the equations of the step have them.
fn points<S: MechanicalSystem, const K: usize>(h: f64, step: &TakenStep<S, K>) -> Points<S, K> {
    let impulses = core::array::from_fn(|a| Array::from_fn(|c| h * step.impulses[a][c]));
    Points { differences: step.differences.clone(), impulses }
}

impl<S: MechanicalSystem, F: NodalCurves<S>, const K: usize> Differentiable<S> for GalerkinStep<S, F, K> {
    type Taken = TakenStep<S, K>;
    type Workspace = GalerkinWorkspace<S, K>;

    fn workspace(&self) -> Self::Workspace {
        let action = self.action();
        let back =
            if self.legendre().is_some() { BackStep::new(&action.mechanics, action.h()) } else { None };
        GalerkinWorkspace { newton: NewtonSolve::new(action), back }
    }

    fn advance_taking_notes(
        &mut self,
        _: &mut Self::Workspace,
        state: &mut State<S>,
        tally: &mut impl Tally,
    ) -> Result<TakenStep<S, K>, DerivativeError> {
        let start = state.clone();
        let mut end = state.clone();
        self.advance(&mut end, tally)?;
        let Some((Points { differences, impulses }, arriving)) = self.found(&start, &end) else {
            unreachable!("a step that was taken has found its points")
        };
        let h = self.action().h();
        let impulses = core::array::from_fn(|a| Array::from_fn(|c| impulses[a][c] / h));
        *state = end.clone();
        Ok(TakenStep { start, end, differences, impulses, arriving })
    }

    fn push_forward(
        &self,
        GalerkinWorkspace { newton, .. }: &mut Self::Workspace,
        taken: &TakenStep<S, K>,
        tangents: &mut [StateTangent<S>],
    ) -> Result<(), DerivativeError> {
        let (action, h) = (self.action(), self.action().h());
        let singular = |matrix| DerivativeError::Singular { t: taken.start.t, matrix };
        let mut factors = newton.factor(action, &taken.start, &points(h, taken)).map_err(singular)?;
        let action = OnNodes(action);
        let derivative = StepDerivative::new(&action, None, taken)?;
        for tangent in tangents {
            derivative.push_forward(tangent, |rows| {
                // The rows of the coordinates are those of the momenta times h.
                multiply_coordinates::<S>(rows, h);
                factors.solve(rows);
            });
        }
        Ok(())
    }

    fn pull_back(
        &self,
        GalerkinWorkspace { newton, back }: &mut Self::Workspace,
        taken: &TakenStep<S, K>,
        Backwards(seeds): &Backwards<'_, S>,
        gradient: &mut StateGradient<S>,
    ) -> Result<(), DerivativeError> {
        let (action, h) = (self.action(), self.action().h());
        let on_nodes = OnNodes(action);
        let derivative = StepDerivative::new(&on_nodes, self.legendre(), taken)?;
        let by_arriving = derivative.before_landing(seeds, gradient);
        if let Some(back) = back
            && pull_back_by_passes(back, (action, taken), &derivative, &by_arriving, seeds, gradient).is_ok()
        {
            return Ok(());
        }
        let singular = |matrix| DerivativeError::Singular { t: taken.start.t, matrix };
        let mut factors = newton.factor(action, &taken.start, &points(h, taken)).map_err(singular)?;
        derivative.pull_back_from(by_arriving, seeds, gradient, |rows| {
            factors.solve_transposed(rows);
            multiply_coordinates::<S>(rows, h);
        });
        Ok(())
    }
}

/// Moves a gradient from the landing of a step back to its start, by passes.
///
/// # Errors
/// [`NotConverged`] of steps that are too large for passes; the gradient has not changed then.
fn pull_back_by_passes<S: MechanicalSystem, T: NodalTables<K>, const K: usize>(
    back: &mut BackStep<S, K>,
    (action, taken): (&GalerkinAction<S, T, K>, &TakenStep<S, K>),
    derivative: &StepDerivative<'_, S, OnNodes<'_, GalerkinAction<S, T, K>>, K>,
    by_arriving: &S::PerCoordinate<f64>,
    seeds: &Seeds<S>,
    gradient: &mut StateGradient<S>,
) -> Result<(), NotConverged> {
    let TakenStep { start, end, differences, impulses, .. } = taken;
    let [first_weight, last_weight] = back.end_weights();
    let nothing = zero::<S>();
    // How the force at an end changes what is made of its impulse.
    let by_force = |state: &State<S>, weight: f64, by_impulse: &S::PerCoordinate<f64>| {
        let point = Point { t: state.t, q: &state.q, v: &state.v, inputs: &start.inputs };
        let of_force = Array::from_fn(|i| weight * by_impulse[i]);
        point.product(seeds, &action.mechanics, &of_force, &nothing).force
    };
    let of_end = by_force(end, last_weight, by_arriving);
    let by_point = Array::from_fn(|i| gradient.q[i] + of_end[i]);
    let arrival = Arrival { start, differences, impulses, by_point: &by_point, by_momentum: by_arriving };
    let departure = back.take(&arrival)?;
    let by_momentum = departure.by_impulse(0);
    let of_start = by_force(start, first_weight, &by_momentum);
    gradient.q = Array::from_fn(|i| departure.by_points[i] + of_start[i]);
    gradient.v = zero::<S>();
    derivative.add_start_curvature(seeds, &mut gradient.q, &by_momentum);
    if seeds.n_parameters > 0 || S::N_INPUTS > 0 {
        let last = |a: usize| if a + 1 < K { departure.by_impulse(a + 1) } else { by_arriving.clone() };
        let along = AlongPoints { first: by_momentum.clone(), others: core::array::from_fn(last) };
        let of_residual = core::array::from_fn(|a| departure.by_residual(a + 1));
        derivative.add_parameters(seeds, &along, &of_residual, gradient);
    }
    gradient.p = by_momentum;
    Ok(())
}

/// Storage for going back over steps by passes, and for Newton's iteration on the inner points of a step and the matrix of its equations.
pub struct GalerkinWorkspace<S: MechanicalSystem, const K: usize> {
    newton: NewtonSolve<S, K>,
    back: Option<BackStep<S, K>>,
}

fn multiply_coordinates<S: MechanicalSystem>(rows: &mut [S::PerUnknown<f64>], factor: f64) {
    for row in rows {
        for i in 0..S::N_COORDINATES {
            row[i] *= factor;
        }
    }
}
