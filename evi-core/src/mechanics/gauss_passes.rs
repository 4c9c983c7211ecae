//! A Gauss step by passes over all nodes at once, a node per lane.
//!
//! In canonical variables, with velocities `Vᵢ` and forces `Wᵢ` at the nodes,
//!
//! ```text
//! Qᵢ = q₀ + h Σⱼ Aᵢⱼ Vⱼ        Pᵢ = p₀ + h Σⱼ Aᵢⱼ Wⱼ        ∂L/∂v(Qᵢ, Vᵢ) = Pᵢ        Wᵢ = ∂L/∂q(Qᵢ, Vᵢ) + f(Qᵢ, Vᵢ)
//! ```
//!
//! A pass evaluates `W`, `∂L/∂v` and the mass matrix at `(Q, V)` for the last `V`, takes `P` from `W`, and corrects `V` by a solve with the mass matrix at
//! every node.

use super::lane_step::product;
use super::reach::Length;
use super::{Mechanics, State};
use crate::array::Array;
use crate::linear::{LaneMass, factor_mass};
use crate::newton::{LinearProgress, NotConverged};
use crate::scalar::{LaneOperation, Lanes};
use crate::scheme::{GaussTables, PAST};
use crate::system::MechanicalSystem;

/// One value per coordinate at every node.
type Nodes<S> = <S as MechanicalSystem>::PerCoordinate<Lanes>;

/// What lengths are compared with is found anew after a pass that has moved a node by more than this share of it.
const STALE: f64 = 3e-3;

/// The passes of one scene, for one step size.
pub(crate) struct GaussPasses<S: MechanicalSystem, const K: usize> {
    constants: S::PerConstant<Lanes>,
    tables: GaussTables,
    mass: LaneMass<S>,
    /// `Vᵢ` of the last passes.
    pub(crate) velocities: Nodes<S>,
}

/// What a step changes.
pub(crate) struct GaussEnd<S: MechanicalSystem> {
    /// `q₁ − q₀`.
    pub(crate) difference: S::PerCoordinate<f64>,
    /// `p₁ − p₀`.
    pub(crate) gain: S::PerCoordinate<f64>,
    /// Passes taken.
    pub(crate) passes: usize,
}

/// Where the passes begin.
pub(crate) enum GaussGuess<'a, S: MechanicalSystem> {
    /// From the velocities of the last steps, the last one first.
    Continued(&'a [Nodes<S>; PAST]),
    /// From the acceleration of the state.
    Constant(&'a S::PerCoordinate<f64>),
}

/// Passes until they have converged, as an operation on lanes.
pub(crate) struct GaussIteration<'a, S: MechanicalSystem, const K: usize> {
    passes: &'a mut GaussPasses<S, K>,
    start: &'a State<S>,
    guess: GaussGuess<'a, S>,
}

impl<S: MechanicalSystem, const K: usize> LaneOperation for GaussIteration<'_, S, K> {
    type Output = Result<GaussEnd<S>, NotConverged>;

    #[inline(always)]
    fn run<const FUSED: bool>(self) -> Self::Output {
        self.passes.iterate::<FUSED>(self.start, &self.guess)
    }
}

impl<S: MechanicalSystem, const K: usize> GaussPasses<S, K> {
    pub(crate) fn new(mechanics: &Mechanics<S>, h: f64) -> Self {
        let nonzeros = S::STRUCTURE.hessian.vv.iter().map(|entry| (entry.col, entry.row));
        Self {
            constants: Array::from_fn(|i| Lanes::splat(mechanics.constants[i])),
            tables: GaussTables::new::<K>(h),
            mass: LaneMass::<S>::new(nonzeros, false),
            velocities: Array::filled(Lanes::ZERO),
        }
    }

