//! RATTLE, in its classical velocity form.

use super::constrained_drift::{ConstrainedDrift, DriftStart};
use crate::integrator::{OneStep, Scheme, StepError, Symmetric, Tally};
use crate::linear::{Factorization, SingularMatrix};
use crate::mechanics::{AsScene, Mechanics, ProjectionError, State};
use crate::memory::memory;
use crate::scheme::{SchemeError, checked_step_size};
use crate::system::MechanicalSystem;

/// RATTLE (Andersen, J. Comput. Phys. 52 (1983) 24) for scenes with constant mass matrix and `L = ½vᵀMv − V(t, q)`:
///
/// ```text
/// v½ = v₀ + ½h M⁻¹(f(q₀) − G₀ᵀ λ₀)     q₁ = q₀ + h v½     φ(q₁) = 0
/// v₁ = v½ + ½h M⁻¹(f(q₁) − G₁ᵀ λ₁)     G₁ v₁ = 0
/// ```
///
/// Newton runs on the multipliers alone, with the Gram matrix `G₁ M⁻¹ G₀ᵀ`. Forces that are no derivatives of `L` are part of `f`,
/// which is the trapezoid member of the Lagrange-d'Alembert family; those that depend on velocities would make the kicks implicit
/// and are refused.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rattle {
    h: f64,
}

impl Rattle {
    /// Steps of size `h`.
    pub const fn new(h: f64) -> Self {
        Self { h }
    }
}

impl Symmetric for Rattle {
    fn step_size(&self) -> f64 {
        self.h
    }

    fn with_step_size(&self, h: f64) -> Self {
        Self { h }
    }

    fn check_symmetry(&self) -> Result<(), SchemeError> {
        Ok(())
    }
}

impl<S: MechanicalSystem> Scheme<S> for Rattle {
    type Step = RattleStep<S>;

    fn prepare(&self, mechanics: Mechanics<S>) -> Result<RattleStep<S>, SchemeError> {
        let h = checked_step_size(self.h)?;
        Ok(RattleStep { drift: ConstrainedDrift::new("RATTLE", mechanics, h)? })
    }
}

/// The one-step map of [`Rattle`].
pub struct RattleStep<S: MechanicalSystem> {
    drift: ConstrainedDrift<S>,
}

impl<S: MechanicalSystem> OneStep<S> for RattleStep<S> {
    fn h(&self) -> f64 {
        self.drift.h()
    }

    fn mechanics(&self) -> &Mechanics<S> {
        self.drift.mechanics()
    }

    fn advance(&mut self, state: &mut State<S>, tally: &mut impl Tally) -> Result<(), StepError> {
        let half = 0.5 * self.h();
        let start = DriftStart { t: state.t, q: &state.q };
        let mut half_step_velocity = self.drift.kicked(half, start, &state.v, &state.inputs);
        let q = self.drift.drift(start, &mut half_step_velocity, tally)?;
        let t = state.t + self.h();
        let end = DriftStart { t, q: &q };
        let mut v = self.drift.kicked(half, end, &half_step_velocity, &state.inputs);
        self.project(end, &mut v, tally)
            .map_err(|cause| StepError::Projection { t, cause: ProjectionError::Singular(cause) })?;
        let p = self.mechanics().momentum_at(t, &q, &v);
        state.replace(t, q, v, p)
    }
}

impl<S: MechanicalSystem> RattleStep<S> {
    /// Subtracts `M⁻¹ G₁ᵀ ½h λ₁` from `v`, so that it satisfies the hidden constraints.
    fn project(
        &self,
        DriftStart { t, q }: DriftStart<'_, S>,
        v: &mut S::PerCoordinate<f64>,
        tally: &mut impl Tally,
    ) -> Result<(), SingularMatrix> {
        let mechanics = self.mechanics();
        let (_, jacobian) = S::constraint_derivatives(&mechanics.constants, t, q);
        let directions = self.drift.directions(&jacobian);
        let mut impulse = mechanics.constraint_rate(&jacobian, v);
        let gram =
            S::GramFactors::factor_of_any_size(&mechanics.gram_matrix::<AsScene>(&jacobian, &directions))?;
        if gram.is_fallback() {
            tally.count_fallback();
        }
        gram.solve(&mut impulse);
        for i in 0..S::N_COORDINATES {
            v[i] -= (0..S::N_CONSTRAINTS).map(|c| directions[c][i] * impulse[c]).sum::<f64>();
        }
        Ok(())
    }
}

memory!([S: MechanicalSystem] RattleStep<S>, |words| Self { drift } => { words.part(drift) });
