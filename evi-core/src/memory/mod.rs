//! What a one-step map remembers of the steps that it has taken, as a list of words.
//!
//! In: a prepared map. Out: the words of its memory, each the bits of a number, from which an equal map goes on to the last bit. What is constant
//! over a run is not memory: it is prepared again, and [fixed](Record::fixed) numbers of it tell whether it was prepared alike.
//!
//! A map lists its memory once, by the macro `memory!`, which takes it apart into fields, all of them: a field that is added does not compile
//! until somebody has said what becomes of it.

mod digest;

use crate::array::Array;
use crate::scalar::{LANES, Lanes};

pub(crate) use self::digest::Digest;

/// A part of a run that steps change besides the state: predictions from the past, lost digits, counters.
///
/// [`OneStep`](crate::integrator::OneStep) asks for it, so that no map can be written whose runs cannot be continued from a
/// checkpoint. Both functions go over the same words in the same order.
///
/// ```
/// use evi_core::memory::{Memory, Recall, Record};
///
/// /// Counts something.
/// #[derive(Default)]
/// struct Counter { seen: u64 }
///
/// impl Memory for Counter {
///     fn record(&self, words: &mut Record<'_>) {
///         words.count(&self.seen);
///     }
///     fn recall(&mut self, words: &mut Recall<'_>) {
///         words.count(&mut self.seen);
///     }
/// }
///
/// let mut words = Vec::new();
/// Counter { seen: 3 }.record(&mut Record::to(&mut |word| words.push(word)));
/// let (mut counter, mut words) = (Counter::default(), words.into_iter());
/// counter.recall(&mut Recall::from(&mut || words.next().unwrap_or_default()));
/// assert_eq!(counter.seen, 3);
/// ```
pub trait Memory {
    /// Writes every word of the memory.
    fn record(&self, words: &mut Record<'_>);

    /// Overwrites the memory with words that [`record`](Self::record) wrote.
    fn recall(&mut self, words: &mut Recall<'_>);
}

/// Takes the words of a memory.
pub struct Record<'a> {
    sink: &'a mut dyn FnMut(u64),
    fixed: Digest,
}

/// Gives the words of a memory back.
pub struct Recall<'a> {
    source: &'a mut dyn FnMut() -> u64,
}

/// Implements [`Memory`] for a type from one list of words: `memory!([GENERICS] TYPE, |words| PATTERN => BODY)`. The pattern takes `self` apart, without
/// `..`; the body is the same for both directions, since [`Record`] takes references where [`Recall`] takes mutable ones.
macro_rules! memory {
    ([$($generics:tt)*] $type:ty, |$words:ident| $pattern:pat => $body:block) => {
        impl<$($generics)*> $crate::memory::Memory for $type {
            fn record(&self, $words: &mut $crate::memory::Record<'_>) {
                let $pattern = self;
                $body
            }

            fn recall(&mut self, $words: &mut $crate::memory::Recall<'_>) {
                let $pattern = self;
                $body
            }
        }
    };
}
pub(crate) use memory;

impl<'a> Record<'a> {
    /// A record whose words go to `sink`.
    pub fn to(sink: &'a mut dyn FnMut(u64)) -> Self {
        Self { sink, fixed: Digest::default() }
    }

    /// A number, bit by bit.
    pub fn number(&mut self, number: &f64) {
        (self.sink)(number.to_bits());
    }

    /// Numbers.
    pub fn numbers(&mut self, numbers: &impl Array<f64>) {
        numbers.as_ref().iter().for_each(|number| self.number(number));
    }

    /// Numbers, several side by side.
    pub fn lanes(&mut self, lanes: &impl Array<Lanes>) {
        lanes.as_ref().iter().for_each(|lanes| self.numbers(&lanes.to_array()));
    }

    /// Numbers of which the map knows how many they are.
    pub fn slice(&mut self, numbers: &[f64]) {
        numbers.iter().for_each(|number| self.number(number));
    }

    /// The same, several side by side.
    pub fn lane_slice(&mut self, lanes: &[Lanes]) {
        lanes.iter().for_each(|lanes| self.numbers(&lanes.to_array()));
    }

    /// Yes or no.
    pub fn flag(&mut self, flag: &bool) {
        (self.sink)(u64::from(*flag));
    }

    /// A count.
    pub fn count(&mut self, count: &u64) {
        (self.sink)(*count);
    }

    /// A small number of things.
    pub fn index(&mut self, index: &usize) {
        (self.sink)(*index as u64);
    }

    /// A memory inside of this one.
    pub fn part(&mut self, part: &impl Memory) {
        part.record(self);
    }

    /// A memory that a run may have or not have; `blank` is one to overwrite.
    pub fn optional<M: Memory>(&mut self, part: &Option<M>, blank: impl FnOnce() -> M) {
        drop(blank);
        self.flag(&part.is_some());
        if let Some(part) = part {
            part.record(self);
        }
    }

    /// A number that the steps of a run share, and that has to be the same where the memory is recalled: of it, the digest is kept.
    pub fn fixed(&mut self, number: f64) {
        self.fixed.add(number.to_bits());
    }

    /// The digest of the fixed numbers.
    #[cfg(feature = "std")]
    pub(crate) const fn digest(&self) -> u64 {
        self.fixed.value()
    }
}

impl<'a> Recall<'a> {
    /// Recalls from the words of `source`.
    pub fn from(source: &'a mut dyn FnMut() -> u64) -> Self {
        Self { source }
    }

    /// A number, bit by bit.
    pub fn number(&mut self, number: &mut f64) {
        *number = f64::from_bits((self.source)());
    }

