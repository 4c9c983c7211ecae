//! Galerkin steps of eight members by passes over their nodes, a member per lane.
//!
//! The iteration is that of `mechanics/lane_step`, whose lanes are the nodes of one member: a pass is the same number of vector operations per member
//! here as there, but for what a single step does outside of its passes (prediction, landing, horizontal sums) and waits for. Here all of it is done for
//! eight members at a time, and nodes do not wait for each other. What is lost is that a group takes the passes of its slowest member.

use super::galerkin_passes::{LaneProgress, STALE};
use super::kicks::LaneLegendre;
use super::lane_map::{LaneMap, LaneScheme};
use super::lane_matrix::{LaneLu, Slopes};
use super::lane_reach::LaneReach;
use super::lane_state::{LaneState, nothing, side_by_side};
use super::mask::LaneMask;
use crate::integrator::{Galerkin, Symmetric};
use crate::linear::Cholesky;
use crate::mechanics::reach::has_light;
use crate::mechanics::{AsMass, ConstantLegendre, Mechanics, State};
use crate::newton;
use crate::scalar::{LANES, Lanes, Scalar};
use crate::scheme::{Columns, LaneTables, Linear, PAST, SchemeError, checked_step_size};
use crate::system::MechanicalSystem;

/// One value per coordinate of eight members.
pub(super) type Vector<S> = <S as MechanicalSystem>::PerCoordinate<Lanes>;
/// One value per constraint of eight members.
pub(super) type Multipliers<S> = <S as MechanicalSystem>::PerConstraint<Lanes>;

/// What a member brings into the passes of eight.
pub struct GalerkinMember<S: MechanicalSystem> {
    legendre: ConstantLegendre<S>,
    /// `√Mᵢᵢ`.
    units: S::PerCoordinate<f64>,
    acceleration: S::PerCoordinate<f64>,
}

/// The tables of a step as rows of numbers.
pub(super) struct Tables<const K: usize> {
    pub(super) nodes: [f64; K],
    pub(super) weights: [f64; K],
    pub(super) last_weight: f64,
    pub(super) positions: [[f64; K]; K],
    pub(super) multipliers: [[f64; K]; K],
    pub(super) prediction: [[[f64; K]; K]; PAST],
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
    pub(super) h: f64,
    pub(super) tolerance: f64,
    pub(super) tables: Box<Tables<K>>,
    pub(super) slopes: Slopes<S>,
    pub(super) legendre: LaneLegendre<S>,
    /// What a coordinate is multiplied with at least before lengths are compared: `√Mᵢᵢ`.
    pub(super) units: Vector<S>,
    /// The members with coordinates that the metric of the masses does not see, if there are any.
    pub(super) light: Option<LaneMask>,
    /// Of the nodes, and of what they were made.
    pub(super) grams: Vec<LaneLu<S>>,
    pub(super) jacobians: Vec<S::PerJacobianEntry<Lanes>>,
    pub(super) gram: LaneLu<S>,
    /// `aⱼ` of the last steps, the last one first.
    pub(super) past: [Vec<Vector<S>>; PAST],
    pub(super) accelerations: Vec<Vector<S>>,
    pub(super) forces: Vec<Vector<S>>,
    pub(super) positions: Vec<Vector<S>>,
    pub(super) nearest: Vec<Vector<S>>,
    pub(super) shares: Vec<Multipliers<S>>,
    pub(super) multipliers: Vec<Multipliers<S>>,
    /// Squares of how far the last pass has moved each point, in the units of [`LaneReach`].
    pub(super) squares: [Lanes; K],
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
            tolerance: self.tolerance(),
            tables: Box::new(Tables::new(h)),
            slopes: Slopes::new(side_by_side(|lane, i| mechanics[lane].constants[i])),
            legendre: LaneLegendre::of(members.map(|member| &member.legendre)),
            units: side_by_side(|lane, i| members[lane].units[i]),
            light: with_light(members),
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
            squares: [Lanes::ZERO; K],
        }
    }
}

fn with_light<S: MechanicalSystem>(members: [&GalerkinMember<S>; LANES]) -> Option<LaneMask> {
    let light = LaneMask::of(members.map(|member| has_light(member.units.as_ref())));
    light.is_any().then_some(light)
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
    pub(super) const IS_CONSTRAINED: bool = S::N_CONSTRAINTS > 0;
    /// Whether forces, those of the constraints aside, change from pass to pass.
    pub(super) const FORCE_VARIES: bool = !S::STRUCTURE.hessian.qq.is_empty();
}

impl<S: MechanicalSystem, const K: usize> LaneMap<S> for GalerkinLanes<S, K> {
    #[inline(always)]
    fn advance<const FUSED: bool>(&mut self, state: &mut LaneState<S>, active: LaneMask) -> LaneMask {
        self.predict::<FUSED>();
        self.place::<FUSED>(state, 0);
        let LaneReach { per_reach, units } = LaneReach::<S>::of(&self.units, self.h, state);
        let mut progress = LaneProgress::of(active, self.tolerance);
        let mut stale = LaneMask::ALL;
        for pass in 0..newton::MAX_CORRECTIONS {
            let is_first = pass == 0;
            // What a lane that is done has a matrix of does not matter.
            let is_all_stale = !progress.pending().without(stale).is_any();
            let farthest = self.project_points::<FUSED>(state.t, &units, is_first, stale, is_all_stale);
            self.accelerate::<FUSED>(state, is_first, active.without(progress.pending()));
            let length = Scalar::sqrt(farthest) * per_reach;
            stale = LaneMask::below(Lanes::splat(STALE), length).and(progress.pending());
            // In the first pass nothing has moved yet.
            if !(is_first && Self::FORCE_VARIES) {
                progress.record(length);
            }
            let is_last = !progress.pending().is_any();
            self.place::<FUSED>(state, if is_last { K - 1 } else { 0 });
            if is_last {
                break;
            }
        }
        let failed = self.land::<FUSED>(state, active, progress.pending());
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
