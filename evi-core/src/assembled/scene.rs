//! A scene made ready for its steps: what is constant over a run, and storage for what is not.

use super::assembly::{Assembly, ConstraintsAt, Point};
use super::galerkin::PointMatrix;
use super::gram::Gram;
use super::mass::{ConstantMass, check_inertia, mass_matrix};
use super::saddle::Saddle;
use super::sparse::TooMuchFill;
use super::{AssembledState, AssembledSystem, AssemblyError};
use crate::integrator::StepError;
use crate::memory::memory;

/// A scene, prepared for runs: its elements, the orders of its eliminations, and the storage of its steps. Stages of a composition share it.
pub struct PreparedScene {
    pub(super) assembly: Assembly,
    /// Of scenes with a constant mass of small blocks; in others velocities and multipliers are found with the saddle-point matrix.
    pub(super) inertia: Option<ConstantInertia>,
    /// Positions and multipliers together, where steps need it.
    pub(super) saddle: Option<Saddle>,
    /// All points of a Galerkin step together, where there are such steps and the matrix is not too large.
    pub(super) points: Option<PointMatrix>,
    pub(super) space: Space,
    n_inputs: usize,
}

/// A mass matrix that is constant and of small blocks: with it multipliers are found alone.
pub(super) struct ConstantInertia {
    pub(super) mass: ConstantMass,
    pub(super) gram: Gram,
}

/// Storage of a step.
pub(super) struct Space {
    /// The end of the step.
    pub(super) q: Vec<f64>,
    pub(super) v: Vec<f64>,
    pub(super) p: Vec<f64>,
    /// A sum of forces or momenta.
    pub(super) pull: Vec<f64>,
    /// A displacement.
    pub(super) moved: Vec<f64>,
    pub(super) force: Vec<f64>,
    pub(super) momentum: Vec<f64>,
    /// The force at the start and at the end of a step, where it acts there.
    pub(super) force_at_start: Vec<f64>,
    pub(super) force_at_end: Vec<f64>,
    /// `ℓ`, the impulse of the constraint force.
    pub(super) impulse: Vec<f64>,
    pub(super) rates: Vec<f64>,
    /// Coordinates, then constraints.
    pub(super) unknowns: Vec<f64>,
    pub(super) at_start: ConstraintsAt,
    pub(super) at_end: ConstraintsAt,
    /// Whether what is kept of the start belongs to the state that the next step begins from.
    pub(super) is_start_known: bool,
}

// What is known of the start of the next step is found by the last one, at a time that is rounded otherwise where a composition begins; the rest is written
// anew in every step.
memory!([] PreparedScene, |words| Self { assembly: _, inertia: _, saddle: _, points: _, space, n_inputs: _ } => {
    let Space { at_start, force_at_start, force_at_end, is_start_known, .. } = space;
    words.part(at_start);
    words.slice(force_at_start);
    words.slice(force_at_end);
    words.flag(is_start_known);
});

impl Space {
    fn of(assembly: &Assembly) -> Self {
        let per_coordinate = || vec![0.0; assembly.n_coordinates];
        let per_constraint = || vec![0.0; assembly.n_constraints];
        Self {
            q: per_coordinate(),
            v: per_coordinate(),
            p: per_coordinate(),
            pull: per_coordinate(),
            moved: per_coordinate(),
            force: per_coordinate(),
            momentum: per_coordinate(),
            force_at_start: per_coordinate(),
            force_at_end: per_coordinate(),
            impulse: per_constraint(),
            rates: per_constraint(),
            unknowns: vec![0.0; assembly.n_coordinates + assembly.n_constraints],
            at_start: ConstraintsAt::of(assembly),
            at_end: ConstraintsAt::of(assembly),
            is_start_known: false,
        }
    }
}

impl PreparedScene {
    /// Prepares every element of `system`.
    pub(super) fn new<S: AssembledSystem>(system: &S) -> Result<Self, AssemblyError> {
        let assembly = Assembly::new(system)?;
        let zero = vec![0.0; assembly.n_coordinates];
        let matrix = mass_matrix(&assembly, Point { t: 0.0, q: &zero, v: &zero });
        check_inertia(system, &matrix)?;
        // Where the constraints alone fill in too much, they are eliminated with the coordinates.
        let inertia = ConstantMass::new(&assembly, &matrix).and_then(|mass| {
            let gram = Gram::new(&assembly, &mass).ok()?;
            Some(ConstantInertia { mass, gram })
        });
        let saddle = match inertia {
            Some(_) => None,
            None => Some(Saddle::new(&assembly).map_err(|fill| too_much(&assembly, fill))?),
        };
        Ok(Self {
            space: Space::of(&assembly),
            assembly,
            inertia,
            saddle,
            points: None,
            n_inputs: S::INPUTS.len(),
        })
    }

    /// A state of zeros, for numbers to come.
    pub(super) fn blank_state(&self) -> AssembledState {
        AssembledState::blank(self.assembly.n_coordinates, self.n_inputs)
    }

    /// Sets what forces take from the caller: what is known of the start of a step is known no more.
    pub(super) fn set_inputs(&mut self, inputs: &[f64]) {
        self.assembly.set_inputs(inputs);
        self.space.is_start_known = false;
    }

    /// Makes sure that there is a saddle-point matrix.
    pub(super) fn prepare_saddle(&mut self) -> Result<(), AssemblyError> {
        if self.saddle.is_none() {
            let saddle = Saddle::new(&self.assembly).map_err(|fill| too_much(&self.assembly, fill))?;
            self.saddle = Some(saddle);
        }
        Ok(())
    }

    /// Makes sure that there is a matrix over all points of steps with so many intervals, if it is not too large.
    pub(super) fn prepare_points(&mut self, intervals: usize) {
        if self.points.as_ref().is_none_or(|points| !points.is_for(intervals)) {
            self.points = PointMatrix::new(&self.assembly, intervals);
        }
    }

    /// Overwrites the state with the end of the step that has been found, if every number of it is finite.
    pub(super) fn reach(&mut self, state: &mut AssembledState, t: f64) -> Result<(), StepError> {
        let space = &mut self.space;
        // A sum is finite only if all of its terms are; only numbers near the largest one overflow together.
        let sum: f64 = space.q.iter().chain(&space.v).chain(&space.p).sum();
        // Written so that a NaN is refused.
        let is_finite = sum.abs() < f64::INFINITY;
        if !is_finite {
            space.is_start_known = false;
            return Err(StepError::NotFinite { t });
        }
        state.t = t;
        std::mem::swap(&mut state.q, &mut space.q);
        std::mem::swap(&mut state.v, &mut space.v);
        std::mem::swap(&mut state.p, &mut space.p);
        std::mem::swap(&mut space.at_start, &mut space.at_end);
        std::mem::swap(&mut space.force_at_start, &mut space.force_at_end);
        space.is_start_known = true;
        Ok(())
    }
}

impl PreparedScene {
    /// The error of a scene whose elimination takes too much.
    pub(super) fn too_much(&self, fill: TooMuchFill) -> AssemblyError {
        too_much(&self.assembly, fill)
    }
}

fn too_much(assembly: &Assembly, fill: TooMuchFill) -> AssemblyError {
    AssemblyError::TooMuchFill { unknowns: assembly.n_coordinates + assembly.n_constraints, most: fill.most }
}
