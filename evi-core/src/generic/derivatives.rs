//! Derivatives of a [`GenericSystem`] by forward-mode dual numbers.
//!
//! In: a point `(t, q, v)` and, per coordinate, the direction that it is moved in. Out: first and mixed second
//! derivatives, added into buffers of the caller. Nothing allocates after [`Derivatives::new`]. What the derivatives
//! are needed for is left to [`step`](super::step) and [`projection`](super::projection).
//!
//! The step needs `D₁L_d`, `D₂L_d` and `D₁D₂L_d`, not the Hessian of `L`: a coordinate `i` is therefore moved along
//! `(qᵢ, vᵢ) += (Seed::q, Seed::v) ε`, with the interpolant's weights of start or end as seeds. One evaluation of `L` in
//! numbers with two chunks of infinitesimals gives a chunk of `D₁L_d` and a block of `D₁D₂L_d`: `n²` entries
//! instead of the `2n (2n + 1) / 2` of the Hessian in `(q, v)`.

use nalgebra::DMatrix;
use num_dual::{Dual64, HyperDual64};

use super::GenericSystem;
use super::chunk::{
    CHUNK, Gradient, Mixed, add_block, add_scaled, add_transposed_block, infinitesimal, mixed, moved,
    subtract_first_column,
};

/// Direction that a coordinate and its velocity are moved in.
#[derive(Clone, Copy, Debug)]
pub(super) struct Seed {
    pub(super) q: f64,
    pub(super) v: f64,
}

impl Seed {
    /// The velocity alone: derivatives by `v`.
    pub(super) const VELOCITY: Self = Self { q: 0.0, v: 1.0 };
    /// The coordinate alone: derivatives by `q`.
    pub(super) const POSITION: Self = Self { q: 1.0, v: 0.0 };
}

/// Arguments of the Lagrangian.
#[derive(Clone, Copy)]
pub(super) struct Point<'a> {
    pub(super) t: f64,
    pub(super) q: &'a [f64],
    pub(super) v: &'a [f64],
}

/// A system with buffers for its arguments in dual numbers.
pub(super) struct Derivatives<S> {
    pub(super) system: S,
    pub(super) n_coordinates: usize,
    pub(super) gradient_q: Vec<Gradient>,
    pub(super) gradient_v: Vec<Gradient>,
    gradient_residuals: Vec<Gradient>,
    pub(super) mixed_q: Vec<Mixed>,
    pub(super) mixed_v: Vec<Mixed>,
    mixed_residuals: Vec<Mixed>,
    time_q: Vec<Dual64>,
    time_residuals: Vec<Dual64>,
    line_q: Vec<HyperDual64>,
    line_residuals: Vec<HyperDual64>,
    /// Empty for a system without forces, as the two below.
    pub(super) force: Vec<f64>,
    pub(super) gradient_force: Vec<Gradient>,
    pub(super) gradient_inputs: Vec<Gradient>,
}

impl<S: GenericSystem> Derivatives<S> {
    pub(super) fn new(system: S) -> Self {
        let (n, m) = (system.n_coordinates(), system.n_constraints());
        let n_forces = if S::HAS_FORCES { n } else { 0 };
        Self {
            force: vec![0.0; n_forces],
            gradient_force: vec![Gradient::from_re(0.0); n_forces],
            gradient_inputs: vec![Gradient::from_re(0.0); system.n_inputs()],
            system,
            n_coordinates: n,
            gradient_q: vec![Gradient::from_re(0.0); n],
            gradient_v: vec![Gradient::from_re(0.0); n],
            gradient_residuals: vec![Gradient::from_re(0.0); m],
            mixed_q: vec![Mixed::from_re(0.0); n],
            mixed_v: vec![Mixed::from_re(0.0); n],
            mixed_residuals: vec![Mixed::from_re(0.0); m],
            time_q: vec![Dual64::from_re(0.0); n],
            time_residuals: vec![Dual64::from_re(0.0); m],
            line_q: vec![HyperDual64::from_re(0.0); n],
            line_residuals: vec![HyperDual64::from_re(0.0); m],
        }
    }

    pub(super) const fn system(&self) -> &S {
        &self.system
    }

