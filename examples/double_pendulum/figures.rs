//! Measurements as figures: two panels, one per start, and one legend.

use std::error::Error;
use std::ops::Range;
use std::path::{Path, PathBuf};

use plotters::coord::Shift;
use plotters::prelude::*;

use crate::experiment::{InitialState, Measurement, Method, methods};

type Canvas<'a> = DrawingArea<SVGBackend<'a>, Shift>;

const SIZE: (u32, u32) = (1080, 440);
const LEGEND_WIDTH: u32 = 190;
const FONT: &str = "sans-serif";
/// Errors that are exactly zero are drawn here, at the bottom of a logarithmic axis.
const ZERO: f64 = 1e-17;

/// What a figure shows.
struct Figure {
    file: &'static str,
    title: &'static str,
    x_label: &'static str,
    y_label: &'static str,
    y_range: Range<f64>,
    /// Number of ticks of the horizontal axis.
    x_ticks: usize,
    /// Text at a tick of the horizontal axis.
    x_tick: fn(&f64) -> String,
}

/// Curves of one start.
struct Panel<'m> {
    x_range: Range<f64>,
    curves: Vec<(Method, Vec<(f64, f64)>)>,
    caption: &'m str,
}

/// Figure of the largest energy error over 100 steps against the step size.
pub(crate) fn energy_over_step_size(
    measurements: &[Measurement],
    folder: &Path,
) -> Result<PathBuf, Box<dyn Error>> {
    let figure = Figure {
        file: "energy_error.svg",
        title: "Largest energy error over 100 steps (of runs that took them all)",
        x_label: "step size h [s]",
        y_label: "max |H − H₀| [J]",
        y_range: 1e-14..1e2,
        x_ticks: 3,
        x_tick: power_of_ten,
    };
    over_step_size(&figure, measurements, |measurement| measurement.max_energy_error, folder)
}

/// Figure of the largest constraint error over 100 steps against the step size.
pub(crate) fn constraints_over_step_size(
    measurements: &[Measurement],
    folder: &Path,
) -> Result<PathBuf, Box<dyn Error>> {
    let figure = Figure {
        file: "constraint_error.svg",
        title: "Largest constraint error over 100 steps (of runs that took them all)",
        x_label: "step size h [s]",
        y_label: "max |φ| [m²]",
        y_range: ZERO..1e1,
        x_ticks: 3,
        x_tick: power_of_ten,
    };
    over_step_size(&figure, measurements, |measurement| measurement.max_constraint_error, folder)
}

/// Figure of the energy error over 20,000 steps against time.
pub(crate) fn energy_over_time(
    measurements: &[Measurement],
    folder: &Path,
) -> Result<PathBuf, Box<dyn Error>> {
    let figure = Figure {
        file: "long_run.svg",
        title: "Energy error over 20,000 steps (largest of every 100)",
        x_label: "time [s]",
        y_label: "|H − H₀| [J]",
        y_range: 1e-6..1e2,
        x_ticks: 5,
        x_tick: |time| format!("{time}"),
    };
    let panel = |state, end, caption| Panel {
        x_range: 0.0..end,
        curves: of_state(measurements, state)
            .map(|measurement| (measurement.case.method, measurement.energy_over_time.clone()))
            .collect(),
        caption,
    };
    let panels = [
        panel(InitialState::Horizontal, 200.0, "from horizontal, h = 0.01 s"),
        panel(InitialState::Mild, 1000.0, "from 0.1 rad, h = 0.05 s"),
    ];
    draw(&figure, &panels, folder)
}

/// A figure over the step size; runs that ended before their time are left out, as the table says.
fn over_step_size(
    figure: &Figure,
    measurements: &[Measurement],
    error: fn(&Measurement) -> f64,
    folder: &Path,
) -> Result<PathBuf, Box<dyn Error>> {
    let curve = |state, method| -> Vec<(f64, f64)> {
        of_state(measurements, state)
            .filter(|measurement| measurement.case.method == method && measurement.stopped.is_none())
            .map(|measurement| (measurement.case.h.log10(), error(measurement)))
            .collect()
    };
    let panel = |state, caption| Panel {
        x_range: -3.2..-0.8,
        curves: methods().into_iter().map(|method| (method, curve(state, method))).collect(),
        caption,
    };
    let panels =
        [panel(InitialState::Horizontal, "from horizontal"), panel(InitialState::Mild, "from 0.1 rad")];
    draw(figure, &panels, folder)
}

