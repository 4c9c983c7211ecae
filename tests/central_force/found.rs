//! What the derive takes for a central force, and what it does not.

use evi_core::baseline::Dense;
use evi_core::prelude::*;
use evi_core::system::CentralForce;
use evi_examples::{
    DoublePendulum, DrivenPendulum, FermiPastaUlam, HarmonicOscillator, HenonHeiles, Kepler,
    SphericalPendulum, StiffSpringPendulum,
};

use crate::scenes::{Cup, DoubleStar, Dumbbell, Elliptic, Line, Morse, OffCentre, Softened};

#[track_caller]
fn check<S: MechanicalSystem>(is_linear: bool, is_beside_uniform_force: bool) {
    let expected = Some(CentralForce { is_linear, is_beside_uniform_force });
    assert_eq!(S::STRUCTURE.central_force, expected, "{}", S::REPORT.name);
    let with_kernels = ["squared_distance", "central_force"];
    assert!(with_kernels.iter().all(|name| S::REPORT.kernels.iter().any(|kernel| kernel.name == *name)));
    assert_eq!(S::REPORT.n_unknowns_of_midpoint_steps(), 1);
}

#[track_caller]
fn check_none<S: MechanicalSystem>() {
    assert_eq!(S::STRUCTURE.central_force, None, "{}", S::REPORT.name);
    assert!(S::REPORT.kernels.iter().all(|kernel| kernel.name != "central_force"), "{}", S::REPORT.name);
    assert_eq!(S::REPORT.n_unknowns_of_midpoint_steps(), S::REPORT.n_unknowns_after_elimination());
}

#[test]
fn one_force_along_a_distance_is_found() {
    check::<StiffSpringPendulum>(true, true);
    check::<OffCentre>(true, true);
    check::<Dumbbell>(true, true);
    check::<Kepler>(false, false);
    check::<DoubleStar>(false, false);
    check::<Morse>(false, false);
    check::<Cup>(false, false);
    check::<Softened>(false, false);
    // Whether masses and distance go together is known when a run is prepared.
    check::<Elliptic>(true, true);
}

/// A scene that is next to one of a central force.
macro_rules! scene {
    ($name:ident, $($item:tt)*) => {
        #[derive(MechanicalSystem)]
        #[evi(coordinates(x, y), $($item)*)]
        struct $name {
            m: f64,
            k: f64,
            l: f64,
        }
    };
}

scene!(
    TwoSprings,
    kinetic = 0.5 * m * (der(x).powi(2) + der(y).powi(2)),
    potential = 0.5 * k * ((x.powi(2) + y.powi(2)).sqrt() - l).powi(2)
        + 0.5 * k * (((x - l).powi(2) + y.powi(2)).sqrt() - l).powi(2)
);
scene!(
    BesideAnother,
    kinetic = 0.5 * m * (der(x).powi(2) + der(y).powi(2)),
    potential = 0.5 * k * ((x.powi(2) + y.powi(2)).sqrt() - l).powi(2) + k * x.cos()
);
scene!(
    BesideALinearForce,
    kinetic = 0.5 * m * (der(x).powi(2) + der(y).powi(2)),
    potential = 0.5 * k * ((x.powi(2) + y.powi(2)).sqrt() - l).powi(2) + 0.5 * k * x.powi(2)
);
scene!(
    TiltedBySlope,
    kinetic = 0.5 * m * (der(x).powi(2) + der(y).powi(2)),
    potential = 0.5 * k * ((x.powi(2) + y.powi(2)).sqrt() - l * x).powi(2)
);
scene!(
    Braked,
    kinetic = 0.5 * m * (der(x).powi(2) + der(y).powi(2)),
    potential = 0.5 * k * ((x.powi(2) + y.powi(2)).sqrt() - l).powi(2),
    dissipation = 0.5 * l * der(x).powi(2)
);
scene!(
    OnALine,
    kinetic = 0.5 * m * (der(x).powi(2) + der(y).powi(2)),
    potential = 0.5 * k * ((x.powi(2) + y.powi(2)).sqrt() - l).powi(2),
    constraint(line: x == l)
);
scene!(
    InAMagneticField,
    lagrangian = 0.5 * m * (der(x).powi(2) + der(y).powi(2)) + l * (x * der(y) - y * der(x))
        - 0.5 * k * ((x.powi(2) + y.powi(2)).sqrt() - l).powi(2)
);
scene!(
    OfVaryingMass,
    kinetic = 0.5 * m * (der(x).powi(2) + (1.0 + x.powi(2)) * der(y).powi(2)),
    potential = 0.5 * k * ((x.powi(2) + y.powi(2)).sqrt() - l).powi(2)
);
scene!(
    Quadratic,
    kinetic = 0.5 * m * (der(x).powi(2) + der(y).powi(2)),
    potential = 0.5 * k * (x.powi(2) + y.powi(2)) + l * y
);
// What one coordinate does is no less than what its distance does.
#[derive(MechanicalSystem)]
#[evi(coordinates(x), kinetic = 0.5 * m * der(x).powi(2), potential = 0.25 * k * (x - l).powi(4))]
struct OneCoordinate {
    m: f64,
    k: f64,
    l: f64,
}

// Of three squares in two coordinates the sum need not vanish where its gradient does.
scene!(
    ThreeSquares,
    kinetic = 0.5 * m * (der(x).powi(2) + der(y).powi(2)),
    potential = k * (x.powi(2) + y.powi(2) + (x + y - l).powi(2)).sqrt()
);
// A weight that is a parameter may be zero or negative.
scene!(
    Weighted,
    kinetic = 0.5 * m * (der(x).powi(2) + der(y).powi(2)),
    potential = l * (x.powi(2) + k * y.powi(2)).sqrt()
);
scene!(
    Hyperbolic,
    kinetic = 0.5 * m * (der(x).powi(2) + der(y).powi(2)),
    potential = k * (x.powi(2) - 0.1 * y.powi(2) + l).cos()
);

/// A spring whose rest length changes with time.
#[derive(MechanicalSystem)]
#[evi(
    coordinates(x, y),
    kinetic = 0.5 * m * (der(x).powi(2) + der(y).powi(2)),
    potential = 0.5 * k * ((x.powi(2) + y.powi(2)).sqrt() - l * t.cos()).powi(2),
)]
struct InTime {
    m: f64,
    k: f64,
    l: f64,
}

#[test]
fn other_forces_are_not_taken_for_one() {
    check_none::<TwoSprings>();
    check_none::<BesideAnother>();
    check_none::<BesideALinearForce>();
    check_none::<TiltedBySlope>();
    check_none::<InTime>();
    check_none::<Braked>();
    check_none::<OnALine>();
    check_none::<InAMagneticField>();
    check_none::<OfVaryingMass>();
    check_none::<Quadratic>();
    check_none::<ThreeSquares>();
    check_none::<OneCoordinate>();
    check_none::<Weighted>();
    check_none::<Hyperbolic>();
    check_none::<HarmonicOscillator>();
    check_none::<DoublePendulum>();
    check_none::<SphericalPendulum>();
    check_none::<DrivenPendulum>();
    check_none::<HenonHeiles>();
    check_none::<FermiPastaUlam>();
    // A scene in which nothing is taken advantage of.
    assert_eq!(Dense::<StiffSpringPendulum>::STRUCTURE.central_force, None);
}

#[test]
fn a_distance_on_a_line_is_one() {
    check::<Line>(false, true);
}
