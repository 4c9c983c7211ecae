//! The stages of a pass, in the steps of its [`Sweeps`](super::sweeps::Sweeps).

use std::ops::Range;

use super::super::AssembledState;
use super::passes::{NodeStorage, Scene};
use crate::mechanics::product_of_stored as product;
use crate::scalar::{Lanes, Scalar};

impl NodeStorage {
    /// A pass; overwrites `lengths` with the largest displacements, in the units of the storage, and returns the sum of all new positions.
    #[inline(always)]
    pub(super) fn pass<const K: usize, const FUSED: bool>(
        &mut self,
        scene: Scene<'_>,
        is_stale: bool,
    ) -> Lanes {
        self.evaluate_constraints::<FUSED>(scene, is_stale);
        let mut ends = Lanes::ZERO;
        for step in self.sweeps.steps() {
            self.lengths[step] = self.meet_constraints::<K, FUSED>(scene, step).largest();
            self.add_forces::<K>(scene, step);
            ends = ends + self.follow_forces::<K, FUSED>(scene, step);
        }
        ends
    }

    /// The first pass, with multipliers that the predicted accelerations imply.
    #[inline(always)]
    pub(super) fn first_pass<const K: usize, const FUSED: bool>(&mut self, scene: Scene<'_>) -> Lanes {
        self.evaluate_constraints::<FUSED>(scene, true);
        let mut ends = Lanes::ZERO;
        for step in self.sweeps.steps() {
            self.lengths[step] = self.meet_constraints::<K, FUSED>(scene, step).largest();
            self.add_forces::<K>(scene, step);
        }
        if scene.assembly.n_constraints > 0 {
            self.imply_multipliers::<K, FUSED>(scene);
        }
        for step in self.sweeps.steps() {
            ends = ends + self.follow_forces::<K, FUSED>(scene, step);
        }
        ends
    }

    /// Overwrites the shares with the first half of `S⁻¹ φ`, with new Gram matrices if these are stale.
    #[inline(always)]
    fn evaluate_constraints<const FUSED: bool>(&mut self, scene: Scene<'_>, is_stale: bool) {
        let Scene { assembly, mass, pattern, instructions, start } = scene;
        let Self { tables, sweeps, gram, positions, shares, slopes, .. } = self;
        let times = tables.nodes + Lanes::splat(start.t);
        if is_stale {
            assembly.lane_constraint_derivatives(instructions, times, positions, shares, slopes);
            pattern.symmetric::<Lanes, FUSED>(mass, slopes, gram);
            gram.factor_unchecked::<FUSED>(&pattern.elimination);
        }
        for step in sweeps.steps() {
            if !is_stale {
                let elements = |family: usize| sweeps.families[family].evaluated.of(step);
                assembly.lane_constraints(instructions, elements, (times, positions), shares);
            }
            gram.solve_forward::<FUSED>(&pattern.elimination, sweeps.forward.of(step), shares);
        }
    }

    /// Moves points onto the constraints, `q̃ᵢ = qᵢ − M⁻¹ Gᵢᵀ ηᵢ`, and begins the forces there; returns the largest displacement.
    #[inline(always)]
    fn meet_constraints<const K: usize, const FUSED: bool>(
        &mut self,
        scene: Scene<'_>,
        step: usize,
    ) -> Lanes {
        let Scene { assembly, mass, pattern, instructions, start } = scene;
        let Self { tables, sweeps, gram, positions, nearest, forces, shares, units, .. } = self;
        let is_constrained = assembly.n_constraints > 0;
        if is_constrained {
            gram.solve_backward::<FUSED>(&pattern.elimination, sweeps.backward.of(step), shares);
            // `−Gᵀ η`, in the place of the forces, which are not needed any more.
            forces[sweeps.reached.of(step)].fill(Lanes::ZERO);
            let times = tables.nodes + Lanes::splat(start.t);
            let elements = |family: usize| sweeps.families[family].pulled.of(step);
            assembly.subtract_lane_pull(instructions, elements, (times, positions), shares, forces);
        }
        let force_varies = assembly.traits.force_varies();
        let mut lengths = Lanes::ZERO;
        for i in sweeps.moved.of(step) {
            let mut position = positions[i];
            if force_varies {
                let moved = position - nearest[i];
                lengths = lengths.larger(moved.abs() * Lanes::splat(units[i]));
                nearest[i] = position;
            }
            if is_constrained {
                let displacement = mass.inverse_times_at::<Lanes, FUSED>(forces, i);
                lengths = lengths.larger(displacement.abs() * Lanes::splat(units[i]));
                position = position + displacement;
            }
            // The end of the step gives its lane to the start; the positions are made anew.
            positions[i] = position.with(K - 1, start.q[i]);
        }
        if assembly.traits.force_is_on_v {
            self.set_velocities::<K, FUSED>(start, self.sweeps.moved.of(step));
        }
        for i in self.sweeps.moved.of(step) {
            self.forces[i] = Lanes::splat(self.uniform_force[i]);
        }
        lengths
    }

    /// Adds the forces at `q̃`, those of the constraints aside.
    #[inline(always)]
    fn add_forces<const K: usize>(&mut self, scene: Scene<'_>, step: usize) {
        let Scene { assembly, instructions, .. } = scene;
        if assembly.traits.has_uniform_force() {
            return;
        }
        let times = self.force_times::<K>(scene);
        let Self { sweeps, positions, velocities, forces, .. } = self;
        let velocities = assembly.traits.force_is_on_v.then_some(&velocities[..]);
        let elements = |family: usize| sweeps.families[family].acting.of(step);
        assembly.add_lane_force(instructions, elements, (times, positions, velocities), forces);
    }

