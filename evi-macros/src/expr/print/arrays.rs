//! Sums, vectors and elements of arrays as people write them: `Σ_{i=0}^{N−1} ½ mᵢ |ṗᵢ|²`.

use super::names::symbol;
use super::{Level, Printer, Text};
use crate::expr::{Affine, Composite, ExprId};

impl Printer<'_> {
    pub(super) fn composite(&self, composite: &Composite) -> Text {
        match composite {
            Composite::Sum { index, from, to, body, .. } => self.loop_sum(index, from, to, *body),
            Composite::Element { name, is_velocity, indices } => {
                self.count_one();
                let indices: Vec<String> = indices.iter().map(|index| index.print(self.notation)).collect();
                let name =
                    if indices.is_empty() { name.clone() } else { format!("{name}[{}]", indices.join(", ")) };
                Text::atom(symbol(&name, *is_velocity, self.notation))
            }
            Composite::Index(index) => {
                self.count_one();
                let level = if index.terms.len() + usize::from(index.constant != 0) > 1 {
                    Level::Sum
                } else {
                    Level::Atom
                };
                Text { text: index.print(self.notation), level }
            }
            Composite::Part(vector, place) => {
                let vector = self.at_least(Level::Atom, self.expression(*vector));
                let place = place.print(self.notation);
                Text::atom(if self.is_latex() {
                    format!("{vector}_{{{place}}}")
                } else {
                    format!("{vector}[{place}]")
                })
            }
            Composite::Row(parts) => {
                let parts: Vec<String> = parts.iter().map(|part| self.sum(*part).text).collect();
                Text::atom(self.parentheses(&parts.join(", ")))
            }
            Composite::Dot(a, b) => self.product_of_vectors(*a, *b, ("·", "\\cdot")),
            Composite::Cross(a, b) => self.product_of_vectors(*a, *b, ("×", "\\times")),
            Composite::Norm(vector) => {
                let vector = self.sum(*vector).text;
                Text::atom(if self.is_latex() {
                    format!("\\left|{vector}\\right|")
                } else {
                    format!("|{vector}|")
                })
            }
        }
    }

    /// Reads on to the end of its product, like a function without parentheses.
    fn loop_sum(&self, index: &str, from: &Affine, to: &Affine, body: ExprId) -> Text {
        let last = to.plus(-1, &Affine::number(1)).unwrap_or_else(|| to.clone());
        let (from, last) = (from.print(self.notation), last.print(self.notation).replace(' ', ""));
        let sign = if self.is_latex() { "\\sum" } else { "Σ" };
        let body = self.sum(body);
        let body = self.at_least(Level::Product, body);
        Text { text: format!("{sign}_{{{index}={from}}}^{{{last}}} {body}"), level: Level::Function }
    }

    /// In parentheses among factors: `a · b c` would be read as `a · (b c)`.
    fn product_of_vectors(&self, a: ExprId, b: ExprId, (sign, command): (&str, &str)) -> Text {
        let (a, b) = (self.expression(a), self.expression(b));
        let (a, b) = (self.at_least(Level::Power, a), self.at_least(Level::Power, b));
        let sign = if self.is_latex() { command } else { sign };
        Text { text: format!("{a} {sign} {b}"), level: Level::Product }
    }
}
