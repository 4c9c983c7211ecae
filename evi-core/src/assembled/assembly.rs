//! A scene whose elements have been prepared: what it adds up, at one point.

use std::ops::Range;

use super::elements::{Elements, ObservedElement, ObservedElements, Repeated, Term};
use super::number::Number;
use super::{AssembledSystem, AssemblyError, Family, FamilyVisitor, FrequencyVisitor, ObservedVisitor};
use crate::memory::memory;
use crate::scalar::Scalar;
use crate::system::Structure;

/// A point of a motion.
#[derive(Clone, Copy)]
pub(super) struct Point<'a> {
    pub(super) t: f64,
    pub(super) q: &'a [f64],
    pub(super) v: &'a [f64],
}

/// A scene, prepared.
pub(super) struct Assembly {
    pub(super) n_coordinates: usize,
    pub(super) n_constraints: usize,
    pub(super) families: Vec<PlacedFamily>,
    /// Terms of observed quantities, each with the quantity.
    observed: Vec<(usize, Box<dyn Term>)>,
    /// The frequencies of curves that the scene gives, with their coordinates.
    frequencies: Vec<(usize, f64)>,
    /// Constraint and coordinate of every slope.
    pub(super) slots: Vec<Slot>,
    pub(super) traits: Traits,
}

/// A family, and where its constraints and slopes stand among those of the scene.
pub(super) struct PlacedFamily {
    pub(super) elements: Box<dyn Elements>,
    pub(super) rows: Range<usize>,
    pub(super) slopes: Range<usize>,
}

/// A nonzero of the Jacobian of the constraints.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Slot {
    pub(super) row: u32,
    pub(super) col: u32,
}

/// What holds for all elements.
#[derive(Clone, Copy, Debug)]
pub(super) struct Traits {
    /// `L = ½ vᵀ M v + aᵀ v − V(t, q)` with constant `M` and `a`.
    pub(super) is_separable: bool,
    /// `L` is a polynomial of degree two in `v`.
    pub(super) is_quadratic_in_velocity: bool,
    /// `∂L/∂v = 0` at rest.
    pub(super) momentum_vanishes_at_rest: bool,
    /// Forces, those of the constraints aside, depend on positions.
    pub(super) force_is_on_q: bool,
    /// They depend on velocities.
    pub(super) force_is_on_v: bool,
    /// They depend on time.
    pub(super) force_is_on_t: bool,
    /// Some constraint depends on time.
    pub(super) constraints_are_on_t: bool,
    /// Forces depend on what the caller sets.
    pub(super) force_is_on_inputs: bool,
}

impl Traits {
    const OF_NOTHING: Self = Self {
        is_separable: true,
        is_quadratic_in_velocity: true,
        momentum_vanishes_at_rest: true,
        force_is_on_q: false,
        force_is_on_v: false,
        force_is_on_t: false,
        constraints_are_on_t: false,
        force_is_on_inputs: false,
    };

    /// Whether forces, those of the constraints aside, never change.
    pub(super) const fn has_uniform_force(&self) -> bool {
        !(self.force_is_on_q || self.force_is_on_v || self.force_is_on_t || self.force_is_on_inputs)
    }

    /// Whether they change while the nodes of a step are sought.
    pub(super) const fn force_varies(&self) -> bool {
        self.force_is_on_q || self.force_is_on_v
    }

    fn and(self, element: &Structure) -> Self {
        let on = element.forces.on;
        Self {
            is_separable: self.is_separable && element.is_separable_with_constant_mass(),
            is_quadratic_in_velocity: self.is_quadratic_in_velocity && element.is_quadratic_in_velocity(),
            momentum_vanishes_at_rest: self.momentum_vanishes_at_rest && element.momentum_vanishes_at_rest,
            force_is_on_q: self.force_is_on_q || !element.hessian.qq.is_empty() || on.on_q,
            force_is_on_v: self.force_is_on_v || !element.hessian.vq.is_empty() || on.on_v,
            force_is_on_t: self.force_is_on_t || element.lagrangian.on_t || on.on_t,
            constraints_are_on_t: self.constraints_are_on_t || element.constraints.on_t,
            force_is_on_inputs: self.force_is_on_inputs || element.forces.on_inputs,
        }
    }
}

/// Prepares the families that it sees.
struct Preparation<'a, S> {
    system: &'a S,
    families: Vec<Box<dyn Elements>>,
    observed: Vec<(usize, Box<dyn Term>)>,
    frequencies: Vec<(usize, f64)>,
}

impl<S> FrequencyVisitor<S> for Preparation<'_, S> {
    fn frequency<F: Family<S>>(&mut self) {
        for index in 0..F::count(self.system) {
            let element = ObservedElement::new(&F::element(self.system, index));
            let places = F::coordinates(self.system, index);
            self.frequencies.extend(places.as_ref().iter().map(|&place| (place, element.at_rest())));
        }
    }
}

