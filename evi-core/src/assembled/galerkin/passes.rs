//! Passes over all nodes of a step, a node per lane.
//!
//! The formulas are those of `mechanics/lane_step`: with the accelerations `aⱼ = M⁻¹ Fⱼ` of the total forces `Fⱼ = ∂L/∂q + f − Gᵀλⱼ` and
//! `Sᵢ = Gᵢ M⁻¹ Gᵢᵀ`, a pass is
//!
//! ```text
//! qᵢ = q₀ + h cᵢ v₀ + h² Σⱼ Bᵢⱼ aⱼ           ηᵢ = Sᵢ⁻¹ φ(qᵢ)           λ += (B⁻¹ η) / h²
//! q̃ᵢ = qᵢ − M⁻¹ Gᵢᵀ ηᵢ                        Fⱼ = ∂L/∂q(q̃ⱼ) + f(q̃ⱼ, vⱼ) − G(q̃ⱼ)ᵀ λⱼ
//! ```
//!
//! Loops go over coordinates by index, and check it: where iterators leave no check, the compiler makes vectors of eight coordinates instead of
//! eight nodes, and gathers them from all over memory.

use super::super::AssembledState;
use super::super::assembly::{Assembly, subtract_pull};
use super::super::gram::GramPattern;
use super::super::mass::ConstantMass;
use super::super::scene::{ConstantInertia, PreparedScene};
use super::super::sparse::Symmetric;
use crate::mechanics::product_of_stored as product;
use crate::memory::memory;
use crate::newton::{LinearProgress, NotConverged};
use crate::scalar::{InstructionSet, LaneOperation, Lanes, Scalar};
use crate::scheme::{LaneTables, PAST};

/// The Gram matrices are made anew after a pass that has moved a point by more than this share of the configuration.
const STALE: f64 = 3e-3;

/// What belongs to all nodes of a step.
pub(super) struct NodeStorage {
    pub(super) tables: LaneTables,
    /// Of the nodes `1 .. K`.
    gram: Symmetric<Lanes>,
    /// Of the nodes `0 .. K−1`.
    start_gram: Symmetric<Lanes>,
    /// Positions at the nodes `1 .. K`; where forces are evaluated those after the constraints, with the start of the step in the lane of its end.
    positions: Vec<Lanes>,
    /// Positions after the constraints of the last pass, where forces depend on them.
    nearest: Vec<Lanes>,
    /// `aⱼ` and `Fⱼ` of the last passes, `j = 0 .. K−1`.
    pub(super) accelerations: Vec<Lanes>,
    pub(super) forces: Vec<Lanes>,
    /// `∂L/∂q + f` of scenes in which it never changes.
    uniform_force: Vec<f64>,
    velocities: Vec<Lanes>,
    multipliers: Vec<Lanes>,
    /// `φ`, then `η`.
    shares: Vec<Lanes>,
    values: Vec<Lanes>,
    slopes: Vec<Lanes>,
    start_slopes: Vec<Lanes>,
    /// The accelerations of the last steps, the last one first. They affect the number of passes and the last bits of a state, nothing else.
    past: [Vec<Lanes>; PAST],
    /// How many of them are known.
    known: usize,
}

impl NodeStorage {
    pub(super) fn new<const K: usize>(assembly: &Assembly, pattern: &GramPattern, h: f64) -> Self {
        let per_coordinate = || vec![Lanes::ZERO; assembly.n_coordinates];
        let per_constraint = || vec![Lanes::ZERO; assembly.n_constraints];
        let per_slope = || vec![Lanes::ZERO; assembly.slots.len()];
        Self {
            tables: LaneTables::new::<K>(h),
            gram: Symmetric::zero(&pattern.elimination),
            start_gram: Symmetric::zero(&pattern.elimination),
            positions: per_coordinate(),
            nearest: if assembly.traits.force_varies() { per_coordinate() } else { Vec::new() },
            accelerations: per_coordinate(),
            forces: per_coordinate(),
            uniform_force: assembly.force_at_origin(),
            velocities: if assembly.traits.force_is_on_v { per_coordinate() } else { Vec::new() },
            multipliers: per_constraint(),
            shares: per_constraint(),
            values: per_constraint(),
            slopes: per_slope(),
            start_slopes: per_slope(),
            past: core::array::from_fn(|_| per_coordinate()),
            known: 0,
        }
    }

