//! Kernels of a scene along a direction: the products of their derivatives with vectors that sensitivities are made of.

use super::parameters::{Reach, Seeds};
use super::{StateGradient, StateTangent};
use crate::array::Array;
use crate::mechanics::{ForcePoint, Mechanics};
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

/// A point of a motion.
#[derive(Clone, Copy)]
pub(super) struct Point<'a, S: MechanicalSystem> {
    pub(super) t: f64,
    pub(super) q: &'a S::PerCoordinate<f64>,
    pub(super) v: &'a S::PerCoordinate<f64>,
    pub(super) inputs: &'a S::PerInput<f64>,
}

/// What belongs to `∂L/∂q + f`, or to the position, and what to `∂L/∂v`, or to the velocity.
pub(super) struct Along<S: MechanicalSystem> {
    pub(super) force: S::PerCoordinate<f64>,
    pub(super) momentum: S::PerCoordinate<f64>,
}

/// The rates of `∂L/∂q + f` and `∂L/∂v` where a point moves, and with it the constants and the inputs of a direction.
#[inline]
pub(super) fn along<S: MechanicalSystem>(
    tangent: &StateTangent<S>,
    point: &Point<'_, S>,
    q: &S::PerCoordinate<f64>,
    v: &S::PerCoordinate<f64>,
) -> Along<S> {
    let (q, v) = (moving::<S>(point.q, q), moving::<S>(point.v, v));
    let inputs = tangent.moving_inputs(point.inputs);
    let rates = forced_gradient::<S, f64>(&tangent.constants, Tangent::still(point.t), &q, &v, &inputs);
    Along {
        force: Array::from_fn(|i| rates.force[i].rate),
        momentum: Array::from_fn(|i| rates.momentum[i].rate),
    }
}

impl<S: MechanicalSystem> Point<'_, S> {
    /// How the number `a · (∂L/∂q + f) + b · ∂L/∂v` changes with the position and with the velocity. Second derivatives of `L` are symmetric, so that one
    /// evaluation of its gradient along `(a, b)` gives their part.
    #[inline]
    pub(super) fn product(
        &self,
        seeds: &Seeds<S>,
        mechanics: &Mechanics<S>,
        of_force: &S::PerCoordinate<f64>,
        of_momentum: &S::PerCoordinate<f64>,
    ) -> Along<S> {
        let Self { t, q, v, inputs } = *self;
        let (x, y) = (moving::<S>(q, of_force), moving::<S>(v, of_momentum));
        let rates = S::lagrangian_gradient(&seeds.still, Tangent::still(t), &x, &y);
        let mut force = S::PerCoordinate::<f64>::from_fn(|i| rates.force[i].rate);
        let mut momentum = S::PerCoordinate::<f64>::from_fn(|i| rates.momentum[i].rate);
        if S::STRUCTURE.forces.exist() {
            let mut unused = S::PerCoordinate::<f64>::from_fn(|_| 0.0);
            let derivatives =
                mechanics.add_force_with_derivatives(ForcePoint { t, q, v, inputs }, &mut unused);
            derivatives.for_each_by_q(|row, col, value| force[col] += of_force[row] * value);
            derivatives.for_each_by_v(|row, col, value| momentum[col] += of_force[row] * value);
        }
        Along { force, momentum }
    }

    /// Adds the derivatives of the same number by the parameters and the inputs.
    pub(super) fn add_parameters(
        &self,
        seeds: &Seeds<S>,
        of_force: &S::PerCoordinate<f64>,
        of_momentum: &S::PerCoordinate<f64>,
        gradient: &mut StateGradient<S>,
    ) {
        let Self { t, q, v, inputs } = *self;
        let follows = |reach: &Reach| reach.force || reach.momentum;
        seeds.add_parameter_rates(&mut gradient.parameters, follows, |constants| {
            let (q, v) = (still::<S, _>(q), still::<S, _>(v));
            let inputs = Array::from_fn(|k| Tangent::still(inputs[k]));
            let rates = forced_gradient::<S, _>(constants, Tangent::still(t), &q, &v, &inputs);
            (0..S::N_COORDINATES).fold(Rate::ZERO, |sum, i| {
                sum + rates.force[i].rate.times(of_force[i]) + rates.momentum[i].rate.times(of_momentum[i])
            })
        });
        if S::STRUCTURE.forces.on_inputs {
            seeds.add_input_rates(inputs, &mut gradient.inputs, |constants, inputs| {
                let (q, v) = (still::<S, _>(q), still::<S, _>(v));
                let force = S::forces(constants, Tangent::still(t), &q, &v, inputs);
                let forced = S::STRUCTURE.forces.forced.iter();
                forced.fold(Rate::ZERO, |sum, &i| sum + force[i].rate.times(of_force[i]))
            });
        }
    }
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
