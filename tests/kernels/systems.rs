//! Systems behind pointers, and what their kernels return.

use super::*;

/// A system behind a pointer, so that the checks below are compiled once and not per struct.
pub(super) struct Scene<K: ?Sized> {
    pub(super) name: &'static str,
    pub(super) system: Box<K>,
}

/// The emitted kernels over numbers with error bounds, and the generic copy over hyperdual numbers.
pub(super) trait System {
    fn n_coordinates(&self) -> usize;
    fn n_constraints(&self) -> usize;
    fn structure(&self) -> Structure;
    fn parameters(&self) -> Vec<f64>;
    fn kernels_rounded(&self, at: &Arguments<Rounded>) -> Values<Rounded>;
    fn lagrangian(&self, t: Outlined, q: &[Outlined], v: &[Outlined]) -> Outlined;
    fn constraints(&self, t: Outlined, q: &[Outlined]) -> Vec<Outlined>;
    fn n_inputs(&self) -> usize;
    fn n_observables(&self) -> usize;
    fn dissipation(&self, t: Outlined, q: &[Outlined], v: &[Outlined]) -> Outlined;
    fn forces(&self, t: Outlined, q: &[Outlined], v: &[Outlined], inputs: &[Outlined]) -> Vec<Outlined>;
}

impl<S: MechanicalSystem + GenericSystem> System for S {
    fn n_coordinates(&self) -> usize {
        assert_eq!(S::N_COORDINATES, GenericSystem::n_coordinates(self));
        S::N_COORDINATES
    }
    fn n_constraints(&self) -> usize {
        assert_eq!(S::N_CONSTRAINTS, GenericSystem::n_constraints(self));
        S::N_CONSTRAINTS
    }
    fn structure(&self) -> Structure {
        S::STRUCTURE
    }
    fn parameters(&self) -> Vec<f64> {
        MechanicalSystem::parameters(self).as_ref().to_vec()
    }
    fn kernels_rounded(&self, at: &Arguments<Rounded>) -> Values<Rounded> {
        evaluate::<S, Rounded>(at)
    }
    fn lagrangian(&self, t: Outlined, q: &[Outlined], v: &[Outlined]) -> Outlined {
        GenericSystem::lagrangian(self, t, q, v)
    }
    fn constraints(&self, t: Outlined, q: &[Outlined]) -> Vec<Outlined> {
        let mut residuals = vec![Outlined::from_f64(0.0); S::N_CONSTRAINTS];
        GenericSystem::constraints(self, t, q, &mut residuals);
        residuals
    }
    fn n_inputs(&self) -> usize {
        assert_eq!(S::N_INPUTS, GenericSystem::n_inputs(self));
        S::N_INPUTS
    }
    fn n_observables(&self) -> usize {
        S::OBSERVABLES.len()
    }
    fn dissipation(&self, t: Outlined, q: &[Outlined], v: &[Outlined]) -> Outlined {
        GenericSystem::dissipation(self, t, q, v)
    }
    fn forces(&self, t: Outlined, q: &[Outlined], v: &[Outlined], inputs: &[Outlined]) -> Vec<Outlined> {
        let mut forces = vec![Outlined::from_f64(0.0); S::N_COORDINATES];
        GenericSystem::add_forces(self, t, q, v, inputs, &mut forces);
        forces
    }
}

/// The emitted kernels over `f64`, for the scenes that also show that the scalar makes no difference:
/// optimising them for the random systems, too, would double the time that this test compiles.
pub(super) trait OverDoubles: System {
    fn kernels(&self, at: &Arguments<f64>) -> Values<f64>;
}

impl<S: MechanicalSystem + GenericSystem> OverDoubles for S {
    fn kernels(&self, at: &Arguments<f64>) -> Values<f64> {
        evaluate::<S, f64>(at)
    }
}

/// The emitted kernels over the scalars that only operators' scenes are compiled for.
pub(super) trait OtherScalars: OverDoubles {
    fn parameter_names(&self) -> &'static [&'static str];
    fn kernels_dual(&self, at: &Arguments<Dual64>) -> Values<Dual64>;
    fn kernels_single(&self, at: &Arguments<f32>) -> Values<f32>;
}

