//! Rust that has no meaning in an equation.

use evi_core::prelude::*;

#[derive(MechanicalSystem)]
#[evi(coordinates(x), kinetic = 0.5 * der(x).powi(2), potential = (x < 1.0) * x)]
struct Comparison;

#[derive(MechanicalSystem)]
#[evi(coordinates(x), kinetic = 0.5 * der(x).powi(2), potential = x == 1.0)]
struct Equation;

#[derive(MechanicalSystem)]
#[evi(coordinates(x), kinetic = 0.5 * der(x).powi(2), potential = x = 1.0)]
struct Assignment;

#[derive(MechanicalSystem)]
#[evi(coordinates(x), kinetic = 0.5 * der(x).powi(2), potential = x % 2.0 + !x + &x)]
struct Remainder;

#[derive(MechanicalSystem)]
#[evi(coordinates(x), kinetic = 0.5 * der(x).powi(2), potential = if x < 0.0 { 0.0 } else { x })]
struct Choice;

#[derive(MechanicalSystem)]
#[evi(coordinates(x), kinetic = 0.5 * der(x).powi(2), potential = match x { _ => x })]
struct Match;

#[derive(MechanicalSystem)]
#[evi(coordinates(x), kinetic = 0.5 * der(x).powi(2), potential = (k as f64) * x)]
struct Cast { k: f64 }

#[derive(MechanicalSystem)]
#[evi(coordinates(x), kinetic = 0.5 * self.m * der(x).powi(2), potential = x.m)]
struct SelfField { m: f64 }

#[derive(MechanicalSystem)]
#[evi(coordinates(x), kinetic = 0.5 * der(x).powi(2), potential = [x, 1.0].norm() + x[0])]
struct Vectors;

#[derive(MechanicalSystem)]
#[evi(
    coordinates(x),
    kinetic = { let half: f64 = 0.5; half; half * der(x).powi(2) },
    potential = { let t = x; let (a, b) = x; },
)]
struct Blocks;

fn main() {}
