//! Derivatives of the steps that solve for points, whatever their action is.
//!
//! With the points `q_a`, `a = 0 .. A`, of a step and `P_a = ∂L_d/∂q_a` with the discrete forces, every such step solves
//!
//! ```text
//! −P_a − p₀ δ_a0 + G_aᵀ Λ_a = 0,  a = 0 .. A−1        φ(t_a, q_a) = 0,  a = 1 .. A        p⁻ = P_A
//! ```
//!
//! With one interval these are the exponential variational integrators, with inner Lobatto points the Galerkin ones. By the implicit function
//! theorem a change of the start moves the points by `−K⁻¹` times what it makes of the left sides, where `K` is the matrix of the step; a gradient goes
//! back through `K⁻ᵀ` (Marsden & West, Acta Numerica 10 (2001), sec. 2.2; for adjoints of variational integrators Ober-Blöbaum, Junge, Marsden, ESAIM COCV 17
//! (2011) 322).

use super::evaluation::{ConstraintRates, moving};
use super::landing::{Landing, Moved};
use super::parameters::{Reach, Seeds};
use super::{DerivativeError, StateGradient, StateTangent};
use crate::array::Array;
use crate::linear::constraint_index;
use crate::mechanics::{ConstantLegendre, Mechanics, State};
use crate::scalar::{Rate, Tangent};
use crate::system::MechanicalSystem;

/// One vector per point after the first.
pub(super) type PerPoint<S, const A: usize> = [<S as MechanicalSystem>::PerCoordinate<f64>; A];
/// One row of the equations, or one unknown, per point after the first: coordinates, then constraints.
pub(super) type Blocks<S, const A: usize> = [<S as MechanicalSystem>::PerUnknown<f64>; A];

/// The action of a step as a function of its points, by what its derivatives are made of.
pub(super) trait PointAction<S: MechanicalSystem, const A: usize> {
    fn scene(&self) -> &Mechanics<S>;

    /// `t_a`.
    fn point_time(&self, t: f64, point: usize) -> f64;

    /// `P_a` of the first point and of the last.
    fn end_momenta(&self, start: &State<S>, differences: &PerPoint<S, A>) -> [S::PerCoordinate<f64>; 2];

    /// The rates of `P_a` where the points, the constants and the inputs move.
    fn momentum_rates(
        &self,
        step: &TakenStep<S, A>,
        tangent: &StateTangent<S>,
        moved: &Points<S, A>,
    ) -> Points<S, A>;

    /// How the number `Σ_a m_a · P_a` of vectors `m` changes with every point.
    fn products(&self, step: &TakenStep<S, A>, seeds: &Seeds<S>, along: &Points<S, A>) -> Points<S, A>;

    /// Adds the derivatives of `Σ_a m_a · P_a` by the parameters and the inputs.
    fn add_parameters(
        &self,
        step: &TakenStep<S, A>,
        seeds: &Seeds<S>,
        along: &Points<S, A>,
        gradient: &mut StateGradient<S>,
    );
}

/// A step that was taken: what its derivative is made of.
pub struct TakenStep<S: MechanicalSystem, const A: usize> {
    pub(super) start: State<S>,
    pub(super) end: State<S>,
    /// `q_a − q₀`, from `a = 1` on.
    pub(super) differences: PerPoint<S, A>,
    /// `Λ_a`, from `a = 0` on.
    pub(super) impulses: [S::PerConstraint<f64>; A],
    /// `p⁻`.
    pub(super) arriving: S::PerCoordinate<f64>,
}

/// Vectors by point, the first one included.
pub(super) struct Points<S: MechanicalSystem, const A: usize> {
    pub(super) first: S::PerCoordinate<f64>,
    pub(super) others: PerPoint<S, A>,
}

impl<S: MechanicalSystem, const A: usize> Points<S, A> {
    pub(super) fn zero() -> Self {
        Self { first: zero::<S>(), others: core::array::from_fn(|_| zero::<S>()) }
    }

    #[inline]
    pub(super) fn get(&self, point: usize) -> &S::PerCoordinate<f64> {
        if point == 0 { &self.first } else { &self.others[point - 1] }
    }

    #[inline]
    pub(super) fn get_mut(&mut self, point: usize) -> &mut S::PerCoordinate<f64> {
        if point == 0 { &mut self.first } else { &mut self.others[point - 1] }
    }
}

pub(super) fn zero<S: MechanicalSystem>() -> S::PerCoordinate<f64> {
    Array::from_fn(|_| 0.0)
}

