//! Rays of a block of pixels through a cell.

use fearless_simd::{Simd, SimdBase, SimdFloat, SimdMask};

use super::record::Record;

/// Pixels across a block; a vector of pixels is a block, and its lanes are rows of this many.
pub(crate) const WIDTH: usize = 4;

/// Column and row of each lane of the widest vectors.
const COLUMNS: [f32; 16] = [0.0, 1.0, 2.0, 3.0, 0.0, 1.0, 2.0, 3.0, 0.0, 1.0, 2.0, 3.0, 0.0, 1.0, 2.0, 3.0];
const ROWS: [f32; 16] = [0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0, 2.0, 2.0, 2.0, 2.0, 3.0, 3.0, 3.0, 3.0];

/// Columns and rows of a block's pixels whose first is at (x, y).
#[inline(always)]
pub(crate) fn places<S: Simd>(simd: S, x: f32, y: f32) -> (S::f32s, S::f32s) {
    let lanes = S::f32s::LEN;
    (S::f32s::from_slice(simd, &COLUMNS[..lanes]) + x, S::f32s::from_slice(simd, &ROWS[..lanes]) + y)
}

/// The value of (d/dx, d/dy, at the origin) at some places.
#[inline(always)]
fn linear<S: Simd>(simd: S, [dx, dy, c]: [f32; 3], x: S::f32s, y: S::f32s) -> S::f32s {
    x.mul_add(dx, y.mul_add(dy, S::f32s::splat(simd, c)))
}

/// More than any w.
const BEYOND: f32 = 1e30;

/// What takes the second plane and the third from where rays leave the cell, and from where they enter it, by how many
/// planes are front faces: 0, or beyond any w.
const SIDES: [[[f32; 2]; 2]; 8] = {
    const FRONT: [f32; 2] = [-BEYOND, 0.0];
    const BACK: [f32; 2] = [0.0, BEYOND];
    [[BACK; 2], [BACK; 2], [FRONT, BACK], [FRONT; 2], [FRONT; 2], [BACK; 2], [BACK; 2], [BACK; 2]]
};

/// Where rays enter a cell and leave it.
#[derive(Clone, Copy)]
pub(crate) struct Crossing<S: Simd> {
    /// w, counted from the cell's lean: the first is not above the second where they miss it.
    front: S::f32s,
    back: S::f32s,
    /// w of the lean.
    lean: S::f32s,
}

impl<S: Simd> Crossing<S> {
    /// Nowhere.
    #[inline(always)]
    pub(crate) fn none(simd: S) -> Crossing<S> {
        let zero = S::f32s::splat(simd, 0.0);
        Crossing { front: zero, back: zero, lean: zero }
    }

    /// Whether any of the rays meets the cell.
    #[inline(always)]
    pub(crate) fn is_met(&self) -> bool {
        self.front.simd_gt(self.back).any_true()
    }
}

/// What integrals along the parts of rays inside a cell need.
#[derive(Clone, Copy)]
pub(crate) struct Part<S: Simd> {
    /// The scalar in the middle, less the cell's lowest, and by how much it rises from there to the back end.
    pub(crate) scalar: S::f32s,
    pub(crate) rise: S::f32s,
    /// In device units; 0 where the ray misses the cell.
    pub(crate) length: S::f32s,
}

impl<S: Simd> Part<S> {
    /// Of no length.
    #[inline(always)]
    pub(crate) fn none(simd: S) -> Part<S> {
        let zero = S::f32s::splat(simd, 0.0);
        Part { scalar: zero, rise: zero, length: zero }
    }
}

/// The parts of rays inside a cell.
pub(crate) struct Segments<S: Simd> {
    pub(crate) part: Part<S>,
    /// The middle's depth from `z_ref` and half the extent in depth, both over `z_ref` in perspective.
    pub(crate) middle: S::f32s,
    pub(crate) half: S::f32s,
    /// Any scalar in the middle is so much of what it is on the cell's lean less so much of its `along`.
    pub(crate) shares: [S::f32s; 2],
    /// 1 + w on the lean.
    pub(crate) tilt: S::f32s,
}

