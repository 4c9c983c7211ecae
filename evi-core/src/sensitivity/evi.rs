//! Derivatives of exponential variational integrators.

use super::kicks::{note_kicks, pull_over_kicks, push_over_kicks};
use super::landing::Landing;
use super::nodes::{NodeAction, OnNodes};
use super::points::{PerPoint, PointAction, StepDerivative, TakenStep};
use super::{Backwards, DerivativeError, Differentiable, StateGradient, StateTangent};
use crate::array::Array;
use crate::integrator::{EviStep, OneStep, Tally};
use crate::linear::Kkt;
use crate::mechanics::{ConstantLegendre, DiscreteLagrangian, ImplicitStep, Mechanics, State, StepStart};
use crate::scheme::{Interpolant, InterpolationTable, interpolate};
use crate::system::MechanicalSystem;

impl<S: MechanicalSystem, T: InterpolationTable, const K: usize> NodeAction<S, 1>
    for DiscreteLagrangian<S, T, K>
{
    fn mechanics(&self) -> &Mechanics<S> {
        &self.mechanics
    }

    fn h(&self) -> f64 {
        ImplicitStep::h(self)
    }

    fn n_nodes(&self) -> usize {
        K
    }

    #[inline]
    fn weight(&self, node: usize) -> f64 {
        self.quadrature().weights()[node]
    }

    #[inline]
    fn node_time(&self, t: f64, node: usize) -> f64 {
        t + (0.5 + self.quadrature().offsets()[node]) * ImplicitStep::h(self)
    }

    #[inline]
    fn point_time(&self, t: f64, point: usize) -> f64 {
        if point == 0 { t } else { t + ImplicitStep::h(self) }
    }

    #[inline]
    fn node(
        &self,
        q: &S::PerCoordinate<f64>,
        differences: &PerPoint<S, 1>,
        node: usize,
    ) -> (S::PerCoordinate<f64>, S::PerCoordinate<f64>) {
        interpolate::<S>(self.table(), node, q, &differences[0], 1.0 / ImplicitStep::h(self))
    }

    #[inline]
    fn shares(&self, node: usize, point: usize, coordinate: usize) -> (f64, f64) {
        let c = self.coefficients(node, coordinate);
        if point == 0 { (c.start(), c.start_rate()) } else { (c.end(), c.end_rate()) }
    }
}

/// The block `A` of a step, without constraints, and the entries of their Jacobians at its start and its end.
struct Matrix<S: MechanicalSystem> {
    block: Kkt<S>,
    at_start: S::PerJacobianEntry<f64>,
    at_end: S::PerJacobianEntry<f64>,
}

impl<S: MechanicalSystem> Matrix<S> {
    fn new(
        action: &impl ImplicitStep<S>,
        TakenStep { start, end, differences, .. }: &TakenStep<S, 1>,
    ) -> Self {
        let mechanics = action.mechanics();
        let at = StepStart::new(mechanics, start.t, &start.q, &start.p, &start.inputs);
        let mut block = Kkt::zero();
        action.node_kick(&at, &differences[0], Some(&mut block));
        let (_, at_end) = S::constraint_derivatives(&mechanics.constants, end.t, &end.q);
        Self { block, at_start: at.jacobian, at_end }
    }

    /// `K = [A G₀ᵀ; G₁ 0]`.
    fn forward(mut self, constants: &S::PerConstant<f64>) -> Kkt<S> {
        self.block.set_upper_jacobian(constants, &self.at_start);
        self.block.set_lower_jacobian(constants, &self.at_end);
        self.block
    }

    /// `Kᵀ = [Aᵀ G₁ᵀ; G₀ 0]`: a matrix of the same pattern.
    fn backward(mut self, constants: &S::PerConstant<f64>) -> Kkt<S> {
        self.block.transpose_block();
        self.block.set_upper_jacobian(constants, &self.at_end);
        self.block.set_lower_jacobian(constants, &self.at_start);
        self.block
    }
}

/// The step from `start` to `end`, with the impulse of the constraints at its start.
pub(super) fn noted<S: MechanicalSystem>(
    action: &impl PointAction<S, 1>,
    legendre: Option<&ConstantLegendre<S>>,
    start: State<S>,
    end: &State<S>,
) -> Result<TakenStep<S, 1>, DerivativeError> {
    let differences = [Array::from_fn(|i| end.q[i] - start.q[i])];
    let [departing, arriving] = action.end_momenta(&start, &differences);
    let mut impulses = [Array::from_fn(|_| 0.0)];
    if S::N_CONSTRAINTS > 0 {
        let balance = Array::from_fn(|i| start.p[i] + departing[i]);
        impulses = [Landing::new(action.scene(), legendre, &start)?.impulse(&balance)];
    }
    Ok(TakenStep { start, end: end.clone(), differences, impulses, arriving })
}

