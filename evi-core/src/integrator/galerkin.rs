//! Galerkin variational integrators: order `2K` in one step with inner points, each of them on the constraints.

use super::{Compensable, CompensableStep, IterationFailure, OneStep, Scheme, StepError, Symmetric, Tally};
use crate::array::Array;
use crate::linear::{InPlaceLu, constraint_index, largest_magnitude};
use crate::mechanics::{
    Dropped, GalerkinAction, Lost, LostDigits, Mechanics, Points, RoundOff, State, Sum, relative,
};
use crate::newton::{self, Converged};
use crate::scheme::{Frequency, Linear, NodalCurves, NodalTables, SchemeError, checked_step_size};
use crate::system::MechanicalSystem;

/// A Galerkin variational integrator with `K` intervals between Lobatto nodes, `1 ≤ K ≤ 8`.
///
/// The curve of a step is a polynomial of degree `K`, or with a [`Frequency`] an element of
/// `span{1, t, …, t^(K−2), cos ωt, sin ωt}`, through `K + 1` points at the Lobatto nodes; the action is Lobatto's rule on these nodes; every
/// point satisfies the constraints. Of order `2K` in positions, velocities, energy and the multipliers that
/// [`Mechanics::acceleration`] recovers, symplectic on the constraint manifold, time-symmetric (Jay, SIAM J. Numer. Anal. 33 (1996) 368;
/// Wenger, Ober-Blöbaum, Leyendecker, Adv. Comput. Math. 43 (2017) 1163). Inner velocities need not satisfy the hidden constraints,
/// and are not reported.
///
/// Linear momentum is kept by polynomials, and by every frequency from `K = 2` on, since the curves then contain the
/// constants. One interval is RATTLE, and with a frequency the exponential integrator on the trapezoidal rule.
///
/// A step solves for `K (n + m)` unknowns at once, by Newton's iteration with the exact derivative. It pays where a large step of
/// high order is wanted: `K` of 3 to 5 for errors of 1e-8 to 1e-12. For 1e-4 an [`Evi`](super::Evi) is cheaper.
///
/// ```
/// use evi_core::prelude::*;
/// let order_6 = Galerkin::<3>::new(0.1);
/// let exponential = Galerkin::<3>::new(0.1).frequency(3.13);
/// # let _ = (order_6, exponential);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Galerkin<const K: usize, F = Linear> {
    h: f64,
    curves: F,
}

impl<const K: usize> Galerkin<K> {
    /// The member on polynomials, for steps of size `h`.
    pub const fn new(h: f64) -> Self {
        Self { h, curves: Linear }
    }

    /// Gives every coordinate the same frequency.
    pub fn frequency(self, frequency: impl Into<Frequency>) -> Galerkin<K, Frequency> {
        Galerkin { h: self.h, curves: frequency.into() }
    }

    /// Gives coordinate `i` the frequency `frequencies[i]`; [`Frequency::ZERO`] stands for a polynomial.
    pub fn frequencies<const N: usize>(self, frequencies: [Frequency; N]) -> Galerkin<K, [Frequency; N]> {
        Galerkin { h: self.h, curves: frequencies }
    }
}

impl<const K: usize, F: Clone> Symmetric for Galerkin<K, F> {
    fn step_size(&self) -> f64 {
        self.h
    }

    fn with_step_size(&self, h: f64) -> Self {
        Self { h, curves: self.curves.clone() }
    }

    fn check_symmetry(&self) -> Result<(), SchemeError> {
        Ok(())
    }
}

impl<const K: usize, F> Compensable for Galerkin<K, F> {}

impl<S: MechanicalSystem, const K: usize, F: NodalCurves<S>> Scheme<S> for Galerkin<K, F> {
    type Step = GalerkinStep<S, F, K>;

    fn prepare(&self, mechanics: Mechanics<S>) -> Result<Self::Step, SchemeError> {
        let h = checked_step_size(self.h)?;
        let action = GalerkinAction::new(mechanics, self.curves.tables::<K>(h)?, h);
        Ok(GalerkinStep {
            extrapolation: Extrapolation::new(&action),
            newton: NewtonStorage::new::<S, K>(),
            action,
            past: None,
        })
    }
}

/// The one-step map of a [`Galerkin`] scheme, with the storage of its iteration: nothing is allocated under a step.
pub struct GalerkinStep<S: MechanicalSystem, F: NodalCurves<S>, const K: usize> {
    action: GalerkinAction<S, F::Tables<K>, K>,
    extrapolation: Extrapolation<K>,
    newton: NewtonStorage,
    /// The points of the last step: the first guess of the next. They affect the number of corrections and the last bits of a
    /// state, nothing else.
    past: Option<Points<S, K>>,
}

impl<S: MechanicalSystem, F: NodalCurves<S>, const K: usize> OneStep<S> for GalerkinStep<S, F, K> {
    fn h(&self) -> f64 {
        self.action.h()
    }

