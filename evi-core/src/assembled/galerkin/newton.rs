//! Newton's iteration on all points of a step at once, with the exact derivative: for the steps that passes do not solve.
//!
//! The equations are those of `mechanics/galerkin_equations.rs`. An unknown of the scene stands for its values at all nodes: a coordinate for its
//! differences at the nodes `1 .. K`, a constraint for its impulses `Λₐ = h² bₐ λₐ` at the nodes before the last. The matrix has the pattern of the
//! scene and is eliminated in an order of the scene's unknowns, which is found once; its entries are blocks of `K × K` numbers.

use super::super::assembly::{Assembly, Point, subtract_pull};
use super::super::elements::{SecondWeights, for_each_second_derivative};
use super::super::scene::{PreparedScene, Space};
use super::super::sparse::{Blocked, Effort, Elimination, General};
use super::super::{AssembledState, failure};
use crate::integrator::{IterationFailure, StepError, Tally};
use crate::linear::{SingularMatrix, largest_magnitude};
use crate::mechanics::relative;
use crate::newton::Progress;
use crate::scheme::{LobattoNodes, NodalTable};

/// The matrix is made anew for a correction that is not below this share of the one before.
const STALE: f64 = 1e-3;

/// The matrix over all points of a scene, for steps of any size, and the storage of its iteration. Stages of a composition share it.
pub(in super::super) struct PointMatrix {
    intervals: usize,
    elimination: Elimination,
    matrix: Blocked,
    /// For every family, where second derivatives of its elements go, and those of their constraints.
    second_derivatives: Vec<Vec<u32>>,
    bends: Vec<Vec<u32>>,
    /// For every slope, its place below and above.
    slopes: Vec<[u32; 2]>,
    /// Second derivatives at one node.
    entries: Vec<f64>,
    /// Differences and impulses, unknown by unknown.
    points: Vec<f64>,
    residual: Vec<f64>,
}

impl PointMatrix {
    /// `None` if there are more numbers in it than is sensible.
    pub(in super::super) fn new(assembly: &Assembly, intervals: usize) -> Option<Self> {
        let n = assembly.n_coordinates;
        let n_unknowns = n + assembly.n_constraints;
        let (mut second_derivatives, mut bends) = (Vec::new(), Vec::new());
        for family in &assembly.families {
            let elements = &*family.elements;
            let (mut of_action, mut of_constraints) = (Vec::new(), Vec::new());
            for element in 0..elements.count() {
                let place = |row, col| (elements.place(element, row), elements.place(element, col));
                for_each_second_derivative(elements.structure(), |row, col| of_action.push(place(row, col)));
                elements.for_each_curved_pair(&mut |row, col| of_constraints.push(place(row, col)));
            }
            second_derivatives.push(of_action);
            bends.push(of_constraints);
        }
        let slots: Vec<(usize, usize)> =
            assembly.slots.iter().map(|slot| (n + slot.row as usize, slot.col as usize)).collect();
        let coupled =
            second_derivatives.iter().flatten().chain(bends.iter().flatten()).chain(&slots).copied();
        let elimination = Elimination::new(n_unknowns, coupled, |unknown| unknown >= n).ok()?;
        let matrix = Blocked::zero(&elimination, intervals)?;
        let place = |&(row, col): &(usize, usize)| General::place(&elimination, row, col);
        let places = |families: &[Vec<(usize, usize)>]| -> Vec<Vec<u32>> {
            families.iter().map(|pairs| pairs.iter().map(place).collect()).collect()
        };
        Some(Self {
            intervals,
            matrix,
            second_derivatives: places(&second_derivatives),
            bends: places(&bends),
            slopes: slots.iter().map(|&(row, col)| [place(&(row, col)), place(&(col, row))]).collect(),
            entries: vec![0.0; n_unknowns + 2 * elimination.n_below()],
            points: vec![0.0; n_unknowns * intervals],
            residual: vec![0.0; n_unknowns * intervals],
            elimination,
        })
    }

