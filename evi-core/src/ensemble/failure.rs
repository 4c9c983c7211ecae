//! Members that came to no end, each with its reason.

use crate::integrator::{StartError, StepError};
use crate::memory::{Memory, Recall, Record};

/// A member that could not start, or whose step had no end.
#[derive(Clone, Debug, PartialEq)]
pub struct Failure {
    /// Its index.
    pub member: usize,
    /// Number of steps taken before.
    pub steps: u64,
    /// Time reached.
    pub t: f64,
    /// Why.
    pub error: MemberError,
}

/// Why a member came to no end.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MemberError {
    /// It could not start.
    #[error(transparent)]
    Start(StartError),
    /// A step could not be taken.
    #[error(transparent)]
    Step(StepError),
    /// What was noted of an error, in a file or by another process.
    #[error("{0}")]
    Noted(String),
}

/// Failures in the order of their members.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Failures(pub(super) Vec<Failure>);

impl Memory for Failures {
    fn record(&self, words: &mut Record<'_>) {
        words.index(&self.0.len());
        for Failure { member, steps, t, error } in &self.0 {
            words.index(member);
            words.count(steps);
            words.number(t);
            let text = error.to_string();
            words.index(&text.len());
            for bytes in text.as_bytes().chunks(8) {
                let mut word = [0; 8];
                word[..bytes.len()].copy_from_slice(bytes);
                words.count(&u64::from_le_bytes(word));
            }
        }
    }

    fn recall(&mut self, words: &mut Recall<'_>) {
        let mut count = 0;
        words.index(&mut count);
        self.0.clear();
        for _ in 0..count {
            let (mut member, mut steps, mut t, mut length) = (0, 0, 0.0, 0);
            words.index(&mut member);
            words.count(&mut steps);
            words.number(&mut t);
            words.index(&mut length);
            let mut text = Vec::new();
            while text.len() < length {
                let mut word = 0;
                words.count(&mut word);
                text.extend(word.to_le_bytes());
            }
            text.truncate(length);
            let error = MemberError::Noted(String::from_utf8_lossy(&text).into_owned());
            self.0.push(Failure { member, steps, t, error });
        }
    }
}
