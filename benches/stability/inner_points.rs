//! A step on a polynomial, found anew from its two ends: the points between them, and the momenta at them.
//!
//! Of a step on polynomials of degree `K` the ends are stored, the points between are not. They are a stationary point of
//!
//! ```text
//! L_d(q₀, q₁) = ext h Σⱼ wⱼ L(tⱼ, x(τⱼ), x'(τⱼ)/h),   x(τ) = q₀ + Σ_a ℓ_a(τ) d_a,   φ(t_a, q₀ + d_a) = 0,   a = 1 .. K−1
//! ```
//!
//! and depend on nothing else (Marsden & West, Acta Numerica 10 (2001), sec. 2.2.6): with Lobatto's nodes these are the equations of a Galerkin step, with
//! Gauss' those of a Gauss step. They are solved here from the cubic through positions and velocities of the two ends, by differences of first derivatives
//! that are dual numbers of another project on the user's own expressions, with nodes, weights and elimination of this file. Forces do their virtual work
//! at the nodes.

use evi_core::generic::GenericSystem;
use num_dual::Dual64;

/// The curves and the rule of a step.
#[derive(Clone, Debug)]
pub(crate) struct InnerPoints {
    /// Where points and constraints are, from 0 to 1.
    points: Vec<f64>,
    rule: Vec<Node>,
}

/// A node of the rule.
#[derive(Clone, Debug)]
struct Node {
    time: f64,
    weight: f64,
    /// `ℓ_a` there.
    values: Vec<f64>,
    /// `ℓ_a'` there.
    rates: Vec<f64>,
}

