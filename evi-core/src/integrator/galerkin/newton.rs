//! Newton's iteration on all points of a Galerkin step at once, with the exact derivative: for every kind of scene, and the last rescue of the
//! steps that passes do not solve.

use crate::array::Array;
use crate::integrator::{IterationFailure, StepError, Tally};
use crate::linear::{InPlaceLu, SingularMatrix, constraint_index};
use crate::mechanics::{GalerkinAction, Length, Points, State};
use crate::memory::memory;
use crate::newton::{self, Converged};
use crate::scheme::NodalTables;
use crate::system::MechanicalSystem;

/// Newton's iteration with its first guesses.
pub(crate) struct NewtonSolve<S: MechanicalSystem, const K: usize> {
    extrapolation: Extrapolation<K>,
    storage: NewtonStorage<S, K>,
    /// The points of the last step: the first guess of the next. They affect the number of corrections and the last bits of a
    /// state, nothing else.
    past: Option<Points<S, K>>,
}

impl<S: MechanicalSystem, const K: usize> NewtonSolve<S, K> {
    pub(crate) fn new<T: NodalTables<K>>(action: &GalerkinAction<S, T, K>) -> Self {
        Self { extrapolation: Extrapolation::new(action), storage: NewtonStorage::new(action), past: None }
    }

    /// The points of the step that was taken last, if it was by Newton's iteration.
    pub(super) fn found(&self) -> Option<Points<S, K>> {
        self.past.clone()
    }

    /// Keeps the points of a step that was taken, or that the step was taken by other means.
    pub(super) fn remember(&mut self, points: Option<Points<S, K>>) {
        self.past = points;
    }

    /// The points of the step from `state`: by Newton's iteration from the curve of the last step, continued, where that stays near
    /// the parabola with the acceleration of the state; else, or if it does not converge, from the parabola.
    ///
    /// At large steps a continued polynomial ends anywhere, and Newton's iteration from there at another solution of the
    /// equations (double pendulum from the horizontal, h = 0.1: the step equations are lost after 100 to 1,000 steps). Near the parabola
    /// it saves up to one correction in three for large `K`.
    pub(crate) fn solve<T: NodalTables<K>>(
        &mut self,
        action: &GalerkinAction<S, T, K>,
        state: &State<S>,
        tally: &mut impl Tally,
    ) -> Result<Points<S, K>, StepError> {
        let scale = action.mechanics.unit_scale(state.t, &state.q, &state.v);
        let mut points = parabola(action, state)?;
        if let Some(past) = &self.past {
            let mut continued = self.extrapolation.continued(past);
            if continued.is_near(&points, scale.as_ref())
                && self.storage.iterate(action, state, &scale, &mut continued, tally).is_ok()
            {
                return Ok(continued);
            }
        }
        self.storage.iterate(action, state, &scale, &mut points, tally)?;
        Ok(points)
    }

    /// Factors the matrix of the equations at `points` of the step from `state`.
    pub(crate) fn factor<T: NodalTables<K>>(
        &mut self,
        action: &GalerkinAction<S, T, K>,
        state: &State<S>,
        points: &Points<S, K>,
    ) -> Result<FactoredPoints<'_, S, K>, SingularMatrix> {
        let scale = action.mechanics.unit_scale(state.t, &state.q, &state.v);
        self.storage.linearize(action, state, &scale, points);
        self.storage.factors.factor(&mut self.storage.entries)?;
        Ok(FactoredPoints { storage: &mut self.storage, scale })
    }
}

/// The factored matrix of the equations of a step.
pub(crate) struct FactoredPoints<'a, S: MechanicalSystem, const K: usize> {
    storage: &'a mut NewtonStorage<S, K>,
    scale: S::PerUnknown<f64>,
}

impl<S: MechanicalSystem, const K: usize> FactoredPoints<'_, S, K> {
    /// Overwrites right-hand sides, node by node, with the solution.
    pub(crate) fn solve(&mut self, rows: &mut [S::PerUnknown<f64>; K]) {
        self.solve_by(rows, |factors, entries, rhs| factors.solve(entries, rhs));
    }

    /// The same for the transposed matrix.
    pub(crate) fn solve_transposed(&mut self, rows: &mut [S::PerUnknown<f64>; K]) {
        self.solve_by(rows, |factors, entries, rhs| factors.solve_transposed(entries, rhs));
    }

    fn solve_by(
        &mut self,
        rows: &mut [S::PerUnknown<f64>; K],
        solve: impl FnOnce(&InPlaceLu, &[f64], &mut [f64]),
    ) {
        self.storage.residual.clone_from_slice(rows);
        self.storage.solve_by(&self.scale, solve);
        rows.clone_from_slice(&self.storage.residual);
    }
}

