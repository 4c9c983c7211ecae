//! Sparsity of systems whose derivatives one knows by hand.

use super::systems::{DOUBLE_PENDULUM, HARMONIC_OSCILLATOR, PENDULUM, STIFF_SPRING_PENDULUM};
use super::workbench::{Compiled, compiled};
use crate::expr::Dependence;
use crate::structure::{Entry, EntryValue};

const CONSTANT: Dependence = Dependence { on_q: false, on_v: false, on_t: false };
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
    // Of the six entries of G, 2(x2 − x1) and its negative differ, as do those of y.
    assert_eq!(structure.jacobian_entries.len(), 6);
    assert_eq!((structure.mass, structure.constraints), (CONSTANT, ON_Q));
    assert_eq!(structure.lagrangian, Dependence { on_q: true, on_v: true, on_t: false });
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
    assert_eq!(structure.mass, Dependence { on_q: true, on_v: true, on_t: false });
    assert_eq!(structure.constraints, Dependence { on_q: true, on_v: false, on_t: true });
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
    assert_eq!(programs.structure.lagrangian, Dependence { on_q: false, on_v: true, on_t: false });
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
