//! The midpoint step of a scene whose one force acts along a distance: one scalar equation, whatever the number of coordinates.
//!
//! With `L = ½ vᵀM v + fᵀq − F(r)`, where `r²` is a sum of squares of independent functions that are affine in `q`, and the midpoint
//! `x = q₀ + ½ d`, the step is a kick, a drift and the same kick again,
//!
//! ```text
//! p½ = p₀ + k      d = h M⁻¹ p½      p₁ = p½ + k      k = ½h (f − F'(r) u/r)      u = r ∂r/∂q at x
//! ```
//!
//! and `x = x̂ − ¼h² M⁻¹ u F'(r)/r` with the free midpoint `x̂ = q₀ + ½h M⁻¹ (p₀ + ½h f)`. `u` is affine in `x` with the matrix `Q = ½ ∂²r²/∂q²`, in the
//! range of which it lies. Where `Q M⁻¹ Q = μ Q`, as for all masses on one spring and in one gravitation, `Q M⁻¹ u = μ u`, and so
//!
//! ```text
//! u (1 + χ F'(r)/r) = û      r + χ F'(r) = r̂      u/r = û/r̂      χ = ¼h² μ
//! ```
//!
//! The free midpoint has the direction already. What is left is the force `Φ = F'(r̂ − χΦ)`, where Newton's iteration from `Φ = 0` makes the
//! corrections `(F' − Φ)/(1 + χF'')`: of a spring that is linear in `r` the first is exact. Later ones divide by what belongs to the one before.
//! No difference of large numbers appears, so that stiff forces leave round-off of the positions alone; and whatever is rounded of `Φ`, the kick is
//! the gradient of a function of `r`.

use core::borrow::Borrow;

use super::{AsMass, ConstantLegendre, CoordinateMatrix, Lost, Mechanics, RoundOff, Rows, State, Sum};
use crate::array::Array;
use crate::newton::{self, Tally};
use crate::scalar::Scalar;
use crate::system::{CentralForce, MechanicalSystem};

/// So many roundings of the products that it is made of, and `Q M⁻¹ Q` is still `μ Q`.
const ISOTROPIC: f64 = 16.0 * f64::EPSILON;
/// Squares of distances below have lost digits to underflow, or their terms have.
const SMALLEST: f64 = f64::MIN_POSITIVE / f64::EPSILON;
/// A correction has to be below half of the one before; where one of round-off is not, all coordinates are asked.
const SLOWEST: f64 = 0.5;
/// Corrections after which the step is left to the iteration in all coordinates. Three do where steps are short beside the motion.
const MOST_CORRECTIONS: usize = 8;

/// The midpoint step of a central force.
pub(crate) struct CentralStep<S: MechanicalSystem> {
    /// `½h f`.
    uniform_kick: S::PerCoordinate<f64>,
    /// `½h M⁻¹`.
    half_drift: CoordinateMatrix<S, AsMass>,
    /// `h M⁻¹`.
    drift: CoordinateMatrix<S, AsMass>,
    legendre: ConstantLegendre<S>,
    /// `h`.
    h: f64,
    /// `½h`.
    half_h: f64,
    /// `χ`.
    compliance: f64,
    /// `½h / (1 + χF'')` and `χ / (1 + χF'')` of a linear spring.
    of_spring: [f64; 2],
}

impl<S: MechanicalSystem> CentralStep<S> {
    /// Whether the scene's one force acts along a distance.
    pub(crate) const EXISTS: bool = S::STRUCTURE.central_force.is_some();
    const IS_LINEAR: bool = matches!(S::STRUCTURE.central_force, Some(CentralForce { is_linear: true, .. }));
    const IS_BESIDE_UNIFORM_FORCE: bool =
        matches!(S::STRUCTURE.central_force, Some(CentralForce { is_beside_uniform_force: true, .. }));

    /// The steps of size `h`; `None` where the masses turn the force away from the distance, or a linear spring pushes too hard for them.
    pub(crate) fn new(mechanics: &Mechanics<S>, h: f64) -> Option<Self> {
        let inverse_mass = CoordinateMatrix::<S, AsMass>::inverse_of(&mechanics.constant_mass()).ok()?;
        let metric = S::distance_metric(&mechanics.constants);
        let compliance = 0.25 * h * h * isotropic_mobility(&metric, &inverse_mass)?;
        // Of a linear spring F'' is the same at every distance.
        let [_, slope] = S::central_force(&mechanics.constants, 1.0);
        let softening = 1.0 + compliance * slope;
        let is_sound = !Self::IS_LINEAR || (softening > 0.0 && softening < f64::INFINITY);
        let half_h = 0.5 * h;
        let uniform = S::uniform_force(&mechanics.constants);
        let step = Self {
            uniform_kick: Array::from_fn(|i| half_h * uniform[i]),
            half_drift: inverse_mass.scaled(half_h),
            drift: inverse_mass.scaled(h),
            legendre: ConstantLegendre::new(mechanics).ok()?,
            h,
            half_h,
            compliance,
            of_spring: [half_h / softening, compliance / softening],
        };
        is_sound.then_some(step)
    }

