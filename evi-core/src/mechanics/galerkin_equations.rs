//! The equations of a Galerkin step: a curve through `K + 1` Lobatto nodes, constraints at every node.
//!
//! With the points `q_a`, `a = 0 .. K`, at the nodes `c_a`, the weights `b_a`, and the rates `h v_j = Σ_a R_ja q_a` of the curve,
//!
//! ```text
//! L_d(q₀, …, q_K) = h Σⱼ bⱼ L(tⱼ, qⱼ, vⱼ)
//! h (−∂L_d/∂q_a − p₀ δ_a0) + G_aᵀ Λ_a = 0,   a = 0 .. K−1          φ(t_a, q_a) = 0,   a = 1 .. K
//! ```
//!
//! for the differences `d_a = q_a − q₀`, `a = 1 .. K`, and `Λ_a = h² b_a λ_a`, `a = 0 .. K−1` (Marsden & West, Acta Numerica 10 (2001),
//! sec. 2.2.6 and 3.5; with polynomials the Lobatto IIIA-IIIB pair: Jay, SIAM J. Numer. Anal. 33 (1996) 368; Wenger,
//! Ober-Blöbaum, Leyendecker, Adv. Comput. Math. 43 (2017) 1163). The sum of all rows is the balance of momentum,
//!
//! ```text
//! p⁻ = ∂L_d/∂q_K = p₀ + h Σⱼ bⱼ ∂L/∂q(qⱼ) − Σ G_aᵀ Λ_a / h + Σⱼ bⱼ rⱼ ∂L/∂v(qⱼ, vⱼ)        rⱼ = Σ_a R_ja
//! ```
//!
//! where `∂L/∂q + f` stands for `∂L/∂q` if forces act (see [`super::forces`]),
//! which is how `p⁻` is computed: no difference of large momenta. `rⱼ` is exactly zero for every space of curves that contains the
//! constants, so that linear momentum is kept to round-off.

use super::{ForceDerivatives, ForcePoint, Mechanics, State};
use crate::array::Array;
use crate::linear::{band_places, constraint_index, largest_magnitude};
use crate::memory::memory;
use crate::scheme::{LobattoNodes, NodalTables};
use crate::system::MechanicalSystem;

/// The action of a step, for one step size.
pub(crate) struct GalerkinAction<S: MechanicalSystem, T, const K: usize> {
    pub(crate) mechanics: Mechanics<S>,
    pub(crate) nodes: LobattoNodes<K>,
    tables: T,
    h: f64,
    /// Where every row of a block stands: all nodes of a coordinate or a constraint together, coordinates and constraints that share an equation
    /// near each other.
    places: S::PerUnknown<usize>,
}

/// The unknowns of a step.
pub(crate) struct Points<S: MechanicalSystem, const K: usize> {
    /// `d_a = q_a − q₀`, from `a = 1` on.
    pub(crate) differences: [S::PerCoordinate<f64>; K],
    /// `Λ_a = h² b_a λ_a`, from `a = 0` on.
    pub(crate) impulses: [S::PerConstraint<f64>; K],
}

// Written out, since a derive would demand the same of `S`.
impl<S: MechanicalSystem, const K: usize> Clone for Points<S, K> {
    fn clone(&self) -> Self {
        Self { differences: self.differences.clone(), impulses: self.impulses.clone() }
    }
}

impl<S: MechanicalSystem, const K: usize> Points<S, K> {
    /// All of them where the step begins.
    pub(crate) fn none() -> Self {
        Self {
            differences: core::array::from_fn(|_| Array::from_fn(|_| 0.0)),
            impulses: core::array::from_fn(|_| Array::from_fn(|_| 0.0)),
        }
    }
}

memory!([S: MechanicalSystem, const K: usize] Points<S, K>, |words| Self { differences, impulses } => {
    words.part(differences);
    words.part(impulses);
});

