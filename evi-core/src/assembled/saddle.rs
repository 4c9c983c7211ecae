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
        Self::by(assembly, |sizes, coupled| SaddleMatrix::new(sizes, coupled.iter().copied()))
    }

    /// With the matrix that `matrix` makes for numbers of coordinates and unknowns, and what is coupled.
    fn by(
        assembly: &Assembly,
        matrix: impl FnOnce((usize, usize), &[(usize, usize)]) -> Result<SaddleMatrix, TooMuchFill>,
    ) -> Result<Self, TooMuchFill> {
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
        let all: Vec<(usize, usize)> = coupled.iter().flatten().chain(&slots).copied().collect();
        let matrix = matrix((n, n + assembly.n_constraints), &all)?;
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
        weights: &SecondWeights<'_>,
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

#[cfg(all(test, feature = "sparse"))]
mod tests {
    use super::super::AssembledSimulation;
    use super::super::sparse::{Pivoted, TooMuchFill};
    use super::{Saddle, SaddleMatrix};
    use crate::prelude::*;

    const N: usize = 20;

    /// A net of rods along its rows and springs along its columns, hung up along its first column.
    #[derive(MechanicalSystem, Clone)]
    #[evi(
        coordinates(p: [N, N, 3]),
        kinetic = sum(0..N, |i| sum(0..N, |j| 0.5 * m * (1 + 0.02 * j) * der(p[i][j]).norm_squared())),
        potential = sum(0..N, |i| sum(0..N, |j| m * g * p[i][j][2]))
            + sum(1..N, |i| sum(0..N, |j| 0.25 * k * ((p[i][j] - p[i - 1][j]).norm_squared() - l.powi(2)).powi(2))),
        constraint(hung[i in 0..N]: p[i][0] == [0.0, l * i, 0.0]),
        constraint(rod[i in 0..N, j in 1..N]: (p[i][j] - p[i][j - 1]).norm_squared() == l.powi(2)),
    )]
    struct Net {
        m: f64,
        g: f64,
        k: f64,
        l: f64,
    }

    #[test]
    fn a_run_by_faer_is_the_run_by_the_elimination_in_a_fixed_order() {
        let (net, l) = (Net { m: 0.01, g: 9.81, k: 400.0, l: 0.05 }, 0.05);
        let q: Vec<f64> = (0..N * N).flat_map(|k| [l * (k % N) as f64, l * (k / N) as f64, 0.0]).collect();
        let simulation = AssembledSimulation::new(net, Evi::midpoint(1e-3));
        let start = || simulation.start(q.clone(), vec![0.0; 3 * N * N]).expect("a start");
        let (mut ordered, mut pivoted) = (start(), start());
        let by_faer = |(_, n_unknowns): (usize, usize), coupled: &[(usize, usize)]| {
            let matrix = Pivoted::new(n_unknowns, coupled.iter().copied());
            matrix.map(Box::new).map(SaddleMatrix::Pivoted).ok_or(TooMuchFill { products: 0, most: 0 })
        };
        pivoted.scene.saddle = Some(Saddle::by(&pivoted.scene.assembly, by_faer).expect("memory"));
        assert!(pivoted.report().systems.iter().any(|(_, effort)| effort.is_pivoted));
        for _ in 0..20 {
            ordered.advance().expect("a step");
            pivoted.advance().expect("a step");
        }
        let apart = |x: &[f64], y: &[f64]| x.iter().zip(y).map(|(x, y)| (x - y).abs()).fold(0.0, f64::max);
        let difference = apart(ordered.state().q(), pivoted.state().q());
        println!("{difference:e}, moved {}", apart(ordered.state().q(), &q));
        assert!(apart(ordered.state().q(), &q) > 1e-3, "it moves");
        assert!(difference < 1e-14 && pivoted.constraint_error() < 1e-15, "{difference:e}");
    }
}
