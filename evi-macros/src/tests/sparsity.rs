//! Sparsity of systems whose derivatives one knows by hand.

use super::systems::{DOUBLE_PENDULUM, HARMONIC_OSCILLATOR, PENDULUM, STIFF_SPRING_PENDULUM};
use super::workbench::{Compiled, compiled};
use crate::expr::Dependence;
use crate::structure::{Entry, EntryValue};

const CONSTANT: Dependence = Dependence { on_q: false, on_v: false, on_t: false, on_inputs: false };
const ON_Q: Dependence = Dependence { on_q: true, ..CONSTANT };

/// Rows, columns, and `c` for constant or `v` for varying: `"00c 11v"`.
#[track_caller]
fn check(what: &str, entries: &[Entry], expected: &str) {
    let text = |entry: &Entry| {
        let kind = if matches!(entry.value, EntryValue::Constant(_)) { 'c' } else { 'v' };
        format!("{}{}{kind}", entry.row, entry.col)
    };
    assert_eq!(entries.iter().map(text).collect::<Vec<_>>().join(" "), expected, "{what}");
}

#[test]
fn double_pendulum() {
    let Compiled { programs, .. } = compiled(DOUBLE_PENDULUM);
    let structure = &programs.structure;
    // Uniform gravity: the potential is linear.
    check("qq", &structure.hessian_qq, "");
    check("vq", &structure.hessian_vq, "");
    check("vv", &structure.hessian_vv, "00c 11c 22c 33c");
    check("vt", &structure.hessian_vt, "");
    check("G", &structure.jacobian_q, "00v 01v 10v 11v 12v 13v");
    check("φt", &structure.jacobian_t, "");
    assert!(structure.hessian_entries.is_empty(), "no entry varies");
    // Both masses, each for two coordinates.
    assert_eq!(structure.constant_entries.len(), 2);
    // Of the six entries of G, 2(x2 − x1) and its negative differ, as do those of y; the 2 is set apart.
    assert_eq!((structure.jacobian_entries.len(), structure.content), (6, 2.0));
    assert_eq!((structure.mass, structure.constraints), (CONSTANT, ON_Q));
    assert_eq!(structure.lagrangian, Dependence { on_v: true, ..ON_Q });
}

#[test]
fn pendulum() {
    let Compiled { programs, .. } = compiled(PENDULUM);
    check("qq", &programs.structure.hessian_qq, "00v");
    check("vq", &programs.structure.hessian_vq, "");
    check("vv", &programs.structure.hessian_vv, "00c");
    check("G", &programs.structure.jacobian_q, "");
}

#[test]
fn stiff_spring_pendulum() {
    let Compiled { programs, .. } = compiled(STIFF_SPRING_PENDULUM);
    check("qq", &programs.structure.hessian_qq, "00v 10v 11v");
    check("vq", &programs.structure.hessian_vq, "");
    // One mass for both: one constant.
    check("vv", &programs.structure.hessian_vv, "00c 11c");
    assert_eq!(programs.structure.constant_entries.len(), 1);
}

#[test]
fn harmonic_oscillator() {
    let Compiled { programs, .. } = compiled(HARMONIC_OSCILLATOR);
    check("qq", &programs.structure.hessian_qq, "00c");
    check("vv", &programs.structure.hessian_vv, "00c");
    let operations = programs.lagrangian_derivatives.operations;
    assert_eq!((operations.multiplications, operations.functions), (2, 0), "−k x and m v, nothing else");
}

#[test]
fn every_block_when_everything_couples() {
    let Compiled { programs, .. } = compiled(
        "#[evi(
            coordinates(x, y),
            lagrangian = 0.5 * (1.0 + x * x) * der(x).powi(2) + der(x) * der(y) * a + 0.5 * der(y).powi(4)
                       + t * der(x) * y,
            constraint(moving: x * t == y),
        )]
        struct Coupled { a: f64 }",
    );
    let structure = &programs.structure;
    check("qq", &structure.hessian_qq, "00v");
    check("vq", &structure.hessian_vq, "00v 01v");
    check("vv", &structure.hessian_vv, "00v 10c 11v");
    check("vt", &structure.hessian_vt, "00v");
    check("G", &structure.jacobian_q, "00v 01c");
    check("φt", &structure.jacobian_t, "00v");
    assert_eq!(structure.mass, Dependence { on_v: true, ..ON_Q });
    assert_eq!(structure.constraints, Dependence { on_t: true, ..ON_Q });
}

#[test]
fn what_cancels_is_absent() {
    let Compiled { programs, .. } = compiled(
        "#[evi(
            coordinates(x, y),
            lagrangian = 0.5 * der(x).powi(2) + 0.5 * der(y).powi(2) + (x * y - y * x) + (x - x) * y,
        )]
        struct Free;",
    );
    check("qq", &programs.structure.hessian_qq, "");
    assert_eq!(programs.structure.lagrangian, Dependence { on_v: true, ..CONSTANT });
}

#[test]
fn partial_derivatives_are_stored_once() {
    let compiled = compiled(STIFF_SPRING_PENDULUM);
    let mut values: Vec<_> = compiled.programs.structure.hessian_entries.clone();
    let n_entries = values.len();
    values.sort_unstable();
    values.dedup();
    assert_eq!(values.len(), n_entries);
    assert_eq!(compiled.equations.hessian_qq.len(), 3);
}

/// Forces of every kind: their derivatives are found entry by entry, and the saddle-point matrix is eliminated with them.
#[test]
fn forces_have_the_pattern_of_their_own_derivatives() {
    let source = "
        #[evi(
            coordinates(x, y, z),
            kinetic = 0.5 * m * (der(x).powi(2) + der(y).powi(2) + der(z).powi(2)),
            potential = 0.0,
            input(u),
            dissipation = 0.5 * c * (der(x) - der(y)).powi(2),
            force(y: u * x + t),
        )]
        struct Forced { m: f64, c: f64 }";
    let structure = compiled(source).programs.structure;
    let places = |entries: &[crate::structure::Entry]| -> Vec<(usize, usize)> {
        entries.iter().map(|entry| (entry.row, entry.col)).collect()
    };
    assert_eq!(structure.forced, [0, 1]);
    assert_eq!(places(&structure.force_q), [(1, 0)]);
    assert_eq!(places(&structure.force_v), [(0, 0), (0, 1), (1, 0), (1, 1)]);
    // u is set from step to step; c and −c are parameters.
    assert_eq!(structure.force_entries.len(), 1);
    assert_eq!(structure.forces, Dependence { on_v: true, on_t: true, on_inputs: true, ..ON_Q });
    let kkt = structure.kkt_elimination(3, 0).expect("a mass on every diagonal");
    assert!(kkt.entries.contains(&(0, 1)) && kkt.entries.contains(&(1, 0)) && !kkt.entries.contains(&(0, 2)));
    let mass = structure.mass_elimination(3).expect("a mass on every diagonal");
    assert!(
        mass.entries.iter().all(|(row, col)| row == col),
        "the mass matrix is diagonal whatever the forces"
    );
}

/// Forces that cancel leave nothing behind.
#[test]
fn forces_that_vanish_are_absent() {
    let source = "
        #[evi(coordinates(x), lagrangian = 0.5 * der(x).powi(2), force(x: c * der(x) - c * der(x)))]
        struct Unforced { c: f64 }";
    let programs = compiled(source).programs;
    assert!(programs.structure.forced.is_empty() && programs.forces.is_none());
}
