//! The elements of one family, prepared: their constants and places on the heap, and loops over their kernels.
//!
//! What is known of a scene's elements at compile time ends here: above, a family is a [`Elements`], and a run is the same code for every scene.

use super::Point;
use crate::array::Array;
use crate::scalar::{InstructionSet, LaneOperation, Lanes, Scalar};
use crate::system::{Entry, MechanicalSystem, Structure};

/// A family whose kernels add to vectors of the whole scene.
pub(super) trait Elements {
    /// What is known of one element.
    fn structure(&self) -> &'static Structure;

    /// Number of elements.
    fn count(&self) -> usize;

    /// Number of coordinates of an element.
    fn n_coordinates(&self) -> usize;

    /// Number of constraints of an element.
    fn n_constraints(&self) -> usize;

    /// Where a coordinate of an element lies.
    fn place(&self, element: usize, coordinate: usize) -> usize;

    /// The first parameter that is not finite: its element, name and value.
    fn parameter_that_is_not_finite(&self) -> Option<(usize, &'static str, f64)>;

    /// `Σ v · ∂L/∂v − L`.
    fn energy(&self, at: Point<'_>) -> f64;

    /// Adds `∂L/∂q + f` and `∂L/∂v`.
    fn add_gradient(&self, at: Point<'_>, force: &mut [f64], momentum: &mut [f64]);

    /// Adds `∂L/∂q + f`.
    fn add_force(&self, at: Point<'_>, force: &mut [f64]);

    /// Adds the second derivatives of `L` and `f`, each times its weight, to `entries`, at the `places` that follow each other as
    /// [`for_each_second_derivative`] does.
    fn add_second_derivatives(
        &self,
        at: Point<'_>,
        weights: &SecondWeights,
        places: &[u32],
        entries: &mut [f64],
    );

    /// Overwrites `φ`, the nonzero slopes `∂φ/∂q` of its pattern, and `∂φ/∂t` of this family.
    fn constraint_derivatives(
        &self,
        t: f64,
        q: &[f64],
        values: &mut [f64],
        slopes: &mut [f64],
        rates: &mut [f64],
    );

    /// Overwrites `φ` of this family.
    fn constraints(&self, t: f64, q: &[f64], values: &mut [f64]);

    /// Overwrites `γ = vᵀ φ_qq v + 2 φ_qt v + φ_tt` of this family.
    fn curvature(&self, at: Point<'_>, values: &mut [f64]);

    /// [`add_force`](Self::add_force) at a node per lane.
    fn add_lane_force(
        &self,
        instructions: InstructionSet,
        t: Lanes,
        q: &[Lanes],
        v: Option<&[Lanes]>,
        force: &mut [Lanes],
    );

    /// [`constraints`](Self::constraints) at a node per lane.
    fn lane_constraints(&self, instructions: InstructionSet, t: Lanes, q: &[Lanes], values: &mut [Lanes]);

    /// [`constraint_derivatives`](Self::constraint_derivatives) at a node per lane, without those by time.
    fn lane_constraint_derivatives(
        &self,
        instructions: InstructionSet,
        t: Lanes,
        q: &[Lanes],
        values: &mut [Lanes],
        slopes: &mut [Lanes],
    );

    /// Subtracts `Gᵀ x` from `force` at a node per lane.
    fn subtract_lane_pull(
        &self,
        instructions: InstructionSet,
        t: Lanes,
        q: &[Lanes],
        x: &[Lanes],
        force: &mut [Lanes],
    );
}

/// What second derivatives are multiplied with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct SecondWeights {
    /// `∂²L/∂v²`.
    pub(super) vv: f64,
    /// `∂²L/∂v∂q`, row of `v`.
    pub(super) vq: f64,
    /// `∂²L/∂q∂v`, row of `q`.
    pub(super) qv: f64,
    /// `∂²L/∂q²`.
    pub(super) qq: f64,
    /// `∂f/∂q`.
    pub(super) fq: f64,
    /// `∂f/∂v`.
    pub(super) fv: f64,
}

/// Calls `visit(row, col)` for every number that second derivatives of an element add to a matrix over coordinates.
pub(super) fn for_each_second_derivative(structure: &Structure, mut visit: impl FnMut(usize, usize)) {
    for block in [structure.hessian.vv, structure.hessian.qq] {
        for entry in block {
            visit(entry.row, entry.col);
            if entry.row != entry.col {
                visit(entry.col, entry.row);
            }
        }
    }
    for entry in structure.hessian.vq {
        visit(entry.row, entry.col);
        visit(entry.col, entry.row);
    }
    for entry in structure.forces.q.iter().chain(structure.forces.v) {
        visit(entry.row, entry.col);
    }
}

/// How many numbers that are.
pub(super) fn n_second_derivatives(structure: &Structure) -> usize {
    let mut count = 0;
    for_each_second_derivative(structure, |_, _| count += 1);
    count
}

/// One element: its constants, and where its coordinates lie.
struct Element<E: MechanicalSystem> {
    constants: E::PerConstant<f64>,
    places: E::PerCoordinate<u32>,
}

/// The elements of a family.
pub(super) struct Repeated<E: MechanicalSystem> {
    elements: Vec<Element<E>>,
    broken: Option<(usize, &'static str, f64)>,
}

impl<E: MechanicalSystem> Repeated<E> {
    const HAS_NO_INPUTS: () = assert!(E::N_INPUTS == 0, "elements of an assembled scene have no inputs");

    pub(super) fn new(elements: impl Iterator<Item = (E, E::PerCoordinate<usize>)>) -> Self {
        let () = Self::HAS_NO_INPUTS;
        let mut broken = None;
        let prepare = |(index, (element, places)): (usize, (E, E::PerCoordinate<usize>))| {
            let parameters = element.parameters();
            for (name, &value) in E::PARAMETERS.iter().zip(parameters.as_ref()) {
                if broken.is_none() && !value.is_finite() {
                    broken = Some((index, *name, value));
                }
            }
            Element {
                constants: E::constants(&parameters),
                places: Array::from_fn(|i| u32::try_from(places[i]).unwrap_or(u32::MAX)),
            }
        };
        let elements = elements.enumerate().map(prepare).collect();
        Self { elements, broken }
    }

    /// Whether the velocity enters `∂L/∂q + f`.
    const FORCE_IS_ON_V: bool = !E::STRUCTURE.hessian.vq.is_empty()
        || E::STRUCTURE.mass.on_q
        || (E::STRUCTURE.forces.exist() && E::STRUCTURE.forces.on.on_v);
}

impl<E: MechanicalSystem> Element<E> {
    #[inline(always)]
    fn gather<T: Scalar>(&self, of_scene: &[T]) -> E::PerCoordinate<T> {
        Array::from_fn(|i| of_scene[self.places[i] as usize])
    }

    #[inline(always)]
    fn scatter<T: Scalar>(&self, local: &E::PerCoordinate<T>, sum: &mut [T]) {
        for i in 0..E::N_COORDINATES {
            let place = self.places[i] as usize;
            sum[place] = sum[place] + local[i];
        }
    }

    #[inline(always)]
    fn constants<T: Scalar>(&self) -> E::PerConstant<T> {
        Array::from_fn(|i| T::from_f64(self.constants[i]))
    }
}

/// Adds `∂L/∂q + f` of all elements; at rest where no velocity is given.
#[inline(always)]
fn add_force<E: MechanicalSystem, T: Scalar>(
    elements: &[Element<E>],
    (t, q, v): (T, &[T], Option<&[T]>),
    force: &mut [T],
) {
    let zero = T::from_f64(0.0);
    for element in elements {
        let constants = element.constants();
        let q = element.gather(q);
        let v = match v {
            Some(v) if Repeated::<E>::FORCE_IS_ON_V => element.gather(v),
            _ => E::PerCoordinate::<T>::filled(zero),
        };
        let mut local = E::lagrangian_gradient(&constants, t, &q, &v).force;
        if E::STRUCTURE.forces.exist() {
            let added = E::forces(&constants, t, &q, &v, &E::PerInput::<T>::filled(zero));
            for &i in E::STRUCTURE.forces.forced {
                local[i] = local[i] + added[i];
            }
        }
        element.scatter(&local, force);
    }
}

#[inline(always)]
fn constraints<E: MechanicalSystem, T: Scalar>(elements: &[Element<E>], t: T, q: &[T], values: &mut [T]) {
    if E::N_CONSTRAINTS == 0 {
        return;
    }
    for (element, values) in elements.iter().zip(values.chunks_exact_mut(E::N_CONSTRAINTS)) {
        values.copy_from_slice(E::constraints(&element.constants(), t, &element.gather(q)).as_ref());
    }
}

#[inline(always)]
fn constraint_derivatives<E: MechanicalSystem, T: Scalar>(
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

impl<E: MechanicalSystem> Elements for Repeated<E> {
    fn structure(&self) -> &'static Structure {
        &E::STRUCTURE
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
                let none = E::PerInput::<f64>::filled(0.0);
                let added = E::forces(&element.constants, at.t, &q, &v, &none);
                for &i in E::STRUCTURE.forces.forced {
                    local.force[i] += added[i];
                }
            }
            element.scatter(&local.force, force);
            element.scatter(&local.momentum, momentum);
        }
    }

    fn add_force(&self, at: Point<'_>, force: &mut [f64]) {
        add_force::<E, f64>(&self.elements, (at.t, at.q, Some(at.v)), force);
    }

    fn add_second_derivatives(
        &self,
        at: Point<'_>,
        weights: &SecondWeights,
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
            for (block, weight) in [(structure.hessian.vv, weights.vv), (structure.hessian.qq, weights.qq)] {
                for entry in block {
                    let value = weight * entry.value(constants, hessian.as_ref());
                    add(value);
                    if entry.row != entry.col {
                        add(value);
                    }
                }
            }
            for entry in structure.hessian.vq {
                let value = entry.value(constants, hessian.as_ref());
                add(weights.vq * value);
                add(weights.qv * value);
            }
            if structure.forces.exist() {
                let none = E::PerInput::<f64>::filled(0.0);
                let (_, varying) = E::force_derivatives(&element.constants, at.t, &q, &v, &none);
                for (block, weight) in [(structure.forces.q, weights.fq), (structure.forces.v, weights.fv)] {
                    for entry in block {
                        add(weight * entry.value(constants, varying.as_ref()));
                    }
                }
            }
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
        constraint_derivatives::<E, f64>(&self.elements, (t, q), values, slopes, rates);
    }

    fn constraints(&self, t: f64, q: &[f64], values: &mut [f64]) {
        constraints::<E, f64>(&self.elements, t, q, values);
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
        t: Lanes,
        q: &[Lanes],
        v: Option<&[Lanes]>,
        force: &mut [Lanes],
    ) {
        instructions.run(AddForce { elements: &self.elements, at: (t, q, v), force });
    }

    fn lane_constraints(&self, instructions: InstructionSet, t: Lanes, q: &[Lanes], values: &mut [Lanes]) {
        instructions.run(Constraints { elements: &self.elements, at: (t, q), values, slopes: None });
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
        t: Lanes,
        q: &[Lanes],
        x: &[Lanes],
        force: &mut [Lanes],
    ) {
        instructions.run(SubtractPull { elements: &self.elements, at: (t, q), x, force });
    }
}

/// The pull of the constraints of all elements, as an operation on lanes.
struct SubtractPull<'a, E: MechanicalSystem> {
    elements: &'a [Element<E>],
    at: (Lanes, &'a [Lanes]),
    x: &'a [Lanes],
    force: &'a mut [Lanes],
}

impl<E: MechanicalSystem> LaneOperation for SubtractPull<'_, E> {
    type Output = ();

    #[inline(always)]
    fn run<const FUSED: bool>(self) {
        subtract_pull::<E, FUSED>(self.elements, self.at, self.x, self.force);
    }
}

/// Forces of all elements, as an operation on lanes.
struct AddForce<'a, E: MechanicalSystem> {
    elements: &'a [Element<E>],
    at: (Lanes, &'a [Lanes], Option<&'a [Lanes]>),
    force: &'a mut [Lanes],
}

impl<E: MechanicalSystem> LaneOperation for AddForce<'_, E> {
    type Output = ();

    #[inline(always)]
    fn run<const FUSED: bool>(self) {
        add_force::<E, Lanes>(self.elements, self.at, self.force);
    }
}

/// Constraints of all elements, with slopes where they are asked for, as an operation on lanes.
struct Constraints<'a, E: MechanicalSystem> {
    elements: &'a [Element<E>],
    at: (Lanes, &'a [Lanes]),
    values: &'a mut [Lanes],
    slopes: Option<&'a mut [Lanes]>,
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
