//! A Galerkin step of a scene with constant mass by passes over all nodes at once, a node per lane.
//!
//! With the impulses `kⱼ = h bⱼ Fⱼ` of the total forces `Fⱼ = ∂L/∂q + f − Gᵀλⱼ` at the nodes, the ways `yⱼ = h M⁻¹ kⱼ` that they go in a step, the impulses
//! `Λⱼ = h bⱼ λⱼ` of the constraints, the tables of [`ImpulseTables`] and the Gram matrices `Sᵢ = Gᵢ M⁻¹ Gᵢᵀ`, a pass is
//!
//! ```text
//! qᵢ = q₀ + cᵢ h M⁻¹ p₀ + Σⱼ sᵢⱼ yⱼ           ηᵢ = Sᵢ⁻¹ φ(qᵢ)           Λ += (b B⁻¹ η) / h
//! q̃ᵢ = qᵢ − M⁻¹ Gᵢᵀ ηᵢ                        kⱼ = h bⱼ (∂L/∂q(q̃ⱼ) + f(q̃ⱼ, vⱼ)) − G(q̃ⱼ)ᵀ Λⱼ
//! ```
//!
//! `B⁻¹ ⊗ Sᵢ⁻¹` stands for the inverse of the derivative `Gᵢ M⁻¹ Bᵢⱼ Gⱼᵀ` of the constraints by the multipliers: no matrix that couples nodes
//! is ever formed. A fixed point solves the equations of [`super::galerkin_equations`] exactly, whatever `Sᵢ` is and wherever the first pass begins;
//! a pass shrinks the error by about `4 (h ω)² ρ(B)`.
//!
//! Impulses, and one rounded `h M⁻¹` for them and for `p₀`, leave nothing systematic of the rounding of tables: what one step is off by, another is not.

mod back;
mod end;
mod first_guess;
mod forces;
mod gram;
mod nodes;

use super::reach::{Length, has_light, larger, unit};
use super::{AsMass, AsScene, ConstantLegendre, CoordinateMatrix, Coupling, Mechanics, State};
use crate::array::Array;
use crate::linear::{Cholesky, LaneGram};
use crate::newton::{LinearProgress, NotConverged};
use crate::scalar::{LaneOperation, Lanes};
use crate::scheme::ImpulseTables;
use crate::system::MechanicalSystem;
pub(crate) use back::{Arrival, BackStep};
pub(crate) use end::LaneEnd;
pub(crate) use first_guess::FirstGuess;
use gram::applied;
use nodes::Nodes;
pub(super) use nodes::{from_start, nothing};
pub(crate) use nodes::{product, product_of_stored};

/// The Gram matrices are made anew after a pass that has moved a point by more than this share of the configuration.
const STALE: f64 = 3e-3;

/// The square of a rounding is 1e-32 of that of a configuration, and vanishes below 1e-308: this leaves lengths down to 1e-38.
const SMALLEST_MASS: f64 = 1e-200;

/// The passes of one scene, for one step size.
pub(crate) struct LaneStep<S: MechanicalSystem, const K: usize> {
    /// Relative length of a last correction.
    tolerance: f64,
    constants: S::PerConstant<Lanes>,
    inverse_mass: CoordinateMatrix<S, AsMass>,
    pub(crate) legendre: ConstantLegendre<S>,
    /// `h M⁻¹`.
    mobility: CoordinateMatrix<S, AsMass>,
    tables: ImpulseTables,
    /// What a coordinate is multiplied with at least before lengths are compared: `√Mᵢᵢ` as a power of two.
    units: S::PerCoordinate<f64>,
    /// Whether there are coordinates that the metric of the masses does not see.
    has_light: bool,
    /// Of the nodes `1 .. K`.
    gram: LaneGram<S>,
    /// Of the nodes `0 .. K−1`.
    start_gram: LaneGram<S>,
    /// `yⱼ` of the last passes, `j = 0 .. K−1`.
    pub(crate) ways: Nodes<S>,
    /// `kⱼ` of the last passes, `j = 0 .. K−1`.
    impulses: Nodes<S>,
    /// `Λⱼ` of the last passes, `j = 0 .. K−1`.
    multipliers: S::PerConstraint<Lanes>,
}

/// Passes until they have converged, as an operation on lanes.
pub(crate) struct Passes<'a, S: MechanicalSystem, const K: usize> {
    pub(crate) step: &'a mut LaneStep<S, K>,
    pub(crate) start: &'a State<S>,
    pub(crate) first: FirstGuess<'a, S>,
}

impl<S: MechanicalSystem, const K: usize> LaneOperation for Passes<'_, S, K> {
    type Output = Result<LaneEnd<S>, NotConverged>;

    #[inline(always)]
    fn run<const FUSED: bool>(self) -> Self::Output {
        self.step.passes::<FUSED>(self.start, &self.first)
    }
}

