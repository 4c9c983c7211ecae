//! Steps whose multipliers are found alone: a kick, a drift and a kick, where the mass is constant and no force depends on where a step ends before it
//! has been found.
//!
//! ```text
//! q₁ = q₀ + h M⁻¹ (p₀ + k₀ − G₀ᵀ ℓ)        φ(t₁, q₁) = 0        p⁻ = p₀ + k₀ + k₁ − G₀ᵀ ℓ
//! ```
//!
//! On straight curves the kicks are `k₀ = h Σ wⱼ (1 − cⱼ) Fⱼ` and `k₁ = h Σ wⱼ cⱼ Fⱼ` with forces `F` that are uniform, or depend on time, or are those
//! at the ends of a step (the trapezoidal rule).

use super::assembly::{Assembly, Point, Traits, subtract_pull};
use super::gram::Gram;
use super::history::History;
use super::mass::ConstantMass;
use super::nodes::Nodes;
use super::scene::{ConstantInertia, PreparedScene, Space};
use super::{AssembledState, failure};
use crate::integrator::{IterationFailure, StepError, Tally};
use crate::linear::{SingularMatrix, largest_magnitude};
use crate::mechanics::Length;
use crate::memory::memory;
use crate::newton::Progress;

/// The matrix is made anew for a residual that is not below this share of the one before: Newton's corrections shrink residuals more, and
/// those with an old matrix not much less where it is still good.
const STALE: f64 = 1e-3;

/// Where the forces of a step act.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kicks {
    /// Everywhere alike.
    Uniform,
    /// At the nodes, wherever the bodies are.
    InTime,
    /// At the start and at the end of the step.
    AtEnds,
}

/// The step of one length.
pub(super) struct KickedStep {
    h: f64,
    nodes: Nodes,
    kicks: Kicks,
    impulses: History,
}

impl KickedStep {
    /// `None` if the scene's steps on these nodes are not of this kind.
    pub(super) fn new(scene: &PreparedScene, nodes: &Nodes, h: f64) -> Option<Self> {
        let traits: &Traits = &scene.assembly.traits;
        scene.inertia.as_ref()?;
        let kicks = match (traits.force_is_on_q, traits.force_is_on_t) {
            _ if traits.force_is_on_v => return None,
            (false, false) => Kicks::Uniform,
            (false, true) => Kicks::InTime,
            (true, _) if nodes.are_the_ends() => Kicks::AtEnds,
            (true, _) => return None,
        };
        let impulses = History::none(scene.assembly.n_constraints);
        Some(Self { h, nodes: nodes.clone(), kicks, impulses })
    }

    /// Drops the past.
    pub(super) fn forget(&mut self) {
        self.impulses.forget();
    }

    /// Takes the step.
    pub(super) fn advance(
        &mut self,
        scene: &mut PreparedScene,
        state: &mut AssembledState,
        tally: &mut impl Tally,
    ) -> Result<(), StepError> {
        let t_end = state.t + self.h;
        let PreparedScene { assembly, inertia, space, .. } = &mut *scene;
        let Some(ConstantInertia { mass, gram }) = inertia else {
            return Err(failure::singular(state.t, SingularMatrix { pivot_ratio: f64::NAN }));
        };
        self.begin(assembly, space, state);
        space.is_start_known = false;
        self.find_end(assembly, (mass, gram), space, state, tally).map_err(|failure| {
            let residual = largest_magnitude(space.at_end.values.iter().copied());
            failure.at(state.t, residual, 1.0)
        })?;
        // What the iteration has moved last is not in the constraints yet.
        assembly.constraint_derivatives(t_end, &space.q, &mut space.at_end);
        self.kick_at_end(assembly, space, t_end);
        let Space { p, impulse, at_start, force, .. } = space;
        // With forces that act at the start and the end of a step, what both sum up to.
        for ((p, start), kick) in p.iter_mut().zip(&state.p).zip(force.iter()) {
            *p = start + kick;
        }
        subtract_pull::<f64, false>(&assembly.slots, &at_start.slopes, impulse, p);
        scene.project(t_end, tally).map_err(|cause| StepError::Projection { t: t_end, cause })?;
        // The projection overwrites the impulse: the history has been told before.
        scene.reach(state, t_end)
    }

    /// Overwrites `space.force` with the kick `k₀`, and what is to be known at the start.
    fn begin(&self, assembly: &Assembly, space: &mut Space, state: &AssembledState) {
        let at = Point { t: state.t, q: &state.q, v: &state.v };
        if !space.is_start_known {
            assembly.constraint_derivatives(state.t, &state.q, &mut space.at_start);
            if self.kicks != Kicks::InTime {
                assembly.force(at, &mut space.force_at_start);
                // A uniform force is evaluated never again.
                space.force_at_end.copy_from_slice(&space.force_at_start);
            }
        }
        match self.kicks {
            Kicks::Uniform | Kicks::AtEnds => {
                let weight = self.h * self.nodes.start_weight();
                set_scaled(&mut space.force, weight, &space.force_at_start);
            }
            Kicks::InTime => {
                space.force.fill(0.0);
                self.add_in_time(assembly, space, at, |c| 1.0 - c);
            }
        }
    }

