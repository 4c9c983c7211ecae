//! Kernels of a scene along a direction: the products of their derivatives with vectors that sensitivities are made of.

use crate::array::Array;
use crate::scalar::{Rate, Tangent};
use crate::system::{EntryValue, LagrangianGradient, MechanicalSystem};

/// `x + ε ẋ`.
#[inline]
pub(super) fn moving<S: MechanicalSystem>(
    x: &S::PerCoordinate<f64>,
    rate: &S::PerCoordinate<f64>,
) -> S::PerCoordinate<Tangent> {
    Array::from_fn(|i| Tangent::new(x[i], rate[i]))
}

/// `x`, with rates of zero.
#[inline]
pub(super) fn still<S: MechanicalSystem, R: Rate>(x: &S::PerCoordinate<f64>) -> S::PerCoordinate<Tangent<R>> {
    Array::from_fn(|i| Tangent::still(x[i]))
}

/// `∂L/∂q + f` and `∂L/∂v` on numbers with rates.
#[inline]
pub(super) fn forced_gradient<S: MechanicalSystem, R: Rate>(
    constants: &S::PerConstant<Tangent<R>>,
    t: Tangent<R>,
    q: &S::PerCoordinate<Tangent<R>>,
    v: &S::PerCoordinate<Tangent<R>>,
    inputs: &S::PerInput<Tangent<R>>,
) -> LagrangianGradient<S, Tangent<R>> {
    let mut gradient = S::lagrangian_gradient(constants, t, q, v);
    if S::STRUCTURE.forces.exist() {
        let force = S::forces(constants, t, q, v, inputs);
        for &i in S::STRUCTURE.forces.forced {
            gradient.force[i] = gradient.force[i] + force[i];
        }
    }
    gradient
}

/// The rates of the derivatives of the constraints: `Ġ`, and of `φ` and `∂φ/∂t`.
pub(super) struct ConstraintRates<'a, S: MechanicalSystem, R: Rate = f64> {
    constants: &'a S::PerConstant<Tangent<R>>,
    entries: S::PerJacobianEntry<Tangent<R>>,
    /// `φ̇`.
    pub(super) residual: S::PerConstraint<R>,
}

impl<'a, S: MechanicalSystem, R: Rate> ConstraintRates<'a, S, R> {
    #[inline]
    pub(super) fn new(
        constants: &'a S::PerConstant<Tangent<R>>,
        t: Tangent<R>,
        q: &S::PerCoordinate<Tangent<R>>,
    ) -> Self {
        let (residual, entries) = S::constraint_derivatives(constants, t, q);
        let residual = Array::from_fn(|c| residual[c].rate);
        Self { constants, entries, residual }
    }

    #[inline]
    fn rate(&self, value: EntryValue) -> R {
        match value {
            EntryValue::Constant(slot) => self.constants[slot].rate,
            EntryValue::Varying(index) => self.entries[index].rate,
        }
    }

    /// `xᵀ Ġ w`.
    #[inline]
    pub(super) fn form(&self, x: &S::PerConstraint<f64>, w: &S::PerCoordinate<f64>) -> R {
        let mut sum = R::ZERO;
        for entry in S::STRUCTURE.jacobian.q {
            sum = sum + self.rate(entry.value).times(x[entry.row] * w[entry.col]);
        }
        sum
    }

    /// `x · (∂φ/∂t)˙`.
    #[inline]
    pub(super) fn time_form(&self, x: &S::PerConstraint<f64>) -> R {
        let mut sum = R::ZERO;
        for entry in S::STRUCTURE.jacobian.t {
            sum = sum + self.rate(entry.value).times(x[entry.row]);
        }
        sum
    }
}

impl<S: MechanicalSystem> ConstraintRates<'_, S> {
    /// Adds `factor Ġᵀ x`.
    #[inline]
    pub(super) fn add_pull(&self, factor: f64, x: &S::PerConstraint<f64>, sum: &mut S::PerCoordinate<f64>) {
        for entry in S::STRUCTURE.jacobian.q {
            sum[entry.col] += factor * self.rate(entry.value) * x[entry.row];
        }
    }

    /// `Ġ v + (∂φ/∂t)˙`.
    #[inline]
    pub(super) fn velocity_rate(&self, v: &S::PerCoordinate<f64>) -> S::PerConstraint<f64> {
        let mut sum = S::PerConstraint::<f64>::from_fn(|_| 0.0);
        for entry in S::STRUCTURE.jacobian.t {
            sum[entry.row] += self.rate(entry.value);
        }
        for entry in S::STRUCTURE.jacobian.q {
            sum[entry.row] += self.rate(entry.value) * v[entry.col];
        }
        sum
    }
}
