//! Cells set up in double precision, as many at a time as a vector has lanes.

mod planes;
mod store;
#[cfg(test)]
mod tests;

use bytemuck::{Pod, Zeroable};
use fearless_simd::{
    Level, Select, Simd, SimdBase, SimdCvtTruncate, SimdFloat, SimdMask, SimdNarrow, SimdWiden, dispatch,
};
use glam::DVec3;
use rayon::prelude::*;
use tetlux_mesh::{Location, ScalarField};
use tetlux_optics::transfer_f32::{Piece, piece_at};

use self::planes::{EDGE_ON, fronts_first, lean};
use self::store::store;
use super::bins::TILE;
use super::record::{CHUNK, Chunk};
use super::vector::{Vector, dot};
use crate::Job;
use crate::device_mesh::{DeviceMesh, normalised};
use crate::eye_space::EyeSpace;

/// A vertex of the mesh as seen: half a cache line.
#[derive(Clone, Copy, Default, Pod, Zeroable)]
#[repr(C, align(32))]
pub(crate) struct Point {
    /// Relative to the mesh's origin, in the axes of eye space.
    frame: [f64; 3],
    /// Normalised; 0 for cell data.
    scalar: f64,
}

impl Point {
    pub(crate) fn frame(&self) -> DVec3 {
        self.frame.into()
    }
}

/// Pixels by which a cell's box is widened, for rounding.
const MARGIN: f64 = 0.03125;

/// A cell is thin and seen aslant if no ray is inside for more than this share of its extent in depth: from there on it
/// matters that w is rounded.
const THIN: f64 = 0.0625;

/// Coefficients are limited to this value: sums and products with pixel positions stay finite.
pub(crate) const STEEPEST: f64 = 1e20;

/// The mesh's vertices as seen.
pub(crate) fn points(mesh: &DeviceMesh, scalar: &ScalarField, eye: &EyeSpace) -> Vec<Point> {
    let point = |(i, &[x, y, z, _]): (usize, &[f32; 4])| {
        let frame = eye.frame(DVec3::new(f64::from(x), f64::from(y), f64::from(z)));
        let scalar = if scalar.location == Location::Point { normalised(scalar, scalar.values[i]) } else { 0.0 };
        Point { frame: frame.to_array(), scalar }
    };
    mesh.points.par_iter().enumerate().map(point).collect()
}

/// What all cells of a picture have in common.
pub(crate) struct SetUp<'a> {
    mesh: &'a DeviceMesh,
    /// The mesh's cells, positively oriented.
    pub(crate) cells: &'a [[u32; 4]],
    pub(crate) points: &'a [Point],
    pub(crate) eye: &'a EyeSpace,
    pieces: &'a [Piece],
    /// Every cell is taken to meet all pieces.
    cut_all: bool,
    size: [u32; 2],
    /// No plane is edge-on of whose normal more than this points away from the eye's side, times its depth in perspective.
    edge_on: f64,
}

/// Cells in the widest vectors.
const WIDEST: usize = 8;

/// So few pieces are sooner all compared with than searched.
const FEW: usize = 24;

/// Exchanges of two of four that sort them.
const NETWORK: [[usize; 2]; 5] = [[0, 1], [2, 3], [0, 2], [1, 3], [1, 2]];

/// Chunks that one core sets up at a time.
const RUN: usize = 16;

/// The vertices of a chunk's cells, which are in ascending order, and 1 for each cell that is positively oriented then,
/// else -1.
struct Corners {
    points: [[Point; CHUNK]; 4],
    parity: [f64; CHUNK],
}

/// A cell's box of pixels, a vector each: first and one past the last in x, the same in y, and its middle.
struct Bounds<S: Simd> {
    first: [S::f64s; 2],
    end: [S::f64s; 2],
    middle: [S::f64s; 2],
}