// Matrix and factors are written anew in every correction.
memory!([S: MechanicalSystem, const K: usize] NewtonSolve<S, K>, |words|
    Self { extrapolation: _, storage: _, past } => { words.optional(past, Points::none) }
);

/// The parabola with the acceleration and the multipliers of the state.
fn parabola<S: MechanicalSystem, T: NodalTables<K>, const K: usize>(
    action: &GalerkinAction<S, T, K>,
    state: &State<S>,
) -> Result<Points<S, K>, StepError> {
    let (t, h) = (state.t, action.h());
    let start = action
        .mechanics
        .acceleration_with(t, &state.q, &state.v, &state.inputs)
        .map_err(|matrix| StepError::Singular { t, correction: 0, matrix })?;
    let nodes = &action.nodes;
    Ok(Points {
        differences: core::array::from_fn(|a| {
            let time = h * nodes.node(a + 1);
            Array::from_fn(|i| time * (state.v[i] + 0.5 * time * start.acceleration[i]))
        }),
        impulses: core::array::from_fn(|a| {
            Array::from_fn(|c| h * h * nodes.weights[a] * start.multipliers[c])
        }),
    })
}

/// Continues the polynomials through the points of a step over the next.
struct Extrapolation<const K: usize> {
    /// Difference `a` of the next step per difference `b` of the last.
    differences: [[f64; K]; K],
    /// Impulse `a` per impulse `b`.
    impulses: [[f64; K]; K],
}

impl<const K: usize> Extrapolation<K> {
    fn new<S: MechanicalSystem, T: NodalTables<K>>(action: &GalerkinAction<S, T, K>) -> Self {
        let nodes = &action.nodes;
        let table = |entry: &dyn Fn(usize, usize) -> f64| {
            core::array::from_fn(|a| core::array::from_fn(|b| entry(a, b)))
        };
        let is_end = |b: usize| if b + 1 == K { 1.0 } else { 0.0 };
        Self {
            differences: table(&|a, b| nodes.lagrange(K, b + 1, 1.0 + nodes.offsets[a + 1]) - is_end(b)),
            // The multipliers λ of the nodes before the last, weighted again.
            impulses: table(&|a, b| {
                nodes.weights[a] / nodes.weights[b] * nodes.lagrange(K - 1, b, 1.0 + nodes.offsets[a])
            }),
        }
    }

    fn continued<S: MechanicalSystem>(&self, past: &Points<S, K>) -> Points<S, K> {
        Points {
            differences: core::array::from_fn(|a| {
                Array::from_fn(|i| {
                    (0..K).map(|b| self.differences[a][b] * past.differences[b][i]).sum::<f64>()
                })
            }),
            impulses: core::array::from_fn(|a| {
                Array::from_fn(|c| (0..K).map(|b| self.impulses[a][b] * past.impulses[b][c]).sum::<f64>())
            }),
        }
    }
}

impl<S: MechanicalSystem, const K: usize> Points<S, K> {
    /// Whether no point is farther from that of `other` than a tenth of the way that `other` makes.
    fn is_near(&self, other: &Self, scale: &[f64]) -> bool {
        const NEAR: f64 = 0.1;
        let (mut distance, mut way) = (Length::default(), Length::default());
        for (here, there) in self.differences.iter().zip(&other.differences) {
            distance = distance.or(Length::between(here.as_ref(), there.as_ref(), scale));
            way = way.or(Length::in_units(there.as_ref(), scale));
        }
        distance.relative_to(way) <= NEAR
    }
}

/// Newton's iteration on all points at once.
struct NewtonStorage<S: MechanicalSystem, const K: usize> {
    /// The matrix by columns; its factors while a correction is computed.
    entries: Vec<f64>,
    /// Node by node.
    residual: [S::PerUnknown<f64>; K],
    /// In the order of the matrix.
    ordered: Vec<f64>,
    /// Where a row of the first node stands in the matrix, those of the others behind it.
    places: S::PerUnknown<usize>,
    /// For every place in the matrix its row.
    rows: Vec<usize>,
    factors: InPlaceLu,
}

impl<S: MechanicalSystem, const K: usize> NewtonStorage<S, K> {
    /// Unknowns of a node.
    const BLOCK: usize = S::N_COORDINATES + S::N_CONSTRAINTS;

