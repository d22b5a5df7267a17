//! Which rays of a picture pass through a triangle: exactly, and as if no ray ever met an edge.
//!
//! A ray passes through a triangle if it passes all three edges on the same side: signs of determinants, linear in
//! the pixel, filtered in double precision and decided by exact arithmetic within the filter's error. A ray that meets
//! an edge counts as moved a little to the right or, if that is along the edge, down. So every ray passes through each
//! sheet of a closed surface at one triangle only, whatever the triangles' size, and also where vertices are behind
//! the eye, without any clipping.

use std::ops::Range;

use glam::{DVec3, Vec3};

use crate::Sampling;
use crate::exact::edge_sign;

/// The rays of a picture, in the mesh's own coordinates.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Rays {
    eye: DVec3,
    right: DVec3,
    down: DVec3,
    forward: DVec3,
    pixel: f64,
    size: [u32; 2],
    parallel: bool,
}

/// Pixels: columns, and rows.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Pixels {
    pub(crate) columns: Range<u32>,
    pub(crate) rows: Range<u32>,
}

/// Relative errors of a projection to pixels are far below this, in pixels, while [`SHALLOW`] holds.
pub(crate) const PROJECTION_ERROR: f64 = 1e-3;

/// Depth, over the sum of the distances along the axes, below which a vertex is not projected.
const SHALLOW: f64 = 1e-6;

impl Rays {
    pub(crate) fn new(sampling: &Sampling, origin: DVec3) -> Rays {
        let &Sampling { eye, right, down, forward, pixel, size, orthographic, .. } = sampling;
        Rays { eye: eye - origin, right, down, forward, pixel, size, parallel: orthographic }
    }

    /// Distance of the eye from the mesh's origin.
    pub(crate) fn eye_distance(&self) -> f64 {
        self.eye.length()
    }

    pub(crate) fn size(&self) -> [u32; 2] {
        self.size
    }

    /// 1, or -1 if the picture is mirrored.
    pub(crate) fn handedness(&self) -> i32 {
        if self.right.cross(self.down).dot(self.forward) < 0.0 { -1 } else { 1 }
    }

    /// Pixels from the middle of the picture to the centre of a column or row.
    pub(crate) fn center_offset(&self, axis: usize, index: f64) -> f64 {
        index + 0.5 - f64::from(self.size[axis]) * 0.5
    }

    fn across(&self, column: u32, row: u32) -> DVec3 {
        let [x, y] = [self.center_offset(0, f64::from(column)), self.center_offset(1, f64::from(row))];
        self.right * (x * self.pixel) + self.down * (y * self.pixel)
    }

    /// Where a point is seen, in pixels to the right and down from the middle of the picture, to within
    /// [`PROJECTION_ERROR`] as far as the picture reaches; `None` if it is not well before the eye.
    pub(crate) fn project(&self, p: Vec3) -> Option<[f64; 2]> {
        let from_eye = p.as_dvec3() - self.eye;
        let depth = self.forward.dot(from_eye);
        let seen = self.parallel || depth > SHALLOW * from_eye.abs().element_sum();
        let scale = 1.0 / (if self.parallel { 1.0 } else { depth } * self.pixel);
        seen.then(|| [self.right, self.down].map(|axis| axis.dot(from_eye) * scale))
    }

    /// All pixels whose rays may pass through a triangle; none if certainly none does.
    pub(crate) fn bounds(&self, corners: [Vec3; 3]) -> Pixels {
        if let [Some(a), Some(b), Some(c)] = corners.map(|p| self.project(p)) {
            return self.pixels([a, b, c]);
        }
        let from_eye = corners.map(|p| p.as_dvec3() - self.eye);
        let before = |p: &DVec3| self.forward.dot(*p) > -SHALLOW * p.abs().element_sum();
        if from_eye.iter().any(before) && !self.passes_by(corners) {
            return self.pixels([[f64::NEG_INFINITY; 2], [f64::INFINITY; 2], [0.0; 2]]);
        }
        Pixels { columns: 0..0, rows: 0..0 }
    }

    /// All pixels whose rays may pass through a triangle whose corners are seen at these places.
    pub(crate) fn pixels(&self, [a, b, c]: [[f64; 2]; 3]) -> Pixels {
        let range = |axis: usize| {
            let (low, high) = (a[axis].min(b[axis]).min(c[axis]), a[axis].max(b[axis]).max(c[axis]));
            // Casts saturate, so that infinite bounds are those of the picture.
            // The first pixel may be one too many.
            let first = (low - PROJECTION_ERROR - self.center_offset(axis, 0.0)) as u32;
            let end = (high + PROJECTION_ERROR - self.center_offset(axis, -1.0)) as u32;
            first.min(self.size[axis])..end.min(self.size[axis])
        };
        Pixels { columns: range(0), rows: range(1) }
    }

