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
    Input(usize),
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

/// What an expression is of, beside coordinates and the time.
#[derive(Clone, Copy)]
struct Names {
    coordinates: usize,
    has_velocities: bool,
    inputs: usize,
    /// Without exponentials and high powers: a sine of these is noise, of which no displacement tells how large it is. The slopes of a Lagrangian
    /// are as large as its noise, the values of a force are not.
    is_tame: bool,
}

impl Expression {
    fn random(
        choices: &mut Choices,
        Names { coordinates: n, has_velocities, inputs, is_tame }: Names,
    ) -> Self {
        let mut operations = vec![Operation::Coordinate(choices.below(n))];
        for _ in 0..1 + choices.below(12) {
            let last = operations.len() - 1;
            let other = choices.below(operations.len());
            let operation = match choices.below(26) {
                0..=3 => Operation::Coordinate(choices.below(n)),
                4 if has_velocities => Operation::Velocity(choices.below(n)),
                4 | 5 => Operation::Number(number(choices)),
                6 => Operation::Time,
                7..=9 => Operation::Add(last, other),
                10 | 11 => Operation::Sub(last, other),
                12..=14 => Operation::Mul(last, other),
                15 => Operation::Div(last, other),
                16 => Operation::Atan2(last, other),
                17 if is_tame => Operation::Powi(last, 2),
                17 => Operation::Powi(last, choices.pick(&[2, 3, -1, 0, 1, -2, 7])),
                18 => choices.pick(&[Operation::Sqrt(last), Operation::Ln(last), Operation::Abs(last)]),
                19 | 20 => Operation::Sin(last),
                21 => Operation::Cos(last),
                22 => Operation::Tanh(last),
                24 | 25 if inputs > 0 => Operation::Input(choices.below(inputs)),
                _ if is_tame => Operation::Tanh(last),
                _ => Operation::Exp(last),
            };
            operations.push(operation);
        }
        Self(operations)
    }

    fn value<T: Scalar>(&self, t: T, q: &[T], v: &[T], inputs: &[T]) -> T {
        let mut values: Vec<T> = Vec::with_capacity(self.0.len());
        for operation in &self.0 {
            let value = match *operation {
                Operation::Number(number) => T::from_f64(number),
                Operation::Time => t,
                Operation::Coordinate(i) => q[i],
                Operation::Velocity(i) => v[i],
                Operation::Input(i) => inputs[i],
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

/// A random Lagrangian, random constraints and, in every second case, random forces in up to four coordinates.
#[derive(Clone, Debug)]
pub(crate) struct RandomSystem {
    masses: Vec<f64>,
    /// What `L` has beside `½ Σ mᵢ vᵢ²`.
    rest: Expression,
    /// Each is constant.
    constraints: Vec<Expression>,
    /// The values of the constraints.
    levels: Vec<f64>,
    n_inputs: usize,
    /// Rayleigh's function is half of its square, which takes energy wherever it is linear in velocities.
    dissipation: Option<Expression>,
    /// Of every coordinate.
    forces: Vec<Option<Expression>>,
}

impl RandomSystem {
    pub(crate) fn random(choices: &mut Choices) -> Self {
        let n = 1 + choices.below(4);
        let m = if choices.once_in(2) { choices.below(n + 1) } else { 0 };
        let of_places = Names { coordinates: n, has_velocities: false, inputs: 0, is_tame: false };
        let of_motion = Names { has_velocities: choices.once_in(3), ..of_places };
        let masses = (0..n).map(|_| parameter(choices)).collect();
        let rest = Expression::random(choices, of_motion);
        let constraints = (0..m).map(|_| Expression::random(choices, of_places)).collect();
        let has_forces = choices.once_in(2);
        let n_inputs = if has_forces { choices.below(3) } else { 0 };
        let of_all = Names { has_velocities: true, inputs: n_inputs, is_tame: true, ..of_places };
        let mut perhaps =
            |names: Names| (has_forces && choices.once_in(2)).then(|| Expression::random(choices, names));
        let dissipation = perhaps(Names { inputs: 0, ..of_all });
        let forces = (0..n).map(|_| perhaps(of_all)).collect();
        Self { masses, rest, constraints, levels: vec![0.0; m], n_inputs, dissipation, forces }
    }

    /// The same with constraints that hold at `(t, q)`.
    pub(crate) fn through(mut self, t: f64, q: &[f64]) -> Self {
        self.levels = self.constraints.iter().map(|constraint| constraint.value(t, q, &[], &[])).collect();
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
        let mut sum = self.rest.value(t, q, v, &[]);
        for (mass, v) in self.masses.iter().zip(v) {
            sum = sum + T::from_f64(0.5 * mass) * *v * *v;
        }
        sum
    }

    fn constraints<T: Scalar>(&self, t: T, q: &[T], residuals: &mut [T]) {
        for ((residual, constraint), level) in residuals.iter_mut().zip(&self.constraints).zip(&self.levels) {
            *residual = constraint.value(t, q, &[], &[]) - T::from_f64(*level);
        }
    }

    fn n_inputs(&self) -> usize {
        self.n_inputs
    }

    const HAS_DISSIPATION: bool = true;

    fn dissipation<T: Scalar>(&self, t: T, q: &[T], v: &[T]) -> T {
        let Some(root) = &self.dissipation else { return T::from_f64(0.0) };
        let root = root.value(t, q, v, &[]);
        T::from_f64(0.5) * root * root
    }

    const HAS_FORCES: bool = true;

    fn add_forces<T: Scalar>(&self, t: T, q: &[T], v: &[T], inputs: &[T], forces: &mut [T]) {
        for (sum, force) in forces.iter_mut().zip(&self.forces) {
            if let Some(force) = force {
                *sum = *sum + force.value(t, q, v, inputs);
            }
        }
    }
}
