//! Galerkin steps of eight members by passes over their nodes, a member per lane.
//!
//! The iteration is that of `mechanics/lane_step`, whose lanes are the nodes of one member: a pass is the same number of vector operations per member
//! here as there, but for what a single step does outside of its passes (prediction, landing, horizontal sums) and waits for. Here all of it is done for
//! eight members at a time, and nodes do not wait for each other. What is lost is that a group takes the passes of its slowest member.

use super::kicks::LaneLegendre;
use super::lane_map::{LaneMap, LaneScheme};
use super::lane_matrix::{LaneLu, Slopes};
use super::lane_state::{LaneState, blend, nothing, side_by_side};
use super::mask::LaneMask;
use super::projection::project;
use crate::integrator::{Galerkin, Symmetric};
use crate::linear::Cholesky;
use crate::mechanics::{AsMass, ConstantLegendre, Mechanics, State};
use crate::newton;
use crate::scalar::{LANES, Lanes, Scalar};
use crate::scheme::{Columns, LaneTables, Linear, PAST, SchemeError, checked_step_size};
use crate::system::MechanicalSystem;

/// The Gram matrices are made anew after a pass that has moved a point by more than this share of the configuration.
const STALE: f64 = 3e-3;
/// Ends of steps are on the constraints to round-off; what is farther beside them than this share of their terms has been projected with a matrix
/// that does not determine it.
const BESIDE: f64 = 1e-3;
/// Of the configuration, a length far above round-off and far below a step.
const SLIGHT: f64 = 1e-10;

/// One value per coordinate of eight members.
type Vector<S> = <S as MechanicalSystem>::PerCoordinate<Lanes>;
/// One value per constraint of eight members.
type Multipliers<S> = <S as MechanicalSystem>::PerConstraint<Lanes>;

/// What a member brings into the passes of eight.
pub struct GalerkinMember<S: MechanicalSystem> {
    legendre: ConstantLegendre<S>,
    /// `√Mᵢᵢ`.
    units: S::PerCoordinate<f64>,
    acceleration: S::PerCoordinate<f64>,
}

/// The tables of a step as rows of numbers.
struct Tables<const K: usize> {
    nodes: [f64; K],
    weights: [f64; K],
    last_weight: f64,
    positions: [[f64; K]; K],
    multipliers: [[f64; K]; K],
    prediction: [[[f64; K]; K]; PAST],
}

impl<const K: usize> Tables<K> {
    fn new(h: f64) -> Self {
        let tables = LaneTables::new::<K>(h);
        let numbers = |lanes: Lanes| core::array::from_fn(|lane| lanes.to_array()[lane]);
        let rows = |columns: &Columns| {
            core::array::from_fn(|row| core::array::from_fn(|col| columns[col].to_array()[row]))
        };
        Self {
            nodes: numbers(tables.nodes),
            weights: numbers(tables.weights),
            last_weight: tables.last_weight,
            positions: rows(&tables.positions),
            multipliers: rows(&tables.accelerations),
            prediction: tables.prediction.each_ref().map(rows),
        }
    }
}

/// The passes of eight members. Positions have node `i + 1` at place `i`; forces the same, but for the last place, where they have that of the
/// start.
pub struct GalerkinLanes<S: MechanicalSystem, const K: usize> {
    h: f64,
    tables: Box<Tables<K>>,
    slopes: Slopes<S>,
    legendre: LaneLegendre<S>,
    /// What a coordinate is multiplied with before lengths are compared.
    units: Vector<S>,
    /// Of the nodes, and of what they were made.
    grams: Vec<LaneLu<S>>,
    jacobians: Vec<S::PerJacobianEntry<Lanes>>,
    gram: LaneLu<S>,
    /// `aⱼ` of the last steps, the last one first.
    past: [Vec<Vector<S>>; PAST],
    accelerations: Vec<Vector<S>>,
    forces: Vec<Vector<S>>,
    positions: Vec<Vector<S>>,
    nearest: Vec<Vector<S>>,
    shares: Vec<Multipliers<S>>,
    multipliers: Vec<Multipliers<S>>,
}

/// How the passes of eight members converge: the rule of `newton::Progress` for linear convergence, lane by lane.
struct LaneProgress {
    pending: LaneMask,
    previous: Lanes,
    rate: Lanes,
}