/// The derivatives of one step.
pub(super) struct StepDerivative<'a, S: MechanicalSystem, N, const A: usize> {
    action: &'a N,
    step: &'a TakenStep<S, A>,
    landing: Landing<'a, S>,
    /// `N`: what the projection at the end removed.
    removed: S::PerConstraint<f64>,
}

impl<'a, S: MechanicalSystem, N: PointAction<S, A>, const A: usize> StepDerivative<'a, S, N, A> {
    pub(super) fn new(
        action: &'a N,
        legendre: Option<&'a ConstantLegendre<S>>,
        step: &'a TakenStep<S, A>,
    ) -> Result<Self, DerivativeError> {
        let landing = Landing::new(action.scene(), legendre, &step.end)?;
        let removed = landing.removed(&step.arriving);
        Ok(Self { action, step, landing, removed })
    }

    /// Moves a vector at the start of the step to its end; `solve` overwrites right-hand sides with the solution of `K x = b`.
    pub(super) fn push_forward(&self, tangent: &mut StateTangent<S>, solve: impl FnOnce(&mut Blocks<S, A>)) {
        let mut moved = Points { first: tangent.q.clone(), others: Points::<S, A>::zero().others };
        let rates = self.action.momentum_rates(self.step, tangent, &moved);
        let mut rows: Blocks<S, A> = core::array::from_fn(|a| {
            let own = if a == 0 { 1.0 } else { 0.0 };
            let rate = rates.get(a);
            Array::from_fn(|i| if i < S::N_COORDINATES { rate[i] + own * tangent.p[i] } else { 0.0 })
        });
        if S::N_CONSTRAINTS > 0 {
            self.add_constraint_rows(tangent, &mut rows);
        }
        solve(&mut rows);
        for (moved, row) in moved.others.iter_mut().zip(&rows) {
            *moved = Array::from_fn(|i| row[i]);
        }
        let rates = self.action.momentum_rates(self.step, tangent, &moved);
        let end = &moved.others[A - 1];
        let Moved { v, p } = self.landing.forward(tangent.parts(), &self.removed, end, rates.get(A));
        tangent.q = end.clone();
        (tangent.v, tangent.p) = (v, p);
    }

    /// Adds `−Ġᵀ Λ` and `−φ̇`, which a change of the start and of the constants makes of the left sides.
    fn add_constraint_rows(&self, tangent: &StateTangent<S>, rows: &mut Blocks<S, A>) {
        let TakenStep { start, differences, impulses, .. } = self.step;
        for point in 0..=A {
            if point > 0 && !tangent.parameters_move {
                break;
            }
            let t = Tangent::still(self.action.point_time(start.t, point));
            let q = if point == 0 {
                moving::<S>(&start.q, &tangent.q)
            } else {
                Array::from_fn(|i| Tangent::still(start.q[i] + differences[point - 1][i]))
            };
            let rates = ConstraintRates::<S>::new(&tangent.constants, t, &q);
            if point < A {
                let mut pull = zero::<S>();
                rates.add_pull(-1.0, &impulses[point], &mut pull);
                for i in 0..S::N_COORDINATES {
                    rows[point][i] += pull[i];
                }
            }
            if point > 0 {
                for c in 0..S::N_CONSTRAINTS {
                    rows[point - 1][constraint_index::<S>(c)] -= rates.residual[c];
                }
            }
        }
    }

    /// Moves a gradient at the end of the step to its start; `solve` overwrites right-hand sides with the solution of `Kᵀ x = b`.
    pub(super) fn pull_back(
        &self,
        seeds: &Seeds<S>,
        gradient: &mut StateGradient<S>,
        solve: impl FnOnce(&mut Blocks<S, A>),
    ) {
        let by_arriving = self.before_landing(seeds, gradient);
        self.pull_back_from(by_arriving, seeds, gradient, solve);
    }

