//! Image functions in f32, function by function, as a shader has them.
//!
//! Along a segment luminance and extinction are quadratic between the lines of the grid of texels. The segment is cut at
//! these lines, and between them into pieces; on a piece depth and emission (three nodes of Gauss and
//! Legendre, exact to degree 5) are those of the function, and the light is their ratio times the piece's alpha.
//!
//! On a piece of depth X on which the luminance varies by d the error of the light is at most X d / 4 times its alpha:
//! the emission's excess over its mean, up to any point, is at most X d / 4. Both fall with the piece's length, so that
//! sqrt(X d / (4 bound)) pieces between two lines keep the whole segment within the bound.

#[cfg(test)]
mod tests;

use crate::image_function::ImageFunction;
use crate::segment_f32::opacity;
use crate::widgets_f32::Integrated;

/// No segment is cut into more pieces than about this.
pub const MAX_PIECES: u32 = 1024;

/// An image function as a shader has it.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    /// Luminance and, last, extinction per device unit; row by row, the lowest second scalar first.
    pub texels: Vec<[f32; 4]>,
    /// Texels along each axis.
    pub size: [u32; 2],
    /// Place on the grid of a normalised scalar p: p `scale` + `origin`.
    pub scale: [f32; 2],
    /// See `scale`.
    pub origin: [f32; 2],
}

/// The function with the fields' ranges mapped to [0, 1] (a range of no width counts as 1), and `extinction` per device
/// unit of opacity 1.
pub fn image(function: &ImageFunction, ranges: [[f64; 2]; 2], extinction: f64) -> Image {
    let axis = |k: usize| {
        let ([low, high], [first, last]) = (ranges[k], function.range()[k]);
        let width = if high > low { high - low } else { 1.0 };
        let per_unit = (function.size()[k] - 1) as f64 / (last - first);
        [(width * per_unit) as f32, ((low - first) * per_unit) as f32]
    };
    let [x, y] = [axis(0), axis(1)];
    let texel = |&[r, g, b, a]: &[f32; 4]| [r, g, b, (f64::from(a) * extinction).min(1e15) as f32];
    Image {
        texels: function.texels().iter().map(texel).collect(),
        size: function.size().map(|n| n as u32),
        scale: [x[0], y[0]],
        origin: [x[1], y[1]],
    }
}

/// The four texels of the cell of the grid that holds a place: (0, 0), (1, 0), (0, 1), (1, 1).
fn texels_around(image: &Image, cell: [u32; 2]) -> [[f32; 4]; 4] {
    let right = (cell[0] + 1).min(image.size[0] - 1);
    let up = (cell[1] + 1).min(image.size[1] - 1);
    [[cell[0], cell[1]], [right, cell[1]], [cell[0], up], [right, up]]
        .map(|[i, j]| image.texels[(j * image.size[0] + i) as usize])
}

/// Bilinear in a cell; x and y are clamped to it.
fn bilinear(corners: &[[f32; 4]; 4], x: f32, y: f32) -> [f32; 4] {
    let s = x.clamp(0.0, 1.0);
    let t = y.clamp(0.0, 1.0);
    [0, 1, 2, 3].map(|k| {
        let low = corners[0][k] + (corners[1][k] - corners[0][k]) * s;
        let high = corners[2][k] + (corners[3][k] - corners[2][k]) * s;
        low + (high - low) * t
    })
}

/// The cell of the grid that holds a place, of the two at a line the one ahead.
fn cell_of(place: f32, last: u32) -> u32 {
    // The cast takes negative values to 0.
    (place.floor().min(1e9) as u32).min(last.max(1) - 1)
}

/// Luminance and, last, extinction per device unit at a point of normalised scalars.
pub fn classify(image: &Image, point: [f32; 2]) -> [f32; 4] {
    let x = point[0] * image.scale[0] + image.origin[0];
    let y = point[1] * image.scale[1] + image.origin[1];
    let cell = [cell_of(x, image.size[0] - 1), cell_of(y, image.size[1] - 1)];
    bilinear(&texels_around(image, cell), x - cell[0] as f32, y - cell[1] as f32)
}

