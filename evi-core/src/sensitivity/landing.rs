//! The end of a step, where the momentum is projected on the constraints, and its derivatives.
//!
//! ```text
//! ∂L/∂v(q₁, v₁) + G₁ᵀ N = p⁻        G₁ v₁ + ∂φ/∂t = 0        p₁ = ∂L/∂v(q₁, v₁)
//! ```
//!
//! gives `(v₁, N, p₁)` as functions of `(q₁, p⁻)` and of the parameters. Both directions solve with one symmetric matrix, `[M Gᵀ; G 0]`.

use super::evaluation::{ConstraintRates, moving, still};
use super::parameters::{MovingConstants, Reach, Seeds};
use super::{DerivativeError, StateGradient};
use crate::array::Array;
use crate::linear::{FactoredKkt, Factorization, Kkt, constraint_index, unknowns};
use crate::mechanics::{ConstantLegendre, Mechanics, State};
use crate::scalar::{Rate, Tangent};
use crate::system::{Entry, MechanicalSystem};

/// A state with what solves `[M Gᵀ; G 0] (x, y) = (a, b)` there.
pub(super) struct Landing<'a, S: MechanicalSystem> {
    state: &'a State<S>,
    /// Entries of the Hessian that vary, where the mass matrix is not constant.
    mass: Option<S::PerHessianEntry<f64>>,
    /// Entries of `G` that vary.
    jacobian: S::PerJacobianEntry<f64>,
    solver: Solver<'a, S>,
    mechanics: &'a Mechanics<S>,
}

enum Solver<'a, S: MechanicalSystem> {
    Kkt(FactoredKkt<S>),
    /// By `G M⁻¹ Gᵀ`, as the steps of a constant mass do it.
    Gram {
        legendre: &'a ConstantLegendre<S>,
        factors: S::GramFactors,
    },
}

/// The changes of velocity and momentum.
pub(super) struct Moved<S: MechanicalSystem> {
    pub(super) v: S::PerCoordinate<f64>,
    pub(super) p: S::PerCoordinate<f64>,
}

impl<'a, S: MechanicalSystem> Landing<'a, S> {
    /// Whether the momentum depends on the configuration at a fixed velocity.
    const MOMENTUM_MOVES: bool = !S::STRUCTURE.hessian.vq.is_empty();

    pub(super) fn new(
        mechanics: &'a Mechanics<S>,
        legendre: Option<&'a ConstantLegendre<S>>,
        state: &'a State<S>,
    ) -> Result<Self, DerivativeError> {
        let constants = &mechanics.constants;
        let singular = |matrix| DerivativeError::Singular { t: state.t, matrix };
        let (_, jacobian) = S::constraint_derivatives(constants, state.t, &state.q);
        if ConstantLegendre::<S>::EXISTS
            && let Some(legendre) = legendre
        {
            let factors = legendre.factor_gram(mechanics, &jacobian, &mut ()).map_err(singular)?;
            let solver = Solver::Gram { legendre, factors };
            return Ok(Self { state, mass: None, jacobian, solver, mechanics });
        }
        let (_, mass) = S::lagrangian_derivatives(constants, state.t, &state.q, &state.v);
        let kkt: Kkt<S> = mechanics.mass_kkt(&mass, &jacobian);
        let solver = Solver::Kkt(kkt.factor().map_err(singular)?);
        Ok(Self { state, mass: Some(mass), jacobian, solver, mechanics })
    }

    /// Entries of `G` that vary.
    pub(super) const fn jacobian(&self) -> &S::PerJacobianEntry<f64> {
        &self.jacobian
    }

    /// `N`: the impulse that took `p⁻` to the momentum of the state.
    pub(super) fn removed(&self, arriving: &S::PerCoordinate<f64>) -> S::PerConstraint<f64> {
        self.impulse(&Array::from_fn(|i| arriving[i] - self.state.p[i]))
    }

    /// The impulse `x` with `Gᵀ x = momentum`, which exists.
    pub(super) fn impulse(&self, momentum: &S::PerCoordinate<f64>) -> S::PerConstraint<f64> {
        if S::N_CONSTRAINTS == 0 {
            return Array::from_fn(|_| 0.0);
        }
        self.split(|i| momentum[i], |_| 0.0).1
    }

    /// The solution of `[M Gᵀ; G 0] (x, y) = (a, b)`.
    #[inline]
    fn split(
        &self,
        mut a: impl FnMut(usize) -> f64,
        mut b: impl FnMut(usize) -> f64,
    ) -> (S::PerCoordinate<f64>, S::PerConstraint<f64>) {
        match &self.solver {
            Solver::Kkt(factors) => {
                let mut solution = unknowns::<S>(a, b);
                factors.solve(&mut solution);
                let y = Array::from_fn(|c| solution[constraint_index::<S>(c)]);
                (Array::from_fn(|i| solution[i]), y)
            }
            Solver::Gram { legendre, factors } => {
                let mut momentum = S::PerCoordinate::<f64>::from_fn(&mut a);
                if S::N_CONSTRAINTS == 0 {
                    return (legendre.inverse_mass().times(|i| momentum[i]), Array::from_fn(b));
                }
                let free = legendre.inverse_mass().times(|i| momentum[i]);
                let mut y = S::PerConstraint::<f64>::from_fn(|c| -b(c));
                for entry in S::STRUCTURE.jacobian.q {
                    y[entry.row] += self.slope(entry) * free[entry.col];
                }
                factors.solve(&mut y);
                self.subtract_pull(&y, &mut momentum);
                (legendre.inverse_mass().times(|i| momentum[i]), y)
            }
        }
    }

