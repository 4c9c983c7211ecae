//! A scene linearised: `M ÿ + Ω y = 0` on `G y = 0`, and the modes of that.
//!
//! Constraints bend the motion: with the multipliers `λ` that hold the scene, `Ω = V_qq + Σ λᵢ (φᵢ)_qq`.

#[cfg(feature = "std")]
use super::coordinate_matrix::times;
use super::modes::{Modes, reduced};
use super::{Directions, Mechanics, ProjectionError, Rows};
use crate::array::Array;
use crate::linear::{Cholesky, Kkt, constraint_index, unknowns};
use crate::newton::{self, NotConverged};
use crate::scalar::Scalar;
use crate::scheme::{Frequency, LinearisationError, Quadrature, growth_rate};
use crate::system::MechanicalSystem;

/// A configuration that neutral directions keep Newton's iteration from is an equilibrium if its forces balance to this.
const BALANCE: f64 = 1e-9;
/// A constraint whose gradient the others combine to, to this fraction, is redundant.
const INDEPENDENT: f64 = 1e-10;
/// A squared frequency below this fraction of the largest is too soft to move the reference along its mode.
const SOFT: f64 = 1e-6;

/// A scene linearised at a configuration.
pub struct Linearisation<S: MechanicalSystem> {
    configuration: S::PerCoordinate<f64>,
    reference: S::PerCoordinate<f64>,
    multipliers: S::PerConstraint<f64>,
    stiffness: Rows<S>,
    squared_frequencies: S::PerCoordinate<f64>,
    shapes: Rows<S>,
    n_modes: usize,
}

impl<S: MechanicalSystem> Linearisation<S> {
    /// The configuration: on the constraints, and the equilibrium where one was asked for.
    pub const fn configuration(&self) -> &S::PerCoordinate<f64> {
        &self.configuration
    }

    /// The configuration at which the quadratic model `λᵀφ + V` around [`configuration`](Self::configuration) is stationary:
    /// the equilibrium, or the point that a motion turns about.
    pub const fn reference(&self) -> &S::PerCoordinate<f64> {
        &self.reference
    }

    /// `λ`: the multipliers there.
    pub const fn multipliers(&self) -> &S::PerConstraint<f64> {
        &self.multipliers
    }

    /// `Ω = V_qq + Σ λᵢ (φᵢ)_qq`, by rows.
    pub const fn stiffness(&self) -> &S::PerCoordinate<S::PerCoordinate<f64>> {
        &self.stiffness
    }

    /// Squared frequencies of the constrained linear motion in ascending order, one per degree of freedom; negative for a mode
    /// that grows. Unit: 1 / time².
    pub fn squared_frequencies(&self) -> &[f64] {
        &self.squared_frequencies.as_ref()[..self.n_modes]
    }

    /// The rates at which a step on curves of `frequency` makes each of these modes grow ([`growth_rate`]), 0 for a mode that stays
    /// bounded: which modes are too soft, or too stiff, for the frequency. For modes that grow in truth it tells their growth.
    ///
    /// ```
    /// use evi_core::mechanics::Mechanics;
    /// use evi_core::prelude::*;
    ///
    /// /// Two masses on a spring, free to move along a line.
    /// #[derive(MechanicalSystem)]
    /// #[evi(
    ///     coordinates(x, y),
    ///     kinetic = 0.5 * der(x).powi(2) + 0.5 * der(y).powi(2),
    ///     potential = 0.5 * k * (y - x).powi(2),
    /// )]
    /// struct Molecule { k: f64 }
    ///
    /// let linearisation = Mechanics::new(&Molecule { k: 8.0 }).linearised_at(&[0.0, 0.0])?;
    /// let rates: Vec<f64> =
    ///     linearisation.growth_rates(Frequency::from(4.0), &Quadrature::<3>::uniform(), 0.1).collect();
    /// assert!(rates[0] > 0.4, "translation");
    /// assert_eq!(rates[1], 0.0, "vibration at frequency 4");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn growth_rates<const K: usize>(
        &self,
        frequency: Frequency,
        rule: &Quadrature<K>,
        h: f64,
    ) -> impl Iterator<Item = f64> {
        self.squared_frequencies()
            .iter()
            .map(move |squared_frequency| growth_rate(frequency, rule, h, *squared_frequency))
    }

    /// The shapes of these modes: tangent to the constraints, of unit length in the metric of the mass matrix.
    pub fn shapes(&self) -> &[S::PerCoordinate<f64>] {
        &self.shapes.as_ref()[..self.n_modes]
    }
}

