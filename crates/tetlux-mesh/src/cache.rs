//! Assembled meshes as bytes, to be stored and read back faster than they were made.
//!
//! A cache is trusted only if magic, schema version and byte order are this program's, the key is the one asked for and
//! the hash of its content holds; whatever does not match is a reason to make the mesh anew, never an error.

use glam::{DVec3, Vec3};

use crate::{Assembly, Field, Location, TetMesh};

const MAGIC: [u8; 8] = *b"tetlux-m";

/// Raised whenever the content or its meaning changes.
const SCHEMA: u32 = 1;

/// Written as a number: read back as another where the byte order differs.
const BYTE_ORDER: u32 = 0x0102_0304;

/// Bytes before the content: magic, schema, byte order, hash of the content.
const PREAMBLE: usize = 8 + 4 + 4 + 32;

/// What a mesh was made of: a cache is used only for the same.
#[derive(Debug, Clone, PartialEq, Eq, bincode::Encode, bincode::Decode)]
pub struct CacheKey {
    /// Path of the file.
    pub path: String,
    /// Its size in bytes.
    pub size: u64,
    /// Hash of its content, and of every other file that belongs to it.
    pub hash: [u8; 32],
    /// Whatever else the mesh depends on, as the split of hexahedra.
    pub options: String,
}

/// Why a cache is not used.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum CacheMiss {
    /// Not a cache of tetlux, or one of a machine of the other byte order.
    #[error("it is no mesh cache of this machine")]
    Foreign,
    /// Of another version of tetlux.
    #[error("it was written by another version")]
    Schema,
    /// Made of another file, or of this file before it changed, or with other options.
    #[error("its source or options have changed")]
    Key,
    /// Cut short or changed.
    #[error("it is damaged")]
    Damaged,
}

/// What precedes the arrays.
#[derive(bincode::Encode, bincode::Decode)]
struct Header {
    key: CacheKey,
    origin: [f64; 3],
    assembly: [u64; 9],
    points: u64,
    cells: u64,
    fields: Vec<StoredField>,
}

#[derive(bincode::Encode, bincode::Decode)]
struct StoredField {
    name: String,
    at_points: bool,
    components: u64,
}

/// Headers are no longer than this, so a damaged length in one asks for no more.
const LONGEST_HEADER: usize = 1 << 20;

fn config() -> impl bincode::config::Config {
    bincode::config::standard().with_fixed_int_encoding().with_limit::<LONGEST_HEADER>()
}

impl TetMesh {
    /// The mesh as bytes; `None` if its fields' names are too long for a header.
    pub fn to_cache(&self, key: &CacheKey) -> Option<Vec<u8>> {
        let a = &self.assembly;
        let counts = [
            a.points_given,
            a.points_merged,
            a.merged_data_differ,
            a.cells_given,
            a.cells_repeated,
            a.cells_inverted,
            a.cells_flat,
            a.faces_non_manifold,
            a.faces_folded,
        ];
        let stored = |field: &Field| StoredField {
            name: field.name.clone(),
            at_points: field.location == Location::Point,
            components: field.components as u64,
        };
        let header = Header {
            key: key.clone(),
            origin: self.origin.to_array(),
            assembly: counts.map(|n| n as u64),
            points: self.points.len() as u64,
            cells: self.cells.len() as u64,
            fields: self.fields.iter().map(stored).collect(),
        };
        let header = bincode::encode_to_vec(header, config()).ok().filter(|h| h.len() < LONGEST_HEADER)?;
        let mut bytes = Vec::new();
        bytes.extend_from_slice(&MAGIC);
        bytes.extend_from_slice(&SCHEMA.to_ne_bytes());
        bytes.extend_from_slice(&BYTE_ORDER.to_ne_bytes());
        bytes.resize(PREAMBLE, 0);
        bytes.extend_from_slice(&header);
        bytes.extend_from_slice(bytemuck::cast_slice(&self.points));
        bytes.extend_from_slice(bytemuck::cast_slice(&self.cells));
        bytes.extend_from_slice(bytemuck::cast_slice(&self.neighbors));
        for field in &self.fields {
            bytes.extend_from_slice(bytemuck::cast_slice(&field.values));
        }
        let hash = blake3::hash(&bytes[PREAMBLE..]);
        bytes[PREAMBLE - 32..PREAMBLE].copy_from_slice(hash.as_bytes());
        Some(bytes)
    }

    /// The mesh that [`to_cache`](Self::to_cache) made `bytes` of.
    pub fn from_cache(bytes: &[u8], key: &CacheKey) -> Result<TetMesh, CacheMiss> {
        let number = |at: usize| bytes.get(at..at + 4).and_then(|b| b.try_into().ok()).map(u32::from_ne_bytes);
        if bytes.len() < PREAMBLE || bytes[..8] != MAGIC || number(12) != Some(BYTE_ORDER) {
            return Err(CacheMiss::Foreign);
        }
        if number(8) != Some(SCHEMA) {
            return Err(CacheMiss::Schema);
        }
        let (hash, content) = bytes[16..].split_at(32);
        if blake3::hash(content).as_bytes() != hash {
            return Err(CacheMiss::Damaged);
        }
        let (header, length): (Header, usize) =
            bincode::decode_from_slice(content, config()).map_err(|_| CacheMiss::Damaged)?;
        if header.key != *key {
            return Err(CacheMiss::Key);
        }
        header.mesh(&content[length..]).ok_or(CacheMiss::Damaged)
    }
}

