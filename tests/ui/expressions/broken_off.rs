//! Expressions that do not parse.

use evi_core::prelude::*;

#[derive(MechanicalSystem)]
#[evi(coordinates(x), kinetic = 0.5 * der(x).powi(2) +, potential = 0.0)]
struct BreaksOff;

#[derive(MechanicalSystem)]
#[evi(coordinates(x), kinetic = 0.5 * der(x).powi(2), potential =)]
struct Nothing;

#[derive(MechanicalSystem)]
#[evi(coordinates(x), kinetic = 0.5 * der(x).powi(2), potential = 2 x)]
struct WithoutOperator;

#[derive(MechanicalSystem)]
#[evi(coordinates(x), kinetic = 0.5 * (der(x).powi(2) +), potential = (2.0 * / x))]
struct InParentheses;

#[derive(MechanicalSystem)]
#[evi(coordinates(x), kinetic = @ # $, potential = 0.5 * x.)]
struct Garbage;

#[derive(MechanicalSystem)]
#[evi(coordinates(x), lagrangian = 0.5 * der(x).powi(2), constraint(wall: x.powi(2) + == 1.0), constraint(floor: x ==))]
struct InConstraint;

fn main() {}
