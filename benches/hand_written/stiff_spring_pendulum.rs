//! The stiff spring pendulum. The unknown of the midpoint step is `s = ½(q₁ − q₀)`, the midpoint is `x = q₀ + s`:
//!
//! ```text
//! s − f + κ (1 − l/r) x = 0      f = ½ w − ¼ h² g ŷ,  κ = h² k / 4m,  r = |x|,  q₁ = q₀ + 2s,  w₁ = 4s − w
//! ```
//!
//! The derivative is `1 + κ` along `x` and `τ = 1 + κ (1 − l/r)` across: its inverse needs no 2 × 2 solve. Newton begins at the
//! free flight `s = f`, and whether another correction is needed is judged beside the chain.

use evi_examples::{Start, StiffSpringPendulum};

use super::{HandWritten, MAX_CORRECTIONS, are_finite, difference, dot, sum, times};

/// A run of the stiff spring pendulum by Newton's iteration in the plane, as for any potential `V(r)`.
pub struct HandWrittenSpringPendulum {
    q: [f64; 2],
    /// Velocity times `h`.
    w: [f64; 2],
    h: f64,
    /// `¼ h² g`.
    fall: f64,
    /// `κ`.
    stiffness: f64,
    /// `κ l`.
    pull: f64,
    /// `1 / (1 + κ)`.
    radial: f64,
    /// A residual below this is round-off.
    round_off: f64,
}

impl HandWrittenSpringPendulum {
    /// A run from any start.
    pub fn new(system: &StiffSpringPendulum, start: Start<2>, h: f64) -> Self {
        let stiffness = 0.25 * h * h * system.k / system.m;
        Self {
            q: start.q,
            w: start.v.map(|v| h * v),
            h,
            fall: 0.25 * h * h * system.g,
            stiffness,
            pull: stiffness * system.l,
            radial: 1.0 / (1.0 + stiffness),
            round_off: 4.0 * f64::EPSILON * system.l * (1.0 + stiffness),
        }
    }

    /// The residual at `s`, with `x`, `1/r` and `τ − 1`.
    #[inline(always)]
    fn residual(&self, free: [f64; 2], s: [f64; 2]) -> ([f64; 2], [f64; 2], f64, f64) {
        let x = sum(self.q, s);
        let inverse_r = 1.0 / dot(x, x).sqrt();
        let stretch = self.stiffness - self.pull * inverse_r;
        (sum(difference(s, free), times(stretch, x)), x, inverse_r, stretch)
    }

    /// `s` after a correction.
    #[inline(always)]
    fn corrected(&self, free: [f64; 2], s: [f64; 2]) -> [f64; 2] {
        let (residual, x, inverse_r, stretch) = self.residual(free, s);
        let across = 1.0 / (1.0 + stretch);
        let normal = times(inverse_r, x);
        let along = (self.radial - across) * dot(normal, residual);
        difference(s, sum(times(across, residual), times(along, normal)))
    }
}

impl HandWritten<2> for HandWrittenSpringPendulum {
    #[inline(always)]
    fn advance(&mut self) -> Option<u32> {
        let free = [0.5 * self.w[0], 0.5 * self.w[1] - self.fall];
        let mut s = self.corrected(free, free);
        let mut corrections = 1;
        loop {
            let ([x, y], ..) = self.residual(free, s);
            if x.abs() + y.abs() <= self.round_off {
                break;
            }
            if corrections == MAX_CORRECTIONS {
                return None;
            }
            s = self.corrected(free, s);
            corrections += 1;
        }
        let q = sum(self.q, times(2.0, s));
        let w = difference(times(4.0, s), self.w);
        if !are_finite([q, w]) {
            return None;
        }
        (self.q, self.w) = (q, w);
        Some(corrections)
    }

    fn q(&self) -> [f64; 2] {
        self.q
    }

    fn v(&self) -> [f64; 2] {
        self.w.map(|w| w / self.h)
    }
}

/// The same step without an iteration: for a *linear* spring that is fixed at the *origin*, the midpoint lies on the line
/// through `q₀ + f`, at the radius `(|q₀ + f| + κ l) / (1 + κ)`. No other potential permits this.
pub struct ClosedFormSpringPendulum {
    q: [f64; 2],
    w: [f64; 2],
    h: f64,
    fall: f64,
    /// `κ / (1 + κ)`.
    stiffness: f64,
    /// `κ l / (1 + κ)`.
    pull: f64,
}

impl ClosedFormSpringPendulum {
    /// A run from any start.
    pub fn new(system: &StiffSpringPendulum, start: Start<2>, h: f64) -> Self {
        let stiffness = 0.25 * h * h * system.k / system.m;
        Self {
            q: start.q,
            w: start.v.map(|v| h * v),
            h,
            fall: 0.25 * h * h * system.g,
            stiffness: stiffness / (1.0 + stiffness),
            pull: system.l * stiffness / (1.0 + stiffness),
        }
    }
}

impl HandWritten<2> for ClosedFormSpringPendulum {
    #[inline(always)]
    fn advance(&mut self) -> Option<u32> {
        let free = [0.5 * self.w[0], 0.5 * self.w[1] - self.fall];
        let x = sum(self.q, free);
        let s = difference(free, times(self.stiffness - self.pull / dot(x, x).sqrt(), x));
        let q = sum(self.q, times(2.0, s));
        let w = difference(times(4.0, s), self.w);
        if !are_finite([q, w]) {
            return None;
        }
        (self.q, self.w) = (q, w);
        Some(0)
    }

    fn q(&self) -> [f64; 2] {
        self.q
    }

    fn v(&self) -> [f64; 2] {
        self.w.map(|w| w / self.h)
    }
}
