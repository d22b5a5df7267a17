//! Assembled meshes as bytes, to be stored and read back faster than they were made.
//!
//! Before the arrays stand magic, schema version, byte order, and a header of its own hash that says what the mesh was
//! made of; after them their checksum. Both ways the arrays pass straight between mesh and file, once. Whatever does not
//! match is a reason to make the mesh anew, never an error.

use std::io::{self, Read, Write};

use bytemuck::Pod;
use glam::{DVec3, Vec3};
use twox_hash::XxHash3_128;

use crate::{Assembly, Field, Location, NONE, TetMesh};

const MAGIC: [u8; 8] = *b"tetlux-m";

/// Raised whenever the layout or its meaning changes.
const SCHEMA: u32 = 3;

/// Written as a number: read back as another where the byte order differs.
const BYTE_ORDER: u32 = 0x0102_0304;

/// Bytes before the header: magic, schema, byte order, length of the header, hash of the header.
const PREAMBLE: usize = 8 + 4 + 4 + 8 + HASH;

/// Bytes of a hash, and of the arrays' checksum (XXH3): damage is to be told from none, and that in less time than
/// reading takes.
const HASH: usize = 32;
const CHECKSUM: usize = 16;

/// Headers are no longer than this, so a damaged length asks for no more.
const LONGEST_HEADER: usize = 1 << 20;

/// Bytes read and hashed at a time: they stay in the processor's cache between the two.
const CHUNK: usize = 256 << 10;

/// What a mesh was made of, and what was said of it then.
#[derive(Debug, Clone, Default, PartialEq, Eq, bincode::Encode, bincode::Decode)]
pub struct Origin {
    /// The program and version that made it.
    pub maker: String,
    /// Whatever else than the files it depends on, as the split of hexahedra.
    pub options: String,
    /// Every file that was read, the one that was named first.
    pub sources: Vec<SourceFile>,
    /// Cells of each type in the files.
    pub cell_counts: Vec<(String, u64)>,
    /// What was passed over, a sentence each.
    pub notes: Vec<String>,
}

/// A file that a mesh was made of.
#[derive(Debug, Clone, PartialEq, Eq, bincode::Encode, bincode::Decode)]
pub struct SourceFile {
    /// Absolute path.
    pub path: String,
    /// Size in bytes.
    pub size: u64,
    /// What the file system says of its last change; all zero where that cannot be relied on.
    pub stamp: [i64; 6],
    /// BLAKE3 hash of its content.
    pub hash: [u8; HASH],
}

/// Why stored bytes are not used.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum CacheMiss {
    /// Not a cache of tetlux, or one of a machine of the other byte order.
    #[error("it is no mesh cache of this machine")]
    Foreign,
    /// Of another version of the layout.
    #[error("it was written by another version")]
    Schema,
    /// Cut short, changed, or not to be read.
    #[error("it is damaged")]
    Damaged,
}

/// What precedes the arrays.
#[derive(Debug, bincode::Encode, bincode::Decode)]
struct Header {
    origin: Origin,
    center: [f64; 3],
    assembly: [u64; 9],
    points: u64,
    cells: u64,
    fields: Vec<StoredField>,
}

#[derive(Debug, bincode::Encode, bincode::Decode)]
struct StoredField {
    name: String,
    at_points: bool,
    components: u64,
}

fn config() -> impl bincode::config::Config {
    bincode::config::standard().with_fixed_int_encoding().with_limit::<LONGEST_HEADER>()
}

impl Origin {
    /// A hash of all but the stamps: what depends on the mesh alone can be stored under it.
    pub fn identity(&self) -> [u8; HASH] {
        let mut same = self.clone();
        same.sources.iter_mut().for_each(|source| source.stamp = Default::default());
        let unlimited = bincode::config::standard().with_fixed_int_encoding();
        // Plain data: encoding into memory cannot fail, and if it did the hash would be that of nothing.
        *blake3::hash(&bincode::encode_to_vec(same, unlimited).unwrap_or_default()).as_bytes()
    }
}

