//! Facts as bytes, to be stored beside the mesh they are of.

use std::sync::OnceLock;

use bytemuck::{Pod, Zeroable, bytes_of, cast_slice, pod_read_unaligned};
use tetlux_mesh::{NONE, TetMesh};

use super::{Facts, Known, LANES, Planes, fresh_id};

const MAGIC: [u8; 8] = *b"tetlux-o";

/// Raised whenever the content or its meaning changes.
const SCHEMA: u64 = 1;

/// What precedes the arrays. The schema is stored as a number: another where the byte order differs.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
struct Header {
    magic: [u8; 8],
    schema: u64,
    points: u64,
    cells: u64,
    faces: u64,
    interior: u64,
    components: u64,
    quads_split_both_ways: u64,
    folded_faces: u64,
    non_manifold_faces: u64,
    convex: u64,
    /// Bits of the largest coordinate.
    reach: u64,
}

impl Facts {
    /// The facts as bytes, for [`from_bytes`](Self::from_bytes).
    pub fn to_bytes(&self) -> Vec<u8> {
        let header = Header {
            magic: MAGIC,
            schema: SCHEMA,
            points: self.points as u64,
            cells: self.faces.len() as u64,
            faces: self.owners.len() as u64,
            interior: self.interior as u64,
            components: self.known.components as u64,
            quads_split_both_ways: self.known.quads_split_both_ways as u64,
            folded_faces: self.known.folded_faces as u64,
            non_manifold_faces: self.known.non_manifold_faces as u64,
            convex: u64::from(self.known.convex),
            reach: u64::from(self.reach.to_bits()),
        };
        let mut bytes = Vec::with_capacity(size_of::<Header>() + self.bytes());
        bytes.extend_from_slice(bytes_of(&header));
        bytes.extend_from_slice(cast_slice(&self.planes));
        bytes.extend_from_slice(cast_slice(&self.owners));
        bytes.extend_from_slice(cast_slice(&self.faces));
        bytes
    }

    /// The facts of `mesh` read back; `None` if these are not the bytes of facts, or are of another mesh.
    ///
    /// Counts, faces and neighbours are checked against the mesh; planes are trusted. Whoever stores the bytes binds
    /// them to the mesh's content.
    pub fn from_bytes(bytes: &[u8], mesh: &TetMesh) -> Option<Facts> {
        let (header, rest) = bytes.split_at_checked(size_of::<Header>())?;
        let header: Header = pod_read_unaligned(header);
        let count = |n: u64| usize::try_from(n).ok();
        let (cells, faces, interior) = (count(header.cells)?, count(header.faces)?, count(header.interior)?);
        let boundary = faces.checked_sub(interior)?;
        let matches = header.magic == MAGIC
            && header.schema == SCHEMA
            && header.points == mesh.points().len() as u64
            && cells == mesh.cells().len()
            && interior.checked_mul(2)?.checked_add(boundary)? == 4 * cells;
        if !matches {
            return None;
        }
        let (planes, rest) = rest.split_at_checked(faces.div_ceil(LANES) * size_of::<Planes>())?;
        let (owners, rest) = rest.split_at_checked(faces * size_of::<u32>())?;
        let facts = Facts {
            id: fresh_id(),
            points: count(header.points)?,
            interior,
            planes: copied(planes)?,
            owners: copied(owners)?,
            faces: copied::<[u32; 4]>(rest).filter(|f| f.len() == cells)?,
            reach: f32::from_bits(u32::try_from(header.reach).ok()?),
            known: Known {
                components: count(header.components)?,
                quads_split_both_ways: count(header.quads_split_both_ways)?,
                folded_faces: count(header.folded_faces)?,
                non_manifold_faces: count(header.non_manifold_faces)?,
                convex: header.convex == 1,
            },
            surface: OnceLock::new(),
            steps: OnceLock::new(),
            spheres: OnceLock::new(),
        };
        facts.fit(mesh).then_some(facts)
    }

    /// Whether every face is where it belongs.
    fn fit(&self, mesh: &TetMesh) -> bool {
        let owned = |face: usize, cell: usize, place: usize| self.owners[face] == (cell as u32) << 2 | place as u32;
        mesh.neighbors().iter().zip(&self.faces).enumerate().all(|(c, (around, faces))| {
            (0..4).all(|f| {
                let (face, far_side) = ((faces[f] >> 1) as usize, faces[f] & 1 == 1);
                let outer = around[f] == NONE;
                face < self.owners.len()
                    && outer == (face >= self.interior)
                    && if far_side {
                        !outer && self.owners[face] >> 2 == around[f] && around[f] < c as u32
                    } else {
                        owned(face, c, f)
                    }
            })
        })
    }
}

/// A copy, aligned as its type needs; `None` if the bytes are not a whole number of values.
fn copied<T: Pod>(bytes: &[u8]) -> Option<Vec<T>> {
    if !bytes.len().is_multiple_of(size_of::<T>()) {
        return None;
    }
    let mut values = vec![T::zeroed(); bytes.len() / size_of::<T>()];
    bytemuck::cast_slice_mut(&mut values).copy_from_slice(bytes);
    Some(values)
}
