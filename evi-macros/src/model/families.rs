//! Items with brackets: equations for every value of their indices, and the places that they belong to.

use proc_macro2::Span;

use super::resolve::Scope;
use super::sizes::plain;
use super::tables::{IndexRange, element_name};
use crate::budget::MOST_UNROLLED_EQUATIONS;
use crate::diagnostics::Diagnostics;
use crate::expr::{Affine, ExprId, Graph, Notation, Value, View};
use crate::syntax::{Bracket, Expansion, Indexed, Range, Resolver, lower_index, lower_range};

/// An equation with its name, once or for every value of its indices.
#[derive(Clone)]
pub(crate) struct Named {
    /// `rod`, `link[3]`; of a family that stays a loop the name alone.
    pub(crate) name: String,
    pub(crate) span: Span,
    pub(crate) root: ExprId,
    /// The indices of a family that stays a loop.
    pub(crate) ranges: Vec<IndexRange>,
}

/// What can be done with a scope, for one value of the indices.
type Body<'b, 'a> = &'b mut dyn FnMut(&mut Scope<'a>, &mut Graph, &mut Diagnostics, &[Affine]) -> Option<()>;

impl<'a> Scope<'a> {
    /// Does something for every value of the indices of a family, or once for all of them where it stays a loop. Stops at the first mistake.
    pub(super) fn each(
        &mut self,
        ranges: &[&Range],
        graph: &mut Graph,
        diagnostics: &mut Diagnostics,
        body: Body<'_, 'a>,
    ) -> Option<()> {
        self.each_below(ranges, &mut Vec::new(), graph, diagnostics, body)
    }

    fn each_below(
        &mut self,
        ranges: &[&Range],
        outside: &mut Vec<Affine>,
        graph: &mut Graph,
        diagnostics: &mut Diagnostics,
        body: Body<'_, 'a>,
    ) -> Option<()> {
        let Some((range, inside)) = ranges.split_first() else {
            return body(self, graph, diagnostics, outside);
        };
        let (from, to) = lower_range(range.ends.as_ref()?, graph, self, diagnostics)?;
        let is_loop = self.expansion() != Expansion::Unrolled;
        if !is_loop && to.constant.saturating_sub(from.constant) > MOST_UNROLLED_EQUATIONS {
            let message = format!(
                "more than {MOST_UNROLLED_EQUATIONS} equations are written out only as loops: size an array of coordinates by a \
                 constant, `coordinates(p: [N, 2])`"
            );
            diagnostics.report(range.index.span(), message);
            return None;
        }
        let values: Vec<Affine> = if is_loop {
            vec![self.enter_index(&range.index, &from, &to).1]
        } else {
            (from.constant..to.constant).map(Affine::number).collect()
        };
        let mut done = Some(());
        for value in values {
            self.enter_block();
            self.define(&range.index, Some(Value::Index(value.clone())), diagnostics);
            outside.push(value);
            done = self.each_below(inside, outside, graph, diagnostics, body);
            outside.pop();
            self.leave_block();
            if done.is_none() {
                break;
            }
        }
        if is_loop {
            self.leave_index();
        }
        done
    }

    /// The part of an array of coordinates that brackets choose, where those with ranges are worth `indices`.
    pub(super) fn part(
        &mut self,
        indexed: &Indexed,
        item: &str,
        indices: &[Affine],
        graph: &mut Graph,
        diagnostics: &mut Diagnostics,
    ) -> Option<View> {
        let mut view = self.coordinate(&indexed.name, item, diagnostics)?;
        let mut indices = indices.iter();
        for bracket in &indexed.brackets {
            let (index, place) = match bracket {
                Bracket::Each(range) => {
                    let span = range.index.span();
                    (indices.next().expect("a value for every range").clone(), (span, span))
                }
                Bracket::At(place) => {
                    (lower_index(place, graph, self, diagnostics)?, (place.first_span(), place.last_span()))
                }
            };
            let Some(size) = view.shape.first().cloned() else {
                let message = format!("`{}` has no element here: it is a number", view.name);
                diagnostics.report_range(place.0, place.1, message);
                return None;
            };
            match (index.as_number(), size.as_number()) {
                (Some(known), Some(length)) if !(0..length).contains(&known) => {
                    let last = length - 1;
                    let message = format!(
                        "index {known} is out of range, `{}` has {length} elements, from 0 to {last}",
                        view.name
                    );
                    diagnostics.report_range(place.0, place.1, message);
                    return None;
                }
                (Some(_), Some(_)) => {}
                (None, Some(_)) if self.expansion() == Expansion::Unrolled => {
                    let message = format!("the sizes of `{}` are literals: its indices are, too", view.name);
                    diagnostics.report_range(place.0, place.1, message);
                    return None;
                }
                _ => self.check_bounds(&index, &size, &view.name, place.0, place.1),
            }
            view = view.at(index);
        }
        Some(view)
    }

