//! First guesses from the past.

use crate::array::Array;
use crate::memory::memory;

/// The last values of a quantity that is found anew in every step: the next one lies near the parabola through them.
pub(super) struct Prediction<A> {
    /// Newest first; `None` before the first.
    values: Option<[A; 3]>,
}

impl<A> Default for Prediction<A> {
    fn default() -> Self {
        Self { values: None }
    }
}

impl<A: Array<f64>> Prediction<A> {
    /// The next value, by extrapolation; `None` where no past is known.
    #[inline]
    pub(super) fn predicted(&self) -> Option<A> {
        let [newest, middle, oldest] = self.values.as_ref()?;
        Some(A::from_fn(|i| 3.0 * (newest[i] - middle[i]) + oldest[i]))
    }

    /// Adds a value; the first one stands for those before it.
    #[inline]
    pub(super) fn remember(&mut self, value: A) {
        self.values = Some(match self.values.take() {
            Some([newest, middle, _]) => [value, newest, middle],
            None => [value.clone(), value.clone(), value],
        });
    }

    /// Takes the values to come from the line through `newest` and the value `before` it.
    pub(super) fn remember_line(&mut self, newest: A, before: &A) {
        let oldest = A::from_fn(|i| 2.0 * before[i] - newest[i]);
        self.values = Some([newest, before.clone(), oldest]);
    }

    /// Forgets the past.
    pub(super) fn forget(&mut self) {
        self.values = None;
    }
}

memory!([A: Array<f64>] Prediction<A>, |words| Self { values } => {
    words.optional(values, || core::array::from_fn(|_| A::from_fn(|_| 0.0)));
});

#[cfg(test)]
mod tests {
    use super::Prediction;

    #[test]
    fn a_parabola_is_continued_and_a_first_value_repeated() {
        let mut prediction = Prediction::<[f64; 2]>::default();
        assert_eq!(prediction.predicted(), None);
        let at = |k: f64| [k * k - 3.0 * k, 2.0 - k];
        prediction.remember(at(0.0));
        assert_eq!(prediction.predicted(), Some(at(0.0)));
        (1..=3).for_each(|k| prediction.remember(at(f64::from(k))));
        assert_eq!(prediction.predicted(), Some(at(4.0)));
        prediction.forget();
        assert_eq!(prediction.predicted(), None);
    }
}
