//! What several tests need: orders of convergence, an integrator that shares nothing with evi-core, certified
//! reference numbers, scenes beside the gallery, and random numbers that are the same on every machine.

pub mod agreement;
pub mod conservation;
pub mod convergence;
pub mod galerkin;
pub mod matrix_action;
pub mod motions;
pub mod references;
pub mod scenes;
pub mod tangent;
pub mod trusses;

/// Least-squares slope of `ln error` against `ln h`: the order that a sequence of runs shows.
///
/// # Panics
/// When the errors prove nothing: fewer than four of them, or one that is zero or not finite.
#[track_caller]
pub fn observed_order(steps: &[f64], errors: &[f64]) -> f64 {
    assert!(steps.len() >= 4 && steps.len() == errors.len(), "an order needs four points or more");
    assert!(errors.iter().all(|error| error.is_finite() && *error > 0.0), "vacuous errors: {errors:?}");
    let n = steps.len() as f64;
    let abscissas = steps.iter().map(|h| h.ln());
    let ordinates = errors.iter().map(|error| error.ln());
    let (mean_x, mean_y) = (abscissas.clone().sum::<f64>() / n, ordinates.clone().sum::<f64>() / n);
    let covariance: f64 = abscissas.clone().zip(ordinates).map(|(x, y)| (x - mean_x) * (y - mean_y)).sum();
    let variance: f64 = abscissas.map(|x| (x - mean_x).powi(2)).sum();
    covariance / variance
}

/// Euclidean distance.
pub fn distance(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len(), "points of different dimension");
    a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
}

/// Largest `|aᵢ − bᵢ|`; NaN if one is.
pub fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len(), "points of different dimension");
    let larger = |largest: f64, x: f64| if x <= largest { largest } else { x };
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, larger)
}

/// Positions and velocities at `t_end` by Kutta's method of order 4 from time 0, for accelerations written by
/// hand: independent of the derive and of every integrator of evi-core.
pub fn integrate_by_hand<const N: usize>(
    acceleration: impl Fn(f64, &[f64; N], &[f64; N]) -> [f64; N],
    (mut q, mut v): ([f64; N], [f64; N]),
    t_end: f64,
    steps: u32,
) -> ([f64; N], [f64; N]) {
    let h = t_end / f64::from(steps);
    let moved = |x: &[f64; N], length: f64, rate: &[f64; N]| -> [f64; N] {
        core::array::from_fn(|i| x[i] + length * rate[i])
    };
    for step in 0..steps {
        let t = f64::from(step) * h;
        let (v1, a1) = (v, acceleration(t, &q, &v));
        let v2 = moved(&v, 0.5 * h, &a1);
        let a2 = acceleration(t + 0.5 * h, &moved(&q, 0.5 * h, &v1), &v2);
        let v3 = moved(&v, 0.5 * h, &a2);
        let a3 = acceleration(t + 0.5 * h, &moved(&q, 0.5 * h, &v2), &v3);
        let v4 = moved(&v, h, &a3);
        let a4 = acceleration(t + h, &moved(&q, h, &v3), &v4);
        for i in 0..N {
            q[i] += h * (v1[i] + 2.0 * (v2[i] + v3[i]) + v4[i]) / 6.0;
            v[i] += h * (a1[i] + 2.0 * (a2[i] + a3[i]) + a4[i]) / 6.0;
        }
    }
    (q, v)
}

/// Positions and velocities at `t_end` from time 0 by extrapolation of Gragg's modified midpoint rule to order 16 (Hairer, Nørsett,
/// Wanner, Solving ODEs I, sec. II.9), for accelerations written by hand: a reference at round-off.
pub fn extrapolate_by_hand<const N: usize>(
    acceleration: impl Fn(f64, &[f64; N], &[f64; N]) -> [f64; N],
    start: ([f64; N], [f64; N]),
    t_end: f64,
    steps: u32,
) -> ([f64; N], [f64; N]) {
    /// Substeps of the columns.
    const SUBSTEPS: [u32; 8] = [2, 4, 6, 8, 10, 12, 14, 16];
    type Point<const N: usize> = ([f64; N], [f64; N]);
    let plus = |(q, v): &Point<N>, factor: f64, (dq, dv): &Point<N>| -> Point<N> {
        (core::array::from_fn(|i| q[i] + factor * dq[i]), core::array::from_fn(|i| v[i] + factor * dv[i]))
    };
    let rate = |t: f64, (q, v): &Point<N>| -> Point<N> { (*v, acceleration(t, q, v)) };
    let h = t_end / f64::from(steps);
    // The increment of a step: extrapolated itself, so that the roundings of the columns are those of a small number.
    let increment = |t: f64, start: &Point<N>, n: u32| -> Point<N> {
        let substep = h / f64::from(n);
        let nothing = ([0.0; N], [0.0; N]);
        let (mut previous, mut current) = (nothing, plus(&nothing, substep, &rate(t, start)));
        for k in 1..n {
            let at = rate(t + f64::from(k) * substep, &plus(start, 1.0, &current));
            (previous, current) = (current, plus(&previous, 2.0 * substep, &at));
        }
        // Gragg's smoothing.
        let at_end = rate(t + h, &plus(start, 1.0, &current));
        let mean = plus(&current, 1.0, &previous);
        plus(&nothing, 0.5, &plus(&mean, substep, &at_end))
    };
    let mut point = start;
    for step in 0..steps {
        let t = f64::from(step) * h;
        let mut row: Vec<Point<N>> = Vec::new();
        for (j, &n) in SUBSTEPS.iter().enumerate() {
            let mut column = increment(t, &point, n);
            for k in 0..j {
                let ratio = (f64::from(n) / f64::from(SUBSTEPS[j - 1 - k])).powi(2);
                let coarser = core::mem::replace(&mut row[k], column);
                let difference = plus(&column, -1.0, &coarser);
                column = plus(&column, 1.0 / (ratio - 1.0), &difference);
            }
            row.push(column);
        }
        point = plus(&point, 1.0, &row[SUBSTEPS.len() - 1]);
    }
    point
}

/// SplitMix64 (Steele, Lea, Flood, OOPSLA 2014): the same numbers everywhere for a seed.
#[derive(Clone, Debug)]
pub struct Random {
    state: u64,
}

impl Random {
    /// The sequence of `seed`.
    pub const fn new(seed: u64) -> Self {
        Self { state: seed }
    }

    /// Uniform in `[low, high)`.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        /// One step of a 53-bit number in `[0, 1)`.
        const STEP: f64 = 1.0 / (1_u64 << 53) as f64;
        low + (high - low) * ((self.bits() >> 11) as f64 * STEP)
    }

    /// `N` numbers, uniform in `[low, high)`.
    pub fn array<const N: usize>(&mut self, low: f64, high: f64) -> [f64; N] {
        core::array::from_fn(|_| self.between(low, high))
    }

    fn bits(&mut self) -> u64 {
        self.state = self.state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut bits = self.state;
        bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        bits ^ (bits >> 31)
    }
}