impl Header {
    /// The mesh whose arrays these bytes are; `None` if they do not fit.
    fn mesh(self, mut arrays: &[u8]) -> Option<TetMesh> {
        let (points, cells) = (usize::try_from(self.points).ok()?, usize::try_from(self.cells).ok()?);
        let point_data: Vec<Vec3> = take(&mut arrays, points)?;
        let cell_data: Vec<[u32; 4]> = take(&mut arrays, cells)?;
        let neighbors: Vec<[u32; 4]> = take(&mut arrays, cells)?;
        let mut fields = Vec::with_capacity(self.fields.len());
        for field in self.fields {
            let (location, tuples) = if field.at_points { (Location::Point, points) } else { (Location::Cell, cells) };
            let components = usize::try_from(field.components).ok().filter(|&n| n > 0)?;
            let values = take(&mut arrays, tuples.checked_mul(components)?)?;
            fields.push(Field { name: field.name, location, components, values });
        }
        let [given, merged, differ, cells_given, repeated, inverted, flat, non_manifold, folded] =
            self.assembly.map(|n| n as usize);
        let assembly = Assembly {
            points_given: given,
            points_merged: merged,
            merged_data_differ: differ,
            cells_given,
            cells_repeated: repeated,
            cells_inverted: inverted,
            cells_flat: flat,
            faces_non_manifold: non_manifold,
            faces_folded: folded,
        };
        let origin = DVec3::from(self.origin);
        let mesh = TetMesh { origin, points: point_data, cells: cell_data, neighbors, fields, assembly };
        arrays.is_empty().then_some(mesh)
    }
}

/// The first `count` numbers of some bytes, which are then advanced; `None` if there are not so many.
fn take<T: bytemuck::Pod>(bytes: &mut &[u8], count: usize) -> Option<Vec<T>> {
    let (first, rest) = bytes.split_at_checked(count.checked_mul(size_of::<T>())?)?;
    *bytes = rest;
    Some(bytemuck::allocation::pod_collect_to_vec(first))
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::procedural::{self, Split};

    fn mesh() -> TetMesh {
        let parts = procedural::sphere_shell([7, 4, 2], Split::Six, DVec3::splat(1e6), [1.0, 2.0]);
        let radius = parts.sample(|p| p.length());
        let cells = parts.cells.len();
        let fields = vec![
            Field::point("radius", 1, radius),
            Field::cell("number", 2, (0..2 * cells).map(|i| if i == 3 { f64::NAN } else { i as f64 }).collect()),
        ];
        TetMesh::assemble(&parts.points, &parts.cells, fields).unwrap()
    }

    fn key() -> CacheKey {
        CacheKey { path: "shell.vtu".into(), size: 17, hash: [7; 32], options: "split 6".into() }
    }

    #[test]
    fn a_mesh_comes_back_bit_for_bit() {
        let mesh = mesh();
        let back = TetMesh::from_cache(&mesh.to_cache(&key()).unwrap(), &key()).unwrap();
        assert_eq!((back.origin, &back.points, &back.cells), (mesh.origin, &mesh.points, &mesh.cells));
        assert_eq!((&back.neighbors, back.assembly), (&mesh.neighbors, mesh.assembly));
        let bits = |m: &TetMesh| -> Vec<Vec<u64>> {
            m.fields.iter().map(|f| f.values.iter().map(|v| v.to_bits()).collect()).collect()
        };
        assert_eq!(bits(&back), bits(&mesh));
        assert_eq!(back.fields[1].name, "number");
    }

    #[test]
    fn each_mismatch_has_its_reason() {
        let bytes = mesh().to_cache(&key()).unwrap();
        let miss = |bytes: &[u8], key: &CacheKey| TetMesh::from_cache(bytes, key).unwrap_err();
        let changed = |at: usize| {
            let mut bytes = bytes.clone();
            bytes[at] ^= 1;
            bytes
        };
        assert_eq!(miss(&changed(0), &key()), CacheMiss::Foreign);
        assert_eq!(miss(&changed(8), &key()), CacheMiss::Schema);
        assert_eq!(miss(&changed(12), &key()), CacheMiss::Foreign);
        assert_eq!(miss(&changed(20), &key()), CacheMiss::Damaged);
        assert_eq!(miss(&changed(bytes.len() - 1), &key()), CacheMiss::Damaged);
        assert_eq!(miss(&bytes[..bytes.len() - 1], &key()), CacheMiss::Damaged);
        assert_eq!(miss(&[], &key()), CacheMiss::Foreign);
        for other in [
            CacheKey { path: "other.vtu".into(), ..key() },
            CacheKey { size: 18, ..key() },
            CacheKey { hash: [8; 32], ..key() },
            CacheKey { options: "split 5".into(), ..key() },
        ] {
            assert_eq!(miss(&bytes, &other), CacheMiss::Key);
        }
    }

    proptest! {
        /// Content whose hash holds but whose parts do not fit: as a fault of ours would write it.
        #[test]
        fn nothing_that_does_not_fit_is_taken(at in any::<proptest::sample::Index>(), to in any::<u8>()) {
            let mut bytes = mesh().to_cache(&key()).unwrap();
            let at = PREAMBLE + at.index(bytes.len() - PREAMBLE);
            bytes[at] = to;
            let hash = blake3::hash(&bytes[PREAMBLE..]);
            bytes[PREAMBLE - 32..PREAMBLE].copy_from_slice(hash.as_bytes());
            // Any mesh that is given has parts that fit; a panic would fail the test.
            if let Ok(mesh) = TetMesh::from_cache(&bytes, &key()) {
                prop_assert_eq!(mesh.cells.len(), mesh.neighbors.len());
            }
        }
    }
}
