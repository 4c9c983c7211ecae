//! The double pendulum in its rod vectors `a` (inner) and `b` (outer), in which uniform gravity acts on `a` alone and the
//! constraints are `|a|² = l₁²`, `|b|² = l₂²`. Scaled multipliers `μ, ν` pull along the rods:
//!
//! ```text
//! a' = a + wₐ − (μ a − ν b)      b' = b + w_b + (μ a − β ν b)      β = 1 + m₁/m₂
//! ```
//!
//! From an extrapolated `(μ₀, ν₀)`, the constraints are quadratic polynomials of the correction, `f − 2K(δ, ε) + Q(δ, ε)` with
//! `Q₁ = |δ a − ε b|²` and `Q₂ = |δ a − β ε b|²`. After one correction `Q` is left, exactly; where it is not round-off, a second one
//! needs no evaluation of the constraints.

use evi_examples::{DoublePendulum, Start};

use super::{
    HandWritten, LARGEST_REST, MAX_CORRECTIONS, are_finite, difference, dot, expected_at_end, extrapolated,
    sum, times,
};

/// A run of the double pendulum.
pub struct HandWrittenDoublePendulum {
    /// Rod vectors.
    a: [f64; 2],
    b: [f64; 2],
    /// Their velocities times `h`.
    wa: [f64; 2],
    wb: [f64; 2],
    h: f64,
    /// `h² g / 2`.
    fall: f64,
    /// `β`.
    mass_ratio: f64,
    /// `l₁²`, `l₂²`.
    squared_lengths: [f64; 2],
    /// `β l₂²`.
    outer: f64,
    /// `β l₁² l₂²`.
    both: f64,
    /// `Q₁` and `Q₂` are below `bounds[0] δ² + bounds[1] ε²`.
    bounds: [f64; 2],
    /// A residual below this is round-off.
    round_off: f64,
    /// `LARGEST_REST` for energies in units of `m₂/h²` beside removed ones in units of `m₁/h²`.
    slow: f64,
    /// `(μ, ν)` of the last four steps, newest first.
    multipliers: [[f64; 4]; 2],
}

/// Half the slopes of the constraints by the multipliers, but for the sign, inverted but for the factor: `K⁻¹ = 2 r adj K`.
struct Slopes {
    adjugate: [[f64; 2]; 2],
    r: f64,
}

impl Slopes {
    /// `(δ, ε)` that removes the residual `f` of the constraints.
    #[inline(always)]
    fn correction(&self, f: [f64; 2]) -> [f64; 2] {
        self.adjugate.map(|row| dot(row, f) * self.r)
    }
}

/// The rods at the end of a step, `a·b`, and `1/(β l₁² l₂² − (a·b)²)`.
struct Ends {
    a: [f64; 2],
    b: [f64; 2],
    cosine: f64,
    r: f64,
}

/// What the multipliers `(μ, ν)` along the rods `a`, `b` add to `−wₐ` and to `w_b`.
#[inline(always)]
fn pull_of([a, b]: [[f64; 2]; 2], mass_ratio: f64, [mu, nu]: [f64; 2]) -> [[f64; 2]; 2] {
    let along_a = times(mu, a);
    [difference(along_a, times(nu, b)), difference(along_a, times(mass_ratio * nu, b))]
}

impl HandWrittenDoublePendulum {
    /// A run from a consistent start.
    pub fn new(system: &DoublePendulum, start: Start<4>, h: f64) -> Self {
        let ([x1, y1, x2, y2], [vx1, vy1, vx2, vy2]) = (start.q, start.v);
        let mass_ratio = 1.0 + system.m1 / system.m2;
        let squared_lengths = [system.l1 * system.l1, system.l2 * system.l2];
        Self {
            a: [x1, y1],
            b: [x2 - x1, y2 - y1],
            wa: [h * vx1, h * vy1],
            wb: [h * (vx2 - vx1), h * (vy2 - vy1)],
            h,
            fall: 0.5 * h * h * system.g,
            mass_ratio,
            squared_lengths,
            outer: mass_ratio * squared_lengths[1],
            both: mass_ratio * squared_lengths[0] * squared_lengths[1],
            bounds: [2.0 * squared_lengths[0], 2.0 * mass_ratio * mass_ratio * squared_lengths[1]],
            round_off: 0.25 * f64::EPSILON * squared_lengths[0].min(squared_lengths[1]),
            slow: LARGEST_REST * system.m2 / system.m1,
            multipliers: [[0.0; 4]; 2],
        }
    }

    /// What the multipliers `(μ, ν)` add to `−wₐ` and to `w_b`.
    #[inline(always)]
    fn pull(&self, multipliers: [f64; 2]) -> [[f64; 2]; 2] {
        pull_of([self.a, self.b], self.mass_ratio, multipliers)
    }

    /// Removes the velocities along the rods, and returns twice the kinetic energy that they had, in units of `m₁/h²`.
    #[inline(always)]
    fn without_rest(
        &self,
        &Ends { a, b, cosine, r }: &Ends,
        wa: [f64; 2],
        wb: [f64; 2],
    ) -> ([f64; 2], [f64; 2], f64) {
        let rates = [dot(a, wa), dot(b, wb)];
        let n1 = (self.outer * rates[0] + cosine * rates[1]) * r;
        let n2 = (self.squared_lengths[0] * rates[1] + cosine * rates[0]) * r;
        let [pull_a, pull_b] = pull_of([a, b], self.mass_ratio, [n1, n2]);
        (difference(wa, pull_a), sum(wb, pull_b), n1 * rates[0] + n2 * rates[1])
    }

