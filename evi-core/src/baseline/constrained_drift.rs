//! A drift that ends on the constraints: what SHAKE and RATTLE share.

use super::prediction::Prediction;
use crate::array::Array;
use crate::integrator::{IterationFailure, StepError, Tally};
use crate::linear::{Factorization, largest_magnitude};
use crate::mechanics::{AsScene, CoordinateMatrix, Directions, ForcePoint, Mechanics, relative};
use crate::memory::memory;
use crate::newton::{self, Converged};
use crate::scheme::SchemeError;
use crate::system::MechanicalSystem;

/// Kicks and drifts of a scene with `L = ½vᵀMv − V(t, q)` and constant `M`.
pub(super) struct ConstrainedDrift<S: MechanicalSystem> {
    mechanics: Mechanics<S>,
    inverse_mass: CoordinateMatrix<S>,
    h: f64,
    /// The impulses of the last drifts: they affect the number of corrections and the last bits of a state, nothing else.
    impulses: Prediction<S::PerConstraint<f64>>,
}

/// Where a drift ends.
struct Landing<S: MechanicalSystem> {
    q: S::PerCoordinate<f64>,
    /// The velocity of the drift.
    v: S::PerCoordinate<f64>,
    /// The impulse that it took.
    impulse: S::PerConstraint<f64>,
}

/// Where a drift begins.
pub(super) struct DriftStart<'a, S: MechanicalSystem> {
    pub(super) t: f64,
    pub(super) q: &'a S::PerCoordinate<f64>,
}

// Written out, since a derive would demand the same of `S`.
impl<S: MechanicalSystem> Clone for DriftStart<'_, S> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<S: MechanicalSystem> Copy for DriftStart<'_, S> {}

impl<S: MechanicalSystem> ConstrainedDrift<S> {
    /// # Errors
    /// [`SchemeError::UnsupportedStructure`] for scenes of another kind; `scheme` is who asks.
    pub(super) fn new(scheme: &'static str, mechanics: Mechanics<S>, h: f64) -> Result<Self, SchemeError> {
        let unsupported = |requirement| SchemeError::UnsupportedStructure { scheme, requirement };
        if !S::STRUCTURE.is_separable_with_constant_mass() {
            return Err(unsupported(
                "a constant mass matrix and no coupling of velocity with position or time",
            ));
        }
        if S::STRUCTURE.forces.on.on_v {
            return Err(unsupported("forces that do not depend on velocities"));
        }
        let inverse_mass = CoordinateMatrix::inverse_of(&mechanics.constant_mass())
            .map_err(|_| unsupported("a mass matrix that is regular, not only on the constraints"))?;
        Ok(Self { mechanics, inverse_mass, h, impulses: Prediction::default() })
    }

    pub(super) const fn h(&self) -> f64 {
        self.h
    }

    pub(super) const fn mechanics(&self) -> &Mechanics<S> {
        &self.mechanics
    }

    /// Begins the next drift without a guess from the past.
    pub(super) fn forget_impulses(&mut self) {
        self.impulses.forget();
    }

    /// `v + duration M⁻¹ f(t, q)`.
    pub(super) fn kicked(
        &self,
        duration: f64,
        DriftStart { t, q }: DriftStart<'_, S>,
        v: &S::PerCoordinate<f64>,
        inputs: &S::PerInput<f64>,
    ) -> S::PerCoordinate<f64> {
        let mut force = S::lagrangian_gradient(&self.mechanics.constants, t, q, v).force;
        self.mechanics.add_force(ForcePoint { t, q, v, inputs }, &mut force);
        let kick = self.inverse_mass.times(|i| force[i]);
        Array::from_fn(|i| v[i] + duration * kick[i])
    }

    /// `M⁻¹ Gᵀ`, a row per constraint.
    pub(super) fn directions(&self, jacobian: &S::PerJacobianEntry<f64>) -> Directions<S> {
        self.mechanics.constraint_directions(jacobian, &self.inverse_mass)
    }