impl<S> ObservedVisitor<S> for Preparation<'_, S> {
    fn term<F: Family<S>>(&mut self, quantity: usize) {
        let element = |index| (F::element(self.system, index), F::coordinates(self.system, index));
        let elements = (0..F::count(self.system)).map(element);
        self.observed.push((quantity, Box::new(ObservedElements::new(elements))));
    }
}

impl<S> FamilyVisitor<S> for Preparation<'_, S> {
    fn family<F: Family<S>>(&mut self) {
        let element = |index| (F::element(self.system, index), F::coordinates(self.system, index));
        self.families.push(Box::new(Repeated::new((0..F::count(self.system)).map(element))));
    }
}

impl Assembly {
    /// Prepares every element of `system`.
    ///
    /// # Errors
    /// [`AssemblyError`] for elements that lie elsewhere, or whose parameters are no numbers.
    pub(super) fn new<S: AssembledSystem>(system: &S) -> Result<Self, AssemblyError> {
        let (families, observed, frequencies) = (Vec::new(), Vec::new(), Vec::new());
        let mut preparation = Preparation { system, families, observed, frequencies };
        system.visit_families(&mut preparation);
        system.visit_observed(&mut preparation);
        system.visit_frequencies(&mut preparation);
        let Preparation { families: found, observed, frequencies, .. } = preparation;
        let n_coordinates = system.n_coordinates();
        let (mut rows, mut families, mut slots) = (0, Vec::new(), Vec::new());
        let mut traits = Traits::OF_NOTHING;
        for (family, elements) in found.into_iter().enumerate() {
            if let Some((element, name, value)) = elements.parameter_that_is_not_finite() {
                return Err(AssemblyError::Parameter { family, element, name, value });
            }
            let (expected, found) = (S::INPUTS.len(), elements.n_inputs());
            if found != 0 && found != expected {
                return Err(AssemblyError::Inputs { family, expected, found });
            }
            let (first_row, first_slope) = (rows, slots.len());
            for element in 0..elements.count() {
                check_places(system, n_coordinates, family, &*elements, element)?;
                for entry in elements.structure().jacobian.q {
                    let col = elements.place(element, entry.col);
                    slots.push(Slot { row: (rows + entry.row) as u32, col: col as u32 });
                }
                rows += elements.n_constraints();
            }
            if elements.count() > 0 {
                traits = traits.and(elements.structure());
            }
            families.push(PlacedFamily { elements, rows: first_row..rows, slopes: first_slope..slots.len() });
        }
        Ok(Self { n_coordinates, n_constraints: rows, families, observed, frequencies, slots, traits })
    }

    /// Sets what forces take from the caller.
    pub(super) fn set_inputs(&mut self, inputs: &[f64]) {
        self.families.iter_mut().for_each(|family| family.elements.set_inputs(inputs));
    }

    /// Overwrites the observed quantities.
    pub(super) fn observe(&self, at: Point<'_>, inputs: &[f64], quantities: &mut [f64]) {
        quantities.fill(0.0);
        for (quantity, term) in &self.observed {
            quantities[*quantity] += term.sum(at, inputs);
        }
    }

    /// The frequency of the curve of every coordinate, 0 for those without one; none where the scene gives none.
    pub(super) fn frequencies(&self) -> Option<Vec<f64>> {
        let mut of_coordinates = vec![0.0; self.n_coordinates];
        for &(place, frequency) in &self.frequencies {
            of_coordinates[place] = frequency;
        }
        (!self.frequencies.is_empty()).then_some(of_coordinates)
    }

    /// Whether neither `L` nor a force or a constraint depends on a coordinate.
    pub(super) fn free_coordinates(&self) -> Vec<bool> {
        let mut are_free = vec![true; self.n_coordinates];
        for PlacedFamily { elements, .. } in &self.families {
            for local in (0..elements.n_coordinates()).filter(|&local| !elements.structure().is_free(local)) {
                for element in 0..elements.count() {
                    are_free[elements.place(element, local)] = false;
                }
            }
        }
        are_free
    }

    /// Energy `H = v · ∂L/∂v − L`.
    pub(super) fn energy(&self, at: Point<'_>) -> f64 {
        self.families.iter().map(|family| family.elements.energy(at)).sum()
    }

    /// Overwrites `∂L/∂q + f` and `∂L/∂v`.
    pub(super) fn gradient(&self, at: Point<'_>, force: &mut [f64], momentum: &mut [f64]) {
        force.fill(0.0);
        momentum.fill(0.0);
        for family in &self.families {
            family.elements.add_gradient(at, force, momentum);
        }
    }

    /// Overwrites `∂L/∂q + f`.
    pub(super) fn force(&self, at: Point<'_>, force: &mut [f64]) {
        force.fill(0.0);
        for family in self.families.iter().filter(|family| family.has_force()) {
            family.elements.add_force(at, force);
        }
    }

