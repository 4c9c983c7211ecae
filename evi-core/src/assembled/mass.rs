//! A constant mass matrix of small blocks, inverted once.

use std::collections::BTreeMap;

use super::assembly::{Assembly, Point};
use super::elements::{for_each_second_derivative, n_second_derivatives};
use super::number::Number;
use super::projection::MASS;
use super::{AssembledSystem, AssemblyError};

/// Coordinates of one body that its mass couples: twelve in directors.
const LARGEST_BLOCK: usize = 12;

/// `M⁻¹` by rows, and what belongs to it.
pub(super) struct ConstantMass {
    /// Where the entries of a row begin, and where the last ones end.
    pub(super) starts: Vec<u32>,
    pub(super) cols: Vec<u32>,
    pub(super) values: Vec<f64>,
    /// Whether every row has its diagonal entry alone.
    is_diagonal: bool,
    /// `√Mᵢᵢ`.
    pub(super) units: Vec<f64>,
    /// `a = ∂L/∂v` at rest, where it does not vanish.
    momentum_at_rest: Option<Vec<f64>>,
}

/// The places of the mass matrix of a scene, with its values at one point.
pub(super) fn mass_matrix(assembly: &Assembly, at: Point<'_>) -> BTreeMap<(usize, usize), f64> {
    let mut matrix = BTreeMap::new();
    for family in &assembly.families {
        let elements = &*family.elements;
        let per_element = n_second_derivatives(elements.structure());
        let count = per_element * elements.count();
        let (places, mut entries) = ((0..count as u32).collect::<Vec<_>>(), vec![0.0; count]);
        elements.add_second_derivatives(at, &MASS, &places, &mut entries);
        let vv = elements.structure().hessian.vv;
        let n_mass = vv.iter().map(|entry| if entry.row == entry.col { 1 } else { 2 }).sum();
        for (element, entries) in entries.chunks_exact(per_element.max(1)).enumerate() {
            let mut entries = entries.iter().take(n_mass);
            for_each_second_derivative(elements.structure(), |row, col| {
                if let Some(entry) = entries.next() {
                    let place = (elements.place(element, row), elements.place(element, col));
                    *matrix.entry(place).or_insert(0.0) += entry;
                }
            });
        }
    }
    matrix
}

/// Refuses a scene with a coordinate that has no inertia.
pub(super) fn check_inertia<S: AssembledSystem>(
    system: &S,
    matrix: &BTreeMap<(usize, usize), f64>,
) -> Result<(), AssemblyError> {
    match (0..system.n_coordinates()).find(|&i| !matrix.contains_key(&(i, i))) {
        Some(i) => Err(AssemblyError::NoInertia { name: system.coordinate_name(i) }),
        None => Ok(()),
    }
}

impl ConstantMass {
    /// Inverts `matrix`; `None` if it is not constant, has larger blocks, or is not positive definite: then masses and constraints are
    /// eliminated together.
    pub(super) fn new(assembly: &Assembly, matrix: &BTreeMap<(usize, usize), f64>) -> Option<Self> {
        let n = assembly.n_coordinates;
        if !assembly.traits.is_separable {
            return None;
        }
        let blocks = blocks(n, matrix);
        let mut rows: Vec<Vec<(u32, f64)>> = vec![Vec::new(); n];
        for block in &blocks {
            if block.len() > LARGEST_BLOCK {
                return None;
            }
            let value = |i: usize, j: usize| matrix.get(&(block[i], block[j])).copied().unwrap_or(0.0);
            let dense = (0..block.len()).map(|i| (0..block.len()).map(|j| value(i, j)).collect()).collect();
            let inverse = inverse(dense)?;
            for (i, row) in inverse.into_iter().enumerate() {
                rows[block[i]] = block.iter().map(|&col| col as u32).zip(row).collect();
            }
        }
        let mut starts = vec![0];
        for row in &rows {
            starts.push(starts[starts.len() - 1] + row.len() as u32);
        }
        let (cols, values): (Vec<_>, Vec<_>) = rows.into_iter().flatten().unzip();
        let momentum_at_rest = (!assembly.traits.momentum_vanishes_at_rest).then(|| {
            let (zero, mut force, mut momentum) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
            assembly.gradient(Point { t: 0.0, q: &zero, v: &zero }, &mut force, &mut momentum);
            momentum
        });
        let units = (0..n).map(|i| matrix.get(&(i, i)).copied().unwrap_or(0.0).sqrt()).collect();
        Some(Self { is_diagonal: values.len() == n, starts, cols, values, units, momentum_at_rest })
    }

