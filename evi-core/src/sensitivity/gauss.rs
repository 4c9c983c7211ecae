//! Derivatives of Gauss steps: of the velocities at all nodes at once.
//!
//! With `Qᵢ = q₀ + h Σⱼ Aᵢⱼ Vⱼ`, `Pᵢ = ∂L/∂v(Qᵢ, Vᵢ)` and `Fᵢ = (∂L/∂q + f)(Qᵢ, Vᵢ)` a step solves
//!
//! ```text
//! Pᵢ − p₀ − h Σⱼ Aᵢⱼ Fⱼ = 0        q₁ = q₀ + h Σ bᵢ Vᵢ        p₁ = p₀ + h Σ bᵢ Fᵢ
//! ```

use super::evaluation::{Along, Point, along};
use super::landing::{Landing, Moved};
use super::{Backwards, DerivativeError, Differentiable, StateGradient, StateTangent};
use crate::array::Array;
use crate::integrator::{GaussNewton, GaussStep, OneStep, Tally};
use crate::mechanics::State;
use crate::system::MechanicalSystem;

/// A Gauss step that was taken.
pub struct TakenGaussStep<S: MechanicalSystem, const K: usize> {
    start: State<S>,
    end: State<S>,
    velocities: [S::PerCoordinate<f64>; K],
}

/// The matrix of the equations of a step.
pub struct GaussWorkspace<S: MechanicalSystem, const K: usize>(GaussNewton<S, K>);

impl<S: MechanicalSystem, const K: usize> GaussWorkspace<S, K> {
    /// `x + h Σⱼ Aᵢⱼ xⱼ`.
    fn at_node(
        &self,
        i: usize,
        x: &S::PerCoordinate<f64>,
        rates: &[S::PerCoordinate<f64>; K],
    ) -> S::PerCoordinate<f64> {
        Array::from_fn(|k| x[k] + (0..K).map(|j| self.0.stage(i, j) * rates[j][k]).sum::<f64>())
    }

    /// `h Σᵢ Aᵢⱼ xᵢ`.
    fn gathered(&self, j: usize, x: &[S::PerCoordinate<f64>; K]) -> S::PerCoordinate<f64> {
        Array::from_fn(|k| (0..K).map(|i| self.0.stage(i, j) * x[i][k]).sum())
    }

    /// `h Σᵢ bᵢ xᵢ`.
    fn weighted(&self, x: &[S::PerCoordinate<f64>; K]) -> S::PerCoordinate<f64> {
        Array::from_fn(|k| (0..K).map(|i| self.0.weight(i) * x[i][k]).sum())
    }

    /// The rates of `Fᵢ` and `Pᵢ` where the start moves by `tangent` and the velocities at `rates`.
    fn rates(
        &self,
        taken: &TakenGaussStep<S, K>,
        tangent: &StateTangent<S>,
        rates: &[S::PerCoordinate<f64>; K],
    ) -> [Along<S>; K] {
        core::array::from_fn(|i| {
            let q = self.at_node(i, &taken.start.q, &taken.velocities);
            let rate = self.at_node(i, &tangent.q, rates);
            let point = self.point(taken, i, &q);
            along::<S>(tangent, &point, &rate, &rates[i])
        })
    }

    fn point<'a>(
        &self,
        TakenGaussStep { start, velocities, .. }: &'a TakenGaussStep<S, K>,
        i: usize,
        q: &'a S::PerCoordinate<f64>,
    ) -> Point<'a, S> {
        Point { t: start.t + self.0.time(i), q, v: &velocities[i], inputs: &start.inputs }
    }
}

impl<S: MechanicalSystem, const K: usize> Differentiable<S> for GaussStep<S, K> {
    type Taken = TakenGaussStep<S, K>;
    type Workspace = GaussWorkspace<S, K>;

    fn workspace(&self) -> Self::Workspace {
        GaussWorkspace(GaussNewton::new(self.h()))
    }

    fn advance_taking_notes(
        &mut self,
        _: &mut Self::Workspace,
        state: &mut State<S>,
        tally: &mut impl Tally,
    ) -> Result<Self::Taken, DerivativeError> {
        let (start, mut end) = (state.clone(), state.clone());
        self.advance(&mut end, tally)?;
        *state = end.clone();
        Ok(TakenGaussStep { start, end, velocities: self.velocities_found() })
    }

