//! Emitted kernels against dual numbers over the generic copy of the user's expressions.
//!
//! The systems are written by `build.rs`: one per operator of the grammar, 200 random ones, and one whose
//! kernels have thousands of statements. The generic copy is evaluated over the hyperdual numbers of
//! num-dual, which give exact first and second derivatives; the kernels must agree entry by entry, and what
//! is structurally absent must be zero.
//!
//! The tolerance of an entry is a multiple of its condition times round-off, and both are computed, not
//! guessed: the same kernel is evaluated over [`Rounded`], which carries a bound of its own rounding errors.

// The structs' fields are not all read: some random equations have no parameter.
#![allow(dead_code)]

mod blocks;
mod outlined;
mod rounded;
#[path = "../random_expressions/splitmix.rs"]
mod splitmix;
mod systems;

use std::ops::{Add, Div, Mul, Neg, Sub};

use blocks::{blocks, reference};
use evi_core::array::Array;
use evi_core::generic::GenericSystem;
use evi_core::prelude::*;
use evi_core::scalar::Scalar;
use evi_core::system::{Entry, Structure};
use num_dual::{Dual64, HyperDual64};
use outlined::Outlined;
use rounded::Rounded;
use splitmix::SplitMix;
use systems::{Arguments, OtherScalars, OverDoubles, Scene, System, Values};

/// Parameters of all systems: unequal, so that swapped slots show.
const A: f64 = 1.3;
const B: f64 = 0.7;

mod scenes {
    use std::f64::consts::PI;

    use evi_core::prelude::*;

    use super::{A, B, OtherScalars, OverDoubles, Scene, System};

    /// A constant in the user's scope.
    const RATIO: f64 = 0.25;

    include!(concat!(env!("OUT_DIR"), "/kernel_scenes.rs"));
}

/// Round-off of a kernel and of its reference, in units of the kernel's bound and of the block's largest
/// entry: the reference computes in another order and has errors of its own. The largest seen is 3.3.
const ROUNDINGS: f64 = 8.0;

/// Digits that a comparison must have at least, or it compares nothing.
const COARSEST_TOLERANCE: f64 = 1e-11;

/// Compares every kernel of a system with its reference at random points.
#[track_caller]
fn check(name: &str, system: &dyn System, n_points: u64) {
    for seed in 0..n_points {
        let at = Arguments::random(system, seed);
        let values = blocks(system, system.kernels_rounded(&at.map(Rounded::exact)));
        let references = reference(system, &at);
        for (values, references) in values.iter().zip(&references) {
            assert_eq!(values.name, references.name);
            compare(&format!("{name} at point {seed}, {}", values.name), &values.values, &references.values);
        }
        let of_forces: &[&str] =
            if system.n_inputs() > 0 { &["f", "∂f/∂q", "∂f/∂v", "observed"] } else { &[] };
        for &block in ["momentum", "vv", "∂φ/∂q"].iter().chain(of_forces) {
            let reference = references.iter().find(|reference| reference.name == block);
            let largest = reference.map_or(0.0, |reference| largest(&reference.values));
            assert!(largest > 1e-3, "{name} at point {seed}: {block} is {largest}, nothing is compared");
        }
    }
}

#[track_caller]
fn compare(place: &str, values: &[Rounded], references: &[f64]) {
    assert_eq!(values.len(), references.len(), "{place}");
    let largest = largest(references);
    for (i, (&Rounded { value, error }, &reference)) in values.iter().zip(references).enumerate() {
        assert!(reference.is_finite(), "{place}[{i}]: the reference is {reference}");
        let tolerance = ROUNDINGS * (error + f64::EPSILON * largest);
        assert!(
            tolerance <= COARSEST_TOLERANCE * largest.max(1.0),
            "{place}[{i}]: the tolerance {tolerance:e} is coarse"
        );
        assert!(
            (value - reference).abs() <= tolerance,
            "{place}[{i}]: {value:e}, but dual numbers say {reference:e} ± {tolerance:e}"
        );
    }
}

/// Kernels over `f64` give the values that carry the bounds, bit by bit.
#[track_caller]
fn check_doubles(name: &str, system: &dyn OverDoubles) {
    let at = Arguments::random(system, 0);
    let values = blocks(system, system.kernels(&at));
    let rounded = blocks(system, system.kernels_rounded(&at.map(Rounded::exact)));
    for (values, rounded) in values.iter().zip(rounded) {
        for (value, rounded) in values.values.iter().zip(rounded.values) {
            assert_eq!(value.to_bits(), rounded.value.to_bits(), "{name}, {}", values.name);
        }
    }
}

fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |largest, value| largest.max(value.abs()))
}

#[test]
fn every_operator() {
    for scene in scenes::operator_scenes() {
        check(scene.name, scene.system.as_ref(), 5);
        check_doubles(scene.name, scene.system.as_ref());
    }
}

#[test]
fn random_expressions() {
    for scene in scenes::random_scenes() {
        check(scene.name, scene.system.as_ref(), 3);
    }
}

