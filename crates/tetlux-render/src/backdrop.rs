//! What stands in the volume and ends it: of opaque surfaces, for every pixel, the first that its ray meets.
//!
//! With d the direction of a pixel's ray and a, b, c a triangle's corners in eye space, the ray's line meets the triangle
//! where the volumes d.(b x c), d.(c x a) and d.(a x b) have one sign; they are the barycentric coordinates of the place,
//! times a factor (Olano and Greer 1997). They are linear in the pixel, need no clipping, and those of two triangles at
//! an edge are the same number but for its sign: no ray passes between them.

use glam::DVec3;
use rayon::prelude::*;
use tetlux_scene::Surface;

use crate::eye_space::EyeSpace;

/// Depth of what is not there: beyond every surface.
pub(crate) const BEYOND: f32 = 1e30;

/// Rows of pixels that one core draws at a time.
const BAND: usize = 8;

/// Pixels by which a triangle's bounds are widened, for rounding.
const MARGIN: f64 = 1e-6;

/// For every pixel, top row first, what ends its ray.
#[derive(Debug)]
pub(crate) struct Backdrop {
    /// Depth from the mesh's origin, in device units; [`BEYOND`] where nothing ends the ray.
    pub(crate) depths: Vec<f32>,
    /// Linear RGB, lit.
    colors: Vec<[f32; 3]>,
}

/// A corner of a triangle.
struct Corner {
    /// In eye space.
    eye: DVec3,
    /// Depth from the mesh's origin.
    level: f64,
}

/// A triangle that covers a pixel's centre, perhaps.
struct Seen {
    surface: u32,
    triangle: u32,
    /// First and one past the last pixel, in x and in y.
    columns: [u32; 2],
    rows: [u32; 2],
}

/// The nearest place on a pixel's ray so far.
#[derive(Clone, Copy)]
struct Hit {
    level: f64,
    /// Position in the list of the triangles seen.
    seen: u32,
}

impl Backdrop {
    /// Draws surfaces of a mesh whose device units per world unit are `scale`; near planes cut them too.
    pub(crate) fn new(surfaces: &[Surface], eye: &EyeSpace, scale: f64, size: [u32; 2]) -> Backdrop {
        let corners: Vec<Vec<Corner>> = surfaces.iter().map(|surface| corners(surface, eye, scale)).collect();
        let seen: Vec<Seen> = (0u32..)
            .zip(surfaces)
            .flat_map(|(i, surface)| triangles_seen(i, surface, &corners[i as usize], eye, size))
            .collect();
        let (width, height) = (size[0] as usize, size[1] as usize);
        let mut bands = vec![Vec::new(); height.div_ceil(BAND)];
        for (i, triangle) in (0u32..).zip(&seen) {
            for band in triangle.rows[0] as usize / BAND..=(triangle.rows[1] as usize - 1) / BAND {
                bands[band].push(i);
            }
        }
        let mut backdrop = Backdrop { depths: vec![BEYOND; width * height], colors: vec![[0.0; 3]; width * height] };
        let depths = backdrop.depths.par_chunks_mut(BAND * width);
        let colors = backdrop.colors.par_chunks_mut(BAND * width);
        bands.into_par_iter().zip(depths).zip(colors).enumerate().for_each(|(band, ((list, depths), colors))| {
            let first = band * BAND;
            let mut hits = vec![Hit { level: f64::INFINITY, seen: u32::MAX }; depths.len()];
            for i in list {
                let triangle = &seen[i as usize];
                let names = surfaces[triangle.surface as usize].triangles()[triangle.triangle as usize];
                let corners = names.map(|v| &corners[triangle.surface as usize][v as usize]);
                draw(triangle, i, corners, eye, (first, width), &mut hits);
            }
            for (i, hit) in hits.iter().enumerate().filter(|(_, hit)| hit.level.is_finite()) {
                let triangle = &seen[hit.seen as usize];
                let direction = direction(eye, i % width, first + i / width);
                depths[i] = hit.level as f32;
                colors[i] = lit(&surfaces[triangle.surface as usize], triangle.triangle, eye, direction);
            }
        });
        backdrop
    }

    /// The brightest channel of any pixel.
    pub(crate) fn brightest(&self) -> f32 {
        self.colors.iter().flatten().fold(0.0, |most, &c| c.max(most))
    }

