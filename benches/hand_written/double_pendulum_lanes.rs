//! Eight double pendulums side by side, as an expert would write their step for this scene alone: that of `double_pendulum.rs`, a pendulum per lane.
//!
//! Every pendulum has its own masses and lengths. Tests are made for all lanes at once; what a lane does not need is blended out.

use evi_core::ensemble::LaneMask;
use evi_core::scalar::{InstructionSet, LANES, LaneOperation, Lanes, Scalar};
use evi_examples::{DoublePendulum, Start};

use super::{LARGEST_REST, MAX_CORRECTIONS};

type Pair = [Lanes; 2];

/// Runs of eight double pendulums.
pub struct HandWrittenLanes {
    /// Rod vectors.
    a: Pair,
    b: Pair,
    /// Their velocities times `h`.
    wa: Pair,
    wb: Pair,
    h: f64,
    /// `h² g / 2`.
    fall: Lanes,
    /// `β`.
    mass_ratio: Lanes,
    /// `l₁²`, `l₂²`.
    squared_lengths: Pair,
    /// `β l₂²`.
    outer: Lanes,
    /// `β l₁² l₂²`.
    both: Lanes,
    /// Residuals below these are round-off: a quarter of that of `2 l²`.
    round_off: Pair,
    /// `LARGEST_REST` for energies in units of `m₂/h²` beside removed ones in units of `m₁/h²`.
    slow: Lanes,
    /// `(μ, ν)` of the last four steps, newest first.
    multipliers: [[Lanes; 4]; 2],
}

/// The rods at the end of a step, `a·b`, and `1/(β l₁² l₂² − (a·b)²)`.
struct Ends {
    a: Pair,
    b: Pair,
    cosine: Lanes,
    r: Lanes,
}

/// Half the slopes of the constraints by the multipliers, inverted but for the factor.
struct Slopes {
    adjugate: [Pair; 2],
    r: Lanes,
}

/// `a · b + c`.
#[inline(always)]
fn fma<const FUSED: bool>(a: Lanes, b: Lanes, c: Lanes) -> Lanes {
    a.times_plus::<FUSED>(b, c)
}

#[inline(always)]
fn dot<const FUSED: bool>(a: Pair, b: Pair) -> Lanes {
    fma::<FUSED>(a[0], b[0], a[1] * b[1])
}

/// The value that a cubic through the last four, newest first, predicts.
#[inline(always)]
fn extrapolated<const FUSED: bool>([newest, second, third, oldest]: [Lanes; 4]) -> Lanes {
    let old = fma::<FUSED>(Lanes::splat(6.0), second, oldest);
    fma::<FUSED>(Lanes::splat(4.0), newest + third, -old)
}

/// The multiplier of the kick at the end of a step, from those of this step and the one before.
#[inline(always)]
fn expected<const FUSED: bool>(multiplier: Lanes, previous: Lanes) -> Lanes {
    fma::<FUSED>(multiplier - previous, Lanes::splat(1.0 / 3.0), multiplier)
}

#[inline(always)]
fn sum(a: Pair, b: Pair) -> Pair {
    [a[0] + b[0], a[1] + b[1]]
}

#[inline(always)]
fn difference(a: Pair, b: Pair) -> Pair {
    [a[0] - b[0], a[1] - b[1]]
}

impl Slopes {
    /// `(δ, ε)` that removes the residual `f` of the constraints.
    #[inline(always)]
    fn correction<const FUSED: bool>(&self, f: Pair) -> Pair {
        [dot::<FUSED>(self.adjugate[0], f) * self.r, dot::<FUSED>(self.adjugate[1], f) * self.r]
    }
}

