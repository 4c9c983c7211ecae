//! What there is to tell about a scene, as data: equations as text, and sizes of the emitted code. It is
//! written by the derive, costs nothing where it is not read, and is put into words by [`crate::report`].

use super::{Operations, Structure};

/// A scene's equations, structure and generated code; printing it is the way to read it.
///
/// ```
/// use evi_core::prelude::*;
///
/// #[derive(MechanicalSystem)]
/// #[evi(coordinates(x), kinetic = 0.5 * m * der(x).powi(2), potential = m * g * x)]
/// struct FreeFall { m: f64, g: f64 }
///
/// let report = FreeFall::REPORT.to_string();
/// assert!(report.contains("T = ½ m ẋ²"));
/// assert!(report.contains("potential Hessian: zero, the force is uniform"));
/// ```
#[derive(Clone, Copy, Debug)]
pub struct SystemReport {
    /// Name of the struct.
    pub name: &'static str,
    /// Names of the coordinates.
    pub coordinates: &'static [&'static str],
    /// Names of the constraints.
    pub constraints: &'static [&'static str],
    /// Names of the parameters.
    pub parameters: &'static [&'static str],
    /// Names of the inputs.
    pub inputs: &'static [&'static str],
    /// Names of the observed quantities.
    pub observables: &'static [&'static str],
    /// The equations as the user wrote them, before simplification.
    pub equations: &'static [Equation],
    /// What the compiler knows about the equations.
    pub structure: Structure,
    /// The kernels, in the order in which the trait has them.
    pub kernels: &'static [KernelReport],
}

impl SystemReport {
    /// Stands where the derive found mistakes and the equations are not known.
    #[doc(hidden)]
    pub const UNKNOWN: Self = Self {
        name: "",
        coordinates: &[],
        constraints: &[],
        parameters: &[],
        inputs: &[],
        observables: &[],
        equations: &[],
        structure: Structure::UNKNOWN,
        kernels: &[],
    };

    /// Unknowns of the equations of a step: coordinates and multipliers, `n + m`.
    pub const fn n_unknowns(&self) -> usize {
        self.coordinates.len() + self.constraints.len()
    }

    /// Unknowns that are left to Newton's method once the positions are eliminated: `m` where all second
    /// derivatives of `L` are constant and no other force acts, `n + m` elsewhere.
    pub const fn n_unknowns_after_elimination(&self) -> usize {
        if self.structure.blocks.are_constant() && !self.structure.forces.exist() {
            self.constraints.len()
        } else {
            self.n_unknowns()
        }
    }

    /// Unknowns of a step with one node in its middle on straight curves: the distance along which a central force acts, where the masses do not turn
    /// it away; elsewhere those of other steps.
    pub const fn n_unknowns_of_midpoint_steps(&self) -> usize {
        if self.structure.central_force.is_some() { 1 } else { self.n_unknowns_after_elimination() }
    }
}

/// An equation `left = right`.
#[derive(Clone, Copy, Debug)]
pub struct Equation {
    /// Name of the constraint; empty for a definition.
    pub name: &'static str,
    /// Left side.
    pub left: Formula,
    /// Right side.
    pub right: Formula,
}

/// An expression in two notations.
#[derive(Clone, Copy, Debug)]
pub struct Formula {
    /// As plain text: `½ m₁ ẋ₁²`.
    pub unicode: &'static str,
    /// For LaTeX, in math mode: `\frac{1}{2} m_1 \dot{x}_1^2`.
    pub latex: &'static str,
}

/// What an emitted kernel is made of.
#[derive(Clone, Copy, Debug)]
pub struct KernelReport {
    /// Name of the trait's function.
    pub name: &'static str,
    /// Operations of one call.
    pub operations: Operations,
    /// Named values that are not results.
    pub temporaries: usize,
    /// Statements in its body.
    pub statements: usize,
}

impl KernelReport {
    /// Statements beyond which the report warns that a kernel compiles slowly. The derive refuses a kernel of
    /// ten times as many.
    pub const MANY_STATEMENTS: usize = 5_000;
}