    /// Residuals of the constraints and their slopes at the ends `a'`, `b'` of the rods.
    #[inline(always)]
    fn linearize(&self, end_a: [f64; 2], end_b: [f64; 2]) -> ([f64; 2], Slopes) {
        let residual =
            [dot(end_a, end_a) - self.squared_lengths[0], dot(end_b, end_b) - self.squared_lengths[1]];
        let (aa, ab) = (dot(end_a, self.a), dot(end_a, self.b));
        let (ba, bb) = (dot(end_b, self.a), self.mass_ratio * dot(end_b, self.b));
        (residual, Slopes { adjugate: [[bb, ab], [ba, aa]], r: 0.5 / (aa * bb - ab * ba) })
    }

    /// `(δ, ε)` by Newton's iteration with fresh slopes for every correction, and the number of corrections.
    #[cold]
    fn solve_anew(&self, wa: [f64; 2], wb: [f64; 2]) -> Option<([f64; 2], u32)> {
        let mut delta = [0.0; 2];
        let mut previous = 0.0;
        for correction in 1..=MAX_CORRECTIONS {
            let [pull_a, pull_b] = self.pull(delta);
            let end_a = sum(self.a, difference(wa, pull_a));
            let end_b = sum(self.b, sum(wb, pull_b));
            let (f, slopes) = self.linearize(end_a, end_b);
            delta = sum(delta, slopes.correction(f));
            let size = f[0].abs() + f[1].abs();
            if size <= 16.0 * self.round_off || size * size <= self.round_off * previous {
                return Some((delta, correction));
            }
            previous = size;
        }
        None
    }
}

impl HandWritten<4> for HandWrittenDoublePendulum {
    #[inline(always)]
    fn advance(&mut self) -> Option<u32> {
        let guess = self.multipliers.map(extrapolated);
        let at_end = [0, 1].map(|i| expected_at_end(guess[i], self.multipliers[i][0]));
        let [pull_a, pull_b] = self.pull(guess);
        let wa = [self.wa[0] - pull_a[0], self.wa[1] - (self.fall + pull_a[1])];
        let wb = sum(self.wb, pull_b);
        let (f, slopes) = self.linearize(sum(self.a, wa), sum(self.b, wb));
        let mut delta = slopes.correction(f);
        let mut corrections = 1;
        let is_round_off =
            self.bounds[0] * (delta[0] * delta[0]) + self.bounds[1] * (delta[1] * delta[1]) <= self.round_off;
        if !is_round_off {
            let first = self.pull(delta);
            let correction = slopes.correction(first.map(|pull| dot(pull, pull)));
            let second = self.pull(correction);
            delta = sum(delta, correction);
            corrections = 2;
            // What is left now: Q of both corrections together, less Q of the first.
            let left = |i: usize| dot(sum(times(2.0, first[i]), second[i]), second[i]).abs();
            let converged = left(0).max(left(1)) <= self.round_off;
            if !converged {
                (delta, corrections) = self.solve_anew(wa, wb)?;
            }
        }
        let [pull_a, pull_b] = self.pull(delta);
        let (wa, wb) = (difference(wa, pull_a), sum(wb, pull_b));
        let (a, b) = (sum(self.a, wa), sum(self.b, wb));

        // The end of gravity's kick, and the impulses that keep the velocities on the constraints: those that are expected, and the rest.
        let [pull_a, pull_b] = pull_of([a, b], self.mass_ratio, at_end);
        let wa = [wa[0] - pull_a[0], wa[1] - (self.fall + pull_a[1])];
        let wb = sum(wb, pull_b);
        let cosine = dot(a, b);
        let r = 1.0 / (self.both - cosine * cosine);
        let ends = Ends { a, b, cosine, r };
        let (mut wa, mut wb, removed) = self.without_rest(&ends, wa, wb);
        let is_slow = removed > self.slow * (self.mass_ratio * dot(wa, wa) + 2.0 * dot(wa, wb) + dot(wb, wb));
        if is_slow {
            (wa, wb, _) = self.without_rest(&ends, wa, wb);
        }
        if !are_finite([a, b, wa, wb]) {
            return None;
        }
        (self.a, self.b, self.wa, self.wb) = (a, b, wa, wb);
        for (history, (guess, delta)) in self.multipliers.iter_mut().zip(guess.into_iter().zip(delta)) {
            *history = [guess + delta, history[0], history[1], history[2]];
        }
        Some(corrections)
    }

    fn q(&self) -> [f64; 4] {
        [self.a[0], self.a[1], self.a[0] + self.b[0], self.a[1] + self.b[1]]
    }

    fn v(&self) -> [f64; 4] {
        let [ax, ay] = self.wa.map(|w| w / self.h);
        let [bx, by] = self.wb.map(|w| w / self.h);
        [ax, ay, ax + bx, ay + by]
    }
}