    /// All rays are certainly outside one edge, whichever way the triangle is seen.
    fn passes_by(&self, corners: [Vec3; 3]) -> bool {
        let [right, bottom] = self.size.map(|n| n.saturating_sub(1));
        [corners, [corners[0], corners[2], corners[1]]].into_iter().all(|corners| {
            Triangle::new(self, corners).edges.iter().any(|edge| {
                [(0, 0), (right, 0), (0, bottom), (right, bottom)]
                    .into_iter()
                    .all(|(column, row)| edge.value_at(self, column, row) < -edge.bound)
            })
        })
    }
}

/// A linear function of the pixel that is positive for rays that pass an edge on the inner side.
#[derive(Debug, Clone, Copy)]
struct Edge {
    a: Vec3,
    b: Vec3,
    /// At the middle of the picture, and its growth a pixel to the right and down.
    middle: f64,
    x: f64,
    y: f64,
    /// Where the value is above this in magnitude, its sign is certain.
    bound: f64,
}

/// Roundings of an edge's value, in units of 2^-53 and of the product of the vectors' lengths: differences 2, products
/// and sums of the cross product 4, of the dot products 3 each, of the linear function 3, of the ray itself 3.
const EDGE_ERROR: f64 = 32.0 * f64::EPSILON * 0.5;

impl Edge {
    fn new(rays: &Rays, a: Vec3, b: Vec3) -> Edge {
        let (from_eye, along) = (a.as_dvec3() - rays.eye, b.as_dvec3() - a.as_dvec3());
        let half = rays.size.map(|n| f64::from(n) * 0.5 * rays.pixel);
        let reach = half[0] + half[1];
        // Sums of components are no less than lengths.
        let [distance, length] = [from_eye, along].map(|v| v.abs().element_sum());
        let (middle, x, y, size) = if rays.parallel {
            let n = along.cross(rays.forward);
            (n.dot(from_eye), -n.dot(rays.right), -n.dot(rays.down), length * (distance + reach))
        } else {
            let n = from_eye.cross(along);
            let size = length * distance * (1.0 + reach);
            (n.dot(rays.forward), n.dot(rays.right), n.dot(rays.down), size)
        };
        Edge { a, b, middle, x: x * rays.pixel, y: y * rays.pixel, bound: EDGE_ERROR * size }
    }

    /// Column, from the middle, at which the value is zero in the middle row; its growth a row; and its error.
    fn root(&self, rays: &Rays) -> [f64; 3] {
        let inverse = 1.0 / self.x;
        let (root, growth) = (-self.middle * inverse, -self.y * inverse);
        let rounding = 1e-12 * (root.abs() + growth.abs() * f64::from(rays.size[1]));
        [root, growth, 1e-6 + 2.0 * self.bound * inverse.abs() + rounding]
    }

    /// At pixels from the middle of the picture.
    fn value(&self, x: f64, y: f64) -> f64 {
        self.middle + self.x * x + self.y * y
    }

    fn value_at(&self, rays: &Rays, column: u32, row: u32) -> f64 {
        self.value(rays.center_offset(0, f64::from(column)), rays.center_offset(1, f64::from(row)))
    }

    fn holds(&self, rays: &Rays, column: u32, row: u32, x: f64, y: f64) -> bool {
        let value = self.value(x, y);
        if value.abs() > self.bound { value > 0.0 } else { self.holds_exactly(rays, column, row) }
    }

    #[cold]
    fn holds_exactly(&self, rays: &Rays, column: u32, row: u32) -> bool {
        let across = rays.across(column, row);
        let sign = |origin, direction, finite| edge_sign(self.a, self.b, origin, direction, finite);
        // Of the ray itself, and of its change when it moves to the right, and down.
        let signs = if rays.parallel {
            let moved = |by| sign(by, rays.forward, false);
            [sign(rays.eye + across, rays.forward, true), moved(rays.right), moved(rays.down)]
        } else {
            [rays.forward + across, rays.right, rays.down].map(|direction| sign(rays.eye, direction, true))
        };
        signs.into_iter().find(|&sign| sign != 0).is_some_and(|sign| sign > 0)
    }