impl<S: MechanicalSystem> Mechanics<S> {
    /// The linearisation at the equilibrium next to `q`, which Newton's iteration on `∂V/∂q + Gᵀλ = 0`, `φ = 0` finds.
    ///
    /// The squared frequencies are those of the small motions about it: the eigenvalues of `Ω y = κ M y` on `G y = 0`.
    ///
    /// # Errors
    /// [`LinearisationError`] for a scene that depends on time or couples velocities with positions, and where there is no
    /// equilibrium near `q`.
    pub fn linearised_at(&self, q: &S::PerCoordinate<f64>) -> Result<Linearisation<S>, LinearisationError> {
        check_structure::<S>()?;
        let q = self.equilibrium_near(&self.projected(q)?)?;
        let at_rest = Array::from_fn(|_| 0.0);
        let multipliers = self.multipliers_at(&q, &at_rest)?;
        self.linearised(q.clone(), q, multipliers)
    }

    /// The linearisation at a point `(q, v)` of a motion, with the multipliers that hold the scene there while it moves.
    ///
    /// # Errors
    /// As for [`linearised_at`](Self::linearised_at), but for the equilibrium, which is not needed.
    pub fn linearised_along(
        &self,
        q: &S::PerCoordinate<f64>,
        v: &S::PerCoordinate<f64>,
    ) -> Result<Linearisation<S>, LinearisationError> {
        check_structure::<S>()?;
        if !S::STRUCTURE.mass.is_constant() {
            let requirement = "a constant mass matrix, away from an equilibrium";
            return Err(LinearisationError::UnsupportedStructure { requirement });
        }
        let q = self.projected(q)?;
        check_finite("velocity", v.as_ref())?;
        let v = self.project_velocity(0.0, &q, v.clone()).map_err(not_projected)?.v;
        let multipliers = self.multipliers_at(&q, &v)?;
        let stiffness = self.stiffness_at(&q, &multipliers);
        let modes = Modes::<S>::new(&self.mass_at(&q), &stiffness)?;
        let pull = self.potential_gradient(0.0, &q, &multipliers);
        let largest = modes.squared_frequencies.as_ref().iter().fold(0.0, |x: f64, y| x.max(y.abs()));
        let mut reference = q.clone();
        for k in 0..S::N_COORDINATES {
            let squared_frequency = modes.squared_frequencies[k];
            if squared_frequency.abs() > SOFT * largest {
                let share: f64 = (0..S::N_COORDINATES).map(|i| modes.shapes[k][i] * pull[i]).sum();
                for i in 0..S::N_COORDINATES {
                    reference[i] -= modes.shapes[k][i] * share / squared_frequency;
                }
            }
        }
        self.linearised(q, reference, multipliers)
    }

    /// `∂V/∂q + Gᵀλ` at rest.
    #[inline]
    pub(crate) fn potential_gradient(
        &self,
        t: f64,
        q: &S::PerCoordinate<f64>,
        multipliers: &S::PerConstraint<f64>,
    ) -> S::PerCoordinate<f64> {
        let at_rest = Array::from_fn(|_| 0.0);
        let force = S::lagrangian_gradient(&self.constants, t, q, &at_rest).force;
        let mut gradient = S::PerCoordinate::<f64>::from_fn(|i| -force[i]);
        if S::N_CONSTRAINTS > 0 {
            let (_, jacobian) = S::constraint_derivatives(&self.constants, t, q);
            self.add_constraint_force(&jacobian, multipliers, &mut gradient);
        }
        gradient
    }

