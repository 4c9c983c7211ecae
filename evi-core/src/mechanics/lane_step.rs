//! A Galerkin step of a scene with constant mass by passes over all nodes at once, a node per lane.
//!
//! With the accelerations `aⱼ = M⁻¹ Fⱼ` of the total forces `Fⱼ = ∂L/∂q + f − Gᵀλⱼ` at the nodes, the tables of [`LaneTables`] and the Gram
//! matrices `Sᵢ = Gᵢ M⁻¹ Gᵢᵀ`, a pass is
//!
//! ```text
//! qᵢ = q₀ + h cᵢ v₀ + h² Σⱼ Bᵢⱼ aⱼ           ηᵢ = Sᵢ⁻¹ φ(qᵢ)           λ += (B⁻¹ η) / h²
//! q̃ᵢ = qᵢ − M⁻¹ Gᵢᵀ ηᵢ                        Fⱼ = ∂L/∂q(q̃ⱼ) + f(q̃ⱼ, vⱼ) − G(q̃ⱼ)ᵀ λⱼ
//! ```
//!
//! `B⁻¹ ⊗ Sᵢ⁻¹` stands for the inverse of the derivative `Gᵢ M⁻¹ Bᵢⱼ Gⱼᵀ` of the constraints by the multipliers: no matrix that couples nodes
//! is ever formed. A fixed point solves the equations of [`super::galerkin_equations`] exactly, whatever `Sᵢ` is and wherever the first pass begins;
//! a pass shrinks the error by about `4 (h ω)² ρ(B)`.

use super::{AsMass, AsScene, ConstantLegendre, CoordinateMatrix, Coupling, ForcePoint, Mechanics, State};
use crate::array::Array;
use crate::linear::{Cholesky, LaneGram};
use crate::newton::{NotConverged, Progress};
use crate::scalar::{LaneOperation, Lanes, Scalar};
use crate::scheme::{Columns, LaneTables, PAST};
use crate::system::{Entry, MechanicalSystem};

/// One value per coordinate at every node.
type Nodes<S> = <S as MechanicalSystem>::PerCoordinate<Lanes>;

/// The Gram matrices are made anew after a pass that has moved a point by more than this share of the configuration.
const STALE: f64 = 3e-3;

/// Up to so many entries of the Jacobian, loops over pairs of them are unrolled.
const MOST_UNROLLED: usize = 16;

/// The passes of one scene, for one step size.
pub(crate) struct LaneStep<S: MechanicalSystem, const K: usize> {
    /// Relative length of a last correction.
    tolerance: f64,
    constants: S::PerConstant<Lanes>,
    inverse_mass: CoordinateMatrix<S, AsMass>,
    pub(crate) legendre: ConstantLegendre<S>,
    tables: LaneTables,
    /// What a coordinate is multiplied with before lengths are compared: `√Mᵢᵢ` as a power of two.
    units: S::PerCoordinate<f64>,
    /// Of the nodes `1 .. K`.
    gram: LaneGram<S>,
    /// Of the nodes `0 .. K−1`.
    start_gram: LaneGram<S>,
    /// Entries of the Jacobian in one column: the products that Gram matrices of many constraints are made of.
    products: Vec<[Entry; 2]>,
    /// `aⱼ` of the last passes, `j = 0 .. K−1`.
    pub(crate) accelerations: Nodes<S>,
    /// `Fⱼ` of the last passes, `j = 0 .. K−1`.
    forces: Nodes<S>,
}

/// The end of a step before the constraints are met there to round-off.
pub(crate) struct LaneEnd<S: MechanicalSystem> {
    /// `q_K − q₀`.
    pub(crate) difference: S::PerCoordinate<f64>,
    /// Passes taken.
    pub(crate) passes: usize,
}

/// Passes until they have converged, as an operation on lanes.
pub(crate) struct Passes<'a, S: MechanicalSystem, const K: usize> {
    pub(crate) step: &'a mut LaneStep<S, K>,
    pub(crate) start: &'a State<S>,
    pub(crate) first: FirstGuess<'a, S>,
}

