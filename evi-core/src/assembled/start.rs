//! A scene joined with a scheme, and the start of a run.

use super::assembly::{ConstraintsAt, Point};
use super::run::hidden_residuals;
use super::scene::{ConstantInertia, PreparedScene};
use super::{AssembledRun, AssembledScheme, AssembledState, AssembledSystem, AssemblyError};
use crate::mechanics::{CONSISTENCY, norm};

/// A scene of repeated elements and the scheme that integrates it; see the [module](super) for an example.
#[derive(Clone, Debug)]
pub struct AssembledSimulation<S, F> {
    system: S,
    scheme: F,
}

impl<S: AssembledSystem + Clone, F: AssembledScheme> AssembledSimulation<S, F> {
    /// A simulation of `system` with `scheme`.
    pub const fn new(system: S, scheme: F) -> Self {
        Self { system, scheme }
    }

    /// The scene.
    pub const fn system(&self) -> &S {
        &self.system
    }

    /// The scheme.
    pub const fn scheme(&self) -> &F {
        &self.scheme
    }

    /// A run from positions and velocities at time 0 that satisfy the constraints.
    ///
    /// # Errors
    /// [`AssemblyError`] for elements that do not fit the scene, numbers that are not finite, an inconsistent start, dependent constraints, or a
    /// scheme that defines no step.
    pub fn start(
        &self,
        q: impl Into<Vec<f64>>,
        v: impl Into<Vec<f64>>,
    ) -> Result<AssembledRun<S, F::Step>, AssemblyError> {
        self.start_at(0.0, q, v)
    }

    /// A run from a consistent start at time `t`.
    ///
    /// # Errors
    /// As for [`start`](Self::start).
    pub fn start_at(
        &self,
        t: f64,
        q: impl Into<Vec<f64>>,
        v: impl Into<Vec<f64>>,
    ) -> Result<AssembledRun<S, F::Step>, AssemblyError> {
        let (q, v) = (q.into(), v.into());
        let mut scene = PreparedScene::new(&self.system)?;
        let map = self.scheme.prepare(&mut scene)?;
        self.check_numbers(&scene, t, &q, &v)?;
        self.check_position(&scene, t, &q)?;
        self.check_velocity(&scene, t, &q, &v)?;
        let state = self.project_velocity(&mut scene, t, q, v)?;
        Ok(AssembledRun::new(self.system.clone(), scene, map, state))
    }

    fn check_numbers(
        &self,
        scene: &PreparedScene,
        t: f64,
        q: &[f64],
        v: &[f64],
    ) -> Result<(), AssemblyError> {
        let expected = scene.assembly.n_coordinates;
        for (quantity, found) in [("position", q.len()), ("velocity", v.len())] {
            if found != expected {
                return Err(AssemblyError::Length { quantity, expected, found });
            }
        }
        if !t.is_finite() {
            return Err(AssemblyError::NotFinite { quantity: "time", name: String::new(), value: t });
        }
        self.refuse_what_is_not_finite(&[("position", q), ("velocity", v)])?;
        let energy = scene.assembly.energy(Point { t, q, v });
        if !energy.is_finite() {
            return Err(AssemblyError::NotFinite { quantity: "energy", name: String::new(), value: energy });
        }
        Ok(())
    }

    fn refuse_what_is_not_finite(&self, numbers: &[(&'static str, &[f64])]) -> Result<(), AssemblyError> {
        for &(quantity, values) in numbers {
            if let Some(index) = values.iter().position(|value| !value.is_finite()) {
                let name = self.system.coordinate_name(index);
                return Err(AssemblyError::NotFinite { quantity, name, value: values[index] });
            }
        }
        Ok(())
    }

    /// Refuses a position beside a constraint, by more than the round-off of its terms.
    fn check_position(&self, scene: &PreparedScene, t: f64, q: &[f64]) -> Result<(), AssemblyError> {
        let assembly = &scene.assembly;
        let mut at = ConstraintsAt::of(assembly);
        assembly.constraint_derivatives(t, q, &mut at);
        let reach = norm(q);
        for (c, gradient) in assembly.gradient_norms(&at.slopes).into_iter().enumerate() {
            let (residual, allowed) = (at.values[c], CONSISTENCY * gradient * reach);
            // Written so that a NaN is refused.
            let is_met = residual.abs() <= allowed;
            if !is_met {
                let constraint = self.system.constraint_name(c);
                return Err(AssemblyError::InconsistentPosition { constraint, residual, allowed });
            }
        }
        Ok(())
    }

    fn check_velocity(
        &self,
        scene: &PreparedScene,
        t: f64,
        q: &[f64],
        v: &[f64],
    ) -> Result<(), AssemblyError> {
        let residuals = hidden_residuals(&scene.assembly, t, q, v);
        match residuals.iter().position(|&residual| residual > CONSISTENCY || residual.is_nan()) {
            None => Ok(()),
            Some(c) => Err(AssemblyError::InconsistentVelocity {
                constraint: self.system.constraint_name(c),
                residual: residuals[c],
                allowed: CONSISTENCY,
            }),
        }
    }

    /// Removes what round-off left of the velocity normal to the constraints, and finds the momentum.
    fn project_velocity(
        &self,
        scene: &mut PreparedScene,
        t: f64,
        q: Vec<f64>,
        v: Vec<f64>,
    ) -> Result<AssembledState, AssemblyError> {
        let PreparedScene { assembly, inertia, space, .. } = &mut *scene;
        assembly.constraint_derivatives(t, &q, &mut space.at_end);
        if let Some(ConstantInertia { mass, gram }) = inertia {
            gram.factor(mass, &space.at_end.slopes).map_err(|(constraint, matrix)| {
                let constraint = self.system.constraint_name(constraint);
                AssemblyError::DependentConstraint { constraint, pivot_ratio: matrix.pivot_ratio }
            })?;
        }
        space.q.copy_from_slice(&q);
        space.v.copy_from_slice(&v);
        space.impulse.fill(0.0);
        assembly.gradient(Point { t, q: &q, v: &v }, &mut space.force, &mut space.momentum);
        space.p.copy_from_slice(&space.momentum);
        scene.project(t, &mut ())?;
        let (v, p) = (scene.space.v.clone(), scene.space.p.clone());
        self.refuse_what_is_not_finite(&[("velocity", &v), ("momentum", &p)])?;
        let inputs = vec![0.0; S::INPUTS.len()];
        Ok(AssembledState { t, q, v, p, inputs })
    }
}
