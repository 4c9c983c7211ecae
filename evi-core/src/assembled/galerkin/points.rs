//! Passes over the points of a step, a node per lane, for masses that vary or that couple bodies.
//!
//! The equations are those of `mechanics/point_passes.rs`: with momenta `pⱼ = ∂L/∂v` and forces `Fⱼ = ∂L/∂q + f − Gᵀλⱼ`
//!
//! ```text
//! rᵢ = h Σⱼ (A Π)ᵢⱼ (p₀ − pⱼ) + h² Σⱼ Bᵢⱼ Fⱼ = 0        φ(qᵢ) = 0
//! ```
//!
//! for the differences `dᵢ = qᵢ − q₀`. A pass solves, with the mass matrix and the constraints of every point,
//!
//! ```text
//! [Mᵢ Gᵢᵀ; Gᵢ 0] [Δdᵢ; ηᵢ] = [rᵢ; −φ(qᵢ)]        d += Δd        v += D Δd / h        λ += (B⁻¹ η) / h²
//! ```
//!
//! which leaves a point on its constraints but for squares of its way: both halves of a pass in one solve, where an elimination costs more than a
//! kernel.

use super::super::AssembledState;
use super::super::assembly::{Assembly, Point};
use super::super::elements::LanePoint;
use super::super::lane_saddle::LaneSaddle;
use super::super::scene::{PreparedScene, Space};
use super::super::sparse::TooMuchFill;
use super::passes::FirstGuess;
use super::past::Past;
use crate::linear::largest_magnitude;
use crate::mechanics::reach::larger;
use crate::mechanics::{Length, product};
use crate::memory::memory;
use crate::newton::{LinearProgress, NotConverged};
use crate::scalar::{InstructionSet, LaneOperation, Lanes, Scalar};
use crate::scheme::{Columns, PAST, PointTables};

/// The matrices are made anew after a pass that has moved a point by more than this share of the configuration.
const STALE: f64 = 3e-3;

/// Velocities at the nodes `1 .. K` and multipliers at the nodes before the last.
pub(super) struct Motion {
    velocities: Vec<Lanes>,
    multipliers: Vec<Lanes>,
}

impl Motion {
    fn rest(assembly: &Assembly) -> Self {
        Self {
            velocities: vec![Lanes::ZERO; assembly.n_coordinates],
            multipliers: vec![Lanes::ZERO; assembly.n_constraints],
        }
    }
}

memory!([] Motion, |words| Self { velocities, multipliers } => {
    words.lane_slice(velocities);
    words.lane_slice(multipliers);
});

/// What belongs to all nodes of a step.
pub(super) struct PointStorage {
    tables: PointTables,
    matrix: LaneSaddle,
    /// `√Mᵢᵢ`, or more: what lengths are multiplied with before they are compared.
    units: Vec<f64>,
    differences: Vec<Lanes>,
    positions: Vec<Lanes>,
    motion: Motion,
    start_velocity: Vec<f64>,
    /// `pⱼ` at the nodes `1 .. K`, `Fⱼ` at the nodes before the last.
    momenta: Vec<Lanes>,
    forces: Vec<Lanes>,
    /// `F_K`, without multipliers.
    end_force: Vec<f64>,
    values: Vec<Lanes>,
    slopes: Vec<Lanes>,
    /// The right-hand side of a pass, then what it moves: coordinates, then constraints.
    unknowns: Vec<Lanes>,
    pub(super) past: Past<Motion>,
}

impl PointStorage {
    /// # Errors
    /// [`TooMuchFill`].
    pub(super) fn new<const K: usize>(assembly: &Assembly, h: f64) -> Result<Self, TooMuchFill> {
        let (n, m) = (assembly.n_coordinates, assembly.n_constraints);
        let lanes = |count: usize| vec![Lanes::ZERO; count];
        Ok(Self {
            tables: PointTables::new::<K>(h),
            matrix: LaneSaddle::new(assembly)?,
            units: vec![0.0; n],
            differences: lanes(n),
            positions: lanes(n),
            motion: Motion::rest(assembly),
            start_velocity: vec![0.0; n],
            momenta: lanes(n),
            forces: lanes(n),
            end_force: vec![0.0; n],
            values: lanes(m),
            slopes: lanes(assembly.slots.len()),
            unknowns: lanes(n + m),
            past: Past::none(|| Motion::rest(assembly)),
        })
    }

    /// Keeps the motion of a step that was taken.
    pub(super) fn remember(&mut self) {
        self.past.remember(&mut self.motion);
    }

    /// The largest `|φ|` at the nodes where the last pass has ended.
    pub(super) fn largest_residual(&self) -> f64 {
        largest_magnitude(self.values.iter().map(|value| value.abs().largest()))
    }

