//! Terms of observed quantities.

use super::super::Point;
use super::repeated::Element;
use crate::array::Array;
use crate::system::MechanicalSystem;

/// A sum over elements that a quantity has as a term.
pub(in super::super) trait Term {
    /// `Σ` of what is observed, of the elements with these inputs of the scene.
    fn sum(&self, at: Point<'_>, inputs: &[f64]) -> f64;
}

/// An element that observes what depends on parameters alone.
pub(in super::super) struct ObservedElement<E: MechanicalSystem>(E::PerConstant<f64>);

impl<E: MechanicalSystem> ObservedElement<E> {
    pub(in super::super) fn new(element: &E) -> Self {
        Self(E::constants(&element.parameters()))
    }

    /// `Σ` of what is observed, at rest at the origin at time 0.
    pub(in super::super) fn at_rest(&self) -> f64 {
        let zero = E::PerCoordinate::<f64>::filled(0.0);
        let inputs = E::PerInput::<f64>::filled(0.0);
        E::observables(&self.0, 0.0, &zero, &zero, &inputs).as_ref().iter().sum()
    }
}

/// Elements that observe.
pub(in super::super) struct ObservedElements<E: MechanicalSystem>(Vec<Element<E>>);

impl<E: MechanicalSystem> ObservedElements<E> {
    pub(in super::super) fn new(elements: impl Iterator<Item = (E, E::PerCoordinate<usize>)>) -> Self {
        Self(elements.map(|(element, places)| Element::new(&element, &places)).collect())
    }
}

impl<E: MechanicalSystem> Term for ObservedElements<E> {
    fn sum(&self, at: Point<'_>, inputs: &[f64]) -> f64 {
        let inputs: E::PerInput<f64> = Array::from_fn(|i| inputs[i]);
        let of_element = |element: &Element<E>| -> f64 {
            let (q, v) = (element.gather(at.q), element.gather(at.v));
            E::observables(&element.constants, at.t, &q, &v, &inputs).as_ref().iter().sum()
        };
        self.0.iter().map(of_element).sum()
    }
}
