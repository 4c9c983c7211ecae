//! Springs that become rods: which members tend to the rod, which stop beside it, which blow up.
//!
//! A pendulum on a spring of stiffness `k`, 0.5 rad from rest, against RATTLE on a rod with the same steps.

use evi_core::baseline::Rattle;
use evi_core::prelude::*;
use evi_examples::{SphericalPendulum, StiffSpringPendulum};
use evi_tests::distance;

/// `2 g (1 − cos 0.5)`.
const LARGEST_VELOCITY_SQUARED: f64 = 2.402;
const H: f64 = 0.01;
const T: f64 = 2.0;

/// What separates a spring from a rod over a run.
#[derive(Clone, Copy, Debug)]
struct Separation {
    at_end: f64,
    largest: f64,
    /// Largest stretch at the ends and in the middle of the steps.
    node_stretch: f64,
    middle_stretch: f64,
}

fn length([x, y]: [f64; 2]) -> f64 {
    x.hypot(y)
}

#[track_caller]
fn separation<F: Scheme<StiffSpringPendulum>>(k: f64, h: f64, scheme: impl Fn(f64) -> F) -> Separation {
    let (sine, cosine) = 0.5_f64.sin_cos();
    let rod = Simulation::new(SphericalPendulum::UNIT, Rattle::new(h));
    let mut rod = rod.start([sine, 0.0, -cosine], [0.0; 3]).expect("a start");
    let spring = Simulation::new(StiffSpringPendulum::with_stiffness(k), scheme(h));
    let mut spring = spring.start([sine, -cosine], [0.0; 2]).expect("a start");
    let mut seen = Separation { at_end: 0.0, largest: 0.0, node_stretch: 0.0, middle_stretch: 0.0 };
    for _ in 0..(T / h).round() as u32 {
        let before = *spring.state().q();
        let after = *spring.advance().expect("a step of the spring").q();
        let [x, _, z] = *rod.advance().expect("a step of the rod").q();
        let middle = [0.5 * (before[0] + after[0]), 0.5 * (before[1] + after[1])];
        seen.at_end = distance(&after, &[x, z]);
        seen.largest = seen.largest.max(seen.at_end);
        seen.node_stretch = seen.node_stretch.max((length(after) - 1.0).abs());
        seen.middle_stretch = seen.middle_stretch.max((length(middle) - 1.0).abs());
    }
    println!("k = {k:.0e}, h√k = {:.2}: {seen:?}", h * k.sqrt());
    seen
}

/// The spring acts in the middle of a step: there it becomes a rod, and the ends of the chord stick out.
#[test]
fn the_midpoint_levels_off_beside_the_rod() {
    let sagitta = H * H * LARGEST_VELOCITY_SQUARED / 8.0;
    for k in [1e8, 1e10] {
        let seen = separation(k, H, Evi::midpoint);
        assert!((5.6e-5..5.8e-5).contains(&seen.at_end), "{seen:?}");
        // The pull of the rod is at most 1.24 times the weight.
        assert!((12.0..13.0).contains(&(seen.middle_stretch * k)), "{seen:?}");
        assert!((seen.node_stretch / sagitta - 1.0).abs() < 0.01, "{seen:?} and {sagitta:e}");
    }
    // It is an error of the method: of order 2.
    let ratio = separation(1e10, H, Evi::midpoint).largest / separation(1e10, 0.5 * H, Evi::midpoint).largest;
    assert!((ratio - 4.0).abs() < 0.05, "{ratio}");
}

/// The spring acts at the ends of a step. What separates them is the stretch of the spring, `1/k`, whatever the step size.
#[test]
fn the_trapezoid_tends_to_the_rod() {
    for k in [1e4, 1e5, 1e6, 1e7] {
        for phase in [0.25, 0.5, 1.0, 1.5] {
            let seen = separation(k, phase / f64::sqrt(k), Evi::trapezoid);
            // 25.8 to 26.2 measured: the largest one is seen at the steps only.
            assert!((25.5..26.5).contains(&(seen.largest * k)), "{seen:?}");
        }
    }
}

/// On both sides of `h √k = 2` and of `h √k = √12`.
#[test]
fn end_nodes_blow_up_beyond_their_bounds() {
    let trapezoid = |k| separation(k, H, Evi::trapezoid).largest;
    let simpson = |k| separation(k, H, Evi::simpson).largest;
    let bounded = [trapezoid(3.8e4), simpson(1.1e5), simpson(1.18e5)];
    assert!(bounded.iter().all(|separation| *separation < 1e-3), "{bounded:?}");
    let unbounded = [trapezoid(4.2e4), simpson(1.3e5), simpson(1e6)];
    assert!(unbounded.iter().all(|separation| *separation > 0.1), "{unbounded:?}");
    assert!(unbounded[2] > 1e50, "{unbounded:?}");
}
