//! Loops over the kernels of all elements of a family, for numbers and for lanes.

use super::super::sparse::Symmetric;
use super::LanePoint;
use super::repeated::{Element, Repeated};
use crate::array::Array;
use crate::scalar::{LaneOperation, Lanes, Scalar};
use crate::system::{Entry, MechanicalSystem};

/// Adds `∂L/∂q + f` of all elements; at rest where no velocity is given.
#[inline(always)]
pub(super) fn add_force<E: MechanicalSystem, T: Scalar>(
    elements: &[Element<E>],
    (t, q, v): (T, &[T], Option<&[T]>),
    inputs: &E::PerInput<f64>,
    force: &mut [T],
) {
    let zero = T::from_f64(0.0);
    let inputs: E::PerInput<T> = Array::from_fn(|i| T::from_f64(inputs[i]));
    for element in elements {
        let constants = element.constants();
        let q = element.gather(q);
        let v = match v {
            Some(v) if Repeated::<E>::FORCE_IS_ON_V => element.gather(v),
            _ => E::PerCoordinate::<T>::filled(zero),
        };
        let mut local = E::lagrangian_gradient(&constants, t, &q, &v).force;
        if E::STRUCTURE.forces.exist() {
            let added = E::forces(&constants, t, &q, &v, &inputs);
            for &i in E::STRUCTURE.forces.forced {
                local[i] = local[i] + added[i];
            }
        }
        element.scatter(&local, force);
    }
}

#[inline(always)]
pub(super) fn constraints<E: MechanicalSystem, T: Scalar>(
    elements: &[Element<E>],
    t: T,
    q: &[T],
    values: &mut [T],
) {
    if E::N_CONSTRAINTS == 0 {
        return;
    }
    for (element, values) in elements.iter().zip(values.chunks_exact_mut(E::N_CONSTRAINTS)) {
        values.copy_from_slice(E::constraints(&element.constants(), t, &element.gather(q)).as_ref());
    }
}

#[inline(always)]
pub(super) fn constraint_derivatives<E: MechanicalSystem, T: Scalar>(
    elements: &[Element<E>],
    (t, q): (T, &[T]),
    values: &mut [T],
    slopes: &mut [T],
    mut rates: Option<&mut [T]>,
) {
    if E::N_CONSTRAINTS == 0 {
        return;
    }
    let entries: &[Entry] = E::STRUCTURE.jacobian.q;
    for (index, element) in elements.iter().enumerate() {
        let constants = element.constants();
        let (value, varying) = E::constraint_derivatives(&constants, t, &element.gather(q));
        let first = index * E::N_CONSTRAINTS;
        values[first..first + E::N_CONSTRAINTS].copy_from_slice(value.as_ref());
        let slopes = &mut slopes[index * entries.len()..(index + 1) * entries.len()];
        for (slope, entry) in slopes.iter_mut().zip(entries) {
            *slope = entry.value(constants.as_ref(), varying.as_ref());
        }
        if let Some(rates) = rates.as_deref_mut() {
            let rates = &mut rates[first..first + E::N_CONSTRAINTS];
            rates.fill(T::from_f64(0.0));
            for entry in E::STRUCTURE.jacobian.t {
                rates[entry.row] = rates[entry.row] + entry.value(constants.as_ref(), varying.as_ref());
            }
        }
    }
}

/// Subtracts `Gᵀ x` of all elements.
#[inline(always)]
fn subtract_pull<E: MechanicalSystem, const FUSED: bool>(
    elements: &[Element<E>],
    (t, q): (Lanes, &[Lanes]),
    x: &[Lanes],
    force: &mut [Lanes],
) {
    for (index, element) in elements.iter().enumerate() {
        let constants = element.constants();
        let (_, varying) = E::constraint_derivatives(&constants, t, &element.gather(q));
        let first = index * E::N_CONSTRAINTS;
        for entry in E::STRUCTURE.jacobian.q {
            let slope = entry.value(constants.as_ref(), varying.as_ref());
            let place = element.places[entry.col] as usize;
            force[place] = (-slope).times_plus::<FUSED>(x[first + entry.row], force[place]);
        }
    }
}

/// The pull of the constraints of all elements, as an operation on lanes.
pub(super) struct SubtractPull<'a, E: MechanicalSystem> {
    pub(super) elements: &'a [Element<E>],
    pub(super) at: (Lanes, &'a [Lanes]),
    pub(super) x: &'a [Lanes],
    pub(super) force: &'a mut [Lanes],
}

