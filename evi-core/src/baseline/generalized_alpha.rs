//! The generalized-α method on the index-3 equations.

use super::equations_of_motion::{EquationsOfMotion, MotionPoint, PerAcceleration};
use super::prediction::Prediction;
use crate::array::Array;
use crate::integrator::{IterationFailure, OneStep, Scheme, StepError, Tally};
use crate::linear::{SingularMatrix, constraint_index, largest_magnitude, unknowns};
use crate::mechanics::{Acceleration, Mechanics, State};
use crate::memory::memory;
use crate::newton::{self, Converged, NotConverged, SLOWEST_CHORD};
use crate::scheme::{SchemeError, checked_step_size};
use crate::system::MechanicalSystem;

/// The generalized-α method (Chung, Hulbert, J. Appl. Mech. 60 (1993) 371) for constrained systems, on the constraints of the
/// positions (index 3; Arnold, Brüls, Multibody Syst. Dyn. 18 (2007) 185):
///
/// ```text
/// d/dt ∂L/∂v − ∂L/∂q + Gᵀ λ₁ = f,   φ = 0                               at (t₁, q₁, v₁, q̈₁)
/// q₁ = q₀ + h v₀ + h² ((½ − β) a₀ + β a₁)        v₁ = v₀ + h ((1 − γ) a₀ + γ a₁)
/// (1 − α_m) a₁ + α_m a₀ = (1 − α_f) q̈₁ + α_f q̈₀
/// α_m = (2ρ − 1)/(ρ + 1)     α_f = ρ/(ρ + 1)     γ = ½ − α_m + α_f     β = ¼ (γ + ½)²
/// ```
///
/// Of order 2 in `q`, `v` and `λ`. `ρ` is the spectral radius at infinite frequency, `0 ≤ ρ < 1`: what is not resolved shrinks by this
/// factor per step. The positions of a state lie on the constraints; the velocities are on the hidden ones to `O(h²)` alone.
///
/// `a` is no acceleration of a state but close to that at `t + (α_m − α_f) h`: the map keeps it, and begins with such a one where it
/// is given a state that is not the one that it ended with. Without that, `λ` would be of order 1 (Arnold, Brüls, sec. 3).
///
/// Newton's iteration on `(q̈₁, λ₁)`, with the derivatives of all terms but for the curvature of the constraints, whose entries lie
/// outside of the scene's own elimination: corrections shrink by `O(h²)`, and where they shrink by too little the curvature is added
/// and the matrix solved by dense elimination.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GeneralizedAlpha {
    h: f64,
    spectral_radius: f64,
}

impl GeneralizedAlpha {
    /// What multibody codes take as a rule.
    pub const DEFAULT_SPECTRAL_RADIUS: f64 = 0.8;

    /// Steps of size `h` with the default spectral radius.
    pub const fn new(h: f64) -> Self {
        Self { h, spectral_radius: Self::DEFAULT_SPECTRAL_RADIUS }
    }

    /// With the spectral radius `ρ` at infinity, `0 ≤ ρ < 1`.
    #[must_use]
    pub const fn spectral_radius(self, spectral_radius: f64) -> Self {
        Self { spectral_radius, ..self }
    }
}

impl<S: MechanicalSystem> Scheme<S> for GeneralizedAlpha {
    type Step = GeneralizedAlphaStep<S>;

    fn prepare(&self, mechanics: Mechanics<S>) -> Result<GeneralizedAlphaStep<S>, SchemeError> {
        let h = checked_step_size(self.h)?;
        let rho = self.spectral_radius;
        if !(0.0..1.0).contains(&rho) {
            return Err(SchemeError::SpectralRadius { value: rho });
        }
        Ok(GeneralizedAlphaStep {
            equations: EquationsOfMotion::new(mechanics),
            h,
            coefficients: Coefficients::new(rho),
            past: None,
        })
    }
}

/// The numbers of the method.
struct Coefficients {
    alpha_m: f64,
    alpha_f: f64,
    beta: f64,
    gamma: f64,
}

