//! What the last steps let expect of the next one.

use crate::memory::memory;

/// A prediction is followed where it missed the last step by no more than this fraction.
const TRUSTED: f64 = 1.0 / 64.0;

/// The parabola through the last three values of a vector. It affects the number of corrections and the last bits of a state, nothing else.
pub(super) struct History {
    predicted: Vec<f64>,
    /// The last one, and the one before.
    previous: [Vec<f64>; 2],
    known: usize,
    is_trusted: bool,
}

impl History {
    /// Before the first step.
    pub(super) fn none(length: usize) -> Self {
        let none = vec![0.0; length];
        Self { predicted: none.clone(), previous: [none.clone(), none], known: 0, is_trusted: false }
    }

    /// Overwrites `guess` with what is expected of the next step, if it can be trusted.
    pub(super) fn predict(&self, guess: &mut [f64]) -> bool {
        if self.is_trusted {
            guess.copy_from_slice(&self.predicted);
        }
        self.is_trusted
    }

    /// Adds what a step has found.
    pub(super) fn remember(&mut self, found: &[f64]) {
        let (mut missed, mut whole) = (0.0, 0.0);
        let [last, before] = &mut self.previous;
        for (i, &found) in found.iter().enumerate() {
            let miss = found - self.predicted[i];
            missed += miss * miss;
            whole += found * found;
            self.predicted[i] = 3.0 * (found - last[i]) + before[i];
            before[i] = found;
        }
        std::mem::swap(last, before);
        self.known = (self.known + 1).min(4);
        // The first prediction by three values is that of the fourth.
        self.is_trusted = self.known > 3 && missed <= TRUSTED * TRUSTED * whole;
    }

    /// Drops the past.
    pub(super) fn forget(&mut self) {
        (self.known, self.is_trusted) = (0, false);
    }
}

memory!([] History, |words| Self { predicted, previous: [last, before], known, is_trusted } => {
    for values in [predicted, last, before] {
        words.slice(values);
    }
    words.index(known);
    words.flag(is_trusted);
});

#[cfg(test)]
mod tests {
    use super::History;

    #[test]
    fn a_parabola_is_predicted_once_it_has_been_right() {
        let mut history = History::none(1);
        let mut guess = [0.0];
        let value = |step: f64| 10.0 + step - 0.01 * step * step;
        for step in 0..4 {
            assert!(!history.predict(&mut guess), "trusted before step {step}");
            history.remember(&[value(f64::from(step))]);
        }
        assert!(history.predict(&mut guess) && (guess[0] - value(4.0)).abs() < 1e-13, "{guess:?}");
        history.remember(&[-value(4.0)]);
        assert!(!history.predict(&mut guess), "trusted after a miss");
    }
}
