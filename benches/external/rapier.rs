//! rapier2d, a physics engine for games: what a step of a hanging chain costs there.

/// Why there is no time.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("built without rapier2d: the feature `rapier` brings it")]
pub struct NotBuilt;

/// Nanoseconds per step of a chain of `bodies` masses `1/bodies` on revolute joints `1/bodies` apart, at rest from the horizontal, with the crate's
/// solver of impulses in single precision: the shortest of `repetitions` runs of `steps` steps of size `h`.
///
/// # Errors
/// [`NotBuilt`] without the feature `rapier`.
#[cfg(feature = "rapier")]
pub fn rapier_chain(bodies: usize, h: f64, steps: u32, repetitions: u32) -> Result<f64, NotBuilt> {
    let run = || {
        let mut world = chain(bodies, h as f32);
        // Not among those timed: it allocates.
        world.step();
        let clock = std::time::Instant::now();
        (0..steps).for_each(|_| world.step());
        1e9 * clock.elapsed().as_secs_f64() / f64::from(steps)
    };
    Ok((0..repetitions).map(|_| run()).fold(f64::INFINITY, f64::min))
}

/// Nanoseconds per step.
///
/// # Errors
/// [`NotBuilt`], always: this build has not the feature `rapier`.
#[cfg(not(feature = "rapier"))]
pub fn rapier_chain(_bodies: usize, _h: f64, _steps: u32, _repetitions: u32) -> Result<f64, NotBuilt> {
    Err(NotBuilt)
}

#[cfg(feature = "rapier")]
fn chain(bodies: usize, h: f32) -> rapier2d::prelude::PhysicsWorld {
    use rapier2d::prelude::*;
    // A body without moment of inertia does not turn with its rod.
    const SHARE_OF_INERTIA: f32 = 0.01;
    let share = 1.0 / bodies as f32;
    let inertia = SHARE_OF_INERTIA * share.powi(3);
    let mut world = PhysicsWorld::new();
    world.integration_parameters.dt = h;
    let mut before = world.insert_body(RigidBodyBuilder::fixed());
    for index in 1..=bodies {
        let body = RigidBodyBuilder::dynamic()
            .translation(Vector::new(index as f32 * share, 0.0))
            .can_sleep(false)
            .additional_mass_properties(MassProperties::new(Vector::ZERO, share, inertia));
        let body = world.insert_body(body);
        let joint =
            RevoluteJointBuilder::new().contacts_enabled(false).local_anchor2(Vector::new(-share, 0.0));
        world.insert_impulse_joint(before, body, joint);
        before = body;
    }
    world
}
