//! Names that also occur in emitted code, in the prelude, or nowhere.

#![deny(warnings, missing_docs, unused, nonstandard_style, rust_2018_idioms)]

use evi_core::prelude::*;

/// Coordinates named like the arguments and the type parameter of emitted functions.
#[derive(MechanicalSystem)]
#[evi(
    coordinates(q, v, c, T, p, x0),
    kinetic = 0.5 * h * (der(q).powi(2) + der(v).powi(2) + der(c).powi(2) + der(T).powi(2) + der(p).powi(2)
            + der(x0).powi(2)),
    potential = q * v * c * T * p * x0 * x1 * shared,
    constraint(residuals: q == residual),
)]
pub struct Arguments {
    /// Named like a step size.
    pub h: f64,
    /// Named like a value of a kernel.
    pub x1: f64,
    /// Named like the values that kernels share.
    pub shared: f64,
    /// Named like the output of a kernel.
    pub residual: f64,
}

/// Fields named like items of the prelude, methods, items of the attribute, and keywords.
#[derive(MechanicalSystem)]
#[evi(
    coordinates(drop, vec),
    let kinetic = 0.5 * clone,
    let coordinates = kinetic,
    kinetic = coordinates * (der(drop).powi(2) + der(vec).powi(2)),
    potential = main * drop + r#type * vec + from + constants + sin.sin(),
    constraint(lagrangian: drop == vec),
    constraint(type: drop == vec),
)]
pub struct Prelude {
    /// A trait's method.
    pub clone: f64,
    /// A function here.
    pub main: f64,
    /// A keyword.
    pub r#type: f64,
    /// Another trait's method.
    pub from: f64,
    /// A function of the implemented trait.
    pub constants: f64,
    /// A function of the grammar.
    pub sin: f64,
}

/// A struct named like the type parameter of emitted functions.
#[derive(MechanicalSystem)]
#[evi(coordinates(x), lagrangian = 0.5 * M * der(x).powi(2))]
#[allow(non_snake_case, reason = "physicists write masses in capitals")]
pub struct T {
    /// A parameter in capitals.
    pub M: f64,
}

/// Fields that no equation names may have any type.
#[derive(MechanicalSystem, Clone, Debug)]
#[evi(coordinates(x), kinetic = 0.5 * mass * der(x).powi(2), potential = 0.0)]
pub struct Unnamed {
    /// What to call it.
    pub name: String,
    /// Named by the equations.
    pub mass: f64,
    /// Not named by them.
    pub radius: f64,
    /// Neither.
    pub history: Vec<(f32, usize)>,
}

/// Names that Rust would not bind as they stand: keywords, and names of constants in scope.
#[derive(MechanicalSystem)]
#[evi(
    coordinates(r#type, MASS),
    let LENGTH = 2.0 * K,
    lagrangian = 0.5 * r#loop * (der(r#type).powi(2) + der(MASS).powi(2)) - 10000000000 * LENGTH * MASS,
    constraint(rod: r#type.powi(2) + MASS.powi(2) == LENGTH),
)]
#[allow(non_snake_case, reason = "constants are in capitals")]
pub struct Bound {
    /// A keyword.
    pub r#loop: f64,
    /// A constant below.
    pub K: f64,
}

/// In scope of the struct above.
pub const MASS: f64 = 1.0;
/// Likewise.
pub const LENGTH: f64 = 1.0;
/// Likewise.
pub const K: f64 = 1.0;

/// Written by another macro.
macro_rules! oscillator {
    ($name:ident, $q:ident, $parameter:ident, $potential:expr) => {
        /// Written by a macro.
        #[derive(MechanicalSystem)]
        #[evi(coordinates($q), kinetic = 0.5 * der($q).powi(2), potential = $parameter * ($potential))]
        pub struct $name {
            /// Its only parameter.
            pub $parameter: f64,
        }
    };
}

oscillator!(Macro, angle, stiffness, 1.0 - angle.cos());

fn main() {
    #[derive(MechanicalSystem)]
    #[evi(coordinates(x), kinetic = 0.5 * LOCAL * k * der(x).powi(2), potential = 0.5 * k * x.powi(2))]
    struct Private {
        k: f64,
    }
    const LOCAL: f64 = 2.0;

    let mut run = Simulation::new(Private { k: 1.0 }, Evi::midpoint(0.01)).start([1.0], [0.0]).unwrap();
    assert!(run.integrate(0.1).unwrap().last().q()[0] < 1.0);
    let named = (Arguments::COORDINATES, Prelude::CONSTRAINTS);
    assert_eq!(named, (&["q", "v", "c", "T", "p", "x0"][..], &["lagrangian", "type"][..]));
    assert_eq!((Bound::COORDINATES, Bound::PARAMETERS), (&["type", "MASS"][..], &["loop", "K"][..]));
    assert_eq!((T::PARAMETERS, Unnamed::PARAMETERS, Macro::PARAMETERS), (&["M"][..], &["mass"][..], &["stiffness"][..]));
}
