//! The Legendre transform on the constraint manifold, and projections onto the manifold.

use core::borrow::Borrow;

use super::{ForcePoint, Mechanics, Rounded, Sum};
use crate::array::Array;
use crate::linear::{FactoredKkt, SingularMatrix, constraint_index, unknowns};
use crate::newton::{self, NotConverged, Tally};
use crate::system::{LagrangianGradient, MechanicalSystem};

/// A momentum with the constraint impulse removed, and the velocity that belongs to it.
pub(crate) struct Projected<S: MechanicalSystem> {
    pub(crate) v: S::PerCoordinate<f64>,
    pub(crate) p: S::PerCoordinate<f64>,
}

/// A projection onto the constraint manifold that failed.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ProjectionError {
    /// Mass matrix and constraint Jacobian do not determine the projection.
    #[error("mass matrix and constraints do not determine the motion: {0}")]
    Singular(#[from] SingularMatrix),
    /// Newton's iteration did not converge.
    #[error("the projection did not converge: relative correction {last_correction:e} after {corrections}")]
    NotConverged {
        /// Number of corrections applied.
        corrections: usize,
        /// Relative length of the last one.
        last_correction: f64,
    },
}

impl From<NotConverged> for ProjectionError {
    fn from(failure: NotConverged) -> Self {
        let NotConverged { corrections, last_correction } = failure;
        Self::NotConverged { corrections, last_correction }
    }
}

impl<S: MechanicalSystem> Mechanics<S> {
    /// Removes from `momentum` the impulse `Gᵀ N` that makes the motion leave the constraints.
    ///
    /// Solves `∂L/∂v(t, q, v) + Gᵀ N = momentum`, `G v + ∂φ/∂t = 0` for `(v, N)` and returns `v` and
    /// `p = momentum − Gᵀ N`, with which it overwrites `momentum` (Marsden & West, Acta Numerica 10 (2001), sec. 3.5; the velocity step of RATTLE). Linear
    /// in `(v, N)` for every `L` that is quadratic in `v`: then one solve. `v` is the first guess.
    #[inline]
    pub(crate) fn project_momentum(
        &self,
        t: f64,
        q: &S::PerCoordinate<f64>,
        momentum: &mut impl Sum<S>,
        mut v: S::PerCoordinate<f64>,
        tally: &mut impl Tally,
    ) -> Result<S::PerCoordinate<f64>, ProjectionError> {
        let (_, jacobian) = S::constraint_derivatives(&self.constants, t, q);
        let unprojected = momentum.value().borrow().clone();
        let mut impulse = S::PerConstraint::<f64>::from_fn(|_| 0.0);
        let mut correct = || -> Result<f64, ProjectionError> {
            let (gradient, hessian) = S::lagrangian_derivatives(&self.constants, t, q, &v);
            let kkt = self.mass_kkt(&hessian, &jacobian);
            tally.see_matrix(|| kkt.conditioning());
            let kkt = kkt.factor()?;
            if kkt.is_fallback() {
                tally.count_fallback();
            }
            let rate = self.constraint_rate(&jacobian, &v);
            let mut correction = unknowns::<S>(|i| unprojected[i] - gradient.momentum[i], |c| -rate[c]);
            kkt.solve(&mut correction);
            for i in 0..S::N_COORDINATES {
                v[i] += correction[i];
            }
            // The impulse enters linearly: its value, not an increment, belongs to the corrected velocity.
            impulse = Array::from_fn(|c| correction[constraint_index::<S>(c)]);
            if S::N_CONSTRAINTS > 0 {
                self.refine_hidden_constraints(&kkt, &jacobian, &mut v, &mut impulse);
            }
            Ok(kkt.relative_length(|i| correction[i], |i| v[i]))
        };
        if S::STRUCTURE.is_quadratic_in_velocity() {
            correct()?;
        } else {
            newton::iterate(|_| correct())?;
        }
        let mut constraint_momentum = S::PerCoordinate::<f64>::from_fn(|_| 0.0);
        self.add_constraint_force(&jacobian, &impulse, &mut constraint_momentum);
        for i in 0..S::N_COORDINATES {
            momentum.terms_mut()[i] -= constraint_momentum[i];
        }
        Ok(v)
    }

