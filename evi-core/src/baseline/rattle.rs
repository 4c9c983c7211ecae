//! RATTLE, in its classical velocity form.

use crate::array::Array;
use crate::integrator::{IterationFailure, OneStep, Scheme, StepError, Symmetric, Tally};
use crate::linear::{Factorization, SingularMatrix, largest_magnitude};
use crate::mechanics::{CoordinateMatrix, ForcePoint, Mechanics, ProjectionError, State, relative};
use crate::newton::{self, Converged};
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
        const SCHEME: &str = "RATTLE";
        let h = checked_step_size(self.h)?;
        if !S::STRUCTURE.is_separable_with_constant_mass() {
            let requirement = "a constant mass matrix and no coupling of velocity with position or time";
            return Err(SchemeError::UnsupportedStructure { scheme: SCHEME, requirement });
        }
        if S::STRUCTURE.forces.on.on_v {
            let requirement = "forces that do not depend on velocities";
            return Err(SchemeError::UnsupportedStructure { scheme: SCHEME, requirement });
        }
        let requirement = "a mass matrix that is regular, not only on the constraints";
        let inverse_mass = CoordinateMatrix::inverse_of(&mechanics.constant_mass())
            .map_err(|_| SchemeError::UnsupportedStructure { scheme: SCHEME, requirement })?;
        Ok(RattleStep { mechanics, inverse_mass, h })
    }
}

/// The one-step map of [`Rattle`].
pub struct RattleStep<S: MechanicalSystem> {
    mechanics: Mechanics<S>,
    inverse_mass: CoordinateMatrix<S>,
    h: f64,
}

impl<S: MechanicalSystem> OneStep<S> for RattleStep<S> {
    fn h(&self) -> f64 {
        self.h
    }

    fn mechanics(&self) -> &Mechanics<S> {
        &self.mechanics
    }

    fn advance(&mut self, state: &mut State<S>, tally: &mut impl Tally) -> Result<(), StepError> {
        let t = state.t + self.h;
        let mut half_step_velocity = self.kicked(state.t, &state.q, &state.v, &state.inputs);
        let q = self.solve_positions(state, &mut half_step_velocity, tally)?;
        let mut v = self.kicked(t, &q, &half_step_velocity, &state.inputs);
        self.project(t, &q, &mut v, tally)
            .map_err(|cause| StepError::Projection { t, cause: ProjectionError::Singular(cause) })?;
        let p = self.mechanics.momentum_at(t, &q, &v);
        state.replace(t, q, v, p)
    }
}

impl<S: MechanicalSystem> RattleStep<S> {
    /// `v + ½h M⁻¹ f(t, q)`.
    fn kicked(
        &self,
        t: f64,
        q: &S::PerCoordinate<f64>,
        v: &S::PerCoordinate<f64>,
        inputs: &S::PerInput<f64>,
    ) -> S::PerCoordinate<f64> {
        let mut force = S::lagrangian_gradient(&self.mechanics.constants, t, q, v).force;
        self.mechanics.add_force(ForcePoint { t, q, v, inputs }, &mut force);
        let kick = self.inverse_mass.times(|i| force[i]);
        Array::from_fn(|i| v[i] + 0.5 * self.h * kick[i])
    }

    /// Subtracts `M⁻¹ G₀ᵀ ½h λ₀` from `v`, so that `q₀ + h v` satisfies the constraints, and returns that position.
    fn solve_positions(
        &self,
        state: &State<S>,
        v: &mut S::PerCoordinate<f64>,
        tally: &mut impl Tally,
    ) -> Result<S::PerCoordinate<f64>, StepError> {
        let (h, t) = (self.h, state.t + self.h);
        let constants = &self.mechanics.constants;
        let (_, jacobian) = S::constraint_derivatives(constants, state.t, &state.q);
        let directions = self.mechanics.constraint_directions(&jacobian, &self.inverse_mass);
        let mut q = S::PerCoordinate::<f64>::from_fn(|i| state.q[i] + h * v[i]);
        let mut constraint_residual = 0.0;
        let mut smallest_pivot_ratio = 1.0_f64;
        let iteration = newton::iterate(|correction| {
            let (mut impulse, jacobian) = S::constraint_derivatives(constants, t, &q);
            constraint_residual = largest_magnitude(impulse.as_ref().iter().copied());
            let gram = S::GramFactors::factor(&self.mechanics.gram_matrix(&jacobian, &directions))
                .map_err(|matrix| IterationFailure::Singular { correction, matrix })?;
            smallest_pivot_ratio = smallest_pivot_ratio.min(gram.pivot_ratio());
            if gram.is_fallback() {
                tally.count_fallback();
            }
            gram.solve(&mut impulse);
            let displacement = S::PerCoordinate::<f64>::from_fn(|i| {
                (0..S::N_CONSTRAINTS).map(|c| directions[c][i] * impulse[c]).sum()
            });
            for i in 0..S::N_COORDINATES {
                v[i] -= displacement[i] / h;
                q[i] = state.q[i] + h * v[i];
            }
            let length = largest_magnitude(displacement.as_ref().iter().copied());
            Ok(relative(length, largest_magnitude(q.as_ref().iter().copied())))
        });
        match iteration {
            Ok(Converged { corrections }) => {
                tally.count_corrections(corrections);
                Ok(q)
            }
            Err(failure) => {
                Err(IterationFailure::at(failure, state.t, constraint_residual, smallest_pivot_ratio))
            }
        }
    }

    /// Subtracts `M⁻¹ G₁ᵀ ½h λ₁` from `v`, so that it satisfies the hidden constraints.
    fn project(
        &self,
        t: f64,
        q: &S::PerCoordinate<f64>,
        v: &mut S::PerCoordinate<f64>,
        tally: &mut impl Tally,
    ) -> Result<(), SingularMatrix> {
        let (_, jacobian) = S::constraint_derivatives(&self.mechanics.constants, t, q);
        let directions = self.mechanics.constraint_directions(&jacobian, &self.inverse_mass);
        let mut impulse = self.mechanics.constraint_rate(jacobian.as_ref(), v);
        let gram = S::GramFactors::factor(&self.mechanics.gram_matrix(&jacobian, &directions))?;
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
