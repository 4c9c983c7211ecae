//! `der` of something else than a coordinate.

use evi_core::prelude::*;

#[derive(MechanicalSystem)]
#[evi(coordinates(x), kinetic = 0.5 * der(x).powi(2) + der(mass), potential = 0.0)]
struct Parameter { mass: f64 }

#[derive(MechanicalSystem)]
#[evi(coordinates(theta), kinetic = 0.5 * der(theta).powi(2) + der(tehta) + der(phi), potential = 0.0)]
struct Unknown;

#[derive(MechanicalSystem)]
#[evi(coordinates(x), let square = x.powi(2), kinetic = 0.5 * der(x).powi(2) + der(square) + der(t), potential = 0.0)]
struct Shared;

#[derive(MechanicalSystem)]
#[evi(coordinates(x), kinetic = 0.5 * der(x).powi(2) + der(), potential = 0.0)]
struct Nothing;

#[derive(MechanicalSystem)]
#[evi(coordinates(x, y), kinetic = 0.5 * der(x, y).powi(2), potential = 0.0)]
struct Two;

#[derive(MechanicalSystem)]
#[evi(coordinates(x), kinetic = 0.5 * der(x.powi(2)).powi(2), potential = 0.0)]
struct Expression;

#[derive(MechanicalSystem)]
#[evi(coordinates(x), kinetic = 0.5 * der(der(x)).powi(2), potential = 0.0)]
struct Second;

#[derive(MechanicalSystem)]
#[evi(coordinates(x), kinetic = 0.5 * der.powi(2), potential = 0.0)]
struct WithoutParentheses;

fn main() {}
