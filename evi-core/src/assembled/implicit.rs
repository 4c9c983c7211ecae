//! Steps whose positions and multipliers are found together, for every scene.
//!
//! On straight curves `xⱼ = q₀ + cⱼ d`, `vⱼ = d / h` the equations of a step are
//!
//! ```text
//! Σ wⱼ (pⱼ − h (1 − cⱼ) Fⱼ) − p₀ + G₀ᵀ ℓ = 0        φ(t₁, q₀ + d) = 0        p⁻ = p₀ + h Σ wⱼ Fⱼ − G₀ᵀ ℓ
//! ```
//!
//! and on curves of a frequency, `xⱼ = g₁ q₀ + g₂ q₁` with the coefficients of [`NodeCoefficients`](crate::scheme::NodeCoefficients),
//!
//! ```text
//! Σ wⱼ (−h g₁' pⱼ − h g₁ Fⱼ) − p₀ + G₀ᵀ ℓ = 0        p⁻ = p₀ + Σ wⱼ (h (g₁ + g₂) Fⱼ + h (g₁' + g₂') pⱼ) − G₀ᵀ ℓ
//! ```
//!
//! with `pⱼ = ∂L/∂v` and `Fⱼ = ∂L/∂q + f` at the nodes (Marsden & West, Acta Numerica 10 (2001), sec. 3.5); the momentum at the end is no difference of
//! large ones.

use super::assembly::{Assembly, Point, subtract_pull};
use super::curves::Curves;
use super::elements::SecondWeights;
use super::history::History;
use super::kicked::add_scaled;
use super::nodes::{Node, Nodes};
use super::saddle::Saddle;
use super::scene::{PreparedScene, Space};
use super::{AssembledState, failure};
use crate::integrator::{IterationFailure, StepError, Tally};
use crate::linear::{SingularMatrix, largest_magnitude};
use crate::mechanics::relative;
use crate::memory::memory;
use crate::newton::Progress;
use crate::scheme::NodeCoefficients;

/// The matrix is made anew for a correction that is not below this share of the one before.
const STALE: f64 = 1e-3;

/// The step of one length.
pub(super) struct ImplicitStep {
    h: f64,
    nodes: Nodes,
    /// Where they are not straight.
    curves: Option<Curves>,
    /// The rests `d − h v₀`.
    sags: History,
}

impl ImplicitStep {
    pub(super) fn new(scene: &PreparedScene, nodes: &Nodes, curves: Option<Curves>, h: f64) -> Self {
        Self { h, nodes: nodes.clone(), curves, sags: History::none(scene.assembly.n_coordinates) }
    }

    /// Drops the past.
    pub(super) fn forget(&mut self) {
        self.sags.forget();
    }

    /// Takes the step.
    pub(super) fn advance(
        &mut self,
        scene: &mut PreparedScene,
        state: &mut AssembledState,
        tally: &mut impl Tally,
    ) -> Result<(), StepError> {
        let t_end = state.t + self.h;
        let PreparedScene { assembly, saddle, space, .. } = &mut *scene;
        let Some(saddle) = saddle else {
            return Err(failure::singular(state.t, SingularMatrix { pivot_ratio: f64::NAN }));
        };
        if !space.is_start_known {
            assembly.constraint_derivatives(state.t, &state.q, &mut space.at_start);
        }
        space.is_start_known = false;
        self.find_end(assembly, saddle, space, state, tally).map_err(|failure| {
            let residual = largest_magnitude(space.at_end.values.iter().copied());
            failure.at(state.t, residual, 1.0)
        })?;
        self.arrive(assembly, space, state);
        assembly.constraint_derivatives(t_end, &space.q, &mut space.at_end);
        scene.project(t_end, tally).map_err(|cause| StepError::Projection { t: t_end, cause })?;
        scene.reach(state, t_end)
    }

