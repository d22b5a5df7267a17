//! A cell as the tiles need it: set up in double precision, stored in single.
//!
//! Along the ray through a pixel the inverse depth at which a face's plane is met is linear in the pixel's position;
//! in orthographic views the depth itself is. With the depth `z_ref` of the cell's farthest vertex,
//!
//! ```text
//! w = z_ref / z - 1   (perspective)        w = z_ref - z   (orthographic)
//! ```
//!
//! is 0 at that vertex, grows towards the eye, and is small for small cells, so that thin ones keep their thickness in
//! single precision. The ray is inside between the least w of the front faces and the greatest of the back faces.

use glam::DVec3;
use rayon::prelude::*;
use tetlux_optics::transfer_f32::{Piece, piece_at};

use crate::device_mesh::{DeviceMesh, NEGATIVE};
use crate::eye_space::EyeSpace;

/// A vertex of the mesh as seen.
#[derive(Clone, Copy)]
pub(crate) struct Point {
    /// Relative to the mesh's origin, in the axes of eye space.
    frame: DVec3,
    /// Pixel position; of use only in front of the near plane.
    pixel: [f32; 2],
    scalar: f32,
}

/// A cell ready to be drawn. Pixels are counted from the box's first.
#[derive(Clone, Copy)]
#[repr(align(128))]
pub(crate) struct Record {
    /// (dw/dx, dw/dy, w at the first pixel) of each face's plane, front faces first.
    pub(crate) planes: [[f32; 3]; 4],
    /// How many of the planes are front faces.
    pub(crate) fronts: u32,
    /// w of the nearest vertex, or of the near plane; that of the farthest vertex is 0.
    pub(crate) nearest: f32,
    /// The scalar at depth `z_ref`, less `base`: (d/dx, d/dy, at the first pixel).
    pub(crate) scalar: [f32; 3],
    /// Perspective: the scalar's gradient along the ray times `z_ref` is the scalar at `z_ref` plus this.
    /// Orthographic: the gradient along the ray.
    pub(crate) along: f32,
    /// The cell's lowest scalar.
    pub(crate) base: f32,
    /// Its highest, less `base`.
    pub(crate) range: f32,
    /// Depth of the farthest vertex from the eye.
    pub(crate) depth: f32,
    /// The same from the mesh's origin, which keeps its digits however far away the eye is.
    pub(crate) level: f32,
    /// First and one past the last pixel, in x and y. Empty: nothing of the cell is seen.
    pub(crate) first: [u32; 2],
    pub(crate) end: [u32; 2],
    /// The piece of the transfer function at the lowest scalar, and the last that the range reaches into.
    pub(crate) pieces: [u32; 2],
}

/// Pixels by which a cell's box is widened, for rounding.
const MARGIN: f32 = 0.03125;

/// Planes within this angle (in radians, roughly) of edge-on count as edge-on.
const EDGE_ON: f64 = 1e-6;

/// A ray in a plane that is seen edge-on is taken for one this share of the picture's larger side, and no less than
/// this share of `NUDGE_SIDE` pixels, away: further than single precision misses the plane by. Then all faces that
/// meet in an edge along the ray agree on which side of each it passes. No edge of a grid runs along this direction.
const NUDGE: [f64; 2] = [5.9e-7, 3.3e-7];
const NUDGE_SIDE: f64 = 128.0;

/// Coefficients are limited to this value: sums and products with pixel positions stay finite.
const STEEPEST: f64 = 1e20;

/// The mesh's vertices as seen.
pub(crate) fn points(mesh: &DeviceMesh, eye: &EyeSpace) -> Vec<Point> {
    let point = |&[x, y, z, scalar]: &[f32; 4]| {
        let frame = eye.frame(DVec3::new(f64::from(x), f64::from(y), f64::from(z)));
        Point { frame, pixel: eye.pixel_of(frame + eye.offset).map(|p| p as f32), scalar }
    };
    mesh.points.par_iter().map(point).collect()
}