impl LaneProgress {
    /// Takes note of the relative `length` that the last pass has moved the points by.
    #[inline(always)]
    fn record(&mut self, length: Lanes) {
        let one = Lanes::splat(1.0);
        let known = LaneMask::below(Lanes::ZERO, self.previous);
        let rate = known.select(length / self.previous, one);
        let slower = LaneMask::below(self.rate, rate).select(rate, self.rate);
        let slower = LaneMask::below(slower, one).select(slower, one);
        let round_off = LaneMask::below(length * slower, Lanes::splat(newton::TARGET));
        let stuck = LaneMask::below(Lanes::splat(newton::STAGNATION_RATIO) * self.previous, length)
            .and(LaneMask::at_most(length, Lanes::splat(newton::STAGNATION)))
            .and(known);
        self.pending = self.pending.without(round_off.or(stuck));
        (self.previous, self.rate) = (length, rate);
    }
}

impl<S: MechanicalSystem, const K: usize> LaneScheme<S> for Galerkin<K, Linear> {
    type Member = GalerkinMember<S>;
    type Lanes = GalerkinLanes<S, K>;

    fn h(&self) -> f64 {
        self.step_size()
    }

    fn member(
        &self,
        mechanics: &Mechanics<S>,
        start: &State<S>,
    ) -> Result<Option<GalerkinMember<S>>, SchemeError> {
        checked_step_size(self.step_size())?;
        if !GalerkinLanes::<S, K>::EXIST || self.is_by_newton() {
            return Ok(None);
        }
        let mass = mechanics.constant_mass();
        // Passes eliminate without pivoting.
        if Cholesky::new::<S::PerCoordinate<f64>>(&mass).is_none() {
            return Ok(None);
        }
        let Ok(legendre) = ConstantLegendre::new(mechanics) else { return Ok(None) };
        let Some(acceleration) = acceleration(mechanics, start) else { return Ok(None) };
        let units = crate::array::Array::from_fn(|i| Scalar::sqrt(mass[i][i]));
        Ok(Some(GalerkinMember { legendre, units, acceleration }))
    }

    fn join(
        &self,
        mechanics: [&Mechanics<S>; LANES],
        members: [&GalerkinMember<S>; LANES],
    ) -> GalerkinLanes<S, K> {
        let h = self.step_size();
        let start: Vector<S> = side_by_side(|lane, i| members[lane].acceleration[i]);
        let points = || vec![nothing(); K];
        GalerkinLanes {
            h,
            tables: Box::new(Tables::new(h)),
            slopes: Slopes::new(side_by_side(|lane, i| mechanics[lane].constants[i])),
            legendre: LaneLegendre::of(members.map(|member| &member.legendre)),
            units: side_by_side(|lane, i| members[lane].units[i]),
            grams: (0..K).map(|_| LaneLu::new::<AsMass>()).collect(),
            jacobians: vec![nothing(); K],
            gram: LaneLu::new::<AsMass>(),
            past: core::array::from_fn(|_| vec![start.clone(); K]),
            accelerations: points(),
            forces: points(),
            positions: points(),
            nearest: points(),
            shares: vec![nothing(); K],
            multipliers: vec![nothing(); K],
        }
    }
}

/// The acceleration of a state, from which passes without a past begin.
fn acceleration<S: MechanicalSystem>(
    mechanics: &Mechanics<S>,
    state: &State<S>,
) -> Option<S::PerCoordinate<f64>> {
    mechanics
        .acceleration_with(state.t, &state.q, &state.v, &state.inputs)
        .ok()
        .map(|found| found.acceleration)
}

impl<S: MechanicalSystem, const K: usize> GalerkinLanes<S, K> {
    /// Whether the scene's steps can be taken in lanes.
    const EXIST: bool = S::STRUCTURE.is_separable_with_constant_mass()
        && !S::STRUCTURE.forces.exist()
        && S::STATED_RANK.is_none();
    const IS_CONSTRAINED: bool = S::N_CONSTRAINTS > 0;
    /// Whether forces, those of the constraints aside, change from pass to pass.
    const FORCE_VARIES: bool = !S::STRUCTURE.hessian.qq.is_empty();

    /// The accelerations that the last steps let expect.
    #[inline(always)]
    fn predict<const FUSED: bool>(&mut self) {
        let [last, before] = &self.tables.prediction;
        for j in 0..K {
            let mut sum: Vector<S> = nothing();
            for k in 0..K {
                for i in 0..S::N_COORDINATES {
                    sum[i] = Lanes::splat(last[j][k]).times_plus::<FUSED>(self.past[0][k][i], sum[i]);
                    sum[i] = Lanes::splat(before[j][k]).times_plus::<FUSED>(self.past[1][k][i], sum[i]);
                }
            }
            self.accelerations[j] = sum;
        }
    }

