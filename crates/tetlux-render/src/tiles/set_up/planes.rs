//! The planes of faces, which of them are front faces, and the one that a thin cell is counted from.

use fearless_simd::{Select, Simd, SimdBase, SimdMask, SimdNarrow, SimdWiden};

use super::{NETWORK, SetUp, limited};
use crate::tiles::vector::{Vector, dot};

/// Planes within this angle (in radians, roughly) of edge-on count as edge-on: what double precision leaves uncertain.
pub(super) const EDGE_ON: f64 = 1e-12;

/// A ray in a plane that is seen edge-on is taken for one this share of the picture's larger side, and no less than
/// this share of `NUDGE_SIDE` pixels, away: further than single precision misses the plane by. Then all faces that
/// meet in an edge along the ray agree on which side of each it passes. No edge of a grid runs along this direction.
const NUDGE: [f64; 2] = [5.9e-7, 3.3e-7];
const NUDGE_SIDE: f64 = 128.0;

/// A plane may be leant on if no w within the cell's box is larger than so many times its extent, nor than this: the
/// other planes are rounded as it is.
const LEAN: [f64; 2] = [64.0, 1e4];

/// Vertices of each face in ascending order, opposite vertices 0 to 3. In that order every other face's normal points
/// out of a positively oriented cell.
const FACES: [[usize; 3]; 4] = [[1, 2, 3], [0, 2, 3], [0, 1, 3], [0, 1, 2]];

impl SetUp<'_> {
    /// (dw/dx, dw/dy, w at the middle) of each face's plane; and how much of its normal points away from the eye's side,
    /// times the plane's depth in perspective. `origin` is the point at depth `z_ref` on the middle's ray, `scale` the side of
    /// a pixel there.
    #[inline(always)]
    pub(super) fn planes<S: Simd>(
        &self,
        simd: S,
        normals: &[Vector<S>; 4],
        eye: &[Vector<S>; 4],
        origin: Vector<S>,
        scale: S::f64s,
    ) -> ([[S::f64s; 3]; 4], [S::f64s; 4]) {
        let [p, q, r, s] = [
            self.plane(simd, normals[0], eye[1], origin, scale),
            self.plane(simd, normals[1], eye[0], origin, scale),
            self.plane(simd, normals[2], eye[0], origin, scale),
            self.plane(simd, normals[3], eye[0], origin, scale),
        ];
        let (mut planes, sides) = ([p.0, q.0, r.0, s.0], [p.1, q.1, r.1, s.1]);
        let least = p.1.abs().min(q.1.abs()).min(r.1.abs().min(s.1.abs()));
        if least.simd_le(self.edge_on).any_true() {
            for (face, vertices) in FACES.into_iter().enumerate() {
                let plane =
                    self.near_edge_on(simd, normals[face], vertices.map(|v| eye[v]), sides[face], (origin, scale));
                let (edge_on, plane) = plane;
                for i in 0..3 {
                    planes[face][i] = limited(edge_on.select(plane[i], planes[face][i]));
                }
            }
        }
        (planes, sides)
    }

    /// The plane of a face with normal n through a, and how much of n points away, times the depth in perspective; of no use
    /// if that is next to nothing.
    #[inline(always)]
    fn plane<S: Simd>(
        &self,
        simd: S,
        n: Vector<S>,
        a: Vector<S>,
        origin: Vector<S>,
        scale: S::f64s,
    ) -> ([S::f64s; 3], S::f64s) {
        let side = if self.eye.orthographic { n.z } else { dot(n, a) };
        let inverse = S::f64s::splat(simd, 1.0) / side;
        let slope = scale * inverse;
        ([n.x * slope, n.y * slope, dot(n, origin - a) * inverse], side)
    }

    /// Whether a face is seen edge-on, and its plane if it is. That bounds nothing but the silhouette: any large slope of the
    /// right sign does, through the pixel of `a` if that is in front of the eye, and both cells at the face choose the same.
    #[inline(always)]
    fn near_edge_on<S: Simd>(
        &self,
        simd: S,
        n: Vector<S>,
        [a, b, c]: [Vector<S>; 3],
        side: S::f64s,
        (origin, scale): (Vector<S>, S::f64s),
    ) -> (S::mask64s, [S::f64s; 3]) {
        let splat = |x: f64| S::f64s::splat(simd, x);
        let (size, across) = if self.eye.orthographic {
            (n.x.abs() + n.y.abs(), n.x * (origin.x - a.x) + n.y * (origin.y - a.y))
        } else {
            let reach = a.reach().max(b.reach()).max(c.reach());
            let in_front = a.z.simd_gt(self.eye.near);
            let at_a = in_front.select(side, splat(0.0)) * origin.z / in_front.select(a.z, splat(1.0));
            ((n.x.abs() + n.y.abs() + n.z.abs()) * reach, dot(n, origin) - at_a)
        };
        let toward = side.simd_ge(0.0).select(splat(1.0), splat(-1.0));
        let inverse = splat(1.0) / ((size * EDGE_ON).max(1e-200) * toward);
        let (x, y) = (n.x * scale * inverse, n.y * scale * inverse);
        let larger = f64::from(self.size[0].max(self.size[1])).max(NUDGE_SIDE);
        let nudge = x * (NUDGE[0] * larger) + y * (NUDGE[1] * larger);
        (side.abs().simd_le(size * EDGE_ON), [x, y, across * inverse + nudge])
    }
}