    /// `∂²(V + λᵀφ)/∂q² x` at rest.
    #[cfg(feature = "std")]
    pub(crate) fn potential_hessian_product(
        &self,
        t: f64,
        q: &S::PerCoordinate<f64>,
        multipliers: &S::PerConstraint<f64>,
        x: &S::PerCoordinate<f64>,
    ) -> S::PerCoordinate<f64> {
        let hessian = self.potential_hessian(t, q);
        let mut product = times::<S>(&hessian, x);
        self.for_each_constraint_curvature(t, q, multipliers, |row, col, curvature| {
            product[row] += curvature * x[col];
        });
        product
    }

    /// `M` at rest, by rows.
    pub(crate) fn mass_at(&self, q: &S::PerCoordinate<f64>) -> Rows<S> {
        let at_rest = Array::from_fn(|_| 0.0);
        let (_, hessian) = S::lagrangian_derivatives(&self.constants, 0.0, q, &at_rest);
        let mut mass: Rows<S> = Array::from_fn(|_| Array::from_fn(|_| 0.0));
        for entry in S::STRUCTURE.hessian.vv {
            let value = entry.value(self.constants.as_ref(), hessian.as_ref());
            mass[entry.row][entry.col] = value;
            mass[entry.col][entry.row] = value;
        }
        mass
    }

    /// `V_qq` at rest, by rows.
    #[inline]
    pub(crate) fn potential_hessian(&self, t: f64, q: &S::PerCoordinate<f64>) -> Rows<S> {
        let at_rest = Array::from_fn(|_| 0.0);
        let (_, hessian) = S::lagrangian_derivatives(&self.constants, t, q, &at_rest);
        let mut stiffness: Rows<S> = Array::from_fn(|_| Array::from_fn(|_| 0.0));
        for entry in S::STRUCTURE.hessian.qq {
            let value = -entry.value(self.constants.as_ref(), hessian.as_ref());
            stiffness[entry.row][entry.col] = value;
            stiffness[entry.col][entry.row] = value;
        }
        stiffness
    }

    fn stiffness_at(&self, q: &S::PerCoordinate<f64>, multipliers: &S::PerConstraint<f64>) -> Rows<S> {
        let mut stiffness = self.potential_hessian(0.0, q);
        self.for_each_constraint_curvature(0.0, q, multipliers, |row, col, curvature| {
            stiffness[row][col] += curvature;
        });
        stiffness
    }

    fn projected(&self, q: &S::PerCoordinate<f64>) -> Result<S::PerCoordinate<f64>, LinearisationError> {
        check_finite("position", q.as_ref())?;
        let at_rest = Array::from_fn(|_| 0.0);
        self.project_configuration(0.0, q, &at_rest).map_err(not_projected)
    }

    /// The multipliers that hold the scene at `(q, v)`; at rest, the least squares of `∂V/∂q + Gᵀλ` in the metric of `M⁻¹`.
    fn multipliers_at(
        &self,
        q: &S::PerCoordinate<f64>,
        v: &S::PerCoordinate<f64>,
    ) -> Result<S::PerConstraint<f64>, LinearisationError> {
        match self.acceleration(0.0, q, v) {
            Ok(motion) => Ok(motion.multipliers),
            Err(singular) => Err(LinearisationError::Projection { pivot_ratio: singular.pivot_ratio }),
        }
    }