    /// `q₀ + h cᵢ v₀ + h² Σⱼ Bᵢⱼ aⱼ` at the nodes from `first` on.
    #[inline(always)]
    fn place<const FUSED: bool>(&mut self, state: &LaneState<S>, first: usize) {
        for node in first..K {
            let mut sum: Vector<S> = nothing();
            for i in 0..S::N_COORDINATES {
                sum[i] = Lanes::splat(self.tables.nodes[node]) * state.v[i];
            }
            let row = &self.tables.positions[node];
            for j in 0..K {
                let factor = Lanes::splat(row[j]);
                for i in 0..S::N_COORDINATES {
                    sum[i] = factor.times_plus::<FUSED>(self.accelerations[j][i], sum[i]);
                }
            }
            for i in 0..S::N_COORDINATES {
                sum[i] = state.q[i] + sum[i];
            }
            self.positions[node] = sum;
        }
    }

    /// Projects the points on the constraints; returns the squares of how far the farthest one has moved, in the metric of the masses.
    /// Matrices are made anew for the lanes that are `stale`.
    #[inline(always)]
    fn project_points<const FUSED: bool>(
        &mut self,
        t: f64,
        is_first: bool,
        stale: LaneMask,
        is_all_stale: bool,
    ) -> Lanes {
        let mut farthest = Lanes::ZERO;
        let is_any_stale = is_all_stale || stale.is_any();
        for node in 0..K {
            let time = Lanes::splat(t + self.tables.nodes[node]);
            let position = self.positions[node].clone();
            let mut square = Lanes::ZERO;
            if Self::FORCE_VARIES && !is_first {
                for i in 0..S::N_COORDINATES {
                    let moved = (position[i] - self.nearest[node][i]) * self.units[i];
                    square = moved.times_plus::<FUSED>(moved, square);
                }
            }
            let mut nearest = position.clone();
            if Self::IS_CONSTRAINED {
                let residual = if is_any_stale {
                    let (residual, jacobian) =
                        S::constraint_derivatives(self.slopes.constants(), time, &position);
                    let inverse_mass = &self.legendre.inverse_mass;
                    if is_all_stale {
                        let gram = &mut self.grams[node];
                        self.slopes.gram::<_, FUSED>(&jacobian, inverse_mass, &jacobian, gram);
                        gram.factor::<FUSED>();
                        self.jacobians[node] = jacobian;
                    } else {
                        self.slopes.gram::<_, FUSED>(&jacobian, inverse_mass, &jacobian, &mut self.gram);
                        self.gram.factor::<FUSED>();
                        self.grams[node].blend(stale, &self.gram);
                        blend(stale, &jacobian, &mut self.jacobians[node]);
                    }
                    residual
                } else {
                    S::constraints(self.slopes.constants(), time, &position)
                };
                let mut shares = residual.clone();
                self.grams[node].solve::<FUSED>(&mut shares);
                // φᵀ S⁻¹ φ is the square of the displacement below.
                for c in 0..S::N_CONSTRAINTS {
                    square = residual[c].times_plus::<FUSED>(shares[c], square);
                }
                let pull = self.slopes.pull::<FUSED>(&self.jacobians[node], &shares);
                let displacement = self.legendre.inverse_mass.times::<FUSED>(&pull);
                for i in 0..S::N_COORDINATES {
                    nearest[i] = position[i] - displacement[i];
                }
                self.shares[node] = shares;
            }
            self.nearest[node] = nearest;
            farthest = farthest.larger(square.abs());
        }
        farthest
    }