    #[inline]
    fn slope(&self, entry: &Entry) -> f64 {
        entry.value(self.mechanics.constants.as_ref(), self.jacobian.as_ref())
    }

    /// Adds `M x`.
    fn add_inertia(&self, x: &S::PerCoordinate<f64>, sum: &mut S::PerCoordinate<f64>) {
        let varying = self.mass.as_ref().map_or(&[][..], AsRef::as_ref);
        for entry in S::STRUCTURE.hessian.vv {
            let value = entry.value(self.mechanics.constants.as_ref(), varying);
            sum[entry.row] += value * x[entry.col];
            if entry.row != entry.col {
                sum[entry.col] += value * x[entry.row];
            }
        }
    }

    /// The rate of `∂L/∂v` at a fixed velocity.
    fn momentum_rate(
        &self,
        constants: &MovingConstants<S>,
        parameters_move: bool,
        q: &S::PerCoordinate<f64>,
    ) -> S::PerCoordinate<f64> {
        if !(Self::MOMENTUM_MOVES || parameters_move) {
            return Array::from_fn(|_| 0.0);
        }
        let (q, v) = (moving::<S>(&self.state.q, q), still::<S, f64>(&self.state.v));
        let momentum = S::lagrangian_gradient(constants, Tangent::still(self.state.t), &q, &v).momentum;
        Array::from_fn(|i| momentum[i].rate)
    }

