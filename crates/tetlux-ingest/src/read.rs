//! From a path to a mesh: which format a file has.

use std::path::{Path, PathBuf};

use tetlux_mesh::TetMesh;
use tetlux_mesh::procedural::Split;

use crate::cell_type::{CellType, POLYHEDRON, QUADRATIC_PYRAMID};
use crate::source::{Files, Source};
use crate::tetrahedralize::{PYRAMID_WITH_BASE_POINT, faces_that_differ, is_quadratic};
use crate::{Expression, IngestError, MixedMesh, exodus, gmsh, plot3d, stuffing, surface, tetgen, vtk_legacy, vtk_xml};

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

/// What a file is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Format {
    VtkXml,
    VtkLegacy,
    Gmsh,
    Exodus,
    Surface,
    Plot3d,
    TetGen,
}

impl Format {
    /// Found out from the content, and from the extension only where that fails.
    fn of(source: &Source, options: &ReadOptions) -> Option<Format> {
        let bytes = &source.bytes;
        let extension = source.path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
        let extension = extension.as_str();
        Some(if vtk_xml::recognizes(bytes) {
            Format::VtkXml
        } else if vtk_legacy::recognizes(bytes) {
            Format::VtkLegacy
        } else if gmsh::recognizes(bytes) {
            Format::Gmsh
        } else if exodus::recognizes(bytes) {
            Format::Exodus
        } else if surface::recognizes(bytes) || surface::has_extension(extension) {
            Format::Surface
        } else if plot3d::recognizes(bytes) || PLOT3D_EXTENSIONS.contains(&extension) {
            Format::Plot3d
        } else if VTK_XML_EXTENSIONS.contains(&extension) {
            Format::VtkXml
        } else if extension == "vtk" {
            Format::VtkLegacy
        } else if extension == "msh" {
            Format::Gmsh
        } else if tetgen::recognizes(extension) {
            Format::TetGen
        } else if options.solution.is_some() {
            Format::Plot3d
        } else {
            return None;
        })
    }

    /// What a message calls it.
    fn name(self) -> &'static str {
        match self {
            Format::VtkXml => "a VTK XML file",
            Format::VtkLegacy => "a legacy VTK file",
            Format::Gmsh => "a Gmsh file",
            Format::Exodus => "an Exodus II file",
            Format::Surface => "a surface",
            Format::Plot3d => "a PLOT3D grid",
            Format::TetGen => "a TetGen mesh",
        }
    }

    /// Fails if something is asked for that such a file does not have: it would be passed over in silence.
    fn refuse_unused(self, path: &Path, options: &ReadOptions) -> Result<(), IngestError> {
        let ReadOptions { solution, time, cell_size, expressions } = options;
        let timed = matches!(self, Format::VtkXml | Format::Gmsh | Format::Exodus);
        let (surface, plot3d) = (self == Format::Surface, self == Format::Plot3d);
        let surfaces = "surfaces that are filled (OBJ, STL) have one";
        for (unused, asked, owners) in [
            (solution.is_some() && !plot3d, "a solution", "PLOT3D grids have one"),
            (time.is_some() && !timed, "a time step", "Exodus II, Gmsh and VTK XML files can have them"),
            (cell_size.is_some() && !surface, "a cell size", surfaces),
            (!expressions.is_empty() && !surface, "a field by an expression", surfaces),
        ] {
            if unused {
                return Err(IngestError::Unused { path: path.into(), asked, format: self.name(), owners });
            }
        }
        Ok(())
    }
}

/// Reads a file: its format is found out from its content, and from its extension only where that fails.
///
/// # Errors
/// What is wrong with the file; [`IngestError::Unused`] if an option is set that files of its format do not have.
pub fn read(path: &Path, options: &ReadOptions) -> Result<MixedMesh, IngestError> {
    read_files(path, options, &mut Files::default())
}

/// As [`read`]; all files are opened through `files`.
pub(crate) fn read_files(path: &Path, options: &ReadOptions, files: &mut Files) -> Result<MixedMesh, IngestError> {
    let source = files.open(path)?;
    let Some(format) = Format::of(&source, options) else {
        let start = &source.bytes[..source.bytes.len().min(24)];
        let found = format!("\"{}\"", start.escape_ascii());
        return Err(IngestError::UnknownFormat { path: path.into(), found });
    };
    format.refuse_unused(path, options)?;
    let mut mesh = match format {
        Format::VtkXml => vtk_xml::read(source, options.time, files)?,
        Format::VtkLegacy => vtk_legacy::read(source)?,
        Format::Gmsh => gmsh::read(source, options.time)?,
        Format::Exodus => exodus::read(&source, options.time)?,
        Format::Surface => stuffing::read(&source, options.cell_size, &options.expressions)?,
        Format::Plot3d => plot3d::read(source, options.solution.as_deref(), files)?,
        Format::TetGen => tetgen::read(source, files)?,
    };
    mesh.check()?;
    note_cells(&mut mesh);
    Ok(mesh)
}

/// The number of time steps of a file with several, at least 2.
///
/// # Errors
/// [`IngestError::Unused`] if files of its format have none, [`IngestError::OneTime`] if this one has none or one, or
/// what is wrong with it.
pub fn time_steps(path: &Path, options: &ReadOptions) -> Result<usize, IngestError> {
    // No file has so many: each reader then says how many there are.
    let beyond = ReadOptions { time: Some(usize::MAX), ..options.clone() };
    match read(path, &beyond) {
        Err(IngestError::NoSuchTimeStep { count, .. }) if count > 1 => Ok(count as usize),
        Ok(_) | Err(IngestError::NoSuchTimeStep { .. }) => Err(IngestError::OneTime { path: path.into() }),
        Err(error) => Err(error),
    }
}

/// Reads a file and makes tetrahedra of its cells: [`read`] and [`MixedMesh::tetrahedralize`].
pub fn read_tet_mesh(path: &Path, options: &ReadOptions, split: Split) -> Result<TetMesh, IngestError> {
    read(path, options)?.tetrahedralize(split)
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