    /// What a factorisation takes, in blocks.
    pub(in super::super) fn effort(&self) -> Effort {
        self.elimination.effort()
    }

    /// Whether it is that of steps with so many intervals between nodes.
    pub(in super::super) const fn is_for(&self, intervals: usize) -> bool {
        self.intervals == intervals
    }
}

/// Nodes, weights and rates of the curves, for one step size.
pub(super) struct NewtonTables {
    h: f64,
    /// `c` and `b` of every node.
    nodes: Vec<[f64; 2]>,
    /// `h vⱼ` per point, node by node.
    rates: Vec<Vec<f64>>,
}

impl NewtonTables {
    pub(super) fn new<const K: usize>(h: f64) -> Self {
        let (lobatto, table) = (LobattoNodes::<K>::new(), NodalTable::<K>::polynomial());
        Self {
            h,
            nodes: (0..=K).map(|node| [lobatto.node(node), lobatto.weights[node]]).collect(),
            rates: (0..=K).map(|node| (0..=K).map(|a| table.rates(node).per_point(a)).collect()).collect(),
        }
    }

    /// `K`.
    fn intervals(&self) -> usize {
        self.nodes.len() - 1
    }

    /// The step from `start` by Newton's iteration from the parabola with the acceleration in `space.moved` and the multipliers in `space.rates`; its end
    /// is left as passes leave theirs.
    ///
    /// # Errors
    /// [`StepError`] when it does not converge.
    pub(super) fn solve(
        &self,
        scene: &mut PreparedScene,
        start: &AssembledState,
        tally: &mut impl Tally,
    ) -> Result<(), StepError> {
        let PreparedScene { assembly, space, points, .. } = scene;
        let Some(matrix) = points else {
            return Err(failure::singular(start.t, SingularMatrix { pivot_ratio: f64::NAN }));
        };
        self.guess(assembly, matrix, space, start);
        let mut constraint_residual = 0.0;
        self.iterate(assembly, matrix, space, start, &mut constraint_residual, tally)
            .map_err(|failure| failure.at(start.t, constraint_residual, 1.0))?;
        self.arrive(assembly, matrix, space, start);
        Ok(())
    }

    fn guess(&self, assembly: &Assembly, matrix: &mut PointMatrix, space: &Space, start: &AssembledState) {
        let (k, n, h) = (self.intervals(), assembly.n_coordinates, self.h);
        for (i, points) in matrix.points[..n * k].chunks_exact_mut(k).enumerate() {
            for (point, [time, _]) in points.iter_mut().zip(&self.nodes[1..]) {
                let time = h * time;
                *point = time * (start.v[i] + 0.5 * time * space.moved[i]);
            }
        }
        for (impulses, multiplier) in matrix.points[n * k..].chunks_exact_mut(k).zip(&space.rates) {
            for (impulse, [_, weight]) in impulses.iter_mut().zip(&self.nodes) {
                *impulse = h * h * weight * multiplier;
            }
        }
    }

    fn iterate(
        &self,
        assembly: &Assembly,
        matrix: &mut PointMatrix,
        space: &mut Space,
        start: &AssembledState,
        constraint_residual: &mut f64,
        tally: &mut impl Tally,
    ) -> Result<(), IterationFailure> {
        let (k, n) = (self.intervals(), assembly.n_coordinates);
        let here = largest_magnitude(start.q.iter().copied());
        let mut progress = Progress::default();
        let (mut last, mut before) = (0.0, 0.0);
        tally.begin_iteration();
        loop {
            // Written so that a NaN asks for a matrix, which refuses it.
            let is_fresh = last <= STALE * before && before > 0.0;
            self.linearize(assembly, matrix, space, start, !is_fresh);
            *constraint_residual = largest_magnitude(matrix.residual[n * k..].iter().copied());
            let PointMatrix { elimination, matrix: factors, residual, points, .. } = &mut *matrix;
            if !is_fresh {
                let correction = progress.corrections() + 1;
                let pivot_ratio = factors
                    .factor(elimination)
                    .map_err(|matrix| IterationFailure::Singular { correction, matrix })?;
                tally.see_pivot_ratio(pivot_ratio);
            }
            factors.solve(elimination, residual);
            points.iter_mut().zip(residual.iter()).for_each(|(point, correction)| *point -= correction);
            let way = largest_magnitude(points[..n * k].iter().copied());
            let length = largest_magnitude(residual[..n * k].iter().copied());
            (before, last) = (last, relative(length, here + way));
            tally.see_correction(|| last);
            if progress.has_converged(last)? {
                tally.count_corrections(progress.corrections());
                return Ok(());
            }
        }
    }