    /// Overwrites `state` with the state one step later, and returns what its positions and momenta have lost. Where the distance or
    /// the force along it is not found, or the end is not finite, `None`, and the state is as it was.
    #[inline(always)]
    pub(crate) fn advance<R: RoundOff<S>>(
        &self,
        mechanics: &Mechanics<S>,
        state: &mut State<S>,
        round_off: R,
        tally: &mut impl Tally,
    ) -> Option<[Lost<S, R>; 2]> {
        let kick = self.kick(mechanics, &state.q, &state.p, tally)?;
        let momentum = round_off.momentum(&state.p).plus(&kick);
        let difference = {
            let half_way = momentum.value();
            self.drift.times(|i| half_way.borrow()[i])
        };
        let (q, lost_q) = round_off.position(&state.q).plus(&difference).split();
        let (p, lost_p) = momentum.plus(&kick).split();
        state.replace(state.t + self.h, q, self.legendre.velocity(&p), p).ok()?;
        Some([lost_q, lost_p])
    }

    /// `k`.
    #[inline(always)]
    fn kick(
        &self,
        mechanics: &Mechanics<S>,
        q: &S::PerCoordinate<f64>,
        p: &S::PerCoordinate<f64>,
        tally: &mut impl Tally,
    ) -> Option<S::PerCoordinate<f64>> {
        let half_way = self
            .half_drift
            .times(|i| if Self::IS_BESIDE_UNIFORM_FORCE { p[i] + self.uniform_kick[i] } else { p[i] });
        let free = Array::from_fn(|i| q[i] + half_way[i]);
        let (square, radial) = S::squared_distance(&mechanics.constants, &free);
        let is_in_range = square > SMALLEST && square < f64::INFINITY;
        if !is_in_range {
            return None;
        }
        let distance = Scalar::sqrt(square);
        let inverse_distance = 1.0 / distance;
        let impulse = if Self::IS_LINEAR {
            self.impulse_of_spring(mechanics, distance, tally)?
        } else {
            self.half_h * self.force(mechanics, distance, tally)?
        };
        let pull = impulse * inverse_distance;
        Some(Array::from_fn(|i| {
            if Self::IS_BESIDE_UNIFORM_FORCE {
                self.uniform_kick[i] - pull * radial[i]
            } else {
                -(pull * radial[i])
            }
        }))
    }

    /// `½h Φ` of a linear spring, from the distance `r̂` of the free midpoint; `None` unless `r > 0`.
    #[inline(always)]
    fn impulse_of_spring(
        &self,
        mechanics: &Mechanics<S>,
        distance: f64,
        tally: &mut impl Tally,
    ) -> Option<f64> {
        let [force, _] = S::central_force(&mechanics.constants, distance);
        let [half_h, compliance] = self.of_spring;
        let moved = compliance * force;
        // Written so that a NaN fails.
        if distance > moved {
            tally.begin_iteration();
            tally.see_correction(|| (moved / distance).abs());
            tally.count_corrections(1);
            return Some(half_h * force);
        }
        None
    }

    /// `Φ = F'(r)` at the midpoint, from the distance `r̂` of the free one; `None` where Newton's corrections do not lead there.
    #[inline(always)]
    fn force(&self, mechanics: &Mechanics<S>, distance: f64, tally: &mut impl Tally) -> Option<f64> {
        // `1/(1 + χF'')` of the correction before, and its length; 0 before the first.
        let (mut force, mut last, mut previous) = (0.0, 0.0, 0.0);
        tally.begin_iteration();
        for corrections in 1..=MOST_CORRECTIONS {
            let midway = distance - self.compliance * force;
            let [value, slope] = S::central_force(&mechanics.constants, midway);
            let softening = 1.0 + self.compliance * slope;
            // The first waits for the slope. The others are short, and take that of the evaluation before: their division runs beside.
            let fresh = 1.0 / softening;
            let softened = if corrections == 1 { fresh } else { last };
            let correction = (value - force) * softened;
            let length = correction.abs();
            // Written so that a NaN is refused.
            let contracts = corrections == 1 || length <= SLOWEST * previous;
            let is_led = midway > 0.0 && softening > 0.0 && contracts && length < f64::INFINITY;
            if !is_led {
                return None;
            }
            force += correction;
            tally.see_correction(|| self.compliance * length / distance);
            // What is rounded of the force, and what a rounding of the distance makes of it.
            let scale = force.abs() + (slope * softened).abs() * distance;
            if newton::predicts_round_off(length, previous, scale) {
                tally.count_corrections(corrections);
                return Some(force);
            }
            (last, previous) = (fresh, length);
        }
        None
    }
}

/// `μ` of `Q M⁻¹ Q = μ Q`, if there is one.
fn isotropic_mobility<S: MechanicalSystem>(
    metric: &Rows<S>,
    inverse_mass: &CoordinateMatrix<S, AsMass>,
) -> Option<f64> {
    let n = S::N_COORDINATES;
    let product: Rows<S> = Array::from_fn(|row| {
        let moved = inverse_mass.times(|k| metric[k][row]);
        Array::from_fn(|col| (0..n).map(|k| metric[col][k] * moved[k]).sum())
    });
    let largest = (0..n).max_by(|&i, &k| metric[i][i].total_cmp(&metric[k][k]))?;
    let mobility = product[largest][largest] / metric[largest][largest];
    let is_proportional = |row: usize, col: usize| {
        // Entries of a positive semidefinite matrix are below those of its diagonal.
        let allowed = ISOTROPIC * mobility * Scalar::sqrt(metric[row][row] * metric[col][col]);
        (product[row][col] - mobility * metric[row][col]).abs() <= allowed
    };
    let holds = mobility > 0.0
        && mobility < f64::INFINITY
        && (0..n).all(|row| (0..n).all(|col| is_proportional(row, col)));
    holds.then_some(mobility)
}
