//! What the derive says about mistakes, and what it accepts in silence.
//!
//! A case in `ui/<kind of mistake>/` holds small structs with one mistake each, and beside it what the
//! compiler prints.
//! `TRYBUILD=overwrite cargo test --test ui` writes these files anew; then read them as a user would.

#[test]
fn messages() {
    let cases = trybuild::TestCases::new();
    cases.pass("ui/accepted/*.rs");
    cases.compile_fail("ui/[!a]*/*.rs");
}