impl Coefficients {
    const fn new(rho: f64) -> Self {
        let (alpha_m, alpha_f) = ((2.0 * rho - 1.0) / (rho + 1.0), rho / (rho + 1.0));
        let gamma = 0.5 - alpha_m + alpha_f;
        Self { alpha_m, alpha_f, beta: 0.25 * (gamma + 0.5) * (gamma + 0.5), gamma }
    }

    /// `a₁` per `q̈₁`.
    const fn per_acceleration(&self) -> f64 {
        (1.0 - self.alpha_f) / (1.0 - self.alpha_m)
    }
}

/// The one-step map of [`GeneralizedAlpha`].
pub struct GeneralizedAlphaStep<S: MechanicalSystem> {
    equations: EquationsOfMotion<S>,
    h: f64,
    coefficients: Coefficients,
    past: Option<Past<S>>,
}

/// What the map keeps of the state that it has ended with.
struct Past<S: MechanicalSystem> {
    q: S::PerCoordinate<f64>,
    v: S::PerCoordinate<f64>,
    /// `a₀`.
    average: S::PerCoordinate<f64>,
    /// `(q̈₀, λ₀)`.
    solution: S::PerUnknown<f64>,
    solutions: Prediction<S::PerUnknown<f64>>,
}

impl<S: MechanicalSystem> GeneralizedAlphaStep<S> {
    /// `λ` at the state that the last step has ended with; `None` before the first.
    pub fn multipliers(&self) -> Option<S::PerConstraint<f64>> {
        let past = self.past.as_ref()?;
        Some(Array::from_fn(|c| past.solution[constraint_index::<S>(c)]))
    }

    /// The past of a state that no step has ended with.
    fn past_of(&self, state: &State<S>, tally: &mut impl Tally) -> Result<Past<S>, SingularMatrix> {
        let now = self.acceleration_after(0.0, state, &Array::from_fn(|_| 0.0), tally)?;
        let shift = (self.coefficients.alpha_m - self.coefficients.alpha_f) * self.h;
        let average = self.acceleration_after(shift, state, &now.acceleration, tally)?.acceleration;
        let before = self.acceleration_after(-self.h, state, &now.acceleration, tally)?;
        let together = |at: &Acceleration<S>| unknowns::<S>(|i| at.acceleration[i], |c| at.multipliers[c]);
        let mut solutions = Prediction::default();
        solutions.remember_line(together(&now), &together(&before));
        let (q, v) = (state.q.clone(), state.v.clone());
        Ok(Past { q, v, average, solution: together(&now), solutions })
    }

    /// The accelerations and multipliers at `duration` after the state, where it moves with the given acceleration.
    fn acceleration_after(
        &self,
        duration: f64,
        state: &State<S>,
        acceleration: &S::PerCoordinate<f64>,
        tally: &mut impl Tally,
    ) -> Result<Acceleration<S>, SingularMatrix> {
        let v: S::PerCoordinate<f64> = Array::from_fn(|i| state.v[i] + duration * acceleration[i]);
        let q = Array::from_fn(|i| state.q[i] + 0.5 * duration * (state.v[i] + v[i]));
        self.mechanics().acceleration_tallied(state.t + duration, &q, &v, &state.inputs, tally)
    }
}

impl<S: MechanicalSystem> OneStep<S> for GeneralizedAlphaStep<S> {
    fn h(&self) -> f64 {
        self.h
    }

    fn mechanics(&self) -> &Mechanics<S> {
        &self.equations.mechanics
    }

    fn advance(&mut self, state: &mut State<S>, tally: &mut impl Tally) -> Result<(), StepError> {
        let is_of = |past: &Past<S>| {
            // To the last bit.
            past.q.as_ref() == state.q.as_ref() && past.v.as_ref() == state.v.as_ref()
        };
        let mut past = match self.past.take() {
            Some(past) if is_of(&past) => past,
            other => match self.past_of(state, tally) {
                Ok(past) => past,
                Err(matrix) => {
                    self.past = other;
                    return Err(StepError::Singular { t: state.t, correction: 0, matrix });
                }
            },
        };
        let taken = self.advance_after(&mut past, state, tally);
        self.past = Some(past);
        taken
    }
}

