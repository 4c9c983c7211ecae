//! Scenes of which not all constraints are independent, and that is meant.

use super::{ConstraintLabel, StepError};
use crate::array::Array;
use crate::linear::NullSpace;
use crate::mechanics::{CONSISTENCY, Mechanics, norm};
use crate::system::{HasFrequencies, MechanicalSystem, unfolded_scene_of_inner};

/// A few roundings of the configuration.
pub(super) const ROUND_OFF: f64 = 4.0 * f64::EPSILON;

/// The scene `S`, of whose constraints `R` are independent; made by
/// [`Simulation::constraints_of_rank`](super::Simulation::constraints_of_rank).
///
/// Where a run starts, the rank of `M^(−½) Gᵀ` has to be `R` ([`Mechanics::constraint_rank`]). From there on every system of equations is solved on
/// the null space of `R` independent constraints ([`NullSpace`]): positions are those of the scene without the others; of all multipliers that
/// give the constraint forces, those of least norm are taken, where a multiplier counts by the length of its force. A constraint that is
/// written twice so has half of the multiplier each time. A step that ends where constraints contradict each other is refused
/// ([`StepError::ContradictoryConstraints`]), and so is a configuration where fewer are independent ([`StepError::Singular`]).
///
/// With `R = m` it is a scene whose constraints are nearly dependent: the condition of the constraints is not squared, as it is elsewhere.
///
/// For `Evi` with any nodes and curves and compositions of it, and for the methods of [`baseline`](crate::baseline) without a constant mass; schemes
/// that take advantage of a constant mass matrix refuse it, and so does `Galerkin`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OfRank<S, const R: usize>(pub S);

impl<S: MechanicalSystem, const R: usize> MechanicalSystem for OfRank<S, R> {
    unfolded_scene_of_inner!();

    const STATED_RANK: Option<usize> = {
        assert!(R <= S::N_CONSTRAINTS, "no more constraints are independent than there are");
        assert!(R <= S::N_COORDINATES, "no more constraints are independent than there are coordinates");
        Some(R)
    };

    type KktFactors = NullSpace<S, R>;
    type DenseKktFactors = NullSpace<S, R>;
    type MassFactors = S::MassFactors;
    type GramFactors = S::GramFactors;
}

impl<S: HasFrequencies, const R: usize> HasFrequencies for OfRank<S, R> {
    #[inline]
    fn frequencies<T: crate::scalar::Scalar>(constants: &Self::PerConstant<T>) -> Self::PerCoordinate<T> {
        S::frequencies(constants)
    }
}

/// A constraint that a position is beside.
pub(super) struct Violation {
    pub(super) constraint: ConstraintLabel,
    pub(super) residual: f64,
    pub(super) allowed: f64,
}

/// Compares `φ_c` with `Σ |G_ci qᵢ|`, what a displacement of the size of the configuration would make of it. Round-off of the whole
/// configuration passes, also where the constraint's own coordinates are zero.
pub(super) fn violation<S: MechanicalSystem>(
    mechanics: &Mechanics<S>,
    t: f64,
    q: &S::PerCoordinate<f64>,
) -> Option<Violation> {
    let (residual, jacobian) = S::constraint_derivatives(&mechanics.constants, t, q);
    let gradient_norms = mechanics.gradient_norms(&jacobian);
    let mut allowed = S::PerConstraint::<f64>::from_fn(|c| ROUND_OFF * gradient_norms[c] * norm(q.as_ref()));
    for entry in S::STRUCTURE.jacobian.q {
        let slope = entry.value(mechanics.constants.as_ref(), jacobian.as_ref());
        allowed[entry.row] += CONSISTENCY * (slope * q[entry.col]).abs();
    }
    // Compared this way round, so that a NaN fails.
    let passes = |c: usize| residual[c].abs() <= allowed[c];
    let c = (0..S::N_CONSTRAINTS).find(|&c| !passes(c))?;
    let constraint = ConstraintLabel::Name(S::CONSTRAINTS[c]);
    Some(Violation { constraint, residual: residual[c], allowed: allowed[c] })
}

/// Refuses the end of a step beside constraints that were taken to follow from those that it was solved for.
#[inline(always)]
pub(super) fn check_dependent_constraints<S: MechanicalSystem>(
    mechanics: &Mechanics<S>,
    t: f64,
    q: &S::PerCoordinate<f64>,
) -> Result<(), StepError> {
    if const { S::STATED_RANK.is_some() }
        && let Some(Violation { constraint, residual, allowed }) = violation(mechanics, t, q)
    {
        return Err(StepError::ContradictoryConstraints { t, constraint, residual, allowed });
    }
    Ok(())
}
