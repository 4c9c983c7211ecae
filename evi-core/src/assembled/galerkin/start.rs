//! Accelerations and multipliers of the state that a step begins from.

use super::super::AssembledState;
use super::super::assembly::{Point, subtract_pull};
use super::super::projection::MASS;
use super::super::scene::{ConstantInertia, PreparedScene};
use crate::linear::SingularMatrix;

/// The share of a step over which momenta are differentiated where the mass varies: a first guess, of which it takes no more than some digits.
const SHARE: f64 = 1.0 / 64.0;

impl PreparedScene {
    /// Overwrites `space.at_start` with the constraints of the state, unless they are known.
    pub(super) fn know_start(&mut self, state: &AssembledState) {
        if !self.space.is_start_known {
            self.assembly.constraint_derivatives(state.t, &state.q, &mut self.space.at_start);
        }
        self.space.is_start_known = false;
    }

    /// Overwrites `space.moved` with the acceleration of the state, and `space.rates` with the multipliers: `M a + Gᵀ λ = ∂L/∂q + f − d(∂L/∂v)/dt` at
    /// constant velocity, `G a = −γ`. `space.at_start` holds the constraints.
    pub(super) fn set_acceleration(&mut self, state: &AssembledState, h: f64) -> Result<(), SingularMatrix> {
        let Self { assembly, inertia, saddle, space, .. } = self;
        let n = assembly.n_coordinates;
        let at = Point { t: state.t, q: &state.q, v: &state.v };
        let slopes = &space.at_start.slopes;
        match (inertia, saddle) {
            (Some(ConstantInertia { mass, gram }), _) => {
                assembly.force(at, &mut space.pull);
                mass.inverse_times(&space.pull, &mut space.moved);
                if assembly.n_constraints == 0 {
                    return Ok(());
                }
                gram.factor(mass, slopes).map_err(|(_, matrix)| matrix)?;
                assembly.curvature(at, &mut space.rates);
                assembly.add_rates(slopes, &space.moved, &mut space.rates);
                gram.solve(&mut space.rates);
                subtract_pull::<f64, false>(&assembly.slots, slopes, &space.rates, &mut space.pull);
                mass.inverse_times(&space.pull, &mut space.moved);
                Ok(())
            }
            (None, Some(saddle)) => {
                saddle.clear();
                saddle.add_second_derivatives(assembly, at, &MASS);
                saddle.set_constraints(&space.at_start, &space.at_start);
                saddle.factor()?;
                assembly.gradient(at, &mut space.force, &mut space.momentum);
                space.unknowns[..n].copy_from_slice(&space.force);
                if !assembly.traits.is_separable {
                    let way = SHARE * h;
                    for (sign, t) in [(1.0, state.t + way), (-1.0, state.t - way)] {
                        let near = space.q.iter_mut().zip(state.q.iter().zip(&state.v));
                        near.for_each(|(near, (q, v))| *near = q + sign * way * v);
                        assembly.gradient(
                            Point { t, q: &space.q, v: &state.v },
                            &mut space.force,
                            &mut space.momentum,
                        );
                        let change = space.unknowns.iter_mut().zip(&space.momentum);
                        change.for_each(|(unknown, p)| *unknown -= sign * p / (2.0 * way));
                    }
                }
                assembly.curvature(at, &mut space.rates);
                let below = space.unknowns[n..].iter_mut();
                below.zip(&space.rates).for_each(|(unknown, rate)| *unknown = -rate);
                saddle.solve(&mut space.unknowns);
                space.moved.copy_from_slice(&space.unknowns[..n]);
                space.rates.copy_from_slice(&space.unknowns[n..]);
                Ok(())
            }
            (None, None) => Err(SingularMatrix { pivot_ratio: f64::NAN }),
        }
    }
}
