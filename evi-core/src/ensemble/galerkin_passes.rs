//! The passes of Galerkin steps of eight members: predicted points, their projection on the constraints, and the accelerations there.
//!
//! A pass leaves accelerations at the nodes; the next one begins with the points that they lead to.

use super::galerkin_lanes::{GalerkinLanes, Vector};
use super::lane_state::{LaneState, blend, nothing};
use super::mask::LaneMask;
use crate::newton;
use crate::scalar::{Lanes, Scalar};
use crate::system::MechanicalSystem;

/// The Gram matrices are made anew after a pass that has moved a point by more than this share of the configuration.
pub(super) const STALE: f64 = 3e-3;
/// How the passes of eight members converge: the rule of `newton::Progress` for linear convergence, lane by lane.
pub(super) struct LaneProgress {
    tolerance: f64,
    pending: LaneMask,
    previous: Lanes,
    rate: Lanes,
}

impl LaneProgress {
    /// Of these lanes, to a `tolerance`.
    #[inline(always)]
    pub(super) const fn of(pending: LaneMask, tolerance: f64) -> Self {
        Self { tolerance, pending, previous: Lanes::ZERO, rate: Lanes::ZERO }
    }

    /// The lanes that have not converged.
    #[inline(always)]
    pub(super) const fn pending(&self) -> LaneMask {
        self.pending
    }

    /// Takes note of the relative `length` that the last pass has moved the points by.
    #[inline(always)]
    pub(super) fn record(&mut self, length: Lanes) {
        let one = Lanes::splat(1.0);
        let known = LaneMask::below(Lanes::ZERO, self.previous);
        let rate = known.select(length / self.previous, one);
        let slower = LaneMask::below(self.rate, rate).select(rate, self.rate);
        let slower = LaneMask::below(slower, one).select(slower, one);
        let solved = LaneMask::below(length * slower, Lanes::splat(self.tolerance));
        let stuck = LaneMask::below(Lanes::splat(newton::STAGNATION_RATIO) * self.previous, length)
            .and(LaneMask::at_most(length, Lanes::splat(newton::STAGNATION)))
            .and(known);
        self.pending = self.pending.without(solved.or(stuck));
        (self.previous, self.rate) = (length, rate);
    }
}

impl<S: MechanicalSystem, const K: usize> GalerkinLanes<S, K> {
    /// The accelerations that the last steps let expect.
    #[inline(always)]
    pub(super) fn predict<const FUSED: bool>(&mut self) {
        let [last, before] = &self.tables.prediction;
        for j in 0..K {
            let mut sum: Vector<S> = nothing();
            for k in 0..K {
                for i in 0..S::N_COORDINATES {
                    sum[i] = Lanes::splat(last[j][k]).times_plus::<FUSED>(self.past[0][k][i], sum[i]);
                    sum[i] = Lanes::splat(before[j][k]).times_plus::<FUSED>(self.past[1][k][i], sum[i]);
                }
            }
            self.accelerations[j] = sum;
        }
    }

    /// `q₀ + h cᵢ v₀ + h² Σⱼ Bᵢⱼ aⱼ` at the nodes from `first` on.
    #[inline(always)]
    pub(super) fn place<const FUSED: bool>(&mut self, state: &LaneState<S>, first: usize) {
        for node in first..K {
            let mut sum: Vector<S> = nothing();
            for i in 0..S::N_COORDINATES {
                sum[i] = Lanes::splat(self.tables.nodes[node]) * state.v[i];
            }
            let row = &self.tables.positions[node];
            for j in 0..K {
                let factor = Lanes::splat(row[j]);
                for i in 0..S::N_COORDINATES {
                    sum[i] = factor.times_plus::<FUSED>(self.accelerations[j][i], sum[i]);
                }
            }
            for i in 0..S::N_COORDINATES {
                sum[i] = state.q[i] + sum[i];
            }
            self.positions[node] = sum;
        }
    }

