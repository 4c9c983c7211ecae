//! `G M⁻¹ Gᵀ` of a scene with a constant mass of small blocks: what determines multipliers alone.

use super::assembly::Assembly;
use super::mass::ConstantMass;
use super::number::Number;
use super::sparse::{Elimination, General, Symmetric, TooMuchFill};
use crate::linear::SingularMatrix;

/// A product of two slopes and an entry of `M⁻¹`, and where it goes.
#[derive(Clone, Copy)]
struct Product {
    /// The slope of the constraint that is eliminated later.
    later: u32,
    /// The other one.
    earlier: u32,
    /// The entry of `M⁻¹`.
    weight: u32,
    /// Its place in a symmetric matrix, and in the lower triangle of a general one.
    place: u32,
}

/// The pattern of Gram matrices and the order of their elimination.
pub(super) struct GramPattern {
    pub(super) elimination: Elimination,
    on_diagonal: Vec<Product>,
    beside: Vec<Product>,
}

impl GramPattern {
    /// # Errors
    /// [`TooMuchFill`].
    pub(super) fn new(assembly: &Assembly, mass: &ConstantMass) -> Result<Self, TooMuchFill> {
        let slots = &assembly.slots;
        let mut in_column: Vec<Vec<u32>> = vec![Vec::new(); assembly.n_coordinates];
        for (index, slot) in slots.iter().enumerate() {
            in_column[slot.col as usize].push(index as u32);
        }
        let row = |index: u32| slots[index as usize].row as usize;
        let mut pairs = Vec::new();
        mass.for_each_entry(|i, j, weight| {
            for &a in &in_column[i] {
                for &b in &in_column[j] {
                    pairs.push((a, b, weight as u32));
                }
            }
        });
        let coupled = pairs.iter().map(|&(a, b, _)| (row(a), row(b)));
        let elimination = Elimination::new(assembly.n_constraints, coupled, |_| false)?;
        let (mut on_diagonal, mut beside) = (Vec::new(), Vec::new());
        for (later, earlier, weight) in pairs {
            let place = Symmetric::<f64>::place(&elimination, row(later), row(earlier));
            let product = Product { later, earlier, weight, place };
            if row(later) == row(earlier) {
                on_diagonal.push(product);
            } else if elimination.is_later(row(later), row(earlier)) {
                beside.push(product);
            }
        }
        Ok(Self { elimination, on_diagonal, beside })
    }

    /// Overwrites `matrix` with `G M⁻¹ Gᵀ`.
    #[inline(always)]
    pub(super) fn symmetric<T: Number, const FUSED: bool>(
        &self,
        mass: &ConstantMass,
        slopes: &[T],
        matrix: &mut Symmetric<T>,
    ) {
        matrix.clear();
        for product in self.on_diagonal.iter().chain(&self.beside) {
            let weight = T::from_f64(mass.values[product.weight as usize]);
            let scaled = weight * slopes[product.later as usize];
            matrix.add::<FUSED>(product.place, scaled, slopes[product.earlier as usize]);
        }
    }

    /// Overwrites `matrix` with `G M⁻¹ Hᵀ`.
    pub(super) fn general(&self, mass: &ConstantMass, g: &[f64], h: &[f64], matrix: &mut General) {
        let above = self.elimination.n_below();
        let entries = matrix.entries_mut();
        entries.fill(0.0);
        for &Product { later, earlier, weight, place } in &self.on_diagonal {
            entries[place as usize] += g[later as usize] * mass.values[weight as usize] * h[earlier as usize];
        }
        for &Product { later, earlier, weight, place } in &self.beside {
            let (later, earlier, place) = (later as usize, earlier as usize, place as usize);
            let weight = mass.values[weight as usize];
            entries[place] += g[later] * weight * h[earlier];
            entries[place + above] += g[earlier] * weight * h[later];
        }
    }
}

/// A Gram matrix at one point, factored in place.
pub(super) struct Gram {
    pub(super) pattern: GramPattern,
    pub(super) symmetric: Symmetric<f64>,
    pub(super) general: General,
    peaks: Vec<f64>,
}

impl Gram {
    /// # Errors
    /// [`TooMuchFill`].
    pub(super) fn new(assembly: &Assembly, mass: &ConstantMass) -> Result<Self, TooMuchFill> {
        let pattern = GramPattern::new(assembly, mass)?;
        Ok(Self {
            symmetric: Symmetric::zero(&pattern.elimination),
            general: General::zero(&pattern.elimination),
            peaks: vec![0.0; assembly.n_constraints],
            pattern,
        })
    }

    /// Factors `G M⁻¹ Gᵀ`; returns the smallest pivot as a share of what stood in its place.
    ///
    /// # Errors
    /// [`SingularMatrix`] where a constraint depends on others, with that constraint.
    pub(super) fn factor(
        &mut self,
        mass: &ConstantMass,
        slopes: &[f64],
    ) -> Result<f64, (usize, SingularMatrix)> {
        self.pattern.symmetric::<f64, false>(mass, slopes, &mut self.symmetric);
        self.symmetric.factor(&self.pattern.elimination, &mut self.peaks)
    }

    /// Overwrites the right-hand side with the solution of the system with `G M⁻¹ Gᵀ`.
    pub(super) fn solve(&self, rhs: &mut [f64]) {
        self.symmetric.solve::<false>(&self.pattern.elimination, rhs);
    }

    /// Factors `G M⁻¹ Hᵀ`; returns the smallest pivot as a share of the largest number in its place.
    ///
    /// # Errors
    /// [`SingularMatrix`].
    pub(super) fn factor_between(
        &mut self,
        mass: &ConstantMass,
        g: &[f64],
        h: &[f64],
    ) -> Result<f64, SingularMatrix> {
        self.pattern.general(mass, g, h, &mut self.general);
        self.general.factor(&self.pattern.elimination)
    }

    /// Overwrites the right-hand side with the solution of the system with `G M⁻¹ Hᵀ`.
    pub(super) fn solve_between(&self, rhs: &mut [f64]) {
        self.general.solve(&self.pattern.elimination, rhs);
    }
}
