//! The equations of the continuous motion as equations for accelerations and multipliers, with their exact derivatives.
//!
//! ```text
//! r(t, q, v, a) = d/dt ∂L/∂v − ∂L/∂q − f = M a + (∂²L/∂v∂q) v + ∂²L/∂v∂t − ∂L/∂q − f        r + Gᵀ λ = 0
//! ```
//!
//! With `D` for the derivative along the motion, in the direction `(ṫ, q̇, v̇) = (1, v, a)`, the derivatives of `r` are
//!
//! ```text
//! ∂r/∂a = M        ∂r/∂v = D M + L_vq − L_qv − ∂f/∂v        ∂r/∂q = D L_vq − L_qq − ∂f/∂q
//! ```
//!
//! since `r = D ∂L/∂v − ∂L/∂q − f`: one evaluation of the second derivatives of `L` on [`Tangent`]s gives all of them, third
//! derivatives of `L` included. Where `M` and `L_vq` are constant, `D` of them vanishes and plain numbers do.

use crate::array::Array;
use crate::linear::Kkt;
use crate::mechanics::{ForcePoint, Mechanics};
use crate::scalar::Tangent;
use crate::system::{Entry, LagrangianGradient, MechanicalSystem};

/// The equations of motion of a scene.
pub(super) struct EquationsOfMotion<S: MechanicalSystem> {
    pub(super) mechanics: Mechanics<S>,
    /// The constants, which do not move.
    constants: S::PerConstant<Tangent>,
}

/// Where the equations are evaluated.
pub(super) struct MotionPoint<'a, S: MechanicalSystem> {
    pub(super) t: f64,
    pub(super) q: S::PerCoordinate<f64>,
    pub(super) v: S::PerCoordinate<f64>,
    pub(super) acceleration: &'a S::PerCoordinate<f64>,
    pub(super) inputs: &'a S::PerInput<f64>,
}

/// How `q` and `v` change with the accelerations that are solved for.
#[derive(Clone, Copy)]
pub(super) struct PerAcceleration {
    pub(super) q: f64,
    pub(super) v: f64,
}

impl<S: MechanicalSystem> EquationsOfMotion<S> {
    /// Whether `M` or `L_vq` moves.
    const HAS_RATES: bool = !(S::STRUCTURE.blocks.vv.is_constant() && S::STRUCTURE.blocks.vq.is_constant());

    pub(super) fn new(mechanics: Mechanics<S>) -> Self {
        let constants = Array::from_fn(|k| Tangent::new(mechanics.constants[k], 0.0));
        Self { mechanics, constants }
    }

    /// The residual `r` and, as the block `A` of a saddle-point matrix, its derivative by accelerations with which `q` and `v` change:
    /// `M + per.v ∂r/∂v + per.q ∂r/∂q`.
    #[inline]
    pub(super) fn linearize(
        &self,
        at: &MotionPoint<'_, S>,
        per: PerAcceleration,
    ) -> (S::PerCoordinate<f64>, Kkt<S>) {
        let mut kkt = Kkt::zero();
        let mut residual =
            if Self::HAS_RATES { self.moving(at, per, &mut kkt) } else { self.constant(at, per, &mut kkt) };
        if S::STRUCTURE.forces.exist() {
            self.subtract_forces(at, per, &mut residual, &mut kkt);
        }
        (residual, kkt)
    }

