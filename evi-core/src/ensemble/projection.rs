//! The projection of eight momenta on the hidden constraints, for constant masses.

use super::kicks::LaneLegendre;
use super::lane_matrix::{LaneLu, Slopes};
use super::lane_state::{blend, nothing};
use super::mask::LaneMask;
use crate::mechanics::LARGEST_REST;
use crate::scalar::Lanes;
use crate::system::MechanicalSystem;

/// Velocities on the hidden constraints, with their momenta.
pub(super) struct Projected<S: MechanicalSystem> {
    pub(super) v: S::PerCoordinate<Lanes>,
    pub(super) p: S::PerCoordinate<Lanes>,
}

/// Removes the impulse `Gᵀ N` that leaves the constraints, `G M⁻¹ Gᵀ N = G v + ∂φ/∂t`, from the momenta, with the factors of that matrix. Where
/// what is removed is not small beside the motion, it is done again for the lane's sake.
#[inline(always)]
pub(super) fn project<S: MechanicalSystem, const FUSED: bool>(
    slopes: &Slopes<S>,
    legendre: &LaneLegendre<S>,
    gram: &LaneLu<S>,
    jacobian: &S::PerJacobianEntry<Lanes>,
    p: S::PerCoordinate<Lanes>,
    active: LaneMask,
) -> Projected<S> {
    let (mut projected, removed, energy) = remove_rest::<S, FUSED>(slopes, legendre, gram, jacobian, &p);
    // What is kept and what is removed are orthogonal in the metric of the masses: the energy that is kept need not be waited for.
    let allowed = Lanes::splat(LARGEST_REST) * (energy - removed);
    if !LaneMask::is_everywhere_at_most(removed, allowed) {
        let large = LaneMask::ALL.without(LaneMask::at_most(removed, allowed)).and(active);
        let (again, ..) = remove_rest::<S, FUSED>(slopes, legendre, gram, jacobian, &projected.p);
        blend(large, &again.v, &mut projected.v);
        blend(large, &again.p, &mut projected.p);
    }
    projected
}

/// The projected momenta, and twice the kinetic energies that are removed and that there were.
#[inline(always)]
fn remove_rest<S: MechanicalSystem, const FUSED: bool>(
    slopes: &Slopes<S>,
    legendre: &LaneLegendre<S>,
    gram: &LaneLu<S>,
    jacobian: &S::PerJacobianEntry<Lanes>,
    p: &S::PerCoordinate<Lanes>,
) -> (Projected<S>, Lanes, Lanes) {
    let v = legendre.velocity::<FUSED>(p);
    let moving = legendre.moving(p);
    let mut energy = Lanes::ZERO;
    for i in 0..S::N_COORDINATES {
        energy = moving[i].times_plus::<FUSED>(v[i], energy);
    }
    let rate = slopes.rate::<FUSED>(jacobian, &v);
    let mut impulse = rate.clone();
    gram.solve::<FUSED>(&mut impulse);
    let pull = slopes.pull::<FUSED>(jacobian, &impulse);
    let mut kept: S::PerCoordinate<Lanes> = nothing();
    for i in 0..S::N_COORDINATES {
        kept[i] = p[i] - pull[i];
    }
    let mut removed = Lanes::ZERO;
    for c in 0..S::N_CONSTRAINTS {
        removed = impulse[c].times_plus::<FUSED>(rate[c], removed);
    }
    (Projected { v: legendre.velocity::<FUSED>(&kept), p: kept }, removed, energy)
}
