//! What the kernels say and what dual numbers say, in the same order.

use super::*;

/// Quantities of one kind, dense and row by row, so that their round-off has one scale.
pub(super) struct Block<T> {
    pub(super) name: &'static str,
    pub(super) values: Vec<T>,
}

/// What the kernels say: matrices assembled from the structure's patterns, absent entries zero.
pub(super) fn blocks<T: Scalar>(system: &dyn System, values: Values<T>) -> Vec<Block<T>> {
    let (n, m) = (system.n_coordinates(), system.n_constraints());
    let Structure { hessian, jacobian, forces, .. } = system.structure();
    let dense =
        |entries: &[Entry], shape, varying: &[T]| assembled(entries, shape, &values.constants, varying);
    let of_lagrangian = |entries, shape| dense(entries, shape, &values.hessian_entries);
    let of_constraints = |entries, shape| dense(entries, shape, &values.jacobian_entries);
    let of_forces = |entries| dense(entries, (n, n), &values.force_entries);
    let matrices = [
        ("qq", lower_triangle(of_lagrangian(hessian.qq, (n, n)), n)),
        ("vq", of_lagrangian(hessian.vq, (n, n))),
        ("vv", lower_triangle(of_lagrangian(hessian.vv, (n, n)), n)),
        ("vt", of_lagrangian(hessian.vt, (n, 1))),
        ("∂φ/∂q", of_constraints(jacobian.q, (m, n))),
        ("∂φ/∂t", of_constraints(jacobian.t, (m, 1))),
        ("∂f/∂q", of_forces(forces.q)),
        ("∂f/∂v", of_forces(forces.v)),
    ];
    let [force, momentum] = values.gradient;
    let [fused_force, fused_momentum] = values.fused_gradient;
    let vectors = [
        ("L", vec![values.lagrangian]),
        ("force", force),
        ("momentum", momentum),
        ("fused force", fused_force),
        ("fused momentum", fused_momentum),
        ("φ", values.constraints),
        ("fused φ", values.fused_constraints),
        ("γ", values.curvature),
        ("f", values.forces),
        ("fused f", values.fused_forces),
        ("observed", values.observables),
    ];
    vectors.into_iter().chain(matrices).map(|(name, values)| Block { name, values }).collect()
}

/// The matrix of some entries, row by row.
pub(super) fn assembled<T: Scalar>(
    entries: &[Entry],
    (n_rows, n_cols): (usize, usize),
    constants: &[T],
    varying: &[T],
) -> Vec<T> {
    let mut matrix = vec![None; n_rows * n_cols];
    for entry in entries {
        assert!(entry.row < n_rows && entry.col < n_cols, "{entry:?} lies outside");
        let previous = matrix[entry.row * n_cols + entry.col].replace(entry.value(constants, varying));
        assert!(previous.is_none(), "{entry:?} is given twice");
    }
    matrix.into_iter().map(|value| value.unwrap_or(T::from_f64(0.0))).collect()
}

pub(super) fn lower_triangle<T: Copy>(matrix: Vec<T>, n: usize) -> Vec<T> {
    (0..n)
        .flat_map(|row| (0..=row).map(move |col| (row, col)))
        .map(|(row, col)| matrix[row * n + col])
        .collect()
}

