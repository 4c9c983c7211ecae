//! Scenes that describe one mechanism in different coordinates have one motion.

use core::array::from_fn;

use evi_core::prelude::*;
use evi_examples::{
    DoublePendulum, DoublePendulumAngles, GRAVITY, Pendulum, PendulumCartesian, Scene, Start,
};
use evi_tests::largest_difference;

const H: f64 = 0.0125;
const STEPS: usize = 160;

/// Places and velocities along a run of a member of order 8.
fn motion<const N: usize, S>(system: S, start: Start<N>) -> Vec<([f64; N], [f64; N])>
where
    S: Scene + MechanicalSystem<PerCoordinate<f64> = [f64; N]>,
{
    let scheme = Galerkin::<4>::new(H).compensated();
    let mut run = Simulation::new(system, scheme).start(start.q, start.v).expect("consistent");
    (0..STEPS)
        .map(|_| {
            let state = run.advance().expect("solvable");
            (*state.q(), *state.v())
        })
        .collect()
}

/// A rod of length `l` at an angle: place and velocity of its end, seen from its pivot.
fn rod(l: f64, angle: f64, rate: f64) -> [[f64; 2]; 2] {
    let (sine, cosine) = angle.sin_cos();
    [[l * sine, -l * cosine], [l * cosine * rate, l * sine * rate]]
}

/// Two motions agree in positions and velocities to `bound`, and move.
#[track_caller]
fn check<const N: usize>(a: &[([f64; N], [f64; N])], b: &[([f64; N], [f64; N])], bound: f64) {
    let pairs = || a.iter().zip(b);
    let larger = |largest: f64, x: f64| if x <= largest { largest } else { x };
    let positions = pairs().map(|(a, b)| largest_difference(&a.0, &b.0)).fold(0.0, larger);
    let velocities = pairs().map(|(a, b)| largest_difference(&a.1, &b.1)).fold(0.0, larger);
    let travelled = a.iter().map(|(q, _)| largest_difference(q, &a[0].0)).fold(0.0, larger);
    println!("positions {positions:.1e}, velocities {velocities:.1e} of a motion of {travelled:.1}");
    assert!(travelled > 0.5 && a.len() == b.len(), "vacuous");
    assert!(positions <= bound && velocities <= bound, "{positions:e}, {velocities:e}");
}

#[test]
fn the_pendulum_in_its_angle_and_in_cartesian_coordinates() {
    let (m, l, g) = (1.3, 0.7, GRAVITY);
    let (in_angle, cartesian) = (Pendulum { m, l, g }, PendulumCartesian { m, l, g });
    let from_angle: Vec<_> = motion(in_angle, in_angle.at_rest(2.5))
        .iter()
        .map(|([angle], [rate])| rod(l, *angle, *rate).into())
        .collect();
    // Round-off of velocities up to 7 m/s: 5.7e-14 measured.
    check(&from_angle, &motion(cartesian, cartesian.at_rest(2.5)), 1e-13);
}

#[test]
fn the_double_pendulum_in_its_angles_and_in_cartesian_coordinates() {
    let (m1, m2, l1, l2, g) = (1.3, 0.4, 0.7, 1.1, GRAVITY);
    let (in_angles, cartesian) =
        (DoublePendulumAngles { m1, m2, l1, l2, g }, DoublePendulum { m1, m2, l1, l2, g });
    let from_angles: Vec<_> = motion(in_angles, Start { q: [1.0, -2.0], v: [0.0; 2] })
        .iter()
        .map(|(angles, rates)| {
            let (inner, outer) = (rod(l1, angles[0], rates[0]), rod(l2, angles[1], rates[1]));
            let [q, v] =
                from_fn(|k| [inner[k][0], inner[k][1], inner[k][0] + outer[k][0], inner[k][1] + outer[k][1]]);
            (q, v)
        })
        .collect();
    // The errors of order 8 on either side: 1.4e-12 measured in the velocities.
    check(&from_angles, &motion(cartesian, cartesian.at_angles(1.0, -2.0)), 2e-12);
}