    /// Multipliers take up the shares of the residual and pull at `q̃`; then accelerations and positions are those of the forces. Returns the sum of
    /// the positions.
    #[inline(always)]
    fn follow_forces<const K: usize, const FUSED: bool>(&mut self, scene: Scene<'_>, step: usize) -> Lanes {
        let Scene { assembly, mass, instructions, start, .. } = scene;
        if assembly.n_constraints > 0 {
            let times = self.force_times::<K>(scene);
            let Self { tables, sweeps, positions, forces, multipliers, shares, .. } = &mut *self;
            let elements = |family: usize| sweeps.families[family].acting.of(step);
            for (index, family) in assembly.families.iter().enumerate() {
                for c in family.rows_of(elements(index)) {
                    multipliers[c] = product::<K, FUSED>(&tables.accelerations, shares[c], multipliers[c]);
                }
            }
            assembly.subtract_lane_pull(instructions, elements, (times, positions), multipliers, forces);
        }
        let mut sum = Lanes::ZERO;
        for i in self.sweeps.placed.of(step) {
            self.accelerations[i] = mass.inverse_times_at::<Lanes, FUSED>(&self.forces, i);
            self.place::<K, FUSED>(start, i);
            sum = sum + self.positions[i];
        }
        sum
    }

    /// Evaluates forces and follows them once more in steps that hold back all others, before the next pass.
    ///
    /// Where a chain is taut, the pull of its links turns with the points; what that changes is small only beside the tension, and passes contract
    /// slowly there. Elsewhere points have come to rest: to go over a few of them again costs little.
    #[inline(always)]
    pub(super) fn settle<const K: usize, const FUSED: bool>(&mut self, scene: Scene<'_>) {
        let Scene { assembly, mass, instructions, start, .. } = scene;
        if let Some(steps) = self.sweeps.slowest(&self.lengths) {
            self.slowest = steps;
        }
        let steps = self.slowest.clone();
        let Some(touched) = self.sweeps.touched_by(&steps) else { return };
        let times = self.force_times::<K>(scene);
        for i in touched.clone() {
            self.positions[i] = self.positions[i].with(K - 1, start.q[i]);
            self.forces[i] = Lanes::splat(self.uniform_force[i]);
        }
        if assembly.traits.force_is_on_v {
            self.set_velocities::<K, FUSED>(start, touched.clone());
        }
        let Self { sweeps, positions, velocities, forces, multipliers, .. } = &mut *self;
        let elements = |family: usize| sweeps.families[family].acting.down_over(steps.clone());
        if !assembly.traits.has_uniform_force() {
            let velocities = assembly.traits.force_is_on_v.then_some(&velocities[..]);
            assembly.add_lane_force(instructions, elements, (times, positions, velocities), forces);
        }
        assembly.subtract_lane_pull(instructions, elements, (times, positions), multipliers, forces);
        for i in touched {
            // The others keep their accelerations: some of their forces act elsewhere.
            if self.sweeps.is_within(&steps, i) {
                self.accelerations[i] = mass.inverse_times_at::<Lanes, FUSED>(&self.forces, i);
            }
            self.place::<K, FUSED>(start, i);
        }
    }

    #[inline(always)]
    fn set_velocities<const K: usize, const FUSED: bool>(
        &mut self,
        start: &AssembledState,
        coordinates: Range<usize>,
    ) {
        for i in coordinates {
            let v = Lanes::splat(start.v[i]);
            self.velocities[i] = product::<K, FUSED>(&self.tables.velocities, self.accelerations[i], v);
        }
    }

    /// When forces act: at the nodes before the last, with the start of the step in the lane of its end.
    #[inline(always)]
    fn force_times<const K: usize>(&self, scene: Scene<'_>) -> Lanes {
        (self.tables.nodes + Lanes::splat(scene.start.t)).with(K - 1, scene.start.t)
    }

    /// Overwrites the multipliers with those of the predicted accelerations under the forces: `λⱼ = Sⱼ⁻¹ Gⱼ (M⁻¹ fⱼ − aⱼ)`.
    #[inline(always)]
    fn imply_multipliers<const K: usize, const FUSED: bool>(&mut self, scene: Scene<'_>) {
        let Scene { assembly, mass, pattern, instructions, .. } = scene;
        let times = self.force_times::<K>(scene);
        let Self { start_gram, positions, accelerations, forces, multipliers, slopes, .. } = self;
        // The values of the multipliers' place are not needed yet.
        assembly.lane_constraint_derivatives(instructions, times, positions, multipliers, slopes);
        pattern.symmetric::<Lanes, FUSED>(mass, slopes, start_gram);
        start_gram.factor_unchecked::<FUSED>(&pattern.elimination);
        multipliers.fill(Lanes::ZERO);
        for (slot, &slope) in assembly.slots.iter().zip(slopes.iter()) {
            let (row, col) = (slot.row as usize, slot.col as usize);
            let held = mass.inverse_times_at::<Lanes, FUSED>(forces, col) - accelerations[col];
            multipliers[row] = slope.times_plus::<FUSED>(held, multipliers[row]);
        }
        start_gram.solve::<FUSED>(&pattern.elimination, multipliers);
    }
}
