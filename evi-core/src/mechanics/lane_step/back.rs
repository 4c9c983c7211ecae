//! A step gone back over: the transposed equations of its derivative, by passes like those of the step itself.
//!
//! A number that has the derivatives `γ` by the last point and `π` by `p⁻` has with `κⱼ` by the impulses of the nodes and `ρᵢ` by the points
//!
//! ```text
//! κⱼ = π + h M⁻¹ Σᵢ sᵢⱼ ρᵢ        Gⱼ κⱼ = 0        ρᵢ = Aᵢᵀ κᵢ − Gᵢᵀ νᵢ,   ρ_K = γ − G_Kᵀ ν_K        i = 1 .. K,   j = 0 .. K−1
//! ```
//!
//! where `Aᵢ = h bᵢ ∂(∂L/∂q + f)/∂q − ∂(Gᵀ Λᵢ)/∂q`. Tables are symmetric, `s_{K−i,K−j} = sⱼᵢ`: with the nodes counted from the end these are the equations of
//! a step whose forces are linear, and whose constraints are. Tables and passes are those of [`super::LaneStep`], matrices are made once.

use super::gram::applied;
use super::nodes::{Nodes, nothing, product};
use super::{LaneStep, Length, Mechanics, State};
use crate::array::Array;
use crate::mechanics::for_each_curved_pair;
use crate::newton::{LinearProgress, NotConverged, TARGET};
use crate::scalar::{InstructionSet, LANES, LaneOperation, Lanes};
use crate::system::MechanicalSystem;

/// What a step back is found from: the step, and the derivatives at its end.
pub(crate) struct Arrival<'a, S: MechanicalSystem, const K: usize> {
    pub(crate) start: &'a State<S>,
    /// `q_a − q₀`, from `a = 1` on.
    pub(crate) differences: &'a [S::PerCoordinate<f64>; K],
    /// `Λ_a`, from `a = 0` on.
    pub(crate) impulses: &'a [S::PerConstraint<f64>; K],
    /// `γ`.
    pub(crate) by_point: &'a S::PerCoordinate<f64>,
    /// `π`.
    pub(crate) by_momentum: &'a S::PerCoordinate<f64>,
}

/// The derivatives at the nodes of a step.
pub(crate) struct Departure<S: MechanicalSystem, const K: usize> {
    impulses: Nodes<S>,
    multipliers: S::PerConstraint<Lanes>,
    /// `Σᵢ ρᵢ`, `i = 1 .. K`.
    pub(crate) by_points: S::PerCoordinate<f64>,
}

impl<S: MechanicalSystem, const K: usize> Departure<S, K> {
    /// `κ` of a node before the last; that of the first one is the derivative by `p₀`.
    pub(crate) fn by_impulse(&self, node: usize) -> S::PerCoordinate<f64> {
        Array::from_fn(|i| self.impulses[i].to_array()[K - 1 - node])
    }

    /// `ν` of a point after the first.
    pub(crate) fn by_residual(&self, point: usize) -> S::PerConstraint<f64> {
        let lane = if point == K { K - 1 } else { K - 1 - point };
        Array::from_fn(|c| self.multipliers[c].to_array()[lane])
    }
}

/// Steps back of one scene, for one step size.
pub(crate) struct BackStep<S: MechanicalSystem, const K: usize> {
    step: LaneStep<S, K>,
    instructions: InstructionSet,
    /// `Aᵀ` by rows, and where it may be other than zero.
    rows: S::PerCoordinate<Nodes<S>>,
    is_filled: Filled<S>,
}

/// Which entries of a matrix over the coordinates may be other than zero.
type Filled<S> = <S as MechanicalSystem>::PerCoordinate<<S as MechanicalSystem>::PerCoordinate<bool>>;

impl<S: MechanicalSystem, const K: usize> BackStep<S, K> {
    /// Whether the scene's steps are gone back over so: forces on velocities couple the nodes in another way.
    pub(crate) const EXISTS: bool = LaneStep::<S, K>::EXISTS && !LaneStep::<S, K>::FORCE_IS_ON_V;

