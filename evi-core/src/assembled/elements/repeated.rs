//! A family of elements of one type.

use std::ops::Range;

use super::super::Point;
use super::super::sparse::Symmetric;
use super::loops::{self, AddForce, AddGradient, AddMass, Constraints, SubtractPull};
use super::{Elements, LanePoint, SecondWeights};
use crate::array::Array;
use crate::mechanics::{for_each_constraint_curvature, for_each_curved_pair};
use crate::memory::Digest;
use crate::scalar::{InstructionSet, Lanes, Scalar};
use crate::system::{MechanicalSystem, Structure, SystemReport};

/// One element: its constants, and where its coordinates lie.
pub(super) struct Element<E: MechanicalSystem> {
    pub(super) constants: E::PerConstant<f64>,
    pub(super) places: E::PerCoordinate<u32>,
}

/// The elements of a family.
pub(in super::super) struct Repeated<E: MechanicalSystem> {
    elements: Vec<Element<E>>,
    /// Those of the scene.
    inputs: E::PerInput<f64>,
    broken: Option<(usize, &'static str, f64)>,
}

impl<E: MechanicalSystem> Repeated<E> {
    pub(in super::super) fn new(elements: impl Iterator<Item = (E, E::PerCoordinate<usize>)>) -> Self {
        let mut broken = None;
        let prepare = |(index, (element, places)): (usize, (E, E::PerCoordinate<usize>))| {
            let parameters = element.parameters();
            for (name, &value) in E::PARAMETERS.iter().zip(parameters.as_ref()) {
                if broken.is_none() && !value.is_finite() {
                    broken = Some((index, *name, value));
                }
            }
            Element::new(&element, &places)
        };
        let elements = elements.enumerate().map(prepare).collect();
        Self { elements, inputs: Array::filled(0.0), broken }
    }

    /// Whether the velocity enters `∂L/∂q + f`.
    pub(super) const FORCE_IS_ON_V: bool = !E::STRUCTURE.hessian.vq.is_empty()
        || E::STRUCTURE.mass.on_q
        || (E::STRUCTURE.forces.exist() && E::STRUCTURE.forces.on.on_v);
}

impl<E: MechanicalSystem> Element<E> {
    pub(super) fn new(element: &E, places: &E::PerCoordinate<usize>) -> Self {
        Self {
            constants: E::constants(&element.parameters()),
            places: Array::from_fn(|i| u32::try_from(places[i]).unwrap_or(u32::MAX)),
        }
    }

    #[inline(always)]
    pub(super) fn gather<T: Scalar>(&self, of_scene: &[T]) -> E::PerCoordinate<T> {
        Array::from_fn(|i| of_scene[self.places[i] as usize])
    }

    #[inline(always)]
    pub(super) fn scatter<T: Scalar>(&self, local: &E::PerCoordinate<T>, sum: &mut [T]) {
        for i in 0..E::N_COORDINATES {
            let place = self.places[i] as usize;
            sum[place] = sum[place] + local[i];
        }
    }

    #[inline(always)]
    pub(super) fn constants<T: Scalar>(&self) -> E::PerConstant<T> {
        Array::from_fn(|i| T::from_f64(self.constants[i]))
    }
}

impl<E: MechanicalSystem> Elements for Repeated<E> {
    fn structure(&self) -> &'static Structure {
        &E::STRUCTURE
    }

    fn report(&self) -> SystemReport {
        E::REPORT
    }

    fn set_inputs(&mut self, inputs: &[f64]) {
        if E::N_INPUTS == inputs.len() {
            self.inputs.as_mut().copy_from_slice(inputs);
        }
    }

    fn n_inputs(&self) -> usize {
        E::N_INPUTS
    }

    fn count(&self) -> usize {
        self.elements.len()
    }

    fn n_coordinates(&self) -> usize {
        E::N_COORDINATES
    }

    fn n_constraints(&self) -> usize {
        E::N_CONSTRAINTS
    }

    fn place(&self, element: usize, coordinate: usize) -> usize {
        self.elements[element].places[coordinate] as usize
    }

