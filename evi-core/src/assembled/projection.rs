//! Momenta on the hidden constraints, and the velocities that belong to them.

use super::assembly::{Assembly, ConstraintsAt, Point, subtract_pull};
use super::elements::SecondWeights;
use super::gram::Gram;
use super::mass::ConstantMass;
use super::saddle::Saddle;
use super::scene::{ConstantInertia, PreparedScene, Space};
use crate::integrator::Tally;
use crate::linear::{SingularMatrix, largest_magnitude};
use crate::mechanics::{ProjectionError, relative};
use crate::newton;

/// Kinetic energy of the velocities that are removed, relative to that of the motion, up to which one projection does: the
/// velocities are then below 1/128 of the motion's.
const LARGEST_REST: f64 = 1.0 / 16384.0;

/// Of a saddle-point matrix with the mass.
pub(super) const MASS: SecondWeights<'static> =
    SecondWeights { vv: 1.0, vq: 0.0, qv: 0.0, qq: 0.0, fq: 0.0, fv: 0.0, curves: None };

impl PreparedScene {
    /// Moves `space.q` onto the constraints, from a point that is beside them by little, across them in the metric of the mass; overwrites `space.at_end`
    /// with the constraints there. `space.v` is a velocity, where the mass depends on it.
    pub(super) fn meet_constraints(&mut self, t: f64) -> Result<(), ProjectionError> {
        let Self { assembly, inertia, saddle, space, .. } = self;
        if assembly.n_constraints == 0 {
            return Ok(());
        }
        let n = assembly.n_coordinates;
        assembly.constraint_derivatives(t, &space.q, &mut space.at_end);
        match (inertia, saddle) {
            (Some(ConstantInertia { mass, gram }), _) => {
                gram.factor(mass, &space.at_end.slopes).map_err(|(_, matrix)| matrix)?;
                space.rates.copy_from_slice(&space.at_end.values);
                gram.solve(&mut space.rates);
                space.pull.fill(0.0);
                let (slopes, slots) = (&space.at_end.slopes, &assembly.slots);
                subtract_pull::<f64, false>(slots, slopes, &space.rates, &mut space.pull);
                mass.inverse_times(&space.pull, &mut space.moved);
            }
            (None, Some(saddle)) => {
                saddle.clear();
                saddle.add_second_derivatives(assembly, Point { t, q: &space.q, v: &space.v }, &MASS);
                saddle.set_constraints(&space.at_end, &space.at_end);
                saddle.factor()?;
                space.unknowns[..n].fill(0.0);
                let below = space.unknowns[n..].iter_mut();
                below.zip(&space.at_end.values).for_each(|(unknown, value)| *unknown = -value);
                saddle.solve(&mut space.unknowns);
                space.moved.copy_from_slice(&space.unknowns[..n]);
            }
            (None, None) => return Err(SingularMatrix { pivot_ratio: f64::NAN }.into()),
        }
        space.q.iter_mut().zip(&space.moved).for_each(|(q, moved)| *q += moved);
        assembly.constraint_derivatives(t, &space.q, &mut space.at_end);
        Ok(())
    }

    /// Removes from the momentum `space.p` at the end of a step the impulse `Gᵀ N` that leaves the constraints: solves
    /// `∂L/∂v(t, q, v) + Gᵀ N = p`, `G v + ∂φ/∂t = 0` with the constraints `space.at_end`, and overwrites `space.v` (Marsden & West, Acta
    /// Numerica 10 (2001), sec. 3.5). `N` is expected to be near `space.impulse`; `space.v` is the first guess where the mass depends on `v`.
    pub(super) fn project(&mut self, t: f64, tally: &mut impl Tally) -> Result<(), ProjectionError> {
        let Self { assembly, inertia, saddle, space, .. } = self;
        match (inertia, saddle) {
            (Some(ConstantInertia { mass, gram }), _) => {
                let pivot_ratio = gram.factor(mass, &space.at_end.slopes).map_err(|(_, matrix)| matrix)?;
                tally.see_pivot_ratio(pivot_ratio);
                project_on_constant_mass(assembly, mass, gram, space);
                Ok(())
            }
            (None, Some(saddle)) => project_by_saddle(assembly, saddle, space, t, tally),
            (None, None) => Err(SingularMatrix { pivot_ratio: f64::NAN }.into()),
        }
    }
}