impl<S: MechanicalSystem, const K: usize> LaneStep<S, K> {
    /// Whether the scene's steps are of this kind.
    pub(crate) const EXISTS: bool = S::STRUCTURE.is_separable_with_constant_mass();
    const IS_CONSTRAINED: bool = S::N_CONSTRAINTS > 0;
    const FORCE_IS_ON_V: bool = S::STRUCTURE.forces.exist() && S::STRUCTURE.forces.on.on_v;
    /// Whether forces, those of the constraints aside, change from pass to pass.
    const FORCE_VARIES: bool = !S::STRUCTURE.hessian.qq.is_empty()
        || (S::STRUCTURE.forces.exist() && (S::STRUCTURE.forces.on.on_q || S::STRUCTURE.forces.on.on_v));

    /// Passes end where the next one would move no point by more than `tolerance` of the configuration. `None` if the mass matrix is not positive
    /// definite: passes eliminate without pivoting; nor where masses are so small that squares of lengths in their metric vanish before lengths do.
    pub(crate) fn new(mechanics: &Mechanics<S>, h: f64, tolerance: f64) -> Option<Self> {
        let mass = mechanics.constant_mass();
        Cholesky::new::<S::PerCoordinate<f64>>(&mass)?;
        if (0..S::N_COORDINATES).any(|i| mass[i][i] < SMALLEST_MASS) {
            return None;
        }
        let inverse = CoordinateMatrix::<S>::inverse_of(&mass).ok()?;
        let is_coupled = |i: usize, j: usize| i == j || !<AsScene as Coupling<S>>::IS_DIAGONAL;
        let inverse_at = |i: usize, j: usize| if is_coupled(i, j) { inverse.at(i, j) } else { 0.0 };
        let couples_all = !<AsMass as Coupling<S>>::IS_DIAGONAL;
        let coupled = S::STRUCTURE.constraint_graph;
        let units: S::PerCoordinate<f64> = Array::from_fn(|i| unit(mass[i][i]));
        Some(Self {
            tolerance,
            constants: Array::from_fn(|i| Lanes::splat(mechanics.constants[i])),
            inverse_mass: CoordinateMatrix::new(Array::from_fn(|i| Array::from_fn(|j| inverse_at(i, j)))),
            legendre: ConstantLegendre::new(mechanics).ok()?,
            mobility: CoordinateMatrix::new(Array::from_fn(|i| Array::from_fn(|j| h * inverse_at(i, j)))),
            tables: ImpulseTables::new::<K>(h),
            has_light: has_light(units.as_ref()),
            units,
            gram: LaneGram::<S>::new(coupled.iter().copied(), couples_all),
            start_gram: LaneGram::<S>::new(coupled.iter().copied(), couples_all),
            ways: nothing(),
            impulses: nothing(),
            multipliers: nothing(),
        })
    }