impl TetMesh {
    /// Writes the mesh and what it was made of.
    ///
    /// # Errors
    /// Those of the writer, and [`io::ErrorKind::InvalidInput`] if names and notes together are longer than 1 MiB.
    pub fn write_cache(&self, origin: &Origin, to: &mut dyn Write) -> io::Result<()> {
        let header = bincode::encode_to_vec(self.header(origin), config()).ok().filter(|h| h.len() <= LONGEST_HEADER);
        let header = header.ok_or_else(|| {
            io::Error::new(io::ErrorKind::InvalidInput, "the names and notes of the mesh are longer than 1 MiB")
        })?;
        to.write_all(&MAGIC)?;
        to.write_all(&SCHEMA.to_ne_bytes())?;
        to.write_all(&BYTE_ORDER.to_ne_bytes())?;
        to.write_all(&(header.len() as u64).to_ne_bytes())?;
        to.write_all(blake3::hash(&header).as_bytes())?;
        to.write_all(&header)?;
        let mut checksum = XxHash3_128::new();
        let mut put = |bytes: &[u8]| {
            bytes.chunks(CHUNK).try_for_each(|chunk| {
                checksum.write(chunk);
                to.write_all(chunk)
            })
        };
        put(bytemuck::cast_slice(&self.points))?;
        put(bytemuck::cast_slice(&self.cells))?;
        put(bytemuck::cast_slice(&self.neighbors))?;
        self.fields.iter().try_for_each(|field| put(bytemuck::cast_slice(&field.values)))?;
        to.write_all(&checksum.finish_128().to_ne_bytes())
    }

    fn header(&self, origin: &Origin) -> Header {
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
        Header {
            origin: origin.clone(),
            center: self.origin.to_array(),
            assembly: counts.map(|n| n as u64),
            points: self.points.len() as u64,
            cells: self.cells.len() as u64,
            fields: self.fields.iter().map(stored).collect(),
        }
    }
}

/// A stored mesh of which the header has been read.
#[derive(Debug)]
pub struct CacheReader<R> {
    from: R,
    header: Header,
    /// Bytes up to the arrays.
    start: u64,
}

impl<R: Read> CacheReader<R> {
    /// Reads what precedes the arrays.
    ///
    /// # Errors
    /// [`CacheMiss`], if it is not this version's or its hash does not hold.
    pub fn new(mut from: R) -> Result<Self, CacheMiss> {
        let mut preamble = [0; PREAMBLE];
        from.read_exact(&mut preamble).map_err(|_| CacheMiss::Foreign)?;
        let number = |at: usize| u32::from_ne_bytes([0, 1, 2, 3].map(|i| preamble[at + i]));
        if preamble[..8] != MAGIC || number(12) != BYTE_ORDER {
            return Err(CacheMiss::Foreign);
        }
        if number(8) != SCHEMA {
            return Err(CacheMiss::Schema);
        }
        let length = u64::from_ne_bytes([0, 1, 2, 3, 4, 5, 6, 7].map(|i| preamble[16 + i]));
        if length > LONGEST_HEADER as u64 {
            return Err(CacheMiss::Damaged);
        }
        let mut header = vec![0; length as usize];
        from.read_exact(&mut header).map_err(|_| CacheMiss::Damaged)?;
        if blake3::hash(&header).as_bytes()[..] != preamble[PREAMBLE - HASH..] {
            return Err(CacheMiss::Damaged);
        }
        let (header, read): (Header, usize) =
            bincode::decode_from_slice(&header, config()).map_err(|_| CacheMiss::Damaged)?;
        let whole = read as u64 == length;
        whole.then_some(CacheReader { from, header, start: PREAMBLE as u64 + length }).ok_or(CacheMiss::Damaged)
    }

    /// What the mesh was made of.
    pub fn origin(&self) -> &Origin {
        &self.header.origin
    }

    /// Tetrahedra of the mesh.
    pub fn cells(&self) -> u64 {
        self.header.cells
    }

