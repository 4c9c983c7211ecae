//! The Legendre transform of a scene with a constant mass matrix, `p = M v + a`, inverted once.

use core::borrow::Borrow;

use super::constraints::Gram;
use super::{AsMass, CoordinateMatrix, Mechanics, NOTHING, Sum};
use crate::array::Array;
use crate::linear::{Cholesky, Conditioning, Factorization, SingularMatrix, reciprocal_power_of_two};
use crate::newton::Tally;
use crate::scalar::Scalar;
use crate::system::{Entry, LagrangianGradient, MechanicalSystem};

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

/// `1/(G_c M⁻¹ G_cᵀ)` of masses at fixed distances of the origin, `½ |q_I|² = −φ_c(0)`, `G_c = q_I`: `1/(−2 φ_c(0) M⁻¹_ii)`.
fn constant_inverse_gram<S: MechanicalSystem>(
    mechanics: &Mechanics<S>,
    inverse_mass: &CoordinateMatrix<S, AsMass>,
) -> S::PerConstraint<f64> {
    let (at_origin, _) = mechanics.primitive_constraints(0.0, &Array::from_fn(|_| 0.0));
    let mut inverse = S::PerConstraint::<f64>::from_fn(|_| f64::NAN);
    for Entry { row, col, .. } in S::STRUCTURE.jacobian.q {
        let reciprocal = 1.0 / (-2.0 * at_origin[*row] * inverse_mass.at(*col, *col));
        if reciprocal.is_normal() {
            inverse[*row] = reciprocal;
        }
    }
    inverse
}

/// `v = M⁻¹ (p − a)` with constant `M` and `a`.
pub(crate) struct ConstantLegendre<S: MechanicalSystem> {
    inverse_mass: CoordinateMatrix<S, AsMass>,
    /// `a = ∂L/∂v` at `v = 0`.
    momentum_at_rest: S::PerCoordinate<f64>,
    /// [`LARGEST_REST`], of masses that are positive; NaN of others, with which an energy says little.
    largest_rest: f64,
    /// The diagonal of `(G M⁻¹ Gᵀ)⁻¹`, in units of the content, of scenes where it is constant; NaN where it is no number to rely on.
    inverse_gram: S::PerConstraint<f64>,
}

impl<S: MechanicalSystem> ConstantLegendre<S> {
    /// Whether the scene's transform is of this kind.
    pub(crate) const EXISTS: bool = S::STRUCTURE.is_separable_with_constant_mass();

    /// Whether `G M⁻¹ Gᵀ` is the same wherever the constraints hold.
    const HAS_CONSTANT_GRAM: bool = S::STRUCTURE.has_constant_gram();