impl HandWrittenLanes {
    /// Runs from consistent starts.
    pub fn new(systems: [DoublePendulum; LANES], starts: [Start<4>; LANES], h: f64) -> Self {
        let of = |value: &dyn Fn(&DoublePendulum, &Start<4>) -> f64| {
            Lanes::new(core::array::from_fn(|lane| value(&systems[lane], &starts[lane])))
        };
        let beta = |system: &DoublePendulum| 1.0 + system.m1 / system.m2;
        let square = |x: f64| x * x;
        Self {
            a: [of(&|_, start| start.q[0]), of(&|_, start| start.q[1])],
            b: [of(&|_, start| start.q[2] - start.q[0]), of(&|_, start| start.q[3] - start.q[1])],
            wa: [of(&|_, start| h * start.v[0]), of(&|_, start| h * start.v[1])],
            wb: [
                of(&|_, start| h * (start.v[2] - start.v[0])),
                of(&|_, start| h * (start.v[3] - start.v[1])),
            ],
            h,
            fall: of(&|system, _| 0.5 * h * h * system.g),
            mass_ratio: of(&|system, _| beta(system)),
            squared_lengths: [of(&|system, _| square(system.l1)), of(&|system, _| square(system.l2))],
            outer: of(&|system, _| beta(system) * square(system.l2)),
            both: of(&|system, _| beta(system) * square(system.l1) * square(system.l2)),
            round_off: [
                of(&|system, _| 0.5 * f64::EPSILON * square(system.l1)),
                of(&|system, _| 0.5 * f64::EPSILON * square(system.l2)),
            ],
            slow: of(&|system, _| LARGEST_REST * system.m2 / system.m1),
            multipliers: [[Lanes::ZERO; 4]; 2],
        }
    }

    /// What the multipliers `(μ, ν)` add to `−wₐ` and to `w_b`.
    #[inline(always)]
    fn pull<const FUSED: bool>(&self, multipliers: Pair) -> [Pair; 2] {
        self.pull_along::<FUSED>([self.a, self.b], multipliers)
    }

    /// What the multipliers `(μ, ν)` along the rods `a`, `b` add to `−wₐ` and to `w_b`.
    #[inline(always)]
    fn pull_along<const FUSED: bool>(&self, [a, b]: [Pair; 2], [mu, nu]: Pair) -> [Pair; 2] {
        let outer = self.mass_ratio * nu;
        let along_a = [mu * a[0], mu * a[1]];
        [
            [fma::<FUSED>(-nu, b[0], along_a[0]), fma::<FUSED>(-nu, b[1], along_a[1])],
            [fma::<FUSED>(-outer, b[0], along_a[0]), fma::<FUSED>(-outer, b[1], along_a[1])],
        ]
    }

    /// Removes the velocities along the rods, and returns twice the kinetic energy that they had, in units of `m₁/h²`.
    #[inline(always)]
    fn without_rest<const FUSED: bool>(&self, ends: &Ends, wa: Pair, wb: Pair) -> (Pair, Pair, Lanes) {
        let Ends { a, b, cosine, r } = *ends;
        let rates = [dot::<FUSED>(a, wa), dot::<FUSED>(b, wb)];
        let n1 = fma::<FUSED>(self.outer, rates[0], cosine * rates[1]) * r;
        let n2 = fma::<FUSED>(self.squared_lengths[0], rates[1], cosine * rates[0]) * r;
        let [pull_a, pull_b] = self.pull_along::<FUSED>([a, b], [n1, n2]);
        let removed = fma::<FUSED>(n1, rates[0], n2 * rates[1]);
        (difference(wa, pull_a), sum(wb, pull_b), removed)
    }

    /// Residuals of the constraints and their slopes at the ends `a'`, `b'` of the rods.
    #[inline(always)]
    fn linearize<const FUSED: bool>(&self, end_a: Pair, end_b: Pair) -> (Pair, Slopes) {
        let residual = [
            dot::<FUSED>(end_a, end_a) - self.squared_lengths[0],
            dot::<FUSED>(end_b, end_b) - self.squared_lengths[1],
        ];
        let (aa, ab) = (dot::<FUSED>(end_a, self.a), dot::<FUSED>(end_a, self.b));
        let (ba, bb) = (dot::<FUSED>(end_b, self.a), self.mass_ratio * dot::<FUSED>(end_b, self.b));
        let determinant = fma::<FUSED>(aa, bb, -(ab * ba));
        (residual, Slopes { adjugate: [[bb, ab], [ba, aa]], r: Lanes::splat(0.5) / determinant })
    }

