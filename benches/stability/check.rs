//! The independent check of accepted steps: are the stored states what the method's equations say?
//!
//! Nothing of the steps is used, nor any emitted kernel: the Lagrangian and the constraints are the generic copies of the user's
//! expressions, their derivatives come from the dual numbers of another project, the curves from the paper's `sin(uτ)/sin u`, multipliers
//! from least squares. Residuals are given in multiples of round-off: of what moving every number of the step by one rounding would make of
//! the same equation, for momenta about `ε ‖M‖‖q‖/h`.

use evi_core::comparison::Solver;
use evi_core::generic::GenericSystem;
use num_dual::Dual64;
use serde::Serialize;

use crate::action::Equations;
use crate::tangent::Tangents;

/// A residual of so many roundings is none of round-off. Measured over all rows: 1 to 30 of most, 750 of generalized-α in steps of ten
/// periods, 560 of a Galerkin member at a mass ratio of 1e12.
pub(crate) const ROUNDINGS: f64 = 1024.0;

/// A state as it is stored.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Snapshot {
    pub(crate) t: f64,
    pub(crate) q: Vec<f64>,
    pub(crate) v: Vec<f64>,
    pub(crate) p: Vec<f64>,
}

impl Snapshot {
    pub(crate) fn of(solver: &dyn Solver) -> Self {
        Self { t: solver.t(), q: solver.q().into(), v: solver.v().into(), p: solver.p().into() }
    }

    fn is_finite(&self) -> bool {
        [&self.q, &self.v, &self.p].into_iter().flatten().all(|x| x.is_finite())
    }
}

/// What a method promises of a step, and is held to.
#[derive(Clone, Debug)]
pub(crate) struct Promise {
    /// Every end lies on the constraints.
    pub(crate) constraints: bool,
    /// And its velocity along them.
    pub(crate) hidden_constraints: Velocity,
    /// By how much the round-off of the projected velocity, and that of the momentum beside it, is larger than that of independent
    /// constraints.
    pub(crate) conditioning: [f64; 2],
    /// A step is a stationary point of this discrete action.
    pub(crate) action: Option<Equations>,
}

/// To what round-off a method holds the hidden constraints.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Velocity {
    /// To none: its velocities are not projected.
    #[default]
    Free,
    /// That of the velocity itself.
    Projected,
    /// That of the configurations whose difference the velocity is, `‖q‖/h`.
    ProjectedOnce,
}

/// The equation that a step violates most, and by how many roundings.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Residual {
    pub(crate) roundings: f64,
    pub(crate) equation: &'static str,
    /// Whether the equations of its action were among those that were looked at: not, where it promises none, and where the points between its ends were
    /// not found again.
    pub(crate) has_action: bool,
}

/// The checks of a run.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub(crate) struct Check {
    pub(crate) steps: u64,
    /// Largest residual, in roundings.
    pub(crate) worst: f64,
    /// Its step.
    pub(crate) worst_step: u64,
    pub(crate) equation: &'static str,
    /// Of so many steps the equations of the action were checked, too.
    pub(crate) actions: u64,
}

impl Check {
    pub(crate) fn add(&mut self, step: u64, residual: Residual) {
        let Residual { roundings, equation, has_action } = residual;
        self.steps += 1;
        self.actions += u64::from(has_action);
        // Written so that a NaN is the worst.
        let is_better = roundings <= self.worst;
        if !is_better && !self.worst.is_nan() {
            (self.worst, self.worst_step, self.equation) = (roundings, step, equation);
        }
    }

    /// The checks of both.
    pub(crate) fn merge(&mut self, other: &Self) {
        let (steps, actions) = (self.steps + other.steps, self.actions + other.actions);
        let is_better = other.worst <= self.worst;
        if !is_better {
            *self = *other;
        }
        (self.steps, self.actions) = (steps, actions);
    }

    pub(crate) fn has_failed(&self) -> bool {
        // Written so that a NaN has.
        let holds = self.worst <= ROUNDINGS;
        !holds
    }
}

