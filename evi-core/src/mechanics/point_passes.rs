//! A Galerkin step of any scene by passes over all nodes at once, a node per lane: for a momentum that is anything but a constant mass times the
//! velocity.
//!
//! The unknowns are the points of the curve, `qᵢ = q₀ + dᵢ`, `i = 1 .. K`; velocities are its rates, `v = D d / h`. With momenta `pⱼ = ∂L/∂v` and forces
//! `Fⱼ = ∂L/∂q + f − Gᵀλⱼ`, the equations of [`super::galerkin_equations`], added up along the step by the tables of [`PointTables`], are
//!
//! ```text
//! rᵢ = h Σⱼ (A Π)ᵢⱼ (p₀ − pⱼ) + h² Σⱼ Bᵢⱼ Fⱼ = 0        φ(qᵢ) = 0
//! ```
//!
//! and a pass is, with the mass and Gram matrices `Mᵢ`, `Sᵢ = Gᵢ Mᵢ⁻¹ Gᵢᵀ` of a point,
//!
//! ```text
//! ηᵢ = Sᵢ⁻¹ φ(qᵢ)        dᵢ −= Mᵢ⁻¹ Gᵢᵀ ηᵢ        λ += (B⁻¹ η) / h²        v += D Δd / h        p, F at (q, v)        dᵢ += Mᵢ⁻¹ rᵢ
//! ```
//!
//! with the change `Δd` since the last evaluation: velocities follow the points onto the constraints before anything is evaluated there, without which
//! every pass gains half as many digits, and rates of `d` itself would have its round-off times up to `K (K + 1) / 2`. A fixed point solves the
//! equations exactly, whatever `Mᵢ` and `Sᵢ` are and wherever the first pass begins.

use super::lane_step::{from_start, nothing, product};
use super::point_guess::{FirstPoints, NodeMotion, NodeMultipliers, Nodes, PointGuess};
use super::reach::Length;
use super::{ForcePoint, Mechanics, Points, State};
use crate::array::Array;
use crate::linear::{LaneGram, LaneMass, factor_mass};
use crate::newton::{LinearProgress, NotConverged};
use crate::scalar::{LaneOperation, Lanes};
use crate::scheme::PointTables;
use crate::system::{LagrangianGradient, MassShape, MechanicalSystem};

/// Mass and Gram matrices are made anew after a pass that has moved a point by more than this share of the configuration.
const STALE: f64 = 3e-3;

/// The passes of one scene, for one step size.
pub(crate) struct PointPasses<S: MechanicalSystem, const K: usize> {
    constants: S::PerConstant<Lanes>,
    tables: PointTables,
    mass: LaneMass<S>,
    gram: LaneGram<S>,
    /// What the last passes have found.
    pub(crate) found: NodeMotion<S>,
    /// `q_a − q₀` of the last passes, `a = 1 .. K`.
    differences: Nodes<S>,
}

/// What a step changes, before the constraints are met at its end to round-off.
pub(crate) struct PointEnd<S: MechanicalSystem> {
    /// `q_K − q₀`.
    pub(crate) difference: S::PerCoordinate<f64>,
    /// `p⁻ − p₀`, without the multipliers at the end.
    pub(crate) gain: S::PerCoordinate<f64>,
    /// `v_K`.
    pub(crate) velocity: S::PerCoordinate<f64>,
    /// Passes taken.
    pub(crate) passes: usize,
}

/// Passes until they have converged, as an operation on lanes.
pub(crate) struct PointIteration<'a, S: MechanicalSystem, const K: usize> {
    pub(crate) passes: &'a mut PointPasses<S, K>,
    pub(crate) mechanics: &'a Mechanics<S>,
    pub(crate) start: &'a State<S>,
    pub(crate) guess: PointGuess<'a, S>,
}

impl<S: MechanicalSystem, const K: usize> LaneOperation for PointIteration<'_, S, K> {
    type Output = Result<PointEnd<S>, NotConverged>;

    #[inline(always)]
    fn run<const FUSED: bool>(self) -> Self::Output {
        self.passes.iterate::<FUSED>(self.mechanics, self.start, &self.guess)
    }
}

