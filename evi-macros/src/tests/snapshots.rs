//! The expansions of the small systems as files, headed by what each kernel costs.
//!
//! `UPDATE_EXPECT=1 cargo test -p evi-macros` rewrites them.

use expect_test::{ExpectFile, expect_file};

use super::systems::{
    DOUBLE_PENDULUM, HARMONIC_OSCILLATOR, PENDULUM, PUSHED_OSCILLATOR, SPHERICAL_PENDULUM,
    STIFF_SPRING_PENDULUM,
};
use super::workbench::{Compiled, compiled};
use crate::pipeline::expand;
use crate::schedule::{Operations, Program};

#[track_caller]
fn check(source: &str, snapshot: ExpectFile) {
    let expansion = expand(source.parse().expect("a test's struct is made of Rust tokens"));
    let file = syn::parse2(expansion).expect("the expansion is Rust");
    let text = format!("{}\n{}", costs(&compiled(source)), prettyplease::unparse(&file));
    snapshot.assert_eq(&text);
}

/// A table of operations per kernel, as a comment.
fn costs(Compiled { programs, .. }: &Compiled) -> String {
    let line = |(name, program): (&str, &Program)| {
        let Operations { additions, multiplications, divisions, functions } = program.operations;
        format!("// {name:<24}{additions:>4}{multiplications:>4}{divisions:>4}{functions:>4}\n")
    };
    let head = format!("// {:<24}{:>4}{:>4}{:>4}{:>4}\n", "operations", "+ -", "*", "/", "f()");
    head + &programs.kernels().into_iter().map(line).collect::<String>()
}

#[test]
fn double_pendulum() {
    check(DOUBLE_PENDULUM, expect_file!["../snapshots/double_pendulum.rs"]);
}

#[test]
fn pendulum() {
    check(PENDULUM, expect_file!["../snapshots/pendulum.rs"]);
}

#[test]
fn spherical_pendulum() {
    check(SPHERICAL_PENDULUM, expect_file!["../snapshots/spherical_pendulum.rs"]);
}

#[test]
fn stiff_spring_pendulum() {
    check(STIFF_SPRING_PENDULUM, expect_file!["../snapshots/stiff_spring_pendulum.rs"]);
}

#[test]
fn harmonic_oscillator() {
    check(HARMONIC_OSCILLATOR, expect_file!["../snapshots/harmonic_oscillator.rs"]);
}

#[test]
fn pushed_oscillator() {
    check(PUSHED_OSCILLATOR, expect_file!["../snapshots/pushed_oscillator.rs"]);
}