    /// Whether residuals of both constraints are.
    #[inline(always)]
    fn are_round_off(&self, left: Pair) -> LaneMask {
        let [inner, outer] = self.round_off;
        LaneMask::at_most(left[0], inner).and(LaneMask::at_most(left[1], outer))
    }

    /// `(δ, ε)` by Newton's iteration with fresh slopes for every correction, and the lanes that are found.
    #[cold]
    #[inline(never)]
    fn solve_anew<const FUSED: bool>(&self, wa: Pair, wb: Pair, wanted: LaneMask) -> (Pair, LaneMask) {
        let mut delta = [Lanes::ZERO; 2];
        let mut previous = Lanes::ZERO;
        let (mut pending, mut found) = (wanted, LaneMask::NONE);
        for _ in 0..MAX_CORRECTIONS {
            let [pull_a, pull_b] = self.pull::<FUSED>(delta);
            let end_a = sum(self.a, difference(wa, pull_a));
            let end_b = sum(self.b, sum(wb, pull_b));
            let (f, slopes) = self.linearize::<FUSED>(end_a, end_b);
            let next = sum(delta, slopes.correction::<FUSED>(f));
            delta = [pending.select(next[0], delta[0]), pending.select(next[1], delta[1])];
            let size = f[0].abs() + f[1].abs();
            let [inner, outer] = self.round_off;
            let round_off = Lanes::splat(0.5) * LaneMask::below(inner, outer).select(inner, outer);
            let done = LaneMask::at_most(size, Lanes::splat(16.0) * round_off)
                .or(LaneMask::at_most(size * size, round_off * previous))
                .and(pending);
            (found, pending) = (found.or(done), pending.without(done));
            if !pending.is_any() {
                break;
            }
            previous = size;
        }
        (delta, found)
    }