    /// Adds the kick `k₁` to `space.force`, which holds `k₀`.
    fn kick_at_end(&self, assembly: &Assembly, space: &mut Space, t_end: f64) {
        let weight = self.h * self.nodes.end_weight();
        match self.kicks {
            Kicks::Uniform => add_scaled(&mut space.force, weight, &space.force_at_start),
            Kicks::AtEnds => {
                // Without velocities.
                let at = Point { t: t_end, q: &space.q, v: &space.v };
                assembly.force(at, &mut space.force_at_end);
                add_scaled(&mut space.force, weight, &space.force_at_end);
            }
            Kicks::InTime => {
                let q = std::mem::take(&mut space.q);
                let v = std::mem::take(&mut space.v);
                let at = Point { t: t_end - self.h, q: &q, v: &v };
                self.add_in_time(assembly, space, at, |c| c);
                (space.q, space.v) = (q, v);
            }
        }
    }

    /// Adds `h Σ wⱼ g(cⱼ) F(t + cⱼ h)` to `space.force`.
    fn add_in_time(&self, assembly: &Assembly, space: &mut Space, at: Point<'_>, g: impl Fn(f64) -> f64) {
        for node in self.nodes.iter() {
            assembly.force(Point { t: at.t + node.time * self.h, ..at }, &mut space.pull);
            add_scaled(&mut space.force, self.h * node.weight * g(node.time), &space.pull);
        }
    }

    /// Overwrites `space.q` and `space.impulse`: from the impulse that the last steps let expect, or if that leads nowhere from none.
    fn find_end(
        &mut self,
        assembly: &Assembly,
        (mass, gram): (&ConstantMass, &mut Gram),
        space: &mut Space,
        state: &AssembledState,
        tally: &mut impl Tally,
    ) -> Result<(), IterationFailure> {
        space.p.copy_from_slice(&state.p);
        mass.subtract_rest(&mut space.p);
        space.p.iter_mut().zip(&space.force).for_each(|(p, kick)| *p += kick);
        if self.impulses.predict(&mut space.impulse) {
            let found = self.iterate(assembly, (mass, gram), space, state, tally);
            if found.is_ok() {
                self.impulses.remember(&space.impulse);
                return Ok(());
            }
            tally.count_restart();
            self.impulses.forget();
        }
        space.impulse.fill(0.0);
        self.iterate(assembly, (mass, gram), space, state, tally)?;
        self.impulses.remember(&space.impulse);
        Ok(())
    }

    /// Newton's iteration for the impulse, from the one in `space.impulse` and the kicked momentum in `space.p`.
    fn iterate(
        &self,
        assembly: &Assembly,
        (mass, gram): (&ConstantMass, &mut Gram),
        space: &mut Space,
        state: &AssembledState,
        tally: &mut impl Tally,
    ) -> Result<(), IterationFailure> {
        let (h, t_end) = (self.h, state.t + self.h);
        let Space { q, p, pull, moved, impulse, rates, at_start, at_end, .. } = space;
        pull.copy_from_slice(p);
        subtract_pull::<f64, false>(&assembly.slots, &at_start.slopes, impulse, pull);
        mass.inverse_times(pull, moved);
        let mut reach = Length::default();
        for (i, q) in q.iter_mut().enumerate() {
            let difference = h * moved[i];
            *q = state.q[i] + difference;
            reach = reach.with(mass.units[i], state.q[i].abs() + difference.abs());
        }
        if assembly.n_constraints == 0 {
            return Ok(());
        }
        tally.begin_iteration();
        let (per_reach, least_unit) =
            if reach.metric > 0.0 { (1.0 / reach.metric, reach.least_unit()) } else { (0.0, 0.0) };
        let mut progress = Progress::default();
        let mut previous = 0.0;
        loop {
            assembly.constraint_derivatives(t_end, q, at_end);
            let residual = largest_magnitude(at_end.values.iter().copied());
            // Written so that a NaN asks for a matrix, which refuses it.
            let is_fresh = residual <= STALE * previous;
            if residual != 0.0 && !is_fresh {
                let correction = progress.corrections() + 1;
                let pivot_ratio = gram
                    .factor_between(mass, &at_end.slopes, &at_start.slopes)
                    .map_err(|matrix| IterationFailure::Singular { correction, matrix })?;
                tally.see_pivot_ratio(pivot_ratio);
            }
            previous = residual;
            rates.copy_from_slice(&at_end.values);
            gram.solve_between(rates);
            pull.fill(0.0);
            subtract_pull::<f64, false>(&assembly.slots, &at_start.slopes, rates, pull);
            mass.inverse_times(pull, moved);
            let inverse_h = 1.0 / h;
            impulse.iter_mut().zip(rates.iter()).for_each(|(impulse, rate)| *impulse += inverse_h * rate);
            let mut length = 0.0_f64;
            for ((q, moved), unit) in q.iter_mut().zip(moved.iter()).zip(&mass.units) {
                *q += moved;
                let moved = unit.max(least_unit) * moved.abs();
                // Written so that a NaN stays.
                length = if moved <= length { length } else { moved };
            }
            tally.see_correction(|| length * per_reach);
            if progress.has_converged(length * per_reach)? {
                tally.count_corrections(progress.corrections());
                return Ok(());
            }
        }
    }
}

// How forces act follows from the scene and the nodes.
memory!([] KickedStep, |words| Self { h, nodes, kicks: _, impulses } => {
    words.fixed(*h);
    nodes.for_each_number(|number| words.fixed(number));
    words.part(impulses);
});

fn set_scaled(sum: &mut [f64], factor: f64, terms: &[f64]) {
    sum.iter_mut().zip(terms).for_each(|(sum, term)| *sum = factor * term);
}

/// Adds `factor · terms` to `sum`.
pub(super) fn add_scaled(sum: &mut [f64], factor: f64, terms: &[f64]) {
    sum.iter_mut().zip(terms).for_each(|(sum, term)| *sum += factor * term);
}