    /// Solves once more for what the first solve left of `G v + ∂φ/∂t`.
    ///
    /// Near a turning point `v` is a small difference of large momenta, whose round-off would stay in `G v`.
    #[inline]
    fn refine_hidden_constraints(
        &self,
        kkt: &FactoredKkt<S>,
        jacobian: &S::PerJacobianEntry<f64>,
        v: &mut S::PerCoordinate<f64>,
        impulse: &mut S::PerConstraint<f64>,
    ) {
        let rate = self.constraint_rate(jacobian, v);
        let mut refinement = unknowns::<S>(|_| 0.0, |c| -rate[c]);
        kkt.solve(&mut refinement);
        for i in 0..S::N_COORDINATES {
            v[i] += refinement[i];
        }
        for c in 0..S::N_CONSTRAINTS {
            impulse[c] += refinement[constraint_index::<S>(c)];
        }
    }

    /// The configuration on the manifold nearest to `start` in the metric of the mass matrix at `(start, v)`.
    ///
    /// Newton's iteration on `M (q − start) + Gᵀ μ = 0`, `φ(q) = 0`. Without the displacement in the first row,
    /// `q` would be on the manifold, but not nearest; without the curvature `Σ μ φ_qq` in its derivative,
    /// convergence would be linear and fail at distances of a fifth of the radius of curvature.
    pub(crate) fn project_configuration(
        &self,
        t: f64,
        start: &S::PerCoordinate<f64>,
        v: &S::PerCoordinate<f64>,
    ) -> Result<S::PerCoordinate<f64>, ProjectionError> {
        let mut q = start.clone();
        if S::N_CONSTRAINTS == 0 {
            return Ok(q);
        }
        let (_, hessian) = S::lagrangian_derivatives(&self.constants, t, start, v);
        let mut multipliers = S::PerConstraint::<f64>::from_fn(|_| 0.0);
        newton::iterate(|_| -> Result<f64, ProjectionError> {
            let (residual, jacobian) = S::constraint_derivatives(&self.constants, t, &q);
            let mut kkt = self.mass_kkt(&hessian, &jacobian);
            self.for_each_constraint_curvature(t, &q, &multipliers, |row, col, curvature| {
                kkt.add_block(row, col, curvature);
            });
            let kkt = kkt.factor_densely()?;
            let displacement = S::PerCoordinate::<f64>::from_fn(|i| q[i] - start[i]);
            let mut pull = self.mass_times(&hessian, &displacement);
            self.add_constraint_force(&jacobian, &multipliers, &mut pull);
            let mut correction = unknowns::<S>(|i| -pull[i], |c| -residual[c]);
            kkt.solve(&mut correction);
            for i in 0..S::N_COORDINATES {
                q[i] += correction[i];
            }
            for c in 0..S::N_CONSTRAINTS {
                multipliers[c] += correction[constraint_index::<S>(c)];
            }
            Ok(kkt.relative_length(|i| correction[i], |i| q[i]))
        })?;
        Ok(q)
    }

    /// `M x`.
    fn mass_times(
        &self,
        hessian: &S::PerHessianEntry<f64>,
        x: &S::PerCoordinate<f64>,
    ) -> S::PerCoordinate<f64> {
        let mut product = S::PerCoordinate::<f64>::from_fn(|_| 0.0);
        S::for_each_vv(&self.constants, hessian, |row, col, mass| product[row] += mass * x[col]);
        product
    }

    /// The velocity that satisfies `G v + ∂φ/∂t = 0` nearest to `v` in the metric of the mass matrix, and its
    /// momentum `p = ∂L/∂v`.
    pub(crate) fn project_velocity(
        &self,
        t: f64,
        q: &S::PerCoordinate<f64>,
        v: S::PerCoordinate<f64>,
    ) -> Result<Projected<S>, ProjectionError> {
        let momentum = S::lagrangian_gradient(&self.constants, t, q, &v).momentum;
        let mut momentum = Rounded(momentum);
        let v = self.project_momentum(t, q, &mut momentum, v, &mut ())?;
        Ok(Projected { v, p: momentum.0 })
    }

