//! Why a file could not be read.

use std::fmt;
use std::io;
use std::path::PathBuf;

use tetlux_mesh::MeshError;

/// The formats [`read`](crate::read) knows, for messages.
pub(crate) const FORMATS: &str = "closed surfaces to fill (OBJ, STL), VTK XML grids (.vtu, .vts, .vtr, .vti, .pvtu and the like, .vtm, .pvd), legacy VTK grids (.vtk), Gmsh (.msh, versions 2 and 4.1), TetGen (.node with .ele) and Exodus II (.ex2, .e, .exo) and PLOT3D (whole 3-D grids)";

/// Where in a file something was found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Place {
    /// Bytes from the start of the file.
    Byte(u64),
    /// A cell, numbered from 0 in the file's order.
    Cell(usize),
    /// A point, numbered from 0 in the file's order.
    Point(usize),
    /// The file as a whole.
    File,
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Place::Byte(offset) => write!(f, "at byte {offset}"),
            Place::Cell(cell) => write!(f, "at cell {cell}"),
            Place::Point(point) => write!(f, "at point {point}"),
            Place::File => write!(f, "in the file"),
        }
    }
}

/// A file that cannot be read, or a mesh that cannot be made of it.
#[derive(Debug, thiserror::Error)]
pub enum IngestError {
    /// The file does not exist or may not be read.
    #[error("{}: cannot be read: {source}; check the path and its permissions", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// A directory, a pipe or a device.
    #[error("{}: is {found}, not a file; name the file itself", path.display())]
    NotAFile {
        /// What was named.
        path: PathBuf,
        /// "a directory" or "no regular file".
        found: &'static str,
    },
    /// No bytes at all.
    #[error("{}: is empty; write it again", path.display())]
    Empty {
        /// The file.
        path: PathBuf,
    },
    /// None of the formats read.
    #[error("{}: is of no known format (it begins {found}); the formats read are {FORMATS}", path.display())]
    UnknownFormat {
        /// The file.
        path: PathBuf,
        /// The first bytes, escaped.
        found: String,
    },
    /// The file ends too soon, or a length in it is too large.
    #[error(
        "{}: {what} at byte {offset} needs {needed} bytes, but {found} are there: the file is cut short or its \
         header is wrong; copy or write it again",
        path.display()
    )]
    Truncated {
        /// The file.
        path: PathBuf,
        /// What was being read.
        what: String,
        /// Where it begins, in bytes from the start of the file.
        offset: u64,
        /// Bytes it needs.
        needed: u64,
        /// Bytes there are.
        found: u64,
    },
    /// Something the format forbids.
    #[error("{}: {place}: {what}: found {found}; {remedy}", path.display())]
    Malformed {
        /// The file.
        path: PathBuf,
        /// Where.
        place: Place,
        /// What is wrong.
        what: String,
        /// The value found.
        found: String,
        /// What to do.
        remedy: String,
    },
    /// Something the format allows but this reader does not know.
    #[error("{}: {place}: {what} {found} cannot be read; {remedy}", path.display())]
    Unsupported {
        /// The file.
        path: PathBuf,
        /// Where.
        place: Place,
        /// The kind of thing, as "compressor".
        what: &'static str,
        /// The one found.
        found: String,
        /// What to do.
        remedy: String,
    },
    /// A coordinate that is NaN or infinite.
    #[error(
        "{}: point {point} is at ({}, {}, {}); every coordinate must be finite: mend the mesh or leave the point out",
        path.display(), at[0], at[1], at[2]
    )]
    NonFinite {
        /// The file.
        path: PathBuf,
        /// The point, numbered from 0 in the file's order.
        point: usize,
        /// Its coordinates.
        at: [f64; 3],
    },
    /// A PLOT3D solution of another grid.
    #[error(
        "{}: holds a solution on {} x {} x {} points, but the grid {} has {} x {} x {}; name the q file that \
         belongs to the grid",
        solution.display(), found[0], found[1], found[2], path.display(), expected[0], expected[1], expected[2]
    )]
    SolutionDiffers {
        /// The grid file.
        path: PathBuf,
        /// The solution file.
        solution: PathBuf,
        /// The dimensions in the solution file.
        found: [u32; 3],
        /// The grid's.
        expected: [u32; 3],
    },
    /// Something was asked for that files of this format do not have.
    #[error("{}: {asked} is asked for, but {format} has none; leave it out: {owners}", path.display())]
    Unused {
        /// The file.
        path: PathBuf,
        /// What was asked for.
        asked: &'static str,
        /// What the file is.
        format: &'static str,
        /// Which files have such a thing.
        owners: &'static str,
    },
    /// Several time steps were asked for of a file that does not have them.
    #[error("{}: the file has no several time steps: name one that has, or a file for every step", path.display())]
    OneTime {
        /// The file.
        path: PathBuf,
    },
    /// A time step that the file does not have.
    #[error(
        "{}: time step {step} is out of range: the file has {count}, numbered from 0; name one of them, or none for \
         the last",
        path.display()
    )]
    NoSuchTimeStep {
        /// The file.
        path: PathBuf,
        /// The step asked for.
        step: u64,
        /// Number of steps there are.
        count: u64,
    },
    /// A surface that encloses nothing.
    #[error(
        "{}: the surface is not closed, so that it has no inside to fill: {open} edges have one triangle, \
         {non_manifold} have three or more, {same_way} have two of which one must be inside out; close it in a mesh \
         editor (Blender: Mesh, Clean Up, Fill Holes; MeshLab: Cleaning and Repairing)",
        path.display()
    )]
    NotClosed {
        /// The file.
        path: PathBuf,
        /// Edges of one triangle alone.
        open: usize,
        /// Edges of three or more.
        non_manifold: usize,
        /// Edges of two triangles that no turning makes agree.
        same_way: usize,
    },
    /// A cell size that is no size.
    #[error("{}: cells of size {cell_size} cannot fill the surface; the size must be positive", path.display())]
    CellSize {
        /// The file.
        path: PathBuf,
        /// The size asked for.
        cell_size: f64,
    },
    /// Cells too small for the surface.
    #[error(
        "{}: cells of size {cell_size} take a lattice of {nodes:.0} nodes, where {limit} are the most, or meet too \
         many triangles; {fitting:.4} fits",
        path.display()
    )]
    TooFine {
        /// The file.
        path: PathBuf,
        /// The size asked for.
        cell_size: f64,
        /// Nodes of the lattice round the surface.
        nodes: f64,
        /// Nodes there may be.
        limit: u64,
        /// A size that will do.
        fitting: f64,
    },
    /// Cells too large for the surface.
    #[error(
        "{}: no node of a lattice of cell size {cell_size} lies inside the surface; give a size of half its thickness \
         or less",
        path.display()
    )]
    NothingInside {
        /// The file.
        path: PathBuf,
        /// The size asked for.
        cell_size: f64,
    },
    /// A file that a collection lists cannot be read.
    #[error("{}: of the files it lists, {source}", path.display())]
    Listed {
        /// The collection.
        path: PathBuf,
        /// What is wrong with the file, which it names.
        source: Box<IngestError>,
    },
    /// The points and cells make no mesh, or a field does not fit.
    #[error("{}: {source}", path.display())]
    Mesh {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        source: MeshError,
    },
}