impl<'a> SetUp<'a> {
    pub(crate) fn new(job: &'a Job, points: &'a [Point], cut_all: bool) -> SetUp<'a> {
        let (mesh, eye) = (job.mesh, &job.eye);
        let across = mesh.bounds[0].distance(mesh.bounds[1]);
        // No normal is longer, and no coordinate larger.
        let (normal, reach) = (across * across, eye.offset.length() + across);
        let edge_on = EDGE_ON * 2.0 * normal * if eye.orthographic { 1.0 } else { reach };
        SetUp { mesh, cells: job.cells, points, eye, pieces: job.pieces, cut_all, size: job.size, edge_on }
    }

    /// Sets up cells, in their order, in the place of others.
    pub(crate) fn chunks(&self, level: Level, cells: &[u32], chunks: &mut [Chunk]) {
        let runs = cells.par_chunks(RUN * CHUNK).zip(chunks.par_chunks_mut(RUN));
        runs.for_each(|(cells, chunks)| dispatch!(level, simd => self.run(simd, cells, chunks)));
    }

    #[inline(always)]
    fn run<S: Simd>(&self, simd: S, cells: &[u32], chunks: &mut [Chunk]) {
        let mut rest = cells.chunks(CHUNK);
        let mut cells = rest.next().unwrap_or_default();
        let mut names = self.names(cells);
        for chunk in chunks {
            // Those of the next are on their way while these are set up.
            let next = rest.next().unwrap_or_default();
            let next_names = self.names(next);
            self.chunk(simd, cells, &names, chunk);
            (cells, names) = (next, next_names);
        }
    }

    /// The vertices of a chunk's cells.
    #[inline(always)]
    fn names(&self, cells: &[u32]) -> [[u32; 4]; CHUNK] {
        let mut names = [[0; 4]; CHUNK];
        for (names, &cell) in names.iter_mut().zip(cells) {
            *names = self.cells[cell as usize];
        }
        names
    }

    #[inline(always)]
    fn chunk<S: Simd>(&self, simd: S, cells: &[u32], names: &[[u32; 4]; CHUNK], chunk: &mut Chunk) {
        let (names, parity) = ascending(names);
        let mut corners = Corners { points: [[Point::default(); CHUNK]; 4], parity };
        let Corners { points: [a, b, c, d], .. } = &mut corners;
        // All that is needed is loaded first, the misses at once.
        for lane in 0..cells.len().min(CHUNK) {
            a[lane] = self.points[names[0][lane] as usize];
            b[lane] = self.points[names[1][lane] as usize];
            c[lane] = self.points[names[2][lane] as usize];
            d[lane] = self.points[names[3][lane] as usize];
        }
        // Whole vectors: behind the last cell they hold what nothing looks at.
        for start in (0..cells.len()).step_by(S::f64s::LEN) {
            self.vector(simd, &cells[start..], &corners, start, chunk);
        }
        // Nothing is seen of what is behind the last cell.
        chunk.tiles[cells.len()..].fill([0; 4]);
    }

    /// Sets up as many cells as there are lanes, the first of them at `start`.
    #[inline(always)]
    fn vector<S: Simd>(&self, simd: S, cells: &[u32], corners: &Corners, start: usize, chunk: &mut Chunk) {
        let lanes = S::f64s::LEN;
        let splat = |x: f64| S::f64s::splat(simd, x);
        let Corners { points: [a, b, c, d], parity } = corners;
        let (a, s0) = load(simd, &a[start..start + lanes]);
        let (b, s1) = load(simd, &b[start..start + lanes]);
        let (c, s2) = load(simd, &c[start..start + lanes]);
        let (d, s3) = load(simd, &d[start..start + lanes]);
        let scalars = [s0, s1, s2, s3];
        let parity = S::f64s::from_slice(simd, &parity[start..start + lanes]);
        let offset = Vector { x: splat(self.eye.offset.x), y: splat(self.eye.offset.y), z: splat(self.eye.offset.z) };
        let eye = [a + offset, b + offset, c + offset, d + offset];
        let farthest = eye[0].z.max(eye[1].z).max(eye[2].z.max(eye[3].z));
        let nearest = eye[0].z.min(eye[1].z).min(eye[2].z.min(eye[3].z));
        let bounds = self.bound(simd, &eye, nearest);
        let is_seen = bounds.first[0].simd_lt(bounds.end[0]) & bounds.first[1].simd_lt(bounds.end[1]);
        let boxes = packed(simd, &bounds, is_seen);
        let tiles = &mut chunk.tiles[start..start + lanes];
        for (lane, tiles) in tiles.iter_mut().enumerate() {
            let ([x, y], [right, bottom]) = (boxes[lane], boxes[lanes + lane]);
            const SIDE: u16 = TILE as u16;
            *tiles = [x / SIDE, y / SIDE, right.div_ceil(SIDE), bottom.div_ceil(SIDE)];
        }
        let records = &mut chunk.records[start..start + lanes];
        if !is_seen.any_true() {
            records.iter_mut().for_each(|record| (record.first, record.end) = ([0; 2], [0; 2]));
            return;
        }
        let (base, range, pieces) = self.classify(simd, cells, scalars);

        let farthest = farthest.max(self.eye.near);
        let nearest = nearest.max(self.eye.near).min(farthest);
        // The ray through the middle pixel: in perspective where it is at depth z_ref.
        let scale = if self.eye.orthographic { splat(self.eye.pixel) } else { farthest * self.eye.pixel };
        let across = (bounds.middle[0] + (0.5 - self.eye.middle[0])) * scale;
        let down = (bounds.middle[1] + (0.5 - self.eye.middle[1])) * scale;
        let origin = Vector { x: across, y: down, z: farthest };

        // (b-a) x (c-a) of each face: both cells at a face find the same bits.
        let (e1, e2, e3) = (b - a, c - a, d - a);
        let normals = [(c - b).cross(d - b), e2.cross(e3), e1.cross(e3), e1.cross(e2)];
        let (mut planes, sides) = self.planes(simd, &normals, &eye, origin, scale);
        let [p, q, r, s] = sides;
        let seen = p.abs() + q.abs() + r.abs() + s.abs();
        let span = farthest - nearest;
        let near = if self.eye.orthographic { span } else { span / nearest }.min(STEEPEST);

        let volume = dot(e1, normals[1]);
        let size = volume.abs();
        let tiny = size.simd_le(f64::MIN_POSITIVE);
        // Six volumes over twice the area that is seen is the longest ray; that area is half of all faces'.
        let longest = size * if self.eye.orthographic { splat(2.0) } else { farthest * 2.0 };
        let thin = longest.simd_lt(span * seen * THIN) & is_seen;
        let inverse = splat(1.0) / tiny.select(splat(1.0), volume);
        let [s0, s1, s2, s3] = scalars;
        let [r1, r2, r3] = [(s1 - s0) * inverse, (s2 - s0) * inverse, (s3 - s0) * inverse];
        let sum = normals[1] * r1 - normals[2] * r2 + normals[3] * r3;
        let zero = splat(0.0);
        let gradient = Vector { x: tiny.select(zero, sum.x), y: tiny.select(zero, sum.y), z: tiny.select(zero, sum.z) };
        let at = s0 - base + dot(gradient, origin - eye[0]);
        let along = if self.eye.orthographic { gradient.z } else { dot(gradient, origin) - at };
        let mut scalar = [limited(gradient.x * scale), limited(gradient.y * scale), limited(at)];
        let along = limited(along);

        let (fronts, back) = fronts_first(simd, &mut planes, sides, parity);
        let mut flatter = [zero; 3];
        if thin.any_true() {
            let half = [(bounds.end[0] - bounds.first[0]) * 0.5, (bounds.end[1] - bounds.first[1]) * 0.5];
            flatter = lean(simd, &planes, back, half, thin, near);
            for i in 0..3 {
                for plane in &mut planes {
                    plane[i] -= flatter[i];
                }
                scalar[i] -= along * flatter[i];
            }
        }
        let ([x, y, at], [lean_x, lean_y, lean_at]) = (scalar, flatter);
        let [[px, py, pw], [qx, qy, qw], [rx, ry, rw], [sx, sy, sw]] = planes;
        let fields = [
            [px, near],
            [py, x],
            [pw, y],
            [qx, at],
            [qy, along],
            [qw, base],
            [rx, range],
            [ry, farthest],
            [rw, farthest - self.eye.offset.z],
            [sx, zero],
            [sy, zero],
            [sw, bounds.middle[0]],
            [lean_x, bounds.middle[1]],
            [lean_y, zero],
            [lean_at, zero],
        ];
        store(simd, fields, records);
        let counts = integers::<S>(fronts.narrow(zero));
        for (lane, record) in records.iter_mut().enumerate() {
            record.fronts = counts[lane] as u32;
            (record.first, record.end) = (boxes[lane], boxes[lanes + lane]);
            record.pieces = [pieces[lane], pieces[lanes + lane]];
        }
    }

    /// The boxes of pixels in which cells may be seen: empty if they hold no pixel's centre.
    #[inline(always)]
    fn bound<S: Simd>(&self, simd: S, eye: &[Vector<S>; 4], nearest: S::f64s) -> Bounds<S> {
        let [ax, ay] = self.pixel(simd, eye[0]);
        let [bx, by] = self.pixel(simd, eye[1]);
        let [cx, cy] = self.pixel(simd, eye[2]);
        let [dx, dy] = self.pixel(simd, eye[3]);
        let mut low = [ax.min(bx).min(cx.min(dx)), ay.min(by).min(cy.min(dy))];
        let mut high = [ax.max(bx).max(cx.max(dx)), ay.max(by).max(cy.max(dy))];
        let before = nearest.simd_lt(self.eye.near);
        if before.any_true() {
            let (before, mut bounds) = (before.to_bitmask(), [low, high]);
            for lane in (0..S::f64s::LEN).filter(|lane| before >> lane & 1 != 0) {
                let point = |i: usize| DVec3::new(eye[i].x[lane], eye[i].y[lane], eye[i].z[lane]);
                let found = self.eye.seen_bounds([point(0), point(1), point(2), point(3)]);
                for axis in 0..2 {
                    (bounds[0][axis][lane], bounds[1][axis][lane]) = (found[0][axis], found[1][axis]);
                }
            }
            [low, high] = bounds;
        }
        // The pixels whose centres, at i + 1/2, lie between the bounds.
        let [width, height] = self.size.map(f64::from);
        let inside = |x: S::f64s, side: f64| x.max(0.0).min(side).floor();
        let first = [inside(low[0] + (0.5 - MARGIN), width), inside(low[1] + (0.5 - MARGIN), height)];
        let end = [inside(high[0] + (0.5 + MARGIN), width), inside(high[1] + (0.5 + MARGIN), height)];
        let middle = [((first[0] + end[0]) * 0.5).floor(), ((first[1] + end[1]) * 0.5).floor()];
        Bounds { first, end, middle }
    }

    /// The pixel positions of points; of use only in front of the near plane.
    #[inline(always)]
    fn pixel<S: Simd>(&self, simd: S, p: Vector<S>) -> [S::f64s; 2] {
        let scale = if self.eye.orthographic {
            S::f64s::splat(simd, 1.0 / self.eye.pixel)
        } else {
            S::f64s::splat(simd, 1.0) / (p.z.max(self.eye.near) * self.eye.pixel)
        };
        [p.x * scale + self.eye.middle[0], p.y * scale + self.eye.middle[1]]
    }

    /// The lowest scalars of cells, how much higher the highest are, both in single precision, and the first and the last
    /// pieces of the transfer function that they meet: the first of all lanes before the last.
    #[inline(always)]
    fn classify<S: Simd>(
        &self,
        simd: S,
        cells: &[u32],
        [a, b, c, d]: [S::f64s; 4],
    ) -> (S::f64s, S::f64s, [u32; 2 * WIDEST]) {
        let lanes = S::f64s::LEN;
        let mut ends = a.min(b).min(c.min(d)).narrow(a.max(b).max(c.max(d)));
        if !self.mesh.cell_scalars.is_empty() {
            let mut own = ends;
            for (lane, &cell) in cells.iter().enumerate().take(lanes) {
                if let Some(s) = self.mesh.own_scalar(cell) {
                    (own[lane], own[lanes + lane]) = (s, s);
                }
            }
            ends = own;
        }
        let mut pieces = [0; 2 * WIDEST];
        if self.cut_all {
            pieces[lanes..].fill(self.pieces.len() as u32 - 1);
        } else if self.pieces.len() <= FEW {
            // Pieces begin where others end: as many as begin at or below the lowest, and below the highest, but one.
            let (zero, one) = (S::f32s::splat(simd, 0.0), S::f32s::splat(simd, 1.0));
            let (mut first, mut last) = (zero, zero);
            for piece in self.pieces.iter().skip(1) {
                let begin = S::f32s::splat(simd, piece.s[0]);
                first += begin.simd_le(ends).select(one, zero);
                last += begin.simd_lt(ends).select(one, zero);
            }
            let (firsts, lasts) = (integers::<S>(first), integers::<S>(last));
            for lane in 0..lanes {
                let (first, last) = (firsts[lane] as u32, lasts[lanes + lane] as u32);
                // A piece that is only touched at its beginning is not entered.
                (pieces[lane], pieces[lanes + lane]) = (first, last.max(first));
            }
        } else {
            for lane in 0..lanes {
                [pieces[lane], pieces[lanes + lane]] = self.pieces_of(ends[lane], ends[lanes + lane]);
            }
        }
        let (base, most) = ends.widen();
        (base, most - base, pieces)
    }

    /// The first and the last piece of the transfer function that a range meets.
    #[inline(always)]
    fn pieces_of(&self, least: f32, most: f32) -> [u32; 2] {
        let first = piece_at(self.pieces, least);
        // A piece that is only touched at its beginning is not entered.
        let mut last = first;
        while self.pieces[last].s[1] < most && last + 1 < self.pieces.len() {
            last += 1;
        }
        [first as u32, last as u32]
    }
}