    fn parameter_that_is_not_finite(&self) -> Option<(usize, &'static str, f64)> {
        self.broken
    }

    fn tell(&self, equations: &mut Digest, constants: &mut Vec<u64>) {
        E::REPORT.add_to(equations);
        equations.add(self.elements.len() as u64);
        for Element { constants: values, places } in &self.elements {
            places.as_ref().iter().for_each(|place| equations.add(u64::from(*place)));
            constants.extend(values.as_ref().iter().map(|value| value.to_bits()));
        }
    }

    fn energy(&self, at: Point<'_>) -> f64 {
        let energy = |element: &Element<E>| {
            let (q, v) = (element.gather(at.q), element.gather(at.v));
            let momentum = E::lagrangian_gradient(&element.constants, at.t, &q, &v).momentum;
            let action_rate: f64 = (0..E::N_COORDINATES).map(|i| momentum[i] * v[i]).sum();
            action_rate - E::lagrangian(&element.constants, at.t, &q, &v)
        };
        self.elements.iter().map(energy).sum()
    }

    fn add_gradient(&self, at: Point<'_>, force: &mut [f64], momentum: &mut [f64]) {
        for element in &self.elements {
            let (q, v) = (element.gather(at.q), element.gather(at.v));
            let mut local = E::lagrangian_gradient(&element.constants, at.t, &q, &v);
            if E::STRUCTURE.forces.exist() {
                let added = E::forces(&element.constants, at.t, &q, &v, &self.inputs);
                for &i in E::STRUCTURE.forces.forced {
                    local.force[i] += added[i];
                }
            }
            element.scatter(&local.force, force);
            element.scatter(&local.momentum, momentum);
        }
    }

    fn add_force(&self, at: Point<'_>, force: &mut [f64]) {
        loops::add_force::<E, f64>(&self.elements, (at.t, at.q, Some(at.v)), &self.inputs, force);
    }

    fn add_second_derivatives(
        &self,
        at: Point<'_>,
        weights: &SecondWeights<'_>,
        places: &[u32],
        entries: &mut [f64],
    ) {
        let structure = &E::STRUCTURE;
        let mut places = places.iter();
        for element in &self.elements {
            let (q, v) = (element.gather(at.q), element.gather(at.v));
            let constants = element.constants.as_ref();
            let (_, hessian) = E::lagrangian_derivatives(&element.constants, at.t, &q, &v);
            let mut add = |value: f64| {
                if let Some(&place) = places.next() {
                    entries[place as usize] += value;
                }
            };
            let place = |coordinate: usize| element.places[coordinate] as usize;
            type Weight<'w> = &'w dyn Fn(usize, usize) -> f64;
            let of_v: Weight<'_> = &|row, col| weights.vv(row, col);
            let of_q: Weight<'_> = &|row, col| weights.qq(row, col);
            for (block, weight) in [(structure.hessian.vv, of_v), (structure.hessian.qq, of_q)] {
                for entry in block {
                    let (row, col) = (place(entry.row), place(entry.col));
                    let value = entry.value(constants, hessian.as_ref());
                    add(weight(row, col) * value);
                    if entry.row != entry.col {
                        add(weight(col, row) * value);
                    }
                }
            }
            for entry in structure.hessian.vq {
                let (row, col) = (place(entry.row), place(entry.col));
                let value = entry.value(constants, hessian.as_ref());
                add(weights.vq(row, col) * value);
                add(weights.qv(col, row) * value);
            }
            if structure.forces.exist() {
                let (_, varying) = E::force_derivatives(&element.constants, at.t, &q, &v, &self.inputs);
                let of_q: Weight<'_> = &|row, col| weights.fq(row, col);
                let of_v: Weight<'_> = &|row, col| weights.fv(row, col);
                for (block, weight) in [(structure.forces.q, of_q), (structure.forces.v, of_v)] {
                    for entry in block {
                        let value = entry.value(constants, varying.as_ref());
                        add(weight(place(entry.row), place(entry.col)) * value);
                    }
                }
            }
        }
    }

