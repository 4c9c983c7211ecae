//! Whether a step of the double pendulum exists, decided without any iteration.
//!
//! The Lagrangian is quadratic and gravity uniform: `−D₁L_d(q₀, q₁) + G₀ᵀℓ = p₀` gives the end `q₁ = c + Bℓ` by a linear solve, and two
//! quadratics in the two multipliers are left. The first rod holds where its end is on a circle, `x₁ = l₁ (sin α, −cos α)`, which gives `ℓ(α)`;
//! on it the second is a trigonometric polynomial of degree 2 in `α`. Where it is farther from zero in every one of ever smaller intervals than its
//! slope can bridge, there is no solution: a proof, but for round-off, which is 1e-15 of its terms.

use std::f64::consts::PI;

use evi_core::generic::GenericSystem;
use evi_core::scheme::Frequency;
use evi_examples::DoublePendulum;

use crate::action::{Action, MIDPOINT, SIMPSON, TRAPEZOID};
use crate::check::Snapshot;
use crate::observation::Observation;
use crate::tangent::Tangents;
use crate::theory::Figure;
use crate::verdict::{Verdict, on};

/// The residual of the step that was not found, and the proof that it does not exist; nothing where all steps were found.
pub(crate) fn proof(
    system: &DoublePendulum,
    method: &str,
    omega: Option<f64>,
    h: f64,
    seen: &Observation,
) -> Vec<Figure> {
    let Verdict::NoSolution(unsolved) = on(seen) else { return Vec::new() };
    let mut figures = vec![Figure::seen("residual", unsolved.residual.unwrap_or(f64::NAN))];
    if let (Some(end), Some(action)) = (&seen.end, action_of(method, omega))
        && let Some(gap) = smallest_violation(system, &action, h, end)
    {
        figures.push(Figure::at_least("proved: no end violates its rods by less than", gap, 0.0));
    }
    figures
}

/// The discrete action of a member on straight lines, or on curves of a frequency.
fn action_of(method: &str, omega: Option<f64>) -> Option<Action> {
    let straight = |nodes| Some(Action { nodes, frequency: Frequency::ZERO });
    let curved = |nodes| omega.map(|omega| Action { nodes, frequency: Frequency::from(omega) });
    match method {
        "midpoint" => straight(MIDPOINT),
        "simpson" => straight(SIMPSON),
        "rattle" => straight(TRAPEZOID),
        "midpoint_trig" => curved(MIDPOINT),
        "simpson_trig" => curved(SIMPSON),
        _ => None,
    }
}

/// A lower bound of `|φ₂|` over all ends that the equations of motion and the first rod admit; negative where it proves nothing. `None`
/// where the equations do not determine the end.
fn smallest_violation(system: &DoublePendulum, action: &Action, h: f64, start: &Snapshot) -> Option<f64> {
    let ends = Ends::of(system, action, h, start)?;
    let violation = |alpha: f64| {
        let mut residuals = [0.0; 2];
        system.constraints(start.t + h, &ends.at(alpha), &mut residuals);
        residuals[1]
    };
    // Coefficients of degree 0 to 2, from eight values; the slope is at most the sum of their amplitudes times their degrees.
    let values: Vec<f64> = (0..8).map(|k| violation(k as f64 * PI / 4.0)).collect();
    let amplitude = |degree: f64| {
        let part = |f: fn(f64) -> f64| {
            values.iter().enumerate().map(|(k, value)| value * f(degree * k as f64 * PI / 4.0)).sum::<f64>()
                / 4.0
        };
        part(f64::cos).hypot(part(f64::sin))
    };
    let slope = amplitude(1.0) + 2.0 * amplitude(2.0);
    // Halved until the slope cannot bridge what is left, or nothing is.
    const NARROWEST: f64 = 1e-9;
    let mut intervals = vec![(PI, PI)];
    let mut smallest = f64::INFINITY;
    while let Some((middle, half)) = intervals.pop() {
        let value = violation(middle).abs();
        let bound = value - half * slope;
        if bound > 0.5 * value || half < NARROWEST {
            smallest = smallest.min(bound);
        } else {
            let quarter = 0.5 * half;
            intervals.extend([(middle - quarter, quarter), (middle + quarter, quarter)]);
        }
        if smallest < 0.0 {
            break;
        }
    }
    Some(smallest)
}