#[inline(always)]
fn limited<V: fearless_simd::SimdFloat<S, Element = f64>, S: Simd>(x: V) -> V {
    x.max(-STEEPEST).min(STEEPEST)
}

/// The vertices of each cell in ascending order, the first of all cells before the second, and 1 for each cell that takes
/// an even permutation, else -1.
#[inline(always)]
fn ascending(cells: &[[u32; 4]; CHUNK]) -> ([[u32; CHUNK]; 4], [f64; CHUNK]) {
    let (mut names, mut odd, mut parity) = ([[0; CHUNK]; 4], [0; CHUNK], [1.0; CHUNK]);
    for (lane, cell) in cells.iter().enumerate() {
        [names[0][lane], names[1][lane], names[2][lane], names[3][lane]] = *cell;
    }
    for [i, j] in NETWORK {
        for lane in 0..CHUNK {
            let (a, b) = (names[i][lane], names[j][lane]);
            odd[lane] ^= u32::from(a > b);
            (names[i][lane], names[j][lane]) = (a.min(b), a.max(b));
        }
    }
    for (parity, odd) in parity.iter_mut().zip(odd) {
        *parity = if odd == 0 { 1.0 } else { -1.0 };
    }
    (names, parity)
}

/// The coordinates and the scalars of as many points as there are lanes.
#[inline(always)]
fn load<S: Simd>(simd: S, points: &[Point]) -> (Vector<S>, S::f64s) {
    let (values, lanes) = (bytemuck::cast_slice(points), S::f64s::LEN);
    let row = |i: usize| S::f64s::from_slice(simd, &values[i * lanes..][..lanes]);
    // Every other number, twice: x and z, y and s; then each alone.
    let (xz, ys) = row(0).deinterleave(row(1));
    let (more_xz, more_ys) = row(2).deinterleave(row(3));
    let ((x, z), (y, s)) = (xz.deinterleave(more_xz), ys.deinterleave(more_ys));
    (Vector { x, y, z }, s)
}

/// The corners of boxes: the first pixels of all lanes before those behind the last; all 0 where nothing is seen.
#[inline(always)]
fn packed<S: Simd>(simd: S, bounds: &Bounds<S>, is_seen: S::mask64s) -> [[u16; 2]; 2 * WIDEST] {
    let zero = S::f64s::splat(simd, 0.0);
    let along = |axis: usize| {
        integers::<S>(is_seen.select(bounds.first[axis], zero).narrow(is_seen.select(bounds.end[axis], zero)))
    };
    let (x, y) = (along(0), along(1));
    let mut corners = [[0; 2]; 2 * WIDEST];
    for (i, corner) in corners.iter_mut().enumerate() {
        *corner = [x[i] as u16, y[i] as u16];
    }
    corners
}

/// Small whole numbers as such.
#[inline(always)]
fn integers<S: Simd>(numbers: S::f32s) -> [i32; 2 * WIDEST] {
    let mut integers = [0; 2 * WIDEST];
    S::i32s::truncate_from(numbers).store_slice(&mut integers[..S::f32s::LEN]);
    integers
}
