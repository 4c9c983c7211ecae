//! The Legendre transform of a scene with a constant mass matrix, `p = M v + a`, inverted once.

use core::borrow::Borrow;

use super::constraints::Gram;
use super::{AsMass, CoordinateMatrix, Mechanics, NOTHING, Sum};
use crate::array::Array;
use crate::linear::{Conditioning, Factorization, SingularMatrix, reciprocal_power_of_two};
use crate::newton::Tally;
use crate::scalar::Scalar;
use crate::system::{LagrangianGradient, MechanicalSystem};

/// Kinetic energy of the velocities that are removed, relative to that of the motion, up to which one projection does: the
/// velocities are then below 1/128 of the motion's.
pub(crate) const LARGEST_REST: f64 = 1.0 / 16384.0;

/// How well `G M⁻¹ Gᵀ` determines multipliers, in units in which its diagonal is about 1.
fn gram_conditioning<S: MechanicalSystem>(matrix: &Gram<S>) -> Conditioning {
    let scale =
        S::PerConstraint::<f64>::from_fn(|c| reciprocal_power_of_two(Scalar::sqrt(matrix[c][c].abs())));
    let scaled: Gram<S> =
        Array::from_fn(|row| Array::from_fn(|col| matrix[row][col] * scale[row] * scale[col]));
    Conditioning::of::<_, _, S::PerConstraint<usize>>(&scaled)
}

/// `v = M⁻¹ (p − a)` with constant `M` and `a`.
pub(crate) struct ConstantLegendre<S: MechanicalSystem> {
    inverse_mass: CoordinateMatrix<S, AsMass>,
    /// `a = ∂L/∂v` at `v = 0`.
    momentum_at_rest: S::PerCoordinate<f64>,
}

impl<S: MechanicalSystem> ConstantLegendre<S> {
    /// Whether the scene's transform is of this kind.
    pub(crate) const EXISTS: bool = S::STRUCTURE.is_separable_with_constant_mass();

    /// # Errors
    /// [`SingularMatrix`] if `M` is singular: then the constraints are needed to determine the velocity.
    pub(crate) fn new(mechanics: &Mechanics<S>) -> Result<Self, SingularMatrix> {
        let at_rest = Array::from_fn(|_| 0.0);
        let LagrangianGradient { momentum, .. } =
            S::lagrangian_gradient(&mechanics.constants, 0.0, &at_rest, &at_rest);
        let inverse_mass = CoordinateMatrix::inverse_of(&mechanics.constant_mass())?;
        Ok(Self { inverse_mass, momentum_at_rest: momentum })
    }

    /// `M⁻¹`.
    #[cfg(feature = "std")]
    #[inline(always)]
    pub(crate) const fn inverse_mass(&self) -> &CoordinateMatrix<S, AsMass> {
        &self.inverse_mass
    }

    /// `a`.
    #[cfg(feature = "std")]
    pub(crate) const fn momentum_at_rest(&self) -> &S::PerCoordinate<f64> {
        &self.momentum_at_rest
    }

    /// The velocity of the momentum `p`.
    #[inline(always)]
    pub(crate) fn velocity(&self, p: &S::PerCoordinate<f64>) -> S::PerCoordinate<f64> {
        self.inverse_mass.times(|i| self.moving_momentum(p, i))
    }

    /// `M v = p − a`; of what is added to a momentum, with the same `a`.
    #[inline(always)]
    pub(crate) fn moving(&self, p: &S::PerCoordinate<f64>) -> S::PerCoordinate<f64> {
        Array::from_fn(|i| self.moving_momentum(p, i))
    }

    /// `p = M v + a`, from `M v`; of what is added to it, with the same `a`.
    #[inline(always)]
    pub(crate) fn canonical(&self, moving: &S::PerCoordinate<f64>) -> S::PerCoordinate<f64> {
        if S::STRUCTURE.momentum_vanishes_at_rest {
            moving.clone()
        } else {
            Array::from_fn(|i| moving[i] + self.momentum_at_rest[i])
        }
    }

    /// Factors of `G M⁻¹ Gᵀ`.
    ///
    /// # Errors
    /// [`SingularMatrix`] where the constraints are dependent.
    #[inline(always)]
    pub(crate) fn factor_gram(
        &self,
        mechanics: &Mechanics<S>,
        jacobian: &S::PerJacobianEntry<f64>,
        tally: &mut impl Tally,
    ) -> Result<S::GramFactors, SingularMatrix> {
        self.factored_gram(mechanics, jacobian, tally, S::GramFactors::factor_of_any_size)
    }

