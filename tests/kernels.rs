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

#[path = "random_expressions/splitmix.rs"]
mod splitmix;

use std::ops::{Add, Div, Mul, Neg, Sub};

use evi_core::array::Array;
use evi_core::generic::GenericSystem;
use evi_core::prelude::*;
use evi_core::scalar::Scalar;
use evi_core::system::{Entry, Structure};
use num_dual::{Dual64, HyperDual64};
use splitmix::SplitMix;

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

/// A system behind a pointer, so that the checks below are compiled once and not per struct.
struct Scene<K: ?Sized> {
    name: &'static str,
    system: Box<K>,
}

/// The emitted kernels over numbers with error bounds, and the generic copy over hyperdual numbers.
trait System {
    fn n_coordinates(&self) -> usize;
    fn n_constraints(&self) -> usize;
    fn structure(&self) -> Structure;
    fn parameters(&self) -> Vec<f64>;
    fn kernels_rounded(&self, at: &Arguments<Rounded>) -> Values<Rounded>;
    fn lagrangian(&self, t: Outlined, q: &[Outlined], v: &[Outlined]) -> Outlined;
    fn constraints(&self, t: Outlined, q: &[Outlined]) -> Vec<Outlined>;
    fn n_inputs(&self) -> usize;
    fn n_observables(&self) -> usize;
    fn dissipation(&self, t: Outlined, q: &[Outlined], v: &[Outlined]) -> Outlined;
    fn forces(&self, t: Outlined, q: &[Outlined], v: &[Outlined], inputs: &[Outlined]) -> Vec<Outlined>;
}

impl<S: MechanicalSystem + GenericSystem> System for S {
    fn n_coordinates(&self) -> usize {
        assert_eq!(S::N_COORDINATES, GenericSystem::n_coordinates(self));
        S::N_COORDINATES
    }
    fn n_constraints(&self) -> usize {
        assert_eq!(S::N_CONSTRAINTS, GenericSystem::n_constraints(self));
        S::N_CONSTRAINTS
    }
    fn structure(&self) -> Structure {
        S::STRUCTURE
    }
    fn parameters(&self) -> Vec<f64> {
        MechanicalSystem::parameters(self).as_ref().to_vec()
    }
    fn kernels_rounded(&self, at: &Arguments<Rounded>) -> Values<Rounded> {
        evaluate::<S, Rounded>(at)
    }
    fn lagrangian(&self, t: Outlined, q: &[Outlined], v: &[Outlined]) -> Outlined {
        GenericSystem::lagrangian(self, t, q, v)
    }
    fn constraints(&self, t: Outlined, q: &[Outlined]) -> Vec<Outlined> {
        let mut residuals = vec![Outlined::from_f64(0.0); S::N_CONSTRAINTS];
        GenericSystem::constraints(self, t, q, &mut residuals);
        residuals
    }
    fn n_inputs(&self) -> usize {
        assert_eq!(S::N_INPUTS, GenericSystem::n_inputs(self));
        S::N_INPUTS
    }
    fn n_observables(&self) -> usize {
        S::OBSERVABLES.len()
    }
    fn dissipation(&self, t: Outlined, q: &[Outlined], v: &[Outlined]) -> Outlined {
        GenericSystem::dissipation(self, t, q, v)
    }
    fn forces(&self, t: Outlined, q: &[Outlined], v: &[Outlined], inputs: &[Outlined]) -> Vec<Outlined> {
        let mut forces = vec![Outlined::from_f64(0.0); S::N_COORDINATES];
        GenericSystem::add_forces(self, t, q, v, inputs, &mut forces);
        forces
    }
}

/// The emitted kernels over `f64`, for the scenes that also show that the scalar makes no difference:
/// optimising them for the random systems, too, would double the time that this test compiles.
trait OverDoubles: System {
    fn kernels(&self, at: &Arguments<f64>) -> Values<f64>;
}