/// What all cells of a picture have in common.
pub(crate) struct SetUp<'a> {
    pub(crate) mesh: &'a DeviceMesh,
    pub(crate) points: &'a [Point],
    pub(crate) eye: &'a EyeSpace,
    pub(crate) pieces: &'a [Piece],
    pub(crate) size: [u32; 2],
}

impl SetUp<'_> {
    /// Sets up a cell; its box is empty if nothing of it is seen.
    pub(crate) fn record(&self, index: u32) -> Record {
        let mut record = Record {
            planes: [[0.0; 3]; 4],
            fronts: 0,
            nearest: 0.0,
            scalar: [0.0; 3],
            along: 0.0,
            base: 0.0,
            range: 0.0,
            depth: 0.0,
            level: 0.0,
            first: [0; 2],
            end: [0; 2],
            pieces: [0; 2],
        };
        let names = self.mesh.cells[index as usize];
        let points = names.map(|v| &self.points[(v & !NEGATIVE) as usize]);
        let frame = points.map(|p| p.frame);
        let eye = frame.map(|f| f + self.eye.offset);
        let z = eye.map(|e| e.z);
        let farthest = z[0].max(z[1]).max(z[2].max(z[3]));
        let nearest = z[0].min(z[1]).min(z[2].min(z[3])).max(self.eye.near);
        if farthest <= self.eye.near {
            return record;
        }
        let [low, high] = self.pixel_bounds(&points, &eye);
        for axis in 0..2 {
            // The pixels whose centres, at i + 1/2, lie between the bounds. A conversion of a float saturates.
            record.first[axis] = (low[axis] - MARGIN - 0.5).ceil().max(0.0) as u32;
            record.end[axis] = (((high[axis] + MARGIN - 0.5).floor() + 1.0).max(0.0) as u32).min(self.size[axis]);
            if record.first[axis] >= record.end[axis] {
                record.end[axis] = record.first[axis];
                return record;
            }
        }

        // The ray through the first pixel: in perspective where it is at depth z_ref.
        let scale = self.eye.pixel * if self.eye.orthographic { 1.0 } else { farthest };
        let across = |axis: usize| (f64::from(record.first[axis]) + 0.5 - self.eye.middle[axis]) * scale;
        let origin = DVec3::new(across(0), across(1), farthest);

        // (b-a) x (c-a) of each face, vertices in ascending order: both cells at a face find the same bits.
        let edge = |i: usize, j: usize| frame[j] - frame[i];
        let (e1, e2, e3) = (edge(0, 1), edge(0, 2), edge(0, 3));
        let normals = [edge(1, 2).cross(edge(1, 3)), e2.cross(e3), e1.cross(e3), e1.cross(e2)];
        let reach = eye.map(|e| e.abs().max_element());
        let parity = if names[0] & NEGATIVE == 0 { 1.0 } else { -1.0 };
        let (mut fronts, mut backs) = (0, 4);
        for (face, [a, b, c]) in [[1, 2, 3], [0, 2, 3], [0, 1, 3], [0, 1, 2]].into_iter().enumerate() {
            let reach = reach[a].max(reach[b]).max(reach[c]);
            let (plane, toward) = self.plane(normals[face], eye[a], reach, origin, scale);
            // In ascending order every other face's normal points into the cell.
            let inward = if face % 2 == 0 { -parity } else { parity };
            if toward * inward > 0.0 {
                record.planes[fronts] = plane;
                fronts += 1;
            } else {
                backs -= 1;
                record.planes[backs] = plane;
            }
        }
        record.fronts = fronts as u32;
        record.nearest =
            ((farthest - nearest) / if self.eye.orthographic { 1.0 } else { nearest }).min(STEEPEST) as f32;
        record.depth = farthest as f32;
        record.level = (farthest - self.eye.offset.z) as f32;

        let scalars = match self.mesh.cell_scalars.get(index as usize) {
            Some(&s) => [s; 4],
            None => points.map(|p| p.scalar),
        };
        let least = scalars[0].min(scalars[1]).min(scalars[2].min(scalars[3]));
        let most = scalars[0].max(scalars[1]).max(scalars[2].max(scalars[3]));
        record.base = least;
        record.range = most - least;
        let first = piece_at(self.pieces, least);
        // A piece that is only touched at its beginning is not entered.
        let mut last = first;
        while self.pieces[last].s[1] < most && last + 1 < self.pieces.len() {
            last += 1;
        }
        record.pieces = [first as u32, last as u32];
        if record.range > 0.0 {
            let s = scalars.map(|s| f64::from(s) - f64::from(least));
            let volume = e1.dot(normals[1]);
            let sum = normals[1] * (s[1] - s[0]) - normals[2] * (s[2] - s[0]) + normals[3] * (s[3] - s[0]);
            let gradient = if volume.abs() > f64::MIN_POSITIVE { sum / volume } else { DVec3::ZERO };
            let at = s[0] + gradient.dot(origin - eye[0]);
            record.scalar = [gradient.x * scale, gradient.y * scale, at].map(limited);
            record.along = limited(if self.eye.orthographic { gradient.z } else { gradient.dot(origin) - at });
        }
        record
    }

    /// (dw/dx, dw/dy, w at the first pixel) of the plane through `a` with normal n, and +1 if n points away from the
    /// eye's side, else -1. `origin` is the point at depth `z_ref` on the first pixel's ray, `scale` the side of a
    /// pixel there.
    fn plane(&self, n: DVec3, a: DVec3, reach: f64, origin: DVec3, scale: f64) -> ([f32; 3], f64) {
        let (side, size) = if self.eye.orthographic {
            (n.z, n.x.abs() + n.y.abs())
        } else {
            (n.dot(a), n.abs().element_sum() * reach)
        };
        let toward = if side >= 0.0 { 1.0 } else { -1.0 };
        if side.abs() > EDGE_ON * size {
            let inverse = 1.0 / side;
            return ([n.x * scale * inverse, n.y * scale * inverse, n.dot(origin - a) * inverse].map(limited), toward);
        }
        // Seen edge-on the plane bounds nothing but the silhouette: any large slope of the right sign does, through
        // the pixel of `a`, and both cells at the face choose the same.
        let inverse = toward / (1e-12 * size).max(1e-200);
        let steep = scale * inverse;
        let [x, y] = [n.x * steep, n.y * steep];
        let depth = if self.eye.orthographic { 1.0 } else { origin.z / a.z.max(self.eye.near) };
        let across = n.truncate().dot(origin.truncate() - a.truncate() * depth) * inverse;
        let larger = f64::from(self.size[0].max(self.size[1])).max(NUDGE_SIDE);
        ([x, y, across + (x * NUDGE[0] + y * NUDGE[1]) * larger].map(limited), toward)
    }

    /// Pixel bounds of what is seen of a cell.
    fn pixel_bounds(&self, points: &[&Point; 4], eye: &[DVec3; 4]) -> [[f32; 2]; 2] {
        let near = self.eye.near;
        let mut bounds = [[f32::MAX; 2], [f32::MIN; 2]];
        let mut reach = |p: [f32; 2]| {
            for axis in 0..2 {
                bounds[0][axis] = bounds[0][axis].min(p[axis]);
                bounds[1][axis] = bounds[1][axis].max(p[axis]);
            }
        };
        for i in 0..4 {
            if eye[i].z >= near {
                reach(points[i].pixel);
            }
            for j in 0..i {
                // Where an edge passes the near plane.
                if (eye[i].z < near) != (eye[j].z < near) {
                    let t = (near - eye[i].z) / (eye[j].z - eye[i].z);
                    let crossing = eye[i] + (eye[j] - eye[i]) * t;
                    reach(self.eye.pixel_of(crossing.with_z(near)).map(|p| p as f32));
                }
            }
        }
        bounds
    }
}

fn limited(x: f64) -> f32 {
    x.clamp(-STEEPEST, STEEPEST) as f32
}
