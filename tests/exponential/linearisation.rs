//! Linearised scenes: normal frequencies, equilibria, and references at rest.

use evi_core::mechanics::Mechanics;
use evi_core::prelude::*;
use evi_core::scheme::LinearisationError;
use evi_examples::{DoublePendulum, HarmonicOscillator, SphericalPendulum};
use evi_tests::largest_difference;
use evi_tests::scenes::{ChargedParticle, DoublePendulumInAngles, Dumbbell, KapitzaPendulum};

use super::fixtures::{Molecule, Ring};

const HANGING: [f64; 4] = [0.0, -1.0, 0.0, -2.0];

#[test]
fn the_double_pendulum_has_its_normal_frequencies() {
    let linearisation =
        Mechanics::new(&DoublePendulum::UNIT).linearised_at(&HANGING).expect("an equilibrium");
    let frequencies: Vec<f64> = linearisation.squared_frequencies().iter().map(|x| x.sqrt()).collect();
    println!("{frequencies:?}");
    assert_eq!(frequencies.len(), 2);
    assert!((frequencies[0] - 2.3972).abs() < 5e-5 && (frequencies[1] - 5.7874).abs() < 5e-5);
    // Ω = g [[3, −1], [−1, 1]] for either direction.
    for (row, stiffness) in linearisation.stiffness().iter().enumerate() {
        for (col, stiffness) in stiffness.iter().enumerate() {
            let block = [[3.0, -1.0], [-1.0, 1.0]][row / 2][col / 2];
            let expected = if row % 2 == col % 2 { 9.81 * block } else { 0.0 };
            assert!((stiffness - expected).abs() < 1e-13, "{stiffness} for {expected}");
        }
    }
}

/// The same pendulum with constraints and in angles, where the mass matrix depends on the configuration.
#[test]
fn frequencies_do_not_depend_on_the_coordinates() {
    let angles = DoublePendulumInAngles::UNEQUAL;
    let hanging = [0.0, -angles.l1, 0.0, -angles.l1 - angles.l2];
    let constrained = Mechanics::new(&angles.constrained()).linearised_at(&hanging).expect("an equilibrium");
    let free = Mechanics::new(&angles).linearised_at(&[0.0; 2]).expect("an equilibrium");
    assert_eq!(free.squared_frequencies().len(), 2);
    for (a, b) in constrained.squared_frequencies().iter().zip(free.squared_frequencies()) {
        println!("{a} {b}");
        // 2 roundings measured.
        assert!((a / b - 1.0).abs() <= 8.0 * f64::EPSILON, "{a} {b}");
    }
    // Shapes are tangent to the rods, which hang down, and of unit length in the metric of the masses.
    for shape in constrained.shapes() {
        assert!(shape[1].abs() < 1e-15 && shape[3].abs() < 1e-15, "{shape:?}");
        let length = 1.3 * shape[0] * shape[0] + 0.7 * shape[2] * shape[2];
        assert!((length - 1.0).abs() < 1e-14);
    }
}

#[test]
fn newton_finds_the_equilibrium_next_to_a_guess() {
    let mechanics = Mechanics::new(&DoublePendulum::UNIT);
    let near = DoublePendulum::UNIT.at_angles(0.4, -0.3).q;
    let found = mechanics.linearised_at(&near).expect("an equilibrium");
    assert!(largest_difference(found.configuration(), &HANGING) < 1e-15, "{:?}", found.configuration());
    assert!(largest_difference(found.multipliers(), &[9.81, 4.905]) < 1e-14);
    // Not on the constraints either: projected first.
    let off = mechanics.linearised_at(&[0.1, -1.3, -0.2, -2.4]).expect("an equilibrium");
    assert!(largest_difference(off.configuration(), &HANGING) < 1e-15);
    // Upside down everything grows.
    let upright = mechanics.linearised_at(&[0.01, 1.0, 0.0, 2.0]).expect("an equilibrium");
    assert!(upright.squared_frequencies().iter().all(|squared| *squared < -1.0));
}

#[test]
fn neutral_directions_are_modes_of_frequency_zero() {
    let molecule =
        Mechanics::new(&Molecule::STANDARD).linearised_at(&Molecule::REST).expect("an equilibrium");
    let squared = molecule.squared_frequencies();
    println!("{squared:?}");
    assert!(squared[..2].iter().all(|x| *x == 0.0), "translations");
    assert!(squared[2] > 1.0);
    let dumbbell = Dumbbell::STANDARD;
    let linearisation =
        Mechanics::new(&dumbbell).linearised_at(&dumbbell.turning().q).expect("at rest anywhere");
    assert_eq!(linearisation.squared_frequencies(), [0.0; 3]);
}

