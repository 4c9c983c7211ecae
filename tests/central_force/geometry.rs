//! What steps keep that are found by the distance alone: the symplectic form, time reversal, momenta.

use evi_core::prelude::*;
use evi_examples::{Kepler, Start};
use evi_tests::conservation::{angular_momentum, largest_change, there_and_back};

use crate::paths::{BOND, DUMBBELL, OFF_CENTRE, ORBIT, STARS, SWING, TUMBLE, TURN};

/// `(q, M v)` after one step, as one vector, by differences of `(q, M v)` before; columns are directions.
fn derivative<const N: usize, S>(system: S, masses: [f64; N], h: f64, start: Start<N>) -> Vec<Vec<f64>>
where
    S: MechanicalSystem<PerCoordinate<f64> = [f64; N]> + Copy,
{
    /// The cube root of ε: what is cut off of central differences is then what is rounded of them, some 1e-10.
    const DISTANCE: f64 = 6e-6;
    let end = |direction: usize, distance: f64| -> Vec<f64> {
        let Start { mut q, mut v } = start;
        if direction < N {
            q[direction] += distance;
        } else {
            v[direction - N] += distance / masses[direction - N];
        }
        let mut run = Simulation::new(system, Evi::midpoint(h)).start(q, v).expect("a start");
        let state = run.advance().expect("a step");
        state.q().iter().chain(state.p()).copied().collect()
    };
    let column = |direction| {
        let (ahead, behind) = (end(direction, DISTANCE), end(direction, -DISTANCE));
        ahead.iter().zip(&behind).map(|(a, b)| (a - b) / (2.0 * DISTANCE)).collect()
    };
    (0..2 * N).map(column).collect()
}

/// `DΨᵀ J DΨ = J` of one step.
#[track_caller]
fn check_symplecticity<const N: usize, S>(system: S, masses: [f64; N], h: f64, start: Start<N>)
where
    S: MechanicalSystem<PerCoordinate<f64> = [f64; N]> + Copy,
{
    let columns = derivative(system, masses, h, start);
    let form = |a: &[f64], b: &[f64]| (0..N).map(|i| a[i] * b[N + i] - a[N + i] * b[i]).sum::<f64>();
    let (mut defect, mut turned) = (0.0_f64, 0.0_f64);
    for (i, a) in columns.iter().enumerate() {
        for (k, b) in columns.iter().enumerate() {
            let expected = f64::from(i8::from(k == i + N)) - f64::from(i8::from(i == k + N));
            defect = defect.max((form(a, b) - expected).abs());
        }
        turned = turned.max((a[i] - 1.0).abs());
    }
    println!("{}: {defect:.1e}", core::panic::Location::caller());
    assert!(turned > 1e-3, "vacuous: the step is all but the identity");
    // 2e-10 measured.
    assert!(defect < 1e-9, "the form changes by {defect:e}");
}

#[test]
fn steps_are_symplectic() {
    check_symplecticity(OFF_CENTRE, [OFF_CENTRE.m; 2], 0.1, SWING);
    let [first, second] = [[DUMBBELL.m1; 3], [DUMBBELL.m2; 3]];
    let masses = core::array::from_fn(|i| if i < 3 { first[i] } else { second[i - 3] });
    check_symplecticity(DUMBBELL, masses, 0.1, TUMBLE);
    check_symplecticity(STARS, [STARS.m1, STARS.m1, STARS.m2, STARS.m2], 0.1, ORBIT);
    check_symplecticity(BOND, [BOND.m; 3], 0.1, TURN);
}

#[test]
fn steps_back_return_to_the_start() {
    #[track_caller]
    fn check<const N: usize, S>(system: S, start: Start<N>)
    where
        S: MechanicalSystem<PerCoordinate<f64> = [f64; N]> + Copy,
    {
        let distance = there_and_back(system, Evi::midpoint, start, 0.02, 50);
        // Velocities of 2, rounded in 100 steps and amplified by the motion: 46 ε of the dumbbell measured.
        assert!(distance <= 128.0 * f64::EPSILON, "misses the start by {distance:e}");
    }
    check(OFF_CENTRE, SWING);
    check(DUMBBELL, TUMBLE);
    check(STARS, ORBIT);
    check(BOND, TURN);
}

#[test]
fn momenta_are_kept_to_round_off() {
    const STEPS: usize = 10_000;
    /// Momenta of size 2 on an arm of 1, rounded at random in every step: `ε · 2 · √10⁴`; measured 0.4 of it.
    const ROUND_OFF: f64 = 2.0 * 100.0 * f64::EPSILON;
    let kepler = Kepler { m: 1.7, mu: 1.2 };
    let around = Start { q: [0.4, 0.1], v: [-0.2, 2.0] };
    let of_kepler =
        largest_change(kepler, Evi::midpoint(0.01), around, STEPS, |q, p| angular_momentum(q, p, 0));
    let of_stars = |quantity: fn(&[f64], &[f64]) -> f64| {
        largest_change(STARS, Evi::midpoint(0.01), ORBIT, STEPS, quantity)
    };
    let of_bond = largest_change(BOND, Evi::midpoint(0.01), TURN, STEPS, |q, p| angular_momentum(q, p, 0));
    let changes = [
        of_kepler,
        of_stars(|_, p| p[1] + p[3]),
        of_bond,
        // The stars move away from the origin, so that the arm grows to 14.
        of_stars(|q, p| angular_momentum(q, p, 0) + angular_momentum(q, p, 2)) / 14.0,
    ];
    println!("{changes:?}");
    assert!(changes.iter().all(|change| *change <= ROUND_OFF), "{changes:?}");
}
