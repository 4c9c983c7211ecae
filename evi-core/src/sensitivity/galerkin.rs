//! Derivatives of Galerkin steps: of all points at once.

use super::nodes::{NodeAction, OnNodes};
use super::points::{PerPoint, PointAction, StepDerivative, TakenStep};
use super::{Backwards, DerivativeError, Differentiable, StateGradient, StateTangent};
use crate::array::Array;
use crate::integrator::{GalerkinStep, NewtonSolve, OneStep, Tally};
use crate::linear::largest_magnitude;
use crate::mechanics::{GalerkinAction, Mechanics, Points, State};
use crate::scheme::{NodalCurves, NodalTables};
use crate::system::MechanicalSystem;

/// Passes and Newton's iteration solve the same equations: their ends differ by round-off and by what the last pass left, far below this share of
/// the configuration. Another solution is a step away.
const SAME_END: f64 = 1e-7;

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

/// The points of the step from `start` to `end`, by Newton's iteration.
fn found_again<S: MechanicalSystem, T: NodalTables<K>, const K: usize>(
    action: &GalerkinAction<S, T, K>,
    newton: &mut NewtonSolve<S, K>,
    start: &State<S>,
    end: &State<S>,
) -> Result<Points<S, K>, DerivativeError> {
    let points = newton.solve(action, start, &mut ())?;
    let last = &points.differences[K - 1];
    let apart = largest_magnitude((0..S::N_COORDINATES).map(|i| start.q[i] + last[i] - end.q[i]));
    let reach = largest_magnitude(end.q.as_ref().iter().chain(last.as_ref()).copied());
    let is_same = apart <= SAME_END * reach;
    if is_same {
        Ok(points)
    } else {
        Err(DerivativeError::InnerPoints { t: start.t, distance: apart / reach })
    }
}

/// The points as the equations of the step have them.
fn points<S: MechanicalSystem, const K: usize>(h: f64, step: &TakenStep<S, K>) -> Points<S, K> {
    let impulses = core::array::from_fn(|a| Array::from_fn(|c| h * step.impulses[a][c]));
    Points { differences: step.differences.clone(), impulses }
}

impl<S: MechanicalSystem, F: NodalCurves<S>, const K: usize> Differentiable<S> for GalerkinStep<S, F, K> {
    type Taken = TakenStep<S, K>;
    type Workspace = NewtonWorkspace<S, K>;

    fn workspace(&self) -> Self::Workspace {
        NewtonWorkspace(NewtonSolve::new(self.action()))
    }

    fn advance_taking_notes(
        &mut self,
        NewtonWorkspace(newton): &mut Self::Workspace,
        state: &mut State<S>,
        tally: &mut impl Tally,
    ) -> Result<TakenStep<S, K>, DerivativeError> {
        let start = state.clone();
        let mut end = state.clone();
        self.advance(&mut end, tally)?;
        let action = self.action();
        let Points { differences, impulses } = match self.points_found(&start) {
            Some(points) => points,
            None => found_again(action, newton, &start, &end)?,
        };
        let h = action.h();
        let impulses = core::array::from_fn(|a| Array::from_fn(|c| impulses[a][c] / h));
        let [_, arriving] = OnNodes(action).end_momenta(&start, &differences);
        *state = end.clone();
        Ok(TakenStep { start, end, differences, impulses, arriving })
    }

    fn push_forward(
        &self,
        NewtonWorkspace(newton): &mut Self::Workspace,
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
        NewtonWorkspace(newton): &mut Self::Workspace,
        taken: &TakenStep<S, K>,
        Backwards(seeds): &Backwards<'_, S>,
        gradient: &mut StateGradient<S>,
    ) -> Result<(), DerivativeError> {
        let (action, h) = (self.action(), self.action().h());
        let singular = |matrix| DerivativeError::Singular { t: taken.start.t, matrix };
        let mut factors = newton.factor(action, &taken.start, &points(h, taken)).map_err(singular)?;
        StepDerivative::new(&OnNodes(action), None, taken)?.pull_back(seeds, gradient, |rows| {
            factors.solve_transposed(rows);
            multiply_coordinates::<S>(rows, h);
        });
        Ok(())
    }
}

/// Newton's iteration for the inner points of steps, and the matrix of their equations.
pub struct NewtonWorkspace<S: MechanicalSystem, const K: usize>(NewtonSolve<S, K>);

fn multiply_coordinates<S: MechanicalSystem>(rows: &mut [S::PerUnknown<f64>], factor: f64) {
    for row in rows {
        for i in 0..S::N_COORDINATES {
            row[i] *= factor;
        }
    }
}