impl<S: MechanicalSystem + GenericSystem> OverDoubles for S {
    fn kernels(&self, at: &Arguments<f64>) -> Values<f64> {
        evaluate::<S, f64>(at)
    }
}

/// The emitted kernels over the scalars that only operators' scenes are compiled for.
trait OtherScalars: OverDoubles {
    fn parameter_names(&self) -> &'static [&'static str];
    fn kernels_dual(&self, at: &Arguments<Dual64>) -> Values<Dual64>;
    fn kernels_single(&self, at: &Arguments<f32>) -> Values<f32>;
}

impl<S: MechanicalSystem + GenericSystem> OtherScalars for S {
    fn parameter_names(&self) -> &'static [&'static str] {
        S::PARAMETERS
    }
    fn kernels_dual(&self, at: &Arguments<Dual64>) -> Values<Dual64> {
        evaluate::<S, Dual64>(at)
    }
    fn kernels_single(&self, at: &Arguments<f32>) -> Values<f32> {
        evaluate::<S, f32>(at)
    }
}

/// What kernels are evaluated at.
#[derive(Clone)]
struct Arguments<T> {
    parameters: Vec<T>,
    t: T,
    q: Vec<T>,
    v: Vec<T>,
    inputs: Vec<T>,
}

impl Arguments<f64> {
    /// A point of the domain of all expressions.
    fn random(system: &dyn System, seed: u64) -> Self {
        let mut random = SplitMix::new(seed);
        let n = system.n_coordinates();
        let mut values = |n: usize| (0..n).map(|_| random.between(-1.4, 1.4)).collect();
        let (q, v): (Vec<f64>, Vec<f64>) = (values(n), values(n));
        let t = random.between(0.2, 1.4);
        let inputs = (0..system.n_inputs()).map(|_| random.between(0.3, 1.4)).collect();
        Self { parameters: system.parameters(), t, q, v, inputs }
    }

    fn map<T>(&self, convert: impl Fn(f64) -> T) -> Arguments<T> {
        let all = |values: &[f64]| values.iter().map(|&value| convert(value)).collect();
        Arguments {
            parameters: all(&self.parameters),
            t: convert(self.t),
            q: all(&self.q),
            v: all(&self.v),
            inputs: all(&self.inputs),
        }
    }
}

/// What all kernels of a system return.
struct Values<T> {
    constants: Vec<T>,
    lagrangian: T,
    gradient: [Vec<T>; 2],
    fused_gradient: [Vec<T>; 2],
    hessian_entries: Vec<T>,
    constraints: Vec<T>,
    fused_constraints: Vec<T>,
    jacobian_entries: Vec<T>,
    curvature: Vec<T>,
    forces: Vec<T>,
    fused_forces: Vec<T>,
    force_entries: Vec<T>,
    observables: Vec<T>,
}

fn evaluate<S: MechanicalSystem, T: Scalar>(at: &Arguments<T>) -> Values<T> {
    let constants = S::constants::<T>(&S::PerParameter::from_fn(|i| at.parameters[i]));
    let q = S::PerCoordinate::<T>::from_fn(|i| at.q[i]);
    let v = S::PerCoordinate::<T>::from_fn(|i| at.v[i]);
    let gradient = S::lagrangian_gradient(&constants, at.t, &q, &v);
    let (fused_gradient, hessian_entries) = S::lagrangian_derivatives(&constants, at.t, &q, &v);
    let (fused_constraints, jacobian_entries) = S::constraint_derivatives(&constants, at.t, &q);
    let inputs = S::PerInput::<T>::from_fn(|i| at.inputs[i]);
    let (fused_forces, force_entries) = S::force_derivatives(&constants, at.t, &q, &v, &inputs);
    Values {
        forces: S::forces(&constants, at.t, &q, &v, &inputs).as_ref().to_vec(),
        fused_forces: fused_forces.as_ref().to_vec(),
        force_entries: force_entries.as_ref().to_vec(),
        observables: S::observables(&constants, at.t, &q, &v, &inputs).as_ref().to_vec(),
        lagrangian: S::lagrangian(&constants, at.t, &q, &v),
        gradient: [gradient.force.as_ref().to_vec(), gradient.momentum.as_ref().to_vec()],
        fused_gradient: [fused_gradient.force.as_ref().to_vec(), fused_gradient.momentum.as_ref().to_vec()],
        hessian_entries: hessian_entries.as_ref().to_vec(),
        constraints: S::constraints(&constants, at.t, &q).as_ref().to_vec(),
        fused_constraints: fused_constraints.as_ref().to_vec(),
        jacobian_entries: jacobian_entries.as_ref().to_vec(),
        curvature: S::constraint_curvature(&constants, at.t, &q, &v).as_ref().to_vec(),
        constants: constants.as_ref().to_vec(),
    }
}