/// Where entries of the Newton matrix go: block `(a, b)` couples row `a` of the equations with point `b + 1` and impulse `b`.
pub(crate) struct Blocks<'a> {
    entries: &'a mut [f64],
    /// Of the rows of a block: coordinates, then constraints.
    places: &'a [usize],
    intervals: usize,
}

impl Blocks<'_> {
    #[inline]
    fn add(&mut self, (a, row): (usize, usize), (b, col): (usize, usize), value: f64) {
        let dimension = self.places.len() * self.intervals;
        let place = |node: usize, index: usize| Some(self.places.get(index)? * self.intervals + node);
        let place = place(b, col).zip(place(a, row)).map(|(col, row)| col * dimension + row);
        // There is one for every equation and every unknown, which the optimiser need not find out.
        if let Some(entry) = place.and_then(|place| self.entries.get_mut(place)) {
            *entry += value;
        }
    }
}

/// The place of every coordinate and constraint in the matrix.
fn places<S: MechanicalSystem>() -> S::PerUnknown<usize> {
    let (hessian, jacobian, forces) = (S::STRUCTURE.hessian, S::STRUCTURE.jacobian.q, S::STRUCTURE.forces);
    let of_coordinates = [hessian.qq, hessian.vq, hessian.vv, forces.q, forces.v].into_iter().flatten();
    let of_coordinates = of_coordinates.map(|entry| (entry.row, entry.col));
    let of_constraints = jacobian.iter().map(|entry| (constraint_index::<S>(entry.row), entry.col));
    let places = band_places(S::N_COORDINATES + S::N_CONSTRAINTS, of_coordinates.chain(of_constraints));
    Array::from_fn(|row| places[row])
}

impl<S: MechanicalSystem, T: NodalTables<K>, const K: usize> GalerkinAction<S, T, K> {
    /// Whether some constraint has a second derivative.
    const CONSTRAINTS_CURVE: bool = {
        let mut curve = false;
        let mut c = 0;
        while c < S::STRUCTURE.each_constraint.len() {
            curve |= !S::STRUCTURE.each_constraint[c].is_affine();
            c += 1;
        }
        curve
    };

    pub(crate) fn new(mechanics: Mechanics<S>, tables: T, h: f64) -> Self {
        Self { mechanics, nodes: LobattoNodes::new(), tables, h, places: places::<S>() }
    }

    /// The place in the matrix of a row of a node.
    #[inline]
    pub(crate) fn place(&self, node: usize, row: usize) -> usize {
        self.places[row] * K + node
    }

    /// Calls `see` for the numbers that tell this action from another of its type: those of the curves.
    pub(crate) fn for_each_number(&self, mut see: impl FnMut(f64)) {
        for i in 0..S::N_COORDINATES {
            for node in 0..=K {
                let rates = self.tables.table(i).rates(node);
                see(rates.start);
                rates.differences.iter().copied().for_each(&mut see);
            }
        }
    }

    /// Step size.
    #[inline]
    pub(crate) fn h(&self) -> f64 {
        self.h
    }

    /// `t_a`.
    #[inline]
    pub(crate) fn time(&self, t: f64, node: usize) -> f64 {
        t + self.nodes.node(node) * self.h
    }

    /// `q_a`.
    #[inline]
    fn position(
        &self,
        q: &S::PerCoordinate<f64>,
        points: &Points<S, K>,
        node: usize,
    ) -> S::PerCoordinate<f64> {
        match node {
            0 => q.clone(),
            _ => Array::from_fn(|i| q[i] + points.differences[node - 1][i]),
        }
    }

    /// `v_j`.
    #[inline]
    pub(crate) fn velocity(
        &self,
        q: &S::PerCoordinate<f64>,
        points: &Points<S, K>,
        node: usize,
    ) -> S::PerCoordinate<f64> {
        Array::from_fn(|i| {
            let rates = self.tables.table(i).rates(node);
            let mut sum = rates.start * q[i];
            for a in 0..K {
                sum += rates.differences[a] * points.differences[a][i];
            }
            sum / self.h
        })
    }