    /// Forces and accelerations at the nodes before the last, with multipliers that take up what points were beside the constraints; in the first
    /// pass with those that the predicted accelerations imply. Lanes in `frozen` keep theirs.
    #[inline(always)]
    fn accelerate<const FUSED: bool>(&mut self, state: &LaneState<S>, is_first: bool, frozen: LaneMask) {
        let is_any_frozen = frozen.is_any();
        for j in 0..K {
            let is_start = j == K - 1;
            let time = Lanes::splat(if is_start { state.t } else { state.t + self.tables.nodes[j] });
            let point = if is_start { state.q.clone() } else { self.nearest[j].clone() };
            let mut force = S::lagrangian_gradient(self.slopes.constants(), time, &point, &nothing()).force;
            if Self::IS_CONSTRAINED {
                let (_, jacobian) = S::constraint_derivatives(self.slopes.constants(), time, &point);
                if is_first {
                    self.imply_multipliers::<FUSED>(j, is_start, &jacobian, &force);
                }
                let mut multipliers = self.multipliers[j].clone();
                let row = &self.tables.multipliers[j];
                for node in 0..K {
                    let factor = Lanes::splat(row[node]);
                    for c in 0..S::N_CONSTRAINTS {
                        multipliers[c] = factor.times_plus::<FUSED>(self.shares[node][c], multipliers[c]);
                    }
                }
                let pull = self.slopes.pull::<FUSED>(&jacobian, &multipliers);
                for i in 0..S::N_COORDINATES {
                    force[i] = force[i] - pull[i];
                }
                self.multipliers[j] = multipliers;
            }
            let acceleration = self.legendre.inverse_mass.times::<FUSED>(&force);
            if is_any_frozen {
                let going = LaneMask::ALL.without(frozen);
                blend(going, &acceleration, &mut self.accelerations[j]);
                blend(going, &force, &mut self.forces[j]);
            } else {
                (self.accelerations[j], self.forces[j]) = (acceleration, force);
            }
        }
    }

    /// `λⱼ = Sⱼ⁻¹ Gⱼ (M⁻¹ fⱼ − aⱼ)`: the multipliers of the accelerations `aⱼ` under the other forces `fⱼ`, with the matrices of the points before
    /// they were projected, which is near enough to begin with.
    #[inline(always)]
    fn imply_multipliers<const FUSED: bool>(
        &mut self,
        j: usize,
        is_start: bool,
        jacobian: &S::PerJacobianEntry<Lanes>,
        force: &Vector<S>,
    ) {
        let mut held = self.legendre.inverse_mass.times::<FUSED>(force);
        for i in 0..S::N_COORDINATES {
            held[i] = held[i] - self.accelerations[j][i];
        }
        let mut multipliers = self.slopes.along::<FUSED>(jacobian, &held);
        if is_start {
            self.slopes.gram::<_, FUSED>(jacobian, &self.legendre.inverse_mass, jacobian, &mut self.gram);
            self.gram.factor::<FUSED>();
            self.gram.solve::<FUSED>(&mut multipliers);
        } else {
            self.grams[j].solve::<FUSED>(&mut multipliers);
        }
        self.multipliers[j] = multipliers;
    }

    /// One over what steps from `state` are found to the round-off of, in the metric of the masses: as in `mechanics/lane_step`.
    #[inline(always)]
    fn per_reach(&self, state: &LaneState<S>) -> Lanes {
        /// A step of an eighth of the configuration is not short.
        const LONG: f64 = 8.0;
        /// Points are sums of a configuration: closer is not to be had.
        const CLOSEST: f64 = 1.0 / 16.0;
        let (mut here, mut way) = (Lanes::ZERO, Lanes::ZERO);
        let h = Lanes::splat(self.h.abs());
        for i in 0..S::N_COORDINATES {
            here = (self.units[i] * state.q[i].abs()).larger(here);
            way = (self.units[i] * h * state.v[i].abs()).larger(way);
        }
        let here = here + way;
        let long = Lanes::splat(LONG) * way;
        let limited = LaneMask::below(long, here).select(long, here);
        Lanes::splat(1.0) / limited.larger(Lanes::splat(CLOSEST) * here)
    }

    /// The lanes whose residuals are farther beside the constraints than can be.
    #[inline(always)]
    fn beside(
        &self,
        jacobian: &S::PerJacobianEntry<Lanes>,
        reach: &Vector<S>,
        residual: &Multipliers<S>,
    ) -> LaneMask {
        let scale = self.slopes.scale(jacobian, reach);
        let mut on = LaneMask::ALL;
        for c in 0..S::N_CONSTRAINTS {
            on = on.and(LaneMask::at_most(residual[c].abs(), Lanes::splat(BESIDE) * scale[c]));
        }
        LaneMask::ALL.without(on)
    }