    /// The solution of `∂V/∂q + Gᵀλ = 0`, `φ = 0` next to a configuration on the constraints.
    fn equilibrium_near(
        &self,
        start: &S::PerCoordinate<f64>,
    ) -> Result<S::PerCoordinate<f64>, LinearisationError> {
        let at_rest = Array::from_fn(|_| 0.0);
        let mut multipliers = self.multipliers_at(start, &at_rest)?;
        let mut q = start.clone();
        let found = newton::iterate(|_| -> Result<f64, NoEquilibrium> {
            let stiffness = self.stiffness_at(&q, &multipliers);
            let no_multipliers = Array::from_fn(|_| 0.0);
            let gradient = self.potential_gradient(0.0, &q, &no_multipliers);
            let (residual, jacobian) = S::constraint_derivatives(&self.constants, 0.0, &q);
            let mut kkt = Kkt::<S>::zero();
            for row in 0..S::N_COORDINATES {
                for col in 0..S::N_COORDINATES {
                    kkt.add_block(row, col, stiffness[row][col]);
                }
            }
            kkt.set_upper_jacobian(&self.constants, &jacobian);
            kkt.set_lower_jacobian(&self.constants, &jacobian);
            let kkt = kkt.factor_densely().map_err(|_| NoEquilibrium::Neutral)?;
            let mut correction = unknowns::<S>(|i| -gradient[i], |c| -residual[c]);
            kkt.solve(&mut correction);
            for i in 0..S::N_COORDINATES {
                q[i] += correction[i];
            }
            // The multipliers enter linearly: their values, not increments, belong to the corrected configuration.
            multipliers = Array::from_fn(|c| correction[constraint_index::<S>(c)]);
            Ok(kkt.relative_length(|i| correction[i], |i| q[i].abs() + correction[i].abs()))
        });
        match found {
            Ok(_) => Ok(q),
            // Neutral directions: nothing to solve for where the forces balance already.
            Err(NoEquilibrium::Neutral) if self.is_balanced(start)? => Ok(start.clone()),
            Err(NoEquilibrium::Neutral) => {
                Err(LinearisationError::NoEquilibrium { corrections: 0, last_correction: f64::NAN })
            }
            Err(NoEquilibrium::NotConverged(NotConverged { corrections, last_correction })) => {
                Err(LinearisationError::NoEquilibrium { corrections, last_correction })
            }
        }
    }

    /// Whether the forces at rest balance, to a fraction of their terms.
    fn is_balanced(&self, q: &S::PerCoordinate<f64>) -> Result<bool, LinearisationError> {
        let at_rest = Array::from_fn(|_| 0.0);
        let multipliers = self.multipliers_at(q, &at_rest)?;
        let none = Array::from_fn(|_| 0.0);
        let stiffness = self.stiffness_at(q, &multipliers);
        let (pull, of_potential) =
            (self.potential_gradient(0.0, q, &multipliers), self.potential_gradient(0.0, q, &none));
        Ok((0..S::N_COORDINATES).all(|i| {
            let springs: f64 = (0..S::N_COORDINATES).map(|k| (stiffness[i][k] * q[k]).abs()).sum();
            pull[i].abs() <= BALANCE * (of_potential[i].abs() + springs)
        }))
    }

    /// The modes of `Ω` on the tangent space of the constraints.
    fn linearised(
        &self,
        configuration: S::PerCoordinate<f64>,
        reference: S::PerCoordinate<f64>,
        multipliers: S::PerConstraint<f64>,
    ) -> Result<Linearisation<S>, LinearisationError> {
        let stiffness = self.stiffness_at(&configuration, &multipliers);
        let metric = Cholesky::new(&self.mass_at(&configuration)).ok_or(LinearisationError::Mass)?;
        let mut restricted = reduced::<S>(&metric, &stiffness)?;
        let (normals, rank) = self.orthonormal_gradients(&metric, &configuration);
        for normal in &normals.as_ref()[..rank] {
            project_out::<S>(&mut restricted, normal);
        }
        // The directions that constraints forbid are moved above all modes, so that sorting leaves them last.
        let sum_of_magnitudes = |row: &S::PerCoordinate<f64>| row.as_ref().iter().map(|x| x.abs()).sum();
        let bound = restricted.as_ref().iter().map(sum_of_magnitudes).fold(0.0, |x: f64, y: f64| x.max(y));
        let above = if bound > 0.0 { 2.0 * bound } else { 1.0 };
        for normal in &normals.as_ref()[..rank] {
            for row in 0..S::N_COORDINATES {
                for col in 0..S::N_COORDINATES {
                    restricted[row][col] += above * (normal[row] * normal[col]);
                }
            }
        }
        let Modes { squared_frequencies, shapes, .. } = Modes::<S>::in_metric(&metric, &restricted)?;
        Ok(Linearisation {
            configuration,
            reference,
            multipliers,
            stiffness,
            squared_frequencies,
            shapes,
            n_modes: S::N_COORDINATES - rank,
        })
    }

