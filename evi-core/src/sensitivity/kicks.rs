//! Derivatives of the steps that are a kick, a drift and a kick.
//!
//! ```text
//! p½ = p₀ + k₀(q₀) − G₀ᵀℓ      q₁ = q₀ + D p½      φ(q₁) = 0      p⁻ = p½ + k₁(q₁)
//! ```
//!
//! Forward and back, only multipliers are solved for, with `G₁ D G₀ᵀ` and its transpose, as the step itself does it. What parameters make of such a step they make
//! of its action at fixed ends.

use super::evaluation::{ConstraintRates, moving};
use super::landing::{Landing, Moved};
use super::parameters::Seeds;
use super::points::{PointAction, Points, TakenStep, subtract_constraint_parameters};
use super::{Backwards, DerivativeError, StateGradient, StateTangent};
use crate::array::Array;
use crate::integrator::MultiplierStep;
use crate::linear::Factorization;
use crate::mechanics::{Coupling, KickDriftKick, Mechanics, State};
use crate::scalar::Tangent;
use crate::system::MechanicalSystem;

/// The step from `start` to `end`, which `step` has just taken.
pub(super) fn note_kicks<S: MechanicalSystem, F: KickDriftKick<S>>(
    step: &MultiplierStep<S, F>,
    mechanics: &Mechanics<S>,
    start: State<S>,
    end: &State<S>,
) -> TakenStep<S, 1> {
    let differences = [Array::from_fn(|i| end.q[i] - start.q[i])];
    let (free, impulse) = (step.free(), step.last_impulse());
    let kick = free.start_kick(mechanics, start.t, &start.q);
    let mut half_way = S::PerCoordinate::<f64>::from_fn(|i| start.p[i] + kick[i]);
    if S::N_CONSTRAINTS > 0 {
        let (_, jacobian) = S::constraint_derivatives(&mechanics.constants, start.t, &start.q);
        mechanics.subtract_constraint_force(&jacobian, &impulse, &mut half_way);
    }
    let kick = free.end_kick(mechanics, end.t, &end.q);
    let arriving = Array::from_fn(|i| half_way[i] + kick[i]);
    TakenStep { start, end: end.clone(), differences, impulses: [impulse], arriving }
}

/// Factors of `G D Gᵀ` with `G` at one end from the left and at the other from the right.
fn multipliers<S: MechanicalSystem, F: KickDriftKick<S>>(
    free: &F,
    mechanics: &Mechanics<S>,
    t: f64,
    (left, right): (&S::PerJacobianEntry<f64>, &S::PerJacobianEntry<f64>),
) -> Result<<F::Coupling as Coupling<S>>::GramFactors, DerivativeError> {
    let directions = mechanics.constraint_directions(right, free.drift());
    let gram = mechanics.gram_matrix::<F::Coupling>(left, &directions);
    Factorization::factor_of_any_size(&gram).map_err(|matrix| DerivativeError::Singular { t, matrix })
}

/// `G x`.
fn rate<S: MechanicalSystem>(
    mechanics: &Mechanics<S>,
    jacobian: &S::PerJacobianEntry<f64>,
    x: &S::PerCoordinate<f64>,
) -> S::PerConstraint<f64> {
    mechanics.reach(jacobian, x)
}