#[test]
fn kernels_of_many_scopes() {
    for scene in scenes::large_scenes() {
        let n_operations = scene.system.structure().operations.lagrangian_derivatives.total();
        assert!(n_operations > 3000, "{n_operations} operations fit into few scopes");
        check(scene.name, scene.system.as_ref(), 2);
        check_doubles(scene.name, scene.system.as_ref());
    }
}

/// The dual part of every kernel, for a dual part 1 of one coordinate or velocity, is the derivative that the
/// kernels over `f64` give.
#[test]
fn kernels_over_dual_numbers_give_derivatives() {
    for Scene { name, system } in scenes::operator_scenes() {
        let at = Arguments::random(system.as_ref(), 1);
        let n = system.n_coordinates();
        let values = blocks(system.as_ref(), system.kernels(&at));
        let bounds = blocks(system.as_ref(), system.kernels_rounded(&at.map(Rounded::exact)));
        let block = |name: &str| values.iter().position(|block| block.name == name).expect("a block's name");
        for (index, is_velocity) in (0..2 * n).map(|direction| (direction % n, direction >= n)) {
            let mut seeded = at.map(Dual64::from);
            let of = if is_velocity { &mut seeded.v } else { &mut seeded.q };
            of[index].eps = 1.0;
            let Values { lagrangian, gradient: [force, momentum], constraints, .. } =
                system.kernels_dual(&seeded);
            let compare = |what: &str, block: usize, entry: usize, derivative: f64| {
                let (value, error) = (values[block].values[entry], bounds[block].values[entry].error);
                let tolerance = ROUNDINGS * (error + f64::EPSILON * largest(&values[block].values).max(1.0));
                let difference = (derivative - value).abs();
                assert!(difference <= tolerance, "{name}, {what}: {derivative:e} instead of {value:e}");
            };
            compare("∂L", block(if is_velocity { "momentum" } else { "force" }), index, lagrangian.eps);
            for row in 0..n {
                // Of the symmetric blocks, only the lower triangle is there.
                let triangle = row.max(index) * (row.max(index) + 1) / 2 + row.min(index);
                if is_velocity {
                    compare("∂²L/∂v∂v", block("vv"), triangle, momentum[row].eps);
                    compare("∂²L/∂q∂v", block("vq"), index * n + row, force[row].eps);
                } else {
                    compare("∂²L/∂q∂q", block("qq"), triangle, force[row].eps);
                    compare("∂²L/∂v∂q", block("vq"), row * n + index, momentum[row].eps);
                }
            }
            for (row, residual) in constraints.iter().enumerate().filter(|_| !is_velocity) {
                compare("∂φ/∂q", block("∂φ/∂q"), row * n + index, residual.eps);
            }
        }
    }
}

/// Parameters are arguments like any other: their dual part passes through `constants`.
#[test]
fn derivatives_by_parameters_pass_through_the_constants() {
    /// Truncation of the central difference, `step² ∂³L / 6`, and its round-off, `eps L / step`, are below
    /// 1e-8.
    const STEP: f64 = 1e-5;
    const TOLERANCE: f64 = 1e-7;
    for Scene { name, system } in scenes::operator_scenes() {
        let at = Arguments::random(system.as_ref(), 2);
        for (index, parameter) in system.parameter_names().iter().enumerate() {
            let mut seeded = at.map(Dual64::from);
            seeded.parameters[index].eps = 1.0;
            let moved = |step: f64| {
                let mut moved = at.clone();
                moved.parameters[index] += step;
                system.kernels(&moved).lagrangian
            };
            let value = system.kernels_dual(&seeded).lagrangian.eps;
            let reference = (moved(STEP) - moved(-STEP)) / (2.0 * STEP);
            assert!(
                (value - reference).abs() <= TOLERANCE * reference.abs().max(1.0),
                "{name}, {parameter}: {value:e} instead of {reference:e}"
            );
            assert!(value != 0.0, "{name} depends on {parameter}");
        }
    }
}

/// Kernels over `f32` agree with those over `f64` to 1e-4 of their block's largest entry: 1,000 roundings of
/// `f32`.
#[test]
fn kernels_over_single_precision_agree() {
    for Scene { name, system } in scenes::operator_scenes() {
        let at = Arguments::random(system.as_ref(), 3);
        let values = blocks(system.as_ref(), system.kernels(&at));
        let single = blocks(system.as_ref(), system.kernels_single(&at.map(|value| value as f32)));
        for (values, single) in values.iter().zip(single) {
            let scale = largest(&values.values).max(1.0);
            for (value, single) in values.values.iter().zip(single.values) {
                let difference = (value - f64::from(single)).abs();
                assert!(
                    difference <= 1e-4 * scale,
                    "{name}, {}: {single:e} instead of {value:e}",
                    values.name
                );
            }
        }
    }
}

/// The parameters' order is the struct's, and each has its own value.
#[test]
fn parameters_keep_their_order() {
    for Scene { name, system } in scenes::operator_scenes() {
        assert_eq!(system.parameter_names(), ["a", "b"], "{name}");
        assert_eq!(system.parameters(), [A, B], "{name}");
    }
}
