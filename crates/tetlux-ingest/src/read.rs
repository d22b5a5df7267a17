//! From a path to a mesh: which format a file has.

use std::path::{Path, PathBuf};

use tetlux_mesh::TetMesh;
use tetlux_mesh::procedural::Split;

use crate::cell_type::{CellType, POLYHEDRON, QUADRATIC_PYRAMID};
use crate::source::Source;
use crate::tetrahedralize::{PYRAMID_WITH_BASE_POINT, faces_that_differ, is_quadratic};
use crate::{
    Expression, IngestError, MixedMesh, Place, exodus, gmsh, plot3d, stuffing, surface, tetgen, vtk_legacy, vtk_xml,
};

/// What a path alone does not say.
#[derive(Debug, Clone, Default)]
pub struct ReadOptions {
    /// The solution (q) file that belongs to a PLOT3D grid; without it the grid has no fields.
    pub solution: Option<PathBuf>,
    /// The time step of a file with several (Exodus II, Gmsh, VTK XML), numbered from 0; without it the last.
    pub time: Option<usize>,
    /// The size of the cells that fill a surface (OBJ, STL): see [`fill`](crate::fill). Without it a fortieth of the
    /// diagonal of the surface's box.
    pub cell_size: Option<f64>,
    /// Fields on the points of what fills a surface, by name, beside its distance.
    pub expressions: Vec<(String, Expression)>,
}

/// Extensions that PLOT3D grids commonly have; used only for the message where the content is at fault.
const PLOT3D_EXTENSIONS: [&str; 7] = ["xyz", "bin", "x", "p3d", "p3dbin", "g", "grd"];

/// Extensions of VTK XML files; likewise.
const VTK_XML_EXTENSIONS: [&str; 11] =
    ["vtu", "vts", "vtr", "vti", "pvtu", "pvts", "pvtr", "pvti", "vtm", "vtmb", "pvd"];

/// Reads a file: its format is found out from its content, and from its extension only where that fails.
pub fn read(path: &Path, options: &ReadOptions) -> Result<MixedMesh, IngestError> {
    let source = Source::open(path)?;
    let extension = path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
    let mut mesh = if vtk_xml::recognizes(&source.bytes) {
        refuse_solution(&source, options)?;
        vtk_xml::read(source, options.time)?
    } else if vtk_legacy::recognizes(&source.bytes) {
        vtk_legacy::read(source)?
    } else if gmsh::recognizes(&source.bytes) {
        gmsh::read(source, options.time)?
    } else if exodus::recognizes(&source.bytes) {
        refuse_solution(&source, options)?;
        exodus::read(&source, options.time)?
    } else if surface::recognizes(&source.bytes) || surface::has_extension(&extension) {
        stuffing::read(&source, options.cell_size, &options.expressions)?
    } else if plot3d::recognizes(&source.bytes)
        || options.solution.is_some()
        || PLOT3D_EXTENSIONS.contains(&extension.as_str())
    {
        plot3d::read(source, options.solution.as_deref())?
    } else if VTK_XML_EXTENSIONS.contains(&extension.as_str()) {
        vtk_xml::read(source, options.time)?
    } else if extension == "vtk" {
        vtk_legacy::read(source)?
    } else if extension == "msh" {
        gmsh::read(source, options.time)?
    } else if tetgen::recognizes(&extension) {
        tetgen::read(source)?
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

/// A solution belongs to a PLOT3D grid, and to no file of another format.
fn refuse_solution(source: &Source, options: &ReadOptions) -> Result<(), IngestError> {
    let Some(solution) = &options.solution else { return Ok(()) };
    let remedy = "leave the solution out: only PLOT3D grids have one";
    Err(source.malformed(Place::File, "a solution for a file of another format", solution.display(), remedy))
}

/// Notes of what becomes of cells that are no plain linear ones.
fn note_cells(mesh: &mut MixedMesh) {
    let kinds = || mesh.cells.types.iter().map(|&t| CellType::of(t));
    let flat = kinds().flatten().filter(|kind| kind.dimension < 3).count();
    let polyhedra = kinds().flatten().filter(|kind| kind.number == POLYHEDRON).count();
    let quadratic = kinds().flatten().filter(|kind| is_quadratic(kind)).count();
    let more = |(c, kind): &(usize, Option<&CellType>)| {
        let points = mesh.cells.cell(*c).unwrap_or_default().len();
        let known =
            kind.and_then(|k| if k.number == QUADRATIC_PYRAMID { Some(PYRAMID_WITH_BASE_POINT) } else { k.points });
        known.is_some_and(|n| points > n)
    };
    let long = kinds().enumerate().filter(more).count();
    let differ = faces_that_differ(mesh);
    for (count, what, fate) in [
        (flat, "cells of points, lines or surfaces, without volume", "left out"),
        (long, "cells with more points than their type has", "of which the first points count"),
        (polyhedra, "polyhedra", "each with a point added in its middle"),
        (quadratic, "quadratic cells", "made linear between their corners and mid-edge points"),
        (
            differ,
            "faces between a linear and a quadratic cell, or where only one side has a point in the middle",
            "which do not fit together",
        ),
    ] {
        if count > 0 {
            mesh.notes.push(format!("{what}: {count}, {fate}"));
        }
    }
}
