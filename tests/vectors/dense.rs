//! The kernels of a scene as full matrices, and those of a sum of elements in the coordinates of the whole.

use evi_core::assembled::{AssembledSystem, Family, FamilyVisitor};
use evi_core::generic::GenericSystem;
use evi_core::prelude::*;
use evi_core::system::Entry;
use nalgebra::{DMatrix, DVector};

/// Where kernels are evaluated.
pub struct Point {
    pub t: f64,
    pub q: Vec<f64>,
    pub v: Vec<f64>,
}

impl Point {
    /// Away from every symmetry.
    pub fn irregular(n: usize) -> Self {
        let spread = |seed: f64| (0..n).map(|i| seed + (2.3 * i as f64 + seed).sin()).collect();
        Self { t: 0.7, q: spread(1.1), v: spread(0.2) }
    }

    fn part(&self, places: &[usize]) -> Self {
        let part = |values: &[f64]| places.iter().map(|&place| values[place]).collect();
        Self { t: self.t, q: part(&self.q), v: part(&self.v) }
    }
}

/// Everything that a step needs of a scene without inputs.
#[derive(Debug)]
pub struct Kernels {
    pub lagrangian: f64,
    pub vectors: [DVector<f64>; 3],
    /// `∂²L/∂q²`, `∂²L/∂v∂q`, `∂²L/∂v²`, `∂f/∂q`, `∂f/∂v`.
    pub matrices: [DMatrix<f64>; 5],
    pub constraints: DVector<f64>,
    pub curvature: DVector<f64>,
    pub jacobian: DMatrix<f64>,
}

impl Kernels {
    fn zero(n: usize) -> Self {
        Self {
            lagrangian: 0.0,
            vectors: std::array::from_fn(|_| DVector::zeros(n)),
            matrices: std::array::from_fn(|_| DMatrix::zeros(n, n)),
            constraints: DVector::zeros(0),
            curvature: DVector::zeros(0),
            jacobian: DMatrix::zeros(0, n),
        }
    }

    /// The kernels that the derive emits for `system`.
    pub fn of<S: MechanicalSystem>(system: &S, at: &Point) -> Self {
        use evi_core::array::Array;
        let constants = S::constants(&system.parameters());
        let q: S::PerCoordinate<f64> = Array::from_fn(|i| at.q[i]);
        let v: S::PerCoordinate<f64> = Array::from_fn(|i| at.v[i]);
        let inputs = Array::from_fn(|_| 0.0);
        let (gradient, hessian) = S::lagrangian_derivatives(&constants, at.t, &q, &v);
        let (residuals, jacobian) = S::constraint_derivatives(&constants, at.t, &q);
        let (forces, force_entries) = S::force_derivatives(&constants, at.t, &q, &v, &inputs);
        let (n, m) = (S::N_COORDINATES, S::N_CONSTRAINTS);
        let filled = |rows: usize, entries: &[Entry], varying: &[f64], is_symmetric: bool| {
            let mut matrix = DMatrix::zeros(rows, n);
            for entry in entries {
                let value = entry.value(constants.as_ref(), varying);
                matrix[(entry.row, entry.col)] = value;
                if is_symmetric {
                    matrix[(entry.col, entry.row)] = value;
                }
            }
            matrix
        };
        let structure = S::STRUCTURE;
        Self {
            lagrangian: S::lagrangian(&constants, at.t, &q, &v),
            vectors: [gradient.force.as_ref(), gradient.momentum.as_ref(), forces.as_ref()]
                .map(DVector::from_column_slice),
            matrices: [
                filled(n, structure.hessian.qq, hessian.as_ref(), true),
                filled(n, structure.hessian.vq, hessian.as_ref(), false),
                filled(n, structure.hessian.vv, hessian.as_ref(), true),
                filled(n, structure.forces.q, force_entries.as_ref(), false),
                filled(n, structure.forces.v, force_entries.as_ref(), false),
            ],
            constraints: DVector::from_column_slice(residuals.as_ref()),
            curvature: DVector::from_column_slice(S::constraint_curvature(&constants, at.t, &q, &v).as_ref()),
            jacobian: filled(m, structure.jacobian.q, jacobian.as_ref(), false),
        }
    }

    /// The sum of the kernels of all elements.
    pub fn of_elements<S: AssembledSystem>(system: &S, at: &Point) -> Self {
        let mut sum = Sum { system, at, kernels: Self::zero(system.n_coordinates()) };
        system.visit_families(&mut sum);
        sum.kernels
    }

    /// Adds an element whose coordinates lie at `places`.
    fn add(&mut self, element: &Self, places: &[usize]) {
        self.lagrangian += element.lagrangian;
        for (sum, vector) in self.vectors.iter_mut().zip(&element.vectors) {
            for (i, &row) in places.iter().enumerate() {
                sum[row] += vector[i];
            }
        }
        for (sum, matrix) in self.matrices.iter_mut().zip(&element.matrices) {
            for (i, &row) in places.iter().enumerate() {
                for (j, &col) in places.iter().enumerate() {
                    sum[(row, col)] += matrix[(i, j)];
                }
            }
        }
        let first = self.constraints.len();
        let m = first + element.constraints.len();
        let jacobian = std::mem::replace(&mut self.jacobian, DMatrix::zeros(0, 0));
        self.jacobian = jacobian.resize_vertically(m, 0.0);
        let extended = |vector: &DVector<f64>, more: &DVector<f64>| {
            DVector::from_iterator(m, vector.iter().chain(more).copied())
        };
        self.constraints = extended(&self.constraints, &element.constraints);
        self.curvature = extended(&self.curvature, &element.curvature);
        for c in 0..element.constraints.len() {
            for (j, &col) in places.iter().enumerate() {
                self.jacobian[(first + c, col)] += element.jacobian[(c, j)];
            }
        }
    }

    /// The largest difference of any two entries.
    pub fn distance(&self, other: &Self) -> f64 {
        let pairs = self.vectors.iter().zip(&other.vectors).map(|(a, b)| (a - b).amax());
        let matrices = self.matrices.iter().zip(&other.matrices).map(|(a, b)| (a - b).amax());
        let others = [
            (self.lagrangian - other.lagrangian).abs(),
            (&self.constraints - &other.constraints).amax(),
            (&self.curvature - &other.curvature).amax(),
            (&self.jacobian - &other.jacobian).amax(),
        ];
        // A NaN must not pass.
        pairs.chain(matrices).chain(others).fold(0.0, |largest, x| if x <= largest { largest } else { x })
    }
}

struct Sum<'s, S> {
    system: &'s S,
    at: &'s Point,
    kernels: Kernels,
}

impl<S> FamilyVisitor<S> for Sum<'_, S> {
    fn family<F: Family<S>>(&mut self) {
        for index in 0..F::count(self.system) {
            let places = F::coordinates(self.system, index);
            let element = F::element(self.system, index);
            let at = self.at.part(places.as_ref());
            self.kernels.add(&Kernels::of(&element, &at), places.as_ref());
        }
    }
}

/// `L`, `φ`, `D` and the generalized forces of the generic copy.
pub fn generic_values(system: &impl GenericSystem, at: &Point) -> Vec<f64> {
    let mut residuals = vec![0.0; system.n_constraints()];
    system.constraints(at.t, &at.q, &mut residuals);
    let mut forces = vec![0.0; system.n_coordinates()];
    system.add_forces(at.t, &at.q, &at.v, &[], &mut forces);
    let energies = [system.lagrangian(at.t, &at.q, &at.v), system.dissipation(at.t, &at.q, &at.v)];
    energies.into_iter().chain(residuals).chain(forces).collect()
}