/// Quantities of one kind, dense and row by row, so that their round-off has one scale.
struct Block<T> {
    name: &'static str,
    values: Vec<T>,
}

/// What the kernels say: matrices assembled from the structure's patterns, absent entries zero.
fn blocks<T: Scalar>(system: &dyn System, values: Values<T>) -> Vec<Block<T>> {
    let (n, m) = (system.n_coordinates(), system.n_constraints());
    let Structure { hessian, jacobian, forces, .. } = system.structure();
    let dense =
        |entries: &[Entry], shape, varying: &[T]| assembled(entries, shape, &values.constants, varying);
    let of_lagrangian = |entries, shape| dense(entries, shape, &values.hessian_entries);
    let of_constraints = |entries, shape| dense(entries, shape, &values.jacobian_entries);
    let of_forces = |entries| dense(entries, (n, n), &values.force_entries);
    let matrices = [
        ("qq", lower_triangle(of_lagrangian(hessian.qq, (n, n)), n)),
        ("vq", of_lagrangian(hessian.vq, (n, n))),
        ("vv", lower_triangle(of_lagrangian(hessian.vv, (n, n)), n)),
        ("vt", of_lagrangian(hessian.vt, (n, 1))),
        ("∂φ/∂q", of_constraints(jacobian.q, (m, n))),
        ("∂φ/∂t", of_constraints(jacobian.t, (m, 1))),
        ("∂f/∂q", of_forces(forces.q)),
        ("∂f/∂v", of_forces(forces.v)),
    ];
    let [force, momentum] = values.gradient;
    let [fused_force, fused_momentum] = values.fused_gradient;
    let vectors = [
        ("L", vec![values.lagrangian]),
        ("force", force),
        ("momentum", momentum),
        ("fused force", fused_force),
        ("fused momentum", fused_momentum),
        ("φ", values.constraints),
        ("fused φ", values.fused_constraints),
        ("γ", values.curvature),
        ("f", values.forces),
        ("fused f", values.fused_forces),
        ("observed", values.observables),
    ];
    vectors.into_iter().chain(matrices).map(|(name, values)| Block { name, values }).collect()
}

/// The matrix of some entries, row by row.
fn assembled<T: Scalar>(
    entries: &[Entry],
    (n_rows, n_cols): (usize, usize),
    constants: &[T],
    varying: &[T],
) -> Vec<T> {
    let mut matrix = vec![None; n_rows * n_cols];
    for entry in entries {
        assert!(entry.row < n_rows && entry.col < n_cols, "{entry:?} lies outside");
        let previous = matrix[entry.row * n_cols + entry.col].replace(entry.value(constants, varying));
        assert!(previous.is_none(), "{entry:?} is given twice");
    }
    matrix.into_iter().map(|value| value.unwrap_or(T::from_f64(0.0))).collect()
}

fn lower_triangle<T: Copy>(matrix: Vec<T>, n: usize) -> Vec<T> {
    (0..n)
        .flat_map(|row| (0..=row).map(move |col| (row, col)))
        .map(|(row, col)| matrix[row * n + col])
        .collect()
}

