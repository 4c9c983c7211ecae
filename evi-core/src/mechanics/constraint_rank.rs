//! How many constraints are independent: decided at one point, by singular values.
//!
//! With `M = L Lᵀ`, the columns of `L⁻¹ Gᵀ` are the constraint forces in the metric of the kinetic energy. Scaled to length 1, they do not depend
//! on the units of coordinates and constraints, and their singular values tell angles between forces. A value below
//!
//! ```text
//! max(n, m) · 1e-12 · σ₁
//! ```
//!
//! is none: 1e-12 is how far from the constraints a start may be, and gradients that depend on the constraints alone are independent
//! by as much beside them. Where values are small, the same is asked with all masses 1: masses many powers of ten apart make angles small
//! that are not. The rank is decided where a run starts, and nowhere else: a rank that is decided anew at every matrix changes where
//! round-off wants, and with it the number of degrees of freedom.

use core::cmp::Ordering;
use core::fmt;

use super::{Mechanics, Rows};
use crate::array::Array;
use crate::linear::{Cholesky, largest_magnitude, orthonormal, singular_values};
use crate::scalar::Scalar;
use crate::system::MechanicalSystem;

/// A start is consistent when a constraint residual is below this fraction of what it would be for a
/// displacement (or velocity) of full size: decimal data with 13 digits pass, shortened data do not.
pub(crate) const CONSISTENCY: f64 = 1e-12;

/// Below this the squares of singular values, which the solvers of a scene meet, are round-off.
const NEARLY_DEPENDENT: f64 = 1e-7;

/// How many constraints are independent at a configuration, and which ones; made by [`Mechanics::constraint_rank`].
pub struct ConstraintRank<S: MechanicalSystem> {
    singular_values: S::PerConstraint<f64>,
    rank: usize,
    /// Constraints, `rank` independent ones first.
    order: S::PerConstraint<usize>,
    /// Whether the gradient of some constraint vanishes: it follows from nothing.
    pub(crate) lacks_gradient: bool,
}

impl<S: MechanicalSystem> ConstraintRank<S> {
    /// The number of independent constraints.
    pub const fn rank(&self) -> usize {
        self.rank
    }

    /// `σ₁ ≥ σ₂ ≥ …` of the constraint forces, each scaled to length 1, in the metric of the mass matrix.
    pub fn singular_values(&self) -> &[f64] {
        self.singular_values.as_ref()
    }

    /// Singular values below this count as zero.
    pub fn tolerance(&self) -> f64 {
        tolerance::<S>(&self.singular_values)
    }

    /// The constraints that follow from the others. Of constraints that say the same, the later ones do.
    pub fn dependent(&self) -> ConstraintSet {
        ConstraintSet::of(S::CONSTRAINTS, &self.order.as_ref()[self.rank..])
    }

    /// The constraint that follows most nearly from those before it.
    pub(crate) fn most_dependent(&self) -> usize {
        self.order.as_ref().last().copied().unwrap_or(0)
    }

    /// Whether the constraints are independent, and the squares of their singular values no round-off.
    pub(crate) fn is_sound(&self) -> bool {
        self.rank == S::N_CONSTRAINTS && self.gap().0 > NEARLY_DEPENDENT
    }

    /// The smallest singular value that counts, and the largest that does not, relative to the largest of all.
    pub(crate) fn gap(&self) -> (f64, f64) {
        let value = |k: usize| match (self.singular_values().get(k), self.singular_values().first()) {
            (Some(value), Some(largest)) if *largest > 0.0 => value / largest,
            _ => 0.0,
        };
        (self.rank.checked_sub(1).map_or(0.0, value), value(self.rank))
    }
}

impl<S: MechanicalSystem> fmt::Display for ConstraintRank<S> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "rank {} of {} constraints, singular values", self.rank, S::N_CONSTRAINTS)?;
        for (k, value) in self.singular_values().iter().enumerate() {
            write!(formatter, "{} {value:.3e}", if k == 0 { "" } else { "," })?;
        }
        if self.rank < S::N_CONSTRAINTS {
            write!(formatter, "; from the others follow: {}", self.dependent())?;
        }
        Ok(())
    }
}

fn tolerance<S: MechanicalSystem>(values: &S::PerConstraint<f64>) -> f64 {
    let size = S::N_COORDINATES.max(S::N_CONSTRAINTS);
    size as f64 * CONSISTENCY * values.as_ref().first().copied().unwrap_or(0.0)
}

/// Some of a scene's constraints, to be printed by their names.
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct ConstraintSet {
    names: &'static [&'static str],
    /// Bit `c` stands for constraint `c`; of those from 128 on none are named.
    members: u128,
}

impl ConstraintSet {
    fn of(names: &'static [&'static str], members: &[usize]) -> Self {
        let bit = |&c: &usize| 1_u128.checked_shl(c as u32).unwrap_or(0);
        Self { names, members: members.iter().map(bit).fold(0, |all, bit| all | bit) }
    }

    /// The names, in the order of the scene.
    pub fn names(&self) -> impl Iterator<Item = &'static str> + use<> {
        let Self { names, members } = *self;
        names.iter().take(128).enumerate().filter(move |(c, _)| members >> c & 1 == 1).map(|(_, name)| *name)
    }
}

