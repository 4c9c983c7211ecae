//! Random cases that shrink: what a generator chooses is a tape of numbers, and a shorter tape is a simpler case.
//!
//! In: a property that makes its own case out of [`Choices`]. Out: nothing, or a panic with the smallest case that was found to
//! fail and the seed of the first. Whoever includes it has `random_expressions/splitmix.rs` beside it (after D. MacIver, A. Donaldson, *Test-case reduction via test-case generation*, ECOOP
//! 2020). A seed names the same case everywhere.

use std::any::Any;
use std::fmt::Display;
use std::ops::Range;
use std::panic::resume_unwind;
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::{Duration, Instant};

use super::splitmix::SplitMix;

/// What a case may take at most before it counts as a hang: 10,000 times the longest that was seen.
const HANG: Duration = Duration::from_secs(120);
/// Cases that are tried to make a failing one smaller.
const SHRINKING: usize = 4000;

/// The choices of one case. Zero is the simplest choice everywhere, and what is read behind the end of a tape.
pub(super) struct Choices {
    tape: Vec<u32>,
    position: usize,
    random: Option<SplitMix>,
}

impl Choices {
    fn random(seed: u64) -> Self {
        Self { tape: Vec::new(), position: 0, random: Some(SplitMix::new(seed)) }
    }

    fn replayed(tape: Vec<u32>) -> Self {
        Self { tape, position: 0, random: None }
    }

    fn draw(&mut self) -> u32 {
        if self.position == self.tape.len() {
            // The factor is exact: a draw has 32 random bits.
            let drawn = self.random.as_mut().map_or(0.0, |random| random.between(0.0, 4_294_967_296.0));
            self.tape.push(drawn as u32);
        }
        self.position += 1;
        self.tape[self.position - 1]
    }

    /// A number below `bound`.
    pub(super) fn below(&mut self, bound: usize) -> usize {
        // Monotone in the draw, so that a smaller draw is a choice further in front.
        ((u64::from(self.draw()) * bound as u64) >> 32) as usize
    }

    /// One of the elements, the first of which is the simplest.
    pub(super) fn pick<T: Copy>(&mut self, elements: &[T]) -> T {
        elements[self.below(elements.len())]
    }

    /// True once in `n` times.
    pub(super) fn once_in(&mut self, n: usize) -> bool {
        self.below(n) == n - 1
    }

    /// 64 random bits.
    #[allow(dead_code, reason = "the tests of the compiler have no use for bits")]
    pub(super) fn bits(&mut self) -> u64 {
        u64::from(self.draw()) << 32 | u64::from(self.draw())
    }
}

/// Runs the property on a number of random cases, `EVI_FUZZ_CASES` where that is set, from the seed `EVI_FUZZ_SEED` on. Every case
/// has a thread of its own with `stack` bytes: a case that overflows it ends the test with the case's seed as the name of the thread.
///
/// Returns what the property said about the cases, in their order.
///
/// # Panics
///
/// If the property panics, hangs, or returns an error, after the case is made as small as it goes.
#[track_caller]
pub(super) fn check<T: Send + 'static, E: Display + Send + 'static>(
    n_cases: u64,
    stack: usize,
    property: fn(&mut Choices) -> Result<T, E>,
) -> Vec<T> {
    let run = |choices: Choices, seed: u64| on_a_thread(choices, seed, stack, property);
    let mut slowest = (Duration::ZERO, 0);
    let verdicts = cases(n_cases)
        .map(|seed| {
            let start = Instant::now();
            let (verdict, tape) = run(Choices::random(seed), seed);
            slowest = slowest.max((start.elapsed(), seed));
            verdict.unwrap_or_else(|failure| {
                let (tape, failure) = shrunk(tape, failure, |tape| run(Choices::replayed(tape), seed));
                panic!("case {seed}, of {} choices when shrunk: {failure}", tape.len());
            })
        })
        .collect();
    // Where cases take long, this one says why.
    println!("the slowest case, {}, took {:.1?}", slowest.1, slowest.0);
    verdicts
}

/// The seeds of the cases.
fn cases(n_cases: u64) -> Range<u64> {
    let number = |name: &str| std::env::var(name).ok().map(|text| text.parse::<u64>().expect("a number"));
    let first = number("EVI_FUZZ_SEED").unwrap_or(0);
    first..first + number("EVI_FUZZ_CASES").unwrap_or(n_cases)
}

/// What a panic said.
pub(super) fn panic_message(payload: &(dyn Any + Send)) -> &str {
    let text = payload.downcast_ref::<String>().map(String::as_str);
    text.or_else(|| payload.downcast_ref::<&str>().copied()).unwrap_or("without a message")
}

type Outcome<T> = (Result<T, String>, Vec<u32>);

fn on_a_thread<T: Send + 'static, E: Display + Send + 'static>(
    mut choices: Choices,
    seed: u64,
    stack: usize,
    property: fn(&mut Choices) -> Result<T, E>,
) -> Outcome<T> {
    let (sender, receiver) = channel();
    let case = move || {
        let caught = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| property(&mut choices)));
        let verdict = match caught {
            Ok(verdict) => verdict.map_err(|error| error.to_string()),
            Err(payload) => Err(format!("panicked: {}", panic_message(&*payload))),
        };
        // The receiver waits for it, unless it has given up.
        let _ = sender.send((verdict, choices.tape));
    };
    let thread = std::thread::Builder::new().name(format!("case {seed}")).stack_size(stack).spawn(case);
    let thread = thread.expect("a thread starts");
    match receiver.recv_timeout(HANG) {
        Ok(outcome) => outcome,
        Err(RecvTimeoutError::Timeout) => panic!("case {seed} hangs"),
        Err(RecvTimeoutError::Disconnected) => resume_unwind(thread.join().expect_err("it has sent nothing")),
    }
}

/// A tape that fails, too, and is as short as could be found, with numbers as small.
fn shrunk<T>(
    mut tape: Vec<u32>,
    mut failure: String,
    run: impl Fn(Vec<u32>) -> Outcome<T>,
) -> (Vec<u32>, String) {
    let mut attempts = 0;
    let mut fails = |candidate: Vec<u32>, tape: &mut Vec<u32>| {
        attempts += 1;
        if attempts > SHRINKING || candidate == *tape {
            return false;
        }
        match run(candidate) {
            // As many numbers as were read: a case may become shorter by itself, and may not become longer.
            (Err(reason), read) if (read.len(), &read) < (tape.len(), tape) => {
                (*tape, failure) = (read, reason);
                true
            }
            _ => false,
        }
    };
    loop {
        let before = tape.clone();
        let mut length = tape.len();
        while length > 0 {
            let mut at = 0;
            while at + length <= tape.len() {
                let candidate = [&tape[..at], &tape[at + length..]].concat();
                if !fails(candidate, &mut tape) {
                    at += length;
                }
            }
            length /= 2;
        }
        for at in 0.. {
            for smaller in [|_| 0, |number: u32| number / 2, |number: u32| number - number / 8] {
                if at < tape.len() {
                    let mut candidate = tape.clone();
                    candidate[at] = smaller(candidate[at]);
                    fails(candidate, &mut tape);
                }
            }
            if at >= tape.len() {
                break;
            }
        }
        if tape == before {
            return (tape, failure);
        }
    }
}