    /// Overwrites `space.moved` with the difference `q_K − q₀`, `space.p` with `p₀ + h Σ bⱼ Fⱼ` without the multipliers of the end, and `space.v` with
    /// the velocity there.
    pub(super) fn arrive<const K: usize>(&self, space: &mut Space, start: &AssembledState) {
        let lobatto = &self.tables.lobatto;
        for i in 0..start.q.len() {
            let before_last = (lobatto.weights * self.forces[i]).sum();
            space.moved[i] = self.differences[i].to_array()[K - 1];
            space.p[i] = start.p[i] + (lobatto.last_weight * self.end_force[i] + before_last);
            space.v[i] = self.motion.velocities[i].to_array()[K - 1];
        }
    }
}

// The rest of the storage is written anew in every step.
memory!([] PointStorage, |words|
    Self {
        tables: _,
        matrix: _,
        units: _,
        differences: _,
        positions: _,
        motion: _,
        start_velocity: _,
        momenta: _,
        forces: _,
        end_force: _,
        values: _,
        slopes: _,
        unknowns: _,
        past,
    } => {
        words.part(past);
    }
);

/// Passes until they have converged, as an operation on lanes; returns their number. `space.at_start` holds the constraints of the start.
pub(super) struct PointPasses<'a, const K: usize> {
    pub(super) nodes: &'a mut PointStorage,
    pub(super) scene: &'a mut PreparedScene,
    pub(super) start: &'a AssembledState,
    pub(super) first: FirstGuess,
    pub(super) instructions: InstructionSet,
}

impl<const K: usize> LaneOperation for PointPasses<'_, K> {
    type Output = Result<usize, NotConverged>;

    #[inline(always)]
    fn run<const FUSED: bool>(self) -> Self::Output {
        let Self { nodes, scene, start, first, instructions } = self;
        let PreparedScene { assembly, space, .. } = scene;
        nodes.guess::<K, FUSED>(space, start, first);
        nodes.iterate::<K, FUSED>(assembly, space, start, instructions)
    }
}

impl PointStorage {
    #[inline(always)]
    fn guess<const K: usize, const FUSED: bool>(
        &mut self,
        space: &Space,
        start: &AssembledState,
        first: FirstGuess,
    ) {
        let Self { tables, motion, past, .. } = self;
        let [last, before] = past.found();
        match first {
            FirstGuess::Continued => {
                let continued = |prediction: &[Columns; PAST], last: Lanes, before: Lanes| {
                    let older = product::<K, FUSED>(&prediction[1], before, Lanes::ZERO);
                    product::<K, FUSED>(&prediction[0], last, older)
                };
                for (i, velocity) in motion.velocities.iter_mut().enumerate() {
                    *velocity = continued(&tables.prediction, last.velocities[i], before.velocities[i]);
                }
                for (c, multiplier) in motion.multipliers.iter_mut().enumerate() {
                    let prediction = &tables.lobatto.prediction;
                    *multiplier = continued(prediction, last.multipliers[c], before.multipliers[c]);
                }
            }
            FirstGuess::Constant => {
                for (i, velocity) in motion.velocities.iter_mut().enumerate() {
                    let change = tables.lobatto.nodes * Lanes::splat(space.moved[i]);
                    *velocity = Lanes::splat(start.v[i]) + change;
                }
                for (multiplier, &rate) in motion.multipliers.iter_mut().zip(&space.rates) {
                    *multiplier = Lanes::splat(rate);
                }
            }
        }
        for i in 0..start.q.len() {
            let velocity = self.motion.velocities[i];
            self.differences[i] = product::<K, FUSED>(&self.tables.ways, velocity, Lanes::ZERO);
            self.start_velocity[i] = (self.tables.extrapolation * velocity).sum();
        }
    }

    #[inline(always)]
    fn iterate<const K: usize, const FUSED: bool>(
        &mut self,
        assembly: &Assembly,
        space: &mut Space,
        start: &AssembledState,
        instructions: InstructionSet,
    ) -> Result<usize, NotConverged> {
        let n = assembly.n_coordinates;
        let times = self.tables.lobatto.nodes + Lanes::splat(start.t);
        let mut per_reach = 0.0;
        let mut progress = LinearProgress::default();
        let (mut is_stale, mut is_last, mut passes) = (true, false, 0);
        loop {
            for i in 0..n {
                self.positions[i] = Lanes::splat(start.q[i]) + self.differences[i];
            }
            let Self { matrix, units, positions, motion, values, slopes, .. } = &mut *self;
            if is_stale {
                assembly.lane_constraint_derivatives(instructions, times, positions, values, slopes);
                let at = LanePoint { t: times, q: positions, v: &motion.velocities };
                matrix.factor::<FUSED>(assembly, instructions, at, slopes, units);
                per_reach = 1.0 / self.measured::<K>(start);
            } else {
                let at = (times, &positions[..]);
                assembly.lane_constraints(instructions, assembly.all(), at, values);
            }
            self.evaluate::<K>(assembly, space, start, times, instructions);
            passes += 1;
            if is_last {
                // Comparisons lose a NaN on the way; in the sums over all nodes it arrives.
                let sum: f64 = self
                    .differences
                    .iter()
                    .zip(&self.forces)
                    .map(|(d, f)| d.to_array()[K - 1] + f.sum())
                    .sum();
                let is_finite = sum.is_finite();
                return if is_finite {
                    Ok(passes)
                } else {
                    Err(NotConverged { corrections: passes, last_correction: f64::NAN })
                };
            }
            self.set_residual::<K, FUSED>(space, start);
            self.matrix.solve::<FUSED>(&mut self.unknowns);
            let length = self.apply::<K, FUSED>(n) * per_reach;
            is_stale = length > STALE;
            // Then once more, for the forces where the points have come to.
            is_last = progress.has_converged(length * length)?;
        }
    }

