//! The saddle-point matrices `[M Gᵀ; G 0]` at all nodes of a step, a node per lane: for masses that vary, or that couple bodies.

use super::assembly::Assembly;
use super::elements::LanePoint;
use super::sparse::{Elimination, Symmetric, TooMuchFill};
use crate::scalar::{InstructionSet, Lanes, Scalar};

/// The matrices, and where everything goes that is added to them. Constraints are eliminated after their coordinates: the mass matrix is positive
/// definite and the constraints are independent, so that no pivot vanishes in this order.
pub(super) struct LaneSaddle {
    elimination: Elimination,
    /// For every family, where the masses of its elements go.
    masses: Vec<Vec<u32>>,
    /// Where every slope goes.
    slopes: Vec<u32>,
    matrix: Symmetric<Lanes>,
}

impl LaneSaddle {
    /// # Errors
    /// [`TooMuchFill`].
    pub(super) fn new(assembly: &Assembly) -> Result<Self, TooMuchFill> {
        let n = assembly.n_coordinates;
        let pairs = |family: &super::assembly::PlacedFamily| -> Vec<(usize, usize)> {
            let elements = &*family.elements;
            let vv = elements.structure().hessian.vv;
            (0..elements.count())
                .flat_map(|element| {
                    vv.iter().map(move |entry| {
                        (elements.place(element, entry.row), elements.place(element, entry.col))
                    })
                })
                .collect()
        };
        let masses: Vec<Vec<(usize, usize)>> = assembly.families.iter().map(pairs).collect();
        let slots: Vec<(usize, usize)> =
            assembly.slots.iter().map(|slot| (n + slot.row as usize, slot.col as usize)).collect();
        let coupled = masses.iter().flatten().chain(&slots).copied();
        let elimination = Elimination::new(n + assembly.n_constraints, coupled, |unknown| unknown >= n)?;
        let place = |&(row, col): &(usize, usize)| Symmetric::<Lanes>::place(&elimination, row, col);
        Ok(Self {
            masses: masses.iter().map(|pairs| pairs.iter().map(place).collect()).collect(),
            slopes: slots.iter().map(place).collect(),
            matrix: Symmetric::zero(&elimination),
            elimination,
        })
    }

    /// Overwrites the matrices with the masses at these points and constraints with these slopes, and `units` with the roots of the diagonal of the
    /// mass, its largest value at any node; then factors them. Singular ones give numbers that are not finite.
    #[inline(always)]
    pub(super) fn factor<const FUSED: bool>(
        &mut self,
        assembly: &Assembly,
        instructions: InstructionSet,
        at: LanePoint<'_>,
        slopes: &[Lanes],
        units: &mut [f64],
    ) {
        self.matrix.clear();
        for (family, places) in assembly.families.iter().zip(&self.masses) {
            family.elements.add_lane_mass(instructions, at, places, &mut self.matrix);
        }
        for (&place, &slope) in self.slopes.iter().zip(slopes) {
            self.matrix.add::<FUSED>(place, slope, Lanes::splat(1.0));
        }
        for (unit, mass) in units.iter_mut().zip(self.matrix.diagonal()) {
            *unit = mass.abs().largest().sqrt();
        }
        self.matrix.factor_unchecked::<FUSED>(&self.elimination);
    }

    /// Overwrites the right-hand sides, coordinates first, with the solutions.
    #[inline(always)]
    pub(super) fn solve<const FUSED: bool>(&self, rhs: &mut [Lanes]) {
        self.matrix.solve::<FUSED>(&self.elimination, rhs);
    }
}