    /// `None` if the mass matrix is not positive definite.
    pub(crate) fn new(mechanics: &Mechanics<S>, h: f64) -> Option<Self> {
        if !Self::EXISTS {
            return None;
        }
        let mut is_filled: Filled<S> = Array::from_fn(|_| Array::from_fn(|_| false));
        for entry in S::STRUCTURE.hessian.qq {
            is_filled[entry.row][entry.col] = true;
            is_filled[entry.col][entry.row] = true;
        }
        for entry in S::STRUCTURE.forces.q {
            is_filled[entry.col][entry.row] = true;
        }
        for_each_curved_pair::<S>(|row, col| is_filled[row][col] = true);
        Some(Self {
            step: LaneStep::new(mechanics, h, TARGET)?,
            instructions: InstructionSet::detect(),
            rows: Array::from_fn(|_| nothing()),
            is_filled,
        })
    }

    /// `h b` of the first node and of the last.
    pub(crate) const fn end_weights(&self) -> [f64; 2] {
        let weights = self.step.tables.weights.to_array();
        [weights[K - 1], self.step.tables.last_weight]
    }

    /// The derivatives at the nodes.
    ///
    /// # Errors
    /// [`NotConverged`] of steps that are too large for passes.
    pub(crate) fn take(&mut self, arrival: &Arrival<'_, S, K>) -> Result<Departure<S, K>, NotConverged> {
        self.instructions.run(Back { step: self, arrival })
    }

    /// Overwrites `Aᵀ` at the nodes within the step; it is zero elsewhere.
    #[inline(always)]
    fn differentiate<const FUSED: bool>(
        &mut self,
        arrival: &Arrival<'_, S, K>,
        (times, points): (Lanes, &Nodes<S>),
    ) {
        let Self { step, rows, .. } = self;
        let (constants, tables) = (&step.constants, &step.tables);
        for row in 0..S::N_COORDINATES {
            rows[row] = nothing();
        }
        let weights = tables.weights * tables.inner;
        if !S::STRUCTURE.hessian.qq.is_empty() {
            let (_, hessian) = S::lagrangian_derivatives(constants, times, points, &nothing());
            S::for_each_qq(
                constants,
                &hessian,
                #[inline(always)]
                |row, col, value| rows[row][col] = weights * value,
            );
        }
        if S::STRUCTURE.forces.exist() && S::STRUCTURE.forces.on.on_q {
            let mut inputs: S::PerInput<Lanes> = nothing();
            for k in 0..S::N_INPUTS {
                inputs[k] = Lanes::splat(arrival.start.inputs[k]);
            }
            let (_, entries) = S::force_derivatives(constants, times, points, &nothing(), &inputs);
            for entry in S::STRUCTURE.forces.q {
                let value = entry.value(constants.as_ref(), entries.as_ref());
                let sum = &mut rows[entry.col][entry.row];
                *sum = weights.times_plus::<FUSED>(value, *sum);
            }
        }
        if S::N_CONSTRAINTS == 0 {
            return;
        }
        let mut multipliers: S::PerConstraint<Lanes> = nothing();
        for c in 0..S::N_CONSTRAINTS {
            let mut lanes = [0.0; LANES];
            for lane in 0..K - 1 {
                lanes[lane] = arrival.impulses[K - 1 - lane][c];
            }
            multipliers[c] = Lanes::new(lanes);
        }
        self.subtract_curvature::<FUSED>(times, points, &multipliers);
    }

