//! The impulses of the steps so far, and what they let expect.

use crate::array::Array;
use crate::memory::memory;
use crate::system::MechanicalSystem;

/// The impulses so far. They affect the number of corrections and the last bits of a state, nothing else: a prediction that misses is not
/// followed.
// Aligned, so that instructions on two numbers take them from where they are.
#[repr(C, align(16))]
pub(super) struct History<S: MechanicalSystem> {
    /// The first guess of the next step: what a cubic through the last four impulses predicts.
    pub(super) predicted: S::PerConstraint<f64>,
    /// At the end of the next step, if it goes as predicted.
    pub(super) expected: S::PerConstraint<f64>,
    /// Impulses of the last three steps, newest first.
    pub(super) previous: [S::PerConstraint<f64>; 3],
}

impl<S: MechanicalSystem> History<S> {
    /// Before the first step.
    pub(super) fn none() -> Self {
        let none = S::PerConstraint::<f64>::from_fn(|_| 0.0);
        let previous = [none.clone(), none.clone(), none.clone()];
        Self { predicted: none.clone(), expected: none, previous }
    }

    /// The impulse at the end of a step, from that at its start. Averages of the multipliers with the weights `1 − τ` and `τ`,
    /// they belong to the times `⅓ h` and `⅔ h`.
    #[inline(always)]
    pub(super) fn expected_end_impulse(&self, impulse: &S::PerConstraint<f64>) -> S::PerConstraint<f64> {
        Array::from_fn(|c| impulse[c] + (1.0 / 3.0) * (impulse[c] - self.previous[0][c]))
    }

    /// Adds the impulse of a step that was taken.
    #[inline(always)]
    pub(super) fn remember(&mut self, impulse: S::PerConstraint<f64>) {
        let [first, second, third] = &mut self.previous;
        // One by one: a list that is moved as a whole goes through memory.
        for c in 0..S::N_CONSTRAINTS {
            let predicted = 4.0 * (impulse[c] + second[c]) - (6.0 * first[c] + third[c]);
            self.expected[c] = predicted + (1.0 / 3.0) * (predicted - impulse[c]);
            self.predicted[c] = predicted;
            third[c] = second[c];
            second[c] = first[c];
            first[c] = impulse[c];
        }
    }
}

memory!([S: MechanicalSystem] History<S>, |words| Self { predicted, expected, previous } => {
    words.numbers(predicted);
    words.numbers(expected);
    words.part(previous);
});
