//! Affine integer expressions: places in arrays, ends of ranges, sizes.
//!
//! `c + Σ aₖ xₖ` with integers `c`, `aₖ`, where `xₖ` is an index of a sum or family, a size that rustc knows by a name, or a product of sizes and at
//! most one index. Equal expressions are equal values: terms are sorted, and none is zero.

use std::cmp::Ordering;

use proc_macro2::TokenStream;

use super::print::Notation;

/// `c + Σ aₖ xₖ`.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord, Debug, Default)]
pub(crate) struct Affine {
    pub(crate) constant: i64,
    /// Products, each with its coefficient.
    pub(crate) terms: Vec<(Vec<Variable>, i64)>,
}

/// What an affine expression is made of besides numbers.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub(crate) enum Variable {
    /// A constant in the user's scope.
    Size(NamedSize),
    /// An index: how many others are open around it, and its name.
    Index { level: usize, name: String },
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
        Self::variable(Variable::Index { level, name: name.into() })
    }

    pub(crate) fn size(path: TokenStream) -> Self {
        let text = path.to_string().replace(' ', "");
        Self::variable(Variable::Size(NamedSize { text, path }))
    }

    fn variable(variable: Variable) -> Self {
        Self { constant: 0, terms: vec![(vec![variable], 1)] }
    }

    /// The value where it is a number.
    pub(crate) fn as_number(&self) -> Option<i64> {
        self.terms.is_empty().then_some(self.constant)
    }

    /// `self + factor · other`; `None` beyond the integers of 64 bits.
    pub(crate) fn plus(&self, factor: i64, other: &Self) -> Option<Self> {
        let mut sum = self.clone();
        sum.constant = sum.constant.checked_add(other.constant.checked_mul(factor)?)?;
        for (product, coefficient) in &other.terms {
            sum.add(product.clone(), coefficient.checked_mul(factor)?)?;
        }
        Some(sum)
    }

    /// Adds one product, or a number where there are no variables.
    fn add(&mut self, product: Vec<Variable>, coefficient: i64) -> Option<()> {
        if product.is_empty() {
            self.constant = self.constant.checked_add(coefficient)?;
            return Some(());
        }
        match self.terms.iter_mut().find(|(known, _)| *known == product) {
            Some((_, known)) => *known = known.checked_add(coefficient)?,
            None => self.terms.push((product, coefficient)),
        }
        self.terms.retain(|(_, coefficient)| *coefficient != 0);
        self.terms.sort();
        Some(())
    }

    /// All terms, the number among them.
    fn all_terms(&self) -> impl Iterator<Item = (Vec<Variable>, i64)> {
        let number = (self.constant != 0).then(|| (Vec::new(), self.constant));
        self.terms.iter().cloned().chain(number)
    }

    /// `self · other`; `None` for a product of two indices.
    pub(crate) fn times(&self, other: &Self) -> Option<Self> {
        let mut result = Self::default();
        for (a, first) in self.all_terms() {
            for (b, second) in other.all_terms() {
                let mut product: Vec<Variable> = a.iter().chain(&b).cloned().collect();
                product.sort();
                if product.iter().filter(|variable| variable.level().is_some()).count() > 1 {
                    return None;
                }
                result.add(product, first.checked_mul(second)?)?;
            }
        }
        Some(result)
    }

    /// What the index at `level` is called in it, if it has that one.
    pub(crate) fn name_of(&self, level: usize) -> Option<&str> {
        let variables = self.terms.iter().flat_map(|(product, _)| product);
        variables.into_iter().find_map(|variable| match variable {
            Variable::Index { level: known, name } if *known == level => Some(name.as_str()),
            _ => None,
        })
    }

    /// Levels of the indices in it.
    pub(crate) fn levels(&self) -> impl Iterator<Item = usize> {
        self.terms.iter().flat_map(|(product, _)| product.iter().filter_map(Variable::level))
    }

    /// The expression with `value` for the index at `level`.
    pub(crate) fn with_index(&self, level: usize, value: &Self) -> Option<Self> {
        let mut result = Self::default();
        for (product, coefficient) in self.all_terms() {
            let is_other = |variable: &Variable| variable.level() != Some(level);
            let rest: Vec<Variable> = product.iter().filter(|variable| is_other(variable)).cloned().collect();
            let has_index = rest.len() < product.len();
            let mut factor = Self::default();
            factor.add(rest, coefficient)?;
            result = result.plus(1, &if has_index { factor.times(value)? } else { factor })?;
        }
        Some(result)
    }

    /// `2 i − 1`, without spaces around signs in LaTeX.
    pub(crate) fn print(&self, notation: Notation) -> String {
        let minus = if notation == Notation::Latex { "-" } else { "−" };
        let space = if notation == Notation::Latex { "" } else { " " };
        let mut text = String::new();
        // Indices before sizes, both before the number, as they are mostly written.
        let mut terms: Vec<&(Vec<Variable>, i64)> = self.terms.iter().collect();
        terms.sort_by_key(|(product, _)| product.iter().all(|variable| variable.level().is_none()));
        let number = (Vec::new(), self.constant);
        terms.extend((self.constant != 0 || terms.is_empty()).then_some(&number));
        for (position, (product, factor)) in terms.into_iter().enumerate() {
            text += &match (position, *factor < 0) {
                (0, false) => String::new(),
                (0, true) => minus.to_owned(),
                (_, false) => format!("{space}+{space}"),
                (_, true) => format!("{space}{minus}{space}"),
            };
            let number =
                (factor.unsigned_abs() != 1 || product.is_empty()).then(|| factor.unsigned_abs().to_string());
            let names = product.iter().map(|variable| variable.name().to_owned());
            text += &number.into_iter().chain(names).collect::<Vec<_>>().join(" ");
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
        assert_eq!(i.times(&three), Affine::default().plus(3, &i));
        assert_eq!(i.times(&three), three.times(&i));
        // A size times an index is.
        let n = Affine::size("N".parse().expect("a name"));
        let place = n.times(&i).and_then(|rows| rows.plus(1, &Affine::index(1, "j"))).expect("affine");
        assert_eq!(place.print(Notation::Unicode), "N i + j");
        assert_eq!(place.times(&i), None);
        let end = n.plus(-1, &Affine::number(1)).expect("small");
        let last = place.with_index(0, &end).and_then(|place| place.with_index(1, &end)).expect("affine");
        assert_eq!(last.print(Notation::Latex), "N N-1");
    }

    #[test]
    fn an_index_is_replaced() {
        let (i, j) = (Affine::index(0, "i"), Affine::index(1, "j"));
        let sum = i.times(&Affine::number(2)).and_then(|twice| twice.plus(1, &j)).expect("small");
        let value = sum.with_index(0, &Affine::number(5)).expect("small");
        assert_eq!(value, j.plus(1, &Affine::number(10)).expect("small"));
    }
}
