//! What no equation uses is in no step: scenes with and without unused features execute the same number of instructions per step,
//! to the last one. Counted by valgrind's callgrind, which runs this program again; without valgrind there is nothing to compare.

use std::process::Command;

use evi_core::prelude::*;
use evi_examples::GRAVITY;

/// Two bobs on rods, a quadratic Lagrangian, with more fields, definitions and potential energy.
macro_rules! folded {
    ($name:ident, { $($field:ident)* }, [$($definition:tt)*], $($potential:tt)*) => {
        #[derive(MechanicalSystem, Clone, Copy)]
        #[evi(
            coordinates(x1, y1, x2, y2),
            $($definition)*
            kinetic = 0.5 * m1 * (der(x1).powi(2) + der(y1).powi(2)) + 0.5 * m2 * (der(x2).powi(2) + der(y2).powi(2)),
            potential = g * (m1 * y1 + m2 * y2) $($potential)*,
            constraint(rod1: x1.powi(2) + y1.powi(2) == 1.0),
            constraint(rod2: (x2 - x1).powi(2) + (y2 - y1).powi(2) == 1.0),
        )]
        #[allow(dead_code, reason = "fields that no equation names are what is tested")]
        struct $name {
            m1: f64,
            $($field: f64,)*
            m2: f64,
            g: f64,
        }

        impl Counted for $name {
            fn take(steps: u64) -> f64 {
                let system = Self { m1: 1.3, $($field: 2.0,)* m2: 0.7, g: GRAVITY };
                take(system, [0.6, -0.8, 1.4, -1.4], steps)
            }
        }
    };
}

folded!(Folded, {}, [],);
folded!(FoldedWithField, { colour }, [],);
folded!(FoldedWithDefinition, {}, [let radius = (x1.powi(2) + y1.powi(2)).sqrt(),],);
folded!(FoldedWithNothing, { k }, [], + 0.0 * k * x1.powi(4) + 0.0);
folded!(FoldedWithBystanders, { k }, [
    dissipation = 0.0 * k * der(x1).powi(2),
    force(y1: k * x2 - k * x2),
    frequency(x1: k),
    observe(height: y1 * t),
],);
folded!(FoldedWithSpring, { k }, [], + 0.5 * k * (x1 * x2 + y1.powi(2)));

/// A mass on a spring, whose force is not linear, and in a force of its own.
macro_rules! sprung {
    ($name:ident, { $($field:ident)* }, [$($definition:tt)*], $($potential:tt)*) => {
        #[derive(MechanicalSystem, Clone, Copy)]
        #[evi(
            coordinates(x, y),
            let stretch = (x.powi(2) + y.powi(2)).sqrt() - 1.0,
            $($definition)*
            kinetic = 0.5 * m * (der(x).powi(2) + der(y).powi(2)),
            potential = 50.0 * stretch.powi(2) + m * g * y $($potential)*,
        )]
        #[allow(dead_code, reason = "fields that no equation names are what is tested")]
        struct $name {
            m: f64,
            $($field: f64,)*
            g: f64,
        }

        impl Counted for $name {
            fn take(steps: u64) -> f64 {
                take(Self { m: 1.3, $($field: 2.0,)* g: GRAVITY }, [1.0, 0.3], steps)
            }
        }
    };
}

// One force along a distance.
sprung!(Central, {}, [],);
sprung!(CentralWithField, { colour }, [],);
sprung!(CentralWithDefinition, {}, [let angle = (y / x).atan(),],);
sprung!(CentralWithNothing, { k }, [], + 0.0 * k * x.powi(4) + 0.0);
sprung!(CentralWithBystanders, { k }, [
    dissipation = 0.0 * k * der(x).powi(2),
    force(y: k * x - k * x),
    frequency(x: k),
    observe(height: y * t),
],);
sprung!(CentralWithHardening, { k }, [], + 0.5 * k * stretch.powi(4));

// Forces along two.
sprung!(General, {}, [], + x.powi(4));
sprung!(GeneralWithField, { colour }, [], + x.powi(4));
sprung!(GeneralWithDefinition, {}, [let angle = (y / x).atan(),], + x.powi(4));
sprung!(GeneralWithNothing, { k }, [], + x.powi(4) + 0.0 * k * x.powi(4) + 0.0);
sprung!(GeneralWithBystanders, { k }, [
    dissipation = 0.0 * k * der(x).powi(2),
    force(y: k * x - k * x),
    frequency(x: k),
    observe(height: y * t),
], + x.powi(4));
sprung!(GeneralWithSpring, { k }, [], + x.powi(4) + 0.5 * k * y.powi(4));