    /// Overwrites momenta and forces: at the nodes over lanes, at the start by itself, in `space.momentum` and in the lane that the end has of the forces.
    #[inline(always)]
    fn evaluate<const K: usize>(
        &mut self,
        assembly: &Assembly,
        space: &mut Space,
        start: &AssembledState,
        times: Lanes,
        instructions: InstructionSet,
    ) {
        let Self { positions, motion, momenta, forces, end_force, start_velocity, .. } = self;
        let Motion { velocities, multipliers } = motion;
        assembly.lane_gradient(
            instructions,
            LanePoint { t: times, q: positions, v: velocities },
            forces,
            momenta,
        );
        for (end, force) in end_force.iter_mut().zip(forces.iter()) {
            *end = force.to_array()[K - 1];
        }
        assembly.subtract_lane_pull(instructions, assembly.all(), (times, positions), multipliers, forces);
        let at = Point { t: start.t, q: &start.q, v: start_velocity };
        assembly.gradient(at, &mut space.force, &mut space.momentum);
        for (slot, slope) in assembly.slots.iter().zip(&space.at_start.slopes) {
            space.force[slot.col as usize] -= slope * multipliers[slot.row as usize].to_array()[K - 1];
        }
        for (force, &of_start) in forces.iter_mut().zip(&space.force) {
            *force = force.with(K - 1, of_start);
        }
    }

    /// Overwrites the unknowns with `rᵢ` and `−φ`.
    #[inline(always)]
    fn set_residual<const K: usize, const FUSED: bool>(&mut self, space: &Space, start: &AssembledState) {
        let (n, tables) = (start.q.len(), &self.tables);
        for i in 0..n {
            let missing = Lanes::splat(start.p[i]) - self.momenta[i];
            let start_missing = Lanes::splat(start.p[i] - space.momentum[i]);
            let of_forces = product::<K, FUSED>(&tables.lobatto.positions, self.forces[i], Lanes::ZERO);
            let of_start = tables.start_momentum.times_plus::<FUSED>(start_missing, of_forces);
            self.unknowns[i] = product::<K, FUSED>(&tables.momenta, missing, of_start);
        }
        for (c, &value) in self.values.iter().enumerate() {
            self.unknowns[n + c] = -value;
        }
    }

    /// Moves points, velocities and multipliers by the unknowns; returns the largest way of a point.
    #[inline(always)]
    fn apply<const K: usize, const FUSED: bool>(&mut self, n: usize) -> f64 {
        let Self { tables, motion, differences, .. } = self;
        let mut lengths = Lanes::ZERO;
        for i in 0..n {
            let moved = self.unknowns[i];
            lengths = lengths.larger(moved.abs() * Lanes::splat(self.units[i]));
            differences[i] = differences[i] + moved;
            motion.velocities[i] = product::<K, FUSED>(&tables.rates, moved, motion.velocities[i]);
            self.start_velocity[i] += (tables.start_rates * moved).sum();
        }
        for (multiplier, &share) in motion.multipliers.iter_mut().zip(&self.unknowns[n..]) {
            *multiplier = product::<K, FUSED>(&tables.lobatto.accelerations, share, *multiplier);
        }
        lengths.largest()
    }

    /// What a step from `start` is found to the round-off of, in the metric of the diagonal of the mass matrix, where light coordinates get a unit of plain
    /// numbers.
    fn measured<const K: usize>(&mut self, start: &AssembledState) -> f64 {
        let (mut here, mut way) = (Length::default(), Length::default());
        for ((unit, q), difference) in self.units.iter().zip(&start.q).zip(&self.differences) {
            here = here.with(*unit, *q);
            way = way.with(*unit, difference.to_array()[K - 1]);
        }
        let reach = here.reach(way);
        self.units.iter_mut().for_each(|unit| *unit = larger(*unit, reach.least_unit()));
        reach.metric
    }
}