    fn push_forward(
        &self,
        workspace: &mut Self::Workspace,
        taken: &Self::Taken,
        tangents: &mut [StateTangent<S>],
    ) -> Result<(), DerivativeError> {
        let singular = |matrix| DerivativeError::Singular { t: taken.start.t, matrix };
        workspace.0.factor(self.mechanics(), &taken.start, &taken.velocities).map_err(singular)?;
        let landing = Landing::new(self.mechanics(), None, &taken.end)?;
        for tangent in tangents {
            let none = core::array::from_fn(|_| Array::from_fn(|_| 0.0));
            let rates = workspace.rates(taken, tangent, &none);
            let forces = core::array::from_fn(|j| rates[j].force.clone());
            let mut rows: [S::PerCoordinate<f64>; K] = core::array::from_fn(|i| {
                let gain = workspace.at_node(i, &tangent.p, &forces);
                Array::from_fn(|k| gain[k] - rates[i].momentum[k])
            });
            workspace.0.solve_rows(&mut rows);
            let rates = workspace.rates(taken, tangent, &rows);
            let forces = core::array::from_fn(|j| rates[j].force.clone());
            let (way, gain) = (workspace.weighted(&rows), workspace.weighted(&forces));
            let q = Array::from_fn(|k| tangent.q[k] + way[k]);
            let arriving = Array::from_fn(|k| tangent.p[k] + gain[k]);
            let nothing = Array::from_fn(|_| 0.0);
            let Moved { v, p } = landing.forward(tangent.parts(), &nothing, &q, &arriving);
            (tangent.q, tangent.v, tangent.p) = (q, v, p);
        }
        Ok(())
    }

    fn pull_back(
        &self,
        workspace: &mut Self::Workspace,
        taken: &Self::Taken,
        Backwards(seeds): &Backwards<'_, S>,
        gradient: &mut StateGradient<S>,
    ) -> Result<(), DerivativeError> {
        let mechanics = self.mechanics();
        let singular = |matrix| DerivativeError::Singular { t: taken.start.t, matrix };
        workspace.0.factor(mechanics, &taken.start, &taken.velocities).map_err(singular)?;
        let nothing = Array::from_fn(|_| 0.0);
        let by_gain = Landing::new(mechanics, None, &taken.end)?.backward(seeds, &nothing, gradient);
        let positions: [S::PerCoordinate<f64>; K] =
            core::array::from_fn(|i| workspace.at_node(i, &taken.start.q, &taken.velocities));
        let zero = S::PerCoordinate::<f64>::from_fn(|_| 0.0);
        // Of q₁ and p₁ at fixed velocities and start.
        let products: [Along<S>; K] = core::array::from_fn(|i| {
            let of_force = Array::from_fn(|k| workspace.0.weight(i) * by_gain[k]);
            workspace.point(taken, i, &positions[i]).product(seeds, mechanics, &of_force, &zero)
        });
        let by_positions = core::array::from_fn(|i| products[i].force.clone());
        let mut rows: [S::PerCoordinate<f64>; K] = core::array::from_fn(|j| {
            let gathered = workspace.gathered(j, &by_positions);
            let weight = workspace.0.weight(j);
            Array::from_fn(|k| weight * gradient.q[k] + products[j].momentum[k] + gathered[k])
        });
        for by_position in &by_positions {
            for k in 0..S::N_COORDINATES {
                gradient.q[k] += by_position[k];
            }
        }
        workspace.0.solve_transposed_rows(&mut rows);
        gradient.p = by_gain.clone();
        gradient.v = zero;
        for i in 0..K {
            let point = workspace.point(taken, i, &positions[i]);
            let gathered = workspace.gathered(i, &rows);
            let of_momentum = Array::from_fn(|k| -rows[i][k]);
            let by_row = point.product(seeds, mechanics, &gathered, &of_momentum);
            for k in 0..S::N_COORDINATES {
                gradient.q[k] += by_row.force[k];
                gradient.p[k] += rows[i][k];
            }
            let of_force = Array::from_fn(|k| gathered[k] + workspace.0.weight(i) * by_gain[k]);
            point.add_parameters(seeds, &of_force, &of_momentum, gradient);
        }
        Ok(())
    }
}
