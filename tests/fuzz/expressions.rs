//! Systems whose equations are data: what they are made of is chosen when the program runs.

use evi_core::generic::GenericSystem;
use evi_core::scalar::Scalar;

use crate::numbers::{number, parameter};
use crate::random_choices::Choices;

/// An operation on values that were found before, by their places.
#[derive(Clone, Copy, Debug)]
enum Operation {
    Number(f64),
    Time,
    Coordinate(usize),
    Velocity(usize),
    Add(usize, usize),
    Sub(usize, usize),
    Mul(usize, usize),
    Div(usize, usize),
    Atan2(usize, usize),
    Powi(usize, i32),
    Sqrt(usize),
    Sin(usize),
    Cos(usize),
    Exp(usize),
    Ln(usize),
    Tanh(usize),
    Abs(usize),
}

/// A list of operations; the last is the value.
#[derive(Clone, Debug)]
struct Expression(Vec<Operation>);

impl Expression {
    /// Of `n` coordinates and the time, and of velocities where it may.
    fn random(choices: &mut Choices, n: usize, has_velocities: bool) -> Self {
        let mut operations = vec![Operation::Coordinate(choices.below(n))];
        for _ in 0..1 + choices.below(12) {
            let last = operations.len() - 1;
            let other = choices.below(operations.len());
            let operation = match choices.below(24) {
                0..=3 => Operation::Coordinate(choices.below(n)),
                4 if has_velocities => Operation::Velocity(choices.below(n)),
                4 | 5 => Operation::Number(number(choices)),
                6 => Operation::Time,
                7..=9 => Operation::Add(last, other),
                10 | 11 => Operation::Sub(last, other),
                12..=14 => Operation::Mul(last, other),
                15 => Operation::Div(last, other),
                16 => Operation::Atan2(last, other),
                17 => Operation::Powi(last, choices.pick(&[2, 3, -1, 0, 1, -2, 7])),
                18 => choices.pick(&[Operation::Sqrt(last), Operation::Ln(last), Operation::Abs(last)]),
                19 | 20 => Operation::Sin(last),
                21 => Operation::Cos(last),
                22 => Operation::Tanh(last),
                _ => Operation::Exp(last),
            };
            operations.push(operation);
        }
        Self(operations)
    }

    fn value<T: Scalar>(&self, t: T, q: &[T], v: &[T]) -> T {
        let mut values: Vec<T> = Vec::with_capacity(self.0.len());
        for operation in &self.0 {
            let value = match *operation {
                Operation::Number(number) => T::from_f64(number),
                Operation::Time => t,
                Operation::Coordinate(i) => q[i],
                Operation::Velocity(i) => v[i],
                Operation::Add(a, b) => values[a] + values[b],
                Operation::Sub(a, b) => values[a] - values[b],
                Operation::Mul(a, b) => values[a] * values[b],
                Operation::Div(a, b) => values[a] / values[b],
                Operation::Atan2(a, b) => values[a].atan2(values[b]),
                Operation::Powi(a, exponent) => values[a].powi(exponent),
                Operation::Sqrt(a) => values[a].sqrt(),
                Operation::Sin(a) => values[a].sin(),
                Operation::Cos(a) => values[a].cos(),
                Operation::Exp(a) => values[a].exp(),
                Operation::Ln(a) => values[a].ln(),
                Operation::Tanh(a) => values[a].tanh(),
                Operation::Abs(a) => values[a].abs(),
            };
            values.push(value);
        }
        values[values.len() - 1]
    }
}

/// A random Lagrangian and random constraints in up to four coordinates.
#[derive(Clone, Debug)]
pub(crate) struct RandomSystem {
    masses: Vec<f64>,
    /// What `L` has beside `½ Σ mᵢ vᵢ²`.
    rest: Expression,
    /// Each is constant.
    constraints: Vec<Expression>,
    /// The values of the constraints.
    levels: Vec<f64>,
}

impl RandomSystem {
    pub(crate) fn random(choices: &mut Choices) -> Self {
        let n = 1 + choices.below(4);
        let m = if choices.once_in(2) { choices.below(n + 1) } else { 0 };
        let has_velocities = choices.once_in(3);
        Self {
            masses: (0..n).map(|_| parameter(choices)).collect(),
            rest: Expression::random(choices, n, has_velocities),
            constraints: (0..m).map(|_| Expression::random(choices, n, false)).collect(),
            levels: vec![0.0; m],
        }
    }

    /// The same with constraints that hold at `(t, q)`.
    pub(crate) fn through(mut self, t: f64, q: &[f64]) -> Self {
        self.levels = self.constraints.iter().map(|constraint| constraint.value(t, q, &[])).collect();
        self
    }

    /// The size of the terms of its constraints.
    pub(crate) fn largest_level(&self) -> f64 {
        crate::largest(&self.levels)
    }
}

impl GenericSystem for RandomSystem {
    fn n_coordinates(&self) -> usize {
        self.masses.len()
    }

    fn n_constraints(&self) -> usize {
        self.constraints.len()
    }

    fn lagrangian<T: Scalar>(&self, t: T, q: &[T], v: &[T]) -> T {
        let mut sum = self.rest.value(t, q, v);
        for (mass, v) in self.masses.iter().zip(v) {
            sum = sum + T::from_f64(0.5 * mass) * *v * *v;
        }
        sum
    }

    fn constraints<T: Scalar>(&self, t: T, q: &[T], residuals: &mut [T]) {
        for ((residual, constraint), level) in residuals.iter_mut().zip(&self.constraints).zip(&self.levels) {
            *residual = constraint.value(t, q, &[]) - T::from_f64(*level);
        }
    }
}
