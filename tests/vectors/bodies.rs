//! Bodies in directors have the energy of rigid bodies, and their points move with them.

use evi_core::prelude::*;
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
