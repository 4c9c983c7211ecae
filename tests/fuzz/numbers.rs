//! Numbers of every kind.

use crate::random_choices::Choices;

/// What is special about floats.
const SPECIAL: [f64; 16] = [
    0.0,
    -0.0,
    -1.0,
    1e16,
    1e-16,
    1e150,
    -1e150,
    1e-150,
    1e300,
    -1e300,
    1e-300,
    5e-324,
    f64::MAX,
    f64::INFINITY,
    f64::NEG_INFINITY,
    f64::NAN,
];

/// A number: of ordinary size in nine cases of ten.
pub(crate) fn number(choices: &mut Choices) -> f64 {
    match choices.below(40) {
        0..=35 => fraction(choices) * 4.0 - 2.0,
        36 => special(choices),
        37 => f64::from_bits(choices.bits()),
        _ => (fraction(choices) - 0.5) * 10_f64.powi(choices.below(61) as i32 - 30),
    }
}

/// A parameter: positive, of ordinary size in nine cases of ten.
pub(crate) fn parameter(choices: &mut Choices) -> f64 {
    if choices.once_in(10) { number(choices) } else { 0.2 + 2.0 * fraction(choices) }
}

/// A step size: below 0.2, backwards or forwards, in four cases of five.
pub(crate) fn step_size(choices: &mut Choices) -> f64 {
    match choices.below(10) {
        0..=5 => 0.2 * fraction(choices),
        6 | 7 => -0.2 * fraction(choices),
        8 => 10_f64.powi(choices.below(601) as i32 - 300),
        _ => number(choices),
    }
}

fn special(choices: &mut Choices) -> f64 {
    choices.pick(&SPECIAL)
}

/// In 0..1, with few digits where the choice is simple.
fn fraction(choices: &mut Choices) -> f64 {
    choices.below(1 << 20) as f64 / f64::from(1 << 20)
}
