//! The saddle-point matrix `[A G₀ᵀ; G₁ 0]` of positions and multipliers together: for scenes whose mass or forces vary.

use super::assembly::{Assembly, ConstraintsAt, Point};
use super::elements::{SecondWeights, for_each_second_derivative};
use super::sparse::{Elimination, General, TooMuchFill};
use crate::linear::SingularMatrix;

/// The matrix, and where everything goes that is added to it. Constraints are eliminated after their coordinates: the diagonal of a constraint
/// vanishes until then.
pub(super) struct Saddle {
    elimination: Elimination,
    matrix: General,
    /// For every family, where the second derivatives of its elements go.
    second_derivatives: Vec<Vec<u32>>,
    /// For every slope, its place below, in `G₁`, and above, in `G₀ᵀ`.
    slopes: Vec<[u32; 2]>,
}

impl Saddle {
    /// # Errors
    /// [`TooMuchFill`].
    pub(super) fn new(assembly: &Assembly) -> Result<Self, TooMuchFill> {
        let n = assembly.n_coordinates;
        let mut coupled: Vec<Vec<(usize, usize)>> = Vec::new();
        for family in &assembly.families {
            let elements = &*family.elements;
            let mut pairs = Vec::new();
            for element in 0..elements.count() {
                for_each_second_derivative(elements.structure(), |row, col| {
                    pairs.push((elements.place(element, row), elements.place(element, col)));
                });
            }
            coupled.push(pairs);
        }
        let slots: Vec<(usize, usize)> =
            assembly.slots.iter().map(|slot| (n + slot.row as usize, slot.col as usize)).collect();
        let all = coupled.iter().flatten().chain(&slots).copied();
        let elimination = Elimination::new(n + assembly.n_constraints, all, |unknown| unknown >= n)?;
        let place = |row, col| General::place(&elimination, row, col);
        let second_derivatives =
            coupled.iter().map(|pairs| pairs.iter().map(|&(row, col)| place(row, col)).collect()).collect();
        let slopes = slots.iter().map(|&(row, col)| [place(row, col), place(col, row)]).collect();
        Ok(Self { matrix: General::zero(&elimination), elimination, second_derivatives, slopes })
    }

    /// Overwrites the matrix with zero.
    pub(super) fn clear(&mut self) {
        self.matrix.entries_mut().fill(0.0);
    }

    /// Adds the second derivatives at a point, each times its weight, to `A`.
    pub(super) fn add_second_derivatives(
        &mut self,
        assembly: &Assembly,
        at: Point<'_>,
        weights: &SecondWeights,
    ) {
        let entries = self.matrix.entries_mut();
        for (family, places) in assembly.families.iter().zip(&self.second_derivatives) {
            family.elements.add_second_derivatives(at, weights, places, entries);
        }
    }

    /// Sets `G₀` and `G₁`.
    pub(super) fn set_constraints(&mut self, start: &ConstraintsAt, end: &ConstraintsAt) {
        let entries = self.matrix.entries_mut();
        for ([below, above], (start, end)) in self.slopes.iter().zip(start.slopes.iter().zip(&end.slopes)) {
            entries[*below as usize] = *end;
            entries[*above as usize] = *start;
        }
    }

    /// Factors the matrix in place; returns the smallest pivot as a share of the largest number in its place.
    ///
    /// # Errors
    /// [`SingularMatrix`].
    pub(super) fn factor(&mut self) -> Result<f64, SingularMatrix> {
        self.matrix.factor(&self.elimination)
    }

    /// Overwrites the right-hand side, coordinates first, with the solution.
    pub(super) fn solve(&self, rhs: &mut [f64]) {
        self.matrix.solve(&self.elimination, rhs);
    }
}