    /// Takes a step of every pendulum. Returns whether all of them have one; those that have none stay where they were.
    #[inline(always)]
    pub fn advance<const FUSED: bool>(&mut self) -> bool {
        let guess = [extrapolated::<FUSED>(self.multipliers[0]), extrapolated::<FUSED>(self.multipliers[1])];
        let at_end = [
            expected::<FUSED>(guess[0], self.multipliers[0][0]),
            expected::<FUSED>(guess[1], self.multipliers[1][0]),
        ];
        let [pull_a, pull_b] = self.pull::<FUSED>(guess);
        let wa = [self.wa[0] - pull_a[0], self.wa[1] - (self.fall + pull_a[1])];
        let wb = sum(self.wb, pull_b);
        let (f, slopes) = self.linearize::<FUSED>(sum(self.a, wa), sum(self.b, wb));
        let mut delta = slopes.correction::<FUSED>(f);
        // A correction leaves the square of what it moves the end of a rod by.
        let first = self.pull::<FUSED>(delta);
        let squares = first.map(|moved| dot::<FUSED>(moved, moved));
        let unsolved = LaneMask::ALL.without(self.are_round_off(squares));
        let (mut moved_a, mut moved_b) = (difference(wa, first[0]), sum(wb, first[1]));
        let mut failed = LaneMask::NONE;
        if unsolved.is_any() {
            let [mu, nu] = slopes.correction::<FUSED>(squares);
            let correction = [unsolved.select(mu, Lanes::ZERO), unsolved.select(nu, Lanes::ZERO)];
            let second = self.pull::<FUSED>(correction);
            (moved_a, moved_b) = (difference(moved_a, second[0]), sum(moved_b, second[1]));
            // What is left now: the square of both corrections together, less that of the first.
            let left = |i: usize| {
                let twice =
                    [first[i][0] + first[i][0] + second[i][0], first[i][1] + first[i][1] + second[i][1]];
                dot::<FUSED>(twice, second[i]).abs()
            };
            delta = sum(delta, correction);
            let wanted = unsolved.without(self.are_round_off([left(0), left(1)]));
            if wanted.is_any() {
                let (anew, found) = self.solve_anew::<FUSED>(wa, wb, wanted);
                delta = [wanted.select(anew[0], delta[0]), wanted.select(anew[1], delta[1])];
                let [pull_a, pull_b] = self.pull::<FUSED>(delta);
                let (anew_a, anew_b) = (difference(wa, pull_a), sum(wb, pull_b));
                let chosen = |anew: Pair, moved: Pair| [0, 1].map(|i| wanted.select(anew[i], moved[i]));
                (moved_a, moved_b) = (chosen(anew_a, moved_a), chosen(anew_b, moved_b));
                failed = wanted.without(found);
            }
        }
        let (wa, wb) = (moved_a, moved_b);
        let (a, b) = (sum(self.a, wa), sum(self.b, wb));

        // The end of gravity's kick, and the impulses that keep the velocities on the constraints: those that are expected, and the rest.
        let [pull_a, pull_b] = self.pull_along::<FUSED>([a, b], at_end);
        let wa = [wa[0] - pull_a[0], wa[1] - (self.fall + pull_a[1])];
        let wb = sum(wb, pull_b);
        let cosine = dot::<FUSED>(a, b);
        let r = Lanes::splat(1.0) / fma::<FUSED>(-cosine, cosine, self.both);
        let ends = Ends { a, b, cosine, r };
        let (mut wa, mut wb, removed) = self.without_rest::<FUSED>(&ends, wa, wb);
        let energy = fma::<FUSED>(
            self.mass_ratio,
            dot::<FUSED>(wa, wa),
            fma::<FUSED>(Lanes::splat(2.0), dot::<FUSED>(wa, wb), dot::<FUSED>(wb, wb)),
        );
        let slow = LaneMask::ALL.without(LaneMask::at_most(removed, self.slow * energy));
        if slow.is_any() {
            let (again_a, again_b, _) = self.without_rest::<FUSED>(&ends, wa, wb);
            wa = [slow.select(again_a[0], wa[0]), slow.select(again_a[1], wa[1])];
            wb = [slow.select(again_b[0], wb[0]), slow.select(again_b[1], wb[1])];
        }
        let all = (a[0] + a[1]) + (b[0] + b[1]) + ((wa[0] + wa[1]) + (wb[0] + wb[1]));
        let finite = LaneMask::below(all * Lanes::ZERO, Lanes::splat(1.0));
        let taken = finite.without(failed);
        for (history, (guess, delta)) in self.multipliers.iter_mut().zip(guess.into_iter().zip(delta)) {
            *history = [guess + delta, history[0], history[1], history[2]];
        }
        let is_lost = LaneMask::ALL.without(taken).is_any();
        if is_lost {
            for (kept, new) in [(&mut self.a, a), (&mut self.b, b), (&mut self.wa, wa), (&mut self.wb, wb)] {
                *kept = [taken.select(new[0], kept[0]), taken.select(new[1], kept[1])];
            }
        } else {
            (self.a, self.b, self.wa, self.wb) = (a, b, wa, wb);
        }
        !is_lost
    }

    /// Positions of one pendulum, in the scene's coordinates.
    pub fn q(&self, lane: usize) -> [f64; 4] {
        let at = |x: Lanes| x.to_array()[lane];
        let (a, b) = (self.a.map(at), self.b.map(at));
        [a[0], a[1], a[0] + b[0], a[1] + b[1]]
    }

    /// Velocities of one pendulum.
    pub fn v(&self, lane: usize) -> [f64; 4] {
        let at = |x: Lanes| x.to_array()[lane] / self.h;
        let (a, b) = (self.wa.map(at), self.wb.map(at));
        [a[0], a[1], a[0] + b[0], a[1] + b[1]]
    }
}

/// So many steps of all groups, in turn, as an operation on lanes.
struct Steps<'a> {
    groups: &'a mut [HandWrittenLanes],
    steps: u64,
}

impl LaneOperation for Steps<'_> {
    type Output = bool;

    #[inline(always)]
    fn run<const FUSED: bool>(self) -> bool {
        let mut all = true;
        for _ in 0..self.steps {
            for group in self.groups.iter_mut() {
                all &= group.advance::<FUSED>();
            }
        }
        all
    }
}

/// Takes so many steps of all groups, in turn, in the vector instructions of this machine; whether all of them were found.
pub fn advance_all(groups: &mut [HandWrittenLanes], steps: u64) -> bool {
    InstructionSet::detect().run(Steps { groups, steps })
}