    /// Reads the mesh; `length` is that of all the stored bytes, and bounds what memory is asked for.
    ///
    /// # Errors
    /// [`CacheMiss::Damaged`], if lengths, hash or indices do not fit.
    pub fn mesh(self, length: u64) -> Result<TetMesh, CacheMiss> {
        let CacheReader { from, header, start } = self;
        let left = length.checked_sub(start + CHECKSUM as u64).ok_or(CacheMiss::Damaged)?;
        let mut arrays = Arrays { from, left, checksum: XxHash3_128::new() };
        header.mesh(&mut arrays).filter(|_| arrays.end()).ok_or(CacheMiss::Damaged)
    }
}

/// The arrays of a stored mesh, one after another.
struct Arrays<R> {
    from: R,
    /// Bytes of arrays that are still to come.
    left: u64,
    checksum: XxHash3_128,
}

impl<R: Read> Arrays<R> {
    /// The next `count` items; `None` if there are not so many. Each part is looked at while it is near at hand.
    fn take<T: Pod>(&mut self, count: usize, mut look: impl FnMut(&[T])) -> Option<Vec<T>> {
        let bytes = (count as u64).checked_mul(size_of::<T>() as u64)?;
        self.left = self.left.checked_sub(bytes)?;
        let mut items: Vec<T> = bytemuck::allocation::try_zeroed_vec(count).ok()?;
        for part in items.chunks_mut(CHUNK / size_of::<T>()) {
            let bytes = bytemuck::cast_slice_mut(part);
            self.from.read_exact(bytes).ok()?;
            self.checksum.write(bytes);
            look(part);
        }
        Some(items)
    }

    /// The next `count` cells of indices, of which each must be below `limit` once `bias` is added.
    fn indices(&mut self, count: usize, limit: usize, bias: u32) -> Option<Vec<[u32; 4]>> {
        // Meshes have fewer than 2^31 of everything, so that the sign of a difference tells, for all at once.
        let limit = i32::try_from(limit).ok()? as u32;
        let mut signs = [0; 4];
        let cells = self.take(count, |cells: &[[u32; 4]]| {
            for cell in cells {
                let index = cell.map(|index| index.wrapping_add(bias));
                signs = [0, 1, 2, 3].map(|i| signs[i] | index[i] | limit.wrapping_sub(index[i]).wrapping_sub(1));
            }
        })?;
        signs.iter().all(|&sign| sign >> 31 == 0).then_some(cells)
    }

    /// Whether all was taken, and the checksum that follows is that of what was.
    fn end(&mut self) -> bool {
        let mut checksum = [0; CHECKSUM];
        let all = self.left == 0 && self.from.read_exact(&mut checksum).is_ok();
        all && self.checksum.finish_128().to_ne_bytes() == checksum
    }
}

impl Header {
    /// The mesh of these arrays; `None` if they do not fit.
    fn mesh<R: Read>(self, arrays: &mut Arrays<R>) -> Option<TetMesh> {
        let (points, cells) = (usize::try_from(self.points).ok()?, usize::try_from(self.cells).ok()?);
        let point_data: Vec<Vec3> = arrays.take(points, |_| ())?;
        let cell_data = arrays.indices(cells, points, 0)?;
        // With one added no neighbour is 0, and the others are from 1 on.
        let neighbors = arrays.indices(cells, cells + 1, NONE.wrapping_neg())?;
        let mut fields = Vec::with_capacity(self.fields.len());
        for field in self.fields {
            let (location, tuples) = if field.at_points { (Location::Point, points) } else { (Location::Cell, cells) };
            let components = usize::try_from(field.components).ok().filter(|&n| n > 0)?;
            let values = arrays.take(tuples.checked_mul(components)?, |_| ())?;
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
        let origin = DVec3::from(self.center);
        Some(TetMesh { origin, points: point_data, cells: cell_data, neighbors, fields, assembly })
    }
}

#[cfg(test)]
mod tests;