    /// `h v_j` of coordinate `i` per point `a`.
    #[inline]
    pub(crate) fn rate(&self, node: usize, a: usize, i: usize) -> f64 {
        self.tables.table(i).rates(node).per_point(a)
    }

    /// `h v_j` of coordinate `i` per point `a`, times the weight of the node.
    #[inline]
    fn weighted_rate(&self, node: usize, a: usize, i: usize) -> f64 {
        self.nodes.weight(node) * self.rate(node, a, i)
    }

    /// Overwrites `residual` with the left sides of the equations, node by node, and `entries` (by columns, in the order of
    /// [`place`](Self::place)) with their derivative; returns the largest residual of a constraint.
    pub(crate) fn linearize(
        &self,
        start: &State<S>,
        points: &Points<S, K>,
        residual: &mut [S::PerUnknown<f64>; K],
        entries: &mut [f64],
    ) -> f64 {
        let (n, h) = (S::N_COORDINATES, self.h);
        let constants = &self.mechanics.constants;
        *residual = core::array::from_fn(|_| Array::filled(0.0));
        entries.fill(0.0);
        let mut matrix = Blocks { entries, places: self.places.as_ref(), intervals: K };
        for i in 0..n {
            residual[0][i] -= h * start.p[i];
        }
        for node in 0..=K {
            let (t, q) = (self.time(start.t, node), self.position(&start.q, points, node));
            let v = self.velocity(&start.q, points, node);
            let (mut gradient, hessian) = S::lagrangian_derivatives(constants, t, &q, &v);
            let weight = self.nodes.weight(node);
            if S::STRUCTURE.forces.exist() {
                let at = ForcePoint { t, q: &q, v: &v, inputs: &start.inputs };
                let derivatives = self.mechanics.add_force_with_derivatives(at, &mut gradient.force);
                self.subtract_force_derivatives(node, &derivatives, &mut matrix);
            }
            for i in 0..n {
                for a in 0..K {
                    residual[a][i] -= h * self.weighted_rate(node, a, i) * gradient.momentum[i];
                }
                if node < K {
                    residual[node][i] -= h * h * weight * gradient.force[i];
                }
            }
            self.subtract_second_derivatives(node, hessian.as_ref(), &mut matrix);
            let (constraint, jacobian) = S::constraint_derivatives(constants, t, &q);
            if node < K {
                let impulse = &points.impulses[node];
                S::for_each_slope(constants, &jacobian, |row, col, slope| {
                    residual[node][col] += slope * impulse[row];
                });
            }
            for entry in S::STRUCTURE.jacobian.q {
                let slope = entry.number(constants.as_ref(), jacobian.as_ref());
                let constraint = constraint_index::<S>(entry.row);
                if node < K {
                    matrix.add((node, entry.col), (node, constraint), slope);
                }
                if node > 0 {
                    matrix.add((node - 1, constraint), (node - 1, entry.col), slope);
                }
            }
            if node > 0 {
                for c in 0..S::N_CONSTRAINTS {
                    residual[node - 1][constraint_index::<S>(c)] = constraint[c];
                }
                if Self::CONSTRAINTS_CURVE && node < K {
                    let impulse = &points.impulses[node];
                    self.mechanics.for_each_constraint_curvature(t, &q, impulse, |row, col, value| {
                        matrix.add((node, row), (node - 1, col), value);
                    });
                }
            }
        }
        largest_magnitude(residual.iter().flat_map(|rows| rows.as_ref().iter().skip(n).copied()))
    }

