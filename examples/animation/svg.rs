//! A motion as a picture that moves: one SVG file, which browsers play without a script.

use std::fmt::Write;

/// Light and dark.
const STYLE: &str = "\
svg{background:#fff}path{fill:none;stroke-linejoin:round;stroke-linecap:round;vector-effect:non-scaling-stroke}\
.body{stroke:#1f4e79;stroke-width:2}.solid{stroke:#1f4e79;stroke-width:1.5;fill:#1f4e7933}.trail{stroke:#c0563b;stroke-width:1}\
.frame{stroke:#999;stroke-width:1}\
@media(prefers-color-scheme:dark){svg{background:#111}.body,.solid{stroke:#8fc1f0}.solid{fill:#8fc1f033}.trail{stroke:#f0916f}}";

/// A line in the plane that moves: its points in every frame, `[x, y]` with y upwards.
pub(crate) struct Line {
    /// Class of the style: `body`, `solid`, `trail` or `frame`.
    pub(crate) class: &'static str,
    /// As many points in every frame; a single frame is a line that does not move.
    pub(crate) frames: Vec<Vec<[f64; 2]>>,
}

/// The lines as an SVG that plays for `seconds`, over and over; `title` is what a reader hears who does not see it.
pub(crate) fn animation(title: &str, lines: &[Line], seconds: f64) -> String {
    const WIDTH: f64 = 800.0;
    const MARGIN: f64 = 20.0;
    let points = || lines.iter().flat_map(|line| line.frames.iter().flatten());
    let range = |axis: usize| {
        points().fold([f64::INFINITY, f64::NEG_INFINITY], |[least, most], point| {
            [least.min(point[axis]), most.max(point[axis])]
        })
    };
    let ([left, right], [bottom, top]) = (range(0), range(1));
    let scale = (WIDTH - 2.0 * MARGIN) / (right - left).max(top - bottom);
    let width = scale * (right - left) + 2.0 * MARGIN;
    let height = scale * (top - bottom) + 2.0 * MARGIN;
    let place = |[x, y]: [f64; 2]| [MARGIN + scale * (x - left), MARGIN + scale * (top - y)];
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width:.0} {height:.0}\" role=\"img\">\
         <title>{title}</title><style>{STYLE}</style>\n"
    );
    for Line { class, frames } in lines {
        let path = |frame: &Vec<[f64; 2]>| {
            frame.iter().map(|&point| place(point)).enumerate().fold(
                String::new(),
                |mut path, (k, [x, y])| {
                    // Writing to a string does not fail.
                    let _ = write!(path, "{}{x:.1} {y:.1}", if k == 0 { "M" } else { "L" });
                    path
                },
            )
        };
        let first = frames.first().map_or_else(String::new, path);
        let _ = write!(svg, "<path class=\"{class}\" d=\"{first}\">");
        if frames.len() > 1 {
            let frames: Vec<String> = frames.iter().map(path).collect();
            let _ = write!(
                svg,
                "<animate attributeName=\"d\" dur=\"{seconds}s\" repeatCount=\"indefinite\" values=\"{}\"/>",
                frames.join(";")
            );
        }
        svg.push_str("</path>\n");
    }
    svg.push_str("</svg>\n");
    svg
}
