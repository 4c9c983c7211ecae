//! `sum(a..b, |i| EXPR)`: unrolled where that is small, a loop otherwise.

use proc_macro2::Ident;

use super::expression::{Expansion, Lowering, Resolver};
use crate::expr::{Affine, Binary, Composite, Dependence, ExprId, Value};

const SUM_TAKES: &str = "write `sum(0..N, |i| expression)`";
/// Terms that a sum of a scene of loops unrolls: the dimensions of space, not the bodies.
const SHORTEST_LOOP: i64 = 8;
/// Nodes of a graph that is still to be compiled, beyond which unrolling stops; the largest kernel that is compiled has fewer.
const LARGEST_GRAPH: usize = 2_000_000;

impl<R: Resolver> Lowering<'_, R> {
    /// The value of `sum(..)`.
    pub(super) fn sum(&mut self, keyword: &Ident, arguments: &[&syn::Expr]) -> Option<Value> {
        let [range, syn::Expr::Closure(closure)] = arguments else {
            return self.mistake(keyword.span(), SUM_TAKES);
        };
        let index = match closure.inputs.iter().collect::<Vec<_>>().as_slice() {
            [syn::Pat::Ident(index)] if index.by_ref.is_none() && index.subpat.is_none() => {
                index.ident.clone()
            }
            _ => {
                // From bar to bar, since between them there may be nothing.
                return self.mistake_between(
                    closure.inputs_begin.span,
                    closure.inputs_end.span,
                    "a sum goes over one index: write `|i|`, and a `sum` inside for a second one",
                );
            }
        };
        let (from, to) = self.range(range)?;
        let length = to.plus(-1, &from).and_then(|length| length.as_number());
        let is_loop = match (self.resolver.expansion(), length) {
            (Expansion::Unrolled, Some(_)) => false,
            (Expansion::Looped, Some(length)) => length > SHORTEST_LOOP || from.as_number().is_none(),
            _ => true,
        };
        if is_loop {
            return self.looped(keyword, &index, (from, to), &closure.body);
        }
        self.unrolled(keyword, &index, from.constant..to.constant, &closure.body)
    }

    /// Term by term; the first with a mistake is the last that is looked at.
    fn unrolled(
        &mut self,
        keyword: &Ident,
        index: &Ident,
        range: std::ops::Range<i64>,
        body: &syn::Expr,
    ) -> Option<Value> {
        let mut total: Option<Value> = None;
        for place in range {
            if self.graph.len() > LARGEST_GRAPH {
                return self.mistake(keyword.span(), "this sum is too long to be written out: give the array a size by a constant, `const N: usize`, and sum over `0..N`");
            }
            self.resolver.enter_block();
            self.resolver.define(index, Some(Value::Index(Affine::number(place))), self.diagnostics);
            let term = self.value(body);
            self.resolver.leave_block();
            total = Some(match (total, term?) {
                (None, term) => match self.known(term) {
                    Ok(term) => term,
                    Err(message) => return self.mistake_over(body, message),
                },
                (Some(total), term) => match self.combined(Binary::Add, total, term) {
                    Ok(total) => total,
                    Err(message) => return self.mistake_over(body, message),
                },
            });
        }
        Some(total.unwrap_or_else(|| Value::Scalar(self.graph.number(0.0))))
    }

    fn looped(
        &mut self,
        keyword: &Ident,
        index: &Ident,
        (from, to): (Affine, Affine),
        body: &syn::Expr,
    ) -> Option<Value> {
        self.resolver.enter_block();
        let (level, place) = self.resolver.enter_index(index, &from, &to);
        self.resolver.define(index, Some(Value::Index(place)), self.diagnostics);
        let body_value = self.value(body);
        self.resolver.leave_index();
        self.resolver.leave_block();
        let value = match self.known(body_value?) {
            Ok(value) => value,
            Err(message) => return self.mistake_over(body, message),
        };
        let index = index.to_string();
        Some(self.sums(value, &mut |lowering: &mut Self, body: ExprId| {
            let (index, from, to) = (index.clone(), from.clone(), to.clone());
            let sum = Composite::Sum { index, level, from, to, body };
            let sum = lowering.graph.composite(sum, Dependence::default());
            lowering.resolver.place_of_sum(sum, keyword.span());
            sum
        }))
    }

    /// The sum of a vector is that of its elements.
    fn sums(&mut self, value: Value, sum: &mut dyn FnMut(&mut Self, ExprId) -> ExprId) -> Value {
        match value {
            Value::Scalar(body) => Value::Scalar(sum(self, body)),
            Value::Vector(parts) => {
                Value::Vector(parts.into_iter().map(|part| self.sums(part, sum)).collect())
            }
            Value::Array(_) | Value::Index(_) => unreachable!("arrays and indices are made known"),
        }
    }

    /// The ends of `a..b` or `a..=b`, the second behind the last element.
    pub(super) fn range(&mut self, range: &syn::Expr) -> Option<(Affine, Affine)> {
        let syn::Expr::Range(syn::ExprRange { start: Some(start), end: Some(end), limits, .. }) = range
        else {
            return self.unknown_range(range);
        };
        let (from, to) = (self.index(start), self.index(end));
        let (from, mut to) = (from?, to?);
        if let syn::RangeLimits::Closed(_) = limits {
            match to.plus(1, &Affine::number(1)) {
                Some(behind) => to = behind,
                None => return self.unknown_range(range),
            }
        }
        let is_number = from.as_number().is_some() && to.as_number().is_some();
        if !is_number && self.resolver.expansion() == Expansion::Unrolled {
            return self.mistake_over(
                range,
                "a range that is not known here: where the coordinates have literal sizes, ranges end at literals, too; to \
                 keep loops, size an array of coordinates by the constant, `coordinates(p: [N, 2])`",
            );
        }
        match to.plus(-1, &from).map(|length| length.as_number()) {
            Some(Some(length)) if length < 0 => self.mistake_over(range, "this range ends before it begins"),
            Some(_) => Some((from, to)),
            None => self.unknown_range(range),
        }
    }

    fn unknown_range<X>(&mut self, range: &syn::Expr) -> Option<X> {
        self.mistake_over(
            range,
            "the range of an index has two ends, integers, constants or other indices: write `0..N`",
        )
    }
}