fn of_state(measurements: &[Measurement], state: InitialState) -> impl Iterator<Item = &Measurement> {
    measurements.iter().filter(move |measurement| measurement.case.state == state)
}

fn draw(figure: &Figure, panels: &[Panel<'_>], folder: &Path) -> Result<PathBuf, Box<dyn Error>> {
    let path = folder.join(figure.file);
    {
        let canvas = SVGBackend::new(&path, SIZE).into_drawing_area();
        canvas.fill(&WHITE)?;
        let canvas = canvas.titled(figure.title, (FONT, 20))?;
        let (plots, legend) = canvas.split_horizontally(SIZE.0 - LEGEND_WIDTH);
        for (panel, area) in panels.iter().zip(plots.split_evenly((1, panels.len()))) {
            draw_panel(figure, panel, &area)?;
        }
        draw_legend(&legend)?;
        canvas.present()?;
    }
    Ok(path)
}

fn draw_panel(figure: &Figure, panel: &Panel<'_>, area: &Canvas<'_>) -> Result<(), Box<dyn Error>> {
    let mut chart = ChartBuilder::on(area)
        .caption(panel.caption, (FONT, 16))
        .margin(10)
        .x_label_area_size(42)
        .y_label_area_size(68)
        .build_cartesian_2d(panel.x_range.clone(), figure.y_range.clone().log_scale())?;
    chart
        .configure_mesh()
        .light_line_style(WHITE)
        .bold_line_style(RGBColor(225, 225, 225))
        .x_desc(figure.x_label)
        .y_desc(figure.y_label)
        .x_labels(figure.x_ticks)
        .y_labels(10)
        .x_label_formatter(&figure.x_tick)
        .y_label_formatter(&|error| format!("{error:.0e}"))
        .label_style((FONT, 13))
        .axis_desc_style((FONT, 14))
        .draw()?;
    for (method, points) in &panel.curves {
        let points: Vec<(f64, f64)> = points
            .iter()
            .map(|&(x, error)| (x, error.clamp(figure.y_range.start, figure.y_range.end)))
            .collect();
        let color = color(*method);
        chart.draw_series(LineSeries::new(points.iter().copied(), color.stroke_width(2)))?;
        // Curves over the step size have few points, which get markers.
        if points.len() <= 3 {
            let size = marker_size(*method);
            chart.draw_series(points.iter().map(|&point| Circle::new(point, size, color.stroke_width(2))))?;
        }
    }
    Ok(())
}

fn draw_legend(area: &Canvas<'_>) -> Result<(), Box<dyn Error>> {
    const TOP: i32 = 50;
    const LINE: i32 = 26;
    for (row, method) in (0..).zip(methods()) {
        let y = TOP + LINE * row;
        let color = color(method);
        area.draw(&PathElement::new([(6, y), (34, y)], color.stroke_width(2)))?;
        area.draw(&Circle::new((20, y), marker_size(method), color.stroke_width(2)))?;
        area.draw(&Text::new(method.to_string(), (42, y - 7), (FONT, 14)))?;
    }
    Ok(())
}

/// Colours of Okabe and Ito, which colour-blind readers can tell apart.
fn color(method: Method) -> RGBColor {
    match method {
        Method::Evi { nodes: 1, omega: 0.0 } => RGBColor(0, 114, 178),
        Method::Evi { nodes: 1, omega } if omega < 3.0 => RGBColor(86, 180, 233),
        Method::Evi { nodes: 1, .. } => RGBColor(0, 158, 115),
        Method::Evi { omega: 0.0, .. } => RGBColor(230, 159, 0),
        Method::Evi { omega, .. } if omega < 3.0 => RGBColor(204, 121, 167),
        Method::Evi { .. } => RGBColor(150, 100, 40),
        Method::Rattle => RGBColor(90, 90, 90),
        Method::Rk4 => RGBColor(213, 94, 0),
    }
}

/// Rings of different size stay visible where curves lie on each other, as they do at u = 0.
fn marker_size(method: Method) -> i32 {
    match method {
        Method::Evi { nodes: 1, .. } => 3,
        Method::Evi { .. } => 6,
        Method::Rattle => 9,
        Method::Rk4 => 3,
    }
}

fn power_of_ten(exponent: &f64) -> String {
    if exponent.fract().abs() < 1e-9 { format!("1e{exponent:.0}") } else { String::new() }
}
