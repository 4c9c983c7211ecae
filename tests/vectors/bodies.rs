//! Bodies in directors have the energy of rigid bodies, and their points move with them.

use evi_core::assembled::{AssembledSimulation, AssembledSystem};
use evi_core::prelude::*;
use evi_tests::largest_difference;
use nalgebra::{Rotation3, Vector3};

use crate::dense::{Kernels, Point};

/// A free body in a field that pulls at one of its points.
#[derive(MechanicalSystem, Clone, Debug)]
#[evi(
    rigid_body(body, mass = mass, center = center, inertia = [inertia[0], inertia[1], inertia[2]]),
    potential = pull.dot(body.point(hook)),
    observe(hook: body.point(hook)),
    observe(speed: der(body.point(hook))),
)]
struct Body {
    mass: f64,
    center: [f64; 3],
    inertia: Vector3<f64>,
    pull: Vector3<f64>,
    hook: [f64; 3],
}

/// Energies of about 4 by two formulas: one rounding measured.
const ROUND_OFF: f64 = 1e-15;

#[test]
fn a_turning_body_has_the_energy_of_its_inertia() {
    let (center, inertia) = (Vector3::new(0.3, -0.2, 0.5), Vector3::new(0.7, 1.1, 1.3));
    let (hook, pull) = (Vector3::new(-1.0, 0.4, 0.2), Vector3::new(0.5, 0.1, -2.0));
    let body = Body { mass: 1.7, center: center.into(), inertia, pull, hook: hook.into() };
    let frame = Rotation3::from_euler_angles(0.4, -1.1, 2.3);
    let (place, velocity) = (Vector3::new(0.2, 0.9, -0.4), Vector3::new(-0.6, 0.3, 1.2));
    let turning = Vector3::new(1.4, -0.8, 0.6);
    let directors: Vec<Vector3<f64>> = frame.matrix().column_iter().map(Vector3::from).collect();
    let with = |first: Vector3<f64>, others: &mut dyn Iterator<Item = Vector3<f64>>| -> Vec<f64> {
        std::iter::once(first).chain(others).flat_map(|vector| [vector.x, vector.y, vector.z]).collect()
    };
    let at = Point {
        t: 0.0,
        q: with(place, &mut directors.iter().copied()),
        v: with(velocity, &mut directors.iter().map(|director| turning.cross(director))),
    };
    let kernels = Kernels::of(&body, &at);

    let in_frame = frame.inverse() * turning;
    let of_center = velocity + turning.cross(&(frame * center));
    let turning_energy = 0.5 * inertia.component_mul(&in_frame).dot(&in_frame);
    let kinetic = 0.5 * body.mass * of_center.norm_squared() + turning_energy;
    let potential = pull.dot(&(place + frame * hook));
    assert!(turning_energy > 1.0, "{turning_energy}");
    let difference = kernels.lagrangian - (kinetic - potential);
    assert!(difference.abs() <= ROUND_OFF, "{difference:e}");
    // A rigid motion keeps the directors orthonormal.
    assert!(kernels.constraints.amax() <= 2.0 * f64::EPSILON, "{}", kernels.constraints);
    assert!((&kernels.jacobian * nalgebra::DVector::from_vec(at.v.clone())).amax() <= 8.0 * f64::EPSILON);
    assert_eq!(Body::CONSTRAINTS.len(), 6);
    // That is what directors are for.
    assert!(Body::STRUCTURE.mass.is_constant() && Body::STRUCTURE.has_quadratic_constraints());
    assert_eq!(Body::OBSERVABLES, ["hook[0]", "hook[1]", "hook[2]", "speed[0]", "speed[1]", "speed[2]"]);
}

const BODIES: usize = 2;

/// Bodies that hang on each other by ball joints, each of another mass, the first at the origin: its constraint holds coordinates at 0.
macro_rules! pendulum {
    ($name:ident, $n:tt) => {
        #[derive(MechanicalSystem, Clone, Debug)]
        #[evi(
            rigid_body(b[i in 0..$n], mass = m[i], center = [0.0, 0.1, half], inertia = [0.02 * m[i], j, 0.03]),
            potential = g * sum(0..$n, |i| m[i] * b[i].point([0.0, 0.1, half])[2]),
            constraint(hung: b[0][0] == [0.0, 0.0, 0.0]),
            constraint(joint[i in 1..$n]: b[i][0] == b[i - 1].point([0.0, 0.0, 2.0 * half])),
            observe(end: b[$n - 1].point([0.0, 0.0, 2.0 * half])[2]),
        )]
        struct $name {
            m: [f64; $n],
            half: f64,
            j: f64,
            g: f64,
        }

        impl $name {
            const UNEQUAL: Self = Self { m: [1.0, 0.7], half: -0.2, j: 0.025, g: 9.81 };
        }
    };
}

pendulum!(Unrolled, 2);
pendulum!(Looped, BODIES);

#[test]
fn bodies_that_are_counted_move_as_bodies_by_themselves() {
    assert_eq!(Looped::UNEQUAL.n_coordinates(), 12 * BODIES);
    assert_eq!(Looped::UNEQUAL.coordinate_name(13), "b[1, 0, 1]");
    // The first body is turned, the others go on from its end in the same attitude.
    let frame = Rotation3::from_euler_angles(0.9, 0.4, -0.3);
    let directors: Vec<f64> = frame.matrix().column_iter().flat_map(|d| [d[0], d[1], d[2]]).collect();
    let mut q = Vec::new();
    for i in 0..BODIES {
        q.extend((0..3).map(|k| -0.4 * i as f64 * directors[6 + k]));
        q.extend(&directors);
    }
    let start: [f64; 24] = q.clone().try_into().expect("twelve of each");
    let scheme = Evi::midpoint(0.01);
    let mut one = Simulation::new(Unrolled::UNEQUAL, scheme).start(start, [0.0; 24]).expect("a start");
    let mut other = AssembledSimulation::new(Looped::UNEQUAL, scheme).start(q, [0.0; 24]).expect("a start");
    one.advance_to(0.2).expect("every step");
    other.advance_to(0.2).expect("every step");
    let difference = largest_difference(one.state().q(), other.state().q());
    println!("{difference:e}, H {:e}, end {:?}", one.energy() - other.energy(), other.observe());
    assert!(largest_difference(one.state().q(), &start) > 0.05, "it moves");
    assert!(difference < 2e-15, "{difference:e}");
    assert!((one.observe()[0] - other.observe()[0]).abs() < 2e-15);
    assert!(other.constraint_error() < 1e-15, "{:e}", other.constraint_error());
}
