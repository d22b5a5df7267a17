//! From a path to a mesh: which format a file has.

use std::path::{Path, PathBuf};

use tetlux_mesh::TetMesh;
use tetlux_mesh::procedural::Split;

use crate::cell_type::CellType;
use crate::source::Source;
use crate::{IngestError, MixedMesh, Place, plot3d, vtu};

/// What a path alone does not say.
#[derive(Debug, Clone, Default)]
pub struct ReadOptions {
    /// The solution (q) file that belongs to a PLOT3D grid; without it the grid has no fields.
    pub solution: Option<PathBuf>,
}

/// Extensions that PLOT3D grids commonly have; used only for the message where the content is at fault.
const PLOT3D_EXTENSIONS: [&str; 7] = ["xyz", "bin", "x", "p3d", "p3dbin", "g", "grd"];

/// Reads a file: its format is found out from its content, and from its extension only where that fails.
pub fn read(path: &Path, options: &ReadOptions) -> Result<MixedMesh, IngestError> {
    let source = Source::open(path)?;
    let extension = path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
    let mut mesh = if vtu::recognizes(&source.bytes) {
        if let Some(solution) = &options.solution {
            let remedy = "leave the solution out: only PLOT3D grids have one";
            return Err(source.malformed(Place::File, "a solution for a VTU file", solution.display(), remedy));
        }
        vtu::read(source)?
    } else if plot3d::recognizes(&source.bytes)
        || options.solution.is_some()
        || PLOT3D_EXTENSIONS.contains(&extension.as_str())
    {
        plot3d::read(source, options.solution.as_deref())?
    } else if extension == "vtu" {
        vtu::read(source)?
    } else {
        let start = &source.bytes[..source.bytes.len().min(24)];
        let found = format!("\"{}\"", start.escape_ascii());
        return Err(IngestError::UnknownFormat { path: path.into(), found });
    };
    mesh.check()?;
    note_cells(&mut mesh);
    Ok(mesh)
}

/// Reads a file and makes tetrahedra of its cells: [`read`] and [`MixedMesh::tetrahedralize`].
pub fn read_tet_mesh(path: &Path, options: &ReadOptions, split: Split) -> Result<TetMesh, IngestError> {
    read(path, options)?.tetrahedralize(split)
}

/// Notes of the cells that are left out, and of points that are.
fn note_cells(mesh: &mut MixedMesh) {
    let kinds = || mesh.cells.types.iter().map(|&t| CellType::of(t));
    let flat = kinds().flatten().filter(|kind| kind.dimension < 3).count();
    let more = |(c, kind): &(usize, Option<&CellType>)| {
        let points = mesh.cells.cell(*c).unwrap_or_default().len();
        kind.and_then(|k| k.points).is_some_and(|n| points > n)
    };
    let long = kinds().enumerate().filter(more).count();
    if flat > 0 {
        mesh.notes.push(format!("cells of points, lines or surfaces, without volume: {flat}, left out"));
    }
    if long > 0 {
        mesh.notes.push(format!("cells with more points than their type has: {long}, of which the first points count"));
    }
}