    /// The value changes so little along a row that more than one of these columns may be undecided: there the rays'
    /// own roundings, not their order, decide which are inside.
    fn is_level(&self, rays: &Rays, columns: &Range<u32>, row: u32) -> bool {
        let steep = self.x.abs() > 8.0 * self.bound;
        let inside = |column: u32| self.value_at(rays, column, row) > self.bound;
        !(steep || columns.is_empty() || inside(columns.start) && inside(columns.end - 1))
    }

    /// Shrinks a range of a row's columns to those that may be inside.
    fn shrink(&self, [root, growth, error]: [f64; 3], columns: &mut Range<u32>, first: f64, y: f64) {
        // From the first column's centre; casts saturate, so that the range only shrinks within itself.
        let root = root + growth * y - first;
        if self.x > 0.0 {
            columns.start = columns.start.max((root - error) as u32);
        } else if self.x < 0.0 {
            columns.end = columns.end.min(((root + error + 1.0).max(0.0)) as u32);
        }
    }
}

/// A triangle whose corners run such that the rays that pass through it, in front of the eye, are inside all edges:
/// clockwise seen by the eye as it looks from outside.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Triangle {
    edges: [Edge; 3],
}

/// Columns above which a row is cut by its edges' roots, and not tested pixel by pixel.
const WIDE: usize = 4;

impl Triangle {
    pub(crate) fn new(rays: &Rays, [a, b, c]: [Vec3; 3]) -> Triangle {
        Triangle { edges: [(a, b), (b, c), (c, a)].map(|(a, b)| Edge::new(rays, a, b)) }
    }

    /// Calls `cover` with rows of `pixels` and columns in them whose rays pass through the triangle: each such pixel
    /// is in one call.
    pub(crate) fn cover(&self, rays: &Rays, pixels: Pixels, mut cover: impl FnMut(u32, Range<u32>)) {
        let [first_x, first_y] = [0, 1].map(|axis| rays.center_offset(axis, 0.0));
        let wide = pixels.columns.len() > WIDE;
        let roots = if wide { self.edges.map(|edge| edge.root(rays)) } else { [[0.0; 3]; 3] };
        for row in pixels.rows {
            let y = f64::from(row) + first_y;
            let holds = |column| {
                let x = f64::from(column) + first_x;
                self.edges.iter().all(|edge| edge.holds(rays, column, row, x, y))
            };
            let mut columns = pixels.columns.clone();
            if wide {
                for (edge, root) in self.edges.iter().zip(roots) {
                    edge.shrink(root, &mut columns, first_x, y);
                }
            }
            if !wide || self.edges.iter().any(|edge| edge.is_level(rays, &columns, row)) {
                columns.filter(|&column| holds(column)).for_each(|column| cover(row, column..column + 1));
                continue;
            }
            // Inside is an interval: only its ends need tests.
            while columns.start < columns.end && !holds(columns.start) {
                columns.start += 1;
            }
            while columns.start < columns.end && !holds(columns.end - 1) {
                columns.end -= 1;
            }
            if columns.start < columns.end {
                cover(row, columns);
            }
        }
    }
}

/// Depth of the plane of a triangle along rays.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Depth {
    over: f64,
    middle: f64,
    x: f64,
    y: f64,
    range: [f64; 2],
}

impl Depth {
    pub(crate) fn new(rays: &Rays, corners: [Vec3; 3]) -> Depth {
        let [a, b, c] = corners.map(|p| p.as_dvec3() - rays.eye);
        let n = (b - a).cross(c - a);
        let z = [a, b, c].map(|p| rays.forward.dot(p));
        let range = [z[0].min(z[1]).min(z[2]), z[0].max(z[1]).max(z[2])];
        let [x, y] = [rays.right, rays.down].map(|axis| n.dot(axis) * rays.pixel);
        let (over, middle) = (n.dot(a), n.dot(rays.forward));
        if rays.parallel {
            Depth { over: middle, middle: over, x: -x, y: -y, range }
        } else {
            Depth { over, middle, x, y, range }
        }
    }

    /// Between those of the triangle's corners, also where the plane is seen almost edge-on.
    pub(crate) fn at(&self, rays: &Rays, column: u32, row: u32) -> f64 {
        let [x, y] = [rays.center_offset(0, f64::from(column)), rays.center_offset(1, f64::from(row))];
        let linear = self.middle + self.x * x + self.y * y;
        let depth = if rays.parallel { linear / self.over } else { self.over / linear };
        if depth.is_nan() { self.range[0] } else { depth.max(self.range[0]).min(self.range[1]) }
    }
}

#[cfg(test)]
mod tests;
