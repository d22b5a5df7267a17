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

/// The parts of rays inside a cell.
pub(crate) struct Segments<S: Simd> {
    /// Scalar at the front and at the back end, less the cell's lowest.
    pub(crate) front: S::f32s,
    pub(crate) back: S::f32s,
    /// In device units; 0 where the ray misses the cell.
    pub(crate) length: S::f32s,
    /// Depth of the middle from the mesh's origin.
    pub(crate) depth: S::f32s,
    /// The middle's depth from `z_ref` and the extent in depth, both over `z_ref` in perspective.
    pub(crate) middle: S::f32s,
    pub(crate) extent: S::f32s,
}

/// Where the rays of a block's pixels end, if anything in the volume ends rays.
#[derive(Clone, Copy)]
pub(crate) struct Ends<S: Simd> {
    /// Depths from the mesh's origin.
    pub(crate) levels: S::f32s,
    /// Depth of the origin.
    pub(crate) origin: f32,
}

/// The segments of the rays through some pixels, counted from the middle of the cell's box, `stretch` the rays' length for a depth
/// of 1, `ends` where they end; `None` if all miss the cell.
#[inline(always)]
pub(crate) fn segments<S: Simd, const ORTHOGRAPHIC: bool>(
    simd: S,
    record: &Record,
    (x, y): (S::f32s, S::f32s),
    stretch: S::f32s,
    ends: Option<Ends<S>>,
) -> Option<Segments<S>> {
    let p = linear(simd, record.planes[0], x, y);
    let q = linear(simd, record.planes[1], x, y);
    let r = linear(simd, record.planes[2], x, y);
    let s = linear(simd, record.planes[3], x, y);
    let mut front = S::f32s::splat(simd, record.nearest);
    let mut back = S::f32s::splat(simd, 0.0);
    match record.fronts {
        1 => {
            front = front.min(p);
            back = back.max(q).max(r.max(s));
        }
        2 => {
            front = front.min(p.min(q));
            back = back.max(r.max(s));
        }
        3 => {
            front = front.min(p).min(q.min(r));
            back = back.max(s);
        }
        0 => back = back.max(p).max(q).max(r.max(s)),
        _ => front = front.min(p).min(q).min(r.min(s)),
    }
    if let Some(Ends { levels, origin }) = ends {
        let before = S::f32s::splat(simd, record.level) - levels;
        back = back.max(if ORTHOGRAPHIC { before } else { before / (levels + origin) });
    }
    if !front.simd_gt(back).any_true() {
        return None;
    }
    // Where the ray misses the cell too, both between the farthest vertex and the nearest.
    let back = back.min(record.nearest);
    let front = front.max(back);
    let extent = front - back;
    let half = S::f32s::splat(simd, 0.5);
    let scalar = linear(simd, record.scalar, x, y);
    // The middle's depth from z_ref, the extent in depth, both over z_ref in perspective; the gradient likewise.
    let (middle, extent, gradient) = if ORTHOGRAPHIC {
        ((front + back) * half, extent, S::f32s::splat(simd, record.along))
    } else {
        let inverse = S::f32s::splat(simd, 1.0) / ((front + 1.0) * (back + 1.0));
        ((front + back).mul_add(half, front * back) * inverse, extent * inverse, scalar + record.along)
    };
    let rise = gradient * extent * half;
    let middle_scalar = scalar - gradient * middle;
    let scale = if ORTHOGRAPHIC { 1.0 } else { record.depth };
    Some(Segments {
        front: (middle_scalar - rise).max(0.0).min(record.range),
        back: (middle_scalar + rise).max(0.0).min(record.range),
        length: extent * stretch * scale,
        depth: S::f32s::splat(simd, record.level) - middle * scale,
        middle,
        extent,
    })
}