/// Momenta and forces at all nodes.
struct AtNodes<S: MechanicalSystem> {
    /// `pⱼ` at the nodes `1 .. K`.
    momenta: Nodes<S>,
    /// `Fⱼ` at the nodes before the last.
    forces: Nodes<S>,
    start_momentum: S::PerCoordinate<f64>,
    /// `F_K`, without multipliers.
    end_force: S::PerCoordinate<f64>,
}

impl<S: MechanicalSystem, const K: usize> PointPasses<S, K> {
    const IS_CONSTRAINED: bool = S::N_CONSTRAINTS > 0;

    pub(crate) fn new(mechanics: &Mechanics<S>, h: f64) -> Self {
        let masses = S::STRUCTURE.hessian.vv.iter().map(|entry| (entry.col, entry.row));
        let couples_all = !matches!(S::STRUCTURE.mass_shape, MassShape::Diagonal);
        Self {
            constants: Array::from_fn(|i| Lanes::splat(mechanics.constants[i])),
            tables: PointTables::new::<K>(h),
            mass: LaneMass::<S>::new(masses, false),
            gram: LaneGram::<S>::new(S::STRUCTURE.constraint_graph.iter().copied(), couples_all),
            found: NodeMotion::rest(),
            differences: nothing(),
        }
    }

    /// The points of the last passes, of size `h`: as the equations of all points have them, which know `h² b λ`.
    pub(crate) fn points_found(&self, h: f64) -> Points<S, K> {
        let weights = self.tables.lobatto.weights.to_array();
        let difference = |a: usize| Array::from_fn(|i| self.differences[i].to_array()[a]);
        let impulse = |a: usize| {
            let lane = if a == 0 { K - 1 } else { a - 1 };
            Array::from_fn(|c| h * weights[lane] * self.found.multipliers[c].to_array()[lane])
        };
        Points { differences: core::array::from_fn(difference), impulses: core::array::from_fn(impulse) }
    }