    /// # Errors
    /// [`SingularMatrix`] if `M` is singular: then the constraints are needed to determine the velocity.
    pub(crate) fn new(mechanics: &Mechanics<S>) -> Result<Self, SingularMatrix> {
        let at_rest = Array::from_fn(|_| 0.0);
        let LagrangianGradient { momentum, .. } =
            S::lagrangian_gradient(&mechanics.constants, 0.0, &at_rest, &at_rest);
        let inverse_mass = CoordinateMatrix::inverse_of(&mechanics.constant_mass())?;
        let inverse_gram = if Self::HAS_CONSTANT_GRAM {
            constant_inverse_gram(mechanics, &inverse_mass)
        } else {
            Array::from_fn(|_| f64::NAN)
        };
        let is_positive = Cholesky::new::<S::PerCoordinate<f64>>(&mechanics.constant_mass()).is_some();
        let largest_rest = if is_positive { LARGEST_REST } else { f64::NAN };
        Ok(Self { inverse_mass, momentum_at_rest: momentum, largest_rest, inverse_gram })
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

    /// `G M⁻¹ Gᵀ`, as `factor` factors it.
    #[inline(always)]
    fn factored_gram(
        &self,
        mechanics: &Mechanics<S>,
        jacobian: &S::PerJacobianEntry<f64>,
        tally: &mut impl Tally,
        factor: impl FnOnce(&Gram<S>) -> Result<S::GramFactors, SingularMatrix>,
    ) -> Result<S::GramFactors, SingularMatrix> {
        let matrix = mechanics.symmetric_gram_matrix(jacobian, &self.inverse_mass);
        tally.see_matrix(|| gram_conditioning::<S>(&matrix));
        let gram = factor(&matrix)?;
        if gram.is_fallback() {
            tally.count_fallback();
        }
        Ok(gram)
    }

    /// [`project`](Self::project) at `(t, q)`, for a step that takes another way where this one does not lead: `None` where the constraints are dependent, or
    /// a momentum or velocity is not finite.
    #[inline(always)]
    pub(crate) fn project_as_expected<P: Sum<S>>(
        &self,
        mechanics: &Mechanics<S>,
        (t, q): (f64, &S::PerCoordinate<f64>),
        expected: &S::PerConstraint<f64>,
        mut momentum: P,
        tally: &mut impl Tally,
    ) -> Option<(S::PerCoordinate<f64>, P)> {
        let (_, jacobian) = mechanics.primitive_constraints(t, q);
        mechanics.subtract_constraint_force(&jacobian, expected, momentum.terms_mut());
        let removed = if Self::HAS_CONSTANT_GRAM {
            tally.see_matrix(|| {
                gram_conditioning::<S>(&mechanics.symmetric_gram_matrix(&jacobian, &self.inverse_mass))
            });
            self.remove_rest(mechanics, &jacobian, &mut momentum, |rest| {
                *rest = Array::from_fn(|c| rest[c] * self.inverse_gram[c]);
                1.0
            })
        } else {
            let gram =
                self.factored_gram(mechanics, &jacobian, tally, S::GramFactors::factor_unguarded).ok()?;
            let solve = |rest: &mut S::PerConstraint<f64>| gram.solve_up_to_factor(rest);
            self.remove_rest(mechanics, &jacobian, &mut momentum, solve) + gram.doubt()
        };
        let mut v = self.velocity(momentum.value().borrow());
        let energy = self.doubled_energy(momentum.value().borrow(), &v);
        // False of a NaN.
        let is_done = removed <= self.largest_rest * energy;
        if !is_done {
            (v, momentum) = self.projected_anew(mechanics, t, q.clone(), momentum)?;
        }
        // A sum of products is finite only if all factors are; those of other masses have been looked at.
        (energy < f64::INFINITY).then_some((v, momentum))
    }

    /// By value, and evaluated anew: nothing that it takes need lie in memory until then.
    #[cold]
    fn projected_anew<P: Sum<S>>(
        &self,
        mechanics: &Mechanics<S>,
        t: f64,
        q: S::PerCoordinate<f64>,
        momentum: P,
    ) -> Option<(S::PerCoordinate<f64>, P)> {
        let (_, jacobian) = mechanics.primitive_constraints(t, &q);
        let gram = self.factor_gram(mechanics, &jacobian, &mut ()).ok()?;
        let (v, momentum) = self.projected_again(mechanics, &gram, jacobian, momentum);
        let is_finite = v.as_ref().iter().chain(momentum.value().borrow().as_ref()).all(|x| x.is_finite());
        is_finite.then_some((v, momentum))
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
        let removed =
            self.remove_rest(mechanics, jacobian, &mut momentum, |rest| gram.solve_up_to_factor(rest));
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
        self.remove_rest(mechanics, &jacobian, &mut momentum, |rest| gram.solve_up_to_factor(rest));
        let v = self.velocity(momentum.value().borrow());
        (v, momentum)
    }

    /// Removes what leaves the constraints, and returns twice the kinetic energy that it had. `solve` overwrites a rate with its impulse over the
    /// factor that it returns.
    #[inline(always)]
    fn remove_rest(
        &self,
        mechanics: &Mechanics<S>,
        jacobian: &S::PerJacobianEntry<f64>,
        momentum: &mut impl Sum<S>,
        solve: impl FnOnce(&mut S::PerConstraint<f64>) -> f64,
    ) -> f64 {
        let rate = if Self::HAS_CONSTANT_GRAM {
            let value = momentum.value();
            let mut rate = S::PerConstraint::<f64>::from_fn(|_| NOTHING);
            S::for_each_slope(&mechanics.constants, jacobian, |row, col, slope| {
                rate[row] +=
                    (slope * self.inverse_mass.at(col, col)) * self.moving_momentum(value.borrow(), col);
            });
            rate
        } else {
            mechanics.constraint_rate(jacobian, &self.velocity(momentum.value().borrow()))
        };
        let mut rest = rate.clone();
        let factor = solve(&mut rest);
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
        let (mut even, mut odd) = (NOTHING, NOTHING);
        for i in 0..S::N_COORDINATES {
            let sum = if i % 2 == 0 { &mut even } else { &mut odd };
            *sum += self.moving_momentum(p, i) * v[i];
        }
        even + odd
    }

    /// `p − a`, coordinate `i`.
    #[inline(always)]
    pub(crate) fn moving_momentum(&self, p: &S::PerCoordinate<f64>, i: usize) -> f64 {
        if S::STRUCTURE.momentum_vanishes_at_rest { p[i] } else { p[i] - self.momentum_at_rest[i] }
    }
}