    /// `r` but for `f`, where `M` or `L_vq` moves.
    fn moving(
        &self,
        at: &MotionPoint<'_, S>,
        per: PerAcceleration,
        kkt: &mut Kkt<S>,
    ) -> S::PerCoordinate<f64> {
        let (t, q) = (Tangent::new(at.t, 1.0), Array::from_fn(|i| Tangent::new(at.q[i], at.v[i])));
        let v = Array::from_fn(|i| Tangent::new(at.v[i], at.acceleration[i]));
        let (LagrangianGradient { force, momentum }, hessian) =
            S::lagrangian_derivatives(&self.constants, t, &q, &v);
        let value = |entry: &Entry| entry.value(self.constants.as_ref(), hessian.as_ref());
        for entry in S::STRUCTURE.hessian.vv {
            let Tangent { value, rate } = value(entry);
            add_symmetric(kkt, entry.row, entry.col, value + per.v * rate);
        }
        for entry in S::STRUCTURE.hessian.vq {
            let Tangent { value, rate } = value(entry);
            kkt.add_block(entry.row, entry.col, per.v * value + per.q * rate);
            kkt.add_block(entry.col, entry.row, -per.v * value);
        }
        for entry in S::STRUCTURE.hessian.qq {
            add_symmetric(kkt, entry.row, entry.col, -per.q * value(entry).value);
        }
        Array::from_fn(|i| momentum[i].rate - force[i].value)
    }

    /// `r` but for `f`, where `M` and `L_vq` are constant.
    fn constant(
        &self,
        at: &MotionPoint<'_, S>,
        per: PerAcceleration,
        kkt: &mut Kkt<S>,
    ) -> S::PerCoordinate<f64> {
        let constants = &self.mechanics.constants;
        let (LagrangianGradient { force, .. }, hessian) =
            S::lagrangian_derivatives(constants, at.t, &at.q, &at.v);
        let value = |entry: &Entry| entry.value(constants.as_ref(), hessian.as_ref());
        let mut residual = S::PerCoordinate::<f64>::from_fn(|i| -force[i]);
        for entry in S::STRUCTURE.hessian.vv {
            let mass = value(entry);
            add_symmetric(kkt, entry.row, entry.col, mass);
            residual[entry.row] += mass * at.acceleration[entry.col];
            if entry.row != entry.col {
                residual[entry.col] += mass * at.acceleration[entry.row];
            }
        }
        for entry in S::STRUCTURE.hessian.vq {
            let coupling = value(entry);
            kkt.add_block(entry.row, entry.col, per.v * coupling);
            kkt.add_block(entry.col, entry.row, -per.v * coupling);
            residual[entry.row] += coupling * at.v[entry.col];
        }
        for entry in S::STRUCTURE.hessian.vt {
            residual[entry.row] += value(entry);
        }
        for entry in S::STRUCTURE.hessian.qq {
            add_symmetric(kkt, entry.row, entry.col, -per.q * value(entry));
        }
        residual
    }

    fn subtract_forces(
        &self,
        at: &MotionPoint<'_, S>,
        per: PerAcceleration,
        residual: &mut S::PerCoordinate<f64>,
        kkt: &mut Kkt<S>,
    ) {
        let mut force = Array::from_fn(|_| 0.0);
        let point = ForcePoint { t: at.t, q: &at.q, v: &at.v, inputs: at.inputs };
        let derivatives = self.mechanics.add_force_with_derivatives(point, &mut force);
        for &i in S::STRUCTURE.forces.forced {
            residual[i] -= force[i];
        }
        derivatives.for_each_by_q(|row, col, value| kkt.add_block(row, col, -per.q * value));
        derivatives.for_each_by_v(|row, col, value| kkt.add_block(row, col, -per.v * value));
    }

    /// The varying entries of `G` with those of `D G`, its derivative along the motion.
    #[inline]
    pub(super) fn moving_jacobian(&self, at: &MotionPoint<'_, S>) -> S::PerJacobianEntry<Tangent> {
        let (t, q) = (Tangent::new(at.t, 1.0), Array::from_fn(|i| Tangent::new(at.q[i], at.v[i])));
        S::constraint_derivatives(&self.constants, t, &q).1
    }
}

fn add_symmetric<S: MechanicalSystem>(kkt: &mut Kkt<S>, row: usize, col: usize, value: f64) {
    kkt.add_block(row, col, value);
    if row != col {
        kkt.add_block(col, row, value);
    }
}