    /// Every coordinate of a part with the number that belongs to it: elements of a vector to those of an array, one number to all.
    pub(super) fn paired(
        &mut self,
        view: View,
        value: &Value,
        is_for_all: bool,
        graph: &mut Graph,
    ) -> Result<Vec<(ExprId, String, ExprId)>, String> {
        let printed = self.expansion() == Expansion::Written;
        match (view.shape.first().map(Affine::as_number), value) {
            (None, Value::Scalar(root)) => {
                Ok(vec![(self.element(graph, &view), element_name(&view.name, &view.indices), *root)])
            }
            (Some(_), Value::Scalar(root)) if printed => {
                Ok(vec![(self.element(graph, &view), element_name(&view.name, &view.indices), *root)])
            }
            (Some(Some(size)), Value::Scalar(_)) if is_for_all => {
                let part =
                    |index| self.paired(view.clone().at(Affine::number(index)), value, is_for_all, graph);
                (0..size)
                    .map(part)
                    .collect::<Result<Vec<_>, _>>()
                    .map(|parts| parts.into_iter().flatten().collect())
            }
            (Some(Some(size)), Value::Vector(values)) if i64::try_from(values.len()) == Ok(size) => {
                let mut pairs = Vec::new();
                for (index, value) in (0..size).zip(values) {
                    pairs.extend(self.paired(
                        view.clone().at(Affine::number(index)),
                        value,
                        is_for_all,
                        graph,
                    )?);
                }
                Ok(pairs)
            }
            (Some(Some(size)), Value::Vector(values)) => {
                let name = element_name(&view.name, &view.indices);
                Err(format!("`{name}` has {size} elements, this vector {}", values.len()))
            }
            (Some(Some(size)), _) => {
                let name = element_name(&view.name, &view.indices);
                Err(format!(
                    "`{name}` has {size} elements: write a vector of as many, or one of them, `{name}[0]`"
                ))
            }
            (Some(None), _) => {
                Err(format!("`{}` is an array: write `{0}[i in 0..N]` for all of its elements", view.name))
            }
            (None, _) => {
                Err(format!("`{}` is a number, this is a vector", element_name(&view.name, &view.indices)))
            }
        }
    }

    /// `link[i in 1..N]`, or the name itself: for the text of equations.
    pub(super) fn name_with_ranges(&self, indexed: &Indexed, indices: &[Affine]) -> String {
        let print = |index: &Affine| index.print(Notation::Unicode);
        let ranges = std::iter::zip(indices, self.ranges()).map(|(index, range)| {
            format!("{} in {}..{}", print(index), print(&range.from), print(&range.to))
        });
        let ranges: Vec<String> = ranges.collect();
        let name = plain(&indexed.name);
        if ranges.is_empty() { name } else { format!("{name}[{}]", ranges.join(", ")) }
    }

    /// The numbers of a value with the names that they have: `name`, or `name[indices, element]`.
    pub(super) fn named(&self, indexed: &Indexed, indices: &[Affine], value: &Value) -> Vec<Named> {
        let ranges = self.open_ranges();
        let name = plain(&indexed.name);
        let keeps_loop = self.expansion() == Expansion::Looped;
        let mut named = Vec::new();
        let outer = if keeps_loop { &[] } else { indices };
        elements(value, &mut outer.to_vec(), &mut |indices, root| {
            let name = element_name(&name, indices);
            named.push(Named { name, span: indexed.span(), root, ranges: ranges.clone() });
        });
        named
    }
}

/// Every number of a value with its indices.
fn elements(value: &Value, indices: &mut Vec<Affine>, found: &mut dyn FnMut(&[Affine], ExprId)) {
    match value {
        Value::Scalar(root) => found(indices, *root),
        Value::Vector(parts) => {
            for (index, part) in (0..).zip(parts) {
                indices.push(Affine::number(index));
                elements(part, indices, found);
                indices.pop();
            }
        }
        Value::Array(_) | Value::Index(_) => unreachable!("an equation's elements are known"),
    }
}