    /// Subtracts `Σ Λ φ_qq`: of the quadratic polynomial `γ` of the velocity, `γ(a + b) − γ(a) − γ(b) + γ(0)` leaves twice its bilinear form.
    #[inline(always)]
    fn subtract_curvature<const FUSED: bool>(
        &mut self,
        times: Lanes,
        points: &Nodes<S>,
        multipliers: &S::PerConstraint<Lanes>,
    ) {
        let Self { step, rows, is_filled, .. } = self;
        let at_rest = S::constraint_curvature(&step.constants, times, points, &nothing());
        let mut along: S::PerCoordinate<S::PerConstraint<Lanes>> = Array::from_fn(|_| nothing());
        for i in 0..S::N_COORDINATES {
            let mut direction: Nodes<S> = nothing();
            direction[i] = Lanes::splat(1.0);
            along[i] = S::constraint_curvature(&step.constants, times, points, &direction);
        }
        for row in 0..S::N_COORDINATES {
            for col in 0..=row {
                if !is_filled[row][col] {
                    continue;
                }
                let mut direction: Nodes<S> = nothing();
                direction[row] = Lanes::splat(1.0);
                direction[col] = direction[col] + Lanes::splat(1.0);
                let along_both = S::constraint_curvature(&step.constants, times, points, &direction);
                let mut sum = Lanes::ZERO;
                for c in 0..S::N_CONSTRAINTS {
                    // Constraint by constraint, so that small whole numbers cancel exactly.
                    let bilinear = along_both[c] - (along[row][c] + along[col][c]) + at_rest[c];
                    sum = bilinear.times_plus::<FUSED>(multipliers[c], sum);
                }
                let half = Lanes::splat(0.5) * sum;
                rows[row][col] = rows[row][col] - half;
                if row != col {
                    rows[col][row] = rows[col][row] - half;
                }
            }
        }
    }

    /// `Aᵀ x` added to `sum`.
    #[inline(always)]
    fn add_force_change<const FUSED: bool>(&self, x: &Nodes<S>, sum: &mut Nodes<S>) {
        for row in 0..S::N_COORDINATES {
            for col in 0..S::N_COORDINATES {
                if self.is_filled[row][col] {
                    sum[row] = self.rows[row][col].times_plus::<FUSED>(x[col], sum[row]);
                }
            }
        }
    }

    /// Time and position of the nodes `K−1 .. 0`.
    #[inline(always)]
    fn nodes(&self, arrival: &Arrival<'_, S, K>) -> (Lanes, Nodes<S>) {
        let h_nodes = self.step.tables.nodes.to_array();
        let mut times = [arrival.start.t; LANES];
        for lane in 0..K - 1 {
            times[lane] += h_nodes[K - 2 - lane];
        }
        let mut points: Nodes<S> = nothing();
        for i in 0..S::N_COORDINATES {
            let mut lanes = [arrival.start.q[i]; LANES];
            for lane in 0..K - 1 {
                lanes[lane] += arrival.differences[K - 2 - lane][i];
            }
            points[i] = Lanes::new(lanes);
        }
        (Lanes::new(times), points)
    }

