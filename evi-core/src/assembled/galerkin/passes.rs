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

use std::ops::Range;

use super::super::AssembledState;
use super::super::assembly::Assembly;
use super::super::gram::GramPattern;
use super::super::mass::ConstantMass;
use super::super::scene::{ConstantInertia, PreparedScene};
use super::super::sparse::Symmetric;
use super::past::Past;
use super::sweeps::Sweeps;
use crate::linear::largest_magnitude;
use crate::mechanics::reach::larger;
use crate::mechanics::{Length, product_of_stored as product};
use crate::memory::memory;
use crate::newton::{LinearProgress, NotConverged};
use crate::scalar::{InstructionSet, LaneOperation, Lanes, Scalar};
use crate::scheme::LaneTables;

/// The Gram matrices are made anew after a pass that has moved a point by more than this share of the configuration.
const STALE: f64 = 3e-3;

/// What belongs to all nodes of a step.
pub(super) struct NodeStorage {
    pub(super) tables: LaneTables,
    pub(super) sweeps: Sweeps,
    /// Of the nodes `1 .. K`.
    pub(super) gram: Symmetric<Lanes>,
    /// Of the nodes `0 .. K−1`.
    pub(super) start_gram: Symmetric<Lanes>,
    /// Positions at the nodes `1 .. K`; where forces are evaluated those after the constraints, with the start of the step in the lane of its end.
    pub(super) positions: Vec<Lanes>,
    /// Positions after the constraints of the last pass, where forces depend on them.
    pub(super) nearest: Vec<Lanes>,
    /// What displacements of a coordinate are multiplied with before they are compared: [`Length::least_unit`] or more.
    pub(super) units: Vec<f64>,
    /// `aⱼ` and `Fⱼ` of the last passes, `j = 0 .. K−1`.
    pub(super) accelerations: Vec<Lanes>,
    pub(super) forces: Vec<Lanes>,
    /// `∂L/∂q + f` of scenes in which it never changes, zero in others.
    pub(super) uniform_force: Vec<f64>,
    pub(super) velocities: Vec<Lanes>,
    pub(super) multipliers: Vec<Lanes>,
    /// `φ`, then `η`.
    pub(super) shares: Vec<Lanes>,
    /// Of the constraints that a Gram matrix is made of.
    pub(super) slopes: Vec<Lanes>,
    /// The largest displacement of every step of a sweep in the last pass, in these units.
    pub(super) lengths: Vec<f64>,
    /// The steps of a sweep that have held back all others, in this step or before. They affect what [`past`](Self::past) does.
    pub(super) slowest: Range<usize>,
    pub(super) past: Past<Vec<Lanes>>,
}

impl NodeStorage {
    pub(super) fn new<const K: usize>(assembly: &Assembly, inertia: &ConstantInertia, h: f64) -> Self {
        let (n, traits) = (assembly.n_coordinates, &assembly.traits);
        let lanes = |count: usize| vec![Lanes::ZERO; count];
        let where_it = |is_needed: bool| lanes(if is_needed { n } else { 0 });
        let pattern = &inertia.gram.pattern;
        let sweeps = Sweeps::new(assembly, &inertia.mass, pattern);
        Self {
            tables: LaneTables::new::<K>(h),
            lengths: vec![0.0; sweeps.steps().len()],
            sweeps,
            slowest: 0..0,
            gram: Symmetric::zero(&pattern.elimination),
            start_gram: Symmetric::zero(&pattern.elimination),
            positions: lanes(n),
            nearest: where_it(traits.force_varies()),
            units: vec![0.0; n],
            accelerations: lanes(n),
            forces: lanes(n),
            uniform_force: if traits.has_uniform_force() { assembly.force_at_origin() } else { vec![0.0; n] },
            velocities: where_it(traits.force_is_on_v),
            multipliers: lanes(assembly.n_constraints),
            shares: lanes(assembly.n_constraints),
            slopes: lanes(assembly.slots.len()),
            past: Past::none(|| lanes(n)),
        }
    }

    /// Keeps the accelerations of a step that was taken.
    pub(super) fn remember(&mut self) {
        self.past.remember(&mut self.accelerations);
    }

    /// `q_K − q₀` of a coordinate that starts with the velocity `v`.
    #[inline]
    pub(super) fn difference<const K: usize>(&self, coordinate: usize, v: f64) -> f64 {
        let inertial = self.tables.nodes * Lanes::splat(v);
        let acceleration = self.accelerations[coordinate];
        product::<K, false>(&self.tables.positions, acceleration, inertial).to_array()[K - 1]
    }

    /// The largest `|φ|` at the nodes where the last pass has ended.
    pub(super) fn largest_residual(
        &mut self,
        assembly: &Assembly,
        instructions: InstructionSet,
        t: f64,
    ) -> f64 {
        let times = self.tables.nodes + Lanes::splat(t);
        let values = &mut self.shares;
        assembly.lane_constraints(instructions, assembly.all(), (times, &self.positions), values);
        largest_magnitude(values.iter().map(|value| value.abs().largest()))
    }
}