impl<E: MechanicalSystem> LaneOperation for SubtractPull<'_, E> {
    type Output = ();

    #[inline(always)]
    fn run<const FUSED: bool>(self) {
        subtract_pull::<E, FUSED>(self.elements, self.at, self.x, self.force);
    }
}

/// Forces of all elements, as an operation on lanes.
pub(super) struct AddForce<'a, E: MechanicalSystem> {
    pub(super) elements: &'a [Element<E>],
    pub(super) at: (Lanes, &'a [Lanes], Option<&'a [Lanes]>),
    pub(super) inputs: &'a E::PerInput<f64>,
    pub(super) force: &'a mut [Lanes],
}

impl<E: MechanicalSystem> LaneOperation for AddForce<'_, E> {
    type Output = ();

    #[inline(always)]
    fn run<const FUSED: bool>(self) {
        add_force::<E, Lanes>(self.elements, self.at, self.inputs, self.force);
    }
}

/// Forces and momenta of all elements, as an operation on lanes.
pub(super) struct AddGradient<'a, E: MechanicalSystem> {
    pub(super) elements: &'a [Element<E>],
    pub(super) at: LanePoint<'a>,
    pub(super) inputs: &'a E::PerInput<f64>,
    pub(super) force: &'a mut [Lanes],
    pub(super) momentum: &'a mut [Lanes],
}

impl<E: MechanicalSystem> LaneOperation for AddGradient<'_, E> {
    type Output = ();

    #[inline(always)]
    fn run<const FUSED: bool>(self) {
        let LanePoint { t, q, v } = self.at;
        let inputs: E::PerInput<Lanes> = Array::from_fn(|i| Lanes::splat(self.inputs[i]));
        for element in self.elements {
            let (constants, q, v) = (element.constants(), element.gather(q), element.gather(v));
            let mut local = E::lagrangian_gradient(&constants, t, &q, &v);
            if E::STRUCTURE.forces.exist() {
                let added = E::forces(&constants, t, &q, &v, &inputs);
                for &i in E::STRUCTURE.forces.forced {
                    local.force[i] = local.force[i] + added[i];
                }
            }
            element.scatter(&local.force, self.force);
            element.scatter(&local.momentum, self.momentum);
        }
    }
}

/// Masses of all elements, as an operation on lanes.
pub(super) struct AddMass<'a, E: MechanicalSystem> {
    pub(super) elements: &'a [Element<E>],
    pub(super) at: LanePoint<'a>,
    pub(super) places: &'a [u32],
    pub(super) matrix: &'a mut Symmetric<Lanes>,
}

impl<E: MechanicalSystem> LaneOperation for AddMass<'_, E> {
    type Output = ();

    #[inline(always)]
    fn run<const FUSED: bool>(self) {
        let entries = E::STRUCTURE.hessian.vv;
        if entries.is_empty() {
            return;
        }
        let LanePoint { t, q, v } = self.at;
        for (element, places) in self.elements.iter().zip(self.places.chunks_exact(entries.len())) {
            let constants = element.constants();
            let (_, hessian) =
                E::lagrangian_derivatives(&constants, t, &element.gather(q), &element.gather(v));
            for (&place, entry) in places.iter().zip(entries) {
                let value = entry.value(constants.as_ref(), hessian.as_ref());
                self.matrix.add::<FUSED>(place, value, Lanes::splat(1.0));
            }
        }
    }
}

/// Constraints of all elements, with slopes where they are asked for, as an operation on lanes.
pub(super) struct Constraints<'a, E: MechanicalSystem> {
    pub(super) elements: &'a [Element<E>],
    pub(super) at: (Lanes, &'a [Lanes]),
    pub(super) values: &'a mut [Lanes],
    pub(super) slopes: Option<&'a mut [Lanes]>,
}

impl<E: MechanicalSystem> LaneOperation for Constraints<'_, E> {
    type Output = ();

    #[inline(always)]
    fn run<const FUSED: bool>(self) {
        match self.slopes {
            Some(slopes) => {
                constraint_derivatives::<E, Lanes>(self.elements, self.at, self.values, slopes, None)
            }
            None => constraints::<E, Lanes>(self.elements, self.at.0, self.at.1, self.values),
        }
    }
}