    fn mechanics(&self) -> &Mechanics<S> {
        &self.action.mechanics
    }

    fn advance(&mut self, state: &mut State<S>, tally: &mut impl Tally) -> Result<(), StepError> {
        self.advance_with(state, Dropped, tally).map(drop)
    }
}

impl<S: MechanicalSystem, F: NodalCurves<S>, const K: usize> CompensableStep<S> for GalerkinStep<S, F, K> {
    fn advance_compensated(
        &mut self,
        state: &mut State<S>,
        lost: &mut LostDigits<S>,
        tally: &mut impl Tally,
    ) -> Result<(), StepError> {
        let [q, p] = self.advance_with(state, &*lost, tally)?;
        *lost = LostDigits::new(q, p);
        Ok(())
    }
}

impl<S: MechanicalSystem, F: NodalCurves<S>, const K: usize> GalerkinStep<S, F, K> {
    #[inline]
    fn advance_with<R: RoundOff<S>>(
        &mut self,
        state: &mut State<S>,
        round_off: R,
        tally: &mut impl Tally,
    ) -> Result<[Lost<S, R>; 2], StepError> {
        let points = self.solve(state, tally)?;
        let t = state.t + self.action.h();
        let (q, lost_q) = round_off.position(&state.q).plus(&points.differences[K - 1]).split();
        let mut momentum = round_off.momentum(&state.p).plus(&self.action.momentum_gain(state, &points));
        let guess = self.action.velocity(&state.q, &points, K);
        let v = self
            .mechanics()
            .project_momentum(t, &q, &mut momentum, guess, tally)
            .map_err(|cause| StepError::Projection { t, cause })?;
        let (p, lost_p) = momentum.split();
        state.replace(t, q, v, p)?;
        self.past = Some(points);
        Ok([lost_q, lost_p])
    }

    /// The points of the step from `state`: by Newton's iteration from the curve of the last step, continued, where that stays near
    /// the parabola with the acceleration of the state; else, or if it does not converge, from the parabola.
    ///
    /// At large steps a continued polynomial ends anywhere, and Newton's iteration from there at another solution of the
    /// equations (double pendulum from the horizontal, h = 0.1: the step equations are lost after 100 to 1,000 steps). Near the parabola
    /// it saves up to one correction in three for large `K`.
    fn solve(&mut self, state: &State<S>, tally: &mut impl Tally) -> Result<Points<S, K>, StepError> {
        let scale = self.mechanics().unit_scale(state.t, &state.q, &state.v);
        let mut points = self.parabola(state)?;
        if let Some(past) = &self.past {
            let mut continued = self.extrapolation.continued(past);
            if continued.is_near(&points, scale.as_ref())
                && self.newton.iterate(&self.action, state, &scale, &mut continued, tally).is_ok()
            {
                return Ok(continued);
            }
        }
        self.newton.iterate(&self.action, state, &scale, &mut points, tally)?;
        Ok(points)
    }

    /// The parabola with the acceleration and the multipliers of the state.
    fn parabola(&self, state: &State<S>) -> Result<Points<S, K>, StepError> {
        let (t, h) = (state.t, self.action.h());
        let start = self
            .mechanics()
            .acceleration_with(t, &state.q, &state.v, &state.inputs)
            .map_err(|matrix| StepError::Singular { t, correction: 0, matrix })?;
        let nodes = &self.action.nodes;
        Ok(Points {
            differences: core::array::from_fn(|a| {
                let time = h * nodes.node(a + 1);
                Array::from_fn(|i| time * (state.v[i] + 0.5 * time * start.acceleration[i]))
            }),
            impulses: core::array::from_fn(|a| {
                Array::from_fn(|c| h * h * nodes.weights[a] * start.multipliers[c])
            }),
        })
    }
}

/// Continues the polynomials through the points of a step over the next.
struct Extrapolation<const K: usize> {
    /// Difference `a` of the next step per difference `b` of the last.
    differences: [[f64; K]; K],
    /// Impulse `a` per impulse `b`.
    impulses: [[f64; K]; K],
}

impl<const K: usize> Extrapolation<K> {
    fn new<S: MechanicalSystem, T: NodalTables<K>>(action: &GalerkinAction<S, T, K>) -> Self {
        let nodes = &action.nodes;
        let table = |entry: &dyn Fn(usize, usize) -> f64| {
            core::array::from_fn(|a| core::array::from_fn(|b| entry(a, b)))
        };
        let is_end = |b: usize| if b + 1 == K { 1.0 } else { 0.0 };
        Self {
            differences: table(&|a, b| nodes.lagrange(K, b + 1, 1.0 + nodes.offsets[a + 1]) - is_end(b)),
            // The multipliers λ of the nodes before the last, weighted again.
            impulses: table(&|a, b| {
                nodes.weights[a] / nodes.weights[b] * nodes.lagrange(K - 1, b, 1.0 + nodes.offsets[a])
            }),
        }
    }