    fn for_each_curved_pair(&self, visit: &mut dyn FnMut(usize, usize)) {
        for_each_curved_pair::<E>(visit);
    }

    fn add_bends(&self, t: f64, q: &[f64], multipliers: &[f64], places: &[u32], entries: &mut [f64]) {
        if E::N_CONSTRAINTS == 0 {
            return;
        }
        let mut places = places.iter();
        for (element, multipliers) in self.elements.iter().zip(multipliers.chunks_exact(E::N_CONSTRAINTS)) {
            let multipliers = Array::from_fn(|c| multipliers[c]);
            let at = (t, &element.gather(q));
            for_each_constraint_curvature::<E>(&element.constants, at, &multipliers, |_, _, value| {
                if let Some(&place) = places.next() {
                    entries[place as usize] += value;
                }
            });
        }
    }

    fn constraint_derivatives(
        &self,
        t: f64,
        q: &[f64],
        values: &mut [f64],
        slopes: &mut [f64],
        rates: &mut [f64],
    ) {
        // Where no constraint depends on time, nothing overwrites the zeros of the beginning.
        let rates = if E::STRUCTURE.jacobian.t.is_empty() { None } else { Some(rates) };
        loops::constraint_derivatives::<E, f64>(&self.elements, (t, q), values, slopes, rates);
    }

    fn constraints(&self, t: f64, q: &[f64], values: &mut [f64]) {
        loops::constraints::<E, f64>(&self.elements, t, q, values);
    }

    fn curvature(&self, at: Point<'_>, values: &mut [f64]) {
        if E::N_CONSTRAINTS == 0 {
            return;
        }
        for (element, values) in self.elements.iter().zip(values.chunks_exact_mut(E::N_CONSTRAINTS)) {
            let (q, v) = (element.gather(at.q), element.gather(at.v));
            let curvature = E::constraint_curvature(&element.constants, at.t, &q, &v);
            values.copy_from_slice(curvature.as_ref());
        }
    }

    fn add_lane_force(
        &self,
        instructions: InstructionSet,
        elements: Range<usize>,
        t: Lanes,
        q: &[Lanes],
        v: Option<&[Lanes]>,
        force: &mut [Lanes],
    ) {
        let elements = &self.elements[elements];
        instructions.run(AddForce { elements, at: (t, q, v), inputs: &self.inputs, force });
    }

    fn add_lane_gradient(
        &self,
        instructions: InstructionSet,
        at: LanePoint<'_>,
        force: &mut [Lanes],
        momentum: &mut [Lanes],
    ) {
        instructions.run(AddGradient { elements: &self.elements, at, inputs: &self.inputs, force, momentum });
    }

    fn add_lane_mass(
        &self,
        instructions: InstructionSet,
        at: LanePoint<'_>,
        places: &[u32],
        matrix: &mut Symmetric<Lanes>,
    ) {
        instructions.run(AddMass { elements: &self.elements, at, places, matrix });
    }

    fn lane_constraints(
        &self,
        instructions: InstructionSet,
        elements: Range<usize>,
        t: Lanes,
        q: &[Lanes],
        values: &mut [Lanes],
    ) {
        let elements = &self.elements[elements];
        instructions.run(Constraints { elements, at: (t, q), values, slopes: None });
    }

    fn lane_constraint_derivatives(
        &self,
        instructions: InstructionSet,
        t: Lanes,
        q: &[Lanes],
        values: &mut [Lanes],
        slopes: &mut [Lanes],
    ) {
        let slopes = Some(slopes);
        instructions.run(Constraints { elements: &self.elements, at: (t, q), values, slopes });
    }

    fn subtract_lane_pull(
        &self,
        instructions: InstructionSet,
        elements: Range<usize>,
        t: Lanes,
        q: &[Lanes],
        x: &[Lanes],
        force: &mut [Lanes],
    ) {
        instructions.run(SubtractPull { elements: &self.elements[elements], at: (t, q), x, force });
    }
}