/// `q₁ = c + Bℓ`, with the multipliers for which the first rod holds.
struct Ends {
    l1: f64,
    constant: [f64; 4],
    per_multiplier: [[f64; 4]; 2],
}

impl Ends {
    fn of(system: &DoublePendulum, action: &Action, h: f64, start: &Snapshot) -> Option<Self> {
        let momentum = |q1: [f64; 4]| -> [f64; 4] {
            let [departing, _] = action.momenta(system, h, start.t, [&start.q, &q1]);
            [0, 1, 2, 3].map(|i| departing[i])
        };
        let at_zero = momentum([0.0; 4]);
        // Affine: differences are derivatives.
        let mut matrix = [[0.0; 4]; 4];
        for j in 0..4 {
            let mut unit = [0.0; 4];
            unit[j] = 1.0;
            let column = momentum(unit);
            (0..4).for_each(|i| matrix[i][j] = column[i] - at_zero[i]);
        }
        let rows = Tangents::at(system, start.t, &start.q).rows;
        let constant = solve(matrix, [0, 1, 2, 3].map(|i| start.p[i] - at_zero[i]))?;
        let mut per_multiplier = [[0.0; 4]; 2];
        for (column, row) in per_multiplier.iter_mut().zip(&rows) {
            *column = solve(matrix, [0, 1, 2, 3].map(|i| -row[i]))?;
        }
        Some(Self { l1: system.l1, constant, per_multiplier })
    }

    /// The end whose first rod hangs at the angle `alpha`.
    fn at(&self, alpha: f64) -> [f64; 4] {
        let Self { l1, constant: c, per_multiplier: [b1, b2] } = self;
        let right = [l1 * alpha.sin() - c[0], -l1 * alpha.cos() - c[1]];
        let determinant = b1[0] * b2[1] - b2[0] * b1[1];
        let first = (right[0] * b2[1] - b2[0] * right[1]) / determinant;
        let second = (b1[0] * right[1] - right[0] * b1[1]) / determinant;
        [0, 1, 2, 3].map(|i| c[i] + first * b1[i] + second * b2[i])
    }
}

/// Gauss' elimination with row pivoting.
fn solve(mut matrix: [[f64; 4]; 4], mut right: [f64; 4]) -> Option<[f64; 4]> {
    for k in 0..4 {
        let pivot = (k..4).max_by(|&a, &b| matrix[a][k].abs().total_cmp(&matrix[b][k].abs()))?;
        matrix.swap(k, pivot);
        right.swap(k, pivot);
        if matrix[k][k] == 0.0 {
            return None;
        }
        for row in k + 1..4 {
            let factor = matrix[row][k] / matrix[k][k];
            for col in k..4 {
                matrix[row][col] -= factor * matrix[k][col];
            }
            right[row] -= factor * right[k];
        }
    }
    for k in (0..4).rev() {
        let known: f64 = (k + 1..4).map(|col| matrix[k][col] * right[col]).sum();
        right[k] = (right[k] - known) / matrix[k][k];
    }
    Some(right)
}

#[cfg(test)]
mod tests {
    use super::*;
    use evi_examples::Start;

    /// A step that exists has an end that violates nothing.
    #[test]
    fn a_step_that_exists_is_not_proved_away() {
        let system = DoublePendulum::UNIT;
        let Start { q, v } = system.at_angles(0.3, 0.5);
        let start = Snapshot { t: 0.0, q: q.into(), v: v.into(), p: v.into() };
        let action = action_of("simpson_trig", Some(3.0)).expect("a member on curves");
        let bound = smallest_violation(&system, &action, 0.05, &start).expect("a regular matrix");
        assert!((-1e-7..=0.0).contains(&bound), "{bound}");
        // A chord far beyond both rods.
        let fast = Snapshot { p: vec![500.0, 0.0, 500.0, 0.0], ..start };
        let bound = smallest_violation(&system, &action, 0.05, &fast).expect("a regular matrix");
        assert!(bound > 0.1, "{bound}");
    }
}