    fn continued<S: MechanicalSystem>(&self, past: &Points<S, K>) -> Points<S, K> {
        Points {
            differences: core::array::from_fn(|a| {
                Array::from_fn(|i| {
                    (0..K).map(|b| self.differences[a][b] * past.differences[b][i]).sum::<f64>()
                })
            }),
            impulses: core::array::from_fn(|a| {
                Array::from_fn(|c| (0..K).map(|b| self.impulses[a][b] * past.impulses[b][c]).sum::<f64>())
            }),
        }
    }
}

/// `max |xᵢ| / Dᵢ` over the coordinates.
fn length_in_units(x: &[f64], scale: &[f64]) -> f64 {
    largest_magnitude(x.iter().zip(scale).map(|(x, scale)| x / scale))
}

impl<S: MechanicalSystem, const K: usize> Points<S, K> {
    /// Whether no point is farther from that of `other` than a tenth of the way that `other` makes.
    fn is_near(&self, other: &Self, scale: &[f64]) -> bool {
        const NEAR: f64 = 0.1;
        let (mut distance, mut way) = (0.0, 0.0);
        for (here, there) in self.differences.iter().zip(&other.differences) {
            let difference = S::PerCoordinate::<f64>::from_fn(|i| here[i] - there[i]);
            distance = largest_magnitude([distance, length_in_units(difference.as_ref(), scale)]);
            way = largest_magnitude([way, length_in_units(there.as_ref(), scale)]);
        }
        distance <= NEAR * way
    }
}

/// Newton's iteration on all points at once.
struct NewtonStorage {
    /// The matrix by columns; its factors while a correction is computed.
    entries: Vec<f64>,
    residual: Vec<f64>,
    factors: InPlaceLu,
}

impl NewtonStorage {
    fn new<S: MechanicalSystem, const K: usize>() -> Self {
        let dimension = K * (S::N_COORDINATES + S::N_CONSTRAINTS);
        Self {
            entries: vec![0.0; dimension * dimension],
            residual: vec![0.0; dimension],
            factors: InPlaceLu::new(dimension),
        }
    }

    /// Corrects `points` until they solve the equations of the step from `state`.
    fn iterate<S: MechanicalSystem, T: NodalTables<K>, const K: usize>(
        &mut self,
        action: &GalerkinAction<S, T, K>,
        state: &State<S>,
        scale: &S::PerUnknown<f64>,
        points: &mut Points<S, K>,
        tally: &mut impl Tally,
    ) -> Result<(), StepError> {
        let n = S::N_COORDINATES;
        let block = n + S::N_CONSTRAINTS;
        let in_units = |x: &[f64]| length_in_units(x, scale.as_ref());
        let mut constraint_residual = 0.0;
        let mut smallest_pivot_ratio = 1.0_f64;
        let iteration = newton::iterate(|correction| {
            constraint_residual = action.linearize(state, points, &mut self.residual, &mut self.entries);
            for (col, column) in self.entries.chunks_exact_mut(self.residual.len()).enumerate() {
                for (row, entry) in column.iter_mut().enumerate() {
                    *entry *= scale[row % block] * scale[col % block];
                }
            }
            let apply_scale = |unknowns: &mut [f64]| {
                for unknowns in unknowns.chunks_exact_mut(block) {
                    unknowns.iter_mut().zip(scale.as_ref()).for_each(|(unknown, scale)| *unknown *= scale);
                }
            };
            self.factors
                .factor(&mut self.entries)
                .map_err(|matrix| IterationFailure::Singular { correction, matrix })?;
            smallest_pivot_ratio = smallest_pivot_ratio.min(self.factors.pivot_ratio());
            apply_scale(&mut self.residual);
            self.factors.solve(&self.entries, &mut self.residual);
            apply_scale(&mut self.residual);
            let mut length = 0.0_f64;
            let mut reach = in_units(state.q.as_ref());
            for (a, update) in self.residual.chunks_exact(block).enumerate() {
                for i in 0..n {
                    points.differences[a][i] -= update[i];
                }
                for c in 0..S::N_CONSTRAINTS {
                    points.impulses[a][c] -= update[constraint_index::<S>(c)];
                }
                length = largest_magnitude([length, in_units(&update[..n])]);
                reach = reach.max(in_units(points.differences[a].as_ref()));
            }
            Ok(relative(length, reach))
        });
        match iteration {
            Ok(Converged { corrections }) => {
                tally.count_corrections(corrections);
                Ok(())
            }
            Err(failure) => {
                Err(IterationFailure::at(failure, state.t, constraint_residual, smallest_pivot_ratio))
            }
        }
    }
}