    fn new<T: NodalTables<K>>(action: &GalerkinAction<S, T, K>) -> Self {
        let dimension = K * Self::BLOCK;
        let mut rows = vec![0; dimension];
        for index in 0..dimension {
            rows[action.place(index / Self::BLOCK, index % Self::BLOCK)] = index % Self::BLOCK;
        }
        let places = Array::from_fn(|row| action.place(0, row));
        Self {
            entries: vec![0.0; dimension * dimension],
            residual: core::array::from_fn(|_| Array::filled(0.0)),
            ordered: vec![0.0; dimension],
            places,
            rows,
            factors: InPlaceLu::new(dimension),
        }
    }

    /// Overwrites the residual, and the matrix in units in which its unknowns are comparable; returns the largest residual of a constraint.
    fn linearize<T: NodalTables<K>>(
        &mut self,
        action: &GalerkinAction<S, T, K>,
        state: &State<S>,
        scale: &S::PerUnknown<f64>,
        points: &Points<S, K>,
    ) -> f64 {
        let constraint_residual = action.linearize(state, points, &mut self.residual, &mut self.entries);
        let in_order = self.rows.iter().map(|row| scale.as_ref().get(*row).copied().unwrap_or(f64::NAN));
        for (column, col_scale) in self.entries.chunks_exact_mut(K * Self::BLOCK).zip(in_order.clone()) {
            for (entry, row_scale) in column.iter_mut().zip(in_order.clone()) {
                *entry *= row_scale * col_scale;
            }
        }
        constraint_residual
    }

    /// Overwrites the residual with what `solve` makes of it by the factors, in their order and units.
    fn solve_by(&mut self, scale: &S::PerUnknown<f64>, solve: impl FnOnce(&InPlaceLu, &[f64], &mut [f64])) {
        for (node, residual) in self.residual.iter().enumerate() {
            for row in 0..Self::BLOCK {
                if let Some(value) = self.ordered.get_mut(self.places[row] + node) {
                    *value = residual[row] * scale[row];
                }
            }
        }
        solve(&self.factors, &self.entries, &mut self.ordered);
        for (node, residual) in self.residual.iter_mut().enumerate() {
            for row in 0..Self::BLOCK {
                let value = self.ordered.get(self.places[row] + node).copied();
                residual[row] = value.unwrap_or(f64::NAN) * scale[row];
            }
        }
    }

    /// Corrects `points` until they solve the equations of the step from `state`.
    fn iterate<T: NodalTables<K>>(
        &mut self,
        action: &GalerkinAction<S, T, K>,
        state: &State<S>,
        scale: &S::PerUnknown<f64>,
        points: &mut Points<S, K>,
        tally: &mut impl Tally,
    ) -> Result<(), StepError> {
        let n = S::N_COORDINATES;
        let in_units = |x: &[f64]| Length::in_units(x, scale.as_ref());
        let mut constraint_residual = 0.0;
        let mut smallest_pivot_ratio = 1.0_f64;
        tally.begin_iteration();
        let iteration = newton::iterate(|correction| {
            constraint_residual = self.linearize(action, state, scale, points);
            self.factors
                .factor(&mut self.entries)
                .map_err(|matrix| IterationFailure::Singular { correction, matrix })?;
            smallest_pivot_ratio = smallest_pivot_ratio.min(self.factors.pivot_ratio());
            tally.see_pivot_ratio(self.factors.pivot_ratio());
            self.solve_by(scale, |factors, entries, rhs| factors.solve(entries, rhs));
            let (mut length, mut reach) = (Length::default(), in_units(state.q.as_ref()));
            for (a, update) in self.residual.iter().enumerate() {
                for i in 0..n {
                    points.differences[a][i] -= update[i];
                }
                for c in 0..S::N_CONSTRAINTS {
                    points.impulses[a][c] -= update[constraint_index::<S>(c)];
                }
                length = length.or(in_units(&update.as_ref()[..n]));
                reach = reach.or(in_units(points.differences[a].as_ref()));
            }
            let length = length.relative_to(reach);
            tally.see_correction(|| length);
            Ok(length)
        });
        match iteration {
            Ok(Converged { corrections }) => {
                tally.count_corrections(corrections);
                Ok(())
            }
            Err(failure) => {
                Err(IterationFailure::at(failure, state.t, constraint_residual, smallest_pivot_ratio))
            }
        }
    }
}