/// Where the rays of a block's pixels end, if anything in the volume ends rays.
#[derive(Clone, Copy)]
pub(crate) struct Ends<S: Simd> {
    /// Depths from the mesh's origin.
    pub(crate) levels: S::f32s,
    /// Depth of the origin.
    pub(crate) origin: f32,
}

/// Where the rays through some pixels, counted from the middle of its box, enter a cell and leave it. `ends` is where
/// they end.
#[inline(always)]
pub(crate) fn crossing<S: Simd, const ORTHOGRAPHIC: bool>(
    simd: S,
    record: &Record,
    (x, y): (S::f32s, S::f32s),
    ends: Option<Ends<S>>,
) -> Crossing<S> {
    let p = linear(simd, record.planes[0], x, y);
    let q = linear(simd, record.planes[1], x, y);
    let r = linear(simd, record.planes[2], x, y);
    let s = linear(simd, record.planes[3], x, y);
    // Without branches, which no processor could foretell.
    let [[back_q, front_q], [back_r, front_r]] = SIDES[record.fronts as usize % SIDES.len()];
    let lean = linear(simd, record.lean, x, y);
    let nearest = S::f32s::splat(simd, record.nearest) - lean;
    let mut front = p.min(nearest).min((q + front_q).min(r + front_r));
    let mut back = s.max(-lean).max((q + back_q).max(r + back_r));
    if record.fronts == 0 {
        (front, back) = (nearest, back.max(p));
    } else if record.fronts == 4 {
        (front, back) = (front.min(s), -lean);
    }
    if let Some(Ends { levels, origin }) = ends {
        let before = S::f32s::splat(simd, record.level) - levels;
        back = back.max(if ORTHOGRAPHIC { before } else { before / (levels + origin) } - lean);
    }
    Crossing { front, back, lean }
}

/// The segments of rays that enter a cell and leave it there ([`crossing`]); `stretch` is the rays' length for a depth
/// of 1.
#[inline(always)]
pub(crate) fn segments<S: Simd, const ORTHOGRAPHIC: bool>(
    simd: S,
    record: &Record,
    (x, y): (S::f32s, S::f32s),
    stretch: S::f32s,
    Crossing { front, back, lean }: Crossing<S>,
) -> Segments<S> {
    // Where the ray misses the cell too, both between the farthest vertex and the nearest.
    let back = back.min(S::f32s::splat(simd, record.nearest) - lean);
    let front = front.max(back);
    let extent = front - back;
    let (scalar, tilt) = (linear(simd, record.scalar, x, y), lean + 1.0);
    // In perspective all over z_ref, the gradient times it.
    let (middle, half, gradient, shares) = if ORTHOGRAPHIC {
        let middle = (front + back) * 0.5;
        let whole = S::f32s::splat(simd, 1.0);
        (lean + middle, extent * 0.5, S::f32s::splat(simd, record.along), [whole, middle])
    } else {
        let (enter, leave) = (front + tilt, back + tilt);
        let half = S::f32s::splat(simd, 0.5) / (enter * leave);
        let shares = [(enter + leave) * half, front.mul_add(leave, back * enter) * half];
        let (near, far) = (front + lean, back + lean);
        ((near * far).mul_add(2.0, near + far) * half, extent * half, tilt.mul_add(record.along, scalar), shares)
    };
    // Both ends between the cell's lowest scalar and its highest.
    let rise = gradient * half;
    let scalar = shares[1].mul_add(-record.along, shares[0] * scalar).max(0.0).min(record.range);
    let limit = scalar.min(S::f32s::splat(simd, record.range) - scalar);
    let length = half * stretch * if ORTHOGRAPHIC { 2.0 } else { 2.0 * record.depth };
    let part = Part { scalar, rise: rise.min(limit).max(-limit), length };
    Segments { part, middle, half, shares, tilt }
}

impl<S: Simd> Segments<S> {
    /// Depths of the middles from the mesh's origin.
    #[inline(always)]
    pub(crate) fn depth<const ORTHOGRAPHIC: bool>(&self, simd: S, record: &Record) -> S::f32s {
        let scale = if ORTHOGRAPHIC { 1.0 } else { record.depth };
        S::f32s::splat(simd, record.level) - self.middle * scale
    }
}