/// The end of a step.
struct End<S: MechanicalSystem> {
    q: S::PerCoordinate<f64>,
    v: S::PerCoordinate<f64>,
    average: S::PerCoordinate<f64>,
    solution: S::PerUnknown<f64>,
}

impl<S: MechanicalSystem> GeneralizedAlphaStep<S> {
    /// Takes the step from a state with this past; where there is none, both stay as they were.
    fn advance_after(
        &self,
        past: &mut Past<S>,
        state: &mut State<S>,
        tally: &mut impl Tally,
    ) -> Result<(), StepError> {
        let predicted = past.solutions.predicted().unwrap_or_else(|| past.solution.clone());
        let end = match self.solve(state, past, predicted, tally) {
            // A prediction overshoots where the motion turns sharply.
            Err(StepError::NoSolution { .. }) => self.solve(state, past, past.solution.clone(), tally)?,
            end => end?,
        };
        let End { q, v, average, solution } = end;
        let t = state.t + self.h;
        let p = self.mechanics().momentum_at(t, &q, &v);
        state.replace(t, q, v, p)?;
        past.solutions.remember(solution.clone());
        (past.q, past.v) = (state.q.clone(), state.v.clone());
        (past.average, past.solution) = (average, solution);
        Ok(())
    }

    /// The end of the step, by Newton's iteration from the guess `solution`.
    fn solve(
        &self,
        state: &State<S>,
        past: &Past<S>,
        mut solution: S::PerUnknown<f64>,
        tally: &mut impl Tally,
    ) -> Result<End<S>, StepError> {
        let h = self.h;
        let mechanics = self.mechanics();
        let constants = &mechanics.constants;
        let Coefficients { alpha_m, alpha_f, beta, gamma } = self.coefficients;
        let per_average = self.coefficients.per_acceleration();
        let per = PerAcceleration { q: h * h * beta * per_average, v: h * gamma * per_average };
        let t = state.t + h;
        let end = |solution: S::PerUnknown<f64>| -> End<S> {
            let average = S::PerCoordinate::<f64>::from_fn(|i| {
                let known = alpha_f * past.solution[i] - alpha_m * past.average[i];
                per_average * solution[i] + known / (1.0 - alpha_m)
            });
            let mean = |weight: f64, i: usize| past.average[i] + weight * (average[i] - past.average[i]);
            End {
                q: Array::from_fn(|i| {
                    state.q[i]
                        + h * (state.v[i]
                            + h * (0.5 * past.average[i] + beta * (average[i] - past.average[i])))
                }),
                v: Array::from_fn(|i| state.v[i] + h * mean(gamma, i)),
                average,
                solution,
            }
        };
        let mut constraint_residual = 0.0;
        let mut smallest_pivot_ratio = 1.0_f64;
        let (mut previous, mut with_curvature) = (f64::INFINITY, false);
        let iteration = newton::iterate(|correction| {
            let acceleration = Array::from_fn(|i| solution[i]);
            let End { q, v, .. } = end(solution.clone());
            let at = MotionPoint { t, q, v, acceleration: &acceleration, inputs: &state.inputs };
            let (mut residual, mut kkt) = self.equations.linearize(&at, per);
            let (constraints, jacobian) = S::constraint_derivatives(constants, t, &at.q);
            let multipliers = Array::from_fn(|c| solution[constraint_index::<S>(c)]);
            mechanics.add_constraint_force(&jacobian, &multipliers, &mut residual);
            constraint_residual = largest_magnitude(constraints.as_ref().iter().copied());
            kkt.set_upper_jacobian(constants, &jacobian);
            kkt.set_lower_jacobian(constants, &jacobian);
            let mut change = unknowns::<S>(|i| residual[i], |c| constraints[c] / per.q);
            let moved = |x: f64| per.q * x;
            // All that is added up to `q₁`: where it is damped, it is smaller than its terms.
            let reach = |i: usize| {
                let terms = [state.q[i], h * state.v[i], h * h * past.average[i]];
                at.q[i].abs() + terms.map(f64::abs).iter().sum::<f64>()
            };
            let length;
            if with_curvature {
                let multipliers = Array::from_fn(|c| solution[constraint_index::<S>(c)]);
                mechanics.for_each_constraint_curvature(t, &at.q, &multipliers, |row, col, value| {
                    kkt.add_block(row, col, per.q * value);
                });
                let kkt = kkt.factor_densely();
                let kkt = kkt.map_err(|matrix| IterationFailure::Singular { correction, matrix })?;
                smallest_pivot_ratio = smallest_pivot_ratio.min(kkt.pivot_ratio());
                kkt.solve(&mut change);
                length = kkt.relative_length(|i| moved(change[i]), reach);
            } else {
                let kkt = kkt.factor().map_err(|matrix| IterationFailure::Singular { correction, matrix })?;
                smallest_pivot_ratio = smallest_pivot_ratio.min(kkt.pivot_ratio());
                if kkt.is_fallback() {
                    tally.count_fallback();
                }
                kkt.solve(&mut change);
                length = kkt.relative_length(|i| moved(change[i]), reach);
            }
            for (unknown, change) in solution.as_mut().iter_mut().zip(change.as_ref()) {
                *unknown -= change;
            }
            let shrinks = length <= SLOWEST_CHORD * previous;
            with_curvature |= S::N_CONSTRAINTS > 0 && !shrinks;
            previous = length;
            Ok(length)
        });
        let found = iteration.and_then(|Converged { corrections }| {
            let end = end(solution);
            if self.is_on_constraints(state, &end) {
                tally.count_corrections(corrections);
                Ok(end)
            } else {
                Err(NotConverged { corrections, last_correction: previous }.into())
            }
        });
        found.map_err(|failure: IterationFailure| {
            failure.at(state.t, constraint_residual, smallest_pivot_ratio)
        })
    }