trait Counted {
    /// Takes so many steps.
    fn take(steps: u64) -> f64;
}

fn take<const N: usize, S>(system: S, q: [f64; N], steps: u64) -> f64
where
    S: MechanicalSystem<PerCoordinate<f64> = [f64; N]>,
{
    let simulation = Simulation::new(system, Evi::midpoint(0.01));
    let mut run = simulation.start_projected(0.0, q, [0.0; N]).expect("near the constraints");
    counted_steps(&mut run, steps);
    run.state().q()[0]
}

/// The steps, which alone are counted: callgrind knows the function by its name.
#[inline(never)]
fn counted_steps<S: MechanicalSystem, M: OneStep<S>>(run: &mut Run<S, M>, steps: u64) {
    for _ in 0..steps {
        run.advance().expect("solvable");
    }
}

type Take = fn(u64) -> f64;

const SCENES: [(&str, Take); 18] = [
    ("folded", Folded::take),
    ("folded, unused field", FoldedWithField::take),
    ("folded, unused let", FoldedWithDefinition::take),
    ("folded, zero potential", FoldedWithNothing::take),
    ("folded, zero force, frequency, observed", FoldedWithBystanders::take),
    ("folded, a spring", FoldedWithSpring::take),
    ("general", General::take),
    ("general, unused field", GeneralWithField::take),
    ("general, unused let", GeneralWithDefinition::take),
    ("general, zero potential", GeneralWithNothing::take),
    ("general, zero force, frequency, observed", GeneralWithBystanders::take),
    ("general, a spring", GeneralWithSpring::take),
    ("central", Central::take),
    ("central, unused field", CentralWithField::take),
    ("central, unused let", CentralWithDefinition::take),
    ("central, zero potential", CentralWithNothing::take),
    ("central, zero force, frequency, observed", CentralWithBystanders::take),
    ("central, a spring that hardens", CentralWithHardening::take),
];

const COUNTED: u64 = 1_000;
/// Tells the program under valgrind which scene to step.
const SCENE: &str = "EVI_COUNTED_SCENE";

#[test]
#[ignore = "takes the steps that the other test counts"]
fn steps_to_count() {
    let Ok(scene) = std::env::var(SCENE) else { return };
    let (_, take) = SCENES[scene.parse::<usize>().expect("an index of SCENES")];
    println!("{}", take(COUNTED));
}

/// Instructions of `COUNTED` steps, or `None` where valgrind does not run.
fn instructions(scene: usize) -> Option<u64> {
    let output = Command::new("valgrind")
        .args(["--tool=callgrind", "--callgrind-out-file=/dev/null", "--toggle-collect=*counted_steps*"])
        .arg(std::env::current_exe().ok()?)
        .args(["--exact", "steps_to_count", "--ignored", "--test-threads=1"])
        .env(SCENE, scene.to_string())
        .output()
        .ok()?;
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let report = String::from_utf8(output.stderr).ok()?;
    report.split("Collected :").nth(1)?.split_whitespace().next()?.parse().ok()
}

#[test]
fn what_nothing_uses_adds_no_instruction_to_a_step() {
    if instructions(0).is_none() {
        println!("valgrind does not run here: instructions are not compared");
        return;
    }
    let counts: Vec<u64> =
        (0..SCENES.len()).map(|scene| instructions(scene).expect("valgrind runs")).collect();
    for ((name, _), count) in SCENES.iter().zip(&counts) {
        println!("{name:<40} {count} instructions in {COUNTED} steps");
    }
    // Something is counted. A central force takes 90 instructions per step.
    for (counts, fewest) in counts.chunks(6).zip([100, 100, 50]) {
        let [plain, field, definition, nothing, bystanders, spring] = counts else {
            unreachable!("six of each")
        };
        assert_eq!([field, definition, nothing, bystanders], [plain; 4]);
        // And it depends on the scene.
        assert!(*plain > fewest * COUNTED && spring != plain);
    }
}