/// Where the passes begin.
pub(crate) enum FirstGuess<'a, S: MechanicalSystem> {
    /// From the accelerations of the last steps, the last one first.
    Continued(&'a [Nodes<S>; PAST]),
    /// From the acceleration of the state at every node.
    Constant(&'a S::PerCoordinate<f64>),
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
    /// definite: passes eliminate without pivoting.
    pub(crate) fn new(mechanics: &Mechanics<S>, h: f64, tolerance: f64) -> Option<Self> {
        let mass = mechanics.constant_mass();
        Cholesky::new::<S::PerCoordinate<f64>>(&mass)?;
        let inverse = CoordinateMatrix::<S>::inverse_of(&mass).ok()?;
        let is_coupled = |i: usize, j: usize| i == j || !<AsScene as Coupling<S>>::IS_DIAGONAL;
        let inverse_at = |i: usize, j: usize| if is_coupled(i, j) { inverse.at(i, j) } else { 0.0 };
        let couples_all = !<AsMass as Coupling<S>>::IS_DIAGONAL;
        let coupled = S::STRUCTURE.constraint_graph;
        let entries = S::STRUCTURE.jacobian.q;
        let pairs = entries.iter().flat_map(|a| entries.iter().map(move |b| [*a, *b]));
        Some(Self {
            tolerance,
            constants: Array::from_fn(|i| Lanes::splat(mechanics.constants[i])),
            inverse_mass: CoordinateMatrix::new(Array::from_fn(|i| Array::from_fn(|j| inverse_at(i, j)))),
            legendre: ConstantLegendre::new(mechanics).ok()?,
            tables: LaneTables::new::<K>(h),
            units: Array::from_fn(|i| unit(mass[i][i])),
            gram: LaneGram::<S>::new(coupled.iter().copied(), couples_all),
            start_gram: LaneGram::<S>::new(coupled.iter().copied(), couples_all),
            products: pairs.filter(|[a, b]| a.col == b.col && b.row <= a.row).collect(),
            accelerations: nothing(),
            forces: nothing(),
        })
    }

    #[inline(always)]
    fn passes<const FUSED: bool>(
        &mut self,
        start: &State<S>,
        first: &FirstGuess<'_, S>,
    ) -> Result<LaneEnd<S>, NotConverged> {
        let times = self.tables.nodes + Lanes::splat(start.t);
        let mut inertial: Nodes<S> = nothing();
        for i in 0..S::N_COORDINATES {
            inertial[i] = self.tables.nodes * Lanes::splat(start.v[i]);
        }
        let mut accelerations = self.first_accelerations::<FUSED>(first);
        let mut differences = self.differences::<FUSED>(&accelerations, &inertial);
        let mut positions = from_start::<S>(start, &differences);
        let mut nearest: Nodes<S> = nothing();
        let mut multipliers: S::PerConstraint<Lanes> = nothing();
        let mut jacobian: S::PerJacobianEntry<Lanes> = nothing();
        let per_reach = 1.0 / self.reach(start);
        let mut progress = Progress::default();
        let mut is_stale = true;
        let mut passes = 0;
        loop {
            // Squares of lengths in the metric of the mass matrix.
            let mut squares = Lanes::ZERO;
            if Self::FORCE_VARIES {
                for i in 0..S::N_COORDINATES {
                    let moved = (positions[i] - nearest[i]) * Lanes::splat(self.units[i]);
                    squares = moved.times_plus::<FUSED>(moved, squares);
                }
            }
            let mut shares: S::PerConstraint<Lanes> = nothing();
            nearest = positions.clone();
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
                let displacements = self.impelled::<FUSED>(&jacobian, &shares);
                for i in 0..S::N_COORDINATES {
                    nearest[i] = positions[i] - displacements[i];
                }
            }
            let forces = self.forces::<FUSED>(
                start,
                times.with(K - 1, start.t),
                &nearest,
                &accelerations,
                (passes == 0, &shares, &mut multipliers),
            );
            accelerations = self.accelerated::<FUSED>(&forces);
            differences = self.differences::<FUSED>(&accelerations, &inertial);
            positions = from_start::<S>(start, &differences);
            passes += 1;
            let length = Scalar::sqrt(squares.largest().abs()) * per_reach;
            is_stale = length > STALE;
            // In the first pass nothing has moved yet.
            if (passes == 1 && Self::FORCE_VARIES)
                || !progress.has_converged_linearly(length, self.tolerance)?
            {
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
            (self.accelerations, self.forces) = (accelerations, forces);
            return Ok(LaneEnd { difference, passes });
        }
    }

    #[inline(always)]
    fn first_accelerations<const FUSED: bool>(&self, first: &FirstGuess<'_, S>) -> Nodes<S> {
        let mut accelerations: Nodes<S> = nothing();
        match first {
            FirstGuess::Continued([last, before]) => {
                let [of_last, of_before] = &self.tables.prediction;
                for i in 0..S::N_COORDINATES {
                    let older = product::<K, FUSED>(of_before, before[i], Lanes::ZERO);
                    accelerations[i] = product::<K, FUSED>(of_last, last[i], older);
                }
            }
            FirstGuess::Constant(acceleration) => {
                for i in 0..S::N_COORDINATES {
                    accelerations[i] = Lanes::splat(acceleration[i]);
                }
            }
        }
        accelerations
    }

    /// `qᵢ − q₀`, from the accelerations and `h cᵢ v₀`.
    #[inline(always)]
    fn differences<const FUSED: bool>(&self, accelerations: &Nodes<S>, inertial: &Nodes<S>) -> Nodes<S> {
        let mut differences: Nodes<S> = nothing();
        for i in 0..S::N_COORDINATES {
            differences[i] = product::<K, FUSED>(&self.tables.positions, accelerations[i], inertial[i]);
        }
        differences
    }

    /// `Fⱼ` at the nodes before the last of points at the nodes `1 .. K`, with multipliers that take up the `shares` of the constraints'
    /// residual; in the first pass with those that the predicted accelerations imply.
    #[inline(always)]
    fn forces<const FUSED: bool>(
        &mut self,
        start: &State<S>,
        times: Lanes,
        points: &Nodes<S>,
        accelerations: &Nodes<S>,
        (is_first, shares, multipliers): (bool, &S::PerConstraint<Lanes>, &mut S::PerConstraint<Lanes>),
    ) -> Nodes<S> {
        let mut at: Nodes<S> = nothing();
        for i in 0..S::N_COORDINATES {
            at[i] = points[i].with(K - 1, start.q[i]);
        }
        let mut forces = S::lagrangian_gradient(&self.constants, times, &at, &nothing()).force;
        if S::STRUCTURE.forces.exist() {
            let mut velocities: Nodes<S> = nothing();
            if Self::FORCE_IS_ON_V {
                for i in 0..S::N_COORDINATES {
                    let v = Lanes::splat(start.v[i]);
                    velocities[i] = product::<K, FUSED>(&self.tables.velocities, accelerations[i], v);
                }
            }
            let mut inputs: S::PerInput<Lanes> = nothing();
            for i in 0..S::N_INPUTS {
                inputs[i] = Lanes::splat(start.inputs[i]);
            }
            let added = S::forces(&self.constants, times, &at, &velocities, &inputs);
            for &i in S::STRUCTURE.forces.forced {
                forces[i] = forces[i] + added[i];
            }
        }
        if Self::IS_CONSTRAINED {
            let (_, jacobian) = S::constraint_derivatives(&self.constants, times, &at);
            if is_first {
                self.imply_multipliers::<FUSED>(&jacobian, &forces, accelerations, multipliers);
            }
            for c in 0..S::N_CONSTRAINTS {
                multipliers[c] = product::<K, FUSED>(&self.tables.accelerations, shares[c], multipliers[c]);
            }
            for entry in S::STRUCTURE.jacobian.q {
                let slope = entry.value(self.constants.as_ref(), jacobian.as_ref());
                forces[entry.col] = (-slope).times_plus::<FUSED>(multipliers[entry.row], forces[entry.col]);
            }
        }
        forces
    }

    /// `λⱼ = Sⱼ⁻¹ Gⱼ (M⁻¹ fⱼ − aⱼ)`: the multipliers of the accelerations `aⱼ` under the other forces `fⱼ`.
    #[inline(always)]
    fn imply_multipliers<const FUSED: bool>(
        &mut self,
        jacobian: &S::PerJacobianEntry<Lanes>,
        forces: &Nodes<S>,
        accelerations: &Nodes<S>,
        multipliers: &mut S::PerConstraint<Lanes>,
    ) {
        add_gram::<S, FUSED>(
            &self.inverse_mass,
            &self.products,
            &self.constants,
            jacobian,
            &mut self.start_gram,
        );
        self.start_gram.factor::<FUSED>();
        let free = self.accelerated::<FUSED>(forces);
        *multipliers = nothing();
        for entry in S::STRUCTURE.jacobian.q {
            let slope = entry.value(self.constants.as_ref(), jacobian.as_ref());
            let held = free[entry.col] - accelerations[entry.col];
            multipliers[entry.row] = slope.times_plus::<FUSED>(held, multipliers[entry.row]);
        }
        self.start_gram.solve::<FUSED>(multipliers);
    }

    #[inline(always)]
    fn factor_gram<const FUSED: bool>(&mut self, jacobian: &S::PerJacobianEntry<Lanes>) {
        add_gram::<S, FUSED>(&self.inverse_mass, &self.products, &self.constants, jacobian, &mut self.gram);
        self.gram.factor::<FUSED>();
    }

    /// `M⁻¹ Gᵀ x`.
    #[inline(always)]
    fn impelled<const FUSED: bool>(
        &self,
        jacobian: &S::PerJacobianEntry<Lanes>,
        x: &S::PerConstraint<Lanes>,
    ) -> Nodes<S> {
        let mut sum: Nodes<S> = nothing();
        for entry in S::STRUCTURE.jacobian.q {
            let slope = entry.value(self.constants.as_ref(), jacobian.as_ref());
            sum[entry.col] = slope.times_plus::<FUSED>(x[entry.row], sum[entry.col]);
        }
        self.accelerated::<FUSED>(&sum)
    }

    /// `M⁻¹ F`.
    #[inline(always)]
    fn accelerated<const FUSED: bool>(&self, forces: &Nodes<S>) -> Nodes<S> {
        let mut accelerations: Nodes<S> = nothing();
        for i in 0..S::N_COORDINATES {
            if <AsMass as Coupling<S>>::IS_DIAGONAL {
                accelerations[i] = Lanes::splat(self.inverse_mass.at(i, i)) * forces[i];
            } else {
                for k in 0..S::N_COORDINATES {
                    let entry = Lanes::splat(self.inverse_mass.at(i, k));
                    accelerations[i] = entry.times_plus::<FUSED>(forces[k], accelerations[i]);
                }
            }
        }
        accelerations
    }

    /// What a step from `start` is found to the round-off of, in the same metric.
    #[inline(always)]
    fn reach(&self, start: &State<S>) -> f64 {
        let h = self.tables.nodes.to_array()[K - 1].abs();
        let (mut here, mut way) = (0.0, 0.0);
        for i in 0..S::N_COORDINATES {
            here = larger(self.units[i] * start.q[i].abs(), here);
            way = larger(self.units[i] * h * start.v[i].abs(), way);
        }
        reach(here, way)
    }

    /// `M⁻¹ F` at one node.
    #[inline]
    pub(crate) fn inverse_mass_times(&self, force: &S::PerCoordinate<f64>) -> S::PerCoordinate<f64> {
        self.inverse_mass.times(|i| force[i])
    }

    /// `p⁻ − p₀ = h Σⱼ bⱼ Fⱼ`, with the force at the end of the step, but for that of the constraints there, at `q_end`.
    pub(crate) fn momentum_gain(
        &self,
        mechanics: &Mechanics<S>,
        (start, t_end): (&State<S>, f64),
        q_end: &S::PerCoordinate<f64>,
    ) -> S::PerCoordinate<f64> {
        let mut velocity = start.v.clone();
        if Self::FORCE_IS_ON_V {
            for i in 0..S::N_COORDINATES {
                velocity[i] += (self.tables.end_velocity * self.accelerations[i]).sum();
            }
        }
        let mut gain = S::lagrangian_gradient(&mechanics.constants, t_end, q_end, &velocity).force;
        mechanics
            .add_force(ForcePoint { t: t_end, q: q_end, v: &velocity, inputs: &start.inputs }, &mut gain);
        for i in 0..S::N_COORDINATES {
            gain[i] = self.tables.last_weight * gain[i] + (self.tables.weights * self.forces[i]).sum();
        }
        gain
    }
}

/// Zeros; written as a copy, since what builds an array from a function is not always inlined.
#[inline(always)]
pub(super) fn nothing<A: Array<Lanes>>() -> A {
    A::filled(Lanes::ZERO)
}

/// The product of a table of `K` columns with a vector, added to `start`: two sums that do not wait for each other.
#[inline(always)]
pub(crate) fn product<const K: usize, const FUSED: bool>(columns: &Columns, x: Lanes, start: Lanes) -> Lanes {
    const SUMS: usize = 2;
    let x = x.to_array();
    let mut sums = [start, Lanes::ZERO];
    for col in 0..K {
        let factor = Lanes::splat(x[col]);
        let sum = &mut sums[col % SUMS];
        *sum = if 0 < col && col < SUMS {
            columns[col] * factor
        } else {
            columns[col].times_plus::<FUSED>(factor, *sum)
        };
    }
    sums[0] + sums[1]
}

/// `q₀ + d`.
#[inline(always)]
pub(super) fn from_start<S: MechanicalSystem>(start: &State<S>, differences: &Nodes<S>) -> Nodes<S> {
    let mut positions: Nodes<S> = nothing();
    for i in 0..S::N_COORDINATES {
        positions[i] = Lanes::splat(start.q[i]) + differences[i];
    }
    positions
}

/// Overwrites `gram` with `G M⁻¹ Gᵀ`, its lower triangle.
#[inline(always)]
fn add_gram<S: MechanicalSystem, const FUSED: bool>(
    inverse_mass: &CoordinateMatrix<S, AsMass>,
    products: &[[Entry; 2]],
    constants: &S::PerConstant<Lanes>,
    jacobian: &S::PerJacobianEntry<Lanes>,
    gram: &mut LaneGram<S>,
) {
    let entries = S::STRUCTURE.jacobian.q;
    let slope = |entry: &Entry| entry.value(constants.as_ref(), jacobian.as_ref());
    gram.clear();
    if <AsMass as Coupling<S>>::IS_DIAGONAL {
        if entries.len() <= MOST_UNROLLED {
            for a in entries {
                for b in entries {
                    if b.col == a.col && b.row <= a.row {
                        let scaled = Lanes::splat(inverse_mass.at(a.col, a.col)) * slope(a);
                        gram.add_product::<FUSED>(a.row, b.row, scaled, slope(b));
                    }
                }
            }
        } else {
            for [a, b] in products {
                let scaled = Lanes::splat(inverse_mass.at(a.col, a.col)) * slope(a);
                gram.add_product::<FUSED>(a.row, b.row, scaled, slope(b));
            }
        }
        return;
    }
    for col in 0..S::N_CONSTRAINTS {
        let mut direction: Nodes<S> = nothing();
        for entry in entries {
            if entry.row == col {
                for i in 0..S::N_COORDINATES {
                    let mass = Lanes::splat(inverse_mass.at(i, entry.col));
                    direction[i] = mass.times_plus::<FUSED>(slope(entry), direction[i]);
                }
            }
        }
        for entry in entries {
            if entry.row >= col {
                gram.add_product::<FUSED>(entry.row, col, slope(entry), direction[entry.col]);
            }
        }
    }
}

/// The length whose round-off the points of a step are found to: that of the configuration, less in steps that are short beside it, since what
/// points are off by, velocities are off by the `h`-th part of.
#[inline(always)]
pub(crate) fn reach(here: f64, way: f64) -> f64 {
    /// A step of an eighth of the configuration is not short.
    const LONG: f64 = 8.0;
    /// Points are sums of a configuration: closer is not to be had.
    const CLOSEST: f64 = 1.0 / 16.0;
    let here = here + way;
    let limited = if LONG * way < here { LONG * way } else { here };
    larger(limited, CLOSEST * here)
}

/// As the machine takes it: one instruction, where `f64::max` looks for a NaN.
#[inline(always)]
fn larger(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

/// `√mass` as a power of two.
fn unit(mass: f64) -> f64 {
    Scalar::sqrt(mass.abs()).log2().round().exp2()
}
