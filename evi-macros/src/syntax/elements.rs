//! Elements of arrays and vectors: indices, and whether they are in range.

use super::affine::{Integer, affine};
use super::expression::{Expansion, Lowering, Resolved, Resolver};
use super::integers::is_integer_literal;
use super::spine::{first_span, last_span};
use crate::diagnostics::Diagnostics;
use crate::expr::{Affine, Composite, Dependence, Value};

impl<R: Resolver> Lowering<'_, R> {
    /// `left[index]`.
    pub(super) fn indexed(&mut self, left: Option<Value>, index: &syn::ExprIndex) -> Option<Value> {
        let place = self.index(&index.index);
        let (left, place) = (left?, place?);
        match left {
            Value::Array(view) if !view.shape.is_empty() => {
                let (name, size) = (view.name.clone(), view.shape[0].clone());
                self.within(&place, &size, &name, &index.index)?;
                let view = view.at(place);
                let is_element = view.shape.is_empty();
                Some(if is_element {
                    Value::Scalar(self.resolver.element(self.graph, &view))
                } else {
                    Value::Array(view)
                })
            }
            Value::Vector(mut parts) => {
                let Some(known) = place.as_number() else {
                    return self.mistake_over(
                        &index.index,
                        "an index of a vector that is computed is a number: only arrays of coordinates and parameters are indexed by others",
                    );
                };
                let size = Affine::number(i64::try_from(parts.len()).expect("a vector fits in memory"));
                self.within(&place, &size, "the vector", &index.index)?;
                Some(parts.swap_remove(usize::try_from(known).expect("checked by `within`")))
            }
            Value::Scalar(vector) if self.graph.is_as_written() => Some(Value::Scalar(
                self.graph.composite(Composite::Part(vector, place), Dependence::default()),
            )),
            Value::Scalar(_) | Value::Index(_) | Value::Array(_) => self.mistake_between(
                first_span(&index.expr),
                index.bracket_token.span.close(),
                "a number has no elements: nothing here has an index",
            ),
        }
    }

    /// Reports an index that is known to be outside of the array; what is not known yet is left to rustc.
    fn within(&mut self, index: &Affine, size: &Affine, name: &str, place: &syn::Expr) -> Option<()> {
        if self.graph.is_as_written() {
            return Some(());
        }
        if index.as_number().is_none()
            && size.as_number().is_some()
            && self.resolver.expansion() == Expansion::Unrolled
        {
            let message = format!("the sizes of `{name}` are literals: its indices are, too");
            return self.mistake_over(place, message);
        }
        let (Some(known), Some(length)) = (index.as_number(), size.as_number()) else {
            self.resolver.check_bounds(index, size, name, first_span(place), last_span(place));
            return Some(());
        };
        if (0..length).contains(&known) {
            return Some(());
        }
        let written = quote::ToTokens::to_token_stream(place);
        let becomes =
            if is_integer_literal(place) { String::new() } else { format!("`{written}` is {known} here: ") };
        let name = if name == "the vector" { name.to_owned() } else { format!("`{name}`") };
        let last = length - 1;
        self.mistake_over::<()>(
            place,
            format!("{becomes}index {known} is out of range, {name} has {length} elements, from 0 to {last}"),
        )
    }

    /// An affine expression in the indices in reach.
    pub(super) fn index(&mut self, expression: &syn::Expr) -> Option<Affine> {
        let (graph, resolver) = (&mut *self.graph, &mut *self.resolver);
        let mut integer = |name: &proc_macro2::Ident, diagnostics: &mut Diagnostics| match resolver.name(
            graph,
            name,
            diagnostics,
        ) {
            Resolved::Value(Value::Index(index)) => Integer::Affine(index),
            Resolved::Value(_) => {
                let message = format!(
                    "`{name}` is a real number, an index is an integer: a literal, a constant, or an index of `sum` or of a family"
                );
                diagnostics.report(name.span(), message);
                Integer::Mistaken
            }
            Resolved::Mistaken => Integer::Mistaken,
            Resolved::Unknown => Integer::Unknown,
        };
        affine(expression, &mut integer, self.diagnostics)
    }
}
