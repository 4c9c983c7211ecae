//! What kind of equations a scene has: the vocabulary of [`Structure`](super::Structure), every value of
//! which the compiler finds in the scene's expressions, not at run time. Code that branches on these
//! constants is compiled for the scene at hand and holds nothing else.

use super::Dependence;

/// The values of a block of second derivatives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Block {
    /// Every entry vanishes structurally.
    Zero,
    /// Every entry depends on parameters alone, and at least one does not vanish.
    Constant,
    /// At least one entry depends on these variables.
    Varying(Dependence),
}

impl Block {
    /// Whether the block is the same throughout a run.
    pub const fn is_constant(self) -> bool {
        matches!(self, Self::Zero | Self::Constant)
    }

    /// Whether every entry vanishes structurally.
    pub const fn is_zero(self) -> bool {
        matches!(self, Self::Zero)
    }

    /// Whether some entry depends on the coordinates.
    pub const fn is_on_q(self) -> bool {
        matches!(self, Self::Varying(Dependence { on_q: true, .. }))
    }

    /// Whether some entry depends on time.
    pub const fn is_on_t(self) -> bool {
        matches!(self, Self::Varying(Dependence { on_t: true, .. }))
    }
}

/// The blocks of the Hessian of `L`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct HessianBlocks {
    /// `∂²L/∂q²`.
    pub qq: Block,
    /// `∂²L/∂v∂q`: what couples positions and velocities.
    pub vq: Block,
    /// `∂²L/∂v²`: the mass matrix.
    pub vv: Block,
    /// `∂²L/∂v∂t`.
    pub vt: Block,
}

impl HessianBlocks {
    /// Whether the equations of motion are linear in `(q, v)` but for the constraints: then the positions can
    /// be eliminated from the equations of a step once per run.
    pub const fn are_constant(&self) -> bool {
        self.qq.is_constant() && self.vq.is_constant() && self.vv.is_constant()
    }
}

/// The pattern of the mass matrix.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MassShape {
    /// No velocity is coupled to another.
    Diagonal,
    /// Velocities are coupled within this many groups of coordinates only, more than one.
    BlockDiagonal(usize),
    /// All velocities are coupled, directly or through others.
    Full,
}

/// The potential `V(t, q) = −L(t, q, 0)` as a function of `q`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Potential {
    /// Without `q`: no force.
    Zero,
    /// Affine in `q`: a uniform force.
    Affine,
    /// Quadratic in `q`: a force linear in `q`.
    Quadratic,
    /// Anything else.
    General,
    /// The kinetic energy depends on `q`, and no second derivative belongs to the potential alone.
    Inseparable,
}

/// The force of `L = ½ vᵀM v + fᵀq − F(r)` with constant `M` and `f`, along a distance `r`: `r²` is a sum of squares of independent
/// functions that are affine in `q`. Of a potential that is quadratic in `q` this is not said.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CentralForce {
    /// Whether `F` is quadratic in `r`: a linear spring.
    pub is_linear: bool,
    /// Whether `f` does not vanish.
    pub is_beside_uniform_force: bool,
}

/// The structure of one constraint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ConstraintStructure {
    /// Its row of the Jacobian `∂φ/∂q`.
    pub gradient: Block,
    /// Whether it depends on time.
    pub on_t: bool,
    /// Whether it is a polynomial of degree at most two in `q`: its curvature does not depend on `q`.
    pub is_quadratic: bool,
    /// Whether it holds the coordinates of one mass at one distance of the origin, `½ content |q_I|² − c` with the content of all constraints: without a cancellation, `|q_I|²` is as constant as
    /// the constraint holds.
    pub is_sphere: bool,
    /// The earlier constraint that it repeats, structurally.
    pub repeats: Option<usize>,
}

impl ConstraintStructure {
    /// Whether it is affine in `q`.
    pub const fn is_affine(&self) -> bool {
        !self.gradient.is_on_q()
    }
}
