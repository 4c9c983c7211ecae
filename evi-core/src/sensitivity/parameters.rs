//! Which parameters a result is differentiated by, and what they do to the constants of the equations.
//!
//! The kernels are generic over the constants too: evaluated on [`Tangent`] constants they give their derivatives by parameters, exactly. What depends on
//! parameters alone is differentiated here, once per run.

use std::vec::Vec;

use super::DerivativeError;
use super::evaluation::{forced_gradient, still};
use crate::array::Array;
use crate::mechanics::{Mechanics, State};
use crate::scalar::{Rate, Rates, Tangent};
use crate::system::{LagrangianGradient, MechanicalSystem};

/// How many derivatives by parameters or inputs one evaluation of a kernel gives.
pub(super) const ABREAST: usize = 4;

/// Constants with rates along one direction.
pub(super) type MovingConstants<S> = <S as MechanicalSystem>::PerConstant<Tangent>;
/// Constants with rates along several directions.
type ConstantsAbreast<S> = <S as MechanicalSystem>::PerConstant<Tangent<Rates<ABREAST>>>;

/// Some of the parameters of a scene, by their names: those that derivatives are wanted by.
///
/// ```
/// use evi_core::sensitivity::ParameterChoice;
/// # use evi_core::prelude::*;
/// # #[derive(MechanicalSystem)]
/// # #[evi(coordinates(x), kinetic = 0.5 * m * der(x).powi(2), potential = 0.5 * k * x.powi(2))]
/// # struct Oscillator { m: f64, k: f64 }
/// assert_eq!(ParameterChoice::of::<Oscillator>(&["k"])?.names::<Oscillator>().collect::<Vec<_>>(), ["k"]);
/// assert!(ParameterChoice::of::<Oscillator>(&["q"]).is_err());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ParameterChoice {
    indices: Vec<usize>,
}

impl ParameterChoice {
    /// None of them.
    pub const fn none() -> Self {
        Self { indices: Vec::new() }
    }

    /// Those with these names, in this order.
    ///
    /// # Errors
    /// [`DerivativeError::UnknownParameter`] for a name that the equations of the scene do not use.
    pub fn of<S: MechanicalSystem>(names: &[&str]) -> Result<Self, DerivativeError> {
        let indices = names.iter().map(|name| parameter_index::<S>(name)).collect::<Result<_, _>>()?;
        Ok(Self { indices })
    }

    /// All of them.
    pub fn all<S: MechanicalSystem>() -> Self {
        Self { indices: (0..S::PARAMETERS.len()).collect() }
    }

    /// How many they are.
    pub const fn len(&self) -> usize {
        self.indices.len()
    }

    /// Whether there are none.
    pub const fn is_empty(&self) -> bool {
        self.indices.is_empty()
    }

    /// Their names.
    pub fn names<S: MechanicalSystem>(&self) -> impl Iterator<Item = &'static str> {
        self.indices.iter().map(|&index| S::PARAMETERS[index])
    }
}

/// The place of a parameter among those that the equations use.
pub(super) fn parameter_index<S: MechanicalSystem>(name: &str) -> Result<usize, DerivativeError> {
    S::PARAMETERS
        .iter()
        .position(|parameter| *parameter == name)
        .ok_or_else(|| DerivativeError::UnknownParameter { name: name.into(), known: S::PARAMETERS })
}

/// The rates of the constants where the parameters change at `rates`.
pub(super) fn moving_constants<S: MechanicalSystem>(
    system: &S,
    rates: &S::PerParameter<f64>,
) -> MovingConstants<S> {
    let parameters = system.parameters();
    S::constants(&Array::from_fn(|k| Tangent::new(parameters[k], rates[k])))
}

/// The constants of a scene with what derivatives backwards need: their rates by the chosen parameters, several at a time.
pub(super) struct Seeds<S: MechanicalSystem> {
    /// Constants that stay as they are.
    pub(super) still: MovingConstants<S>,
    still_abreast: ConstantsAbreast<S>,
    /// Of every [`ABREAST`] of the parameters, with what follows these.
    by_parameters: Vec<(ConstantsAbreast<S>, Reach)>,
    pub(super) n_parameters: usize,
    pub(super) reach: Reach,
}