    /// Adds `weight ∂L/∂εᵢ` to `gradient`.
    pub(super) fn add_gradient(&mut self, at: Point<'_>, seeds: &[Seed], weight: f64, gradient: &mut [f64]) {
        self.add_gradient_along(at, |i| seeds[i], weight, gradient);
    }

    /// Adds `∂L/∂v` to `momentum`.
    pub(super) fn add_momentum(&mut self, at: Point<'_>, momentum: &mut [f64]) {
        self.add_gradient_along(at, |_| Seed::VELOCITY, 1.0, momentum);
    }

    fn add_gradient_along(
        &mut self,
        at: Point<'_>,
        seed: impl Fn(usize) -> Seed,
        weight: f64,
        gradient: &mut [f64],
    ) {
        for first in (0..self.n_coordinates).step_by(CHUNK) {
            for i in 0..self.n_coordinates {
                let Seed { q, v } = seed(i);
                self.gradient_q[i] = Gradient::new(at.q[i], infinitesimal(i, first, q));
                self.gradient_v[i] = Gradient::new(at.v[i], infinitesimal(i, first, v));
            }
            let t = Gradient::from_re(at.t);
            let value = self.system.lagrangian(t, &self.gradient_q, &self.gradient_v);
            add_scaled(value.eps, weight, &mut gradient[first..]);
        }
    }

    /// Adds `weight ∂L/∂εᵢ` to `gradient` and `weight ∂²L/∂εᵢ∂δⱼ` to `block[(i, j)]`, where `rows` are the directions of
    /// `ε` and `columns` those of `δ`.
    pub(super) fn add_mixed(
        &mut self,
        at: Point<'_>,
        (rows, columns): (&[Seed], &[Seed]),
        weight: f64,
        gradient: &mut [f64],
        block: &mut DMatrix<f64>,
    ) {
        for row in (0..self.n_coordinates).step_by(CHUNK) {
            for col in (0..self.n_coordinates).step_by(CHUNK) {
                let value = self.mixed_along(at, (row, |i| rows[i]), (col, |j| columns[j]));
                if col == 0 {
                    add_scaled(value.eps1, weight, &mut gradient[row..]);
                }
                add_block(&value, weight, (row, col), block);
            }
        }
    }

    /// Adds `∂L/∂v` to `momentum` and `∂²L/∂v²` to `block`, of which only the chunks on and below the diagonal are
    /// evaluated.
    pub(super) fn add_mass(&mut self, at: Point<'_>, momentum: &mut [f64], block: &mut DMatrix<f64>) {
        for row in (0..self.n_coordinates).step_by(CHUNK) {
            for col in (0..=row).step_by(CHUNK) {
                let velocity = |_| Seed::VELOCITY;
                let value = self.mixed_along(at, (row, velocity), (col, velocity));
                if col == 0 {
                    add_scaled(value.eps1, 1.0, &mut momentum[row..]);
                }
                add_block(&value, 1.0, (row, col), block);
                if col != row {
                    add_transposed_block(&value, (row, col), block);
                }
            }
        }
    }

    /// Adds `∂L/∂q` to `force`.
    pub(super) fn add_force(&mut self, at: Point<'_>, force: &mut [f64]) {
        self.add_gradient_along(at, |_| Seed::POSITION, 1.0, force);
    }

    /// Subtracts `(∂²L/∂v∂q) v + ∂²L/∂v∂t` from `force`: the rate of `∂L/∂v` along `(t, q) += (1, v) δ`.
    pub(super) fn subtract_momentum_drift(&mut self, at: Point<'_>, force: &mut [f64]) {
        for row in (0..self.n_coordinates).step_by(CHUNK) {
            for i in 0..self.n_coordinates {
                self.mixed_q[i] = moved(at.q[i], at.v[i]);
                self.mixed_v[i] = mixed(at.v[i], i, (row, Seed::VELOCITY.v), (0, 0.0));
            }
            let value = self.system.lagrangian(moved(at.t, 1.0), &self.mixed_q, &self.mixed_v);
            subtract_first_column(&value, &mut force[row..]);
        }
    }

