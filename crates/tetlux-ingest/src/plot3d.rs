//! PLOT3D: structured grids of one block or several, and their solutions and function files.
//!
//! A grid holds three 32-bit dimensions for each block, then of each block all x, all y and all z, i fastest, then
//! perhaps an integer "iblank" for each point, 0 where the point is blanked. The solution (q) file holds the same
//! dimensions, then of each block four numbers of the flow (Mach number, angle of attack, Reynolds number, time),
//! density, the three components of momentum and the stagnation energy; a function file has a number of variables after
//! each block's dimensions, then these (Walatka, Buning, Pierce and Elson, PLOT3D User's Manual, NASA TM-101067, 1990).
//! All are written in text, as C does, or in Fortran's records, and in either byte order and precision; which it is, is
//! found out from the dimensions and the length ([`layout`]).

mod layout;
mod solution;
#[cfg(test)]
mod tests;
mod values;

use std::path::Path;

use glam::DVec3;
use layout::{Candidates, Contents, Encoding, Layout, candidates};
use values::Values;

use crate::source::{Files, Source, numbers};
use crate::{IngestError, MixedMesh, Place, StructuredGrid};

const REMEDY: &str =
    "read are whole 3-D grids of one block or several, in text, C binary or Fortran records: write it so";
/// Files from tapes are filled with zeros to blocks of this many bytes.
const TAPE: u64 = 512;

/// A layout chosen for a file.
struct Choice {
    layout: Layout,
    /// Bytes after the data.
    rest: u64,
}

/// Whether these bytes have just the length that their dimensions, read in some way, ask for.
pub(crate) fn recognizes(bytes: &[u8]) -> bool {
    grid_choice(bytes, &candidates(bytes, Contents::Grid)).is_some()
        || !candidates(bytes, Contents::PlaneGrid).exact.is_empty()
}

/// The likeliest layout: of just the length, or with bytes after Fortran's records, or with zeros
/// that fill a block of a tape.
fn grid_choice(bytes: &[u8], found: &Candidates) -> Option<Choice> {
    let rest = |layout: &Layout| layout.length(found.lengths) - layout.end;
    let padded = |layout: &&Layout| match layout.encoding {
        Encoding::Text => false,
        Encoding::Binary { records: true, .. } => true,
        Encoding::Binary { records: false, .. } => {
            found.lengths.0.is_multiple_of(TAPE)
                && rest(layout) < TAPE
                // The layout ends before the file does.
                && bytes[layout.end as usize..].iter().all(|&byte| byte == 0)
        }
    };
    let layout = found.exact.first().or_else(|| found.shorter.iter().find(padded))?;
    Some(Choice { rest: rest(layout), layout: layout.clone() })
}

/// Reads a grid and, if it is given, its solution or function file.
pub(crate) fn read(source: Source, solution: Option<&Path>, files: &mut Files) -> Result<MixedMesh, IngestError> {
    let found = candidates(&source.bytes, Contents::Grid);
    let Some(Choice { layout, rest }) = grid_choice(&source.bytes, &found) else {
        return Err(no_grid(&source, &found));
    };
    let mut mesh = MixedMesh { path: source.path.clone(), ..MixedMesh::default() };
    if let [_, other, ..] = found.exact.as_slice() {
        mesh.notes.push(format!("the file is read as {layout}; it could also be {other}"));
    }
    drop(found);
    if rest > 0 {
        mesh.notes.push(format!("the last {rest} bytes are no data of the grid"));
    }
    mesh.points = vec![DVec3::ZERO; layout.points()];
    let mut values = Values::new(&source, &layout);
    let mut first = 0;
    for block in &layout.blocks {
        let points = &mut mesh.points[first..first + block.points()];
        values.skip_to(block.start);
        for axis in 0..3 {
            values.reals(points.len(), |p, value| points[p][axis] = value)?;
        }
        let blanked = if layout.iblank { Some(values.zeros(points.len())?) } else { None };
        let counts = block.counts.map(|n| n as usize);
        mesh.grids.push(StructuredGrid { first_point: first, counts, blanked });
        first += points.len();
    }
    drop(source);
    note_blanked(&mut mesh);
    if let Some(path) = solution {
        solution::add(&mut mesh, &files.open(path)?, &layout)?;
    }
    Ok(mesh)
}

fn note_blanked(mesh: &mut MixedMesh) {
    let visible: usize = mesh.cell_counts().iter().map(|&(_, count)| count).sum();
    let blanked = mesh.cell_tuples() - visible;
    if blanked > 0 {
        mesh.notes.push(format!("{blanked} hexahedra have a blanked corner (iblank 0): they are left out"));
    }
}

/// Why a file is no grid: a plane's, a solution, or of no length that its dimensions ask for.
fn no_grid(source: &Source, found: &Candidates) -> IngestError {
    if let Some(plane) = candidates(&source.bytes, Contents::PlaneGrid).exact.first() {
        let remedy = "only 3-D grids have cells with volume";
        return source.unsupported(Place::File, "a 2-D PLOT3D grid:", &plane.to_string(), remedy);
    }
    if let Some(solution) = candidates(&source.bytes, Contents::Solution).exact.first() {
        let remedy = "name the file with the coordinates, and this one as its solution";
        return source.malformed(Place::File, "a PLOT3D solution where a grid is needed", solution, remedy);
    }
    misfit(source, "grid", found)
}

/// Why a file has no layout: too short even for the dimensions, dimensions that make no sense, or a length that is not theirs.
fn misfit(source: &Source, contents: &str, found: &Candidates) -> IngestError {
    if let Err(truncated) = source.section(&format!("the dimensions of a PLOT3D {contents}"), 0, 3, 4) {
        return truncated;
    }
    // Read wrongly, small dimensions become huge: the fewest points are likeliest meant.
    let likely = found.shorter.iter().chain(&found.longer).min_by_key(|layout| layout.points());
    let Some(likely) = likely else {
        let orders = [crate::source::ByteOrder::Little, crate::source::ByteOrder::Big];
        let dimensions = orders.map(|order| {
            let numbers: Vec<String> = numbers!(i32, source.bytes[..12], order, |v: i32| v.to_string());
            numbers.join(" x ")
        });
        let what = format!("the dimensions of a PLOT3D {contents} (little-endian, or big-endian)");
        return source.malformed(Place::Byte(0), what, dimensions.join(", or "), REMEDY);
    };
    let alike = |layout: &&Layout| layout.encoding == likely.encoding && layout.multiple == likely.multiple;
    let mut ends: Vec<u64> = found.shorter.iter().chain(&found.longer).filter(alike).map(|l| l.end).collect();
    ends.sort_unstable();
    let length = likely.length(found.lengths);
    let text = likely.encoding == Encoding::Text;
    if length < ends[0] && !text {
        let what = format!("a PLOT3D {contents} of {likely}");
        return IngestError::Truncated { path: source.path.clone(), what, offset: 0, needed: ends[0], found: length };
    }
    let unit = if text { "numbers" } else { "bytes" };
    let ends: Vec<String> = ends.iter().map(u64::to_string).collect();
    let what = format!("a PLOT3D {contents} of {likely} (or otherwise) has {} {unit}", ends.join(" or "));
    source.malformed(Place::File, what, format!("{length} {unit}"), REMEDY)
}
