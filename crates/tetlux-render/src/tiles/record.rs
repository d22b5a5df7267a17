//! A cell as the tiles need it, in single precision.
//!
//! Along the ray through a pixel the inverse depth at which a face's plane is met is linear in the pixel's position;
//! in orthographic views the depth itself is. With the depth `z_ref` of the cell's farthest vertex,
//!
//! ```text
//! w = z_ref / z - 1   (perspective)        w = z_ref - z   (orthographic)
//! ```
//!
//! is 0 at that vertex, grows towards the eye, and is small for small cells, so that they keep their thickness in single
//! precision. The ray is inside between the least w of the front faces and the greatest of the back faces.
//!
//! Of a thin cell seen aslant that is a small difference of large w. There w is counted from a plane that the cell lies
//! along, its `lean`, and so is the scalar s, both found in double precision. With the depth d = w - lean beyond it,
//!
//! ```text
//! (1 + w) s = n - along d   (perspective)        s = n - along d   (orthographic)
//! ```
//!
//! where n, the left side on the plane, is linear in the pixel's position too.

use bytemuck::{Pod, Zeroable};

/// A cell ready to be drawn. Pixels are counted from the box's middle, where single precision misses by the least.
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C, align(128))]
pub(crate) struct Record {
    /// (dw/dx, dw/dy, w at the middle) of each face's plane less those of `lean`, front faces first.
    pub(crate) planes: [[f32; 3]; 4],
    /// The plane that a thin cell seen aslant lies along; w = 0 for any other.
    pub(crate) lean: [f32; 3],
    /// How many of the planes are front faces.
    pub(crate) fronts: u32,
    /// w of the nearest vertex, or of the near plane; that of the farthest vertex is 0.
    pub(crate) nearest: f32,
    /// The scalar less `base`, in perspective times 1 + w, on `lean`: (d/dx, d/dy, at the middle).
    pub(crate) scalar: [f32; 3],
    /// Perspective: the scalar's gradient along the ray times `z_ref` is `scalar` plus this times 1 + w, on `lean`.
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
    pub(crate) first: [u16; 2],
    pub(crate) end: [u16; 2],
    /// The pixel in the box's middle.
    pub(crate) middle: [f32; 2],
    /// The piece of the transfer function at the lowest scalar, and the last that the range reaches into.
    pub(crate) pieces: [u32; 2],
    unused: u32,
}

/// Numbers in a record.
pub(crate) const FLOATS: usize = size_of::<Record>() / size_of::<f32>();

const _: () = assert!(size_of::<Record>() == 128, "two cache lines");
const _: () = assert!(tetlux_image::MAX_SIDE <= u16::MAX as u32, "pixels are counted in 16 bits");

impl Record {
    /// All of it as numbers, in the order of its members, to be stored many at a time.
    #[inline(always)]
    pub(crate) fn floats_mut(&mut self) -> &mut [f32; FLOATS] {
        bytemuck::cast_mut(self)
    }

    /// Depth of the nearest vertex, or of the near plane, from the mesh's origin.
    #[inline(always)]
    pub(crate) fn nearest_level(&self, orthographic: bool) -> f32 {
        self.level - if orthographic { self.nearest } else { self.depth * self.nearest / (1.0 + self.nearest) }
    }

    /// Whether any pixel may see the cell.
    pub(crate) fn is_seen(&self) -> bool {
        self.first[0] < self.end[0]
    }
}

/// Cells that one core sets up at a time.
pub(crate) const CHUNK: usize = 64;

/// The records of some cells, and for each the first and one past the last tile of its box, in x and y.
#[derive(Clone, Debug)]
pub(crate) struct Chunk {
    pub(crate) records: [Record; CHUNK],
    pub(crate) tiles: [[u16; 4]; CHUNK],
}

impl Default for Chunk {
    fn default() -> Chunk {
        Chunk { records: [Record::default(); CHUNK], tiles: [[0; 4]; CHUNK] }
    }
}

/// The record at a position.
#[inline(always)]
pub(crate) fn at(chunks: &[Chunk], index: u32) -> &Record {
    &chunks[index as usize / CHUNK].records[index as usize % CHUNK]
}