    /// Overwrites `space.moved` with the difference `d`, and `space.impulse`.
    fn find_end(
        &mut self,
        assembly: &Assembly,
        saddle: &mut Saddle,
        space: &mut Space,
        state: &AssembledState,
        tally: &mut impl Tally,
    ) -> Result<(), IterationFailure> {
        if self.sags.predict(&mut space.moved) {
            add_scaled(&mut space.moved, self.h, &state.v);
            if self.iterate(assembly, saddle, space, state, tally).is_ok() {
                self.remember(space, state);
                return Ok(());
            }
            tally.count_restart();
            self.sags.forget();
        }
        space.moved.iter_mut().zip(&state.v).for_each(|(moved, v)| *moved = self.h * v);
        self.iterate(assembly, saddle, space, state, tally)?;
        self.remember(space, state);
        Ok(())
    }

    fn remember(&mut self, space: &mut Space, state: &AssembledState) {
        space.pull.copy_from_slice(&space.moved);
        add_scaled(&mut space.pull, -self.h, &state.v);
        self.sags.remember(&space.pull);
    }

    /// Newton's iteration from the difference in `space.moved`.
    fn iterate(
        &self,
        assembly: &Assembly,
        saddle: &mut Saddle,
        space: &mut Space,
        state: &AssembledState,
        tally: &mut impl Tally,
    ) -> Result<(), IterationFailure> {
        let n = assembly.n_coordinates;
        let mut progress = Progress::default();
        let (mut last, mut before) = (0.0, 0.0);
        space.impulse.fill(0.0);
        tally.begin_iteration();
        loop {
            self.set_residual(assembly, space, state);
            // Written so that a NaN asks for a matrix, which refuses it.
            let is_fresh = last <= STALE * before && before > 0.0;
            if !is_fresh {
                let correction = progress.corrections() + 1;
                self.set_matrix(assembly, saddle, space, state);
                let pivot_ratio =
                    saddle.factor().map_err(|matrix| IterationFailure::Singular { correction, matrix })?;
                tally.see_pivot_ratio(pivot_ratio);
            }
            let Space { moved, impulse, unknowns, .. } = &mut *space;
            saddle.solve(unknowns);
            moved.iter_mut().zip(&unknowns[..n]).for_each(|(moved, correction)| *moved -= correction);
            impulse.iter_mut().zip(&unknowns[n..]).for_each(|(impulse, correction)| *impulse -= correction);
            let reach = state.q.iter().zip(moved.iter()).map(|(q, moved)| q.abs() + moved.abs());
            let length = largest_magnitude(unknowns[..n].iter().copied());
            (before, last) = (last, relative(length, largest_magnitude(reach)));
            tally.see_correction(|| last);
            if progress.has_converged(last)? {
                tally.count_corrections(progress.corrections());
                return Ok(());
            }
        }
    }

    /// Overwrites `space.q` with the end of the difference, and `space.unknowns` with the residual there.
    fn set_residual(&self, assembly: &Assembly, space: &mut Space, state: &AssembledState) {
        let n = assembly.n_coordinates;
        let Space { q, moved, pull, impulse, unknowns, at_start, at_end, .. } = &mut *space;
        for ((q, start), moved) in q.iter_mut().zip(&state.q).zip(moved.iter()) {
            *q = start + moved;
        }
        assembly.constraint_derivatives(state.t + self.h, q, at_end);
        unknowns[n..].copy_from_slice(&at_end.values);
        // The pull of the constraints at the start comes with the other sign.
        pull.copy_from_slice(&state.p);
        subtract_pull::<f64, false>(&assembly.slots, &at_start.slopes, impulse, pull);
        unknowns[..n].iter_mut().zip(pull.iter()).for_each(|(residual, p)| *residual = -p);
        self.for_each_node(assembly, space, state, |space, Node { time, weight }, curves| {
            let Space { unknowns, force, momentum, .. } = space;
            let Some(curves) = curves else {
                add_scaled(&mut unknowns[..n], weight, momentum);
                add_scaled(&mut unknowns[..n], -weight * self.h * (1.0 - time), force);
                return;
            };
            for (i, of) in curves.iter().enumerate() {
                unknowns[i] -= weight * (of.start_rate() * momentum[i] + self.h * of.start() * force[i]);
            }
        });
    }

