//! Reads the files that hold volume meshes, and makes tetrahedra of them.
//!
//! [`read`] recognises a file by its content and gives a [`MixedMesh`]: points, cells of any type and fields, as the
//! file has them, with a note of whatever was passed over. [`MixedMesh::tetrahedralize`] makes a
//! [`TetMesh`] of it. Read are VTK XML unstructured grids (`.vtu`: appended or inline, raw, base64 or
//! text, zlib or uncompressed, either byte order) and PLOT3D (one whole 3-D grid in C binary, with or without iblank,
//! either byte order, and its solution).
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

mod cell_type;
mod error;
mod mixed;
mod plot3d;
mod read;
mod source;
mod tetrahedralize;
mod vtu;

pub use error::{IngestError, Place};
pub use mixed::{MixedCells, MixedMesh, StructuredGrid};
pub use read::{ReadOptions, read, read_tet_mesh};
pub use tetlux_mesh::TetMesh;
pub use tetlux_mesh::procedural::Split;
