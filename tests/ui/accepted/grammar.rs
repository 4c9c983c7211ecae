//! Every form of the grammar; the emitted code warns nowhere.

#![deny(warnings, missing_docs, unused, nonstandard_style, future_incompatible, rust_2018_idioms)]
#![deny(trivial_casts, trivial_numeric_casts, unused_qualifications, unreachable_pub, single_use_lifetimes)]

use evi_core::prelude::*;

/// A constant of the caller.
const STIFFNESS: f64 = 3.0;
/// A constant that is an integer.
const COUNT: u32 = 2;

mod constants {
    pub(super) const RATIO: f32 = 0.5;
}

/// The items spread over several attributes, with trailing commas.
#[derive(MechanicalSystem, Clone, Debug)]
#[evi(coordinates(x, y,),)]
#[evi(let speed_squared = der(x).powi(2) + der(y).powi(2),)]
#[evi(kinetic = 0.5 * mass * speed_squared)]
#[evi(potential = mass * gravity * y, constraint(rod: x.powi(2) + y.powi(2) == length.powi(2)),)]
pub struct Attributes {
    /// In kilograms.
    pub mass: f64,
    /// In metres.
    pub length: f64,
    /// In metres per second squared.
    pub gravity: f64,
}

/// Without parameters.
#[derive(MechanicalSystem)]
#[evi(coordinates(x), lagrangian = 0.5 * der(x).powi(2) - 0.5 * x.powi(2))]
pub struct Unit;

/// Without parameters, with braces.
#[derive(MechanicalSystem)]
#[evi(coordinates(x), lagrangian = 0.5 * der(x).powi(2))]
pub struct Braces {}

/// Constants: a path, a name in capitals, an integer.
#[derive(MechanicalSystem)]
#[evi(
    coordinates(x),
    kinetic = 0.5 * der(x).powi(2),
    potential = STIFFNESS * (std::f64::consts::PI * x).cos() + core::f64::consts::E + COUNT * constants::RATIO * x,
)]
pub struct Constants;

/// The time, in the potential and in a constraint.
#[derive(MechanicalSystem)]
#[evi(
    coordinates(x, y),
    kinetic = 0.5 * (der(x).powi(2) + der(y).powi(2)),
    potential = x * t.sin(),
    constraint(moving: y == (2.0 * t).cos()),
    constraint(moving_again: y == (2.0 * t).cos()),
)]
pub struct Time;

/// Blocks with `let`, and integers as numbers.
#[derive(MechanicalSystem)]
#[evi(
    coordinates(x, y),
    let r_squared = { let a = x * x; let b = { let y = 2 * y; y * y / 4 }; a + b },
    kinetic = { let m = 2; m * (der(x).powi(2) + der((y)).powi(2)) / 2 },
    potential = -(r_squared) + x / 3 - 4 * 1_0.0_e-1f64,
    constraint(circle: { let r = r_squared.sqrt(); r } == (1)),
)]
pub struct Blocks;

/// Every function.
#[derive(MechanicalSystem)]
#[evi(
    coordinates(x),
    kinetic = 0.5 * der(x).powi(2) * (2.0 + x.sin()),
    potential = x.powi(3) + x.powi(-2) + x.powf(1.5) + x.sqrt() + x.cos() + x.tan() + x.exp() + x.ln()
              + (0.1 * x).asin() + (0.1 * x).acos() + x.atan() + x.atan2(2.0) + x.sinh() + x.cosh() + x.tanh() + x.abs(),
)]
pub struct Functions;

/// Forces, inputs, frequencies and observed quantities; keywords as names.
#[derive(MechanicalSystem)]
#[evi(
    coordinates(x, y, angle),
    input(force, observe,),
    input(torque),
    let lever = { let arm = 2.0; arm * angle.sin() },
    let power = force * der(x) + torque,
    kinetic = 0.5 * input * (der(x).powi(2) + der(y).powi(2) + der(angle).powi(2)),
    potential = -lever,
    dissipation = { let rate = der(x) - der(y); 0.5 * rate.powi(2) } + (0.25 * t) * der(angle).powi(4),
    force(x: force * lever + power / COUNT),
    force(angle: { let torque = torque + t.sin(); torque } * STIFFNESS),
    frequency(x, y: (STIFFNESS / input).sqrt()),
    frequency(angle: 2),
    observe(height: std::f64::consts::PI + y),
    observe(x: power * observe),
)]
pub struct Forces {
    /// A mass by a name that is a keyword of the grammar.
    pub input: f64,
}

/// A frequency that is a number, a force that is constant.
#[derive(MechanicalSystem)]
#[evi(coordinates(x), lagrangian = 0.5 * der(x).powi(2), frequency(x: 1.5), force(x: 1.0))]
pub struct Numbers;

/// Without motion, a dissipation may still depend on place and time.
#[derive(MechanicalSystem)]
#[evi(coordinates(x), lagrangian = 0.5 * der(x).powi(2), dissipation = (x * t).cos() * der(x).exp())]
pub struct Dissipation;

fn main() {
    let scheme = Evi::simpson(0.01).scene_frequencies().allow_soft_modes();
    let mut run = Simulation::new(Forces { input: 2.0 }, scheme).start([1.0, 0.0, 0.5], [0.0; 3]).unwrap();
    run.set_inputs([1.0, 2.0, 3.0]);
    assert_eq!(run.integrate(0.1).unwrap().series("x").unwrap().len(), 11);
    assert_eq!(Forces::INPUTS, ["force", "observe", "torque"]);
    let scheme = Evi::simpson(0.01).scene_frequencies().allow_soft_modes();
    assert!(Simulation::new(Numbers, scheme).start([1.0], [0.0]).unwrap().advance().is_ok());
    assert!(Simulation::new(Dissipation, Evi::midpoint(0.01)).start([1.0], [0.0]).unwrap().advance().is_ok());
    let system = Attributes { mass: 1.0, length: 1.0, gravity: 9.81 };
    let mut run = Simulation::new(system, Evi::midpoint(0.01)).start([1.0, 0.0], [0.0; 2]).unwrap();
    assert_eq!(run.integrate(0.1).unwrap().last().q().len(), 2);
    assert_eq!((Unit::PARAMETERS.len(), Braces::N_COORDINATES, Constants::N_CONSTRAINTS), (0, 1, 0));
    assert_eq!((Time::CONSTRAINTS, Blocks::CONSTRAINTS.len()), (&["moving", "moving_again"][..], 1));
    let mut run = Simulation::new(Functions, Evi::midpoint(0.01)).start([1.0], [0.0]).unwrap();
    assert!(run.integrate(0.1).unwrap().last().q()[0].is_finite());
}
