//! Steps whose positions and multipliers are found together.

use super::Mechanics;
use crate::array::Array;
use crate::linear::{FactoredKkt, Factorization, Kkt, SingularMatrix, unknowns};
use crate::system::MechanicalSystem;

/// Where a step starts, with what stays fixed during its Newton iteration.
pub(crate) struct StepStart<'a, S: MechanicalSystem> {
    pub(crate) t: f64,
    pub(crate) q: &'a S::PerCoordinate<f64>,
    pub(crate) p: &'a S::PerCoordinate<f64>,
    pub(crate) inputs: &'a S::PerInput<f64>,
    /// The varying entries of `G₀ = G(t₀, q₀)`.
    pub(crate) jacobian: S::PerJacobianEntry<f64>,
}

impl<'a, S: MechanicalSystem> StepStart<'a, S> {
    #[inline]
    pub(crate) fn new(
        mechanics: &Mechanics<S>,
        t: f64,
        q: &'a S::PerCoordinate<f64>,
        p: &'a S::PerCoordinate<f64>,
        inputs: &'a S::PerInput<f64>,
    ) -> Self {
        let (_, jacobian) = S::constraint_derivatives(&mechanics.constants, t, q);
        Self { t, q, p, inputs, jacobian }
    }
}

/// What solves the equations of a step.
pub(crate) struct StepSolution<S: MechanicalSystem> {
    /// `d = q₁ − q₀`.
    pub(crate) difference: S::PerCoordinate<f64>,
    /// `ℓ`.
    pub(crate) impulse: S::PerConstraint<f64>,
    /// `k(d)`.
    pub(crate) node_kick: S::PerCoordinate<f64>,
}

/// The equations of a step for the difference `d = q₁ − q₀` and the impulse `ℓ` of the constraint force,
///
/// ```text
/// A d + a(q₀, p₀) − k(q₀, d) + G₀ᵀ ℓ = 0        φ(t₁, q₀ + d) = 0
/// ```
///
/// where `A` is constant and `k` is what the nodes of the rule make of `d`.
pub(crate) trait ImplicitStep<S: MechanicalSystem> {
    /// Factors of the matrix of the equations.
    type Factors: Factorization<S::PerUnknown<f64>, S::PerUnknown<S::PerUnknown<f64>>>;

    /// The scene that moves.
    fn mechanics(&self) -> &Mechanics<S>;

    /// Step size.
    fn h(&self) -> f64;

    /// `A d`.
    fn inertia_times(&self, difference: &S::PerCoordinate<f64>) -> S::PerCoordinate<f64>;

    /// `a(q₀, p₀)`.
    fn start_row(&self, start: &StepStart<'_, S>) -> S::PerCoordinate<f64>;

    /// `k(q₀, d)`; adds `A − ∂k/∂d` to `kkt`.
    fn node_kick(
        &self,
        start: &StepStart<'_, S>,
        difference: &S::PerCoordinate<f64>,
        kkt: Option<&mut Kkt<S>>,
    ) -> S::PerCoordinate<f64>;

    /// Factors the matrix of the equations.
    ///
    /// # Errors
    /// [`SingularMatrix`] if they do not determine a correction.
    fn factor(kkt: Kkt<S>) -> Result<FactoredKkt<S, Self::Factors>, SingularMatrix>;

    /// The momentum `p⁻` at the end of a step.
    fn end_momentum(&self, start: &StepStart<'_, S>, solution: &StepSolution<S>) -> S::PerCoordinate<f64>;

    /// The residual at `(d, ℓ)`, the upper part of which belongs to the node kick `k(q₀, d)`.
    #[inline(always)]
    fn residual(
        &self,
        start: &StepStart<'_, S>,
        StepSolution { difference, impulse, node_kick }: &StepSolution<S>,
        at_end: &S::PerConstraint<f64>,
    ) -> S::PerUnknown<f64> {
        let (inertial, fixed) = (self.inertia_times(difference), self.start_row(start));
        let mut row = S::PerCoordinate::<f64>::from_fn(|i| inertial[i] + fixed[i] - node_kick[i]);
        self.mechanics().add_constraint_force(&start.jacobian, impulse, &mut row);
        unknowns::<S>(|i| row[i], |c| at_end[c])
    }

    /// The derivative of the residual at `(d, ℓ)`
    ///
    /// ```text
    /// [ A − ∂k/∂d  G₀ᵀ ]
    /// [ G₁         0   ]
    /// ```
    ///
    /// with the residual itself and, in the solution, the node kick there. `G₁` moves with the iterate: hence LU, not LDLᵀ.
    #[inline(always)]
    fn linearize(
        &self,
        start: &StepStart<'_, S>,
        solution: &mut StepSolution<S>,
    ) -> (S::PerUnknown<f64>, Kkt<S>) {
        let mut kkt = Kkt::zero();
        solution.node_kick = self.node_kick(start, &solution.difference, Some(&mut kkt));
        let (residual, jacobian) = self.constraints_at_end(start, &solution.difference);
        let constants = &self.mechanics().constants;
        kkt.set_upper_jacobian(constants, &start.jacobian);
        kkt.set_lower_jacobian(constants, &jacobian);
        (self.residual(start, solution, &residual), kkt)
    }

    /// `φ` and the varying entries of `G` at the end of the step.
    #[inline(always)]
    fn constraints_at_end(
        &self,
        start: &StepStart<'_, S>,
        difference: &S::PerCoordinate<f64>,
    ) -> (S::PerConstraint<f64>, S::PerJacobianEntry<f64>) {
        let end = Array::from_fn(|i| start.q[i] + difference[i]);
        S::constraint_derivatives(&self.mechanics().constants, start.t + self.h(), &end)
    }
}
