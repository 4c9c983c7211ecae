//! The order that a method shows: the slope of its errors over its step sizes, in the asymptotic range.

use serde::Serialize;

use crate::results::Row;

/// A fitted order beside the nominal one.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Fitted {
    pub(crate) scene: String,
    pub(crate) method: String,
    pub(crate) nominal: u32,
    /// Slope of `log ‖q − q*‖` over `log h`, by least squares.
    pub(crate) order: f64,
    /// Number of step sizes in the fit.
    pub(crate) points: usize,
    /// Largest and smallest step size of the fit.
    pub(crate) from_h: f64,
    pub(crate) to_h: f64,
}

/// Errors above this fraction of the configuration are coarse.
const COARSE: f64 = 1e-2;
/// Errors within this factor of the smallest one that the method reaches may be round-off.
const ABOVE_ROUND_OFF: f64 = 1e2;
/// The smallest error of a method is round-off if it is below this fraction of the configuration.
const ROUND_OFF: f64 = 1e-9;
/// The finest points, so many, lie in the asymptotic range if any do.
const POINTS: usize = 6;

/// The order of a method with a step size, if at least three points lie between coarse errors and round-off.
///
/// `rows` are the runs of one method on one scene; `size` is the length of the configuration.
pub(crate) fn fit(rows: &[&Row], size: f64) -> Option<Fitted> {
    let mut points: Vec<(f64, f64)> =
        rows.iter().filter_map(|row| row.h.zip(row.position_error)).filter(|point| point.1 > 0.0).collect();
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    let smallest = points.iter().map(|point| point.1).fold(f64::INFINITY, f64::min);
    let floor = if smallest < ROUND_OFF * size { ABOVE_ROUND_OFF * smallest } else { 0.0 };
    // From the finest on, the first unbroken stretch.
    let asymptotic: Vec<(f64, f64)> = points
        .into_iter()
        .skip_while(|point| point.1 < floor)
        .take_while(|point| point.1 < COARSE * size)
        .take(POINTS)
        .collect();
    let [(to_h, _), .., (from_h, _)] = asymptotic[..] else { return None };
    let logarithms: Vec<(f64, f64)> = asymptotic.iter().map(|(h, e)| (h.ln(), e.ln())).collect();
    (logarithms.len() >= 3).then(|| Fitted {
        scene: rows[0].scene.clone(),
        method: rows[0].method.clone(),
        nominal: rows[0].order,
        order: slope(&logarithms),
        points: logarithms.len(),
        from_h,
        to_h,
    })
}

/// Least-squares slope.
fn slope(points: &[(f64, f64)]) -> f64 {
    let n = points.len() as f64;
    let (mean_x, mean_y) =
        (points.iter().map(|p| p.0).sum::<f64>() / n, points.iter().map(|p| p.1).sum::<f64>() / n);
    let covariance: f64 = points.iter().map(|p| (p.0 - mean_x) * (p.1 - mean_y)).sum();
    covariance / points.iter().map(|p| (p.0 - mean_x).powi(2)).sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::fit;
    use crate::results::Row;

    /// Runs at `h = 2^-k` with the errors `error(h)`.
    fn rows(error: impl Fn(f64) -> f64) -> Vec<Row> {
        let row =
            |h: f64| Row { h: Some(h), position_error: Some(error(h)), ..Row::empty("a scene", "a method") };
        (0..12).map(|k| row(0.5_f64.powi(k))).collect()
    }

    fn fitted(error: impl Fn(f64) -> f64) -> Option<f64> {
        let rows = rows(error);
        fit(&rows.iter().collect::<Vec<_>>(), 1.0).map(|fit| fit.order)
    }

    #[test]
    fn a_power_of_the_step_size_is_its_order() {
        let order = fitted(|h| 0.7 * h.powi(4)).expect("many points");
        assert!((order - 4.0).abs() < 1e-9, "{order}");
    }

    #[test]
    fn coarse_errors_and_round_off_are_left_out() {
        let order = fitted(|h| if h > 0.1 { 1.0 } else { 3.0 * h.powi(6) + 1e-14 }).expect("three points");
        assert!((order - 6.0).abs() < 0.05, "{order}");
    }

    #[test]
    fn errors_that_stay_coarse_have_no_order() {
        assert_eq!(fitted(|_| 0.3), None);
    }
}
