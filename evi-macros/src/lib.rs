//! `#[derive(MechanicalSystem)]`: from a Lagrangian written on a struct to specialised code.
//!
//! A symbolic compiler in stages, one folder each, joined in `pipeline`. Expressions live in one
//! hash-consed graph (`expr`) from parsing to emission; it is never expanded to a tree. The expansion is a pure function
//! of the tokens of the struct.

mod budget;
mod diagnostics;
mod differentiate;
mod emit;
mod expr;
mod mechanics;
mod model;
mod pipeline;
mod schedule;
mod simplify;
mod structure;
mod syntax;

#[cfg(test)]
mod tests;

/// Implements `evi_core::system::MechanicalSystem` for a struct that carries a Lagrangian.
///
/// ```text
/// #[derive(MechanicalSystem)]
/// #[evi(
///     coordinates(x, y),
///     kinetic = 0.5 * m * (der(x).powi(2) + der(y).powi(2)),
///     potential = m * g * y,
///     constraint(rod: x.powi(2) + y.powi(2) == l.powi(2)),
/// )]
/// struct Pendulum { m: f64, g: f64, l: f64 }
/// ```
///
/// | item | meaning |
/// |---|---|
/// | `coordinates(x, y)` | the coordinates `q`, in this order |
/// | `coordinates(r: [3], p: [N, 2])` | vectors and arrays of coordinates, the last index fastest |
/// | `lagrangian = EXPR`, or `kinetic = EXPR, potential = EXPR` | `L(t, q, v)`, or `L = T − V` |
/// | `constraint(NAME: LHS == RHS)` | the holonomic constraint `φ = LHS − RHS = 0`; an equation of vectors stands for its elements |
/// | `constraint(NAME[i in 1..N]: LHS == RHS)` | a constraint for every `i`; also by two indices, `NAME[i in 0..M, j in 1..M]` |
/// | `rigid_body(NAME, mass = .., center = [..], inertia = [..])` | a body in directors: the array `NAME: [4, 3]` of the position and three axes, six constraints, kinetic energy; the moments of inertia are those about the centre of mass, of which the axes are principal; its points are `NAME.point([..])` |
/// | `let NAME = EXPR` | a shared subexpression, usable below |
/// | `dissipation = EXPR` | Rayleigh's function `D(t, q, v)`: the force `−∂D/∂v` |
/// | `force(COORDINATE: EXPR)` | a generalized force on a coordinate, of `t, q, v` and inputs |
/// | `input(NAME, ..)` | values that the caller sets from step to step |
/// | `frequency(COORDINATE, ..: EXPR)` | the frequency of the curves of these coordinates, of parameters alone |
/// | `observe(NAME: EXPR)` | a quantity to record, of `t, q, v` and inputs |
///
/// `EXPR` is a Rust expression in the struct's fields, coordinates, `der(coordinate)` for velocities, the
/// time `t`, numbers, and constants (a path or a `SCREAMING_CASE` name, passed on to rustc) with `+ - * /`, unary minus,
/// blocks with `let`, and `.powi(integer) .powf(e) .sqrt() .sin() .cos() .tan() .exp() .ln() .asin() .acos() .atan()
/// .atan2(x) .sinh() .cosh() .tanh() .abs()`. Every field that an equation names is a parameter of the system: an `f64`, an array of them such as
/// `[[f64; 2]; N]`, or one of nalgebra's vectors, `Vector3<f64>`, `SVector<f64, N>`.
///
/// Vectors `[a, b, c]`, arrays and their parts are added, subtracted, and multiplied or divided by numbers, and have `.dot(v) .cross(v) .norm()
/// .norm_squared()`. An index is affine in indices and constants, `p[2 * i + 1]`, `p[N - 1]`; `sum(a..b, |i| EXPR)` is a sum, in which `i` may stand as a number, too.
/// `force(p[i in 0..N][1]: EXPR)`, `frequency(p[0]: EXPR)`, `observe(NAME[i in 0..N]: EXPR)` go over elements.
///
/// Where all sizes are small literals, sums and families are written out, and the struct is a `MechanicalSystem`. Where a size is a constant's name, or a
/// literal too large for that, they stay loops: the struct is an `AssembledSystem`, the sum of repeated elements, each of which is differentiated
/// once. The code does not grow with the number of bodies, and whether indices are in range is a constant assertion.
#[proc_macro_derive(MechanicalSystem, attributes(evi))]
pub fn derive_mechanical_system(input: proc_macro::TokenStream) -> proc_macro::TokenStream {
    pipeline::expand(input.into()).into()
}