    /// The directions `L⁻¹ Gᵀ`, made orthonormal, and how many there are; the other rows are zero.
    fn orthonormal_gradients(
        &self,
        metric: &Cholesky<Rows<S>>,
        q: &S::PerCoordinate<f64>,
    ) -> (Rows<S>, usize) {
        let (_, jacobian) = S::constraint_derivatives(&self.constants, 0.0, q);
        let mut gradients: Directions<S> = Array::from_fn(|_| Array::from_fn(|_| 0.0));
        for entry in S::STRUCTURE.jacobian.q {
            gradients[entry.row][entry.col] = entry.value(self.constants.as_ref(), jacobian.as_ref());
        }
        let mut normals: Rows<S> = Array::from_fn(|_| Array::from_fn(|_| 0.0));
        let mut rank = 0;
        for gradient in gradients.as_ref() {
            let mut normal = gradient.clone();
            metric.solve(&mut normal);
            let length = super::norm(normal.as_ref());
            // Twice is enough (Kahan; Parlett, The Symmetric Eigenvalue Problem, sec. 6.9).
            for _ in 0..2 {
                for known in &normals.as_ref()[..rank] {
                    let share: f64 = (0..S::N_COORDINATES).map(|i| known[i] * normal[i]).sum();
                    for i in 0..S::N_COORDINATES {
                        normal[i] -= share * known[i];
                    }
                }
            }
            let rest = Scalar::sqrt(normal.as_ref().iter().map(|x| x * x).sum::<f64>());
            if rest > INDEPENDENT * length && rank < S::N_COORDINATES {
                normals[rank] = Array::from_fn(|i| normal[i] / rest);
                rank += 1;
            }
        }
        (normals, rank)
    }
}

/// Why Newton's iteration for an equilibrium ended.
enum NoEquilibrium {
    /// Its matrix is singular: some direction is neutral.
    Neutral,
    NotConverged(NotConverged),
}

impl From<NotConverged> for NoEquilibrium {
    fn from(failure: NotConverged) -> Self {
        Self::NotConverged(failure)
    }
}

fn not_projected(error: ProjectionError) -> LinearisationError {
    let pivot_ratio = match error {
        ProjectionError::Singular(singular) => singular.pivot_ratio,
        ProjectionError::NotConverged { .. } => f64::NAN,
    };
    LinearisationError::Projection { pivot_ratio }
}

fn check_finite(quantity: &'static str, values: &[f64]) -> Result<(), LinearisationError> {
    match values.iter().position(|value| !value.is_finite()) {
        Some(index) => Err(LinearisationError::Point { quantity, index, value: values[index] }),
        None => Ok(()),
    }
}

fn check_structure<S: MechanicalSystem>() -> Result<(), LinearisationError> {
    if S::STRUCTURE.forces.exist() {
        let requirement = "a scene without forces but those of its potential";
        return Err(LinearisationError::UnsupportedStructure { requirement });
    }
    if !S::STRUCTURE.is_autonomous() {
        let requirement = "a scene that does not depend on time";
        return Err(LinearisationError::UnsupportedStructure { requirement });
    }
    if !(S::STRUCTURE.hessian.vq.is_empty() || S::STRUCTURE.momentum_vanishes_at_rest) {
        let requirement = "a Lagrangian without terms linear in the velocity";
        return Err(LinearisationError::UnsupportedStructure { requirement });
    }
    Ok(())
}

/// `(1 − n nᵀ) A (1 − n nᵀ)` for a unit vector and a symmetric matrix, which stays symmetric to the last bit.
fn project_out<S: MechanicalSystem>(matrix: &mut Rows<S>, normal: &S::PerCoordinate<f64>) {
    let image = S::PerCoordinate::<f64>::from_fn(|row| {
        (0..S::N_COORDINATES).map(|col| matrix[row.max(col)][row.min(col)] * normal[col]).sum()
    });
    let along: f64 = (0..S::N_COORDINATES).map(|i| normal[i] * image[i]).sum();
    for row in 0..S::N_COORDINATES {
        for col in 0..S::N_COORDINATES {
            let mixed = normal[row] * image[col] + image[row] * normal[col];
            matrix[row][col] += along * (normal[row] * normal[col]) - mixed;
        }
    }
}