/// With the factors of `G M⁻¹ Gᵀ`.
///
/// Near a turning point `v` is a small difference of large velocities, whose round-off would stay: the slowest motions are projected once more.
fn project_on_constant_mass(assembly: &Assembly, mass: &ConstantMass, gram: &Gram, space: &mut Space) {
    let Space { p, v, impulse, rates, at_end, .. } = space;
    mass.subtract_rest(p);
    subtract_pull::<f64, false>(&assembly.slots, &at_end.slopes, impulse, p);
    mass.inverse_times(p, v);
    if assembly.n_constraints > 0 {
        for _ in 0..2 {
            let removed = remove_rest(assembly, gram, at_end, p, v, rates, impulse);
            mass.inverse_times(p, v);
            let doubled_energy: f64 = p.iter().zip(v.iter()).map(|(p, v)| p * v).sum();
            let is_slow = removed > LARGEST_REST * doubled_energy;
            if !is_slow {
                break;
            }
        }
    }
    mass.add_rest(p);
}

/// Removes what leaves the constraints from `p`, and returns twice the kinetic energy that it had; overwrites `rates` and `impulse`.
fn remove_rest(
    assembly: &Assembly,
    gram: &Gram,
    at: &ConstraintsAt,
    p: &mut [f64],
    v: &[f64],
    rates: &mut [f64],
    impulse: &mut [f64],
) -> f64 {
    rates.copy_from_slice(&at.rates);
    assembly.add_rates(&at.slopes, v, rates);
    impulse.copy_from_slice(rates);
    gram.solve(impulse);
    subtract_pull::<f64, false>(&assembly.slots, &at.slopes, impulse, p);
    impulse.iter().zip(rates.iter()).map(|(impulse, rate)| impulse * rate).sum()
}

/// With the saddle-point matrix `[M Gᵀ; G 0]`: one solve where `L` is quadratic in `v`, and one more for what the first has left of the hidden
/// constraints; Newton's iteration else.
fn project_by_saddle(
    assembly: &Assembly,
    saddle: &mut Saddle,
    space: &mut Space,
    t: f64,
    tally: &mut impl Tally,
) -> Result<(), ProjectionError> {
    let n = assembly.n_coordinates;
    let mut correct = || -> Result<f64, ProjectionError> {
        let Space { q, v, p, force, momentum, impulse, unknowns, at_end, .. } = space;
        let at = Point { t, q, v };
        assembly.gradient(at, force, momentum);
        saddle.clear();
        saddle.add_second_derivatives(assembly, at, &MASS);
        saddle.set_constraints(at_end, at_end);
        tally.see_pivot_ratio(saddle.factor()?);
        for ((unknown, p), momentum) in unknowns.iter_mut().zip(p.iter()).zip(momentum.iter()) {
            *unknown = p - momentum;
        }
        set_rates(assembly, at_end, v, &mut unknowns[n..]);
        saddle.solve(unknowns);
        let length = largest_magnitude(unknowns[..n].iter().copied());
        // The impulse enters linearly: its value, not an increment, belongs to the corrected velocity.
        impulse.copy_from_slice(&unknowns[n..]);
        v.iter_mut().zip(&unknowns[..n]).for_each(|(v, correction)| *v += correction);
        if assembly.n_constraints > 0 {
            unknowns[..n].fill(0.0);
            set_rates(assembly, at_end, v, &mut unknowns[n..]);
            saddle.solve(unknowns);
            v.iter_mut().zip(&unknowns[..n]).for_each(|(v, correction)| *v += correction);
            impulse.iter_mut().zip(&unknowns[n..]).for_each(|(impulse, more)| *impulse += more);
        }
        Ok(relative(length, largest_magnitude(v.iter().copied())))
    };
    if assembly.traits.is_quadratic_in_velocity {
        correct()?;
    } else {
        newton::iterate(|_| correct())?;
    }
    subtract_pull::<f64, false>(&assembly.slots, &space.at_end.slopes, &space.impulse, &mut space.p);
    Ok(())
}

/// Overwrites `rates` with `−G v − ∂φ/∂t`.
fn set_rates(assembly: &Assembly, at: &ConstraintsAt, v: &[f64], rates: &mut [f64]) {
    rates.copy_from_slice(&at.rates);
    assembly.add_rates(&at.slopes, v, rates);
    rates.iter_mut().for_each(|rate| *rate = -*rate);
}
