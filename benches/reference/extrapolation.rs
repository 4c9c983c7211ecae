//! Extrapolation of the explicit midpoint rule: Gragg, Bulirsch and Stoer (Hairer, Nørsett, Wanner, Solving ODEs I, sec. II.9).
//!
//! It shares nothing with the integrators of this project, and its coefficients are whole numbers.

use evi_core::scalar::Scalar;

/// Columns of the extrapolation table: order 24.
const COLUMNS: usize = 12;

/// `y(t + h)` from `y(t)` for `y' = f(t, y)`: substeps `h/2, h/4, …, h/24`, extrapolated to zero in powers of their squares.
pub(crate) fn step<T: Scalar>(f: &impl Fn(T, &[T]) -> Vec<T>, t: T, y: &[T], h: T) -> Vec<T> {
    let mut table: Vec<Vec<T>> = Vec::with_capacity(COLUMNS);
    for column in 0..COLUMNS {
        let substeps = 2 * (column + 1);
        table.push(gragg(f, t, y, h, substeps));
        // In place, the youngest row first: table[j] becomes the entry that has used one more substep size.
        for j in (0..column).rev() {
            let weight = T::from_f64(1.0) / (exact_square::<T>(substeps, 2 * (j + 1)) - T::from_f64(1.0));
            for i in 0..y.len() {
                let finer = table[j + 1][i];
                table[j][i] = finer + (finer - table[j][i]) * weight;
            }
        }
    }
    table.swap_remove(0)
}

/// `(a/b)²` without rounding before the division.
fn exact_square<T: Scalar>(a: usize, b: usize) -> T {
    T::from_f64((a * a) as f64) / T::from_f64((b * b) as f64)
}

/// The explicit midpoint rule after one step of Euler, in an even number of substeps; its error is even in the substep.
fn gragg<T: Scalar>(f: &impl Fn(T, &[T]) -> Vec<T>, t: T, y: &[T], h: T, substeps: usize) -> Vec<T> {
    let substep = h / T::from_f64(substeps as f64);
    let along = |from: &[T], slope: &[T], length: T| -> Vec<T> {
        from.iter().zip(slope).map(|(&y, &slope)| y + length * slope).collect()
    };
    let mut before = y.to_vec();
    let mut here = along(y, &f(t, y), substep);
    for k in 1..substeps {
        let slope = f(t + substep * T::from_f64(k as f64), &here);
        let next = along(&before, &slope, T::from_f64(2.0) * substep);
        before = std::mem::replace(&mut here, next);
    }
    here
}
