//! Vectors in expressions: literals, element-wise arithmetic, products, norms, indices.
//!
//! Where equations are computed a vector is a list of numbers; where they are printed it is an expression like any other.

use super::expression::{Lowering, Resolver};
use super::spine::{first_span, last_span};
use crate::budget::{LONGEST_VECTOR, MOST_SIZES};
use crate::expr::{Affine, Binary, Composite, Dependence, ExprId, Unary, Value, View};

/// The functions of vectors.
pub(super) const VECTOR_FUNCTIONS: [&str; 4] = ["dot", "cross", "norm", "norm_squared"];

/// Numbers of a place in space.
const DIMENSIONS: usize = 3;

impl<R: Resolver> Lowering<'_, R> {
    /// The number that `value` is; reports a vector.
    pub(super) fn number(&mut self, value: Value, place: &syn::Expr) -> Option<ExprId> {
        match self.known(value) {
            Ok(Value::Scalar(number)) => Some(number),
            Ok(Value::Vector(parts)) => {
                let length = parts.len();
                let message = format!(
                    "a vector of {length} where a number is expected: write one of its elements, `.norm()` or `.dot(..)`"
                );
                self.mistake_between(first_span(place), last_span(place), message)
            }
            Ok(Value::Array(_) | Value::Index(_)) => unreachable!("arrays and indices are made known"),
            Err(message) => self.mistake_between(first_span(place), last_span(place), message),
        }
    }

    /// The value with its elements, or why they are not known; an index as a number.
    pub(super) fn known(&mut self, value: Value) -> Result<Value, String> {
        match value {
            Value::Index(index) => Ok(Value::Scalar(self.resolver.index_as_number(self.graph, &index))),
            Value::Array(view) if self.graph.is_as_written() => {
                Ok(Value::Scalar(self.resolver.element(self.graph, &view)))
            }
            Value::Array(view) => self.elements(view),
            known => Ok(known),
        }
    }

    fn elements(&mut self, view: View) -> Result<Value, String> {
        let Some(size) = view.shape.first() else {
            return Ok(Value::Scalar(self.resolver.element(self.graph, &view)));
        };
        let Some(size) = size.as_number() else {
            return Err(format!(
                "`{}` is an array of `{}` elements: write one of them, or go over them with `sum(0..{1}, |i| ..)`",
                view.name,
                size.print(crate::expr::Notation::Unicode)
            ));
        };
        if view.n_numbers() > LONGEST_VECTOR {
            return Err(format!(
                "`{}` has {} numbers, a vector that is written out at most {LONGEST_VECTOR}: write one of its elements, or go over \
                 them with `sum`",
                view.name,
                view.n_numbers()
            ));
        }
        let element = |lowering: &mut Self, index| lowering.elements(view.clone().at(Affine::number(index)));
        (0..size).map(|index| element(self, index)).collect::<Result<_, _>>().map(Value::Vector)
    }

    /// `first operator second`, element by element; or what is wrong with it.
    pub(super) fn combined(
        &mut self,
        operator: Binary,
        first: Value,
        second: Value,
    ) -> Result<Value, String> {
        use Value::{Scalar, Vector};
        match (self.known(first)?, self.known(second)?) {
            (Scalar(a), Scalar(b)) => Ok(Scalar(self.graph.binary(operator, a, b))),
            (Vector(a), Vector(b)) if matches!(operator, Binary::Add | Binary::Sub) => {
                if a.len() != b.len() {
                    let (a, b) = (a.len(), b.len());
                    return Err(format!("vectors of {a} and of {b} elements: both sides of `+` and `-` have the same length"));
                }
                std::iter::zip(a, b).map(|(a, b)| self.combined(operator, a, b)).collect::<Result<_, _>>().map(Vector)
            }
            (Vector(parts), number @ Scalar(_)) if matches!(operator, Binary::Mul | Binary::Div) => {
                let parts = parts.into_iter().map(|part| self.combined(operator, part, number.clone()));
                parts.collect::<Result<_, _>>().map(Vector)
            }
            (number @ Scalar(_), Vector(parts)) if operator == Binary::Mul => {
                let parts = parts.into_iter().map(|part| self.combined(operator, number.clone(), part));
                parts.collect::<Result<_, _>>().map(Vector)
            }
            (Vector(_), Vector(_)) if operator == Binary::Mul => {
                Err("a product of vectors: write `.dot(..)` for the scalar product, `.cross(..)` for the vector product".to_owned())
            }
            (_, Vector(_)) if operator == Binary::Div => Err("nothing is divided by a vector".to_owned()),
            _ => Err("a vector and a number: `+` and `-` take two of a kind".to_owned()),
        }
    }

    /// `−value`.
    pub(super) fn negative(&mut self, value: Value) -> Result<Value, String> {
        Ok(match self.known(value)? {
            Value::Scalar(number) => Value::Scalar(self.graph.neg(number)),
            Value::Vector(parts) => {
                Value::Vector(parts.into_iter().map(|part| self.negative(part)).collect::<Result<_, _>>()?)
            }
            Value::Array(_) | Value::Index(_) => unreachable!("arrays and indices are made known"),
        })
    }

    /// A vector from its elements, as it is written in `literal`.
    pub(super) fn row(&mut self, values: Vec<Option<Value>>, literal: &syn::ExprArray) -> Option<Value> {
        let values: Vec<Value> = values.into_iter().collect::<Option<_>>()?;
        if values.iter().any(|value| value.n_levels() >= MOST_SIZES) {
            let message = format!("vectors of vectors have at most {MOST_SIZES} levels");
            return self.mistake_over(literal, message);
        }
        // They multiply with every line that is written.
        let n_numbers = values.iter().map(Value::n_numbers).fold(0, u64::saturating_add);
        if n_numbers > LONGEST_VECTOR {
            let message = format!(
                "a vector of {n_numbers} numbers: at most {LONGEST_VECTOR} are written out, longer ones are arrays of coordinates or parameters"
            );
            return self.mistake_over(literal, message);
        }
        if !self.graph.is_as_written() {
            return Some(Value::Vector(values));
        }
        let parts = values.into_iter().map(|value| self.known(value)).collect::<Result<Vec<_>, _>>().ok()?;
        let parts = parts.into_iter().filter_map(|part| match part {
            Value::Scalar(part) => Some(part),
            _ => None,
        });
        Some(Value::Scalar(self.graph.composite(Composite::Row(parts.collect()), Dependence::default())))
    }

    /// `receiver.dot(argument)` and its like.
    pub(super) fn function_of_vectors(
        &mut self,
        call: &syn::ExprMethodCall,
        receiver: Option<Value>,
        arguments: &[&syn::Expr],
    ) -> Option<Value> {
        let method = call.method.to_string();
        let argument = match (method.as_str(), arguments) {
            ("dot" | "cross", [argument]) => Some(self.value(argument)),
            ("dot" | "cross", _) => {
                return self.mistake(call.method.span(), format!("`.{method}` takes one vector"));
            }
            (_, []) => None,
            (_, [extra, ..]) => return self.mistake_over(extra, format!("`.{method}()` takes no argument")),
        };
        let receiver = receiver?;
        let argument = match argument {
            Some(argument) => Some(argument?),
            None => None,
        };
        if self.graph.is_as_written() {
            return self.written_function(&method, receiver, argument);
        }
        match self.product(&method, receiver, argument) {
            Ok(value) => Some(value),
            Err(message) => self.mistake(call.method.span(), message),
        }
    }

    fn product(&mut self, method: &str, receiver: Value, argument: Option<Value>) -> Result<Value, String> {
        let a = self.numbers(method, receiver)?;
        let Some(argument) = argument else {
            let squares: Vec<ExprId> = a.into_iter().map(|part| self.graph.power(part, 2)).collect();
            let sum = self.total(squares);
            let is_root = method == "norm";
            return Ok(Value::Scalar(if is_root { self.graph.unary(Unary::Sqrt, sum) } else { sum }));
        };
        let b = self.numbers(method, argument)?;
        if a.len() != b.len() {
            return Err(format!(
                "`.{method}` of vectors of {} and of {} elements: both have the same length",
                a.len(),
                b.len()
            ));
        }
        if method == "dot" {
            let products = std::iter::zip(a, b).map(|(a, b)| self.graph.mul(a, b)).collect();
            return Ok(Value::Scalar(self.total(products)));
        }
        let (&[a1, a2, a3], &[b1, b2, b3]) = (a.as_slice(), b.as_slice()) else {
            return Err(format!("`.cross` of vectors of {} elements: it takes vectors of 3", a.len()));
        };
        let mut minor = |a: ExprId, b: ExprId, c: ExprId, d: ExprId| {
            let (first, second) = (self.graph.mul(a, d), self.graph.mul(b, c));
            Value::Scalar(self.graph.sub(first, second))
        };
        Ok(Value::Vector(vec![minor(a2, a3, b2, b3), minor(a3, a1, b3, b1), minor(a1, a2, b1, b2)]))
    }

    /// The elements of a vector of numbers.
    fn numbers(&mut self, method: &str, vector: Value) -> Result<Vec<ExprId>, String> {
        let Value::Vector(parts) = self.known(vector)? else {
            return Err(format!("`.{method}` is a function of vectors, this is a number"));
        };
        let number = |part| match part {
            Value::Scalar(number) => Ok(number),
            _ => Err(format!("`.{method}` is a function of vectors of numbers, this is an array of vectors")),
        };
        parts.into_iter().map(number).collect()
    }

    fn total(&mut self, terms: Vec<ExprId>) -> ExprId {
        let sum = terms.into_iter().reduce(|sum, term| self.graph.add(sum, term));
        sum.unwrap_or_else(|| self.graph.number(0.0))
    }

    fn written_function(&mut self, method: &str, receiver: Value, argument: Option<Value>) -> Option<Value> {
        let mut scalar = |value: Value| match self.known(value) {
            Ok(Value::Scalar(value)) => Some(value),
            _ => None,
        };
        let receiver = scalar(receiver)?;
        let composite = match argument {
            Some(argument) if method == "dot" => Composite::Dot(receiver, scalar(argument)?),
            Some(argument) => Composite::Cross(receiver, scalar(argument)?),
            None => Composite::Norm(receiver),
        };
        let value = self.graph.composite(composite, Dependence::default());
        Some(Value::Scalar(if method == "norm_squared" { self.graph.power(value, 2) } else { value }))
    }

    /// `body.point([a, b, c])`, of positions or velocities: `body[0] + a body[1] + b body[2] + c body[3]`.
    pub(super) fn point_of_body(&mut self, call: &syn::ExprMethodCall, body: Option<Value>) -> Option<Value> {
        let place = match call.args.iter().collect::<Vec<_>>().as_slice() {
            [syn::Expr::Array(array)] => {
                array.elems.iter().map(|part| self.value(part)).collect::<Option<Vec<_>>>()
            }
            [place] => self.value(place).and_then(|place| self.parts(place, DIMENSIONS)),
            _ => {
                return self.mistake(
                    call.method.span(),
                    "`.point` takes a place in the frame of the body: `.point([a, b, c])`",
                );
            }
        };
        let (body, place) = (body?, place?);
        let sizes = |view: &View| view.shape.iter().map(Affine::as_number).collect::<Vec<_>>();
        let view = match body {
            Value::Array(view) if sizes(&view) == [Some(4), Some(3)] => view,
            _ => {
                return self.mistake(
                    call.method.span(),
                    "`.point` is a function of bodies: `rigid_body(name, ..)`, `name.point([a, b, c])`",
                );
            }
        };
        if place.len() != DIMENSIONS {
            let message = format!("a place in the frame of a body has 3 numbers, this has {}", place.len());
            return self.mistake_over(&call.args, message);
        }
        let mut point = Value::Array(view.clone().at(Affine::number(0)));
        for (director, number) in (1..).zip(place) {
            let is_fixed = match self.known(number.clone()) {
                Ok(Value::Scalar(number)) => self.graph.dependence(number).is_constant(),
                _ => return self.mistake_over(&call.args, "a place in the frame of a body has 3 numbers"),
            };
            if !is_fixed {
                return self.mistake_over(
                    &call.args,
                    "a point of a body does not move in its frame: its place is made of parameters",
                );
            }
            let axis = Value::Array(view.clone().at(Affine::number(director)));
            let part = self.combined(Binary::Mul, number, axis);
            point = match part.and_then(|part| self.combined(Binary::Add, point, part)) {
                Ok(point) => point,
                Err(message) => return self.mistake(call.method.span(), message),
            };
        }
        Some(point)
    }

    /// The elements of a vector.
    fn parts(&mut self, vector: Value, length: usize) -> Option<Vec<Value>> {
        match self.known(vector) {
            Ok(Value::Vector(parts)) => Some(parts),
            // As it is written, a vector is one expression.
            Ok(Value::Scalar(vector)) if self.graph.is_as_written() => {
                let part = |index| {
                    let index = Affine::number(i64::try_from(index).unwrap_or(0));
                    Value::Scalar(self.graph.composite(Composite::Part(vector, index), Dependence::default()))
                };
                Some((0..length).map(part).collect())
            }
            _ => Some(Vec::new()),
        }
    }
}
