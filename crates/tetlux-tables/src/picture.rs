//! Pictures of tables and of their errors.

use tetlux_image::{Image, ImageError, difference_picture};

use crate::spec::{Design, SpecError, TableKind, TableSpec};
use crate::table::Table;

/// Width and height of a picture of values.
const SIDE: u32 = 640;

/// Contour lines between the least and the largest value.
const CONTOURS: f32 = 10.0;

/// Largest error on the scale of error pictures; its bottom is [`tetlux_image::DIFFERENCE_FLOOR`].
const TOP_OF_ERRORS: f64 = 0.1;

/// Colours from the least to the largest value: dark blue to yellow, luminance rising.
const SCALE: [[f32; 3]; 5] =
    [[0.06, 0.0, 0.09], [0.05, 0.08, 0.26], [0.01, 0.28, 0.26], [0.1, 0.6, 0.12], [0.98, 0.8, 0.02]];

/// Why there is no picture of a table's errors.
#[derive(Debug, thiserror::Error)]
pub enum PictureError {
    /// The table of twice the nodes is past the limits.
    #[error("the finer table to compare with: {0}")]
    Finer(#[from] SpecError),
    /// The picture cannot be made.
    #[error(transparent)]
    Image(#[from] ImageError),
}

/// A colour map of one channel with contour lines at tenths of its range, as the lookup interpolates it: the first
/// axis to the right, the second upwards, of a third axis the middle.
///
/// # Errors
/// [`ImageError`] if there is no memory for the picture.
pub fn value_picture(table: &Table, channel: usize) -> Result<Image, ImageError> {
    let last = (SIDE - 1) as f32;
    let value =
        |x: u32, y: u32| table.interpolate([x as f32 / last, (SIDE - 1 - y) as f32 / last, 0.5])[channel.min(3)];
    let values: Vec<f32> = (0..SIDE * SIDE).map(|index| value(index % SIDE, index / SIDE)).collect();
    let low = values.iter().copied().fold(f32::INFINITY, f32::min);
    let high = values.iter().copied().fold(f32::NEG_INFINITY, f32::max);
    let range = if high > low { high - low } else { 1.0 };
    let place = |x: u32, y: u32| (values[(y * SIDE + x) as usize] - low) / range;
    let mut image = Image::new(SIDE, SIDE)?;
    for (index, pixel) in (0..).zip(image.pixels_mut()) {
        let (x, y) = (index % SIDE, index / SIDE);
        let band = |x: u32, y: u32| (place(x, y) * CONTOURS).floor();
        let here = band(x, y);
        let crossed = here != band((x + 1).min(SIDE - 1), y) || here != band(x, (y + 1).min(SIDE - 1));
        *pixel = if crossed { [0.0, 0.0, 0.0, 1.0] } else { color_at(place(x, y)) };
    }
    Ok(image)
}

/// The error of interpolating the first channel at the centre of every cell, against a table of twice the nodes, on a
/// logarithmic scale from 1e-7 (black) to 0.1 (white). Tables of q and psi: the error of the blended colour; others: of
/// the stored value. Axes as in [`value_picture`].
///
/// # Errors
/// [`PictureError`] if there is no such finer table within the limits, or no memory.
pub fn error_picture(table: &Table) -> Result<Image, PictureError> {
    let [nx, ny, nz] = table.spec().size;
    let fine = TableSpec { size: [2 * nx - 1, 2 * ny - 1, nz], ..table.spec().clone() };
    let fine = Table::build(&TableSpec { precision: crate::Precision::F32, ..fine })?;
    let slice = nz as usize / 2;
    // The node itself, not a place between two.
    let z = if nz > 1 { slice as f32 / (nz - 1) as f32 } else { 0.0 };
    let mut pictures = [Vec::new(), Vec::new()];
    for j in (0..ny - 1).rev() {
        for i in 0..nx - 1 {
            let share = color_share(&fine, 2 * i + 1, 2 * j + 1);
            let at = [(i as f32 + 0.5) / (nx - 1) as f32, (j as f32 + 0.5) / (ny - 1) as f32, z];
            let exact = fine.texel(2 * i as usize + 1, 2 * j as usize + 1, slice)[0];
            pictures[0].push([table.interpolate(at)[0] * share, 0.0, 0.0, 1.0]);
            pictures[1].push([exact * share, 0.0, 0.0, 1.0]);
        }
    }
    let [got, exact] = pictures.map(|pixels| Image::from_pixels(nx - 1, ny - 1, pixels));
    Ok(difference_picture(&got?, &exact?, TOP_OF_ERRORS)?)
}

/// What an error of the stored value is to be multiplied with to be an error of the colour, at a node.
fn color_share(table: &Table, i: u32, j: u32) -> f32 {
    let x = table.axes()[0].value(i);
    let alpha = -(-x).exp_m1();
    let share = match table.spec().kind {
        TableKind::Q { design: Design::Q } | TableKind::QPair => alpha,
        TableKind::Q { design: Design::R | Design::R4 } => {
            let rho = table.axes()[1].value(j);
            alpha / crate::integral_tables::r_scale(2.0 * x * (1.0 - rho), 2.0 * x * rho)
        }
        _ => 1.0,
    };
    share as f32
}

fn color_at(position: f32) -> [f32; 4] {
    let scaled = position.clamp(0.0, 1.0) * (SCALE.len() - 1) as f32;
    let below = (scaled as usize).min(SCALE.len() - 2);
    let (low, high) = (SCALE[below], SCALE[below + 1]);
    let mix = |c: usize| low[c] + (scaled - below as f32) * (high[c] - low[c]);
    [mix(0), mix(1), mix(2), 1.0]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Precision;

    fn psi(nodes: u32) -> Table {
        let spec = TableSpec {
            id: "psi".to_owned(),
            kind: TableKind::Psi,
            size: [nodes, nodes, 1],
            precision: Precision::F32,
        };
        Table::build(&spec).unwrap()
    }

    #[test]
    fn psi_is_brightest_in_empty_space_and_has_nine_contours_along_the_diagonal() {
        let picture = value_picture(&psi(64), 0).unwrap();
        let at = |x: u32, y: u32| picture.pixels()[(y * SIDE + x) as usize];
        // psi(0, 0) = 1 at the lower left; psi = 0 where both depths are infinite.
        assert!(at(2, SIDE - 3)[0] > 0.9, "{:?}", at(2, SIDE - 3));
        assert!(at(SIDE - 3, 2)[0] < 0.1);
        // psi falls steadily along the diagonal, so every tenth is crossed once; a line may be two pixels wide there.
        let dark: Vec<u32> = (0..SIDE).filter(|&d| at(d, SIDE - 1 - d)[..3] == [0.0; 3]).collect();
        let lines = dark.windows(2).filter(|pair| pair[1] > pair[0] + 1).count() + 1;
        assert!((9..=11).contains(&lines), "{lines}");
    }

    #[test]
    fn the_error_of_psi_is_at_its_right_edge() {
        let picture = error_picture(&psi(64)).unwrap();
        let brightness = |x: usize, y: usize| picture.pixels()[y * 63 + x][..3].iter().sum::<f32>();
        // a infinite and b small: psi has a square root there; the lower right corner.
        assert!(brightness(62, 61) > brightness(10, 50) + 0.5);
        assert_eq!((picture.width(), picture.height()), (63, 63));
    }
}
