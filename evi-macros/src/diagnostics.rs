//! The user's mistakes, gathered over the whole struct: in, a span and a sentence; out, all of them in the
//! order of the source.

use proc_macro2::Span;

/// Mistakes found so far.
#[derive(Default)]
pub(crate) struct Diagnostics {
    mistakes: Vec<Mistake>,
}

/// What is wrong at a range of tokens, and what would be right.
pub(crate) struct Mistake {
    /// Of the first token.
    pub(crate) first: Span,
    /// Of the last token.
    pub(crate) last: Span,
    pub(crate) message: String,
}

impl Diagnostics {
    /// Records a mistake at one token.
    pub(crate) fn report(&mut self, span: Span, message: impl Into<String>) {
        self.report_range(span, span, message);
    }

    /// Records a mistake that reaches from the token at `first` to the token at `last`.
    pub(crate) fn report_range(&mut self, first: Span, last: Span, message: impl Into<String>) {
        self.mistakes.push(Mistake { first, last, message: message.into() });
    }

    /// Number of mistakes.
    pub(crate) fn len(&self) -> usize {
        self.mistakes.len()
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.mistakes.is_empty()
    }

    /// The mistakes in the order of the source, although the stages find them in another one.
    pub(crate) fn mistakes(&self) -> Vec<&Mistake> {
        let mut mistakes: Vec<&Mistake> = self.mistakes.iter().collect();
        mistakes.sort_by_key(|mistake| position(mistake.first));
        mistakes
    }
}

/// Line and column. Outside of the compiler, in unit tests, tokens have no place: all are equal, which leaves
/// the order of finding.
fn position(span: Span) -> (usize, usize) {
    if !proc_macro::is_available() {
        return (0, 0);
    }
    let start = span.unwrap().start();
    (start.line(), start.column())
}

/// The known name that a mistyped one most likely means: ", did you mean `NAME`?", or nothing.
pub(crate) fn suggestion<'k>(name: &str, known: impl IntoIterator<Item = &'k str>) -> String {
    closest(name, known).map(|known| format!(", did you mean `{known}`?")).unwrap_or_default()
}

/// The known name that a mistyped one most likely means.
pub(crate) fn closest<'k>(name: &str, known: impl IntoIterator<Item = &'k str>) -> Option<&'k str> {
    let (distance, known) = known.into_iter().map(|known| (edit_distance(name, known), known)).min()?;
    // Names that share no letter are not similar, however short.
    let has_common_letter = distance < name.chars().count().max(known.chars().count());
    (has_common_letter && distance <= 1.max(name.len() / 3)).then_some(known)
}

/// Number of insertions, deletions, substitutions and swaps of neighbours between two words
/// (Damerau-Levenshtein, optimal string alignment).
fn edit_distance(a: &str, b: &str) -> usize {
    let (a, b): (Vec<char>, Vec<char>) = (a.chars().collect(), b.chars().collect());
    let mut distance = vec![vec![0; b.len() + 1]; a.len() + 1];
    for i in 0..=a.len() {
        for j in 0..=b.len() {
            distance[i][j] = if i == 0 || j == 0 {
                i + j
            } else {
                let substituted = distance[i - 1][j - 1] + usize::from(a[i - 1] != b[j - 1]);
                let shifted = 1 + distance[i - 1][j].min(distance[i][j - 1]);
                let swapped = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
                let best = substituted.min(shifted);
                if swapped { best.min(distance[i - 2][j - 2] + 1) } else { best }
            };
        }
    }
    distance[a.len()][b.len()]
}