    /// Whether a step ends on its constraints, which hold to the round-off of what is added up to `q₁`. Where next to nothing is left
    /// of it, or the iteration has ended at no solution, they do not.
    fn is_on_constraints(&self, state: &State<S>, end: &End<S>) -> bool {
        /// Of the 16 digits of the terms seven may be lost.
        const LARGEST_RESIDUAL: f64 = 1e-9;
        let constants = &self.mechanics().constants;
        let (residual, jacobian) = S::constraint_derivatives(constants, state.t + self.h, &end.q);
        let reach = Array::from_fn(|i| state.q[i].abs() + end.q[i].abs());
        let scale = self.mechanics().constraint_scale(&jacobian, &reach);
        // Written so that a NaN is refused.
        (0..S::N_CONSTRAINTS).all(|c| residual[c].abs() <= LARGEST_RESIDUAL * scale[c])
    }
}

memory!([S: MechanicalSystem] GeneralizedAlphaStep<S>, |words|
    Self { equations: _, h: _, coefficients, past } => {
        words.fixed(coefficients.gamma);
        words.optional(past, Past::none);
    }
);

memory!([S: MechanicalSystem] Past<S>, |words| Self { q, v, average, solution, solutions } => {
    words.numbers(q);
    words.numbers(v);
    words.numbers(average);
    words.numbers(solution);
    words.part(solutions);
});

impl<S: MechanicalSystem> Past<S> {
    fn none() -> Self {
        let none = S::PerCoordinate::<f64>::from_fn(|_| 0.0);
        Self {
            q: none.clone(),
            v: none.clone(),
            average: none,
            solution: Array::from_fn(|_| 0.0),
            solutions: Prediction::default(),
        }
    }
}