/// Sorts planes by what they are, front faces first; how many are front faces, and which of them are not.
#[inline(always)]
pub(super) fn fronts_first<S: Simd>(
    simd: S,
    planes: &mut [[S::f64s; 3]; 4],
    [p, q, r, s]: [S::f64s; 4],
    parity: S::f64s,
) -> (S::f64s, [S::mask64s; 4]) {
    let negative = parity.simd_lt(0.0);
    let ahead = |side: S::f64s| side.simd_ge(0.0) ^ negative;
    let mut back = [ahead(p), !ahead(q), ahead(r), !ahead(s)];
    let (zero, one) = (S::f64s::splat(simd, 0.0), S::f64s::splat(simd, 1.0));
    let front = |back: S::mask64s| back.select(zero, one);
    let fronts = front(back[0]) + front(back[1]) + (front(back[2]) + front(back[3]));
    for [i, j] in NETWORK {
        exchange::<S>(planes, &mut back, [i, j]);
    }
    (fronts, back)
}

/// Exchanges two planes where the first is a back face and the second is not.
#[inline(always)]
fn exchange<S: Simd>(planes: &mut [[S::f64s; 3]; 4], back: &mut [S::mask64s; 4], [i, j]: [usize; 2]) {
    let turned = back[i] & !back[j];
    for k in 0..3 {
        let (first, second) = (planes[i][k], planes[j][k]);
        (planes[i][k], planes[j][k]) = (turned.select(second, first), turned.select(first, second));
    }
    (back[i], back[j]) = (back[i] & back[j], back[i] | back[j]);
}

/// The plane that each thin cell is counted from: its front face or its back face that are the least apart, whichever is
/// flatter, in single precision; 0 if it is too steep, and for all other cells. Front faces come first; `half` the sides of
/// the cells' boxes.
#[inline(always)]
pub(super) fn lean<S: Simd>(
    simd: S,
    planes: &[[S::f64s; 3]; 4],
    back: [S::mask64s; 4],
    half: [S::f64s; 2],
    thin: S::mask64s,
    near: S::f64s,
) -> [S::f64s; 3] {
    let (zero, infinity) = (S::f64s::splat(simd, 0.0), S::f64s::splat(simd, f64::INFINITY));
    let [p, q, r, s] = planes;
    let reaches = [reach::<S>(p, half), reach::<S>(q, half), reach::<S>(r, half), reach::<S>(s, half)];
    let (mut least, mut size, mut flatter) = (infinity, infinity, [zero; 3]);
    for [i, j] in [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]] {
        let (a, b) = (&planes[i], &planes[j]);
        let apart = reach::<S>(&[a[0] - b[0], a[1] - b[1], a[2] - b[2]], half);
        let nearer = back[j] & !back[i] & apart.simd_lt(least);
        let first = reaches[i].simd_le(reaches[j]);
        least = nearer.select(apart, least);
        size = nearer.select(first.select(reaches[i], reaches[j]), size);
        for k in 0..3 {
            flatter[k] = nearer.select(first.select(a[k], b[k]), flatter[k]);
        }
    }
    let leans = thin & size.simd_le((near * LEAN[0]).min(LEAN[1]));
    let [x, y, at] = flatter;
    let (x, y) = leans.select(x, zero).narrow(leans.select(y, zero)).widen();
    [x, y, leans.select(at, zero).narrow(zero).widen().0]
}

/// The largest value of a plane in a box, whose sides are halved.
#[inline(always)]
fn reach<S: Simd>([x, y, at]: &[S::f64s; 3], half: [S::f64s; 2]) -> S::f64s {
    x.abs() * half[0] + y.abs() * half[1] + at.abs()
}
