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

use fearless_simd::{Level, Select, Simd, SimdBase, dispatch};
use glam::DVec3;
use rayon::prelude::*;
use tetlux_mesh::ScalarField;
use tetlux_optics::transfer_f32::{Piece, piece_at};

use crate::device_mesh::{DeviceMesh, NEGATIVE, normalised};
use crate::eye_space::EyeSpace;
use crate::tiles::bins::TILE;
use crate::tiles::vector::{Vector, dot};

/// A vertex of the mesh as seen.
#[derive(Clone, Copy)]
pub(crate) struct Point {
    /// Relative to the mesh's origin, in the axes of eye space.
    pub(crate) frame: DVec3,
    /// Pixel position; of use only in front of the near plane.
    pixel: [f32; 2],
    /// Normalised; 0 for cell data.
    scalar: f64,
}

/// A cell ready to be drawn. Pixels are counted from the box's middle, where single precision misses by the least.
#[derive(Clone, Copy, Default)]
#[repr(C, align(128))]
pub(crate) struct Record {
    /// (dw/dx, dw/dy, w at the middle) of each face's plane, front faces first.
    pub(crate) planes: [[f32; 3]; 4],
    /// How many of the planes are front faces.
    pub(crate) fronts: u32,
    /// w of the nearest vertex, or of the near plane; that of the farthest vertex is 0.
    pub(crate) nearest: f32,
    /// The scalar at depth `z_ref`, less `base`: (d/dx, d/dy, at the middle).
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

impl Record {
    /// Depth of the nearest vertex, or of the near plane, from the mesh's origin.
    #[inline(always)]
    pub(crate) fn nearest_level(&self, orthographic: bool) -> f32 {
        self.level - if orthographic { self.nearest } else { self.depth * self.nearest / (1.0 + self.nearest) }
    }

    /// The pixel in the box's middle.
    #[inline(always)]
    pub(crate) fn middle(&self) -> [u32; 2] {
        [self.first[0].midpoint(self.end[0]), self.first[1].midpoint(self.end[1])]
    }
}

/// Pixels by which a cell's box is widened, for rounding.
const MARGIN: f32 = 0.03125;

/// Planes within this angle (in radians, roughly) of edge-on count as edge-on: what double precision leaves uncertain.
const EDGE_ON: f64 = 1e-12;

/// A ray in a plane that is seen edge-on is taken for one this share of the picture's larger side, and no less than
/// this share of `NUDGE_SIDE` pixels, away: further than single precision misses the plane by. Then all faces that
/// meet in an edge along the ray agree on which side of each it passes. No edge of a grid runs along this direction.
const NUDGE: [f64; 2] = [5.9e-7, 3.3e-7];
const NUDGE_SIDE: f64 = 128.0;

/// Coefficients are limited to this value: sums and products with pixel positions stay finite.
pub(crate) const STEEPEST: f64 = 1e20;

/// The mesh's vertices as seen.
pub(crate) fn points(mesh: &DeviceMesh, scalar: &ScalarField, eye: &EyeSpace) -> Vec<Point> {
    let point = |(i, &[x, y, z, _]): (usize, &[f32; 4])| {
        let frame = eye.frame(DVec3::new(f64::from(x), f64::from(y), f64::from(z)));
        let scalar = if mesh.cell_scalars.is_empty() { normalised(scalar, scalar.values[i]) } else { 0.0 };
        Point { frame, pixel: eye.pixel_of(frame + eye.offset).map(|p| p as f32), scalar }
    };
    mesh.points.par_iter().enumerate().map(point).collect()
}

/// What all cells of a picture have in common.
pub(crate) struct SetUp<'a> {
    pub(crate) mesh: &'a DeviceMesh,
    pub(crate) points: &'a [Point],
    pub(crate) eye: &'a EyeSpace,
    pub(crate) pieces: &'a [Piece],
    /// Every cell is taken to meet all of them.
    pub(crate) cut_all: bool,
    pub(crate) size: [u32; 2],
}

/// Cells that one core sets up at a time.
pub(crate) const CHUNK: usize = 64;

/// The records of some cells, and for each the first and one past the last tile of its box, in x and y.
#[derive(Clone)]
pub(crate) struct Chunk {
    pub(crate) records: [Record; CHUNK],
    pub(crate) tiles: [[u16; 4]; CHUNK],
}