    /// Accelerations and multipliers of the continuous motion at `(t, q, v)`: the index-1 equations
    ///
    /// ```text
    /// M q̈ + Gᵀ λ = ∂L/∂q + f − (∂²L/∂v∂q) v − ∂²L/∂v∂t
    /// G q̈         = −γ
    /// ```
    ///
    /// so that `d/dt ∂L/∂v − ∂L/∂q + Gᵀ λ = f`. At the states of an integrator, `λ` has the order of the integrator;
    /// the multipliers inside its step do not.
    ///
    /// For scenes without inputs, which the compiler checks; [`acceleration_with`](Self::acceleration_with) takes them.
    ///
    /// # Errors
    /// [`SingularMatrix`] where mass matrix and constraints do not determine the acceleration.
    pub fn acceleration(
        &self,
        t: f64,
        q: &S::PerCoordinate<f64>,
        v: &S::PerCoordinate<f64>,
    ) -> Result<Acceleration<S>, SingularMatrix> {
        const { assert!(S::N_INPUTS == 0, "this scene has inputs: call `acceleration_with` and give them") };
        self.acceleration_with(t, q, v, &Array::from_fn(|_| 0.0))
    }

    /// Accelerations and multipliers under the inputs `u`.
    ///
    /// # Errors
    /// As for [`acceleration`](Self::acceleration).
    pub fn acceleration_with(
        &self,
        t: f64,
        q: &S::PerCoordinate<f64>,
        v: &S::PerCoordinate<f64>,
        inputs: &S::PerInput<f64>,
    ) -> Result<Acceleration<S>, SingularMatrix> {
        self.acceleration_tallied(t, q, v, inputs, &mut ())
    }

    /// [`acceleration_with`](Self::acceleration_with) under a step.
    #[inline]
    pub(crate) fn acceleration_tallied(
        &self,
        t: f64,
        q: &S::PerCoordinate<f64>,
        v: &S::PerCoordinate<f64>,
        inputs: &S::PerInput<f64>,
        tally: &mut impl Tally,
    ) -> Result<Acceleration<S>, SingularMatrix> {
        let (LagrangianGradient { mut force, .. }, hessian) =
            S::lagrangian_derivatives(&self.constants, t, q, v);
        self.add_force(ForcePoint { t, q, v, inputs }, &mut force);
        for entry in S::STRUCTURE.hessian.vq {
            force[entry.row] -= entry.value(self.constants.as_ref(), hessian.as_ref()) * v[entry.col];
        }
        for entry in S::STRUCTURE.hessian.vt {
            force[entry.row] -= entry.value(self.constants.as_ref(), hessian.as_ref());
        }
        let (_, jacobian) = S::constraint_derivatives(&self.constants, t, q);
        let curvature = S::constraint_curvature(&self.constants, t, q, v);
        let kkt = self.mass_kkt(&hessian, &jacobian).factor()?;
        if kkt.is_fallback() {
            tally.count_fallback();
        }
        let mut solution = unknowns::<S>(|i| force[i], |c| -curvature[c]);
        kkt.solve(&mut solution);
        Ok(Acceleration {
            acceleration: Array::from_fn(|i| solution[i]),
            multipliers: Array::from_fn(|c| solution[constraint_index::<S>(c)]),
        })
    }
}

/// Second derivatives of the motion and the forces that keep it on the constraints.
pub struct Acceleration<S: MechanicalSystem> {
    /// `q̈`.
    pub acceleration: S::PerCoordinate<f64>,
    /// `λ`: the constraint force is `−Gᵀ λ`. Scaling a constraint scales its multiplier inversely.
    pub multipliers: S::PerConstraint<f64>,
}

/// `length / reference`; zero for a vanishing length, whatever the reference.
#[inline]
pub(crate) fn relative(length: f64, reference: f64) -> f64 {
    if length == 0.0 { 0.0 } else { length / reference }
}