impl fmt::Display for ConstraintSet {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (k, name) in self.names().enumerate() {
            write!(formatter, "{}`{name}`", if k == 0 { "" } else { ", " })?;
        }
        Ok(())
    }
}

impl fmt::Debug for ConstraintSet {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.debug_set().entries(self.names()).finish()
    }
}

impl<S: MechanicalSystem> Mechanics<S> {
    /// How many constraints are independent at `(t, q)`.
    ///
    /// ```
    /// use evi_core::mechanics::Mechanics;
    /// use evi_core::prelude::*;
    /// /// A bead on a wire that is written down twice, in two units.
    /// #[derive(MechanicalSystem)]
    /// #[evi(
    ///     coordinates(x, y),
    ///     kinetic = 0.5 * m * (der(x).powi(2) + der(y).powi(2)),
    ///     potential = 0.0,
    ///     constraint(metres: x.powi(2) + y.powi(2) == l.powi(2)),
    ///     constraint(millimetres: 1e6 * (x.powi(2) + y.powi(2)) == 1e6 * l.powi(2)),
    /// )]
    /// struct Bead { m: f64, l: f64 }
    /// let rank = Mechanics::new(&Bead { m: 2.0, l: 1.0 }).constraint_rank(0.0, &[0.6, 0.8]);
    /// assert_eq!(rank.rank(), 1);
    /// assert_eq!(rank.dependent().to_string(), "`millimetres`");
    /// ```
    #[cold]
    #[inline(never)]
    pub fn constraint_rank(&self, t: f64, q: &S::PerCoordinate<f64>) -> ConstraintRank<S> {
        let by_kinetic_energy = Self::rank_of(self.unit_constraint_forces(t, q, &self.mass_at(q)));
        if by_kinetic_energy.is_sound() {
            return by_kinetic_energy;
        }
        // Masses many powers of ten apart hide directions, which no other metric need hide: what depends does so in all of them.
        let unit_masses = Array::from_fn(|row| Array::from_fn(|col| if row == col { 1.0 } else { 0.0 }));
        let by_coordinates = Self::rank_of(self.unit_constraint_forces(t, q, &unit_masses));
        let (kept, other) = (by_kinetic_energy.gap().0, by_coordinates.gap().0);
        let hides_less = match by_coordinates.rank.cmp(&by_kinetic_energy.rank) {
            Ordering::Equal => by_kinetic_energy.rank == S::N_CONSTRAINTS && other > kept,
            order => order == Ordering::Greater,
        };
        if hides_less { by_coordinates } else { by_kinetic_energy }
    }

    #[inline(never)]
    fn rank_of(mut forces: S::PerConstraint<S::PerCoordinate<f64>>) -> ConstraintRank<S> {
        let lacks_gradient = forces.as_ref().iter().any(|force| orthonormal::product(force, force) == 0.0);
        let mut values = S::PerConstraint::<f64>::from_fn(|_| 0.0);
        singular_values(forces.clone().as_mut(), values.as_mut());
        let least = tolerance::<S>(&values);
        let rank = values.as_ref().iter().filter(|value| **value > least).count();
        let mut order = S::PerConstraint::<usize>::from_fn(|c| c);
        let mut basis = S::PerConstraint::<S::PerCoordinate<f64>>::from_fn(|_| Array::from_fn(|_| 0.0));
        // Of full rank, the last one in this order is the most dependent.
        orthonormal::span(forces.as_mut(), rank, basis.as_mut(), order.as_mut());
        ConstraintRank { singular_values: values, rank, order, lacks_gradient }
    }

    /// The columns of `L⁻¹ Gᵀ`, scaled to length 1; with `diag √|Mᵢᵢ|` for `L` where `M` is not positive definite.
    #[inline(never)]
    fn unit_constraint_forces(
        &self,
        t: f64,
        q: &S::PerCoordinate<f64>,
        mass: &Rows<S>,
    ) -> S::PerConstraint<S::PerCoordinate<f64>> {
        let (_, jacobian) = S::constraint_derivatives(&self.constants, t, q);
        let mut forces = S::PerConstraint::<S::PerCoordinate<f64>>::from_fn(|_| Array::from_fn(|_| 0.0));
        for entry in S::STRUCTURE.jacobian.q {
            forces[entry.row][entry.col] = entry.value(self.constants.as_ref(), jacobian.as_ref());
        }
        let metric = Cholesky::new(mass);
        for force in forces.as_mut() {
            // First to the size of 1: squares of what is far from it leave the numbers.
            let largest = largest_magnitude(force.as_ref().iter().copied());
            scale_by(force, largest);
            match &metric {
                Some(metric) => metric.solve(force),
                None => {
                    for i in 0..S::N_COORDINATES {
                        scale_by_one(&mut force[i], Scalar::sqrt(mass[i][i].abs()));
                    }
                }
            }
            let largest = largest_magnitude(force.as_ref().iter().copied());
            scale_by(force, largest);
            let length = Scalar::sqrt(orthonormal::product(force, force));
            scale_by(force, length);
        }
        forces
    }
}

/// Divides by a length, unless that vanishes.
fn scale_by<V: Array<f64>>(force: &mut V, length: f64) {
    force.as_mut().iter_mut().for_each(|x| scale_by_one(x, length));
}

fn scale_by_one(x: &mut f64, length: f64) {
    // Exactly 0 is the length of nothing.
    if length != 0.0 {
        *x /= length;
    }
}