    /// The same for a gradient that has gone back over the landing, where it has the derivatives `by_arriving` by `p⁻`.
    pub(super) fn pull_back_from(
        &self,
        by_arriving: S::PerCoordinate<f64>,
        seeds: &Seeds<S>,
        gradient: &mut StateGradient<S>,
        solve: impl FnOnce(&mut Blocks<S, A>),
    ) {
        let mut along = Points::<S, A>::zero();
        along.others[A - 1] = by_arriving;
        let mut by_points = self.action.products(self.step, seeds, &along);
        for i in 0..S::N_COORDINATES {
            by_points.others[A - 1][i] += gradient.q[i];
        }
        let mut rows: Blocks<S, A> = core::array::from_fn(|a| {
            let by_point = &by_points.others[a];
            Array::from_fn(|i| if i < S::N_COORDINATES { by_point[i] } else { 0.0 })
        });
        solve(&mut rows);
        let mut of_rows = Points::<S, A>::zero();
        for (a, row) in rows.iter().enumerate() {
            *of_rows.get_mut(a) = Array::from_fn(|i| row[i]);
        }
        let by_start = self.action.products(self.step, seeds, &of_rows).first;
        gradient.q = Array::from_fn(|i| by_points.first[i] + by_start[i]);
        gradient.p = of_rows.first.clone();
        gradient.v = zero::<S>();
        self.add_start_curvature(seeds, &mut gradient.q, &of_rows.first);
        let of_residual = core::array::from_fn(|a| Array::from_fn(|c| rows[a][constraint_index::<S>(c)]));
        for a in 0..A {
            *along.get_mut(a) = of_rows.get(a).clone();
        }
        self.add_parameters(seeds, &along, &of_residual, gradient);
    }

    /// Adds to the derivative by `q₀` what the forces of the constraints there make of that by `p₀`.
    pub(super) fn add_start_curvature(
        &self,
        seeds: &Seeds<S>,
        by_position: &mut S::PerCoordinate<f64>,
        by_momentum: &S::PerCoordinate<f64>,
    ) {
        if S::N_CONSTRAINTS > 0 {
            let TakenStep { start, impulses, .. } = self.step;
            let (t, q) = (Tangent::still(start.t), moving::<S>(&start.q, by_momentum));
            ConstraintRates::<S>::new(&seeds.still, t, &q).add_pull(-1.0, &impulses[0], by_position);
        }
    }

    /// Adds the derivatives by parameters and inputs: `along` has those by the momentum balances of the points before the last and by `p⁻`, `of_residual`
    /// those by the constraints of the points after the first.
    pub(super) fn add_parameters(
        &self,
        seeds: &Seeds<S>,
        along: &Points<S, A>,
        of_residual: &[S::PerConstraint<f64>; A],
        gradient: &mut StateGradient<S>,
    ) {
        if S::N_CONSTRAINTS > 0 {
            let of_momentum: PerPoint<S, A> = core::array::from_fn(|a| along.get(a).clone());
            let time = |point: usize| self.action.point_time(self.step.start.t, point);
            let by_rows = (&of_momentum, of_residual);
            subtract_constraint_parameters(seeds, self.step, time, by_rows, &mut gradient.parameters);
        }
        self.action.add_parameters(self.step, seeds, along, gradient);
    }

    /// Goes back over the landing: adds to the derivatives by `q₁`, and returns those by `p⁻`.
    pub(super) fn before_landing(
        &self,
        seeds: &Seeds<S>,
        gradient: &mut StateGradient<S>,
    ) -> S::PerCoordinate<f64> {
        self.landing.backward(seeds, &self.removed, gradient)
    }
}

/// Subtracts the derivatives of `Σ_a μ_a · G_aᵀ Λ_a + ν_a · φ(q_a)` by the parameters, `a = 0 .. A−1` for `μ` and `a = 1 .. A` for `ν`.
pub(super) fn subtract_constraint_parameters<S: MechanicalSystem, const A: usize>(
    seeds: &Seeds<S>,
    TakenStep { start, differences, impulses, .. }: &TakenStep<S, A>,
    time: impl Fn(usize) -> f64,
    (of_momentum, of_residual): (&PerPoint<S, A>, &[S::PerConstraint<f64>; A]),
    gradient: &mut [f64],
) {
    if !(seeds.reach.residuals || seeds.reach.jacobian) {
        return;
    }
    for point in (0..=A).filter(|&point| point > 0 || seeds.reach.jacobian) {
        let t = Tangent::still(time(point));
        let moved = |i: usize| if point == 0 { 0.0 } else { differences[point - 1][i] };
        let q = Array::from_fn(|i| Tangent::still(start.q[i] + moved(i)));
        if point < A {
            let follows = |reach: &Reach| reach.jacobian;
            seeds.add_parameter_rates(gradient, follows, |constants| {
                -ConstraintRates::<S, _>::new(constants, t, &q).form(&impulses[point], &of_momentum[point])
            });
        }
        if point > 0 {
            let follows = |reach: &Reach| reach.residuals;
            seeds.add_parameter_rates(gradient, follows, |constants| {
                let (residual, by) = (S::constraints(constants, t, &q), &of_residual[point - 1]);
                (0..S::N_CONSTRAINTS).fold(Rate::ZERO, |sum, c| sum - residual[c].rate.times(by[c]))
            });
        }
    }
}
