//! Cells set up in double precision, as many at a time as a vector has lanes.

use fearless_simd::{Level, Select, Simd, SimdBase, SimdFloat, SimdMask, SimdNarrow, dispatch};
use glam::DVec3;
use rayon::prelude::*;
use tetlux_mesh::{Location, ScalarField};
use tetlux_optics::transfer_f32::{Piece, piece_at};

use super::bins::TILE;
use super::record::{CHUNK, Chunk, Record};
use super::vector::{Vector, dot};
use crate::device_mesh::{DeviceMesh, NEGATIVE, normalised};
use crate::eye_space::EyeSpace;

/// A vertex of the mesh as seen.
#[derive(Clone, Copy)]
pub(crate) struct Point {
    /// Relative to the mesh's origin, in the axes of eye space.
    pub(crate) frame: DVec3,
    /// Pixel position; of use only in front of the near plane.
    pixel: [f64; 2],
    /// Normalised; 0 for cell data.
    scalar: f64,
}

/// Pixels by which a cell's box is widened, for rounding.
const MARGIN: f64 = 0.03125;

/// Planes within this angle (in radians, roughly) of edge-on count as edge-on: what double precision leaves uncertain.
const EDGE_ON: f64 = 1e-12;

/// A ray in a plane that is seen edge-on is taken for one this share of the picture's larger side, and no less than
/// this share of `NUDGE_SIDE` pixels, away: further than single precision misses the plane by. Then all faces that
/// meet in an edge along the ray agree on which side of each it passes. No edge of a grid runs along this direction.
const NUDGE: [f64; 2] = [5.9e-7, 3.3e-7];
const NUDGE_SIDE: f64 = 128.0;

/// A cell is thin and seen aslant if no ray is inside for more than this share of its extent in depth: from there on it
/// matters that w is rounded.
const THIN: f64 = 0.0625;

/// A plane may be leant on if no w within the cell's box is larger than so many times its extent, nor than this: the
/// other planes are rounded as it is.
const LEAN: [f64; 2] = [64.0, 1e4];

/// Coefficients are limited to this value: sums and products with pixel positions stay finite.
pub(crate) const STEEPEST: f64 = 1e20;

