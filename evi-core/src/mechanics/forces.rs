//! Forces that are no derivatives of `L`, at one point of a motion.
//!
//! In: `(t, q, v, u)`. Out: the force, added to `∂L/∂q`, and its derivatives, entry by entry of their pattern. A quadrature
//! that sums `wⱼ h gⱼ ∂L/∂q` over the nodes of a curve then sums `wⱼ h gⱼ (∂L/∂q + f)`: that is the discrete
//! Lagrange-d'Alembert principle, whose discrete forces are
//!
//! ```text
//! f⁻ = h Σⱼ wⱼ g₁ f(tⱼ, xⱼ, vⱼ)        f⁺ = h Σⱼ wⱼ g₂ f(tⱼ, xⱼ, vⱼ)
//! ```
//!
//! (Marsden & West, Acta Numerica 10 (2001), sec. 3.2; Kane, Marsden, Ortiz, West, Int. J. Numer. Meth. Eng. 49 (2000) 1295),
//! of the order of the rule, with momenta that change by the discrete impulse to round-off. Nothing of this is in the step
//! of a scene without forces.

use super::Mechanics;
use crate::system::MechanicalSystem;

/// Where a force acts: time, position, velocity, and the inputs of the step.
#[derive(Clone, Copy)]
pub(crate) struct ForcePoint<'a, S: MechanicalSystem> {
    pub(crate) t: f64,
    pub(crate) q: &'a S::PerCoordinate<f64>,
    pub(crate) v: &'a S::PerCoordinate<f64>,
    pub(crate) inputs: &'a S::PerInput<f64>,
}

/// The derivatives of the force at one point.
pub(crate) struct ForceDerivatives<'a, S: MechanicalSystem> {
    constants: &'a S::PerConstant<f64>,
    entries: S::PerForceEntry<f64>,
}

impl<S: MechanicalSystem> Mechanics<S> {
    /// Adds `f` to `force`, which holds `∂L/∂q`.
    #[inline]
    pub(crate) fn add_force(&self, at: ForcePoint<'_, S>, force: &mut S::PerCoordinate<f64>) {
        if S::STRUCTURE.forces.exist() {
            let added = S::forces(&self.constants, at.t, at.q, at.v, at.inputs);
            for &i in S::STRUCTURE.forces.forced {
                force[i] += added[i];
            }
        }
    }

    /// Adds `f` to `force`, which holds `∂L/∂q`, and returns its derivatives.
    #[inline]
    pub(crate) fn add_force_with_derivatives(
        &self,
        at: ForcePoint<'_, S>,
        force: &mut S::PerCoordinate<f64>,
    ) -> ForceDerivatives<'_, S> {
        let (added, entries) = S::force_derivatives(&self.constants, at.t, at.q, at.v, at.inputs);
        for &i in S::STRUCTURE.forces.forced {
            force[i] += added[i];
        }
        ForceDerivatives { constants: &self.constants, entries }
    }
}

impl<S: MechanicalSystem> ForceDerivatives<'_, S> {
    /// Calls `visit(row, col, ∂f_row/∂q_col)`.
    #[inline]
    pub(crate) fn for_each_by_q(&self, mut visit: impl FnMut(usize, usize, f64)) {
        for entry in S::STRUCTURE.forces.q {
            visit(entry.row, entry.col, entry.number(self.constants.as_ref(), self.entries.as_ref()));
        }
    }

    /// Calls `visit(row, col, ∂f_row/∂v_col)`.
    #[inline]
    pub(crate) fn for_each_by_v(&self, mut visit: impl FnMut(usize, usize, f64)) {
        for entry in S::STRUCTURE.forces.v {
            visit(entry.row, entry.col, entry.number(self.constants.as_ref(), self.entries.as_ref()));
        }
    }
}
