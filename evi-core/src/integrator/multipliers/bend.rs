//! What a correction leaves of quadratic constraints, `½ dᵀ φ_qq d` of a displacement `d`, and what of it is round-off.

use crate::array::Array;
use crate::mechanics::{Mechanics, NOTHING, over_content};
use crate::newton;
use crate::scalar::Scalar;
use crate::system::MechanicalSystem;

/// How far from straight quadratic constraints are.
// Aligned, so that instructions on two numbers take them from where they are.
#[repr(C, align(16))]
pub(super) struct Bend<S: MechanicalSystem> {
    /// What `Σ dᵢ²` of a displacement may be that leaves no more than that of any constraint, a number; NaN where it is not known.
    limit: f64,
    /// What is round-off of each residual, where it is the same for every configuration on the constraints.
    allowed: Option<S::PerConstraint<f64>>,
}

impl<S: MechanicalSystem> Bend<S> {
    /// Whether matrices `G₁ D G₀ᵀ` are finite where residuals are, or nothing is taken for round-off at once: masses at fixed distances `l` begin at `|G₀| = l`, so that
    /// `D l` tells how large a `G₁` may be, the square of which is a residual.
    pub(super) const VOUCHES_FOR_MATRICES: bool = S::STRUCTURE.has_constant_gram();

    pub(super) fn new(mechanics: &Mechanics<S>, drift: impl Fn(usize) -> f64) -> Self {
        let allowed = mechanics.constant_reach().map(over_content::<S>).map(round_off_of);
        let limit = match &allowed {
            Some(allowed) if !Self::VOUCHES_FOR_MATRICES || are_in_range(mechanics, drift) => {
                mechanics.straight_up_to(allowed)
            }
            _ => f64::NAN,
        };
        Self { limit, allowed }
    }

    /// Whether a correction by `moved` leaves round-off for certain. `doubt` is 0, or NaN.
    #[inline(always)]
    pub(super) fn is_round_off(&self, moved: &S::PerCoordinate<f64>, doubt: f64) -> bool {
        let (mut even, mut odd) = (NOTHING, NOTHING);
        for i in 0..S::N_COORDINATES {
            let sum = if i % 2 == 0 { &mut even } else { &mut odd };
            *sum += moved[i] * moved[i];
        }
        // False of a NaN.
        even + odd + doubt <= self.limit
    }

    /// What is round-off of each residual, at a configuration with this `G q`.
    #[inline(always)]
    pub(super) fn allowed(&self, reach: impl FnOnce() -> S::PerConstraint<f64>) -> S::PerConstraint<f64> {
        match &self.allowed {
            Some(allowed) => allowed.clone(),
            None => round_off_of(reach()),
        }
    }
}

/// Whether `D l` of every mass at a distance `l` is below the root of the largest number.
fn are_in_range<S: MechanicalSystem>(mechanics: &Mechanics<S>, drift: impl Fn(usize) -> f64) -> bool {
    let (at_origin, _) = mechanics.primitive_constraints(0.0, &Array::from_fn(|_| 0.0));
    let largest = Scalar::sqrt(f64::MAX);
    let mut slopes = S::STRUCTURE.jacobian.q.iter();
    slopes.all(|slope| drift(slope.col).abs() * Scalar::sqrt(-2.0 * at_origin[slope.row]) < largest)
}

/// What is round-off of the residuals of quadratic constraints whose `G q` is `reach`.
#[inline(always)]
fn round_off_of<C: Array<f64>>(reach: C) -> C {
    Array::from_fn(|c| newton::TARGET * reach[c].abs())
}

#[cfg(all(test, feature = "derive"))]
mod tests {
    use super::*;

    /// A rod beside a mass on an ellipse in other units.
    #[derive(evi_macros::MechanicalSystem)]
    #[evi(
        coordinates(x, y, z, w),
        kinetic = 0.5 * m * (der(x).powi(2) + der(y).powi(2) + der(z).powi(2) + der(w).powi(2)),
        potential = 0.0,
        constraint(rod: (z - x).powi(2) + (w - y).powi(2) == l.powi(2)),
        constraint(ellipse: 0.5 * x.powi(2) + 3.0 * x * y + 20.0 * y.powi(2) == r),
    )]
    struct Bent {
        m: f64,
        l: f64,
        r: f64,
    }

    #[test]
    fn a_displacement_within_the_limit_leaves_no_more_than_is_allowed() {
        let mechanics = Mechanics::new(&Bent { m: 1.0, l: 0.3, r: 7.0 });
        let bend = Bend::new(&mechanics, |_| 1.0);
        let allowed = bend.allowed(|| unreachable!("both are forms"));
        let mut closest = 0.0;
        for k in 0..2000 {
            let angle = |i: usize| f64::from(k) * [0.7, 1.3, 2.9][i];
            let [a, b, c] = [0, 1, 2].map(angle);
            let direction = [a.cos() * b.cos(), a.cos() * b.sin(), a.sin() * c.cos(), a.sin() * c.sin()];
            let moved = direction.map(|x: f64| x * bend.limit.sqrt() * (1.0 - 1e-12));
            assert!(bend.is_round_off(&moved, 0.0));
            let curvature = Bent::constraint_curvature(&mechanics.constants, 0.0, &[0.0; 4], &moved);
            let left = over_content::<Bent>(curvature.map(|x| 0.5 * x));
            for c in 0..2 {
                assert!(left[c].abs() <= allowed[c], "{left:?} of {allowed:?}");
                closest = f64::max(closest, left[c].abs() / allowed[c]);
            }
        }
        // The bound is a bound by sums of magnitudes, not the sharp one, but of its size.
        assert!(closest > 0.25, "{closest}");
        assert!(!bend.is_round_off(&[f64::NAN; 4], 0.0) && !bend.is_round_off(&[1.0; 4], 0.0));
        assert!(!bend.is_round_off(&[0.0; 4], f64::NAN));
    }
}
