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
    /// Of the slope.
    pub(crate) standard_error: f64,
    /// Largest and smallest step size of the fit.
    pub(crate) from_h: f64,
    pub(crate) to_h: f64,
}

/// Errors above this fraction of the configuration are coarse.
const COARSE: f64 = 1e-2;
/// Number of neighbouring step sizes that a slope is fitted to.
const POINTS: usize = 6;
/// The asymptotic range: there the standard error of the slope is no more than this fraction of it.
const SETTLED: f64 = 0.02;

/// The order of a method with a step size, from the straightest stretch of [`POINTS`] step sizes below coarse errors, if its slope has settled
/// there: what round-off or the next terms of the error bend has none.
///
/// `rows` are the runs of one method on one scene; `size` is the length of the configuration.
pub(crate) fn fit(rows: &[&Row], size: f64) -> Option<Fitted> {
    let mut points: Vec<(f64, f64)> = rows.iter().filter_map(|row| row.h.zip(row.position_error)).collect();
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (stretch, line) = points
        .windows(POINTS)
        .filter(|stretch| stretch.iter().all(|point| 0.0 < point.1 && point.1 < COARSE * size))
        .map(|stretch| (stretch, Line::through(stretch)))
        .min_by(|a, b| a.1.relative_error().total_cmp(&b.1.relative_error()))?;
    (line.relative_error() <= SETTLED).then(|| Fitted {
        scene: rows[0].scene.clone(),
        method: rows[0].method.clone(),
        nominal: rows[0].order,
        order: line.slope,
        standard_error: line.standard_error,
        from_h: stretch[POINTS - 1].0,
        to_h: stretch[0].0,
    })
}

/// A line through logarithms, by least squares.
struct Line {
    slope: f64,
    standard_error: f64,
}

impl Line {
    fn through(points: &[(f64, f64)]) -> Self {
        let n = points.len() as f64;
        let logarithms = || points.iter().map(|(x, y)| (x.ln(), y.ln()));
        let mean_x = logarithms().map(|(x, _)| x).sum::<f64>() / n;
        let mean_y = logarithms().map(|(_, y)| y).sum::<f64>() / n;
        let variance: f64 = logarithms().map(|(x, _)| (x - mean_x).powi(2)).sum();
        let slope = logarithms().map(|(x, y)| (x - mean_x) * (y - mean_y)).sum::<f64>() / variance;
        let squares: f64 = logarithms().map(|(x, y)| (y - mean_y - slope * (x - mean_x)).powi(2)).sum();
        Self { slope, standard_error: (squares / (n - 2.0) / variance).sqrt() }
    }

    fn relative_error(&self) -> f64 {
        self.standard_error / self.slope.abs()
    }
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
        let error = |h: f64| if h > 0.1 { 1.0 } else { 3.0 * h.powi(3) + 1e-14 * (1e6 * h).sin().abs() };
        let order = fitted(error).expect("six points");
        assert!((order - 3.0).abs() < 0.05, "{order}");
    }

    #[test]
    fn a_slope_that_does_not_settle_is_no_order() {
        assert_eq!(fitted(|h| 1e-3 * h.powi(4) * (2.0 + (3.0 * h.ln()).sin())), None);
    }

    #[test]
    fn errors_that_stay_coarse_have_no_order() {
        assert_eq!(fitted(|_| 0.3), None);
    }
}