    pub(super) const fn knows_the_past(&self) -> bool {
        self.known == PAST
    }

    /// Drops the past: the next step is not predicted from it.
    pub(super) fn forget(&mut self) {
        self.known = 0;
    }

    /// Keeps the accelerations of a step that was taken.
    pub(super) fn remember(&mut self) {
        self.past.rotate_right(1);
        std::mem::swap(&mut self.past[0], &mut self.accelerations);
        self.known = PAST.min(self.known + 1);
    }

    /// `q_K − q₀` of a coordinate that starts with the velocity `v`.
    #[inline]
    pub(super) fn difference<const K: usize>(&self, coordinate: usize, v: f64) -> f64 {
        let inertial = self.tables.nodes * Lanes::splat(v);
        let acceleration = self.accelerations[coordinate];
        product::<K, false>(&self.tables.positions, acceleration, inertial).to_array()[K - 1]
    }

    /// `φ` at the nodes where the last pass has ended.
    pub(super) fn residuals(&self) -> impl Iterator<Item = Lanes> {
        self.values.iter().map(|value| value.abs())
    }
}

// The rest of the storage is written anew in every step.
memory!([] NodeStorage, |words|
    Self {
        tables: _,
        gram: _,
        start_gram: _,
        positions: _,
        nearest: _,
        accelerations: _,
        forces: _,
        uniform_force: _,
        velocities: _,
        multipliers: _,
        shares: _,
        values: _,
        slopes: _,
        start_slopes: _,
        past,
        known,
    } => {
        for accelerations in past {
            words.lane_slice(accelerations);
        }
        words.index(known);
    }
);

/// Where the passes begin.
#[derive(Clone, Copy)]
pub(super) enum FirstGuess {
    /// From the accelerations of the last steps.
    Continued,
    /// From the acceleration of the state, in `space.moved`, at every node.
    Constant,
}

/// Passes until they have converged, as an operation on lanes; returns their number.
pub(super) struct Passes<'a, const K: usize> {
    pub(super) nodes: &'a mut NodeStorage,
    pub(super) scene: &'a mut PreparedScene,
    pub(super) start: &'a AssembledState,
    pub(super) first: FirstGuess,
    pub(super) instructions: InstructionSet,
}

impl<const K: usize> LaneOperation for Passes<'_, K> {
    type Output = Result<usize, NotConverged>;

    #[inline(always)]
    fn run<const FUSED: bool>(self) -> Self::Output {
        let PreparedScene { assembly, inertia, space, .. } = self.scene;
        let Some(ConstantInertia { mass, gram }) = inertia else {
            return Err(NotConverged { corrections: 0, last_correction: f64::NAN });
        };
        let scene = Scene { assembly, mass, pattern: &gram.pattern, instructions: self.instructions };
        match self.first {
            FirstGuess::Continued => self.nodes.continue_past::<K, FUSED>(assembly.n_coordinates),
            FirstGuess::Constant => {
                for i in 0..assembly.n_coordinates {
                    self.nodes.accelerations[i] = Lanes::splat(space.moved[i]);
                }
            }
        }
        self.nodes.iterate::<K, FUSED>(&scene, self.start)
    }
}

/// What passes read of a scene.
struct Scene<'a> {
    assembly: &'a Assembly,
    mass: &'a ConstantMass,
    pattern: &'a GramPattern,
    instructions: InstructionSet,
}

impl NodeStorage {
    #[inline(always)]
    fn continue_past<const K: usize, const FUSED: bool>(&mut self, n_coordinates: usize) {
        let [of_last, of_before] = &self.tables.prediction;
        let [last, before] = &self.past;
        for i in 0..n_coordinates {
            let older = product::<K, FUSED>(of_before, before[i], Lanes::ZERO);
            self.accelerations[i] = product::<K, FUSED>(of_last, last[i], older);
        }
    }