    /// The ends of the steps: on the constraints and on the hidden ones to round-off.
    #[inline(always)]
    fn land<const FUSED: bool>(
        &mut self,
        state: &mut LaneState<S>,
        active: LaneMask,
        mut failed: LaneMask,
    ) -> LaneMask {
        let t = Lanes::splat(state.t + self.h);
        let mut q = self.positions[K - 1].clone();
        let mut slight = Lanes::ZERO;
        for i in 0..S::N_COORDINATES {
            slight = q[i].abs().larger(slight);
        }
        slight = Lanes::splat(SLIGHT) * slight;
        let mut way: Vector<S> = nothing();
        for i in 0..S::N_COORDINATES {
            way[i] = (q[i] - state.q[i]).abs() + slight;
        }
        if Self::IS_CONSTRAINED {
            let (mut shares, jacobian) = S::constraint_derivatives(self.slopes.constants(), t, &q);
            self.slopes.gram::<_, FUSED>(&jacobian, &self.legendre.inverse_mass, &jacobian, &mut self.gram);
            self.gram.factor::<FUSED>();
            self.gram.solve::<FUSED>(&mut shares);
            let pull = self.slopes.pull::<FUSED>(&jacobian, &shares);
            let displacement = self.legendre.inverse_mass.times::<FUSED>(&pull);
            for i in 0..S::N_COORDINATES {
                q[i] = q[i] - displacement[i];
            }
        }
        let end_force = S::lagrangian_gradient(self.slopes.constants(), t, &q, &nothing()).force;
        let mut momentum = state.p.clone();
        for i in 0..S::N_COORDINATES {
            let mut gain = Lanes::splat(self.tables.last_weight) * end_force[i];
            for j in 0..K {
                gain = Lanes::splat(self.tables.weights[j]).times_plus::<FUSED>(self.forces[j][i], gain);
            }
            momentum[i] = momentum[i] + gain;
        }
        if !Self::IS_CONSTRAINED {
            let v = self.legendre.velocity::<FUSED>(&momentum);
            return state.replace(q, v, momentum, active, failed);
        }
        let (left, jacobian) = S::constraint_derivatives(self.slopes.constants(), t, &q);
        let projected =
            project::<S, FUSED>(&self.slopes, &self.legendre, &self.gram, &jacobian, momentum, active);
        let rate = self.slopes.rate::<FUSED>(&jacobian, &projected.v);
        let (mut reach, mut speeds): (Vector<S>, Vector<S>) = (nothing(), nothing());
        let per_h = Lanes::splat(1.0 / self.h.abs());
        for i in 0..S::N_COORDINATES {
            reach[i] = q[i].abs() + way[i];
            speeds[i] = way[i].times_plus::<FUSED>(per_h, projected.v[i].abs());
        }
        let beside = self.beside(&jacobian, &reach, &left).or(self.beside(&jacobian, &speeds, &rate));
        failed = failed.or(beside.and(active));
        state.replace(q, projected.v, projected.p, active, failed)
    }
}

impl<S: MechanicalSystem, const K: usize> LaneMap<S> for GalerkinLanes<S, K> {
    #[inline(always)]
    fn advance<const FUSED: bool>(&mut self, state: &mut LaneState<S>, active: LaneMask) -> LaneMask {
        self.predict::<FUSED>();
        self.place::<FUSED>(state, 0);
        let per_reach = self.per_reach(state);
        let mut progress = LaneProgress { pending: active, previous: Lanes::ZERO, rate: Lanes::ZERO };
        let mut stale = LaneMask::ALL;
        for pass in 0..newton::MAX_CORRECTIONS {
            let is_first = pass == 0;
            // What a lane that is done has a matrix of does not matter.
            let is_all_stale = !progress.pending.without(stale).is_any();
            let farthest = self.project_points::<FUSED>(state.t, is_first, stale, is_all_stale);
            self.accelerate::<FUSED>(state, is_first, active.without(progress.pending));
            let length = Scalar::sqrt(farthest) * per_reach;
            stale = LaneMask::below(Lanes::splat(STALE), length).and(progress.pending);
            // In the first pass nothing has moved yet.
            if !(is_first && Self::FORCE_VARIES) {
                progress.record(length);
            }
            let is_last = !progress.pending.is_any();
            self.place::<FUSED>(state, if is_last { K - 1 } else { 0 });
            if is_last {
                break;
            }
        }
        let failed = self.land::<FUSED>(state, active, progress.pending);
        self.past.swap(0, 1);
        core::mem::swap(&mut self.past[0], &mut self.accelerations);
        failed
    }

    fn forget(&mut self, lane: usize, mechanics: &Mechanics<S>, state: &State<S>) {
        let constant = acceleration(mechanics, state);
        for accelerations in self.past.iter_mut().flatten() {
            for i in 0..S::N_COORDINATES {
                let value = constant.as_ref().map_or(0.0, |acceleration| acceleration[i]);
                accelerations[i] = accelerations[i].with(lane, value);
            }
        }
    }
}
