//! Places and origins of the structurally nonzero entries of derivatives.

/// The structurally nonzero second derivatives of `L`, block by block.
#[derive(Clone, Copy, Debug)]
pub struct HessianPattern {
    /// `∂²L/∂q²`, lower triangle (`row ≥ col`).
    pub qq: &'static [Entry],
    /// `∂²L/∂v∂q`: row of `v`, column of `q`.
    pub vq: &'static [Entry],
    /// `∂²L/∂v²`, lower triangle.
    pub vv: &'static [Entry],
    /// `∂²L/∂v∂t`: row of `v`, column 0.
    pub vt: &'static [Entry],
}

impl HessianPattern {
    /// Whether every second derivative of `L` is constant: `L` is a polynomial of degree two in `(q, v)`.
    pub const fn is_constant(&self) -> bool {
        is_constant(self.qq) && is_constant(self.vq) && is_constant(self.vv) && is_constant(self.vt)
    }
}

pub(super) const fn has_column(entries: &[Entry], col: usize) -> bool {
    let mut k = 0;
    while k < entries.len() {
        if entries[k].col == col {
            return true;
        }
        k += 1;
    }
    false
}

pub(super) const fn has_row(entries: &[Entry], row: usize) -> bool {
    let mut k = 0;
    while k < entries.len() {
        if entries[k].row == row {
            return true;
        }
        k += 1;
    }
    false
}

pub(super) const fn is_diagonal(entries: &[Entry]) -> bool {
    let mut k = 0;
    while k < entries.len() {
        if entries[k].row != entries[k].col {
            return false;
        }
        k += 1;
    }
    true
}

pub(super) const fn is_constant(entries: &[Entry]) -> bool {
    let mut k = 0;
    while k < entries.len() {
        if let EntryValue::Varying(_) = entries[k].value {
            return false;
        }
        k += 1;
    }
    true
}

/// Calls `visit(row, col, value)` for every entry of a lower triangle, and for what mirrors it.
#[inline(always)]
pub(super) fn for_each_of_both<T: Copy>(
    entries: &[Entry],
    constants: &[T],
    varying: &[T],
    mut visit: impl FnMut(usize, usize, T),
) {
    for entry in entries {
        let value = entry.value(constants, varying);
        visit(entry.row, entry.col, value);
        if entry.row != entry.col {
            visit(entry.col, entry.row, value);
        }
    }
}

/// The structurally nonzero derivatives of `φ`.
#[derive(Clone, Copy, Debug)]
pub struct JacobianPattern {
    /// `G = ∂φ/∂q`: row of the constraint, column of the coordinate.
    pub q: &'static [Entry],
    /// `∂φ/∂t`: row of the constraint, column 0.
    pub t: &'static [Entry],
    /// The factor that all derivatives have in common, as `(2x, 2y)` of `x² + y²` have 2: what
    /// [`constraint_slopes`](super::MechanicalSystem::constraint_slopes) leaves out. 1 where an entry is constant.
    pub content: f64,
}

/// Place and origin of one structurally nonzero matrix entry.
#[derive(Clone, Copy, Debug)]
pub struct Entry {
    /// Row in the block.
    pub row: usize,
    /// Column in the block.
    pub col: usize,
    /// Where its value comes from.
    pub value: EntryValue,
}

impl Entry {
    /// Whether a kernel computes it.
    pub const fn is_varying(&self) -> bool {
        matches!(self.value, EntryValue::Varying(_))
    }

    /// The entry's value, from the scene's constants or from what its kernel returned.
    #[inline]
    pub fn value<T: Copy>(&self, constants: &[T], varying: &[T]) -> T {
        match self.value {
            EntryValue::Constant(slot) => constants[slot],
            EntryValue::Varying(index) => varying[index],
        }
    }

    /// The same of numbers, and none where there is no value: for loops over entries that are not unrolled, where the optimiser does not find out that
    /// there is one.
    #[inline]
    pub(crate) fn number(&self, constants: &[f64], varying: &[f64]) -> f64 {
        let value = match self.value {
            EntryValue::Constant(slot) => constants.get(slot),
            EntryValue::Varying(index) => varying.get(index),
        };
        value.copied().unwrap_or(f64::NAN)
    }
}

/// Where the value of a matrix entry comes from.
#[derive(Clone, Copy, Debug)]
pub enum EntryValue {
    /// Constant of the scene, at this index.
    Constant(usize),
    /// Varying entry, at this index of the kernel's output.
    Varying(usize),
}