/// The mesh's vertices as seen.
pub(crate) fn points(mesh: &DeviceMesh, scalar: &ScalarField, eye: &EyeSpace) -> Vec<Point> {
    let point = |(i, &[x, y, z, _]): (usize, &[f32; 4])| {
        let frame = eye.frame(DVec3::new(f64::from(x), f64::from(y), f64::from(z)));
        let scalar = if scalar.location == Location::Point { normalised(scalar, scalar.values[i]) } else { 0.0 };
        Point { frame, pixel: eye.pixel_of(frame + eye.offset), scalar }
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

/// Cells in the widest vectors.
const WIDEST: usize = 8;

/// Vertices of each face in ascending order, opposite vertices 0 to 3. In that order every other face's normal points
/// out of a positively oriented cell.
const FACES: [[usize; 3]; 4] = [[1, 2, 3], [0, 2, 3], [0, 1, 3], [0, 1, 2]];

impl SetUp<'_> {
    /// Sets up cells, in their order, in the place of others.
    pub(crate) fn chunks(&self, level: Level, cells: &[u32], chunks: &mut [Chunk]) {
        let pairs = cells.par_chunks(CHUNK).zip(chunks);
        pairs.for_each(|(cells, chunk)| dispatch!(level, simd => self.chunk(simd, cells, chunk)));
    }

    #[inline(always)]
    fn chunk<S: Simd>(&self, simd: S, cells: &[u32], chunk: &mut Chunk) {
        // All that is needed is loaded first, the misses at once.
        let mut names = [[0; 4]; CHUNK];
        for (names, &cell) in names.iter_mut().zip(cells) {
            *names = self.mesh.cells[cell as usize];
        }
        let mut touched = 0;
        for &[a, b, c, d] in &names[..cells.len()] {
            for v in [a & !NEGATIVE, b, c, d] {
                touched ^= self.points[v as usize].scalar.to_bits();
            }
        }
        std::hint::black_box(touched);
        let lanes = S::f64s::LEN;
        for start in (0..cells.len()).step_by(lanes) {
            let end = (start + lanes).min(cells.len());
            self.vector(simd, &cells[start..end], &names[start..end], &mut chunk.records[start..end]);
        }
        chunk.tiles = [[0; 4]; CHUNK];
        for (tiles, record) in chunk.tiles.iter_mut().zip(&chunk.records[..cells.len()]) {
            let ([x, y], [right, bottom]) = (record.first, record.end);
            const SIDE: u16 = TILE as u16;
            *tiles = [x / SIDE, y / SIDE, right.div_ceil(SIDE), bottom.div_ceil(SIDE)];
        }
    }

    /// Sets up as many cells as there are lanes, or fewer.
    #[inline(always)]
    fn vector<S: Simd>(&self, simd: S, cells: &[u32], names: &[[u32; 4]], records: &mut [Record]) {
        let mut frame = [[[0.0; WIDEST]; 3]; 4];
        let mut pixels = [[[0.0; WIDEST]; 2]; 4];
        let mut scalars = [[0.0; WIDEST]; 4];
        for (lane, names) in names.iter().enumerate() {
            for i in 0..4 {
                let point = &self.points[(names[i] & !NEGATIVE) as usize];
                frame[i][0][lane] = point.frame.x;
                frame[i][1][lane] = point.frame.y;
                frame[i][2][lane] = point.frame.z;
                pixels[i][0][lane] = point.pixel[0];
                pixels[i][1][lane] = point.pixel[1];
                scalars[i][lane] = point.scalar;
            }
        }
        let middle = self.bound(simd, &frame, &pixels, records);
        if !records.iter().any(Record::is_seen) {
            return;
        }
        let base = self.classify(simd, cells, &scalars, records);

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
        let [across, down] = [0, 1].map(|axis| load(&middle[axis]) + (0.5 - self.eye.middle[axis]));
        let origin = Vector { x: across * scale, y: down * scale, z: farthest };

        // (b-a) x (c-a) of each face: both cells at a face find the same bits.
        let (e1, e2, e3) = (frame[1] - frame[0], frame[2] - frame[0], frame[3] - frame[0]);
        let normals = [(frame[2] - frame[1]).cross(frame[3] - frame[1]), e2.cross(e3), e1.cross(e3), e1.cross(e2)];
        let (mut planes, mut seen) = ([[splat(0.0); 4]; 4], splat(0.0));
        for (face, [a, b, c]) in FACES.into_iter().enumerate() {
            let side;
            (planes[face], side) = self.plane(simd, normals[face], [eye[a], eye[b], eye[c]], origin, scale);
            seen += side.max(-side);
        }
        let span = farthest - nearest;
        let nearest = if self.eye.orthographic { span } else { span / nearest }.min(STEEPEST);

        let base = load(&base);
        let [a, b, c, d] = &scalars;
        let s = [load(a) - base, load(b) - base, load(c) - base, load(d) - base];
        let volume = dot(e1, normals[1]);
        let size = volume.max(-volume);
        let tiny = size.simd_le(f64::MIN_POSITIVE);
        // Six volumes over twice the area that is seen is the longest ray; that area is half of all faces'.
        let longest = size * if self.eye.orthographic { splat(2.0) } else { farthest * 2.0 };
        let thin = longest.simd_lt(span * seen * THIN).to_bitmask();
        let inverse = splat(1.0) / tiny.select(splat(1.0), volume);
        let [s1, s2, s3] = [(s[1] - s[0]) * inverse, (s[2] - s[0]) * inverse, (s[3] - s[0]) * inverse];
        let sum = normals[1] * s1 - normals[2] * s2 + normals[3] * s3;
        let zero = splat(0.0);
        let gradient = Vector { x: tiny.select(zero, sum.x), y: tiny.select(zero, sum.y), z: tiny.select(zero, sum.z) };
        let at = s[0] + dot(gradient, origin - eye[0]);
        let along = if self.eye.orthographic { gradient.z } else { dot(gradient, origin) - at };
        let (x, y, at, along) = (limited(gradient.x * scale), limited(gradient.y * scale), limited(at), limited(along));

        // Two values of each lane, the first of all lanes before the second.
        let pair = |a: S::f64s, b: S::f64s| -> [f32; 2 * WIDEST] {
            let mut pair = [0.0; 2 * WIDEST];
            a.narrow(b).store_slice(&mut pair[..2 * S::f64s::LEN]);
            pair
        };
        let [[px, py, pw, pt], [qx, qy, qw, qt], [rx, ry, rw, rt], [sx, sy, sw, st]] = planes;
        let slopes = [pair(px, py), pair(qx, qy), pair(rx, ry), pair(sx, sy)];
        let (heights, toward) = ([pair(pw, qw), pair(rw, sw)], [pair(pt, qt), pair(rt, st)]);
        let depths = [pair(nearest, farthest), pair(farthest - self.eye.offset.z, along)];
        let scalars = [pair(x, y), pair(at, at)];
        let second = S::f64s::LEN;
        for (lane, (names, record)) in names.iter().zip(records).enumerate() {
            let other = lane + second;
            let parity = if names[0] & NEGATIVE == 0 { 1.0 } else { -1.0 };
            let (mut fronts, mut backs, mut faces) = (0, 4, [0; 4]);
            for face in 0..4 {
                let here = if face % 2 == 0 { lane } else { other };
                let inward = if face % 2 == 0 { -parity } else { parity };
                let is_front = toward[face / 2][here] * inward > 0.0;
                backs -= usize::from(!is_front);
                let place = if is_front { fronts } else { backs };
                record.planes[place] = [slopes[face][lane], slopes[face][other], heights[face / 2][here]];
                faces[place] = face;
                fronts += usize::from(is_front);
            }
            record.fronts = fronts as u32;
            record.lean = [0.0; 3];
            record.nearest = depths[0][lane];
            record.depth = depths[0][other];
            record.level = depths[1][lane];
            record.along = depths[1][other];
            record.scalar = [scalars[0][lane], scalars[0][other], scalars[1][lane]];
            if thin >> lane & 1 != 0 {
                let planes = faces.map(|face| [0, 1, 2].map(|i| planes[face][i][lane]));
                lean(record, planes, [x[lane], y[lane], at[lane]], along[lane]);
            }
        }
    }

    /// (dw/dx, dw/dy, w at the middle) of the plane through a, b, c with normal n, and +1 if n points away from
    /// the eye's side, else -1; and how much of n points away, times the plane's depth in perspective. `origin` is the
    /// point at depth `z_ref` on the middle's ray, `scale` the side of a pixel there.
    #[inline(always)]
    fn plane<S: Simd>(
        &self,
        simd: S,
        n: Vector<S>,
        [a, b, c]: [Vector<S>; 3],
        origin: Vector<S>,
        scale: S::f64s,
    ) -> ([S::f64s; 4], S::f64s) {
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
        ([limited(x), limited(y), limited(at), toward], side)
    }

    /// Sets the boxes of pixels in which cells may be seen: empty if they hold no pixel's centre. Their middles.
    #[inline(always)]
    fn bound<S: Simd>(
        &self,
        simd: S,
        frame: &[[[f64; WIDEST]; 3]; 4],
        pixels: &[[[f64; WIDEST]; 2]; 4],
        records: &mut [Record],
    ) -> [[f64; WIDEST]; 2] {
        let lanes = S::f64s::LEN;
        let load = |values: &[f64; WIDEST]| S::f64s::from_slice(simd, &values[..lanes]);
        let [mut low, mut high] = [[[0.0; WIDEST]; 2]; 2];
        for axis in 0..2 {
            let [a, b] = [load(&pixels[0][axis]), load(&pixels[1][axis])];
            let [c, d] = [load(&pixels[2][axis]), load(&pixels[3][axis])];
            a.min(b).min(c.min(d)).store_slice(&mut low[axis][..lanes]);
            a.max(b).max(c.max(d)).store_slice(&mut high[axis][..lanes]);
        }
        let near = self.eye.near - self.eye.offset.z;
        let nearest = load(&frame[0][2]).min(load(&frame[1][2])).min(load(&frame[2][2]).min(load(&frame[3][2])));
        if nearest.simd_lt(near).any_true() {
            for lane in (0..records.len()).filter(|&lane| nearest[lane] < near) {
                let point = |i: usize| DVec3::new(frame[i][0][lane], frame[i][1][lane], frame[i][2][lane]);
                let bounds = self.eye.seen_bounds([0, 1, 2, 3].map(|i| point(i) + self.eye.offset));
                for axis in 0..2 {
                    (low[axis][lane], high[axis][lane]) = (bounds[0][axis], bounds[1][axis]);
                }
            }
        }
        // The pixels whose centres, at i + 1/2, lie between the bounds.
        let [mut first, mut end, mut middle] = [[[0.0; WIDEST]; 2]; 3];
        for axis in 0..2 {
            let side = f64::from(self.size[axis]);
            let from = (load(&low[axis]) + (0.5 - MARGIN)).max(0.0).min(side).floor();
            let to = (load(&high[axis]) + (0.5 + MARGIN)).max(0.0).min(side).floor();
            from.store_slice(&mut first[axis][..lanes]);
            to.store_slice(&mut end[axis][..lanes]);
            ((from + to) * 0.5).floor().store_slice(&mut middle[axis][..lanes]);
        }
        for (lane, record) in records.iter_mut().enumerate() {
            record.first = [first[0][lane] as u16, first[1][lane] as u16];
            record.end = [end[0][lane] as u16, end[1][lane] as u16];
            let seen = record.first[0] < record.end[0] && record.first[1] < record.end[1];
            if !seen {
                (record.first, record.end) = ([0; 2], [0; 2]);
            }
            record.middle = [middle[0][lane] as f32, middle[1][lane] as f32];
        }
        middle
    }

    /// Sets the ranges of cells' scalars and the pieces of the transfer function that they meet. The lowest scalars.
    #[inline(always)]
    fn classify<S: Simd>(
        &self,
        simd: S,
        cells: &[u32],
        scalars: &[[f64; WIDEST]; 4],
        records: &mut [Record],
    ) -> [f64; WIDEST] {
        let lanes = S::f64s::LEN;
        let load = |values: &[f64; WIDEST]| S::f64s::from_slice(simd, &values[..lanes]);
        let [a, b, c, d] = [load(&scalars[0]), load(&scalars[1]), load(&scalars[2]), load(&scalars[3])];
        let mut ends = [0.0; 2 * WIDEST];
        a.min(b).min(c.min(d)).narrow(a.max(b).max(c.max(d))).store_slice(&mut ends[..2 * lanes]);
        let mut base = [0.0; WIDEST];
        for (lane, record) in records.iter_mut().enumerate() {
            let (least, most) = match self.mesh.own_scalar(cells[lane]) {
                Some(s) => (s, s),
                None => (ends[lane], ends[lanes + lane]),
            };
            (record.base, record.range) = (least, most - least);
            base[lane] = f64::from(least);
            record.pieces = if self.cut_all { [0, self.pieces.len() as u32 - 1] } else { self.pieces_of(least, most) };
        }
        base
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

/// Has the planes and the scalar of a thin cell counted from the front face or the back face that are the least apart.
#[cold]
fn lean(record: &mut Record, planes: [[f64; 3]; 4], scalar: [f64; 3], along: f64) {
    let half = [0, 1].map(|axis| 0.5 * f64::from(record.end[axis] - record.first[axis]));
    // The largest value in the box.
    let reach = |[x, y, at]: [f64; 3]| x.abs() * half[0] + y.abs() * half[1] + at.abs();
    let less = |a: [f64; 3], b: [f64; 3]| [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
    let (fronts, backs) = planes.split_at(record.fronts as usize);
    let pairs = fronts.iter().flat_map(|&front| backs.iter().map(move |&back| [front, back]));
    let apart = |[front, back]: &[[f64; 3]; 2]| reach(less(*front, *back));
    let Some([front, back]) = pairs.min_by(|a, b| apart(a).total_cmp(&apart(b))) else { return };
    let flatter = if reach(front) <= reach(back) { front } else { back };
    if reach(flatter) <= LEAN[1].min(LEAN[0] * f64::from(record.nearest)) {
        record.lean = flatter.map(|x| x as f32);
        record.planes = planes.map(|plane| less(plane, record.lean.map(f64::from)).map(|x| x as f32));
        record.scalar = on_plane(scalar, along, record.lean);
    }
}

/// A scalar on a plane, in perspective times 1 + w: from what it is where w = 0, and `along` the rays ([`Record`]).
#[inline(always)]
pub(crate) fn on_plane(scalar: [f64; 3], along: f64, plane: [f32; 3]) -> [f32; 3] {
    [0, 1, 2].map(|i| (scalar[i] - along * f64::from(plane[i])) as f32)
}

#[inline(always)]
fn limited<V: fearless_simd::SimdFloat<S, Element = f64>, S: Simd>(x: V) -> V {
    x.max(-STEEPEST).min(STEEPEST)
}
