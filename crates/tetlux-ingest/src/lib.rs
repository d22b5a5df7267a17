//! Reads the files that hold volume meshes, and makes tetrahedra of them.
//!
//! [`read`] recognises a file by its content and gives a [`MixedMesh`]: points, cells of any type and fields, as the
//! file has them, with a note of whatever was passed over. [`MixedMesh::tetrahedralize`] makes a
//! [`TetMesh`] of it. Read are VTK XML grids of all kinds, and collections of them (`.vtu`, `.vts`, `.vtr`,
//! `.vti`, `.pvtu` and the like, `.vtm`, `.pvd`: appended or inline, raw, base64 or text, zlib, LZ4, LZMA or
//! uncompressed, either byte order), legacy VTK grids (`.vtk`, versions 1.0 to 5.1), Gmsh (`.msh`,
//! versions 2 and 4.1), TetGen (`.node` with `.ele`), Exodus II (in
//! netCDF's classic formats and HDF5), and PLOT3D (whole 3-D grids and their solutions, however they are written).
//!
//! A closed [`Surface`] (OBJ, STL) is filled with tetrahedra by [`fill`], by `read` too, with the distance to it and
//! any [`Expression`] of the coordinates as fields. [`read_cached`] keeps large meshes between runs.
//!
//! ```
//! use tetlux_ingest::{ReadOptions, Split, read};
//!
//! let file = tempfile::Builder::new().suffix(".vtu").tempfile()?;
//! std::fs::write(
//!     &file,
//!     r#"<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian">
//!     <UnstructuredGrid><Piece NumberOfPoints="4" NumberOfCells="1">
//!     <Points><DataArray type="Float64" NumberOfComponents="3" format="ascii">
//!       0 0 0  1 0 0  0 1 0  0 0 1
//!     </DataArray></Points>
//!     <Cells>
//!       <DataArray type="Int32" Name="connectivity" format="ascii">0 1 2 3</DataArray>
//!       <DataArray type="Int32" Name="offsets" format="ascii">4</DataArray>
//!       <DataArray type="UInt8" Name="types" format="ascii">10</DataArray>
//!     </Cells></Piece></UnstructuredGrid></VTKFile>"#,
//! )?;
//! let mixed = read(file.path(), &ReadOptions::default())?;
//! assert_eq!(mixed.cell_counts(), [("tetrahedra", 1)]);
//! let mesh = mixed.tetrahedralize(Split::default())?;
//! assert_eq!(mesh.validate().volume, 1.0 / 6.0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod cache;
mod cell_type;
#[cfg(test)]
mod damage;
mod error;
mod exodus;
mod expression;
mod gmsh;
mod mixed;
mod number;
mod plot3d;
mod read;
mod source;
mod stuffing;
mod surface;
mod tetgen;
mod tetrahedralize;
mod vtk_legacy;
mod vtk_xml;
mod words;

pub use cache::{Cache, CacheEntry, CacheOutcome, Extras, Loaded, Miss, read_cached};
pub use error::{IngestError, Place};
pub use expression::{Expression, ExpressionError};
pub use mixed::{MixedCells, MixedMesh, StructuredGrid};
pub use read::{ReadOptions, read, read_tet_mesh, time_steps};
pub use stuffing::{DISTANCE, Filled, fill};
pub use surface::{Surface, SurfaceReport};
pub use tetlux_mesh::TetMesh;
pub use tetlux_mesh::procedural::Split;
