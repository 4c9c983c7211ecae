//! Whether the constraints of a start have the rank that its scene needs.

use super::of_rank::violation;
use super::{ConstraintLabel, StartError};
use crate::mechanics::{ConstraintRank, Mechanics, ProjectionError};
use crate::system::MechanicalSystem;

/// Refuses constraints whose rank at a configuration is not that of the scene: all, or what it states.
pub(super) fn check_rank<S: MechanicalSystem>(
    mechanics: &Mechanics<S>,
    t: f64,
    q: &S::PerCoordinate<f64>,
) -> Result<(), StartError> {
    // A single constraint is independent unless its gradient vanishes, which its solver sees.
    if S::N_CONSTRAINTS <= 1 {
        return Ok(());
    }
    refusal(&mechanics.constraint_rank(t, q)).map_or(Ok(()), Err)
}

#[cold]
fn refusal<S: MechanicalSystem>(found: &ConstraintRank<S>) -> Option<StartError> {
    let (smallest_kept, largest_dropped) = found.gap();
    let (rank, constraints, dependent) = (found.rank(), S::N_CONSTRAINTS, found.dependent());
    match S::STATED_RANK {
        // Nothing follows from the others: the solver says what is singular.
        None if found.lacks_gradient => None,
        None if rank < constraints => Some(StartError::DependentConstraints {
            rank,
            constraints,
            dependent,
            smallest_kept,
            largest_dropped,
        }),
        Some(stated) if stated != rank => {
            Some(StartError::Rank { stated, rank, dependent, smallest_kept, largest_dropped })
        }
        None if !found.is_sound() => Some(StartError::NearlyDependentConstraints {
            constraint: ConstraintLabel::Name(S::CONSTRAINTS[found.most_dependent()]),
            rank,
            smallest: smallest_kept,
        }),
        _ => None,
    }
}

/// The error of a start that cannot be projected: that its constraints are dependent, if they are.
#[cold]
pub(super) fn explained<S: MechanicalSystem>(
    cause: ProjectionError,
    mechanics: &Mechanics<S>,
    t: f64,
    q: &S::PerCoordinate<f64>,
) -> StartError {
    if S::N_CONSTRAINTS > 1 && matches!(cause, ProjectionError::Singular(_)) {
        return refusal(&mechanics.constraint_rank(t, q)).unwrap_or(StartError::Projection(cause));
    }
    StartError::Projection(cause)
}

/// Refuses a position on the constraints that a stated rank counts as independent, and beside another one: there is none on all of them.
pub(super) fn check_agreement<S: MechanicalSystem>(
    mechanics: &Mechanics<S>,
    t: f64,
    q: &S::PerCoordinate<f64>,
) -> Result<(), StartError> {
    match violation(mechanics, t, q) {
        Some(violation) if S::STATED_RANK.is_some() => {
            let (constraint, residual, allowed) =
                (violation.constraint, violation.residual, violation.allowed);
            Err(StartError::ContradictoryConstraints { constraint, residual, allowed })
        }
        _ => Ok(()),
    }
}
