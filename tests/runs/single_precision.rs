//! Kernels in single precision.

use super::*;

/// Numbers rounded to single precision and back.
fn widened(values: &[f32]) -> Vec<f64> {
    values.iter().map(|value| f64::from(*value)).collect()
}

#[test]
fn kernels_in_single_precision_agree_to_single_precision() {
    type Scene = DoublePendulum;
    let Start { q, v } = moving();
    let single = |values: &[f64; 4]| values.map(|value| value as f32);
    let (q32, v32) = (single(&q), single(&v));
    let parameters = UNEQUAL.parameters();
    let constants = Scene::constants::<f64>(&parameters);
    let constants32 = Scene::constants::<f32>(&parameters.map(|parameter| parameter as f32));
    // Values of size 10 from arguments that are rounded themselves: 3 ε measured.
    let tolerance = 16.0 * f64::from(f32::EPSILON);

    let (gradient, hessian) = Scene::lagrangian_derivatives(&constants, 0.0, &q, &v);
    let (gradient32, hessian32) = Scene::lagrangian_derivatives(&constants32, 0.0, &q32, &v32);
    check_near(&widened(&gradient32.force), &gradient.force, tolerance);
    check_near(&widened(&gradient32.momentum), &gradient.momentum, tolerance);
    check_near(&widened(hessian32.as_ref()), hessian.as_ref(), tolerance);

    // Off the constraints, where the residuals are not zero.
    let (q, q32) = (q.map(|x| 1.5 * x), q32.map(|x| 1.5 * x));
    let (residual, jacobian) = Scene::constraint_derivatives(&constants, 0.0, &q);
    let (residual32, jacobian32) = Scene::constraint_derivatives(&constants32, 0.0, &q32);
    check_near(&widened(&residual32), &residual, tolerance);
    check_near(&widened(&jacobian32), &jacobian, tolerance);
    assert!(residual.iter().chain(&jacobian).all(|value| value.abs() > 0.1), "vacuous");

    let lagrangian = Scene::lagrangian(&constants, 0.0, &q, &v);
    let lagrangian32 = f64::from(Scene::lagrangian(&constants32, 0.0, &q32, &v32));
    check_near(&[lagrangian32], &[lagrangian], tolerance);
    // The kernel in single precision is not the one in double.
    assert_ne!(lagrangian32, lagrangian);
}
