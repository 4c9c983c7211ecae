//! Who takes part: the parameters and the start of every member.

use crate::system::MechanicalSystem;

/// The parameters of one member, in the order of [`PARAMETERS`](MechanicalSystem::PARAMETERS), and its start.
pub struct Member<S: MechanicalSystem> {
    /// Values of the struct's fields.
    pub parameters: S::PerParameter<f64>,
    /// Positions at the start, on the constraints.
    pub q: S::PerCoordinate<f64>,
    /// Velocities at the start, on the hidden constraints.
    pub v: S::PerCoordinate<f64>,
}

impl<S: MechanicalSystem> Member<S> {
    /// The member with the parameters of `system` that starts from `(q, v)`.
    pub fn of(system: &S, q: impl Into<S::PerCoordinate<f64>>, v: impl Into<S::PerCoordinate<f64>>) -> Self {
        Self { parameters: system.parameters(), q: q.into(), v: v.into() }
    }
}

impl<S: MechanicalSystem> Clone for Member<S> {
    fn clone(&self) -> Self {
        Self { parameters: self.parameters.clone(), q: self.q.clone(), v: self.v.clone() }
    }
}

/// The members of an ensemble, by their index: what a member is must depend on its index alone.
pub trait Members<S: MechanicalSystem>: Sync {
    /// Number of members.
    fn count(&self) -> usize;

    /// The member at `index < count()`.
    fn member(&self, index: usize) -> Member<S>;
}

/// Members that a function makes from their index, so that none of them is stored.
pub struct ByIndex<F> {
    count: usize,
    member: F,
}

impl<F> ByIndex<F> {
    /// `count` members.
    pub const fn new(count: usize, member: F) -> Self {
        Self { count, member }
    }
}

impl<S: MechanicalSystem, F: Fn(usize) -> Member<S> + Sync> Members<S> for ByIndex<F> {
    fn count(&self) -> usize {
        self.count
    }

    fn member(&self, index: usize) -> Member<S> {
        (self.member)(index)
    }
}

/// Members from arrays with a value per member: a start, parameters, or both; what has no array is common to all.
///
/// ```
/// use evi_core::ensemble::{Family, Members};
/// use evi_core::prelude::*;
/// #[derive(MechanicalSystem)]
/// #[evi(coordinates(theta), kinetic = 0.5 * der(theta).powi(2), potential = -rate.powi(2) * theta.cos())]
/// struct Pendulum { rate: f64 }
/// let family = Family::new(&Pendulum { rate: 3.0 }, 3, [1.0], [0.0]).parameter("rate", vec![3.0, 3.1, 3.2])?;
/// assert_eq!(family.member(2).parameters, [3.2]);
/// let error = Family::new(&Pendulum { rate: 3.0 }, 3, [1.0], [0.0]).parameter("rate", vec![3.0]).err().expect("refused");
/// assert_eq!(error.to_string(), "`rate` has 1 values, the ensemble 3 members");
/// # Ok::<(), evi_core::ensemble::FamilyError>(())
/// ```
pub struct Family<S: MechanicalSystem> {
    count: usize,
    common: Member<S>,
    /// Index of the parameter, and its values.
    parameters: Vec<(usize, Vec<f64>)>,
    positions: Vec<S::PerCoordinate<f64>>,
    velocities: Vec<S::PerCoordinate<f64>>,
}

/// Arrays that make no family.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum FamilyError {
    /// An array has not one value per member.
    #[error("`{name}` has {found} values, the ensemble {expected} members")]
    Length {
        /// The parameter, `q` or `v`.
        name: String,
        /// Number of members.
        expected: usize,
        /// Number of values.
        found: usize,
    },
    /// The scene has no such parameter.
    #[error("the scene has no parameter `{name}`; it has: {}", known.join(", "))]
    UnknownParameter {
        /// The name.
        name: String,
        /// Those that there are.
        known: &'static [&'static str],
    },
}

impl<S: MechanicalSystem> Family<S> {
    /// `count` members with the parameters of `system` that all start from `(q, v)`, until arrays say otherwise.
    pub fn new(
        system: &S,
        count: usize,
        q: impl Into<S::PerCoordinate<f64>>,
        v: impl Into<S::PerCoordinate<f64>>,
    ) -> Self {
        let common = Member::of(system, q, v);
        Self { count, common, parameters: Vec::new(), positions: Vec::new(), velocities: Vec::new() }
    }

    /// Gives every member its own value of a parameter.
    ///
    /// # Errors
    /// [`FamilyError`] for a name that the scene does not have, and for an array of another length.
    pub fn parameter(mut self, name: &str, values: Vec<f64>) -> Result<Self, FamilyError> {
        let Some(index) = S::PARAMETERS.iter().position(|known| *known == name) else {
            return Err(FamilyError::UnknownParameter { name: name.to_owned(), known: S::PARAMETERS });
        };
        self.check(name, values.len())?;
        self.parameters.push((index, values));
        Ok(self)
    }

    /// Gives every member its own start.
    ///
    /// # Errors
    /// [`FamilyError::Length`] for arrays of another length.
    pub fn starts(
        mut self,
        positions: Vec<S::PerCoordinate<f64>>,
        velocities: Vec<S::PerCoordinate<f64>>,
    ) -> Result<Self, FamilyError> {
        self.check("q", positions.len())?;
        self.check("v", velocities.len())?;
        (self.positions, self.velocities) = (positions, velocities);
        Ok(self)
    }

    fn check(&self, name: &str, found: usize) -> Result<(), FamilyError> {
        let expected = self.count;
        if found == expected {
            Ok(())
        } else {
            Err(FamilyError::Length { name: name.to_owned(), expected, found })
        }
    }
}

impl<S: MechanicalSystem> Members<S> for Family<S>
where
    S::PerCoordinate<f64>: Sync,
    S::PerParameter<f64>: Sync,
{
    fn count(&self) -> usize {
        self.count
    }

    fn member(&self, index: usize) -> Member<S> {
        let mut member = self.common.clone();
        for (parameter, values) in &self.parameters {
            member.parameters.as_mut()[*parameter] = values[index];
        }
        if let Some(q) = self.positions.get(index) {
            member.q = q.clone();
        }
        if let Some(v) = self.velocities.get(index) {
            member.v = v.clone();
        }
        member
    }
}