    /// Composites it behind a picture of the volume before it.
    pub(crate) fn put_behind(&self, pixels: &mut [[f32; 4]]) {
        for ((pixel, color), &depth) in pixels.iter_mut().zip(&self.colors).zip(&self.depths) {
            if depth < BEYOND {
                let left = 1.0 - pixel[3];
                let [r, g, b] = [0, 1, 2].map(|k| pixel[k] + left * color[k]);
                *pixel = [r, g, b, 1.0];
            }
        }
    }
}

fn corners(surface: &Surface, eye: &EyeSpace, scale: f64) -> Vec<Corner> {
    let corner = |p: &glam::Vec3| {
        let frame = eye.frame(p.as_dvec3() * scale);
        Corner { eye: frame + eye.offset, level: frame.z }
    };
    surface.points().par_iter().map(corner).collect()
}

/// The triangles of a surface that may cover a pixel's centre; those of no area cover none.
fn triangles_seen(number: u32, surface: &Surface, corners: &[Corner], eye: &EyeSpace, size: [u32; 2]) -> Vec<Seen> {
    let seen = |(index, names): (usize, &[u32; 3])| {
        let at = names.map(|v| &corners[v as usize]);
        let bounds = eye.seen_bounds(at.map(|corner| corner.eye));
        let [columns, rows] = [0, 1].map(|axis| {
            // The pixels whose centres, at i + 1/2, lie between the bounds. A conversion of a float saturates.
            let first = (bounds[0][axis] - MARGIN - 0.5).ceil().max(0.0) as u32;
            let end = ((bounds[1][axis] + MARGIN - 0.5).floor() + 1.0).max(0.0) as u32;
            [first, end.min(size[axis])]
        });
        let covers = columns[0] < columns[1] && rows[0] < rows[1] && normal(surface, index as u32) != DVec3::ZERO;
        covers.then_some(Seen { surface: number, triangle: index as u32, columns, rows })
    };
    surface.triangles().par_iter().enumerate().filter_map(seen).collect()
}

/// A vector along a triangle's normal in the mesh's axes; 0 if it has no area.
fn normal(surface: &Surface, triangle: u32) -> DVec3 {
    let [a, b, c] = surface.triangles()[triangle as usize].map(|v| surface.points()[v as usize].as_dvec3());
    (b - a).cross(c - a)
}

/// Where the ray of a pixel goes in eye space, or starts if rays are parallel.
fn direction(eye: &EyeSpace, x: usize, y: usize) -> DVec3 {
    let [x, y] = [x, y].map(|i| i as f64 + 0.5);
    DVec3::new((x - eye.middle[0]) * eye.pixel, (y - eye.middle[1]) * eye.pixel, 1.0)
}

/// Draws a triangle into the hits of a band of rows of that first row and width.
fn draw(
    triangle: &Seen,
    number: u32,
    corners: [&Corner; 3],
    eye: &EyeSpace,
    (first, width): (usize, usize),
    hits: &mut [Hit],
) {
    // Parallel rays meet what perspective ones do of the same triangle in the plane at unit depth.
    let [a, b, c] = corners.map(|corner| if eye.orthographic { corner.eye.with_z(1.0) } else { corner.eye });
    let volumes = [b.cross(c), c.cross(a), a.cross(b)];
    let levels = corners.map(|corner| corner.level);
    let near = eye.near - eye.offset.z;
    let rows = (triangle.rows[0] as usize).max(first)..(triangle.rows[1] as usize).min(first + hits.len() / width);
    for y in rows {
        for x in triangle.columns[0] as usize..triangle.columns[1] as usize {
            let ray = direction(eye, x, y);
            let [p, q, r] = volumes.map(|v| v.x * ray.x + (v.y * ray.y + v.z));
            let sum = p + q + r;
            let inside = (p >= 0.0 && q >= 0.0 && r >= 0.0) || (p <= 0.0 && q <= 0.0 && r <= 0.0);
            if !inside || sum == 0.0 {
                continue;
            }
            let level = (p * levels[0] + q * levels[1] + r * levels[2]) / sum;
            let hit = &mut hits[(y - first) * width + x];
            if level >= near && level < hit.level {
                *hit = Hit { level, seen: number };
            }
        }
    }
}

/// The colour of a triangle on the ray of that direction.
fn lit(surface: &Surface, triangle: u32, eye: &EyeSpace, direction: DVec3) -> [f32; 3] {
    let along = if eye.orthographic { DVec3::Z } else { direction };
    let view = -eye.turned_back(along.normalize());
    let color = surface.light().luminance(surface.color(), normal(surface, triangle).to_array(), view.to_array());
    color.map(|c| c as f32)
}

#[cfg(test)]
mod tests;
