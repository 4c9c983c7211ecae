//! The user's mistakes, gathered over the whole struct: in, a span and a sentence; out, all of them in order.

use proc_macro2::Span;

/// Mistakes found so far.
#[derive(Default)]
pub(crate) struct Diagnostics {
    mistakes: Vec<Mistake>,
}

/// What is wrong at a token, and what would be right.
pub(crate) struct Mistake {
    pub(crate) span: Span,
    pub(crate) message: String,
}

impl Diagnostics {
    /// Records a mistake.
    pub(crate) fn report(&mut self, span: Span, message: impl Into<String>) {
        self.mistakes.push(Mistake { span, message: message.into() });
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.mistakes.is_empty()
    }

    /// The mistakes, in the order of finding.
    pub(crate) fn mistakes(&self) -> &[Mistake] {
        &self.mistakes
    }
}

/// The known name that a mistyped one most likely means: ", did you mean `NAME`?", or nothing.
pub(crate) fn suggestion<'k>(name: &str, known: impl IntoIterator<Item = &'k str>) -> String {
    let closest = known.into_iter().map(|known| (edit_distance(name, known), known)).min();
    match closest {
        Some((distance, known)) if distance <= 1.max(name.len() / 3) => format!(", did you mean `{known}`?"),
        _ => String::new(),
    }
}

/// Number of insertions, deletions, substitutions and swaps of neighbours between two words (Damerau-Levenshtein,
/// optimal string alignment).
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
