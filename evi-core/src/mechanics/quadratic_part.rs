//! The quadratic part of a Lagrangian, which a step integrates exactly, and the rest.

use super::coordinate_matrix::times;
use super::{Linearisation, Mechanics, Modes, Rows};
use crate::array::Array;
use crate::scheme::{LinearisationError, ModeFlow, SchemeError};
use crate::system::MechanicalSystem;

/// How a Lagrangian with constant mass matrix is split, with constant `Ω`, `q_ref` and `λ*`:
///
/// ```text
/// L − λ*ᵀφ = ½ vᵀMv − ½ (q − q_ref)ᵀ Ω (q − q_ref) − U(t, q)
/// ```
///
/// `λ*ᵀφ` vanishes on the constraints: the motion is the same with it, its multipliers are less by `λ*`. What it changes is the split:
/// the curvature of the constraints becomes a part of `Ω`.
pub struct QuadraticPart<S: MechanicalSystem> {
    pub(crate) stiffness: Rows<S>,
    pub(crate) reference: S::PerCoordinate<f64>,
    pub(crate) multipliers: S::PerConstraint<f64>,
    /// `Σ λᵢ* (φᵢ)_qq` at the reference.
    curvature: Rows<S>,
}

impl<S: MechanicalSystem> QuadraticPart<S> {
    /// With the stiffness `Ω` about `reference`, and no multipliers.
    ///
    /// # Errors
    /// [`SchemeError`] for a stiffness that is not symmetric, and numbers that are not finite.
    pub fn new(
        stiffness: S::PerCoordinate<S::PerCoordinate<f64>>,
        reference: S::PerCoordinate<f64>,
    ) -> Result<Self, SchemeError> {
        for row in 0..S::N_COORDINATES {
            for col in 0..=row {
                let (value, mirrored) = (stiffness[row][col], stiffness[col][row]);
                // Equality of bits: a matrix that is symmetric but for rounding has been given by mistake.
                if !(value.is_finite() && value == mirrored) {
                    return Err(SchemeError::Stiffness { row, col, value, mirrored });
                }
            }
        }
        if let Some(coordinate) = reference.as_ref().iter().position(|value| !value.is_finite()) {
            return Err(SchemeError::Reference { coordinate, value: reference[coordinate] });
        }
        Ok(Self {
            stiffness,
            reference,
            multipliers: Array::from_fn(|_| 0.0),
            curvature: Array::from_fn(|_| Array::from_fn(|_| 0.0)),
        })
    }

    /// Calls `see` for every number of the split.
    pub(crate) fn for_each_number(&self, mut see: impl FnMut(f64)) {
        for i in 0..S::N_COORDINATES {
            see(self.reference[i]);
            (0..S::N_COORDINATES).for_each(|j| see(self.stiffness[i][j]));
        }
        (0..S::N_CONSTRAINTS).for_each(|c| see(self.multipliers[c]));
    }

    /// With stiffness, reference and multipliers of a linearisation.
    pub fn of(mechanics: &Mechanics<S>, linearisation: &Linearisation<S>) -> Self {
        let mut curvature: Rows<S> = Array::from_fn(|_| Array::from_fn(|_| 0.0));
        let (q, multipliers) = (linearisation.configuration(), linearisation.multipliers());
        mechanics.for_each_constraint_curvature(0.0, q, multipliers, |row, col, value| {
            curvature[row][col] = value;
        });
        Self {
            stiffness: linearisation.stiffness().clone(),
            reference: linearisation.reference().clone(),
            multipliers: multipliers.clone(),
            curvature,
        }
    }

    /// `q − q_ref`.
    #[inline]
    pub(crate) fn displacement(&self, q: &S::PerCoordinate<f64>) -> S::PerCoordinate<f64> {
        Array::from_fn(|i| q[i] - self.reference[i])
    }

    /// `∂U/∂q` at `q_ref + displacement`.
    #[inline]
    pub(crate) fn remaining_gradient(
        &self,
        mechanics: &Mechanics<S>,
        t: f64,
        displacement: &S::PerCoordinate<f64>,
    ) -> S::PerCoordinate<f64> {
        let x = Array::from_fn(|i| self.reference[i] + displacement[i]);
        let gradient = mechanics.potential_gradient(t, &x, &self.multipliers);
        let linear = times::<S>(&self.stiffness, displacement);
        Array::from_fn(|i| gradient[i] - linear[i])
    }

    /// `∂²U/∂q²` at `q_ref + displacement`, with the curvature of the constraints at the reference: exact where they are
    /// quadratic, else the matrix of a chord iteration.
    #[inline]
    pub(crate) fn remaining_hessian(
        &self,
        mechanics: &Mechanics<S>,
        t: f64,
        displacement: &S::PerCoordinate<f64>,
    ) -> Rows<S> {
        let x = Array::from_fn(|i| self.reference[i] + displacement[i]);
        let stiffness = mechanics.potential_hessian(t, &x);
        Array::from_fn(|row| {
            Array::from_fn(|col| stiffness[row][col] + (self.curvature[row][col] - self.stiffness[row][col]))
        })
    }
}

/// The modes of a quadratic part with their exact flows over a step.
pub(crate) struct StepModes<S: MechanicalSystem> {
    pub(crate) modes: Modes<S>,
    pub(crate) flows: S::PerCoordinate<ModeFlow>,
}

impl<S: MechanicalSystem> StepModes<S> {
    /// The flows over a step of size `h`.
    ///
    /// # Errors
    /// [`SchemeError`] for a mode whose flow is not determined by its ends, and a mass matrix that is not positive definite.
    pub(crate) fn new(
        mechanics: &Mechanics<S>,
        part: &QuadraticPart<S>,
        h: f64,
    ) -> Result<Self, SchemeError> {
        let mass = mechanics.mass_at(&part.reference);
        let modes = Modes::<S>::new(&mass, &part.stiffness).map_err(|error| match error {
            LinearisationError::Mass => SchemeError::UnsupportedStructure {
                scheme: "a stiffness",
                requirement: "a positive definite mass matrix",
            },
            other => other.into(),
        })?;
        let flows: S::PerCoordinate<ModeFlow> =
            Array::from_fn(|k| ModeFlow::new(modes.squared_frequencies[k], h));
        for (mode, flow) in flows.as_ref().iter().enumerate() {
            flow.check(mode)?;
        }
        Ok(Self { modes, flows })
    }
}
