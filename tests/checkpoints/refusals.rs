//! Checkpoints that a simulation does not go on from, each with its reason.

use std::path::Path;

use evi_core::integrator::Statistics;
use evi_core::prelude::*;
use evi_examples::{DoublePendulum, Pendulum};

use crate::file;

const DOUBLE: DoublePendulum = DoublePendulum { m1: 1.3, m2: 0.7, l1: 0.9, l2: 1.1, g: 9.81 };

fn curved(frequency: f64) -> Evi<3, Frequency> {
    Evi::simpson(0.01).frequency(frequency)
}

fn checkpoint() -> Checkpoint {
    let start = DOUBLE.at_angles(0.3, -0.2);
    let mut run = Simulation::new(DOUBLE, curved(2.4)).start(start.q, start.v).unwrap();
    run.advance_to(0.1).unwrap();
    run.checkpoint()
}

#[track_caller]
fn refusal<S: MechanicalSystem, F: Scheme<S>>(system: S, scheme: F, checkpoint: &Checkpoint) -> ResumeError {
    let Err(error) = Simulation::new(system, scheme).resume(checkpoint) else { panic!("it was resumed") };
    println!("{error}");
    error
}

#[test]
fn another_simulation_says_in_what_it_differs() {
    let checkpoint = checkpoint();
    assert!(Simulation::new(DOUBLE, curved(2.4)).resume(&checkpoint).is_ok());

    let pendulum = Pendulum { m: 1.0, l: 1.0, g: 9.81 };
    let error = refusal(pendulum, Evi::simpson(0.01).frequency(2.4), &checkpoint);
    assert!(matches!(&error, ResumeError::OtherScene { checkpoint, simulation }
        if checkpoint == "DoublePendulum" && simulation == "Pendulum"));
    let error = refusal(DoublePendulum { g: 9.82, ..DOUBLE }, curved(2.4), &checkpoint);
    assert!(
        matches!(error, ResumeError::OtherParameters { checkpoint, simulation } if checkpoint != simulation)
    );
    let error = refusal(DOUBLE, Evi::simpson(0.01), &checkpoint);
    assert!(error.to_string().contains("`EviStep<DoublePendulum, Linear, 3>`"), "{error}");
    assert!(matches!(error, ResumeError::OtherMap { .. }));
    let error = refusal(DOUBLE, Evi::simpson(0.02).frequency(2.4), &checkpoint);
    assert_eq!(error, ResumeError::StepSize { checkpoint: 0.01, simulation: 0.02 });
    assert_eq!(refusal(DOUBLE, curved(2.5), &checkpoint), ResumeError::OtherScheme);
    let gauss = Evi::new(Quadrature::<3>::gauss(), 0.01).frequency(2.4);
    assert_eq!(refusal(DOUBLE, gauss, &checkpoint), ResumeError::OtherScheme);
    assert!(matches!(refusal(DOUBLE, curved(-1.0), &checkpoint), ResumeError::Scheme(_)));
    let statistics = Simulation::new(DOUBLE, curved(2.4)).resume_with(&checkpoint, Statistics::default());
    assert!(matches!(statistics.err(), Some(ResumeError::OtherTally { .. })));
}

/// The same name and numbers, but another potential.
mod changed {
    use evi_core::prelude::*;

    #[derive(MechanicalSystem)]
    #[evi(
        coordinates(theta),
        kinetic = 0.5 * m * l.powi(2) * der(theta).powi(2),
        potential = -m * g * l * theta.sin(),
    )]
    pub(super) struct Pendulum {
        pub(super) m: f64,
        pub(super) l: f64,
        pub(super) g: f64,
    }
}

#[test]
fn equations_that_have_changed_are_noticed() {
    let scheme = Evi::midpoint(0.01);
    let run = Simulation::new(Pendulum { m: 1.0, l: 1.0, g: 9.81 }, scheme).start([0.3], [0.0]).unwrap();
    let error = refusal(changed::Pendulum { m: 1.0, l: 1.0, g: 9.81 }, scheme, &run.checkpoint());
    assert_eq!(error, ResumeError::OtherEquations { scene: "Pendulum".into() });
}

#[test]
fn json_is_exact_and_damage_is_found() {
    let checkpoint = checkpoint();
    let json = serde_json::to_string(&checkpoint).unwrap();
    assert_eq!(serde_json::from_str::<Checkpoint>(&json).unwrap(), checkpoint);

    // Every digit counts: one of them is another, anywhere.
    let digits: Vec<usize> =
        json.bytes().enumerate().filter(|(_, byte)| byte.is_ascii_digit()).map(|(i, _)| i).collect();
    assert!(digits.len() > 500, "{json}");
    let (mut damaged, mut unreadable) = (0, 0);
    for &place in &digits {
        let mut changed = json.clone().into_bytes();
        changed[place] = if changed[place] == b'7' { b'3' } else { b'7' };
        match serde_json::from_slice::<Checkpoint>(&changed) {
            // Larger than 64 bits.
            Err(_) => unreadable += 1,
            Ok(changed) => {
                let error = Simulation::new(DOUBLE, curved(2.4)).resume(&changed).err();
                let is_found =
                    matches!(error, Some(ResumeError::Damaged { .. } | ResumeError::Format { .. }));
                assert!(is_found, "{error:?}");
                damaged += 1;
            }
        }
    }
    println!("{} digits: {damaged} found by the checksum, {unreadable} not readable", digits.len());
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("cut_off_{}.json", std::process::id()));
    assert!(file::read(&path).unwrap().is_none());
    file::write(&checkpoint, &path).unwrap();
    assert_eq!(file::read(&path).unwrap(), Some(checkpoint));
    for length in [0, 1, json.len() / 2, json.len() - 1] {
        std::fs::write(&path, &json[..length]).unwrap();
        let error = file::read(&path).unwrap_err();
        assert!(error.to_string().contains("is no whole checkpoint: EOF while parsing"), "{error}");
    }
    std::fs::remove_file(&path).unwrap();
}
