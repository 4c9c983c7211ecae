//! Curves side by side, as an SVG.

use std::error::Error;
use std::path::Path;

use plotters::prelude::*;

const PANEL: (u32, u32) = (520, 400);
const FONT: &str = "sans-serif";
const COLOURS: [RGBColor; 6] = [
    RGBColor(0x1f, 0x77, 0xb4),
    RGBColor(0xd6, 0x27, 0x28),
    RGBColor(0x2c, 0xa0, 0x2c),
    RGBColor(0x94, 0x67, 0xbd),
    RGBColor(0xff, 0x7f, 0x0e),
    RGBColor(0x7f, 0x7f, 0x7f),
];

/// What a curve looks like.
#[derive(Clone, Copy, PartialEq, Eq)]
#[allow(dead_code, reason = "each example draws with some of them")]
pub(crate) enum Mark {
    /// A line through the points.
    Line,
    /// The points alone.
    Dots,
}

/// Points in a panel.
pub(crate) struct Curve {
    /// Text in the legend; curves without one stand in no legend.
    pub(crate) label: Option<&'static str>,
    pub(crate) colour: usize,
    pub(crate) mark: Mark,
    pub(crate) points: Vec<(f64, f64)>,
}

/// A pair of axes.
pub(crate) struct Panel {
    pub(crate) title: &'static str,
    pub(crate) x_label: &'static str,
    pub(crate) y_label: &'static str,
    /// Whether lengths along both axes are equal.
    pub(crate) is_to_scale: bool,
    pub(crate) curves: Vec<Curve>,
}

/// Draws panels side by side.
pub(crate) fn draw(path: &Path, panels: &[Panel]) -> Result<(), Box<dyn Error>> {
    let size = (PANEL.0 * panels.len() as u32, PANEL.1);
    let canvas = SVGBackend::new(path, size).into_drawing_area();
    canvas.fill(&WHITE)?;
    for (panel, area) in panels.iter().zip(canvas.split_evenly((1, panels.len()))) {
        let (x_range, y_range) = ranges(panel);
        let mut chart = ChartBuilder::on(&area)
            .caption(panel.title, (FONT, 17))
            .margin(12)
            .x_label_area_size(40)
            .y_label_area_size(56)
            .build_cartesian_2d(x_range, y_range)?;
        chart
            .configure_mesh()
            .x_desc(panel.x_label)
            .y_desc(panel.y_label)
            .label_style((FONT, 13))
            .x_label_formatter(&tick)
            .y_label_formatter(&tick)
            .light_line_style(TRANSPARENT)
            .draw()?;
        for curve in &panel.curves {
            let colour = COLOURS[curve.colour % COLOURS.len()];
            let drawn = match curve.mark {
                Mark::Line => {
                    let style = colour.stroke_width(2);
                    chart.draw_series(LineSeries::new(curve.points.iter().copied(), style))?
                }
                Mark::Dots => {
                    let dot = |point: &(f64, f64)| Circle::new(*point, 2, colour.mix(0.6).filled());
                    chart.draw_series(curve.points.iter().map(dot))?
                }
            };
            if let Some(label) = curve.label {
                drawn
                    .label(label)
                    .legend(move |(x, y)| Rectangle::new([(x, y - 2), (x + 16, y + 2)], colour.filled()));
            }
        }
        if panel.curves.iter().any(|curve| curve.label.is_some()) {
            chart
                .configure_series_labels()
                .position(SeriesLabelPosition::UpperRight)
                .background_style(WHITE.mix(0.85))
                .border_style(BLACK.mix(0.2))
                .label_font((FONT, 13))
                .draw()?;
        }
    }
    canvas.present()?;
    Ok(())
}

/// A number at an axis, of the digits that tell it from its neighbours.
fn tick(x: &f64) -> String {
    let text = format!("{x:.6}");
    match text.trim_end_matches('0').trim_end_matches('.') {
        "-0" => "0".into(),
        text => text.into(),
    }
}

/// The axes that show every point, with some air, and room for the legend above.
fn ranges(panel: &Panel) -> (std::ops::Range<f64>, std::ops::Range<f64>) {
    let points = || panel.curves.iter().flat_map(|curve| &curve.points);
    let around = |values: &mut dyn Iterator<Item = f64>| {
        let (low, high) =
            values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
        let air = 0.06 * (high - low).max(1e-9);
        (low - air, high + air)
    };
    let (mut x, mut y) =
        (around(&mut points().map(|point| point.0)), around(&mut points().map(|point| point.1)));
    if panel.is_to_scale {
        // Of a panel without its labels.
        const ASPECT: f64 = 1.3;
        let (width, height) = (x.1 - x.0, y.1 - y.0);
        let (wide, high) = (width.max(ASPECT * height), height.max(width / ASPECT));
        let widen = |(low, high): (f64, f64), length: f64| {
            let middle = 0.5 * (low + high);
            (middle - 0.5 * length, middle + 0.5 * length)
        };
        (x, y) = (widen(x, wide), widen(y, high));
    }
    const LEGEND_ROW: f64 = 0.075;
    let rows = panel.curves.iter().filter(|curve| curve.label.is_some()).count();
    y.1 += LEGEND_ROW * rows as f64 * (y.1 - y.0);
    (x.0..x.1, y.0..y.1)
}