/// Moves vectors over the step; without an `action` parameters do not move.
pub(super) fn push_over_kicks<S: MechanicalSystem, F: KickDriftKick<S>>(
    free: &F,
    mechanics: &Mechanics<S>,
    action: Option<&impl PointAction<S, 1>>,
    step: &TakenStep<S, 1>,
    tangents: &mut [StateTangent<S>],
) -> Result<(), DerivativeError> {
    let TakenStep { start, end, impulses: [impulse], arriving, .. } = step;
    let landing = Landing::new(mechanics, Some(free.legendre()), end)?;
    let removed = landing.removed(arriving);
    let (_, at_start) = S::constraint_derivatives(&mechanics.constants, start.t, &start.q);
    let at_end = landing.jacobian();
    let multipliers = if S::N_CONSTRAINTS > 0 {
        Some(multipliers(free, mechanics, start.t, (at_end, &at_start))?)
    } else {
        None
    };
    for tangent in tangents {
        let kick = free.start_kick_product(mechanics, start.t, &start.q, &tangent.q);
        let mut half_way = S::PerCoordinate::<f64>::from_fn(|i| tangent.p[i] + kick[i]);
        let of_action = action
            .filter(|_| tangent.parameters_move)
            .map(|action| action.momentum_rates(step, tangent, &Points::zero()));
        if let Some(rates) = &of_action {
            for i in 0..S::N_COORDINATES {
                half_way[i] += rates.first[i];
            }
        }
        if let Some(multipliers) = &multipliers {
            let t = Tangent::still(start.t);
            let q = moving::<S>(&start.q, &tangent.q);
            ConstraintRates::<S>::new(&tangent.constants, t, &q).add_pull(-1.0, impulse, &mut half_way);
            let drift = free.drift().times(|i| half_way[i]);
            let free_end = S::PerCoordinate::<f64>::from_fn(|i| tangent.q[i] + drift[i]);
            let mut leaving = rate(mechanics, at_end, &free_end);
            if tangent.parameters_move {
                let q = moving::<S>(&end.q, &Array::from_fn(|_| 0.0));
                let rates = ConstraintRates::<S>::new(&tangent.constants, Tangent::still(end.t), &q);
                for c in 0..S::N_CONSTRAINTS {
                    leaving[c] += rates.residual[c];
                }
            }
            multipliers.solve(&mut leaving);
            mechanics.subtract_constraint_force(&at_start, &leaving, &mut half_way);
        }
        let drift = free.drift().times(|i| half_way[i]);
        let q = S::PerCoordinate::<f64>::from_fn(|i| tangent.q[i] + drift[i]);
        let mut arriving = free.end_kick_product(mechanics, end.t, &end.q, &q);
        for i in 0..S::N_COORDINATES {
            arriving[i] += half_way[i];
        }
        if let Some(rates) = &of_action {
            for i in 0..S::N_COORDINATES {
                arriving[i] += rates.others[0][i];
            }
        }
        let Moved { v, p } = landing.forward(tangent.parts(), &removed, &q, &arriving);
        (tangent.q, tangent.v, tangent.p) = (q, v, p);
    }
    Ok(())
}

/// Moves a gradient back over the step; without an `action` there are no derivatives by parameters.
pub(super) fn pull_over_kicks<S: MechanicalSystem, F: KickDriftKick<S>>(
    free: &F,
    mechanics: &Mechanics<S>,
    action: Option<&impl PointAction<S, 1>>,
    step: &TakenStep<S, 1>,
    Backwards(seeds): &Backwards<'_, S>,
    gradient: &mut StateGradient<S>,
) -> Result<(), DerivativeError> {
    let TakenStep { start, end, impulses: [impulse], arriving, .. } = step;
    let seeds: &Seeds<S> = seeds;
    let landing = Landing::new(mechanics, Some(free.legendre()), end)?;
    let removed = landing.removed(arriving);
    let by_arriving = landing.backward(seeds, &removed, gradient);
    let mut by_drift = free.end_kick_product(mechanics, end.t, &end.q, &by_arriving);
    for i in 0..S::N_COORDINATES {
        by_drift[i] += gradient.q[i];
    }
    let mut pull = S::PerConstraint::<f64>::from_fn(|_| 0.0);
    if S::N_CONSTRAINTS > 0 {
        let (_, at_start) = S::constraint_derivatives(&mechanics.constants, start.t, &start.q);
        let at_end = landing.jacobian();
        let multipliers = multipliers(free, mechanics, start.t, (&at_start, at_end))?;
        let drift = free.drift().times(|i| by_drift[i]);
        pull = rate(mechanics, &at_start, &Array::from_fn(|i| by_arriving[i] + drift[i]));
        multipliers.solve(&mut pull);
        mechanics.subtract_constraint_force(at_end, &pull, &mut by_drift);
    }
    let drift = free.drift().times(|i| by_drift[i]);
    let by_momentum = S::PerCoordinate::<f64>::from_fn(|i| by_arriving[i] + drift[i]);
    let kick = free.start_kick_product(mechanics, start.t, &start.q, &by_momentum);
    gradient.q = Array::from_fn(|i| by_drift[i] + kick[i]);
    gradient.v = Array::from_fn(|_| 0.0);
    if S::N_CONSTRAINTS > 0 {
        let q = moving::<S>(&start.q, &by_momentum);
        ConstraintRates::<S>::new(&seeds.still, Tangent::still(start.t), &q).add_pull(
            -1.0,
            impulse,
            &mut gradient.q,
        );
    }
    if let Some(action) = action.filter(|_| seeds.n_parameters > 0) {
        let along = Points { first: by_momentum.clone(), others: [by_arriving] };
        action.add_parameters(step, seeds, &along, gradient);
        let (of_momentum, of_residual) = ([by_momentum.clone()], [pull]);
        let times = |point: usize| if point == 0 { start.t } else { end.t };
        subtract_constraint_parameters(
            seeds,
            step,
            times,
            (&of_momentum, &of_residual),
            &mut gradient.parameters,
        );
    }
    gradient.p = by_momentum;
    Ok(())
}