    /// Subtracts this node's part of the derivative of `h ∂L_d/∂q_a` by `q_b`, `a < K`, `b ≥ 1`:
    /// `bⱼ (h² L_qq δ_aj δ_bj + h L_qv δ_aj R_jb + h R_ja L_vq δ_bj + R_ja L_vv R_jb)`.
    fn subtract_second_derivatives(&self, node: usize, hessian: &[f64], matrix: &mut Blocks<'_>) {
        let constants = self.mechanics.constants.as_ref();
        let pattern = S::STRUCTURE.hessian;
        let (h, weight) = (self.h, self.nodes.weight(node));
        let is_inner = 0 < node && node < K;
        for entry in pattern.qq.iter().filter(|_| is_inner) {
            let value = weight * h * h * entry.number(constants, hessian);
            matrix.add((node, entry.row), (node - 1, entry.col), -value);
            if entry.row != entry.col {
                matrix.add((node, entry.col), (node - 1, entry.row), -value);
            }
        }
        for entry in pattern.vq {
            let value = h * entry.number(constants, hessian);
            // Row of the velocity, column of the coordinate.
            for a in (0..K).filter(|_| node > 0) {
                let rate = self.weighted_rate(node, a, entry.row);
                matrix.add((a, entry.row), (node - 1, entry.col), -rate * value);
            }
            // Its transpose.
            for b in (0..K).filter(|_| node < K) {
                let rate = self.weighted_rate(node, b + 1, entry.row);
                matrix.add((node, entry.col), (b, entry.row), -rate * value);
            }
        }
        for entry in pattern.vv {
            let value = entry.number(constants, hessian);
            let mut add = |row: usize, col: usize| {
                for b in 0..K {
                    let end = self.tables.table(col).rates(node).differences[b] * value;
                    for a in 0..K {
                        matrix.add((a, row), (b, col), -self.weighted_rate(node, a, row) * end);
                    }
                }
            };
            add(entry.row, entry.col);
            if entry.row != entry.col {
                add(entry.col, entry.row);
            }
        }
    }

    /// Subtracts this node's part of the derivative of `h² b_a f_a` by `q_b`: `bⱼ δ_aj (h² ∂f/∂q δ_bj + h ∂f/∂v R_jb)`.
    fn subtract_force_derivatives(
        &self,
        node: usize,
        derivatives: &ForceDerivatives<'_, S>,
        matrix: &mut Blocks<'_>,
    ) {
        let (h, weight) = (self.h, self.nodes.weight(node));
        if node == K {
            return;
        }
        if node > 0 {
            derivatives.for_each_by_q(|row, col, value| {
                matrix.add((node, row), (node - 1, col), -(weight * h * h * value));
            });
        }
        derivatives.for_each_by_v(|row, col, value| {
            for b in 0..K {
                let rate = self.weighted_rate(node, b + 1, col);
                matrix.add((node, row), (b, col), -(rate * h * value));
            }
        });
    }

    /// `p⁻ − p₀`, from the balance of momentum.
    pub(crate) fn momentum_gain(&self, start: &State<S>, points: &Points<S, K>) -> S::PerCoordinate<f64> {
        let h = self.h;
        let constants = &self.mechanics.constants;
        let mut gain = S::PerCoordinate::<f64>::from_fn(|_| 0.0);
        for node in 0..=K {
            let (t, q) = (self.time(start.t, node), self.position(&start.q, points, node));
            let v = self.velocity(&start.q, points, node);
            let mut gradient = S::lagrangian_gradient(constants, t, &q, &v);
            self.mechanics
                .add_force(ForcePoint { t, q: &q, v: &v, inputs: &start.inputs }, &mut gradient.force);
            let weight = self.nodes.weight(node);
            let mut pull = S::PerCoordinate::<f64>::from_fn(|_| 0.0);
            if node < K {
                let (_, jacobian) = S::constraint_derivatives(constants, t, &q);
                self.mechanics.add_constraint_force(&jacobian, &points.impulses[node], &mut pull);
            }
            for i in 0..S::N_COORDINATES {
                let constant_rate = self.tables.table(i).rates(node).start;
                gain[i] +=
                    weight * (h * gradient.force[i] + constant_rate * gradient.momentum[i]) - pull[i] / h;
            }
        }
        gain
    }
}