    /// Calls `visit(row, col, index)` for every entry of `M⁻¹`.
    pub(super) fn for_each_entry(&self, mut visit: impl FnMut(usize, usize, usize)) {
        for row in 0..self.units.len() {
            for index in self.starts[row] as usize..self.starts[row + 1] as usize {
                visit(row, self.cols[index] as usize, index);
            }
        }
    }

    /// Coordinate `i` of `M⁻¹ x`.
    #[inline(always)]
    pub(super) fn inverse_times_at<T: Number, const FUSED: bool>(&self, x: &[T], i: usize) -> T {
        if self.is_diagonal {
            return T::from_f64(self.values[i]) * x[i];
        }
        let mut sum = T::ZERO;
        for index in self.starts[i] as usize..self.starts[i + 1] as usize {
            sum = sum.plus_product::<FUSED>(T::from_f64(self.values[index]), x[self.cols[index] as usize]);
        }
        sum
    }

    /// Overwrites `product` with `M⁻¹ x`.
    pub(super) fn inverse_times(&self, x: &[f64], product: &mut [f64]) {
        for (i, product) in product.iter_mut().enumerate() {
            *product = self.inverse_times_at::<f64, false>(x, i);
        }
    }

    /// Subtracts the momentum at rest: of `p` the part that moves is left.
    pub(super) fn subtract_rest(&self, p: &mut [f64]) {
        if let Some(rest) = &self.momentum_at_rest {
            p.iter_mut().zip(rest).for_each(|(p, rest)| *p -= rest);
        }
    }

    /// Adds the momentum at rest.
    pub(super) fn add_rest(&self, p: &mut [f64]) {
        if let Some(rest) = &self.momentum_at_rest {
            p.iter_mut().zip(rest).for_each(|(p, rest)| *p += rest);
        }
    }
}

/// The coordinates that the matrix couples, group by group, each ascending.
fn blocks(n: usize, matrix: &BTreeMap<(usize, usize), f64>) -> Vec<Vec<usize>> {
    let mut leaders: Vec<usize> = (0..n).collect();
    fn leader(leaders: &mut [usize], mut i: usize) -> usize {
        while leaders[i] != i {
            leaders[i] = leaders[leaders[i]];
            i = leaders[i];
        }
        i
    }
    for &(row, col) in matrix.keys() {
        let (a, b) = (leader(&mut leaders, row), leader(&mut leaders, col));
        leaders[a.max(b)] = a.min(b);
    }
    let mut groups = BTreeMap::<usize, Vec<usize>>::new();
    for i in 0..n {
        groups.entry(leader(&mut leaders, i)).or_default().push(i);
    }
    groups.into_values().collect()
}

/// The inverse of a symmetric positive definite matrix, by Gauss and Jordan in place; `None` if it is none.
fn inverse(mut matrix: Vec<Vec<f64>>) -> Option<Vec<Vec<f64>>> {
    let n = matrix.len();
    for k in 0..n {
        let (pivot, whole) = (matrix[k][k], matrix[k][k].abs());
        let is_positive = pivot > f64::EPSILON * whole && pivot.is_finite();
        if !is_positive {
            return None;
        }
        let inverse_pivot = 1.0 / pivot;
        matrix[k][k] = 1.0;
        matrix[k].iter_mut().for_each(|entry| *entry *= inverse_pivot);
        let pivot_row = matrix[k].clone();
        for (row, entries) in matrix.iter_mut().enumerate() {
            if row != k {
                let factor = std::mem::replace(&mut entries[k], 0.0);
                entries.iter_mut().zip(&pivot_row).for_each(|(entry, top)| *entry -= factor * top);
            }
        }
    }
    Some(matrix)
}
