//! The spherical pendulum. Its end point `q' = q + w − μ q` moves along `q` with the scaled multiplier `μ`, so that the
//! constraint is a quadratic polynomial of `μ`:
//!
//! ```text
//! |q'(μ₀ + δ)|² − l² = f − 2 k δ + l² δ²      f = |q'(μ₀)|² − l²,  k = q'(μ₀)·q
//! ```
//!
//! `δ = f / 2k` from an extrapolated `μ₀` leaves `l² δ²`, which is round-off. `k` is `l² cos α` for the angle `α` of a step, so
//! smooth that `1/2k` can be extrapolated as well: the division leaves the chain.

use evi_examples::{SphericalPendulum, Start};

use super::{
    HandWritten, LARGEST_REST, MAX_CORRECTIONS, are_finite, difference, dot, expected_at_end, extrapolated,
    sum, times,
};

/// A run of the spherical pendulum.
pub struct HandWrittenSphericalPendulum {
    q: [f64; 3],
    /// Velocity times `h`.
    w: [f64; 3],
    h: f64,
    /// `h² g / 2`.
    fall: f64,
    squared_length: f64,
    inverse_squared_length: f64,
    /// A residual below this is round-off.
    round_off: f64,
    /// `μ` of the last four steps, newest first.
    multipliers: [f64; 4],
    /// `1/2k` of the last four steps.
    reciprocals: [f64; 4],
}

impl HandWrittenSphericalPendulum {
    /// A run from a consistent start.
    pub fn new(system: &SphericalPendulum, start: Start<3>, h: f64) -> Self {
        let squared_length = system.l * system.l;
        Self {
            q: start.q,
            w: start.v.map(|v| h * v),
            h,
            fall: 0.5 * h * h * system.g,
            squared_length,
            inverse_squared_length: 1.0 / squared_length,
            round_off: 0.25 * f64::EPSILON * squared_length,
            multipliers: [0.0; 4],
            reciprocals: [0.5 / squared_length; 4],
        }
    }

    /// Removes the velocity along the rod at `q`, and returns its square.
    #[inline(always)]
    fn without_rest(&self, q: [f64; 3], w: [f64; 3]) -> ([f64; 3], f64) {
        let rate = dot(q, w);
        let along = self.inverse_squared_length * rate;
        (difference(w, times(along, q)), along * rate)
    }

    /// `δ` by Newton's iteration with a fresh slope for every correction, and the number of corrections.
    #[cold]
    fn solve_anew(&self, guess: [f64; 3]) -> Option<(f64, u32)> {
        let mut delta = 0.0;
        let mut previous = 0.0;
        for correction in 1..=MAX_CORRECTIONS {
            let end = difference(guess, times(delta, self.q));
            let f = dot(end, end) - self.squared_length;
            delta += 0.5 * f / dot(end, self.q);
            let size = f.abs();
            if size <= 16.0 * self.round_off || size * size <= self.round_off * previous {
                return Some((delta, correction));
            }
            previous = size;
        }
        None
    }
}

impl HandWritten<3> for HandWrittenSphericalPendulum {
    #[inline(always)]
    fn advance(&mut self) -> Option<u32> {
        let q = self.q;
        let mu = extrapolated(self.multipliers);
        let at_end = expected_at_end(mu, self.multipliers[0]);
        let reciprocal = extrapolated(self.reciprocals);
        let mut w = self.w;
        w[2] -= self.fall;
        let w = difference(w, times(mu, q));
        let guess = sum(q, w);
        let f = dot(guess, guess) - self.squared_length;
        let k = dot(guess, q);
        let mut delta = f * reciprocal;
        let mut corrections = 1;
        let residual = f - delta * (2.0 * k - self.squared_length * delta);
        let is_round_off = residual.abs() <= self.round_off;
        if !is_round_off {
            delta += residual * reciprocal;
            corrections = 2;
            // The second correction leaves what the first did of its residual, or less.
            let converged = residual * residual <= self.round_off * f.abs();
            if !converged {
                (delta, corrections) = self.solve_anew(guess)?;
            }
        }
        let w = difference(w, times(delta, q));
        let end = sum(q, w);
        let mut w = difference(w, times(at_end, end));
        w[2] -= self.fall;
        let (mut w, removed) = self.without_rest(end, w);
        let is_slow = removed > LARGEST_REST * dot(w, w);
        if is_slow {
            (w, _) = self.without_rest(end, w);
        }
        if !are_finite([end, w]) {
            return None;
        }
        self.q = end;
        self.w = w;
        let [newest, second, third, _] = self.multipliers;
        self.multipliers = [mu + delta, newest, second, third];
        let [newest, second, third, _] = self.reciprocals;
        self.reciprocals = [0.5 / k, newest, second, third];
        Some(corrections)
    }

    fn q(&self) -> [f64; 3] {
        self.q
    }

    fn v(&self) -> [f64; 3] {
        self.w.map(|w| w / self.h)
    }
}
