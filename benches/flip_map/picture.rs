//! Times as colours.

/// From late to early: colours of equal steps in lightness (viridis, van der Walt & Smith, 2015).
const COLOURS: [[f64; 3]; 9] = [
    [68.0, 1.0, 84.0],
    [71.0, 44.0, 122.0],
    [59.0, 81.0, 139.0],
    [44.0, 113.0, 142.0],
    [33.0, 144.0, 141.0],
    [39.0, 173.0, 129.0],
    [92.0, 200.0, 99.0],
    [170.0, 220.0, 50.0],
    [253.0, 231.0, 37.0],
];
/// Of starts that do not flip.
const NEVER: [u8; 3] = [0, 0, 0];

/// The colour of the share of flips that come later.
fn colour(share_later: f64) -> [u8; 3] {
    let place = share_later * (COLOURS.len() - 1) as f64;
    let lower = (place as usize).min(COLOURS.len() - 2);
    let share = place - lower as f64;
    std::array::from_fn(|k| ((1.0 - share) * COLOURS[lower][k] + share * COLOURS[lower + 1][k]).round() as u8)
}

/// A square picture of the times as a PNG file, row by row from the bottom; NaN where there is none. Each colour has the same number of starts.
pub(crate) fn png(width: usize, times: &[f64]) -> Result<Vec<u8>, png::EncodingError> {
    let mut sorted: Vec<f64> = times.iter().copied().filter(|t| !t.is_nan()).collect();
    sorted.sort_by(f64::total_cmp);
    let of = |t: &f64| {
        if t.is_nan() {
            return NEVER;
        }
        let sooner = sorted.partition_point(|other| other < t);
        colour(1.0 - sooner as f64 / sorted.len() as f64)
    };
    let pixels: Vec<u8> = times.chunks(width).rev().flatten().flat_map(of).collect();
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, width as u32, width as u32);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(&pixels)?;
    writer.finish()?;
    Ok(file)
}
