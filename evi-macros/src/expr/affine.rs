//! Affine integer expressions: places in arrays, ends of ranges, sizes.
//!
//! `c + Σ aₖ xₖ` with integers `c`, `aₖ`, where `xₖ` is an index of a sum or family, or a size that rustc knows by a name.
//! Equal expressions are equal values: terms are sorted, and none is zero.

use std::cmp::Ordering;

use proc_macro2::TokenStream;

use super::print::Notation;

/// `c + Σ aₖ xₖ`.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord, Debug, Default)]
pub(crate) struct Affine {
    pub(crate) constant: i64,
    pub(crate) terms: Vec<(Variable, i64)>,
}

/// What an affine expression is made of besides numbers.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub(crate) enum Variable {
    /// An index: how many others are open around it, and its name.
    Index { level: usize, name: String },
    /// A constant in the user's scope.
    Size(NamedSize),
}

/// A constant of type `usize`, as written; equal to another where their texts are.
#[derive(Clone, Debug)]
pub(crate) struct NamedSize {
    text: String,
    pub(crate) path: TokenStream,
}

impl PartialEq for NamedSize {
    fn eq(&self, other: &Self) -> bool {
        self.text == other.text
    }
}

impl Eq for NamedSize {}

impl PartialOrd for NamedSize {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for NamedSize {
    fn cmp(&self, other: &Self) -> Ordering {
        self.text.cmp(&other.text)
    }
}

impl Affine {
    pub(crate) fn number(constant: i64) -> Self {
        Self { constant, terms: Vec::new() }
    }

    pub(crate) fn index(level: usize, name: impl Into<String>) -> Self {
        Self { constant: 0, terms: vec![(Variable::Index { level, name: name.into() }, 1)] }
    }

    pub(crate) fn size(path: TokenStream) -> Self {
        let text = path.to_string().replace(' ', "");
        Self { constant: 0, terms: vec![(Variable::Size(NamedSize { text, path }), 1)] }
    }

    /// The value where it is a number.
    pub(crate) fn as_number(&self) -> Option<i64> {
        self.terms.is_empty().then_some(self.constant)
    }

    /// `self + factor · other`; `None` beyond the integers of 64 bits.
    pub(crate) fn plus(&self, factor: i64, other: &Self) -> Option<Self> {
        let constant = self.constant.checked_add(other.constant.checked_mul(factor)?)?;
        let mut terms = self.terms.clone();
        for (variable, coefficient) in &other.terms {
            let added = coefficient.checked_mul(factor)?;
            match terms.iter_mut().find(|(known, _)| known == variable) {
                Some((_, known)) => *known = known.checked_add(added)?,
                None => terms.push((variable.clone(), added)),
            }
        }
        terms.retain(|(_, coefficient)| *coefficient != 0);
        terms.sort();
        Some(Self { constant, terms })
    }

    /// `self · other`, where one of them is a number.
    pub(crate) fn times(&self, other: &Self) -> Option<Self> {
        match (self.as_number(), other.as_number()) {
            (Some(factor), _) => Self::default().plus(factor, other),
            (None, Some(factor)) => Self::default().plus(factor, self),
            (None, None) => None,
        }
    }

    /// The coefficient of the index at `level`.
    pub(crate) fn coefficient(&self, level: usize) -> i64 {
        let term = self.terms.iter().find(|(variable, _)| variable.level() == Some(level));
        term.map_or(0, |(_, coefficient)| *coefficient)
    }

    /// Levels of the indices in it.
    pub(crate) fn levels(&self) -> impl Iterator<Item = usize> {
        self.terms.iter().filter_map(|(variable, _)| variable.level())
    }

    /// The expression with `value` for the index at `level`.
    pub(crate) fn with_index(&self, level: usize, value: &Self) -> Option<Self> {
        let mut rest = self.clone();
        rest.terms.retain(|(variable, _)| variable.level() != Some(level));
        rest.plus(self.coefficient(level), value)
    }

    /// `2 i − 1`, without spaces in LaTeX.
    pub(crate) fn print(&self, notation: Notation) -> String {
        let minus = if notation == Notation::Latex { "-" } else { "−" };
        let space = if notation == Notation::Latex { "" } else { " " };
        let mut text = String::new();
        // Indices before sizes, both before the number, as they are mostly written.
        let numbers = (self.constant != 0 || self.terms.is_empty()).then_some((None, self.constant));
        let terms = self.terms.iter().map(|(variable, factor)| (Some(variable), *factor)).chain(numbers);
        for (position, (variable, factor)) in terms.enumerate() {
            text += &match (position, factor < 0) {
                (0, false) => String::new(),
                (0, true) => minus.to_owned(),
                (_, false) => format!("{space}+{space}"),
                (_, true) => format!("{space}{minus}{space}"),
            };
            text += &match (variable, factor.unsigned_abs()) {
                (None, number) => number.to_string(),
                (Some(variable), 1) => variable.name().to_owned(),
                (Some(variable), factor) => format!("{factor} {}", variable.name()),
            };
        }
        text
    }
}

impl Variable {
    fn level(&self) -> Option<usize> {
        match self {
            Self::Index { level, .. } => Some(*level),
            Self::Size(_) => None,
        }
    }

    /// The index, or the last segment of a path.
    fn name(&self) -> &str {
        match self {
            Self::Index { name, .. } => name,
            Self::Size(size) => size.text.rsplit("::").next().unwrap_or(&size.text),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Affine, Notation};

    #[test]
    fn equal_expressions_are_equal() {
        let (i, n) = (Affine::index(0, "i"), Affine::size("consts::N".parse().expect("a path")));
        let sum = |a: &Affine, b: &Affine| a.plus(1, b).expect("small");
        let expected = sum(&sum(&i, &n), &Affine::number(-1));
        let other = sum(&sum(&Affine::number(-1), &n), &i);
        assert_eq!(expected, other);
        assert_eq!(sum(&expected, &i).plus(-2, &i), other.plus(-1, &i));
        assert_eq!(expected.print(Notation::Unicode), "i + N − 1");
        assert_eq!(expected.plus(2, &i).map(|sum| sum.print(Notation::Latex)).as_deref(), Some("3 i+N-1"));
    }

    #[test]
    fn a_product_of_indices_is_not_affine() {
        let (i, three) = (Affine::index(0, "i"), Affine::number(3));
        assert_eq!(i.times(&i), None);
        assert_eq!(i.times(&three).map(|product| product.coefficient(0)), Some(3));
        assert_eq!(i.times(&three), three.times(&i));
    }

    #[test]
    fn an_index_is_replaced() {
        let (i, j) = (Affine::index(0, "i"), Affine::index(1, "j"));
        let sum = i.times(&Affine::number(2)).and_then(|twice| twice.plus(1, &j)).expect("small");
        let value = sum.with_index(0, &Affine::number(5)).expect("small");
        assert_eq!(value, j.plus(1, &Affine::number(10)).expect("small"));
    }
}