/// What follows the chosen parameters; the rest is not differentiated by them.
#[derive(Clone, Copy)]
pub(super) struct Reach {
    pub(super) residuals: bool,
    pub(super) jacobian: bool,
    pub(super) momentum: bool,
    pub(super) force: bool,
}

impl Reach {
    /// Rates of the chosen parameters that are no numbers reach everything that an operation joins to them, whatever the values are.
    fn of<S: MechanicalSystem>(system: &S, chosen: &[usize], at: &State<S>) -> Self {
        let parameters = system.parameters();
        let rate = |k: usize| if chosen.contains(&k) { f64::NAN } else { 0.0 };
        let constants = S::constants(&Array::from_fn(|k| Tangent::new(parameters[k], rate(k))));
        let (t, q, v) = (Tangent::still(at.t), still::<S, f64>(&at.q), still::<S, f64>(&at.v));
        let inputs = Array::from_fn(|k| Tangent::still(at.inputs[k]));
        let LagrangianGradient { force, momentum } =
            forced_gradient::<S, f64>(&constants, t, &q, &v, &inputs);
        let (residuals, entries) = S::constraint_derivatives(&constants, t, &q);
        let follows = |x: &Tangent| x.rate.is_nan();
        let structure = S::STRUCTURE.jacobian;
        Self {
            residuals: residuals.as_ref().iter().any(follows),
            jacobian: structure
                .q
                .iter()
                .chain(structure.t)
                .any(|entry| follows(&entry.value(constants.as_ref(), entries.as_ref()))),
            momentum: momentum.as_ref().iter().any(follows),
            force: force.as_ref().iter().any(follows),
        }
    }
}

impl<S: MechanicalSystem> Seeds<S> {
    pub(super) fn new(
        system: &S,
        mechanics: &Mechanics<S>,
        choice: &ParameterChoice,
        start: &State<S>,
    ) -> Self {
        let parameters = system.parameters();
        let chunk = |indices: &[usize]| {
            let rate = |k: usize| indices.iter().position(|&index| index == k);
            let constants = S::constants(&Array::from_fn(|k| {
                Tangent::new(parameters[k], rate(k).map_or(Rates::ZERO, Rates::unit))
            }));
            (constants, Reach::of(system, indices, start))
        };
        Self {
            still: Array::from_fn(|k| Tangent::still(mechanics.constants[k])),
            still_abreast: Array::from_fn(|k| Tangent::still(mechanics.constants[k])),
            by_parameters: choice.indices.chunks(ABREAST).map(chunk).collect(),
            n_parameters: choice.indices.len(),
            reach: Reach::of(system, &choice.indices, start),
        }
    }

    /// Adds to every entry of `gradient`, one per chosen parameter, what `rates` makes of the constants along it: where this `follows` the parameter.
    #[inline]
    pub(super) fn add_parameter_rates(
        &self,
        gradient: &mut [f64],
        follows: impl Fn(&Reach) -> bool,
        mut rates: impl FnMut(&ConstantsAbreast<S>) -> Rates<ABREAST>,
    ) {
        for ((constants, reach), gradient) in self.by_parameters.iter().zip(gradient.chunks_mut(ABREAST)) {
            if !follows(reach) {
                continue;
            }
            for (sum, rate) in gradient.iter_mut().zip(rates(constants).0) {
                *sum += rate;
            }
        }
    }

    /// The same for inputs.
    #[inline]
    pub(super) fn add_input_rates(
        &self,
        inputs: &S::PerInput<f64>,
        gradient: &mut S::PerInput<f64>,
        mut rates: impl FnMut(&ConstantsAbreast<S>, &S::PerInput<Tangent<Rates<ABREAST>>>) -> Rates<ABREAST>,
    ) {
        for first in (0..S::N_INPUTS).step_by(ABREAST) {
            let moving = Array::from_fn(|k| {
                let is_here = first <= k && k < first + ABREAST;
                Tangent::new(inputs[k], if is_here { Rates::unit(k - first) } else { Rates::ZERO })
            });
            let rates = rates(&self.still_abreast, &moving).0;
            for (sum, rate) in gradient.as_mut()[first..].iter_mut().zip(rates) {
                *sum += rate;
            }
        }
    }
}
