//! The saddle-point matrix `[A G₀ᵀ; G₁ 0]` of positions and multipliers together: for scenes whose mass or forces vary.

use super::assembly::{Assembly, ConstraintsAt, Point};
use super::elements::{SecondWeights, for_each_second_derivative};
#[cfg(feature = "sparse")]
use super::sparse::Pivoted;
use super::sparse::{Effort, Elimination, General, TooMuchFill};
use crate::linear::SingularMatrix;

/// The matrix, and where everything goes that is added to it.
pub(super) struct Saddle {
    matrix: SaddleMatrix,
    /// For every family, where the second derivatives of its elements go.
    second_derivatives: Vec<Vec<u32>>,
    /// For every slope, its place below, in `G₁`, and above, in `G₀ᵀ`.
    slopes: Vec<[u32; 2]>,
}

/// A matrix with its way of elimination.
enum SaddleMatrix {
    /// In an order that is found once. Constraints are eliminated after their coordinates: the diagonal of a constraint vanishes until then.
    Ordered(Elimination, General),
    /// With pivoting, for nets.
    #[cfg(feature = "sparse")]
    Pivoted(Box<Pivoted>),
}

impl SaddleMatrix {
    /// For matrices of `n` coordinates and the rest of the unknowns constraints.
    fn new(
        (n, n_unknowns): (usize, usize),
        coupled: impl IntoIterator<Item = (usize, usize)> + Clone,
    ) -> Result<Self, TooMuchFill> {
        let ordered = Elimination::new(n_unknowns, coupled.clone(), |unknown| unknown >= n);
        match ordered {
            Ok(elimination) => {
                let matrix = General::zero(&elimination);
                Ok(Self::Ordered(elimination, matrix))
            }
            #[cfg(feature = "sparse")]
            Err(fill) => Pivoted::new(n_unknowns, coupled).map(Box::new).map(Self::Pivoted).ok_or(fill),
            #[cfg(not(feature = "sparse"))]
            Err(fill) => Err(fill),
        }
    }

    fn place(&self, row: usize, col: usize) -> u32 {
        match self {
            Self::Ordered(elimination, _) => General::place(elimination, row, col),
            #[cfg(feature = "sparse")]
            Self::Pivoted(matrix) => matrix.place(row, col),
        }
    }

    fn entries_mut(&mut self) -> &mut [f64] {
        match self {
            Self::Ordered(_, matrix) => matrix.entries_mut(),
            #[cfg(feature = "sparse")]
            Self::Pivoted(matrix) => matrix.entries_mut(),
        }
    }
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
        let matrix = SaddleMatrix::new((n, n + assembly.n_constraints), all)?;
        let place = |&(row, col): &(usize, usize)| matrix.place(row, col);
        let second_derivatives = coupled.iter().map(|pairs| pairs.iter().map(place).collect()).collect();
        let slopes = slots.iter().map(|&(row, col)| [place(&(row, col)), place(&(col, row))]).collect();
        Ok(Self { matrix, second_derivatives, slopes })
    }

    /// What a factorisation takes.
    pub(super) fn effort(&self) -> Effort {
        match &self.matrix {
            SaddleMatrix::Ordered(elimination, _) => elimination.effort(),
            #[cfg(feature = "sparse")]
            SaddleMatrix::Pivoted(matrix) => {
                Effort { unknowns: matrix.n_unknowns(), below: 0, products: 0, is_pivoted: true }
            }
        }
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
        match &mut self.matrix {
            SaddleMatrix::Ordered(elimination, matrix) => matrix.factor(elimination),
            #[cfg(feature = "sparse")]
            SaddleMatrix::Pivoted(matrix) => matrix.factor(),
        }
    }

    /// Overwrites the right-hand side, coordinates first, with the solution.
    pub(super) fn solve(&mut self, rhs: &mut [f64]) {
        match &mut self.matrix {
            SaddleMatrix::Ordered(elimination, matrix) => matrix.solve(elimination, rhs),
            #[cfg(feature = "sparse")]
            SaddleMatrix::Pivoted(matrix) => matrix.solve(rhs),
        }
    }
}
