//! Surfaces of section: where a function of the state changes its sign.

use crate::mechanics::{Mechanics, State};
use crate::scalar::{LANES, Lanes};
use crate::system::MechanicalSystem;

use super::lane_state::{LaneState, nothing};
use super::mask::LaneMask;

/// A surface `s(t, q, v) = 0` in the space of states, crossed from `s < 0` to `s ≥ 0` unless [`crossed`](Self::crossed) says otherwise.
///
/// A crossing is looked for between the ends of every step, on the quintic through positions, velocities and accelerations there: at it
/// positions are off by `O(h⁶)` and velocities by `O(h⁵)`, beside the error of the steps. What crosses twice in one step is not seen.
pub trait Section<S: MechanicalSystem>: Sync {
    /// Whether there is a surface at all.
    const EXISTS: bool = true;

    /// `s` of eight members.
    fn value(&self, t: Lanes, q: &S::PerCoordinate<Lanes>, v: &S::PerCoordinate<Lanes>) -> Lanes;

    /// The members that have crossed the surface in a step between these states: some of those whose `s` has changed its sign.
    #[inline(always)]
    fn crossed(&self, before: &LaneState<S>, after: &LaneState<S>) -> LaneMask {
        let [before, after] = [
            self.value(Lanes::splat(before.t), &before.q, &before.v),
            self.value(Lanes::splat(after.t), &after.q, &after.v),
        ];
        LaneMask::below(before, Lanes::ZERO).and(LaneMask::at_most(Lanes::ZERO, after))
    }
}

/// No surface.
#[derive(Clone, Copy, Debug)]
pub struct NoSection;

impl<S: MechanicalSystem> Section<S> for NoSection {
    const EXISTS: bool = false;

    fn value(&self, _t: Lanes, _q: &S::PerCoordinate<Lanes>, _v: &S::PerCoordinate<Lanes>) -> Lanes {
        Lanes::ZERO
    }
}

/// The surface of a function of configurations and velocities.
#[derive(Clone, Copy, Debug)]
pub struct Surface<F>(pub F);

impl<S, F> Section<S> for Surface<F>
where
    S: MechanicalSystem,
    F: Fn(&S::PerCoordinate<Lanes>, &S::PerCoordinate<Lanes>) -> Lanes + Sync,
{
    #[inline(always)]
    fn value(&self, _t: Lanes, q: &S::PerCoordinate<Lanes>, v: &S::PerCoordinate<Lanes>) -> Lanes {
        (self.0)(q, v)
    }
}

/// The state between two ends of a step where the section's function first has the other sign; `None` where accelerations are not determined.
pub(super) fn crossing<S: MechanicalSystem>(
    section: &impl Section<S>,
    mechanics: &Mechanics<S>,
    [start, end]: [&State<S>; 2],
) -> Option<State<S>> {
    let h = end.t - start.t;
    let [a, b] = [start, end].map(|state| {
        let found = mechanics.acceleration_with(state.t, &state.q, &state.v, &state.inputs);
        found.ok().map(|found| found.acceleration)
    });
    let (a, b) = (a?, b?);
    let at_start = LaneState::of(start.t, [start; LANES]);
    let is_below = section.value(Lanes::splat(start.t), &at_start.q, &at_start.v).to_array()[0] < 0.0;
    // Eight places at a time: every look divides the interval by nine.
    let (mut from, mut to) = (0.0, 1.0);
    for _ in 0..LOOKS {
        let places: [f64; LANES] =
            core::array::from_fn(|k| from + (to - from) * (k + 1) as f64 / (LANES + 1) as f64);
        let (mut q, mut v): (S::PerCoordinate<Lanes>, S::PerCoordinate<Lanes>) = (nothing(), nothing());
        for i in 0..S::N_COORDINATES {
            let ends = [start.q[i], end.q[i], h * start.v[i], h * end.v[i], h * h * a[i], h * h * b[i]];
            let at: [[f64; 2]; LANES] = core::array::from_fn(|k| quintic(ends, places[k]));
            let of = |order: usize| Lanes::new(at.map(|both| both[order]));
            (q[i], v[i]) = (of(0), of(1) * Lanes::splat(1.0 / h));
        }
        let times = Lanes::new(places.map(|place| start.t + place * h));
        let values = section.value(times, &q, &v).to_array();
        let crossed = values.iter().position(|value| (*value < 0.0) != is_below).unwrap_or(LANES);
        let (lower, upper) = (from, to);
        from = if crossed == 0 { lower } else { places[crossed - 1] };
        to = if crossed == LANES { upper } else { places[crossed] };
    }
    let mut state = end.clone();
    state.t = start.t + to * h;
    for i in 0..S::N_COORDINATES {
        let ends = [start.q[i], end.q[i], h * start.v[i], h * end.v[i], h * h * a[i], h * h * b[i]];
        let [q, rate] = quintic(ends, to);
        (state.q[i], state.v[i]) = (q, rate / h);
    }
    state.p = S::lagrangian_gradient(&mechanics.constants, state.t, &state.q, &state.v).momentum;
    Some(state)
}

/// `9¹⁷ > 2⁵³`.
const LOOKS: usize = 17;

/// Value and rate at `τ` of the polynomial of degree five with these values, rates and second derivatives at 0 and 1.
fn quintic([x0, x1, v0, v1, a0, a1]: [f64; 6], tau: f64) -> [f64; 2] {
    let rest = x1 - x0 - v0 - 0.5 * a0;
    let rate = v1 - v0 - a0;
    let bend = a1 - a0;
    let cubic = 10.0 * rest - 4.0 * rate + 0.5 * bend;
    let quartic = -15.0 * rest + 7.0 * rate - bend;
    let fifth = 6.0 * rest - 3.0 * rate + 0.5 * bend;
    [
        x0 + tau * (v0 + tau * (0.5 * a0 + tau * (cubic + tau * (quartic + tau * fifth)))),
        v0 + tau * (a0 + tau * (3.0 * cubic + tau * (4.0 * quartic + tau * 5.0 * fifth))),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_quintic_is_exact_for_polynomials_of_degree_five() {
        let x = |t: f64| 0.3 - t + 2.0 * t.powi(2) - 0.7 * t.powi(3) + 0.2 * t.powi(4) + 1.1 * t.powi(5);
        let v = |t: f64| -1.0 + 4.0 * t - 2.1 * t.powi(2) + 0.8 * t.powi(3) + 5.5 * t.powi(4);
        let a = |t: f64| 4.0 - 4.2 * t + 2.4 * t.powi(2) + 22.0 * t.powi(3);
        for tau in [0.0, 0.2, 0.55, 1.0] {
            let [value, rate] = quintic([x(0.0), x(1.0), v(0.0), v(1.0), a(0.0), a(1.0)], tau);
            assert!((value - x(tau)).abs() < 1e-14 && (rate - v(tau)).abs() < 2e-14, "{tau}");
        }
    }
}