    #[inline(always)]
    fn iterate<const FUSED: bool>(
        &mut self,
        mechanics: &Mechanics<S>,
        start: &State<S>,
        guess: &PointGuess<'_, S>,
    ) -> Result<PointEnd<S>, NotConverged> {
        let n = S::N_COORDINATES;
        let times = self.tables.lobatto.nodes + Lanes::splat(start.t);
        let (_, start_jacobian) = S::constraint_derivatives(&mechanics.constants, start.t, &start.q);
        let FirstPoints { mut differences, mut velocities, mut multipliers } =
            guess.first::<K, FUSED>(&self.tables, start);
        let mut start_velocity: S::PerCoordinate<f64> =
            sums::<S>(|i| (self.tables.extrapolation * velocities[i]).sum());
        // What the velocities do not know of yet.
        let mut moves: Nodes<S> = nothing();
        let mut jacobian: S::PerJacobianEntry<Lanes> = nothing();
        let mut metric: Nodes<S> = nothing();
        let mut per_reach = 0.0;
        let mut progress = LinearProgress::default();
        let (mut is_stale, mut is_last) = (true, false);
        let mut passes = 0;
        loop {
            let mut q = from_start::<S>(start, &differences);
            // Squares of lengths in this metric.
            let mut squares = Lanes::ZERO;
            let mut shares: NodeMultipliers<S> = nothing();
            if is_stale {
                let inertia = self.factor_mass::<FUSED>(times, &q, &velocities);
                let [here, way] = [&q, &differences].map(|x| Length::of_nodes::<S>(&inertia, x));
                let reach = here.reach(way);
                metric = reach.with_light::<S>(inertia);
                per_reach = 1.0 / reach.metric;
                if Self::IS_CONSTRAINED {
                    (shares, jacobian) = S::constraint_derivatives(&self.constants, times, &q);
                    self.factor_gram::<FUSED>(&jacobian);
                }
            } else if Self::IS_CONSTRAINED {
                shares = S::constraints(&self.constants, times, &q);
            }
            if Self::IS_CONSTRAINED {
                self.gram.solve::<FUSED>(&mut shares);
                for c in 0..S::N_CONSTRAINTS {
                    multipliers[c] =
                        product::<K, FUSED>(&self.tables.lobatto.accelerations, shares[c], multipliers[c]);
                }
                let mut displacements = self.constraint_force::<FUSED>(&jacobian, &shares);
                self.mass.solve::<FUSED>(&mut displacements);
                for i in 0..n {
                    differences[i] = differences[i] - displacements[i];
                    q[i] = q[i] - displacements[i];
                    moves[i] = moves[i] - displacements[i];
                    squares = (metric[i] * displacements[i]).times_plus::<FUSED>(displacements[i], squares);
                }
            }
            for i in 0..n {
                velocities[i] = product::<K, FUSED>(&self.tables.rates, moves[i], velocities[i]);
                start_velocity[i] += (self.tables.start_rates * moves[i]).sum();
            }
            let at = self.evaluate::<FUSED>(
                mechanics,
                start,
                times,
                (&q, &velocities),
                (&start_velocity, &start_jacobian),
                &multipliers,
            );
            passes += 1;
            if is_last {
                self.found = NodeMotion { velocities, multipliers };
                self.differences = differences;
                return self.end(&at, passes);
            }
            let mut residual: Nodes<S> = nothing();
            for i in 0..n {
                let missing = Lanes::splat(start.p[i]) - at.momenta[i];
                let start_missing = Lanes::splat(start.p[i] - at.start_momentum[i]);
                let of_forces =
                    product::<K, FUSED>(&self.tables.lobatto.positions, at.forces[i], Lanes::ZERO);
                let of_start = self.tables.start_momentum.times_plus::<FUSED>(start_missing, of_forces);
                residual[i] = product::<K, FUSED>(&self.tables.momenta, missing, of_start);
            }
            moves = residual;
            self.mass.solve::<FUSED>(&mut moves);
            for i in 0..n {
                squares = (metric[i] * moves[i]).times_plus::<FUSED>(moves[i], squares);
                differences[i] = differences[i] + moves[i];
            }
            let square = squares.largest() * per_reach * per_reach;
            is_stale = square > STALE * STALE;
            // Then once more, for the forces where the points have come to.
            is_last = progress.has_converged(square)?;
        }
    }

    /// What the step changes.
    ///
    /// # Errors
    /// [`NotConverged`] if it is not finite: comparisons lose a NaN on the way, in the sums over all nodes it arrives.
    #[inline(always)]
    fn end(&self, at: &AtNodes<S>, passes: usize) -> Result<PointEnd<S>, NotConverged> {
        let (mut difference, mut gain, mut velocity) =
            (sums::<S>(|_| 0.0), sums::<S>(|_| 0.0), sums::<S>(|_| 0.0));
        let mut total = 0.0;
        for i in 0..S::N_COORDINATES {
            let before_last = (self.tables.lobatto.weights * at.forces[i]).sum();
            difference[i] = self.differences[i].to_array()[K - 1];
            gain[i] = self.tables.lobatto.last_weight * at.end_force[i] + before_last;
            velocity[i] = self.found.velocities[i].to_array()[K - 1];
            total += difference[i] + gain[i];
        }
        if f64::is_finite(total) {
            Ok(PointEnd { difference, gain, velocity, passes })
        } else {
            Err(NotConverged { corrections: passes, last_correction: f64::NAN })
        }
    }

    /// Factors the mass matrices, and returns a metric of motions.
    #[inline(always)]
    fn factor_mass<const FUSED: bool>(&mut self, times: Lanes, q: &Nodes<S>, v: &Nodes<S>) -> Nodes<S> {
        let (_, hessian) = S::lagrangian_derivatives(&self.constants, times, q, v);
        factor_mass::<S, FUSED>(&mut self.mass, &self.constants, &hessian)
    }