/// What dual numbers say of the generic copy, in the order of [`blocks`].
pub(super) fn reference(system: &dyn System, at: &Arguments<f64>) -> Vec<Block<f64>> {
    let (n, m) = (system.n_coordinates(), system.n_constraints());
    // Directions: q, then v, then t.
    let time = 2 * n;
    let lagrangian = |first: usize, second: usize| {
        let seeded = |value: f64, index: usize| {
            let part = |direction| f64::from(u8::from(direction == index));
            Outlined::new(value, part(first), part(second))
        };
        let seeded_all = |values: &[f64], offset: usize| -> Vec<Outlined> {
            values.iter().enumerate().map(|(i, &value)| seeded(value, offset + i)).collect()
        };
        system.lagrangian(seeded(at.t, time), &seeded_all(&at.q, 0), &seeded_all(&at.v, n))
    };
    let constraints = |direction: &dyn Fn(usize) -> f64| {
        let seeded = |value, index| Outlined::new(value, direction(index), direction(index));
        let q: Vec<Outlined> = at.q.iter().enumerate().map(|(i, &value)| seeded(value, i)).collect();
        system.constraints(seeded(at.t, time), &q)
    };
    let along = |index: usize| constraints(&|other| f64::from(u8::from(other == index)));
    let motion = constraints(&|index| if index == time { 1.0 } else { at.v[index] });
    let gradient =
        |offset: usize| -> Vec<f64> { (0..n).map(|i| lagrangian(offset + i, time).0.eps1).collect() };
    let second = |first: usize, second: usize| lagrangian(first, second).0.eps1eps2;
    let lower = |offset: usize| -> Vec<f64> {
        let places = (0..n).flat_map(|row| (0..=row).map(move |col| (row, col)));
        places.map(|(row, col)| second(offset + row, offset + col)).collect()
    };
    // The force in every direction: the generalized one, less the slope of the dissipation.
    let force = |along: usize| -> Vec<Outlined> {
        let part = |direction: usize, index| f64::from(u8::from(direction == index));
        let seeded = |first: usize, offset: usize, values: &[f64]| -> Vec<Outlined> {
            let seed = |(i, &value)| Outlined::new(value, part(first, offset + i), part(along, offset + i));
            values.iter().enumerate().map(seed).collect()
        };
        let t = Outlined::new(at.t, 0.0, part(along, time));
        let inputs: Vec<Outlined> = at.inputs.iter().map(|&u| Outlined::from_f64(u)).collect();
        let none = 2 * n + 1;
        let generalized = system.forces(t, &seeded(none, 0, &at.q), &seeded(none, n, &at.v), &inputs);
        let slope = |i: usize| system.dissipation(t, &seeded(n + i, 0, &at.q), &seeded(n + i, n, &at.v)).0;
        let total = |(i, force): (usize, Outlined)| {
            let slope = slope(i);
            Outlined::new(force.0.re - slope.eps1, 0.0, force.0.eps2 - slope.eps1eps2)
        };
        generalized.into_iter().enumerate().map(total).collect()
    };
    let force_columns: Vec<Vec<Outlined>> = (0..2 * n).map(force).collect();
    let forces: Vec<f64> = force_columns[0].iter().map(|force| force.0.re).collect();
    let force_slopes = |offset: usize| -> Vec<f64> {
        (0..n * n).map(|k| force_columns[offset + k % n][k / n].0.eps2).collect()
    };
    // Scenes that observe something observe L times the second and the first input.
    let value = lagrangian(0, 0).0.re;
    let observed = (0..system.n_observables()).map(|k| at.inputs[1 - k] * value).collect();
    let columns: Vec<Vec<Outlined>> = (0..n).map(along).collect();
    let residuals: Vec<f64> = motion.iter().map(|residual| residual.0.re).collect();
    [
        ("L", vec![lagrangian(0, 0).0.re]),
        ("force", gradient(0)),
        ("momentum", gradient(n)),
        ("fused force", gradient(0)),
        ("fused momentum", gradient(n)),
        ("φ", residuals.clone()),
        ("fused φ", residuals),
        ("γ", motion.iter().map(|residual| residual.0.eps1eps2).collect()),
        ("f", forces.clone()),
        ("fused f", forces),
        ("observed", observed),
        ("qq", lower(0)),
        ("vq", (0..n * n).map(|k| second(n + k / n, k % n)).collect()),
        ("vv", lower(n)),
        ("vt", (0..n).map(|row| second(n + row, time)).collect()),
        ("∂φ/∂q", (0..m * n).map(|k| columns[k % n][k / n].0.eps1).collect()),
        ("∂φ/∂t", along(time).iter().map(|residual| residual.0.eps1).collect()),
        ("∂f/∂q", force_slopes(0)),
        ("∂f/∂v", force_slopes(n)),
    ]
    .map(|(name, values)| Block { name, values })
    .into()
}