/// A step by its ends.
#[derive(Clone, Copy)]
pub(crate) struct Step<'a> {
    pub(crate) t: f64,
    pub(crate) h: f64,
    pub(crate) q: [&'a [f64]; 2],
    pub(crate) v: [&'a [f64]; 2],
    pub(crate) inputs: &'a [f64],
}

/// Points between the ends of a step, and the factors that found them.
#[derive(Clone)]
pub(crate) struct Found {
    unknowns: Vec<f64>,
    factors: Lu,
}

/// What contracts by [`SLOWEST`] is at round-off before.
const CORRECTIONS: usize = 40;
/// Corrections with one matrix that shrink less than this contract no more, or never did.
const SLOWEST: f64 = 0.25;
/// Where they do not, they are round-off below this part of the configuration.
const FOUND: f64 = 1e-13;
/// Points are next to the cubic up to this part of the way.
const NEXT: f64 = 0.01;
/// Displacements by which matrices are found, relative to the configuration.
const DISPLACEMENT: f64 = 1.0 / (1 << 20) as f64;

impl InnerPoints {
    /// Polynomials of degree `K ≥ 1` on Lobatto's `K + 1` nodes.
    pub(crate) fn lobatto(degree: usize) -> Self {
        let points = lobatto_nodes(degree);
        // `1 / P_K²` but for a factor: Hildebrand, Introduction to Numerical Analysis, sec. 8.11.
        let weights =
            normalised(points.iter().map(|x| legendre(degree, 2.0 * x - 1.0)[0].powi(-2)).collect());
        Self::new(points.clone(), &points, &weights)
    }

    /// Polynomials of degree `K ≥ 1` on Gauss' `K` nodes.
    pub(crate) fn gauss(degree: usize) -> Self {
        let nodes: Vec<f64> = (0..degree).map(|k| gauss_node(degree, k)).collect();
        let weight = |x: &f64| {
            let x = 2.0 * x - 1.0;
            1.0 / ((1.0 - x * x) * legendre(degree, x)[1].powi(2))
        };
        let weights = normalised(nodes.iter().map(weight).collect());
        Self::new(lobatto_nodes(degree), &nodes, &weights)
    }

    fn new(points: Vec<f64>, nodes: &[f64], weights: &[f64]) -> Self {
        let rule = nodes.iter().zip(weights).map(|(&time, &weight)| {
            let (values, rates) = lagrange(&points, time);
            Node { time, weight, values, rates }
        });
        Self { rule: rule.collect(), points }
    }

    fn degree(&self) -> usize {
        self.points.len() - 1
    }

    /// The points of a step; `None` where they are not next to the cubic, or the corrections from there do not contract, as in a step that does not
    /// resolve its motion: its ends may belong to several curves, and the iteration find another one than the step.
    pub(crate) fn found<S: GenericSystem>(&self, system: &S, step: Step<'_>) -> Option<Found> {
        let guess = self.guess(system, step);
        let factors = self.factors(system, step, &guess)?;
        let n_positions = (self.degree() - 1) * system.n_coordinates();
        let found = self.found_from(system, step, Found { unknowns: guess.clone(), factors })?;
        let chord = step.q[0].iter().zip(step.q[1]).map(|(start, end)| (end - start).abs());
        let ways = step.v.iter().flat_map(|v| v.iter()).map(|v| (step.h * v).abs());
        let way = chord.chain(ways).fold(0.0, f64::max);
        let pairs = found.unknowns[..n_positions].iter().zip(&guess);
        let apart = pairs.map(|(found, guess)| (found - guess).abs()).fold(0.0, f64::max);
        (apart <= NEXT * way).then_some(found)
    }

    /// The points of a step that is near to the one of which others were found.
    pub(crate) fn found_near<S: GenericSystem>(
        &self,
        system: &S,
        step: Step<'_>,
        near: &Found,
    ) -> Option<Found> {
        self.found_from(system, step, near.clone())
    }

    fn found_from<S: GenericSystem>(&self, system: &S, step: Step<'_>, mut found: Found) -> Option<Found> {
        let n_positions = (self.degree() - 1) * system.n_coordinates();
        let size = largest(step.q[0]).max(largest(step.q[1]));
        let mut previous = f64::INFINITY;
        for _ in 0..CORRECTIONS {
            let mut correction = self.residual(system, step, &found.unknowns);
            found.factors.solve(&mut correction);
            for (unknown, correction) in found.unknowns.iter_mut().zip(&correction) {
                *unknown -= correction;
            }
            let length = largest(&correction[..n_positions]);
            // Written so that a NaN does not contract.
            let contracts = length <= SLOWEST * previous;
            if !contracts || length == 0.0 {
                return (length <= FOUND * size).then_some(found);
            }
            previous = length;
        }
        None
    }

    /// `[−D₁L_d, D₂L_d]` with the virtual work of forces: the momenta that depart and arrive but for the impulses of the constraints.
    pub(crate) fn momenta<S: GenericSystem>(
        &self,
        system: &S,
        step: Step<'_>,
        found: &Found,
    ) -> [Vec<f64>; 2] {
        let [mut departing, arriving] =
            [0, self.degree()].map(|a| self.balance(system, step, &found.unknowns, a));
        departing.iter_mut().for_each(|p| *p = -*p);
        [departing, arriving]
    }

    /// The cubic through both ends, without impulses.
    fn guess<S: GenericSystem>(&self, system: &S, step: Step<'_>) -> Vec<f64> {
        let (n, m) = (system.n_coordinates(), system.n_constraints());
        let inner = &self.points[1..self.degree()];
        let mut guess = Vec::with_capacity(inner.len() * (n + m));
        for &x in inner {
            for i in 0..n {
                let way = step.q[1][i] - step.q[0][i];
                let [departing, arriving] = step.v.map(|v| step.h * v[i]);
                let bend = (x - 1.0) * departing + x * arriving;
                guess.push(x * x * (3.0 - 2.0 * x) * way + x * (x - 1.0) * bend);
            }
        }
        guess.resize(inner.len() * (n + m), 0.0);
        guess
    }

    /// What the equations of the inner points leave: those of the momenta, then the constraints.
    fn residual<S: GenericSystem>(&self, system: &S, step: Step<'_>, unknowns: &[f64]) -> Vec<f64> {
        let (n, m) = (system.n_coordinates(), system.n_constraints());
        let inner = self.degree() - 1;
        let gradients = self.gradients(system, step, unknowns);
        let (mut momenta, mut constraints) = (Vec::with_capacity(inner * n), Vec::with_capacity(inner * m));
        for a in 1..=inner {
            let mut left = self.sum(&gradients, step.h, a);
            if m > 0 {
                let impulses = &unknowns[inner * n + (a - 1) * m..][..m];
                let t = step.t + step.h * self.points[a];
                let q = self.point(step, unknowns, a);
                let mut values = vec![Dual64::from_re(0.0); m];
                let mut moved: Vec<Dual64> = q.iter().map(|&q| Dual64::from_re(q)).collect();
                for i in 0..n {
                    moved[i].eps = 1.0;
                    system.constraints(Dual64::from_re(t), &moved, &mut values);
                    moved[i].eps = 0.0;
                    left[i] -=
                        values.iter().zip(impulses).map(|(value, impulse)| value.eps * impulse).sum::<f64>();
                }
                constraints.extend(values.iter().map(|value| value.re));
            }
            momenta.extend(left);
        }
        momenta.extend(constraints);
        momenta
    }

    /// The derivative of the action along point `a`.
    fn balance<S: GenericSystem>(&self, system: &S, step: Step<'_>, unknowns: &[f64], a: usize) -> Vec<f64> {
        self.sum(&self.gradients(system, step, unknowns), step.h, a)
    }

    fn sum(&self, gradients: &[[Vec<f64>; 2]], h: f64, a: usize) -> Vec<f64> {
        let n = gradients[0][0].len();
        let along = |node: &Node, [force, momentum]: &[Vec<f64>; 2], i: usize| {
            node.weight * (h * node.values[a] * force[i] + node.rates[a] * momentum[i])
        };
        (0..n).map(|i| self.rule.iter().zip(gradients).map(|(node, at)| along(node, at, i)).sum()).collect()
    }

    /// `∂L/∂q` with all forces, and `∂L/∂v`, at every node.
    fn gradients<S: GenericSystem>(
        &self,
        system: &S,
        step: Step<'_>,
        unknowns: &[f64],
    ) -> Vec<[Vec<f64>; 2]> {
        let n = system.n_coordinates();
        let differences: Vec<Vec<f64>> =
            (1..=self.degree()).map(|a| self.difference(step, unknowns, a)).collect();
        let along = |weights: &[f64], i: usize| -> f64 {
            differences.iter().zip(&weights[1..]).map(|(difference, weight)| weight * difference[i]).sum()
        };
        let at = |node: &Node| {
            let q: Vec<f64> = (0..n).map(|i| step.q[0][i] + along(&node.values, i)).collect();
            let v: Vec<f64> = (0..n).map(|i| along(&node.rates, i) / step.h).collect();
            gradient(system, step.t + step.h * node.time, &q, &v, step.inputs)
        };
        self.rule.iter().map(at).collect()
    }

    /// `d_a = q_a − q₀`.
    fn difference(&self, step: Step<'_>, unknowns: &[f64], a: usize) -> Vec<f64> {
        let n = step.q[0].len();
        if a == self.degree() {
            return step.q[1].iter().zip(step.q[0]).map(|(end, start)| end - start).collect();
        }
        unknowns[(a - 1) * n..a * n].to_vec()
    }

    fn point(&self, step: Step<'_>, unknowns: &[f64], a: usize) -> Vec<f64> {
        self.difference(step, unknowns, a)
            .iter()
            .zip(step.q[0])
            .map(|(difference, q)| q + difference)
            .collect()
    }

    /// The matrix of the inner points by differences, eliminated.
    fn factors<S: GenericSystem>(&self, system: &S, step: Step<'_>, unknowns: &[f64]) -> Option<Lu> {
        let n_positions = (self.degree() - 1) * system.n_coordinates();
        let size = largest(step.q[0]).max(largest(step.q[1])).max(largest(&unknowns[..n_positions]));
        let here = self.residual(system, step, unknowns);
        let impulse = largest(&here[..n_positions]).max(f64::MIN_POSITIVE);
        let mut moved = unknowns.to_vec();
        let columns = (0..unknowns.len()).map(|col| {
            let by = if col < n_positions { DISPLACEMENT * size } else { impulse };
            moved[col] = unknowns[col] + by;
            let by = moved[col] - unknowns[col];
            let there = self.residual(system, step, &moved);
            moved[col] = unknowns[col];
            there.iter().zip(&here).map(|(there, here)| (there - here) / by).collect()
        });
        Lu::of(columns.collect())
    }
}

/// `∂L/∂q` with all forces, and `∂L/∂v`.
pub(crate) fn gradient<S: GenericSystem>(
    system: &S,
    t: f64,
    q: &[f64],
    v: &[f64],
    inputs: &[f64],
) -> [Vec<f64>; 2] {
    let n = q.len();
    let mut force = vec![0.0; n];
    if S::HAS_FORCES {
        system.add_forces(t, q, v, inputs, &mut force);
    }
    let mut momentum = vec![0.0; n];
    let dual = |x: &[f64]| -> Vec<Dual64> { x.iter().map(|&x| Dual64::from_re(x)).collect() };
    let (t, mut q, mut v) = (Dual64::from_re(t), dual(q), dual(v));
    for i in 0..n {
        q[i].eps = 1.0;
        force[i] += system.lagrangian(t, &q, &v).eps;
        q[i].eps = 0.0;
        v[i].eps = 1.0;
        momentum[i] = system.lagrangian(t, &q, &v).eps;
        if S::HAS_DISSIPATION {
            force[i] -= system.dissipation(t, &q, &v).eps;
        }
        v[i].eps = 0.0;
    }
    [force, momentum]
}

/// Factors of a square matrix of rows and columns in many units, with partial pivoting.
#[derive(Clone)]
struct Lu {
    rows: Vec<Vec<f64>>,
    order: Vec<usize>,
    row_scale: Vec<f64>,
    column_scale: Vec<f64>,
}

impl Lu {
    fn of(columns: Vec<Vec<f64>>) -> Option<Self> {
        let n = columns.len();
        let reciprocal = |x: f64| if x > 0.0 { 1.0 / x } else { 1.0 };
        let column_scale: Vec<f64> = columns.iter().map(|column| reciprocal(largest(column))).collect();
        let mut rows: Vec<Vec<f64>> =
            (0..n).map(|row| (0..n).map(|col| columns[col][row] * column_scale[col]).collect()).collect();
        let row_scale: Vec<f64> = rows.iter().map(|row| reciprocal(largest(row))).collect();
        for (row, scale) in rows.iter_mut().zip(&row_scale) {
            row.iter_mut().for_each(|entry| *entry *= scale);
        }
        let mut order: Vec<usize> = (0..n).collect();
        for k in 0..n {
            let pivot = (k..n).max_by(|&a, &b| rows[a][k].abs().total_cmp(&rows[b][k].abs()))?;
            rows.swap(k, pivot);
            order.swap(k, pivot);
            // Written so that a NaN is none.
            let is_regular = rows[k][k].abs() > 0.0;
            if !is_regular {
                return None;
            }
            let (above, below) = rows.split_at_mut(k + 1);
            let top = &above[k];
            for row in below {
                let factor = row[k] / top[k];
                row[k] = factor;
                for (entry, above) in row[k + 1..].iter_mut().zip(&top[k + 1..]) {
                    *entry -= factor * above;
                }
            }
        }
        Some(Self { rows, order, row_scale, column_scale })
    }

    fn solve(&self, rhs: &mut Vec<f64>) {
        let n = rhs.len();
        let mut x: Vec<f64> = self.order.iter().map(|&row| rhs[row] * self.row_scale[row]).collect();
        for row in 0..n {
            let known: f64 = (0..row).map(|col| self.rows[row][col] * x[col]).sum();
            x[row] -= known;
        }
        for row in (0..n).rev() {
            let known: f64 = (row + 1..n).map(|col| self.rows[row][col] * x[col]).sum();
            x[row] = (x[row] - known) / self.rows[row][row];
        }
        *rhs = x.iter().zip(&self.column_scale).map(|(x, scale)| x * scale).collect();
    }
}

/// The largest magnitude; NaN if one is.
fn largest(values: &[f64]) -> f64 {
    values.iter().map(|x| x.abs()).fold(0.0, |largest, x| if x <= largest { largest } else { x })
}

/// `P_K(x)`, `P_K'(x)` and `P_K''(x)`.
fn legendre(degree: usize, x: f64) -> [f64; 3] {
    let mut before = [0.0; 3];
    let mut value = [1.0, 0.0, 0.0];
    for k in 0..degree {
        let (a, b) = ((2 * k + 1) as f64, k as f64);
        let times_x = [x * value[0], value[0] + x * value[1], 2.0 * value[1] + x * value[2]];
        let next = core::array::from_fn(|i| (a * times_x[i] - b * before[i]) / (k + 1) as f64);
        before = value;
        value = next;
    }
    value
}

/// Newton's iteration for a root in (0, 1) of what has the value and slope `at` over (−1, 1).
fn root(mut x: f64, at: impl Fn(f64) -> [f64; 2]) -> f64 {
    for _ in 0..60 {
        let [value, slope] = at(x);
        x -= value / slope;
    }
    0.5 + 0.5 * x
}

fn gauss_node(degree: usize, k: usize) -> f64 {
    let guess = -(std::f64::consts::PI * (k as f64 + 0.75) / (degree as f64 + 0.5)).cos();
    root(guess, |x| [legendre(degree, x)[0], legendre(degree, x)[1]])
}

/// The ends, and the roots of `P_K'` between them: next to those of Chebyshev's polynomials.
fn lobatto_nodes(degree: usize) -> Vec<f64> {
    let inner = (1..degree).map(|k| {
        let guess = -(std::f64::consts::PI * k as f64 / degree as f64).cos();
        root(guess, |x| [legendre(degree, x)[1], legendre(degree, x)[2]])
    });
    core::iter::once(0.0).chain(inner).chain([1.0]).collect()
}

fn normalised(weights: Vec<f64>) -> Vec<f64> {
    let sum: f64 = weights.iter().sum();
    weights.iter().map(|weight| weight / sum).collect()
}

/// Lagrange's polynomials on these points, and their slopes, at `x`.
fn lagrange(points: &[f64], x: f64) -> (Vec<f64>, Vec<f64>) {
    let of = |a: usize| -> (f64, f64) {
        points.iter().enumerate().filter(|(b, _)| *b != a).fold((1.0, 0.0), |(value, slope), (_, point)| {
            let per = 1.0 / (points[a] - point);
            (value * (x - point) * per, (slope * (x - point) + value) * per)
        })
    };
    (0..points.len()).map(of).unzip()
}