    #[inline(always)]
    fn passes<const FUSED: bool>(
        &mut self,
        start: &State<S>,
        first: &FirstGuess<'_, S>,
    ) -> Result<LaneEnd<S>, NotConverged> {
        let times = self.tables.nodes + Lanes::splat(start.t);
        let times_of_points = times.with(K - 1, start.t);
        let inertial = self.inertial(start);
        let mut ways = self.first_ways::<FUSED>(first);
        let mut differences = self.differences::<FUSED>(&ways, &inertial);
        let mut positions = from_start::<S>(start, &differences);
        let mut points = self.points::<FUSED>(start, &differences);
        let mut nearest = points.clone();
        let mut multipliers: S::PerConstraint<Lanes> = nothing();
        let mut jacobian: S::PerJacobianEntry<Lanes> = nothing();
        if Self::IS_CONSTRAINED {
            // Before the first projection, so that its matrices are factored at the same time.
            let (_, at_points) = S::constraint_derivatives(&self.constants, times_of_points, &points);
            self.factor_start_gram::<FUSED>(&at_points);
        }
        let (per_reach, units) = self.metric(start);
        let mut progress = LinearProgress::to(self.tolerance);
        let mut is_stale = true;
        let mut passes = 0;
        loop {
            // Squares of lengths in these units.
            let mut squares = Lanes::ZERO;
            if Self::FORCE_VARIES {
                for i in 0..S::N_COORDINATES {
                    let moved = (points[i] - nearest[i]) * Lanes::splat(units[i]);
                    squares = moved.times_plus::<FUSED>(moved, squares);
                }
            }
            let mut shares: S::PerConstraint<Lanes> = nothing();
            nearest = points.clone();
            if Self::IS_CONSTRAINED {
                if is_stale {
                    (shares, jacobian) = S::constraint_derivatives(&self.constants, times, &positions);
                    self.factor_gram::<FUSED>(&jacobian);
                } else {
                    shares = S::constraints(&self.constants, times, &positions);
                }
                let residual = shares.clone();
                self.gram.solve::<FUSED>(&mut shares);
                // φᵀ S⁻¹ φ is the square of the displacement below.
                for c in 0..S::N_CONSTRAINTS {
                    squares = residual[c].times_plus::<FUSED>(shares[c], squares);
                }
                let displacements = self.displacements::<FUSED>(&jacobian, &shares);
                for i in 0..S::N_COORDINATES {
                    nearest[i] = points[i] - displacements[i];
                }
                if self.has_light {
                    for i in 0..S::N_COORDINATES {
                        let displaced = displacements[i] * Lanes::splat(units[i]);
                        squares = displaced.times_plus::<FUSED>(displaced, squares);
                    }
                }
            }
            let mut impulses = self.free_impulses::<FUSED>(start, times_of_points, &nearest, &ways);
            if Self::IS_CONSTRAINED {
                let (_, at_points) = S::constraint_derivatives(&self.constants, times_of_points, &nearest);
                if passes == 0 {
                    multipliers = self.implied_multipliers::<FUSED>(&at_points, &impulses, &ways);
                }
                for c in 0..S::N_CONSTRAINTS {
                    multipliers[c] = product::<K, FUSED>(&self.tables.impulses, shares[c], multipliers[c]);
                }
                self.subtract_constraint_force::<FUSED>(&at_points, &multipliers, &mut impulses);
            }
            ways = applied::<S, FUSED>(&self.mobility, &impulses);
            differences = self.differences::<FUSED>(&ways, &inertial);
            positions = from_start::<S>(start, &differences);
            points = self.points::<FUSED>(start, &differences);
            passes += 1;
            let square = squares.largest().abs() * per_reach;
            is_stale = square > STALE * STALE;
            // In the first pass nothing has moved yet.
            if (passes == 1 && Self::FORCE_VARIES) || !progress.has_converged(square)? {
                continue;
            }
            let mut difference: S::PerCoordinate<f64> = Array::filled(0.0);
            let mut sum = 0.0;
            for i in 0..S::N_COORDINATES {
                difference[i] = differences[i].to_array()[K - 1];
                sum += difference[i];
            }
            // Comparisons lose a NaN on the way; at the end of a step it arrives from every node.
            if !f64::is_finite(sum) {
                return Err(NotConverged { corrections: passes, last_correction: f64::NAN });
            }
            (self.ways, self.impulses, self.multipliers) = (ways, impulses, multipliers);
            return Ok(LaneEnd { difference, passes });
        }
    }

    /// One over the square of what a step from `start` is found to the round-off of, and the units of that metric.
    #[inline(always)]
    fn metric(&self, start: &State<S>) -> (f64, S::PerCoordinate<f64>) {
        let h = self.tables.nodes.to_array()[K - 1];
        let (mut here, mut way) = (Length::default(), Length::default());
        for i in 0..S::N_COORDINATES {
            here = here.with(self.units[i], start.q[i]);
            way = way.with(self.units[i], h * start.v[i]);
        }
        let reach = here.reach(way);
        (1.0 / (reach.metric * reach.metric), self.units_for(reach))
    }

    /// The units in which displacements are compared with this reach.
    #[inline(always)]
    fn units_for(&self, reach: Length) -> S::PerCoordinate<f64> {
        let mut units = self.units.clone();
        if self.has_light {
            for i in 0..S::N_COORDINATES {
                units[i] = larger(units[i], reach.least_unit());
            }
        }
        units
    }

    /// `cᵢ h M⁻¹ p₀`.
    #[inline(always)]
    fn inertial(&self, start: &State<S>) -> Nodes<S> {
        let drift = self.mobility.times(|i| self.legendre.moving_momentum(&start.p, i));
        let mut inertial: Nodes<S> = nothing();
        for i in 0..S::N_COORDINATES {
            inertial[i] = self.tables.fractions * Lanes::splat(drift[i]);
        }
        inertial
    }

    /// Where forces are evaluated: at the points with the start in the place of the end.
    #[inline(always)]
    fn points<const FUSED: bool>(&self, start: &State<S>, differences: &Nodes<S>) -> Nodes<S> {
        let mut points: Nodes<S> = nothing();
        for i in 0..S::N_COORDINATES {
            // Exactly `q₀` or `q₀ + d`; a lane that nothing reads would split the register that it is in.
            points[i] = differences[i].times_plus::<FUSED>(self.tables.inner, Lanes::splat(start.q[i]));
        }
        points
    }

    /// `qᵢ − q₀`, from the ways and `cᵢ h M⁻¹ p₀`.
    #[inline(always)]
    fn differences<const FUSED: bool>(&self, ways: &Nodes<S>, inertial: &Nodes<S>) -> Nodes<S> {
        let mut differences: Nodes<S> = nothing();
        for i in 0..S::N_COORDINATES {
            differences[i] = product::<K, FUSED>(&self.tables.shares, ways[i], inertial[i]);
        }
        differences
    }
}
