//! Which variables an equation may name, by its kind; in: what a name depends on, out: why it is refused.

use crate::expr::Dependence;

/// What an equation is made of besides parameters.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Variables {
    /// Positions, velocities and time: energies and the dissipation.
    OfMotion,
    /// Positions and time: constraints.
    OfPlace,
    /// All there are, inputs too: forces, observed quantities, and shared expressions, which are judged where they are used.
    All,
    /// None of them: frequencies.
    Nothing,
}

/// Why a frequency follows nothing.
const FREQUENCY_IS_CONSTANT: &str = "a frequency is constant over a run and made of parameters only: one that \
                                     followed the state would cost the steps their symplecticity";
const INPUTS_ARE_FOR_FORCES: &str = "only `force` and `observe` may name inputs, for neither energies nor \
                                     constraints may change from step to step";

impl Variables {
    /// Why a name that stands for a coordinate, the time or an input itself cannot stand here.
    pub(super) fn refuse_symbol(self, name: &str, what: &str, on: Dependence) -> Option<String> {
        match self {
            Self::Nothing if !on.is_constant() => {
                Some(format!("`{name}` is {what}: {FREQUENCY_IS_CONSTANT}"))
            }
            Self::OfMotion | Self::OfPlace if on.on_inputs => {
                Some(format!("`{name}` is {what}: {INPUTS_ARE_FOR_FORCES}"))
            }
            _ => None,
        }
    }

    /// Why a name that stands for a shared expression cannot stand here.
    pub(super) fn refuse_shared(self, name: &str, on: Dependence) -> Option<String> {
        match self {
            Self::Nothing if !on.is_constant() => {
                Some(format!("`{name}` is not constant: {FREQUENCY_IS_CONSTANT}"))
            }
            Self::OfPlace if on.on_v => {
                Some(format!("`{name}` contains der(..), which a holonomic constraint cannot"))
            }
            Self::OfMotion | Self::OfPlace if on.on_inputs => {
                Some(format!("`{name}` contains an input: {INPUTS_ARE_FOR_FORCES}"))
            }
            _ => None,
        }
    }

    /// Why `der(..)` cannot stand here, in an equation that is called `context`.
    pub(super) fn refuse_der(self, context: &str) -> Option<String> {
        match self {
            Self::OfPlace => {
                Some(format!("der() in a holonomic constraint: {context} may relate positions and `t` only"))
            }
            Self::Nothing => Some(format!("der() in {context}: {FREQUENCY_IS_CONSTANT}")),
            Self::OfMotion | Self::All => None,
        }
    }
}
