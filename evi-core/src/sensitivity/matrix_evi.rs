//! Derivatives of the members that integrate a quadratic part of the Lagrangian exactly.

use super::evi::{noted, pull_back, push_forward};
use super::kicks::{note_kicks, pull_over_kicks, push_over_kicks};
use super::parameters::Seeds;
use super::points::{PerPoint, PointAction, Points, TakenStep};
use super::{Backwards, DerivativeError, Differentiable, StateGradient, StateTangent};
use crate::integrator::{Form, MatrixEviStep, OneStep, Tally};
use crate::mechanics::{ImplicitStep, MatrixAction, Mechanics, State, StepStart};
use crate::system::MechanicalSystem;

impl<S: MechanicalSystem, const K: usize> PointAction<S, 1> for MatrixAction<S, K> {
    fn scene(&self) -> &Mechanics<S> {
        &self.mechanics
    }

    fn point_time(&self, t: f64, point: usize) -> f64 {
        if point == 0 { t } else { t + self.h() }
    }

    fn end_momenta(&self, start: &State<S>, differences: &PerPoint<S, 1>) -> [S::PerCoordinate<f64>; 2] {
        let at = StepStart::new(&self.mechanics, start.t, &start.q, &start.p, &start.inputs);
        Self::end_momenta(self, &at, &differences[0])
    }

    fn momentum_rates(
        &self,
        step: &TakenStep<S, 1>,
        _tangent: &StateTangent<S>,
        moved: &Points<S, 1>,
    ) -> Points<S, 1> {
        self.product(step, moved)
    }

    fn products(&self, step: &TakenStep<S, 1>, _seeds: &Seeds<S>, along: &Points<S, 1>) -> Points<S, 1> {
        self.product(step, along)
    }

    /// There are none: its tables follow the parameters, which are refused, and its scenes have no inputs.
    fn add_parameters(
        &self,
        _step: &TakenStep<S, 1>,
        _seeds: &Seeds<S>,
        _along: &Points<S, 1>,
        _gradient: &mut StateGradient<S>,
    ) {
    }
}

impl<S: MechanicalSystem, const K: usize> MatrixAction<S, K> {
    /// The second derivative of the action is a symmetric matrix: its product is both.
    fn product(&self, step: &TakenStep<S, 1>, along: &Points<S, 1>) -> Points<S, 1> {
        let TakenStep { start, differences: [difference], .. } = step;
        let ends = [along.get(0), along.get(1)];
        let [first, last] = self.second_derivative_product(start.t, &start.q, difference, ends);
        Points { first, others: [last] }
    }

    fn check_matrix(&self) -> Result<(), DerivativeError> {
        if self.has_exact_matrix() {
            return Ok(());
        }
        let requirement = "constraints that are quadratic, or the trapezoidal rule";
        Err(DerivativeError::Unsupported {
            scheme: "a linearisation that is sampled between the ends",
            requirement,
        })
    }
}

impl<S: MechanicalSystem, const K: usize> Differentiable<S> for MatrixEviStep<S, K> {
    type Taken = TakenStep<S, 1>;
    type Workspace = ();

    fn check_parameters(&self) -> Result<(), DerivativeError> {
        let requirement = "a scheme whose tables do not depend on the mass matrix";
        Err(DerivativeError::Parameters { scheme: "a matrix frequency", requirement })
    }

    fn workspace(&self) {}

    fn advance_taking_notes(
        &mut self,
        (): &mut (),
        state: &mut State<S>,
        tally: &mut impl Tally,
    ) -> Result<TakenStep<S, 1>, DerivativeError> {
        let (start, mut end) = (state.clone(), state.clone());
        self.advance(&mut end, tally)?;
        let taken = match self.form() {
            Form::Impulse { step, .. } => note_kicks(step, self.mechanics(), start, &end),
            Form::General(action) => {
                action.check_matrix()?;
                noted(action, None, start, &end)?
            }
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
        let no_action = None::<&MatrixAction<S, K>>;
        match self.form() {
            Form::Impulse { step, .. } => {
                push_over_kicks(step.free(), self.mechanics(), no_action, taken, tangents)
            }
            Form::General(action) => push_forward(action, action, None, taken, tangents),
        }
    }

    fn pull_back(
        &self,
        (): &mut (),
        taken: &TakenStep<S, 1>,
        backwards: &Backwards<'_, S>,
        gradient: &mut StateGradient<S>,
    ) -> Result<(), DerivativeError> {
        let no_action = None::<&MatrixAction<S, K>>;
        match self.form() {
            Form::Impulse { step, .. } => {
                pull_over_kicks(step.free(), self.mechanics(), no_action, taken, backwards, gradient)
            }
            Form::General(action) => pull_back(action, action, None, taken, backwards, gradient),
        }
    }
}