    #[inline(always)]
    fn passes<const FUSED: bool>(
        &mut self,
        arrival: &Arrival<'_, S, K>,
    ) -> Result<Departure<S, K>, NotConverged> {
        let n = S::N_COORDINATES;
        let (times, points) = self.nodes(arrival);
        self.differentiate::<FUSED>(arrival, (times, &points));
        // Where points have to be on the constraints, and where their forces act: at the end in the place of the start.
        let mut jacobian: S::PerJacobianEntry<Lanes> = nothing();
        let mut of_forces: S::PerJacobianEntry<Lanes> = nothing();
        if S::N_CONSTRAINTS > 0 {
            (_, jacobian) = S::constraint_derivatives(&self.step.constants, times, &points);
            self.step.factor_gram::<FUSED>(&jacobian);
            let mut ends = points;
            for i in 0..n {
                ends[i] = ends[i].with(K - 1, arrival.start.q[i] + arrival.differences[K - 1][i]);
            }
            let t_end = arrival.start.t + self.step.tables.nodes.to_array()[K - 1];
            let times = times.with(K - 1, t_end);
            (_, of_forces) = S::constraint_derivatives(&self.step.constants, times, &ends);
        }
        let (mut base, mut given): (Nodes<S>, Nodes<S>) = (nothing(), nothing());
        for i in 0..n {
            // Of no node, nothing: it would be measured against constraints.
            let mut lanes = [0.0; LANES];
            lanes[..K].fill(arrival.by_momentum[i]);
            base[i] = Lanes::new(lanes);
            given[i] = Lanes::ZERO.with(K - 1, arrival.by_point[i]);
        }
        let reach = self.reach(arrival);
        let per_reach = if reach.metric > 0.0 { 1.0 / (reach.metric * reach.metric) } else { 0.0 };
        let units = self.step.units_for(reach);
        let mut by_points = given.clone();
        self.add_force_change::<FUSED>(&base, &mut by_points);
        let mut ways = applied::<S, FUSED>(&self.step.mobility, &by_points);
        let mut by_impulses = self.step.differences::<FUSED>(&ways, &base);
        let mut nearest = base.clone();
        let mut multipliers: S::PerConstraint<Lanes> = nothing();
        let mut progress = LinearProgress::to(TARGET);
        loop {
            // Squares of lengths in these units.
            let mut squares = Lanes::ZERO;
            for i in 0..n {
                let moved = (by_impulses[i] - nearest[i]) * Lanes::splat(units[i]);
                squares = moved.times_plus::<FUSED>(moved, squares);
            }
            nearest = by_impulses.clone();
            if S::N_CONSTRAINTS > 0 {
                let mut shares: S::PerConstraint<Lanes> = nothing();
                S::for_each_slope(
                    &self.step.constants,
                    &jacobian,
                    #[inline(always)]
                    |row, col, slope| {
                        shares[row] = slope.times_plus::<FUSED>(by_impulses[col], shares[row]);
                    },
                );
                let residual = shares.clone();
                self.step.gram.solve::<FUSED>(&mut shares);
                let displacements = self.step.displacements::<FUSED>(&jacobian, &shares);
                for i in 0..n {
                    nearest[i] = nearest[i] - displacements[i];
                    if self.step.has_light {
                        let displaced = displacements[i] * Lanes::splat(units[i]);
                        squares = displaced.times_plus::<FUSED>(displaced, squares);
                    }
                }
                for c in 0..S::N_CONSTRAINTS {
                    squares = residual[c].times_plus::<FUSED>(shares[c], squares);
                    multipliers[c] =
                        product::<K, FUSED>(&self.step.tables.impulses, shares[c], multipliers[c]);
                }
            }
            by_points = given.clone();
            self.add_force_change::<FUSED>(&nearest, &mut by_points);
            if S::N_CONSTRAINTS > 0 {
                self.step.subtract_constraint_force::<FUSED>(&of_forces, &multipliers, &mut by_points);
            }
            ways = applied::<S, FUSED>(&self.step.mobility, &by_points);
            by_impulses = self.step.differences::<FUSED>(&ways, &base);
            if !progress.has_converged(squares.largest().abs() * per_reach)? {
                continue;
            }
            let mut sums = S::PerCoordinate::<f64>::filled(0.0);
            for i in 0..n {
                sums[i] = by_points[i].sum();
            }
            return Ok(Departure { impulses: by_impulses, multipliers, by_points: sums });
        }
    }

    /// What derivatives are found to the round-off of.
    #[inline(always)]
    fn reach(&self, arrival: &Arrival<'_, S, K>) -> Length {
        let way = self.step.mobility.times(|i| arrival.by_point[i]);
        let mut reach = Length::default();
        for i in 0..S::N_COORDINATES {
            reach = reach.with(self.step.units[i], arrival.by_momentum[i].abs() + way[i].abs());
        }
        reach
    }
}

/// A step back, as an operation on lanes.
struct Back<'a, S: MechanicalSystem, const K: usize> {
    step: &'a mut BackStep<S, K>,
    arrival: &'a Arrival<'a, S, K>,
}

impl<S: MechanicalSystem, const K: usize> LaneOperation for Back<'_, S, K> {
    type Output = Result<Departure<S, K>, NotConverged>;

    #[inline(always)]
    fn run<const FUSED: bool>(self) -> Self::Output {
        self.step.passes::<FUSED>(self.arrival)
    }
}