    #[inline(always)]
    fn iterate<const K: usize, const FUSED: bool>(
        &mut self,
        scene: &Scene<'_>,
        start: &AssembledState,
    ) -> Result<usize, NotConverged> {
        let Scene { assembly, mass, pattern, instructions } = *scene;
        let n = assembly.n_coordinates;
        let is_constrained = assembly.n_constraints > 0;
        let force_varies = assembly.traits.force_varies();
        let times = self.tables.nodes + Lanes::splat(start.t);
        self.place::<K, FUSED>(start);
        if force_varies {
            self.nearest.copy_from_slice(&self.positions);
        }
        let (reach, whole) = self.reach::<K>(mass, start);
        let per_reach = 1.0 / reach;
        // Residuals of constraints are those of positions that are rounded: no pass gains what is lost there.
        let rounded = if is_constrained { reach / whole } else { 1.0 };
        let mut progress = LinearProgress::default();
        let (mut is_stale, mut passes) = (true, 0);
        loop {
            if is_constrained {
                if is_stale {
                    let (values, slopes) = (&mut self.values, &mut self.slopes);
                    assembly.lane_constraint_derivatives(
                        instructions,
                        times,
                        &self.positions,
                        values,
                        slopes,
                    );
                    pattern.symmetric::<Lanes, FUSED>(mass, &self.slopes, &mut self.gram);
                    self.gram.factor_unchecked::<FUSED>(&pattern.elimination);
                } else {
                    assembly.lane_constraints(instructions, times, &self.positions, &mut self.values);
                }
                self.shares.copy_from_slice(&self.values);
                self.gram.solve::<FUSED>(&pattern.elimination, &mut self.shares);
                // `−Gᵀ η`, in the place of the forces, which are not needed any more.
                self.forces.fill(Lanes::ZERO);
                subtract_pull::<Lanes, FUSED>(&assembly.slots, &self.slopes, &self.shares, &mut self.forces);
            }
            // The largest displacement, in the metric of the mass matrix, at every node.
            let mut lengths = Lanes::ZERO;
            for i in 0..n {
                let mut position = self.positions[i];
                if force_varies {
                    let moved = position - self.nearest[i];
                    lengths = lengths.larger(moved.abs() * Lanes::splat(mass.units[i]));
                    self.nearest[i] = position;
                }
                if is_constrained {
                    let displacement = mass.inverse_times_at::<Lanes, FUSED>(&self.forces, i);
                    lengths = lengths.larger(displacement.abs() * Lanes::splat(mass.units[i]));
                    position = position + displacement;
                }
                // The end of the step gives its lane to the start; the positions are made anew.
                self.positions[i] = position.with(K - 1, start.q[i]);
            }
            self.set_forces::<K, FUSED>(scene, start, passes == 0);
            for i in 0..n {
                self.accelerations[i] = mass.inverse_times_at::<Lanes, FUSED>(&self.forces, i);
            }
            self.place::<K, FUSED>(start);
            passes += 1;
            let length = lengths.largest() * per_reach;
            is_stale = length > STALE;
            // In the first pass nothing has moved yet.
            let square = (rounded * length) * (rounded * length);
            if (passes == 1 && force_varies) || !progress.has_converged(square)? {
                continue;
            }
            // Comparisons lose a NaN on the way; at the end of a step it arrives from every node.
            let sum: f64 = self.positions.iter().map(|position| position.to_array()[K - 1]).sum();
            if !sum.is_finite() {
                return Err(NotConverged { corrections: passes, last_correction: f64::NAN });
            }
            return Ok(passes);
        }
    }

