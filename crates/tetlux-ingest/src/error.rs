//! Why a file could not be read.

use std::fmt;
use std::io;
use std::path::PathBuf;

use tetlux_mesh::MeshError;

/// The formats [`read`](crate::read) knows, for messages.
pub(crate) const FORMATS: &str =
    "VTK XML unstructured grids (.vtu) and PLOT3D whole 3-D single grids (C binary, single precision)";

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
        found: [i32; 3],
        /// The grid's.
        expected: [i32; 3],
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