/// The record at a position.
#[inline(always)]
pub(crate) fn at(chunks: &[Chunk], index: u32) -> &Record {
    &chunks[index as usize / CHUNK].records[index as usize % CHUNK]
}

/// Cells in the widest vectors.
const WIDEST: usize = 8;

/// Vertices of each face in ascending order, opposite vertices 0 to 3. In that order every other face's normal points
/// out of a positively oriented cell.
const FACES: [[usize; 3]; 4] = [[1, 2, 3], [0, 2, 3], [0, 1, 3], [0, 1, 2]];

impl SetUp<'_> {
    /// Sets up cells, in their order.
    pub(crate) fn chunks(&self, level: Level, cells: &[u32]) -> Vec<Chunk> {
        cells.par_chunks(CHUNK).map(|cells| dispatch!(level, simd => self.chunk(simd, cells))).collect()
    }

    #[inline(always)]
    fn chunk<S: Simd>(&self, simd: S, cells: &[u32]) -> Chunk {
        // All that is needed is loaded first, the misses at once.
        let mut names = [[0; 4]; CHUNK];
        for (names, &cell) in names.iter_mut().zip(cells) {
            *names = self.mesh.cells[cell as usize];
        }
        let mut touched = 0.0;
        for &[a, b, c, d] in &names[..cells.len()] {
            for v in [a & !NEGATIVE, b, c, d] {
                touched += self.points[v as usize].scalar;
            }
        }
        std::hint::black_box(touched);
        let mut chunk = Chunk { records: [Record::default(); CHUNK], tiles: [[0; 4]; CHUNK] };
        let lanes = S::f64s::LEN;
        for start in (0..cells.len()).step_by(lanes) {
            let end = (start + lanes).min(cells.len());
            self.vector(simd, &cells[start..end], &names[start..end], &mut chunk.records[start..end]);
        }
        for (tiles, record) in chunk.tiles.iter_mut().zip(&chunk.records) {
            let [x, y] = record.first.map(|first| (first / TILE) as u16);
            let [right, bottom] = record.end.map(|end| end.div_ceil(TILE) as u16);
            *tiles = [x, y, right, bottom];
        }
        chunk
    }

    /// Sets up as many cells as there are lanes, or fewer.
    #[inline(always)]
    fn vector<S: Simd>(&self, simd: S, cells: &[u32], names: &[[u32; 4]], records: &mut [Record]) {
        let mut frame = [[[0.0; WIDEST]; 3]; 4];
        let mut scalars = [[0.0; WIDEST]; 4];
        let mut across = [[0.0; WIDEST]; 2];
        let mut seen = false;
        for (lane, (names, record)) in names.iter().zip(&mut *records).enumerate() {
            let vertices = [names[0] & !NEGATIVE, names[1], names[2], names[3]];
            let point = |i: usize| &self.points[vertices[i] as usize];
            let points = [point(0), point(1), point(2), point(3)];
            seen |= self.bound(points, record);
            self.classify(cells[lane], points, record);
            for i in 0..4 {
                for axis in 0..3 {
                    frame[i][axis][lane] = points[i].frame[axis];
                }
                scalars[i][lane] = points[i].scalar - f64::from(record.base);
            }
            let middle = record.middle();
            for axis in 0..2 {
                across[axis][lane] = f64::from(middle[axis]) + 0.5 - self.eye.middle[axis];
            }
        }
        if !seen {
            return;
        }

        let splat = |x: f64| S::f64s::splat(simd, x);
        let load = |values: &[f64; WIDEST]| S::f64s::from_slice(simd, &values[..S::f64s::LEN]);
        let frame: [Vector<S>; 4] = [
            Vector { x: load(&frame[0][0]), y: load(&frame[0][1]), z: load(&frame[0][2]) },
            Vector { x: load(&frame[1][0]), y: load(&frame[1][1]), z: load(&frame[1][2]) },
            Vector { x: load(&frame[2][0]), y: load(&frame[2][1]), z: load(&frame[2][2]) },
            Vector { x: load(&frame[3][0]), y: load(&frame[3][1]), z: load(&frame[3][2]) },
        ];
        let offset = Vector { x: splat(self.eye.offset.x), y: splat(self.eye.offset.y), z: splat(self.eye.offset.z) };
        let eye = [frame[0] + offset, frame[1] + offset, frame[2] + offset, frame[3] + offset];
        let farthest = eye[0].z.max(eye[1].z).max(eye[2].z.max(eye[3].z)).max(self.eye.near);
        let nearest = eye[0].z.min(eye[1].z).min(eye[2].z.min(eye[3].z)).max(self.eye.near).min(farthest);
        // The ray through the middle pixel: in perspective where it is at depth z_ref.
        let scale = if self.eye.orthographic { splat(self.eye.pixel) } else { farthest * self.eye.pixel };
        let origin = Vector { x: load(&across[0]) * scale, y: load(&across[1]) * scale, z: farthest };

        // (b-a) x (c-a) of each face: both cells at a face find the same bits.
        let (e1, e2, e3) = (frame[1] - frame[0], frame[2] - frame[0], frame[3] - frame[0]);
        let normals = [(frame[2] - frame[1]).cross(frame[3] - frame[1]), e2.cross(e3), e1.cross(e3), e1.cross(e2)];
        let mut planes = [[splat(0.0); 4]; 4];
        for (face, [a, b, c]) in FACES.into_iter().enumerate() {
            planes[face] = self.plane(simd, normals[face], [eye[a], eye[b], eye[c]], origin, scale);
        }
        let span = farthest - nearest;
        let nearest = if self.eye.orthographic { span } else { span / nearest }.min(STEEPEST);

        let s = [load(&scalars[0]), load(&scalars[1]), load(&scalars[2]), load(&scalars[3])];
        let volume = dot(e1, normals[1]);
        let tiny = volume.max(-volume).simd_le(f64::MIN_POSITIVE);
        let inverse = splat(1.0) / tiny.select(splat(1.0), volume);
        let [s1, s2, s3] = [(s[1] - s[0]) * inverse, (s[2] - s[0]) * inverse, (s[3] - s[0]) * inverse];
        let sum = normals[1] * s1 - normals[2] * s2 + normals[3] * s3;
        let zero = splat(0.0);
        let gradient = Vector { x: tiny.select(zero, sum.x), y: tiny.select(zero, sum.y), z: tiny.select(zero, sum.z) };
        let at = s[0] + dot(gradient, origin - eye[0]);
        let along = if self.eye.orthographic { gradient.z } else { dot(gradient, origin) - at };
        let scalar = [limited(gradient.x * scale), limited(gradient.y * scale), limited(at), limited(along)];

        for (lane, (names, record)) in names.iter().zip(records).enumerate() {
            let parity = if names[0] & NEGATIVE == 0 { 1.0 } else { -1.0 };
            let (mut fronts, mut backs) = (0, 4);
            for (face, plane) in planes.iter().enumerate() {
                let inward = if face % 2 == 0 { -parity } else { parity };
                let is_front = plane[3][lane] * inward > 0.0;
                backs -= usize::from(!is_front);
                record.planes[if is_front { fronts } else { backs }] =
                    [plane[0][lane] as f32, plane[1][lane] as f32, plane[2][lane] as f32];
                fronts += usize::from(is_front);
            }
            record.fronts = fronts as u32;
            record.nearest = nearest[lane] as f32;
            record.depth = farthest[lane] as f32;
            record.level = (farthest[lane] - self.eye.offset.z) as f32;
            record.scalar = [scalar[0][lane] as f32, scalar[1][lane] as f32, scalar[2][lane] as f32];
            record.along = scalar[3][lane] as f32;
        }
    }

    /// (dw/dx, dw/dy, w at the middle) of the plane through a, b, c with normal n, and +1 if n points away from
    /// the eye's side, else -1. `origin` is the point at depth `z_ref` on the middle's ray, `scale` the side of a
    /// pixel there.
    #[inline(always)]
    fn plane<S: Simd>(
        &self,
        simd: S,
        n: Vector<S>,
        [a, b, c]: [Vector<S>; 3],
        origin: Vector<S>,
        scale: S::f64s,
    ) -> [S::f64s; 4] {
        let splat = |x: f64| S::f64s::splat(simd, x);
        let (side, size, across) = if self.eye.orthographic {
            (n.z, n.x.max(-n.x) + n.y.max(-n.y), n.x * (origin.x - a.x) + n.y * (origin.y - a.y))
        } else {
            let (side, reach) = (dot(n, a), a.reach().max(b.reach()).max(c.reach()));
            let in_front = a.z.simd_gt(self.eye.near);
            let at_a = in_front.select(side, splat(0.0)) * origin.z / in_front.select(a.z, splat(1.0));
            (side, (n.x.max(-n.x) + n.y.max(-n.y) + n.z.max(-n.z)) * reach, dot(n, origin) - at_a)
        };
        let toward = side.simd_ge(0.0).select(splat(1.0), splat(-1.0));
        // Seen edge-on the plane bounds nothing but the silhouette: any large slope of the right sign does, through
        // the pixel of `a` if that is in front of the eye, and both cells at the face choose the same.
        let edge_on = side.max(-side).simd_le(size * EDGE_ON);
        let inverse = splat(1.0) / edge_on.select((size * 1e-12).max(1e-200) * toward, side);
        let (x, y) = (n.x * scale * inverse, n.y * scale * inverse);
        let larger = f64::from(self.size[0].max(self.size[1])).max(NUDGE_SIDE);
        let nudge = x * (NUDGE[0] * larger) + y * (NUDGE[1] * larger);
        let at = edge_on.select(across * inverse + nudge, dot(n, origin - a) * inverse);
        [limited(x), limited(y), limited(at), toward]
    }

    /// Sets the box of pixels in which a cell may be seen: empty if it holds no pixel's centre, which is told.
    #[inline(always)]
    fn bound(&self, points: [&Point; 4], record: &mut Record) -> bool {
        let near = self.eye.near - self.eye.offset.z;
        let z = [points[0].frame.z, points[1].frame.z, points[2].frame.z, points[3].frame.z];
        let [mut low, mut high] = [points[0].pixel; 2];
        if z[0].min(z[1]).min(z[2].min(z[3])) >= near {
            for point in &points[1..] {
                for axis in 0..2 {
                    low[axis] = low[axis].min(point.pixel[axis]);
                    high[axis] = high[axis].max(point.pixel[axis]);
                }
            }
        } else {
            let bounds = self.eye.seen_bounds(points.map(|p| p.frame + self.eye.offset));
            [low, high] = bounds.map(|corner| corner.map(|p| p as f32));
        }
        for axis in 0..2 {
            // The pixels whose centres, at i + 1/2, lie between the bounds. A conversion of a float saturates.
            record.first[axis] = (low[axis] - MARGIN + 0.5).max(0.0) as u32;
            record.end[axis] = ((high[axis] + MARGIN + 0.5).max(0.0) as u32).min(self.size[axis]);
        }
        let seen = record.first[0] < record.end[0] && record.first[1] < record.end[1];
        if !seen {
            (record.first, record.end) = ([0; 2], [0; 2]);
        }
        seen
    }

    /// Sets the range of a cell's scalars and the pieces of the transfer function that it meets.
    #[inline(always)]
    fn classify(&self, cell: u32, points: [&Point; 4], record: &mut Record) {
        let s = points.map(|p| p.scalar as f32);
        let (least, most) = match self.mesh.cell_scalars.get(cell as usize) {
            Some(&s) => (s, s),
            None => (s[0].min(s[1]).min(s[2].min(s[3])), s[0].max(s[1]).max(s[2].max(s[3]))),
        };
        (record.base, record.range) = (least, most - least);
        if self.cut_all {
            record.pieces = [0, self.pieces.len() as u32 - 1];
            return;
        }
        let first = piece_at(self.pieces, least);
        // A piece that is only touched at its beginning is not entered.
        let mut last = first;
        while self.pieces[last].s[1] < most && last + 1 < self.pieces.len() {
            last += 1;
        }
        record.pieces = [first as u32, last as u32];
    }
}

#[inline(always)]
fn limited<V: fearless_simd::SimdFloat<S, Element = f64>, S: Simd>(x: V) -> V {
    x.max(-STEEPEST).min(STEEPEST)
}