/// Moves vectors over a step whose points are its ends.
pub(super) fn push_forward<S: MechanicalSystem, E: ImplicitStep<S>>(
    equations: &E,
    action: &impl PointAction<S, 1>,
    legendre: Option<&ConstantLegendre<S>>,
    taken: &TakenStep<S, 1>,
    tangents: &mut [StateTangent<S>],
) -> Result<(), DerivativeError> {
    let kkt = Matrix::new(equations, taken).forward(&action.scene().constants);
    let factors = E::factor(kkt).map_err(|matrix| DerivativeError::Singular { t: taken.start.t, matrix })?;
    let derivative = StepDerivative::new(action, legendre, taken)?;
    for tangent in tangents {
        derivative.push_forward(tangent, |[rows]| factors.solve(rows));
    }
    Ok(())
}

/// Moves a gradient back over a step whose points are its ends.
pub(super) fn pull_back<S: MechanicalSystem, E: ImplicitStep<S>>(
    equations: &E,
    action: &impl PointAction<S, 1>,
    legendre: Option<&ConstantLegendre<S>>,
    taken: &TakenStep<S, 1>,
    Backwards(seeds): &Backwards<'_, S>,
    gradient: &mut StateGradient<S>,
) -> Result<(), DerivativeError> {
    let kkt = Matrix::new(equations, taken).backward(&action.scene().constants);
    let factors = E::factor(kkt).map_err(|matrix| DerivativeError::Singular { t: taken.start.t, matrix })?;
    StepDerivative::new(action, legendre, taken)?.pull_back(seeds, gradient, |[rows]| factors.solve(rows));
    Ok(())
}

impl<S: MechanicalSystem, F: Interpolant<S>, const K: usize> Differentiable<S> for EviStep<S, F, K> {
    type Taken = TakenStep<S, 1>;
    type Workspace = ();

    fn check_parameters(&self) -> Result<(), DerivativeError> {
        if F::FOLLOWS_PARAMETERS {
            let requirement = "frequencies that are given in the scheme";
            return Err(DerivativeError::Parameters { scheme: "a frequency of the scene", requirement });
        }
        Ok(())
    }

    fn workspace(&self) {}

    fn advance_taking_notes(
        &mut self,
        (): &mut (),
        state: &mut State<S>,
        tally: &mut impl Tally,
    ) -> Result<TakenStep<S, 1>, DerivativeError> {
        let mut end = state.clone();
        self.advance(&mut end, tally)?;
        let start = state.clone();
        let taken = if let Some(folded) = self.folded() {
            note_kicks(folded, OneStep::mechanics(self), start, &end)
        } else if let Some(leapfrog) = self.leapfrog() {
            note_kicks(leapfrog, OneStep::mechanics(self), start, &end)
        } else {
            noted(&OnNodes(self.action()), self.legendre(), start, &end)?
        };
        *state = end;
        Ok(taken)
    }

    fn push_forward(
        &self,
        (): &mut (),
        taken: &TakenStep<S, 1>,
        tangents: &mut [StateTangent<S>],
    ) -> Result<(), DerivativeError> {
        let (action, mechanics) = (self.action(), OneStep::mechanics(self));
        if let Some(folded) = self.folded() {
            push_over_kicks(folded.free(), mechanics, Some(&OnNodes(action)), taken, tangents)
        } else if let Some(leapfrog) = self.leapfrog() {
            push_over_kicks(leapfrog.free(), mechanics, Some(&OnNodes(action)), taken, tangents)
        } else {
            push_forward(action, &OnNodes(action), self.legendre(), taken, tangents)
        }
    }

    fn pull_back(
        &self,
        (): &mut (),
        taken: &TakenStep<S, 1>,
        backwards: &Backwards<'_, S>,
        gradient: &mut StateGradient<S>,
    ) -> Result<(), DerivativeError> {
        let (action, mechanics) = (self.action(), OneStep::mechanics(self));
        if let Some(folded) = self.folded() {
            pull_over_kicks(folded.free(), mechanics, Some(&OnNodes(action)), taken, backwards, gradient)
        } else if let Some(leapfrog) = self.leapfrog() {
            pull_over_kicks(leapfrog.free(), mechanics, Some(&OnNodes(action)), taken, backwards, gradient)
        } else {
            pull_back(action, &OnNodes(action), self.legendre(), taken, backwards, gradient)
        }
    }
}