    /// Overwrites the positions with those of the accelerations.
    #[inline(always)]
    fn place<const K: usize, const FUSED: bool>(&mut self, start: &AssembledState) {
        for i in 0..start.q.len() {
            let inertial = self.tables.nodes * Lanes::splat(start.v[i]);
            let difference = product::<K, FUSED>(&self.tables.positions, self.accelerations[i], inertial);
            self.positions[i] = Lanes::splat(start.q[i]) + difference;
        }
    }

    /// What a step from `start` is found to the round-off of, in the metric of the mass matrix, and what its positions are rounded in.
    fn reach<const K: usize>(&self, mass: &ConstantMass, start: &AssembledState) -> (f64, f64) {
        let h = self.tables.nodes.to_array()[K - 1].abs();
        let (mut here, mut way) = (0.0_f64, 0.0_f64);
        for ((unit, q), v) in mass.units.iter().zip(&start.q).zip(&start.v) {
            here = here.max(unit * q.abs());
            way = way.max(unit * h * v.abs());
        }
        (crate::mechanics::reach(here, way), here + way)
    }

    /// Overwrites the forces with `Fⱼ` at the nodes before the last, of the points after the constraints, with multipliers that take up the shares of
    /// the residual; in the first pass with those that the predicted accelerations imply.
    #[inline(always)]
    fn set_forces<const K: usize, const FUSED: bool>(
        &mut self,
        scene: &Scene<'_>,
        start: &AssembledState,
        is_first: bool,
    ) {
        let Scene { assembly, instructions, .. } = *scene;
        let times = (self.tables.nodes + Lanes::splat(start.t)).with(K - 1, start.t);
        let velocities = if assembly.traits.force_is_on_v {
            for i in 0..assembly.n_coordinates {
                let v = Lanes::splat(start.v[i]);
                self.velocities[i] = product::<K, FUSED>(&self.tables.velocities, self.accelerations[i], v);
            }
            Some(&self.velocities[..])
        } else {
            None
        };
        if assembly.traits.has_uniform_force() {
            for i in 0..assembly.n_coordinates {
                self.forces[i] = Lanes::splat(self.uniform_force[i]);
            }
        } else {
            assembly.lane_force(instructions, times, &self.positions, velocities, &mut self.forces);
        }
        if assembly.n_constraints == 0 {
            return;
        }
        if is_first {
            self.imply_multipliers::<FUSED>(scene, times);
        }
        for c in 0..assembly.n_constraints {
            let (share, multiplier) = (self.shares[c], self.multipliers[c]);
            self.multipliers[c] = product::<K, FUSED>(&self.tables.accelerations, share, multiplier);
        }
        let (multipliers, forces) = (&self.multipliers, &mut self.forces);
        assembly.subtract_lane_pull(instructions, times, &self.positions, multipliers, forces);
    }

    /// Overwrites the multipliers with those of the predicted accelerations under the forces: `λⱼ = Sⱼ⁻¹ Gⱼ (M⁻¹ fⱼ − aⱼ)`.
    #[inline(always)]
    fn imply_multipliers<const FUSED: bool>(&mut self, scene: &Scene<'_>, times: Lanes) {
        let Scene { assembly, mass, pattern, instructions } = *scene;
        // The values of the multipliers' place are not needed yet.
        let (values, slopes) = (&mut self.multipliers, &mut self.start_slopes);
        assembly.lane_constraint_derivatives(instructions, times, &self.positions, values, slopes);
        pattern.symmetric::<Lanes, FUSED>(mass, &self.start_slopes, &mut self.start_gram);
        self.start_gram.factor_unchecked::<FUSED>(&pattern.elimination);
        self.multipliers.fill(Lanes::ZERO);
        for (slot, &slope) in assembly.slots.iter().zip(&self.start_slopes) {
            let (row, col) = (slot.row as usize, slot.col as usize);
            let held = mass.inverse_times_at::<Lanes, FUSED>(&self.forces, col) - self.accelerations[col];
            self.multipliers[row] = slope.times_plus::<FUSED>(held, self.multipliers[row]);
        }
        self.start_gram.solve::<FUSED>(&pattern.elimination, &mut self.multipliers);
    }
}