    /// Numbers.
    pub fn numbers(&mut self, numbers: &mut impl Array<f64>) {
        numbers.as_mut().iter_mut().for_each(|number| self.number(number));
    }

    /// Numbers, several side by side.
    pub fn lanes(&mut self, lanes: &mut impl Array<Lanes>) {
        for lanes in lanes.as_mut() {
            let mut numbers = [0.0; LANES];
            self.numbers(&mut numbers);
            *lanes = Lanes::new(numbers);
        }
    }

    /// Numbers of which the map knows how many they are.
    pub fn slice(&mut self, numbers: &mut [f64]) {
        numbers.iter_mut().for_each(|number| self.number(number));
    }

    /// The same, several side by side.
    pub fn lane_slice(&mut self, lanes: &mut [Lanes]) {
        for lanes in lanes {
            let mut numbers = [0.0; LANES];
            self.numbers(&mut numbers);
            *lanes = Lanes::new(numbers);
        }
    }

    /// Yes or no.
    pub fn flag(&mut self, flag: &mut bool) {
        *flag = (self.source)() != 0;
    }

    /// A count.
    pub fn count(&mut self, count: &mut u64) {
        *count = (self.source)();
    }

    /// A small number of things.
    pub fn index(&mut self, index: &mut usize) {
        *index = (self.source)() as usize;
    }

    /// A memory inside of this one.
    pub fn part(&mut self, part: &mut impl Memory) {
        part.recall(self);
    }

    /// A memory that a run may have or not have; `blank` is one to overwrite.
    pub fn optional<M: Memory>(&mut self, part: &mut Option<M>, blank: impl FnOnce() -> M) {
        let mut is_there = false;
        self.flag(&mut is_there);
        *part = is_there.then(blank);
        if let Some(part) = part {
            part.recall(self);
        }
    }

    /// A number that the steps of a run share: it is there already. See [`Record::fixed`].
    pub fn fixed(&mut self, number: f64) {
        let _ = number;
    }
}

/// Nothing to remember.
impl Memory for () {
    fn record(&self, _words: &mut Record<'_>) {}

    fn recall(&mut self, _words: &mut Recall<'_>) {}
}

/// What is kept on the heap.
#[cfg(feature = "std")]
impl<M: Memory> Memory for std::boxed::Box<M> {
    fn record(&self, words: &mut Record<'_>) {
        (**self).record(words);
    }

    fn recall(&mut self, words: &mut Recall<'_>) {
        (**self).recall(words);
    }
}

/// Several vectors.
impl<A: Array<f64>, const N: usize> Memory for [A; N] {
    fn record(&self, words: &mut Record<'_>) {
        self.iter().for_each(|numbers| words.numbers(numbers));
    }

    fn recall(&mut self, words: &mut Recall<'_>) {
        self.iter_mut().for_each(|numbers| words.numbers(numbers));
    }
}

#[cfg(all(test, feature = "std"))]
mod tests {
    use super::*;

    struct Past {
        numbers: [f64; 3],
        lanes: [Lanes; 2],
        is_trusted: bool,
        known: u64,
        last: Option<Lost>,
        constant: f64,
    }

    struct Lost([f64; 2]);

    memory!([] Past, |words| Self { numbers, lanes, is_trusted, known, last, constant } => {
        words.fixed(*constant);
        words.numbers(numbers);
        words.lanes(lanes);
        words.flag(is_trusted);
        words.count(known);
        words.optional(last, || Lost([0.0; 2]));
    });

    memory!([] Lost, |words| Self(numbers) => { words.numbers(numbers) });

    fn blank(constant: f64) -> Past {
        Past { numbers: [0.0; 3], lanes: [Lanes::ZERO; 2], is_trusted: false, known: 0, last: None, constant }
    }

    fn recorded(past: &Past) -> (Vec<u64>, u64) {
        let mut words = Vec::new();
        let mut sink = |word| words.push(word);
        let mut record = Record::to(&mut sink);
        past.record(&mut record);
        let digest = record.digest();
        (words, digest)
    }

    #[test]
    fn numbers_that_do_not_equal_themselves_are_recalled_too() {
        let payload = f64::from_bits(0x7ff8_0000_0000_1234);
        let past = Past {
            numbers: [-0.0, f64::from_bits(1), payload],
            lanes: [
                Lanes::new([1.0, -0.0, f64::NEG_INFINITY, 0.1, 5.0, 6.0, 7.0, payload]),
                Lanes::splat(3.0),
            ],
            is_trusted: true,
            known: u64::MAX,
            last: Some(Lost([1e-300, 2.0])),
            constant: 0.5,
        };
        let (words, digest) = recorded(&past);
        assert_eq!(words.len(), 3 + 16 + 1 + 1 + 1 + 2);
        let mut again = blank(0.5);
        let mut source = words.iter();
        let mut next = || *source.next().unwrap();
        again.recall(&mut Recall::from(&mut next));
        assert_eq!(recorded(&again), (words, digest));
    }

    #[test]
    fn what_a_run_has_not_yet_replaces_what_another_has() {
        let (words, _) = recorded(&blank(0.5));
        let mut past = Past { last: Some(Lost([1.0; 2])), ..blank(0.5) };
        let mut source = words.into_iter();
        past.recall(&mut Recall::from(&mut || source.next().unwrap()));
        assert!(past.last.is_none());
    }

    #[test]
    fn fixed_numbers_take_no_words_but_change_the_digest() {
        let (words, digest) = recorded(&blank(0.5));
        let (same_words, other_digest) = recorded(&blank(-0.5));
        assert_eq!(words, same_words);
        assert_ne!(digest, other_digest);
    }
}