impl<S: MechanicalSystem + GenericSystem> OtherScalars for S {
    fn parameter_names(&self) -> &'static [&'static str] {
        S::PARAMETERS
    }
    fn kernels_dual(&self, at: &Arguments<Dual64>) -> Values<Dual64> {
        evaluate::<S, Dual64>(at)
    }
    fn kernels_single(&self, at: &Arguments<f32>) -> Values<f32> {
        evaluate::<S, f32>(at)
    }
}

/// What kernels are evaluated at.
#[derive(Clone)]
pub(super) struct Arguments<T> {
    pub(super) parameters: Vec<T>,
    pub(super) t: T,
    pub(super) q: Vec<T>,
    pub(super) v: Vec<T>,
    pub(super) inputs: Vec<T>,
}

impl Arguments<f64> {
    /// A point of the domain of all expressions.
    pub(super) fn random(system: &dyn System, seed: u64) -> Self {
        let mut random = SplitMix::new(seed);
        let n = system.n_coordinates();
        let mut values = |n: usize| (0..n).map(|_| random.between(-1.4, 1.4)).collect();
        let (q, v): (Vec<f64>, Vec<f64>) = (values(n), values(n));
        let t = random.between(0.2, 1.4);
        let inputs = (0..system.n_inputs()).map(|_| random.between(0.3, 1.4)).collect();
        Self { parameters: system.parameters(), t, q, v, inputs }
    }

    pub(super) fn map<T>(&self, convert: impl Fn(f64) -> T) -> Arguments<T> {
        let all = |values: &[f64]| values.iter().map(|&value| convert(value)).collect();
        Arguments {
            parameters: all(&self.parameters),
            t: convert(self.t),
            q: all(&self.q),
            v: all(&self.v),
            inputs: all(&self.inputs),
        }
    }
}

/// What all kernels of a system return.
pub(super) struct Values<T> {
    pub(super) constants: Vec<T>,
    pub(super) lagrangian: T,
    pub(super) gradient: [Vec<T>; 2],
    pub(super) fused_gradient: [Vec<T>; 2],
    pub(super) hessian_entries: Vec<T>,
    pub(super) constraints: Vec<T>,
    pub(super) fused_constraints: Vec<T>,
    pub(super) jacobian_entries: Vec<T>,
    pub(super) curvature: Vec<T>,
    pub(super) forces: Vec<T>,
    pub(super) fused_forces: Vec<T>,
    pub(super) force_entries: Vec<T>,
    pub(super) observables: Vec<T>,
}

pub(super) fn evaluate<S: MechanicalSystem, T: Scalar>(at: &Arguments<T>) -> Values<T> {
    let constants = S::constants::<T>(&S::PerParameter::from_fn(|i| at.parameters[i]));
    let q = S::PerCoordinate::<T>::from_fn(|i| at.q[i]);
    let v = S::PerCoordinate::<T>::from_fn(|i| at.v[i]);
    let gradient = S::lagrangian_gradient(&constants, at.t, &q, &v);
    let (fused_gradient, hessian_entries) = S::lagrangian_derivatives(&constants, at.t, &q, &v);
    let (fused_constraints, jacobian_entries) = S::constraint_derivatives(&constants, at.t, &q);
    let inputs = S::PerInput::<T>::from_fn(|i| at.inputs[i]);
    let (fused_forces, force_entries) = S::force_derivatives(&constants, at.t, &q, &v, &inputs);
    Values {
        forces: S::forces(&constants, at.t, &q, &v, &inputs).as_ref().to_vec(),
        fused_forces: fused_forces.as_ref().to_vec(),
        force_entries: force_entries.as_ref().to_vec(),
        observables: S::observables(&constants, at.t, &q, &v, &inputs).as_ref().to_vec(),
        lagrangian: S::lagrangian(&constants, at.t, &q, &v),
        gradient: [gradient.force.as_ref().to_vec(), gradient.momentum.as_ref().to_vec()],
        fused_gradient: [fused_gradient.force.as_ref().to_vec(), fused_gradient.momentum.as_ref().to_vec()],
        hessian_entries: hessian_entries.as_ref().to_vec(),
        constraints: S::constraints(&constants, at.t, &q).as_ref().to_vec(),
        fused_constraints: fused_constraints.as_ref().to_vec(),
        jacobian_entries: jacobian_entries.as_ref().to_vec(),
        curvature: S::constraint_curvature(&constants, at.t, &q, &v).as_ref().to_vec(),
        constants: constants.as_ref().to_vec(),
    }
}