    /// `∂L/∂q + f` at rest at the origin: everywhere, where it is uniform.
    pub(super) fn force_at_origin(&self) -> Vec<f64> {
        let (zero, mut force) = (vec![0.0; self.n_coordinates], vec![0.0; self.n_coordinates]);
        self.force(Point { t: 0.0, q: &zero, v: &zero }, &mut force);
        force
    }

    /// Overwrites `φ(t, q)`.
    pub(super) fn constraints(&self, t: f64, q: &[f64], values: &mut [f64]) {
        for family in self.families.iter().filter(|family| !family.rows.is_empty()) {
            family.elements.constraints(t, q, &mut values[family.rows.clone()]);
        }
    }

    /// Overwrites `φ(t, q)` and its derivatives.
    pub(super) fn constraint_derivatives(&self, t: f64, q: &[f64], at: &mut ConstraintsAt) {
        for family in self.families.iter().filter(|family| !family.rows.is_empty()) {
            let (rows, slopes) = (family.rows.clone(), family.slopes.clone());
            let values = &mut at.values[rows.clone()];
            family.elements.constraint_derivatives(t, q, values, &mut at.slopes[slopes], &mut at.rates[rows]);
        }
    }

    /// Overwrites `γ = vᵀ φ_qq v + 2 φ_qt v + φ_tt`.
    pub(super) fn curvature(&self, at: Point<'_>, values: &mut [f64]) {
        for family in self.families.iter().filter(|family| !family.rows.is_empty()) {
            family.elements.curvature(at, &mut values[family.rows.clone()]);
        }
    }

    /// Adds `G x` to `sum`.
    pub(super) fn add_rates(&self, slopes: &[f64], x: &[f64], sum: &mut [f64]) {
        for (slot, slope) in self.slots.iter().zip(slopes) {
            sum[slot.row as usize] += slope * x[slot.col as usize];
        }
    }

    /// `‖G_c‖`, the Euclidean norm of every constraint's gradient.
    pub(super) fn gradient_norms(&self, slopes: &[f64]) -> Vec<f64> {
        let mut squares = vec![0.0; self.n_constraints];
        for (slot, slope) in self.slots.iter().zip(slopes) {
            squares[slot.row as usize] += slope * slope;
        }
        squares.into_iter().map(Scalar::sqrt).collect()
    }
}

impl PlacedFamily {
    /// The constraints of some elements.
    #[inline(always)]
    pub(super) fn rows_of(&self, elements: Range<usize>) -> Range<usize> {
        let per_element = self.elements.n_constraints();
        self.rows.start + elements.start * per_element..self.rows.start + elements.end * per_element
    }

    /// Whether some force may act on its elements.
    pub(super) fn has_force(&self) -> bool {
        let structure = self.elements.structure();
        structure.potential != crate::system::Potential::Zero || structure.forces.exist()
    }
}

fn check_places<S: AssembledSystem>(
    system: &S,
    n_coordinates: usize,
    family: usize,
    elements: &dyn Elements,
    element: usize,
) -> Result<(), AssemblyError> {
    for coordinate in 0..elements.n_coordinates() {
        let place = elements.place(element, coordinate);
        if place >= n_coordinates {
            return Err(AssemblyError::Place { family, element, coordinate, place, n_coordinates });
        }
        if (0..coordinate).any(|other| elements.place(element, other) == place) {
            return Err(AssemblyError::RepeatedPlace {
                family,
                element,
                name: system.coordinate_name(place),
            });
        }
    }
    Ok(())
}

/// Subtracts `Gᵀ x` from `sum`.
#[inline(always)]
pub(super) fn subtract_pull<T: Number, const FUSED: bool>(
    slots: &[Slot],
    slopes: &[T],
    x: &[T],
    sum: &mut [T],
) {
    for (slot, &slope) in slots.iter().zip(slopes) {
        let col = slot.col as usize;
        sum[col] = sum[col].plus_product::<FUSED>(T::ZERO - slope, x[slot.row as usize]);
    }
}

/// The constraints at one point.
#[derive(Clone)]
pub(super) struct ConstraintsAt {
    /// `φ`.
    pub(super) values: Vec<f64>,
    /// The nonzeros of `∂φ/∂q`.
    pub(super) slopes: Vec<f64>,
    /// `∂φ/∂t`, zero for families without time.
    pub(super) rates: Vec<f64>,
}

memory!([] ConstraintsAt, |words| Self { values, slopes, rates } => {
    for numbers in [values, slopes, rates] {
        words.slice(numbers);
    }
});

impl ConstraintsAt {
    /// Storage for those of a scene.
    pub(super) fn of(assembly: &Assembly) -> Self {
        Self {
            values: vec![0.0; assembly.n_constraints],
            slopes: vec![0.0; assembly.slots.len()],
            rates: vec![0.0; assembly.n_constraints],
        }
    }
}