    #[inline(always)]
    fn factor_gram<const FUSED: bool>(&mut self, jacobian: &S::PerJacobianEntry<Lanes>) {
        self.gram.clear();
        for other in 0..S::N_CONSTRAINTS {
            let mut direction: Nodes<S> = nothing();
            S::for_each_slope(
                &self.constants,
                jacobian,
                #[inline(always)]
                |row, col, slope| {
                    if row == other {
                        direction[col] = slope;
                    }
                },
            );
            self.mass.solve::<FUSED>(&mut direction);
            let gram = &mut self.gram;
            S::for_each_slope(
                &self.constants,
                jacobian,
                #[inline(always)]
                |row, col, slope| {
                    if row >= other {
                        gram.add_product::<FUSED>(row, other, slope, direction[col]);
                    }
                },
            );
        }
        self.gram.factor::<FUSED>();
    }

    /// `Gᵀ x`.
    #[inline(always)]
    fn constraint_force<const FUSED: bool>(
        &self,
        jacobian: &S::PerJacobianEntry<Lanes>,
        x: &NodeMultipliers<S>,
    ) -> Nodes<S> {
        let mut sum: Nodes<S> = nothing();
        S::for_each_slope(
            &self.constants,
            jacobian,
            #[inline(always)]
            |row, col, slope| sum[col] = slope.times_plus::<FUSED>(x[row], sum[col]),
        );
        sum
    }

    /// Momenta and forces at the nodes `1 .. K` over lanes, and at the start by itself.
    #[inline(always)]
    fn evaluate<const FUSED: bool>(
        &self,
        mechanics: &Mechanics<S>,
        start: &State<S>,
        times: Lanes,
        (q, v): (&Nodes<S>, &Nodes<S>),
        (start_velocity, start_jacobian): (&S::PerCoordinate<f64>, &S::PerJacobianEntry<f64>),
        multipliers: &NodeMultipliers<S>,
    ) -> AtNodes<S> {
        let n = S::N_COORDINATES;
        let LagrangianGradient { mut force, momentum } = S::lagrangian_gradient(&self.constants, times, q, v);
        let mut at_start = S::lagrangian_gradient(&mechanics.constants, start.t, &start.q, start_velocity);
        if S::STRUCTURE.forces.exist() {
            let mut inputs: S::PerInput<Lanes> = nothing();
            for i in 0..S::N_INPUTS {
                inputs[i] = Lanes::splat(start.inputs[i]);
            }
            let added = S::forces(&self.constants, times, q, v, &inputs);
            for &i in S::STRUCTURE.forces.forced {
                force[i] = force[i] + added[i];
            }
            let point = ForcePoint { t: start.t, q: &start.q, v: start_velocity, inputs: &start.inputs };
            mechanics.add_force(point, &mut at_start.force);
        }
        let end_force = sums::<S>(|i| force[i].to_array()[K - 1]);
        if Self::IS_CONSTRAINED {
            let (_, jacobian) = S::constraint_derivatives(&self.constants, times, q);
            let held = self.constraint_force::<FUSED>(&jacobian, multipliers);
            for i in 0..n {
                force[i] = force[i] - held[i];
            }
            S::for_each_slope(
                &mechanics.constants,
                start_jacobian,
                #[inline(always)]
                |row, col, slope| at_start.force[col] -= slope * multipliers[row].to_array()[K - 1],
            );
        }
        for i in 0..n {
            force[i] = force[i].with(K - 1, at_start.force[i]);
        }
        AtNodes { momenta: momentum, forces: force, start_momentum: at_start.momentum, end_force }
    }
}

/// One number per coordinate; written as a copy, since what builds an array from a function is not always inlined.
#[inline(always)]
fn sums<S: MechanicalSystem>(number: impl Fn(usize) -> f64) -> S::PerCoordinate<f64> {
    let mut numbers = S::PerCoordinate::<f64>::filled(0.0);
    for i in 0..S::N_COORDINATES {
        numbers[i] = number(i);
    }
    numbers
}