    /// Overwrites the residual, and the matrix with its derivative where that is asked for.
    fn linearize(
        &self,
        assembly: &Assembly,
        matrix: &mut PointMatrix,
        space: &mut Space,
        start: &AssembledState,
        with_matrix: bool,
    ) {
        let (k, n, h) = (self.intervals(), assembly.n_coordinates, self.h);
        matrix.residual.fill(0.0);
        if with_matrix {
            matrix.matrix.clear();
        }
        for (i, p) in start.p.iter().enumerate() {
            matrix.residual[i * k] = -h * p;
        }
        for node in 0..=k {
            let [_, weight] = self.nodes[node];
            self.visit(assembly, matrix, space, start, node);
            for i in 0..n {
                let rows = &mut matrix.residual[i * k..(i + 1) * k];
                for (row, rate) in rows.iter_mut().zip(&self.rates[node]) {
                    *row -= h * weight * rate * space.momentum[i];
                }
                if node < k {
                    rows[node] -= h * h * weight * space.force[i] - space.pull[i];
                }
            }
            if node > 0 {
                for (rows, value) in matrix.residual[n * k..].chunks_exact_mut(k).zip(&space.at_end.values) {
                    rows[node - 1] = *value;
                }
            }
            if with_matrix {
                self.add_to_matrix(assembly, matrix, space, start, node);
            }
        }
    }

    /// Overwrites `space.q` and `space.v` with those of a node, `space.force` and `space.momentum` with the gradient there, `space.at_end` with the
    /// constraints, and before the last node `space.impulse` with the impulses there and `space.pull` with `Gᵀ Λ`.
    fn visit(
        &self,
        assembly: &Assembly,
        matrix: &PointMatrix,
        space: &mut Space,
        start: &AssembledState,
        node: usize,
    ) {
        let (k, n) = (self.intervals(), assembly.n_coordinates);
        let t = start.t + self.nodes[node][0] * self.h;
        for (i, points) in matrix.points[..n * k].chunks_exact(k).enumerate() {
            space.q[i] = if node == 0 { start.q[i] } else { start.q[i] + points[node - 1] };
            let rate: f64 = points.iter().zip(&self.rates[node][1..]).map(|(point, rate)| point * rate).sum();
            space.v[i] = rate / self.h;
        }
        let Space { q, v, force, momentum, at_end, impulse, pull, .. } = space;
        assembly.gradient(Point { t, q, v }, force, momentum);
        assembly.constraint_derivatives(t, q, at_end);
        pull.fill(0.0);
        if node < k {
            for (impulse, impulses) in impulse.iter_mut().zip(matrix.points[n * k..].chunks_exact(k)) {
                *impulse = -impulses[node];
            }
            subtract_pull::<f64, false>(&assembly.slots, &at_end.slopes, impulse, pull);
            impulse.iter_mut().for_each(|impulse| *impulse = -*impulse);
        }
    }