/// The largest residual of the equations of a step from `before` to `after`.
pub(crate) fn step<S: GenericSystem>(
    system: &S,
    promise: &Promise,
    h: f64,
    before: &Snapshot,
    after: &Snapshot,
) -> Residual {
    if !after.is_finite() {
        return Residual { roundings: f64::INFINITY, equation: "a number is not finite", has_action: false };
    }
    let mut worst = Residual { roundings: 0.0, equation: "", has_action: false };
    let mut hold = |equation: &'static str, residual: f64, rounding: f64| {
        let roundings = if residual == 0.0 { 0.0 } else { residual.abs() / rounding };
        let is_smaller = roundings <= worst.roundings;
        if !is_smaller && !worst.roundings.is_nan() {
            worst = Residual { roundings, equation, ..worst };
        }
    };
    let eps = f64::EPSILON;
    hold("t = t₀ + h", after.t - before.t - h, eps * after.t.abs().max(before.t.abs()).max(h.abs()));
    let momentum = momentum(system, after);
    if momentum.iter().any(|p| p.is_nan()) {
        // Squares of the velocity overflow: there is no energy, and the run has diverged.
        return Residual { roundings: 0.0, equation: "the energy is no number", has_action: false };
    }
    let (largest_p, from_v) = (norm(&after.p), norm(&momentum));
    for (p, value) in after.p.iter().zip(&momentum) {
        hold("p = ∂L/∂v", p - value, eps * largest_p.max(from_v) * promise.conditioning[1]);
    }
    let ends = Tangents::at(system, after.t, &after.q);
    for (c, residual) in ends.residuals.iter().enumerate() {
        let gradient = norm(&ends.rows[c]);
        if promise.constraints {
            hold("φ = 0", *residual, eps * gradient * norm(&after.q));
        }
        // Near rest even a velocity that is refined has roundings of roundings of the configuration.
        let of_differences = norm(&after.q) / h.abs();
        let speed = match promise.hidden_constraints {
            Velocity::Free => continue,
            Velocity::Projected => norm(&after.v) + eps * of_differences,
            Velocity::ProjectedOnce => norm(&after.v) + of_differences,
        };
        let rate = dot(&ends.rows[c], &after.v) + ends.rates[c];
        let rounding = eps * (gradient * speed + ends.rates[c].abs());
        hold("G v + ∂φ/∂t = 0", rate, rounding * promise.conditioning[0]);
    }
    if let Some(([departing, arriving], rounding)) =
        promise.action.as_ref().and_then(|action| action.momenta_with_rounding(system, h, before, after))
    {
        let starts = Tangents::at(system, before.t, &before.q);
        let left: Vec<f64> = departing.iter().zip(&before.p).map(|(d, p)| d - p).collect();
        hold("−D₁L_d + G₀ᵀℓ = p₀", norm(&starts.tangential(left)), rounding + eps * norm(&before.p));
        let left: Vec<f64> = arriving.iter().zip(&after.p).map(|(d, p)| d - p).collect();
        hold("D₂L_d − G₁ᵀN = p₁", norm(&ends.tangential(left)), rounding + eps * largest_p);
        worst.has_action = true;
    }
    worst
}

/// `∂L/∂v` by dual numbers.
fn momentum<S: GenericSystem>(system: &S, Snapshot { t, q, v, .. }: &Snapshot) -> Vec<f64> {
    let q: Vec<Dual64> = q.iter().map(|&q| Dual64::from_re(q)).collect();
    let mut moved: Vec<Dual64> = v.iter().map(|&v| Dual64::from_re(v)).collect();
    (0..v.len())
        .map(|i| {
            moved[i] = Dual64::new(v[i], 1.0);
            let value = system.lagrangian(Dual64::from_re(*t), &q, &moved).eps;
            moved[i] = Dual64::from_re(v[i]);
            value
        })
        .collect()
}

pub(crate) fn norm(x: &[f64]) -> f64 {
    // Without overflow, which would make every residual small.
    let largest = x.iter().fold(0.0_f64, |largest, x| largest.max(x.abs()));
    if largest == 0.0 { 0.0 } else { largest * x.iter().map(|x| (x / largest).powi(2)).sum::<f64>().sqrt() }
}

pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