    /// Subtracts `M⁻¹ G₀ᵀ ℓ` from `v`, so that `q₀ + h v` satisfies the constraints, and returns that position.
    ///
    /// # Errors
    /// [`StepError`] where Newton's iteration on the impulse `ℓ` finds none; nothing is remembered of it.
    pub(super) fn drift(
        &mut self,
        start: DriftStart<'_, S>,
        v: &mut S::PerCoordinate<f64>,
        tally: &mut impl Tally,
    ) -> Result<S::PerCoordinate<f64>, StepError> {
        if S::N_CONSTRAINTS == 0 {
            return Ok(Array::from_fn(|i| start.q[i] + self.h * v[i]));
        }
        let none = || Array::from_fn(|_| 0.0);
        let Landing { q, v: landed, impulse } = match self.impulses.predicted() {
            Some(predicted) => match self.land(start, v, predicted, tally) {
                // A prediction overshoots where the motion turns sharply.
                Err(StepError::NoSolution { .. }) => self.land(start, v, none(), tally)?,
                landing => landing?,
            },
            None => self.land(start, v, none(), tally)?,
        };
        self.impulses.remember(impulse);
        *v = landed;
        Ok(q)
    }

    /// Where the drift with the velocity `v` and the constraint forces ends, by Newton's iteration from the guess `total`.
    fn land(
        &self,
        start: DriftStart<'_, S>,
        v: &S::PerCoordinate<f64>,
        mut total: S::PerConstraint<f64>,
        tally: &mut impl Tally,
    ) -> Result<Landing<S>, StepError> {
        let (h, t) = (self.h, start.t + self.h);
        let landed = |v: &S::PerCoordinate<f64>| Array::from_fn(|i| start.q[i] + h * v[i]);
        let constants = &self.mechanics.constants;
        let (_, jacobian) = S::constraint_derivatives(constants, start.t, start.q);
        let directions = self.directions(&jacobian);
        let pulled = |impulse: &S::PerConstraint<f64>, i: usize| -> f64 {
            (0..S::N_CONSTRAINTS).map(|c| directions[c][i] * impulse[c]).sum()
        };
        // Of a scene at rest at the origin the way that it would go without its constraints is all that there is.
        let way = largest_magnitude(v.as_ref().iter().map(|v| h * v));
        let mut v: S::PerCoordinate<f64> = Array::from_fn(|i| v[i] - pulled(&total, i));
        let mut q: S::PerCoordinate<f64> = landed(&v);
        let mut constraint_residual = 0.0;
        let mut smallest_pivot_ratio = 1.0_f64;
        let iteration = newton::iterate(|correction| {
            let (residual, jacobian) = S::constraint_derivatives(constants, t, &q);
            constraint_residual = largest_magnitude(residual.as_ref().iter().copied());
            let gram = S::GramFactors::factor_of_any_size(
                &self.mechanics.gram_matrix::<AsScene>(&jacobian, &directions),
            )
            .map_err(|matrix| IterationFailure::Singular { correction, matrix })?;
            smallest_pivot_ratio = smallest_pivot_ratio.min(gram.pivot_ratio());
            if gram.is_fallback() {
                tally.count_fallback();
            }
            let mut impulse: S::PerConstraint<f64> = Array::from_fn(|c| residual[c] / h);
            gram.solve(&mut impulse);
            let change = S::PerCoordinate::<f64>::from_fn(|i| pulled(&impulse, i));
            for i in 0..S::N_COORDINATES {
                v[i] -= change[i];
            }
            for c in 0..S::N_CONSTRAINTS {
                total[c] += impulse[c];
            }
            q = landed(&v);
            let length = largest_magnitude(change.as_ref().iter().map(|change| h * change));
            Ok(relative(length, largest_magnitude(q.as_ref().iter().copied()).max(way)))
        });
        match iteration {
            Ok(Converged { corrections }) => {
                tally.count_corrections(corrections);
                Ok(Landing { q, v, impulse: total })
            }
            Err(failure) => {
                Err(IterationFailure::at(failure, start.t, constraint_residual, smallest_pivot_ratio))
            }
        }
    }
}

memory!([S: MechanicalSystem] ConstrainedDrift<S>, |words|
    Self { mechanics: _, inverse_mass: _, h: _, impulses } => { words.part(impulses) }
);