    /// Overwrites `curvatures` with `γ = vᵀ φ_qq v + 2 φ_qt v + φ_tt`, the second derivative along `(t, q) += (1, v) δ`.
    pub(super) fn constraint_curvatures(&mut self, at: Point<'_>, curvatures: &mut [f64]) {
        let line = |value: f64, rate: f64| HyperDual64::new(value, rate, rate, 0.0);
        for i in 0..self.n_coordinates {
            self.line_q[i] = line(at.q[i], at.v[i]);
        }
        self.system.constraints(line(at.t, 1.0), &self.line_q, &mut self.line_residuals);
        for (curvature, residual) in curvatures.iter_mut().zip(&self.line_residuals) {
            *curvature = residual.eps1eps2;
        }
    }

    /// `L` with the chunks of infinitesimals that begin at `row` and `col`.
    fn mixed_along(
        &mut self,
        at: Point<'_>,
        rows: (usize, impl Fn(usize) -> Seed),
        columns: (usize, impl Fn(usize) -> Seed),
    ) -> Mixed {
        self.set_mixed(at, rows, columns);
        self.system.lagrangian(Mixed::from_re(at.t), &self.mixed_q, &self.mixed_v)
    }

    /// Sets the arguments with the chunks of infinitesimals that begin at `row` and `col`.
    pub(super) fn set_mixed(
        &mut self,
        at: Point<'_>,
        (row, row_seed): (usize, impl Fn(usize) -> Seed),
        (col, col_seed): (usize, impl Fn(usize) -> Seed),
    ) {
        for i in 0..self.n_coordinates {
            let (along_row, along_col) = (row_seed(i), col_seed(i));
            self.mixed_q[i] = mixed(at.q[i], i, (row, along_row.q), (col, along_col.q));
            self.mixed_v[i] = mixed(at.v[i], i, (row, along_row.v), (col, along_col.v));
        }
    }

    /// Overwrites `residuals` with `φ(t, q)` and `jacobian` with `G = ∂φ/∂q`.
    pub(super) fn constraints(
        &mut self,
        t: f64,
        q: &[f64],
        residuals: &mut [f64],
        jacobian: &mut DMatrix<f64>,
    ) {
        for first in (0..self.n_coordinates).step_by(CHUNK) {
            for i in 0..self.n_coordinates {
                self.gradient_q[i] = Gradient::new(q[i], infinitesimal(i, first, Seed::POSITION.q));
            }
            self.system.constraints(Gradient::from_re(t), &self.gradient_q, &mut self.gradient_residuals);
            for (c, value) in self.gradient_residuals.iter().enumerate() {
                residuals[c] = value.re;
                for col in first..self.n_coordinates.min(first + CHUNK) {
                    jacobian[(c, col)] = value.eps.0.map_or(0.0, |slopes| slopes[col - first]);
                }
            }
        }
    }

    /// Overwrites `rates` with `∂φ/∂t`.
    pub(super) fn constraint_time_rates(&mut self, t: f64, q: &[f64], rates: &mut [f64]) {
        for i in 0..self.n_coordinates {
            self.time_q[i] = Dual64::from_re(q[i]);
        }
        self.system.constraints(Dual64::from_re(t).derivative(), &self.time_q, &mut self.time_residuals);
        for (c, value) in self.time_residuals.iter().enumerate() {
            rates[c] = value.eps;
        }
    }

    /// Adds `Σ multipliers[c] ∂²φ_c/∂q²` to `block`.
    pub(super) fn add_constraint_hessian(
        &mut self,
        t: f64,
        q: &[f64],
        multipliers: &[f64],
        block: &mut DMatrix<f64>,
    ) {
        for row in (0..self.n_coordinates).step_by(CHUNK) {
            for col in (0..self.n_coordinates).step_by(CHUNK) {
                for i in 0..self.n_coordinates {
                    self.mixed_q[i] = mixed(q[i], i, (row, Seed::POSITION.q), (col, Seed::POSITION.q));
                }
                self.system.constraints(Mixed::from_re(t), &self.mixed_q, &mut self.mixed_residuals);
                for (value, &multiplier) in self.mixed_residuals.iter().zip(multipliers) {
                    add_block(value, multiplier, (row, col), block);
                }
            }
        }
    }
}