    fn constraint_rates<'c>(
        &self,
        constants: &'c MovingConstants<S>,
        time_rate: f64,
        q: &S::PerCoordinate<f64>,
    ) -> ConstraintRates<'c, S> {
        ConstraintRates::new(constants, Tangent::new(self.state.t, time_rate), &moving::<S>(&self.state.q, q))
    }

    /// How velocity and momentum follow changes of the configuration, of the constants, and of the momentum `p⁻`, of which `impulse` was removed.
    pub(super) fn forward(
        &self,
        (constants, parameters_move): (&MovingConstants<S>, bool),
        impulse: &S::PerConstraint<f64>,
        q: &S::PerCoordinate<f64>,
        arriving: &S::PerCoordinate<f64>,
    ) -> Moved<S> {
        let mut p = self.momentum_rate(constants, parameters_move, q);
        let mut rows = S::PerCoordinate::<f64>::from_fn(|i| arriving[i] - p[i]);
        let mut leaving = S::PerConstraint::<f64>::from_fn(|_| 0.0);
        if S::N_CONSTRAINTS > 0 {
            let rates = self.constraint_rates(constants, 0.0, q);
            rates.add_pull(-1.0, impulse, &mut rows);
            leaving = rates.velocity_rate(&self.state.v);
        }
        let (v, _) = self.split(|i| rows[i], |c| -leaving[c]);
        self.add_inertia(&v, &mut p);
        Moved { v, p }
    }

    /// The vector tangent to the constraints nearest to `(q, v)` in the metric of the mass, and its momentum: the derivative of a start that is
    /// projected on the constraints.
    pub(super) fn start(
        &self,
        (constants, parameters_move): (&MovingConstants<S>, bool),
        q: &mut S::PerCoordinate<f64>,
        v: &S::PerCoordinate<f64>,
    ) -> Moved<S> {
        let mut leaving = S::PerConstraint::<f64>::from_fn(|_| 0.0);
        if S::N_CONSTRAINTS > 0 {
            let residual = self.constraint_rates(constants, 0.0, q).residual;
            let (back, _) = self.split(|_| 0.0, |c| -residual[c]);
            for i in 0..S::N_COORDINATES {
                q[i] += back[i];
            }
            leaving = self.constraint_rates(constants, 0.0, q).velocity_rate(&self.state.v);
            for entry in S::STRUCTURE.jacobian.q {
                leaving[entry.row] += self.slope(entry) * v[entry.col];
            }
        }
        let (back, _) = self.split(|_| 0.0, |c| -leaving[c]);
        let v = S::PerCoordinate::<f64>::from_fn(|i| v[i] + back[i]);
        let mut p = self.momentum_rate(constants, parameters_move, q);
        self.add_inertia(&v, &mut p);
        Moved { v, p }
    }

    /// Goes back over [`forward`](Self::forward): adds to the derivatives by the configuration and the parameters in `at_end`, and returns that by `p⁻`.
    pub(super) fn backward(
        &self,
        seeds: &Seeds<S>,
        impulse: &S::PerConstraint<f64>,
        at_end: &mut StateGradient<S>,
    ) -> S::PerCoordinate<f64> {
        let mut by_v = at_end.v.clone();
        self.add_inertia(&at_end.p, &mut by_v);
        let (by_arriving, by_rate) = self.split(|i| by_v[i], |_| 0.0);
        let of_momentum = S::PerCoordinate::<f64>::from_fn(|i| at_end.p[i] - by_arriving[i]);
        self.add_momentum_derivatives(seeds, &of_momentum, at_end);
        if S::N_CONSTRAINTS > 0 {
            let no_time = 0.0;
            let along = self.constraint_rates(&seeds.still, no_time, &by_arriving);
            along.add_pull(-1.0, impulse, &mut at_end.q);
            self.subtract_rate_derivatives(seeds, &by_rate, at_end);
            if seeds.reach.jacobian {
                let follows = |reach: &Reach| reach.jacobian;
                seeds.add_parameter_rates(&mut at_end.parameters, follows, |constants| {
                    let q = still::<S, _>(&self.state.q);
                    let rates = ConstraintRates::<S, _>::new(constants, Tangent::still(self.state.t), &q);
                    -rates.form(impulse, &by_arriving)
                });
            }
        }
        by_arriving
    }

    /// Goes back over [`start`](Self::start): overwrites the derivatives by the state with those by a configuration and a velocity that are projected.
    pub(super) fn back_to_start(&self, seeds: &Seeds<S>, at_start: &mut StateGradient<S>) {
        let of_momentum = at_start.p.clone();
        self.add_momentum_derivatives(seeds, &of_momentum, at_start);
        let mut by_v = at_start.v.clone();
        self.add_inertia(&at_start.p, &mut by_v);
        at_start.p = Array::from_fn(|_| 0.0);
        if S::N_CONSTRAINTS > 0 {
            let (_, by_rate) = self.split(|i| by_v[i], |_| 0.0);
            self.subtract_pull(&by_rate, &mut by_v);
            self.subtract_rate_derivatives(seeds, &by_rate, at_start);
            let (_, by_residual) = self.split(|i| at_start.q[i], |_| 0.0);
            self.subtract_pull(&by_residual, &mut at_start.q);
            let follows = |reach: &Reach| reach.residuals;
            seeds.add_parameter_rates(&mut at_start.parameters, follows, |constants| {
                let q = still::<S, _>(&self.state.q);
                let residual = S::constraints(constants, Tangent::still(self.state.t), &q);
                (0..S::N_CONSTRAINTS).fold(Rate::ZERO, |sum, c| sum - residual[c].rate.times(by_residual[c]))
            });
        }
        at_start.v = by_v;
    }

    /// Adds the derivatives of `w · ∂L/∂v` at a fixed velocity.
    fn add_momentum_derivatives(
        &self,
        seeds: &Seeds<S>,
        w: &S::PerCoordinate<f64>,
        sum: &mut StateGradient<S>,
    ) {
        let State { t, q, v, .. } = self.state;
        if Self::MOMENTUM_MOVES {
            let (q, v) = (still::<S, f64>(q), moving::<S>(v, w));
            let force = S::lagrangian_gradient(&seeds.still, Tangent::still(*t), &q, &v).force;
            for i in 0..S::N_COORDINATES {
                sum.q[i] += force[i].rate;
            }
        }
        if !seeds.reach.momentum {
            return;
        }
        seeds.add_parameter_rates(
            &mut sum.parameters,
            |reach| reach.momentum,
            |constants| {
                let (q, v) = (still::<S, _>(q), still::<S, _>(v));
                let momentum = S::lagrangian_gradient(constants, Tangent::still(*t), &q, &v).momentum;
                (0..S::N_COORDINATES).fold(Rate::ZERO, |sum, i| sum + momentum[i].rate.times(w[i]))
            },
        );
    }

    /// Subtracts the derivatives of `x · (G v + ∂φ/∂t)` at a fixed velocity.
    fn subtract_rate_derivatives(
        &self,
        seeds: &Seeds<S>,
        x: &S::PerConstraint<f64>,
        sum: &mut StateGradient<S>,
    ) {
        let State { t, q, v, .. } = self.state;
        self.constraint_rates(&seeds.still, 1.0, v).add_pull(-1.0, x, &mut sum.q);
        if !seeds.reach.jacobian {
            return;
        }
        seeds.add_parameter_rates(
            &mut sum.parameters,
            |reach| reach.jacobian,
            |constants| {
                let rates = ConstraintRates::<S, _>::new(constants, Tangent::still(*t), &still::<S, _>(q));
                -(rates.form(x, v) + rates.time_form(x))
            },
        );
    }

    /// Subtracts `Gᵀ x`.
    fn subtract_pull(&self, x: &S::PerConstraint<f64>, sum: &mut S::PerCoordinate<f64>) {
        for entry in S::STRUCTURE.jacobian.q {
            sum[entry.col] -= self.slope(entry) * x[entry.row];
        }
    }
}