/// The next u beyond `u` at which a place that runs from `from` by `step` crosses a line of the grid; 2 if none.
fn next_line(from: f32, step: f32, u: f32, last: u32) -> f32 {
    if step.abs() < 1e-6 {
        return 2.0;
    }
    let place = from + step * (u + 1e-5);
    let mut line = place.floor() + 1.0;
    if step < 0.0 {
        line = place.ceil() - 1.0;
    }
    // Outside the function is constant.
    if step > 0.0 {
        line = line.max(0.0);
    } else {
        line = line.min(last as f32);
    }
    if line < 0.0 || line > last as f32 {
        return 2.0;
    }
    (line - from) / step
}

/// Largest difference of a luminance between two texels.
fn difference(a: [f32; 4], b: [f32; 4]) -> f32 {
    (a[0] - b[0]).abs().max((a[1] - b[1]).abs().max((a[2] - b[2]).abs()))
}

/// Premultiplied colour and alpha of a segment with normalised scalars `front` and `back`, of a length in device units:
/// alpha exact, the error of every channel at most `bound` (and what f32 cannot hold, some 1e-5).
///
/// The error is at most `bound` times the segment's alpha, too: that of every piece is at most its share of it.
pub fn integrate(image: &Image, front: [f32; 2], back: [f32; 2], length: f32, bound: f32) -> [f32; 4] {
    integrate_counted(image, front, back, length, bound).color
}

/// The same, with the pieces that it took.
pub fn integrate_counted(image: &Image, front: [f32; 2], back: [f32; 2], length: f32, bound: f32) -> Integrated {
    let from = [front[0] * image.scale[0] + image.origin[0], front[1] * image.scale[1] + image.origin[1]];
    let step = [(back[0] - front[0]) * image.scale[0], (back[1] - front[1]) * image.scale[1]];
    let last = [image.size[0] - 1, image.size[1] - 1];
    let mut result = [0.0; 4];
    let mut u = 0.0;
    let mut spent = 0;
    while u < 1.0 && spent < MAX_PIECES {
        let line = next_line(from[0], step[0], u, last[0]).min(next_line(from[1], step[1], u, last[1]));
        let end = line.max(u + 1e-6).min(1.0);
        // By the middle: an end may lie on a line.
        let middle = 0.5 * (u + end);
        let cell = [cell_of(from[0] + step[0] * middle, last[0]), cell_of(from[1] + step[1] * middle, last[1])];
        let c = texels_around(image, cell);
        let thickest = c[0][3].max(c[1][3].max(c[2][3].max(c[3][3])));
        if thickest > 0.0 {
            let width = end - u;
            let across = difference(c[0], c[1]).max(difference(c[2], c[3])) * step[0].abs();
            let along = difference(c[0], c[2]).max(difference(c[1], c[3])) * step[1].abs();
            let product = thickest * width * length * (across + along) * width;
            let count = (0.25 * product / bound).sqrt().clamp(1.0, 256.0).ceil();
            let place = [from[0] - cell[0] as f32, from[1] - cell[1] as f32];
            for k in 0..count as u32 {
                let u0 = u + width * (k as f32 / count);
                piece(&c, place, step, u0, width / count, length, &mut result);
                spent += 1;
            }
        }
        u = end;
    }
    Integrated { color: result, pieces: spent }
}

/// Composites the piece from u0 on behind what is there.
fn piece(c: &[[f32; 4]; 4], from: [f32; 2], step: [f32; 2], u0: f32, width: f32, length: f32, result: &mut [f32; 4]) {
    let at = |share: f32| {
        let u = u0 + width * share;
        bilinear(c, from[0] + step[0] * u, from[1] + step[1] * u)
    };
    let nodes = [at(0.11270167), at(0.5), at(0.8872983)];
    let weights = [5.0 / 18.0, 8.0 / 18.0, 5.0 / 18.0];
    let mut depth = 0.0;
    let mut emission = [0.0; 3];
    for k in 0..3 {
        let tau = weights[k] * nodes[k][3] * width * length;
        depth += tau;
        for channel in 0..3 {
            emission[channel] += tau * nodes[k][channel];
        }
    }
    if depth > 1e-30 {
        let seen = (1.0 - result[3]) * opacity(depth);
        for channel in 0..3 {
            result[channel] += seen * (emission[channel] / depth);
        }
        result[3] += seen;
    }
}