    /// The passes of the step from `start`.
    pub(crate) fn from<'a>(
        &'a mut self,
        start: &'a State<S>,
        guess: GaussGuess<'a, S>,
    ) -> GaussIteration<'a, S, K> {
        GaussIteration { passes: self, start, guess }
    }

    #[inline(always)]
    fn iterate<const FUSED: bool>(
        &mut self,
        start: &State<S>,
        guess: &GaussGuess<'_, S>,
    ) -> Result<GaussEnd<S>, NotConverged> {
        let n = S::N_COORDINATES;
        let times = self.tables.nodes + Lanes::splat(start.t);
        let h = self.tables.weights.sum().abs();
        let mut velocities = self.first::<FUSED>(start, guess);
        let mut q = self.positions::<FUSED>(start, &velocities);
        let mut metric: Nodes<S> = Array::filled(Lanes::ZERO);
        let mut per_reach = 0.0;
        let mut is_stale = true;
        let mut progress = LinearProgress::default();
        let mut passes = 0;
        loop {
            let (mut gradient, hessian) = S::lagrangian_derivatives(&self.constants, times, &q, &velocities);
            self.add_forces(start, times, &q, &velocities, &mut gradient.force);
            let inertia = factor_mass::<S, FUSED>(&mut self.mass, &self.constants, &hessian);
            let mut correction: Nodes<S> = Array::filled(Lanes::ZERO);
            for i in 0..n {
                let p = product::<K, FUSED>(&self.tables.stages, gradient.force[i], Lanes::splat(start.p[i]));
                correction[i] = p - gradient.momentum[i];
            }
            self.mass.solve::<FUSED>(&mut correction);
            for i in 0..n {
                velocities[i] = velocities[i] + correction[i];
            }
            if is_stale {
                let [here, speed] = [&q, &velocities].map(|x| Length::of_nodes::<S>(&inertia, x));
                let reach = here.reach(speed.times(h));
                metric = reach.with_light::<S>(inertia);
                per_reach = h / reach.metric;
            }
            q = self.positions::<FUSED>(start, &velocities);
            passes += 1;
            let mut moves = Lanes::ZERO;
            for i in 0..n {
                moves = (metric[i] * correction[i]).times_plus::<FUSED>(correction[i], moves);
            }
            let moved = moves.largest();
            // Of a system that rests at the origin the reach is nothing, and no multiple of it.
            let square = if moved == 0.0 { 0.0 } else { moved * per_reach * per_reach };
            is_stale = square > STALE * STALE;
            if progress.has_converged(square)? {
                break;
            }
        }
        let mut forces = S::lagrangian_gradient(&self.constants, times, &q, &velocities).force;
        self.add_forces(start, times, &q, &velocities, &mut forces);
        let (mut difference, mut gain) =
            (S::PerCoordinate::<f64>::filled(0.0), S::PerCoordinate::<f64>::filled(0.0));
        let mut sum = 0.0;
        for i in 0..n {
            difference[i] = (self.tables.weights * velocities[i]).sum();
            gain[i] = (self.tables.weights * forces[i]).sum();
            sum += difference[i] + gain[i];
        }
        self.velocities = velocities;
        // Comparisons lose a NaN on the way; in the sums over all nodes it arrives.
        if !f64::is_finite(sum) {
            return Err(NotConverged { corrections: passes, last_correction: f64::NAN });
        }
        Ok(GaussEnd { difference, gain, passes })
    }

    /// `Qᵢ`.
    #[inline(always)]
    fn positions<const FUSED: bool>(&self, start: &State<S>, velocities: &Nodes<S>) -> Nodes<S> {
        let mut q: Nodes<S> = Array::filled(Lanes::ZERO);
        for i in 0..S::N_COORDINATES {
            let way = product::<K, FUSED>(&self.tables.stages, velocities[i], Lanes::ZERO);
            q[i] = Lanes::splat(start.q[i]) + way;
        }
        q
    }

    /// Adds `f` to `∂L/∂q`.
    #[inline(always)]
    fn add_forces(&self, start: &State<S>, times: Lanes, q: &Nodes<S>, v: &Nodes<S>, force: &mut Nodes<S>) {
        if S::STRUCTURE.forces.exist() {
            let mut inputs: S::PerInput<Lanes> = Array::filled(Lanes::ZERO);
            for i in 0..S::N_INPUTS {
                inputs[i] = Lanes::splat(start.inputs[i]);
            }
            let added = S::forces(&self.constants, times, q, v, &inputs);
            for &i in S::STRUCTURE.forces.forced {
                force[i] = force[i] + added[i];
            }
        }
    }

    #[inline(always)]
    fn first<const FUSED: bool>(&self, start: &State<S>, guess: &GaussGuess<'_, S>) -> Nodes<S> {
        let mut velocities: Nodes<S> = Array::filled(Lanes::ZERO);
        for i in 0..S::N_COORDINATES {
            velocities[i] = match guess {
                GaussGuess::Continued([last, before]) => {
                    let [of_last, of_before] = &self.tables.prediction;
                    let older = product::<K, FUSED>(of_before, before[i], Lanes::ZERO);
                    product::<K, FUSED>(of_last, last[i], older)
                }
                GaussGuess::Constant(acceleration) => {
                    let change = self.tables.nodes * Lanes::splat(acceleration[i]);
                    Lanes::splat(start.v[i]) + change
                }
            };
        }
        velocities
    }
}