    /// Overwrites the saddle-point matrix with the derivative of the residual.
    fn set_matrix(
        &self,
        assembly: &Assembly,
        saddle: &mut Saddle,
        space: &mut Space,
        state: &AssembledState,
    ) {
        let h = self.h;
        saddle.clear();
        for (index, &node) in self.nodes.iter().enumerate() {
            let Node { time: c, weight: w } = node;
            let curves = self.curves.as_ref().map(|curves| curves.at(index));
            // What curves multiply for themselves.
            let (before, behind) = if curves.is_some() { (1.0, 1.0) } else { (1.0 - c, c) };
            let weights = SecondWeights {
                vv: w / h,
                vq: w * behind,
                qv: -w * before,
                qq: -w * h * behind * before,
                fq: -w * h * behind * before,
                fv: -w * before,
                curves,
            };
            place(space, state, (c, curves), h);
            let at = Point { t: state.t + c * h, q: &space.pull, v: &space.v };
            saddle.add_second_derivatives(assembly, at, &weights);
        }
        saddle.set_constraints(&space.at_start, &space.at_end);
    }

    /// Overwrites `space.p` with the momentum that arrives at the end, and `space.v` with a guess of its velocity.
    fn arrive(&self, assembly: &Assembly, space: &mut Space, state: &AssembledState) {
        for ((q, start), moved) in space.q.iter_mut().zip(&state.q).zip(&space.moved) {
            *q = start + moved;
        }
        space.p.copy_from_slice(&state.p);
        self.for_each_node(assembly, space, state, |space, Node { weight, .. }, curves| {
            let Space { p, force, momentum, .. } = space;
            let Some(curves) = curves else {
                add_scaled(p, self.h * weight, force);
                return;
            };
            for (i, of) in curves.iter().enumerate() {
                p[i] += weight * (self.h * of.even * force[i] + of.even_rate * momentum[i]);
            }
        });
        subtract_pull::<f64, false>(&assembly.slots, &space.at_start.slopes, &space.impulse, &mut space.p);
    }

    /// Calls `visit(space, node, curves)` at every node with the gradient there in `space.force` and `space.momentum`.
    fn for_each_node(
        &self,
        assembly: &Assembly,
        space: &mut Space,
        state: &AssembledState,
        mut visit: impl FnMut(&mut Space, Node, Option<&[NodeCoefficients]>),
    ) {
        for (index, &node) in self.nodes.iter().enumerate() {
            let curves = self.curves.as_ref().map(|curves| curves.at(index));
            place(space, state, (node.time, curves), self.h);
            let at = Point { t: state.t + node.time * self.h, q: &space.pull, v: &space.v };
            assembly.gradient(at, &mut space.force, &mut space.momentum);
            visit(space, node, curves);
        }
    }
}

memory!([] ImplicitStep, |words| Self { h, nodes, curves, sags } => {
    words.fixed(*h);
    nodes.for_each_number(|number| words.fixed(number));
    if let Some(curves) = curves {
        curves.for_each_number(|number| words.fixed(number));
    }
    words.part(sags);
});

/// Overwrites `space.pull` and `space.v` with the position and velocity at `c` on the way `space.moved`.
fn place(space: &mut Space, state: &AssembledState, (c, curves): (f64, Option<&[NodeCoefficients]>), h: f64) {
    let inverse_h = 1.0 / h;
    if let Some(curves) = curves {
        for (i, of) in curves.iter().enumerate() {
            let (moved, middle) = (space.moved[i], state.q[i] + 0.5 * space.moved[i]);
            space.pull[i] = of.even * middle + of.odd * moved;
            space.v[i] = inverse_h * (of.even_rate * middle + of.odd_rate * moved);
        }
        return;
    }
    for (i, moved) in space.moved.iter().enumerate() {
        space.pull[i] = state.q[i] + c * moved;
        space.v[i] = inverse_h * moved;
    }
}