    /// Projects the points on the constraints; returns the squares of how far the farthest one has moved, in these units.
    /// Matrices are made anew for the lanes that are `stale`.
    #[inline(always)]
    pub(super) fn project_points<const FUSED: bool>(
        &mut self,
        t: f64,
        units: &Vector<S>,
        is_first: bool,
        stale: LaneMask,
        is_all_stale: bool,
    ) -> Lanes {
        let is_any_stale = is_all_stale || stale.is_any();
        for node in 0..K {
            let time = Lanes::splat(t + self.tables.nodes[node]);
            let position = self.positions[node].clone();
            let mut square = Lanes::ZERO;
            if Self::FORCE_VARIES && !is_first {
                for i in 0..S::N_COORDINATES {
                    let moved = (position[i] - self.nearest[node][i]) * units[i];
                    square = moved.times_plus::<FUSED>(moved, square);
                }
            }
            let mut nearest = position.clone();
            if Self::IS_CONSTRAINED {
                let residual = if is_any_stale {
                    let (residual, jacobian) =
                        S::constraint_derivatives(self.slopes.constants(), time, &position);
                    let inverse_mass = &self.legendre.inverse_mass;
                    if is_all_stale {
                        let gram = &mut self.grams[node];
                        self.slopes.gram::<_, FUSED>(&jacobian, inverse_mass, &jacobian, gram);
                        gram.factor::<FUSED>();
                        self.jacobians[node] = jacobian;
                    } else {
                        self.slopes.gram::<_, FUSED>(&jacobian, inverse_mass, &jacobian, &mut self.gram);
                        self.gram.factor::<FUSED>();
                        self.grams[node].blend(stale, &self.gram);
                        blend(stale, &jacobian, &mut self.jacobians[node]);
                    }
                    residual
                } else {
                    S::constraints(self.slopes.constants(), time, &position)
                };
                let mut shares = residual.clone();
                self.grams[node].solve::<FUSED>(&mut shares);
                // φᵀ S⁻¹ φ is the square of the displacement below.
                for c in 0..S::N_CONSTRAINTS {
                    square = residual[c].times_plus::<FUSED>(shares[c], square);
                }
                let pull = self.slopes.pull::<FUSED>(&self.jacobians[node], &shares);
                let displacement = self.legendre.inverse_mass.times::<FUSED>(&pull);
                for i in 0..S::N_COORDINATES {
                    nearest[i] = position[i] - displacement[i];
                }
                if let Some(light) = self.light {
                    for i in 0..S::N_COORDINATES {
                        let displaced = light.select(displacement[i] * units[i], Lanes::ZERO);
                        square = displaced.times_plus::<FUSED>(displaced, square);
                    }
                }
                self.shares[node] = shares;
            }
            self.nearest[node] = nearest;
            // Kept for each node, since what is carried from node to node the compiler takes apart, and the loop with it.
            self.squares[node] = square;
        }
        let mut farthest = Lanes::ZERO;
        for node in 0..K {
            farthest = farthest.larger(self.squares[node].abs());
        }
        farthest
    }

    /// Forces and accelerations at the nodes before the last, with multipliers that take up what points were beside the constraints; in the first
    /// pass with those that the predicted accelerations imply. Lanes in `frozen` keep theirs.
    #[inline(always)]
    pub(super) fn accelerate<const FUSED: bool>(
        &mut self,
        state: &LaneState<S>,
        is_first: bool,
        frozen: LaneMask,
    ) {
        let is_any_frozen = frozen.is_any();
        for j in 0..K {
            let is_start = j == K - 1;
            let time = Lanes::splat(if is_start { state.t } else { state.t + self.tables.nodes[j] });
            let point = if is_start { state.q.clone() } else { self.nearest[j].clone() };
            let mut force = S::lagrangian_gradient(self.slopes.constants(), time, &point, &nothing()).force;
            if Self::IS_CONSTRAINED {
                let (_, jacobian) = S::constraint_derivatives(self.slopes.constants(), time, &point);
                if is_first {
                    self.imply_multipliers::<FUSED>(j, is_start, &jacobian, &force);
                }
                let mut multipliers = self.multipliers[j].clone();
                let row = &self.tables.multipliers[j];
                for node in 0..K {
                    let factor = Lanes::splat(row[node]);
                    for c in 0..S::N_CONSTRAINTS {
                        multipliers[c] = factor.times_plus::<FUSED>(self.shares[node][c], multipliers[c]);
                    }
                }
                let pull = self.slopes.pull::<FUSED>(&jacobian, &multipliers);
                for i in 0..S::N_COORDINATES {
                    force[i] = force[i] - pull[i];
                }
                self.multipliers[j] = multipliers;
            }
            let acceleration = self.legendre.inverse_mass.times::<FUSED>(&force);
            if is_any_frozen {
                let going = LaneMask::ALL.without(frozen);
                blend(going, &acceleration, &mut self.accelerations[j]);
                blend(going, &force, &mut self.forces[j]);
            } else {
                (self.accelerations[j], self.forces[j]) = (acceleration, force);
            }
        }
    }

    /// `λⱼ = Sⱼ⁻¹ Gⱼ (M⁻¹ fⱼ − aⱼ)`: the multipliers of the accelerations `aⱼ` under the other forces `fⱼ`, with the matrices of the points before
    /// they were projected, which is near enough to begin with.
    #[inline(always)]
    fn imply_multipliers<const FUSED: bool>(
        &mut self,
        j: usize,
        is_start: bool,
        jacobian: &S::PerJacobianEntry<Lanes>,
        force: &Vector<S>,
    ) {
        let mut held = self.legendre.inverse_mass.times::<FUSED>(force);
        for i in 0..S::N_COORDINATES {
            held[i] = held[i] - self.accelerations[j][i];
        }
        let mut multipliers = self.slopes.along::<FUSED>(jacobian, &held);
        if is_start {
            self.slopes.gram::<_, FUSED>(jacobian, &self.legendre.inverse_mass, jacobian, &mut self.gram);
            self.gram.factor::<FUSED>();
            self.gram.solve::<FUSED>(&mut multipliers);
        } else {
            self.grams[j].solve::<FUSED>(&mut multipliers);
        }
        self.multipliers[j] = multipliers;
    }
}