/// What dual numbers say of the generic copy, in the order of [`blocks`].
fn reference(system: &dyn System, at: &Arguments<f64>) -> Vec<Block<f64>> {
    let (n, m) = (system.n_coordinates(), system.n_constraints());
    // Directions: q, then v, then t.
    let time = 2 * n;
    let lagrangian = |first: usize, second: usize| {
        let seeded = |value: f64, index: usize| {
            let part = |direction| f64::from(u8::from(direction == index));
            Outlined::new(value, part(first), part(second))
        };
        let seeded_all = |values: &[f64], offset: usize| -> Vec<Outlined> {
            values.iter().enumerate().map(|(i, &value)| seeded(value, offset + i)).collect()
        };
        system.lagrangian(seeded(at.t, time), &seeded_all(&at.q, 0), &seeded_all(&at.v, n))
    };
    let constraints = |direction: &dyn Fn(usize) -> f64| {
        let seeded = |value, index| Outlined::new(value, direction(index), direction(index));
        let q: Vec<Outlined> = at.q.iter().enumerate().map(|(i, &value)| seeded(value, i)).collect();
        system.constraints(seeded(at.t, time), &q)
    };
    let along = |index: usize| constraints(&|other| f64::from(u8::from(other == index)));
    let motion = constraints(&|index| if index == time { 1.0 } else { at.v[index] });
    let gradient =
        |offset: usize| -> Vec<f64> { (0..n).map(|i| lagrangian(offset + i, time).0.eps1).collect() };
    let second = |first: usize, second: usize| lagrangian(first, second).0.eps1eps2;
    let lower = |offset: usize| -> Vec<f64> {
        let places = (0..n).flat_map(|row| (0..=row).map(move |col| (row, col)));
        places.map(|(row, col)| second(offset + row, offset + col)).collect()
    };
    // The force in every direction: the generalized one, less the slope of the dissipation.
    let force = |along: usize| -> Vec<Outlined> {
        let part = |direction: usize, index| f64::from(u8::from(direction == index));
        let seeded = |first: usize, offset: usize, values: &[f64]| -> Vec<Outlined> {
            let seed = |(i, &value)| Outlined::new(value, part(first, offset + i), part(along, offset + i));
            values.iter().enumerate().map(seed).collect()
        };
        let t = Outlined::new(at.t, 0.0, part(along, time));
        let inputs: Vec<Outlined> = at.inputs.iter().map(|&u| Outlined::from_f64(u)).collect();
        let none = 2 * n + 1;
        let generalized = system.forces(t, &seeded(none, 0, &at.q), &seeded(none, n, &at.v), &inputs);
        let slope = |i: usize| system.dissipation(t, &seeded(n + i, 0, &at.q), &seeded(n + i, n, &at.v)).0;
        let total = |(i, force): (usize, Outlined)| {
            let slope = slope(i);
            Outlined::new(force.0.re - slope.eps1, 0.0, force.0.eps2 - slope.eps1eps2)
        };
        generalized.into_iter().enumerate().map(total).collect()
    };
    let force_columns: Vec<Vec<Outlined>> = (0..2 * n).map(force).collect();
    let forces: Vec<f64> = force_columns[0].iter().map(|force| force.0.re).collect();
    let force_slopes = |offset: usize| -> Vec<f64> {
        (0..n * n).map(|k| force_columns[offset + k % n][k / n].0.eps2).collect()
    };
    // Scenes that observe something observe L times the second and the first input.
    let value = lagrangian(0, 0).0.re;
    let observed = (0..system.n_observables()).map(|k| at.inputs[1 - k] * value).collect();
    let columns: Vec<Vec<Outlined>> = (0..n).map(along).collect();
    let residuals: Vec<f64> = motion.iter().map(|residual| residual.0.re).collect();
    [
        ("L", vec![lagrangian(0, 0).0.re]),
        ("force", gradient(0)),
        ("momentum", gradient(n)),
        ("fused force", gradient(0)),
        ("fused momentum", gradient(n)),
        ("φ", residuals.clone()),
        ("fused φ", residuals),
        ("γ", motion.iter().map(|residual| residual.0.eps1eps2).collect()),
        ("f", forces.clone()),
        ("fused f", forces),
        ("observed", observed),
        ("qq", lower(0)),
        ("vq", (0..n * n).map(|k| second(n + k / n, k % n)).collect()),
        ("vv", lower(n)),
        ("vt", (0..n).map(|row| second(n + row, time)).collect()),
        ("∂φ/∂q", (0..m * n).map(|k| columns[k % n][k / n].0.eps1).collect()),
        ("∂φ/∂t", along(time).iter().map(|residual| residual.0.eps1).collect()),
        ("∂f/∂q", force_slopes(0)),
        ("∂f/∂v", force_slopes(n)),
    ]
    .map(|(name, values)| Block { name, values })
    .into()
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

/// A hyperdual number whose operations are calls instead of inlined: the generic copies are many, and
/// compiling them is most of what this test costs.
#[derive(Clone, Copy, Debug)]
struct Outlined(HyperDual64);

impl Outlined {
    /// `value + first ε₁ + second ε₂`.
    fn new(value: f64, first: f64, second: f64) -> Self {
        Self(HyperDual64::new(value, first, second, 0.0))
    }
}

/// Hands operations on to the implementation for `HyperDual64`.
macro_rules! outlined {
    (operators $($operator:ident $method:ident),*) => {$(
        impl $operator for Outlined {
            type Output = Self;
            #[inline(never)]
            fn $method(self, other: Self) -> Self {
                Self($operator::$method(self.0, other.0))
            }
        }
    )*};
    (functions $($function:ident($($argument:ident: $kind:ty),*)),*) => {$(
        #[inline(never)]
        fn $function(self $(, $argument: $kind)*) -> Self {
            Self(Scalar::$function(self.0 $(, $argument.0)*))
        }
    )*};
}

outlined!(operators Add add, Sub sub, Mul mul, Div div);

impl Neg for Outlined {
    type Output = Self;
    #[inline(never)]
    fn neg(self) -> Self {
        Self(-self.0)
    }
}

impl Scalar for Outlined {
    fn from_f64(value: f64) -> Self {
        Self(Scalar::from_f64(value))
    }
    #[inline(never)]
    fn powi(self, exponent: i32) -> Self {
        Self(Scalar::powi(self.0, exponent))
    }
    outlined!(functions powf(exponent: Self), atan2(x: Self));
    outlined!(functions sqrt(), sin(), cos(), tan(), exp(), ln(), asin(), acos());
    outlined!(functions atan(), sinh(), cosh(), tanh(), abs(), signum());
}

/// A number with a bound of its rounding error, to first order.
///
/// Running error analysis (Higham, Accuracy and Stability of Numerical Algorithms, 3.3): every operation
/// hands on the errors of its operands, scaled by its slopes, and adds its own rounding. Outlined like the
/// numbers above.
#[derive(Clone, Copy, Debug)]
struct Rounded {
    value: f64,
    error: f64,
}

impl Rounded {
    fn exact(value: f64) -> Self {
        Self { value, error: 0.0 }
    }

    /// A result with the errors that its operands hand on; its own rounding is at most one unit in the last
    /// place.
    fn new(value: f64, handed_on: f64) -> Self {
        Self { value, error: handed_on + f64::EPSILON * value.abs() }
    }

    fn function(self, function: fn(f64) -> f64, slope: f64) -> Self {
        Self::new(function(self.value), slope.abs() * self.error)
    }
}

impl Add for Rounded {
    type Output = Self;
    #[inline(never)]
    fn add(self, other: Self) -> Self {
        Self::new(self.value + other.value, self.error + other.error)
    }
}

impl Sub for Rounded {
    type Output = Self;
    #[inline(never)]
    fn sub(self, other: Self) -> Self {
        Self::new(self.value - other.value, self.error + other.error)
    }
}

impl Mul for Rounded {
    type Output = Self;
    #[inline(never)]
    fn mul(self, other: Self) -> Self {
        let handed_on = self.value.abs() * other.error + other.value.abs() * self.error;
        Self::new(self.value * other.value, handed_on)
    }
}

impl Div for Rounded {
    type Output = Self;
    #[inline(never)]
    fn div(self, other: Self) -> Self {
        let quotient = self.value / other.value;
        Self::new(quotient, (self.error + quotient.abs() * other.error) / other.value.abs())
    }
}

impl Neg for Rounded {
    type Output = Self;
    #[inline(never)]
    fn neg(self) -> Self {
        Self { value: -self.value, error: self.error }
    }
}

impl Scalar for Rounded {
    /// A number in a kernel may be the rounded result of folding several.
    #[inline(never)]
    fn from_f64(value: f64) -> Self {
        Self::new(value, 0.0)
    }
    #[inline(never)]
    fn powf(self, exponent: Self) -> Self {
        let power = self.value.powf(exponent.value);
        let slope_of_base = exponent.value * self.value.powf(exponent.value - 1.0);
        let slope_of_exponent = power * self.value.ln();
        let handed_on = slope_of_base.abs() * self.error + slope_of_exponent.abs() * exponent.error;
        Self::new(power, handed_on)
    }
    #[inline(never)]
    fn sqrt(self) -> Self {
        self.function(f64::sqrt, 0.5 / self.value.sqrt())
    }
    #[inline(never)]
    fn sin(self) -> Self {
        self.function(f64::sin, self.value.cos())
    }
    #[inline(never)]
    fn cos(self) -> Self {
        self.function(f64::cos, self.value.sin())
    }
    #[inline(never)]
    fn tan(self) -> Self {
        self.function(f64::tan, self.value.cos().powi(-2))
    }
    #[inline(never)]
    fn exp(self) -> Self {
        self.function(f64::exp, self.value.exp())
    }
    #[inline(never)]
    fn ln(self) -> Self {
        self.function(f64::ln, 1.0 / self.value)
    }
    #[inline(never)]
    fn asin(self) -> Self {
        self.function(f64::asin, 1.0 / (1.0 - self.value.powi(2)).sqrt())
    }
    #[inline(never)]
    fn acos(self) -> Self {
        self.function(f64::acos, 1.0 / (1.0 - self.value.powi(2)).sqrt())
    }
    #[inline(never)]
    fn atan(self) -> Self {
        self.function(f64::atan, 1.0 / (1.0 + self.value.powi(2)))
    }
    #[inline(never)]
    fn atan2(self, x: Self) -> Self {
        let radius_squared = self.value.powi(2) + x.value.powi(2);
        let handed_on = (self.value.abs() * x.error + x.value.abs() * self.error) / radius_squared;
        Self::new(self.value.atan2(x.value), handed_on)
    }
    #[inline(never)]
    fn sinh(self) -> Self {
        self.function(f64::sinh, self.value.cosh())
    }
    #[inline(never)]
    fn cosh(self) -> Self {
        self.function(f64::cosh, self.value.sinh())
    }
    #[inline(never)]
    fn tanh(self) -> Self {
        self.function(f64::tanh, self.value.cosh().powi(-2))
    }
    #[inline(never)]
    fn abs(self) -> Self {
        Self { value: self.value.abs(), error: self.error }
    }
    #[inline(never)]
    fn signum(self) -> Self {
        // Next to the kink the sign itself is uncertain.
        let error = if self.value.abs() <= self.error { 2.0 } else { 0.0 };
        Self { value: self.value.signum(), error }
    }
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