// The rest of the storage is written anew in every step.
memory!([] NodeStorage, |words|
    Self {
        tables: _,
        sweeps: _,
        gram: _,
        start_gram: _,
        positions: _,
        nearest: _,
        units: _,
        accelerations: _,
        forces: _,
        uniform_force: _,
        velocities: _,
        multipliers: _,
        shares: _,
        slopes: _,
        lengths: _,
        slowest: Range { start, end },
        past,
    } => {
        words.index(start);
        words.index(end);
        words.part(past);
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
        let scene = Scene {
            assembly,
            mass,
            pattern: &gram.pattern,
            instructions: self.instructions,
            start: self.start,
        };
        match self.first {
            FirstGuess::Continued => self.nodes.continue_past::<K, FUSED>(assembly.n_coordinates),
            FirstGuess::Constant => {
                for i in 0..assembly.n_coordinates {
                    self.nodes.accelerations[i] = Lanes::splat(space.moved[i]);
                }
            }
        }
        self.nodes.iterate::<K, FUSED>(scene)
    }
}

/// What passes read of a scene.
#[derive(Clone, Copy)]
pub(super) struct Scene<'a> {
    pub(super) assembly: &'a Assembly,
    pub(super) mass: &'a ConstantMass,
    pub(super) pattern: &'a GramPattern,
    pub(super) instructions: InstructionSet,
    /// Where a step begins.
    pub(super) start: &'a AssembledState,
}

impl NodeStorage {
    #[inline(always)]
    fn continue_past<const K: usize, const FUSED: bool>(&mut self, n_coordinates: usize) {
        let [of_last, of_before] = &self.tables.prediction;
        let [last, before] = self.past.found();
        for i in 0..n_coordinates {
            let older = product::<K, FUSED>(of_before, before[i], Lanes::ZERO);
            self.accelerations[i] = product::<K, FUSED>(of_last, last[i], older);
        }
    }

    #[inline(always)]
    fn iterate<const K: usize, const FUSED: bool>(
        &mut self,
        scene: Scene<'_>,
    ) -> Result<usize, NotConverged> {
        let Scene { assembly, mass, start, .. } = scene;
        let force_varies = assembly.traits.force_varies();
        for i in 0..assembly.n_coordinates {
            self.place::<K, FUSED>(start, i);
        }
        if force_varies {
            self.nearest.copy_from_slice(&self.positions);
        }
        let (here, way) = self.reach::<K>(mass, start);
        let reach = here.reach(way);
        for (unit, of_mass) in self.units.iter_mut().zip(&mass.units) {
            *unit = larger(*of_mass, reach.least_unit());
        }
        let per_reach = 1.0 / reach.metric;
        // Residuals of constraints are those of positions that are rounded: no pass gains what is lost there.
        let rounded =
            if assembly.n_constraints > 0 { reach.metric / (here.metric + way.metric) } else { 1.0 };
        let mut progress = LinearProgress::default();
        let (mut is_stale, mut passes) = (true, 0);
        loop {
            let ends = if passes == 0 {
                self.first_pass::<K, FUSED>(scene)
            } else {
                self.pass::<K, FUSED>(scene, is_stale)
            };
            passes += 1;
            let length = largest_magnitude(self.lengths.iter().copied()) * per_reach;
            is_stale = length > STALE;
            // In the first pass nothing has moved yet.
            let square = (rounded * length) * (rounded * length);
            if (passes == 1 && force_varies) || !progress.has_converged(square)? {
                self.settle::<K, FUSED>(scene);
                continue;
            }
            // Comparisons lose a NaN on the way; at the end of a step it arrives from every node.
            if !ends.to_array()[K - 1].is_finite() {
                return Err(NotConverged { corrections: passes, last_correction: f64::NAN });
            }
            return Ok(passes);
        }
    }

    /// Overwrites the positions of a coordinate with those of its accelerations.
    #[inline(always)]
    pub(super) fn place<const K: usize, const FUSED: bool>(&mut self, start: &AssembledState, i: usize) {
        let inertial = self.tables.nodes * Lanes::splat(start.v[i]);
        let difference = product::<K, FUSED>(&self.tables.positions, self.accelerations[i], inertial);
        self.positions[i] = Lanes::splat(start.q[i]) + difference;
    }

    /// The configuration at `start`, and the way from there in a step.
    fn reach<const K: usize>(&self, mass: &ConstantMass, start: &AssembledState) -> (Length, Length) {
        let h = self.tables.nodes.to_array()[K - 1];
        let (mut here, mut way) = (Length::default(), Length::default());
        for ((unit, q), v) in mass.units.iter().zip(&start.q).zip(&start.v) {
            here = here.with(*unit, *q);
            way = way.with(*unit, h * v);
        }
        (here, way)
    }
}