    /// Adds a node's part of the derivative, where [`visit`](Self::visit) has been.
    fn add_to_matrix(
        &self,
        assembly: &Assembly,
        matrix: &mut PointMatrix,
        space: &Space,
        start: &AssembledState,
        node: usize,
    ) {
        const NONE: SecondWeights<'static> =
            SecondWeights { vv: 0.0, vq: 0.0, qv: 0.0, qq: 0.0, fq: 0.0, fv: 0.0, curves: None };
        let (k, h, rates) = (self.intervals(), self.h, &self.rates[node]);
        let [time, weight] = self.nodes[node];
        let at = Point { t: start.t + time * h, q: &space.q, v: &space.v };
        matrix.add(assembly, at, SecondWeights { vv: -weight, ..NONE }, |block, value| {
            for (row, &rate) in block.chunks_exact_mut(k).zip(rates) {
                row.iter_mut().zip(&rates[1..]).for_each(|(entry, end)| *entry += rate * end * value);
            }
        });
        let varies = assembly.traits.force_varies() || !assembly.traits.is_separable;
        if varies && node > 0 {
            matrix.add(assembly, at, SecondWeights { vq: -weight * h, ..NONE }, |block, value| {
                for (row, &rate) in block.chunks_exact_mut(k).zip(rates) {
                    row[node - 1] += rate * value;
                }
            });
        }
        if varies && node < k {
            let weights = SecondWeights { qv: -weight * h, fv: -weight * h, ..NONE };
            matrix.add(assembly, at, weights, |block, value| {
                let row = &mut block[node * k..(node + 1) * k];
                row.iter_mut().zip(&rates[1..]).for_each(|(entry, rate)| *entry += rate * value);
            });
        }
        if 0 < node && node < k {
            let corner = node * k + node - 1;
            if varies {
                let weights = SecondWeights { qq: -weight * h * h, fq: -weight * h * h, ..NONE };
                matrix.add(assembly, at, weights, |block, value| block[corner] += value);
            }
            matrix.add_bends(assembly, at, &space.impulse, corner);
        }
        for ([below, above], slope) in matrix.slopes.iter().zip(&space.at_end.slopes) {
            if node > 0 {
                matrix.matrix.block_mut(*below as usize)[(node - 1) * k + node - 1] += slope;
            }
            if node < k {
                matrix.matrix.block_mut(*above as usize)[node * k + node] += slope;
            }
        }
    }

    /// Overwrites `space.moved`, `space.p` and `space.v` with the difference, the momentum that arrives at the end and the velocity there.
    fn arrive(&self, assembly: &Assembly, matrix: &PointMatrix, space: &mut Space, start: &AssembledState) {
        let (k, h) = (self.intervals(), self.h);
        space.p.copy_from_slice(&start.p);
        for node in 0..=k {
            self.visit(assembly, matrix, space, start, node);
            let weight = h * self.nodes[node][1];
            for (i, p) in space.p.iter_mut().enumerate() {
                *p += weight * space.force[i] - space.pull[i] / h;
            }
        }
        for (i, points) in matrix.points[..assembly.n_coordinates * k].chunks_exact(k).enumerate() {
            space.moved[i] = points[k - 1];
        }
    }
}

impl PointMatrix {
    /// Adds the weighted second derivatives at a node, each by `add(block, value)`.
    fn add(
        &mut self,
        assembly: &Assembly,
        at: Point<'_>,
        weights: SecondWeights<'_>,
        add: impl FnMut(&mut [f64], f64),
    ) {
        self.entries.fill(0.0);
        for (family, places) in assembly.families.iter().zip(&self.second_derivatives) {
            family.elements.add_second_derivatives(at, &weights, places, &mut self.entries);
        }
        self.spread(add);
    }

    /// Adds the second derivatives of the constraints times `impulse` to one number of every block.
    fn add_bends(&mut self, assembly: &Assembly, at: Point<'_>, impulse: &[f64], corner: usize) {
        self.entries.fill(0.0);
        for (family, places) in assembly.families.iter().zip(&self.bends) {
            family.elements.add_bends(at.t, at.q, &impulse[family.rows.clone()], places, &mut self.entries);
        }
        self.spread(|block, value| block[corner] += value);
    }

    fn spread(&mut self, mut add: impl FnMut(&mut [f64], f64)) {
        let Self { entries, matrix, .. } = self;
        for (place, &value) in entries.iter().enumerate() {
            // Exactly: of most kinds most entries are none.
            if value != 0.0 {
                add(matrix.block_mut(place), value);
            }
        }
    }
}