    /// The same for a step that takes another way where products of masses leave the numbers.
    ///
    /// # Errors
    /// As [`factor_gram`](Self::factor_gram), and there.
    #[inline(always)]
    pub(crate) fn factor_usual_gram(
        &self,
        mechanics: &Mechanics<S>,
        jacobian: &S::PerJacobianEntry<f64>,
        tally: &mut impl Tally,
    ) -> Result<S::GramFactors, SingularMatrix> {
        self.factored_gram(mechanics, jacobian, tally, S::GramFactors::factor)
    }

    /// `G M⁻¹ Gᵀ`, as `factor` factors it.
    #[inline(always)]
    fn factored_gram(
        &self,
        mechanics: &Mechanics<S>,
        jacobian: &S::PerJacobianEntry<f64>,
        tally: &mut impl Tally,
        factor: impl FnOnce(&Gram<S>) -> Result<S::GramFactors, SingularMatrix>,
    ) -> Result<S::GramFactors, SingularMatrix> {
        let directions = mechanics.constraint_directions(jacobian, &self.inverse_mass);
        let matrix = mechanics.gram_matrix::<AsMass>(jacobian, &directions);
        tally.see_matrix(|| gram_conditioning::<S>(&matrix));
        let gram = factor(&matrix)?;
        if gram.is_fallback() {
            tally.count_fallback();
        }
        Ok(gram)
    }

    /// Removes from the `momentum` the impulse `Gᵀ N` that leaves the constraints, `G M⁻¹ Gᵀ N = G v + ∂φ/∂t`, with the
    /// factors of that matrix, and returns the velocity and the momentum that are left. `expected` is close to `N`.
    ///
    /// Near a turning point `v` is a small difference of large velocities, whose round-off would stay. Without `expected`
    /// they are small as well, but for the slowest motions: these are projected once more.
    #[inline(always)]
    pub(crate) fn project<P: Sum<S>>(
        &self,
        mechanics: &Mechanics<S>,
        gram: &S::GramFactors,
        jacobian: &S::PerJacobianEntry<f64>,
        expected: &S::PerConstraint<f64>,
        mut momentum: P,
    ) -> (S::PerCoordinate<f64>, P) {
        mechanics.subtract_constraint_force(jacobian, expected, momentum.terms_mut());
        let removed = self.remove_rest(mechanics, gram, jacobian, &mut momentum);
        let v = self.velocity(momentum.value().borrow());
        if removed > LARGEST_REST * self.doubled_energy(momentum.value().borrow(), &v) {
            return self.projected_again(mechanics, gram, jacobian.clone(), momentum);
        }
        (v, momentum)
    }

    /// By value: what it takes need not lie in memory until then.
    #[cold]
    fn projected_again<P: Sum<S>>(
        &self,
        mechanics: &Mechanics<S>,
        gram: &S::GramFactors,
        jacobian: S::PerJacobianEntry<f64>,
        mut momentum: P,
    ) -> (S::PerCoordinate<f64>, P) {
        self.remove_rest(mechanics, gram, &jacobian, &mut momentum);
        let v = self.velocity(momentum.value().borrow());
        (v, momentum)
    }

    /// Removes what leaves the constraints, and returns twice the kinetic energy that it had.
    #[inline(always)]
    fn remove_rest(
        &self,
        mechanics: &Mechanics<S>,
        gram: &S::GramFactors,
        jacobian: &S::PerJacobianEntry<f64>,
        momentum: &mut impl Sum<S>,
    ) -> f64 {
        let rate = mechanics.constraint_rate(jacobian, &self.velocity(momentum.value().borrow()));
        let mut rest = rate.clone();
        let factor = gram.solve_up_to_factor(&mut rest);
        let mut force = S::PerCoordinate::<f64>::from_fn(|_| NOTHING);
        mechanics.add_constraint_force(jacobian, &rest, &mut force);
        for i in 0..S::N_COORDINATES {
            momentum.terms_mut()[i] -= factor * force[i];
        }
        factor * (0..S::N_CONSTRAINTS).map(|c| rest[c] * rate[c]).sum::<f64>()
    }

    /// `(p − a) · v`.
    #[inline(always)]
    fn doubled_energy(&self, p: &S::PerCoordinate<f64>, v: &S::PerCoordinate<f64>) -> f64 {
        (0..S::N_COORDINATES).map(|i| self.moving_momentum(p, i) * v[i]).sum()
    }

    /// `p − a`, coordinate `i`.
    #[inline(always)]
    pub(crate) fn moving_momentum(&self, p: &S::PerCoordinate<f64>, i: usize) -> f64 {
        if S::STRUCTURE.momentum_vanishes_at_rest { p[i] } else { p[i] - self.momentum_at_rest[i] }
    }
}