#[test]
fn what_has_no_linearisation_says_why() {
    fn error<S: MechanicalSystem>(system: S, q: S::PerCoordinate<f64>) -> LinearisationError {
        Mechanics::new(&system).linearised_at(&q).err().expect("no linearisation")
    }
    let time = error(KapitzaPendulum::STANDARD, KapitzaPendulum::STANDARD.near_inverted().q);
    assert!(time.to_string().contains("time"), "{time}");
    let gyroscopic = error(ChargedParticle { m: 1.0, b: 2.0 }, [0.0; 2]);
    assert!(gyroscopic.to_string().contains("linear in the velocity"), "{gyroscopic}");
    // A sphere in gravity, from its equator: no direction down is preferred.
    let sphere = error(SphericalPendulum::UNIT, [1.0, 0.0, 0.0]);
    assert!(matches!(sphere, LinearisationError::NoEquilibrium { .. }), "{sphere}");
    let massless = error(Ring { m: 0.0, r: 1.0 }, [1.0, 0.0]);
    assert!(
        matches!(massless, LinearisationError::Projection { pivot_ratio } if pivot_ratio < 1e-15),
        "{massless}"
    );
    let negative = error(HarmonicOscillator { m: -1.0, k: 1.0 }, [0.0]);
    assert_eq!(negative, LinearisationError::Mass);
    let infinite = Mechanics::new(&HarmonicOscillator { m: 1.0, k: f64::INFINITY });
    assert_eq!(infinite.linearised_along(&[1.0], &[0.0]).err(), Some(LinearisationError::NotFinite));
    let angles = Mechanics::new(&DoublePendulumInAngles::UNEQUAL).linearised_along(&[0.1, 0.2], &[0.0; 2]);
    assert!(angles.err().expect("refused").to_string().contains("constant mass"));
}

/// Distance from the start after 1,000 steps from rest.
#[track_caller]
fn wander<F: Scheme<DoublePendulum>>(scheme: F) -> f64 {
    let mut run = Simulation::new(DoublePendulum::UNIT, scheme).start(HANGING, [0.0; 4]).expect("a start");
    let mut largest = 0.0_f64;
    for _ in 0..1_000 {
        let state = run.advance().expect("a step");
        largest = largest
            .max(largest_difference(state.q(), &HANGING))
            .max(largest_difference(state.v(), &[0.0; 4]));
    }
    println!("{}: {largest:.1e}", core::panic::Location::caller());
    largest
}

#[test]
fn a_reference_at_rest_stays_at_rest() {
    let h = 0.05;
    assert!(wander(Evi::trapezoid(h).linearised_at(HANGING)) <= 1e-14);
    assert!(wander(Evi::midpoint(h).linearised_at(HANGING)) <= 1e-14);
    assert!(wander(Evi::simpson(h).frequency(3.0).about(HANGING)) <= 1e-14);
    let each = [2.0, 2.0, 3.0, 3.0].map(Frequency::from);
    assert!(wander(Evi::midpoint(h).frequencies(each).about(HANGING)) <= 1e-14);
}

/// A reference matters where nothing holds the coordinates to the origin.
#[test]
fn without_a_reference_the_origin_is_taken_for_the_equilibrium() {
    let molecule = Molecule::STANDARD;
    let moved = |scheme: &dyn Fn() -> Result<f64, StartError>| scheme().expect("a start");
    let distance = |q: &[f64; 6]| largest_difference(q, &Molecule::REST);
    let plain = moved(&|| {
        let mut run =
            Simulation::new(molecule, Evi::simpson(0.01).frequency(6.0)).start(Molecule::REST, [0.0; 6])?;
        Ok(distance(run.advance_to(2.0).expect("every step").q()))
    });
    let about = moved(&|| {
        let scheme = Evi::simpson(0.01).frequency(6.0).about(Molecule::REST);
        let mut run = Simulation::new(molecule, scheme).start(Molecule::REST, [0.0; 6])?;
        Ok(distance(run.advance_to(2.0).expect("every step").q()))
    });
    println!("{plain:.1e} {about:.1e}");
    assert!(plain > 1e-3 && about <= 1e-14, "{plain:e} {about:e}");
}

/// What the structure of the scene does not show, its linearisation does: translations grow on curves of a frequency, as
/// foretold.
#[test]
fn the_growth_of_translations_is_foretold() {
    let (molecule, h, frequency) = (Molecule::STANDARD, 0.05, Frequency::from(6.0));
    let linearisation = Mechanics::new(&molecule).linearised_at(&Molecule::REST).expect("an equilibrium");
    let simpson = Quadrature::<3>::uniform();
    let rates: Vec<f64> = linearisation.growth_rates(frequency, &simpson, h).collect();
    println!("{rates:?}");
    assert!(rates[0] > 0.4 && rates[1] == rates[0]);
    assert!(rates[2..].iter().all(|rate| *rate == 0.0), "vibrations are near the frequency");
    assert!(linearisation.growth_rates(frequency, &Quadrature::midpoint(), h).all(|rate| rate == 0.0));

    let scheme = Evi::simpson(h).frequency(frequency).about(Molecule::REST);
    let moved = Molecule::REST.map(|q| q + 1e-3);
    let mut run = Simulation::new(molecule, scheme).start(moved, [0.0; 6]).expect("a start");
    let (early, late) = (4.0, 8.0);
    let displacement = |state: &State<Molecule>| state.q()[3];
    let before = displacement(run.advance_to(early).expect("every step"));
    let after = displacement(run.advance_to(late).expect("every step"));
    let expected = (rates[0] * late).cosh() / (rates[0] * early).cosh();
    println!("{} for {expected}", after / before);
    // The molecule moves as a whole.
    assert!((after / before / expected - 1.0).abs() < 1e-3, "{} for {expected}", after / before);
}
