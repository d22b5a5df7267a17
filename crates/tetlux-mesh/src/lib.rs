//! Tetrahedral meshes for direct volume rendering.
//!
//! A [`TetMesh`] holds points, positively oriented cells, the neighbour across every face, and point or cell
//! fields. [`TetMesh::assemble`] makes one of raw points and cells: it merges coincident points, orients the
//! cells, drops those with repeated vertices, keeps flat ones in the adjacency, and counts all it did.
//! [`TetMesh::validate`] reports what else is known. [`cache`] stores a mesh, [`procedural`] makes some with known
//! answers.
//!
//! ```
//! use tetlux_mesh::{Component, Field, TetMesh};
//!
//! let points = vec![[0.0, 0.0, 0.0].into(), [1.0, 0.0, 0.0].into(), [0.0, 1.0, 0.0].into(), [0.0, 0.0, 1.0].into()];
//! let height = Field::point("height", 1, vec![0.0, 0.0, 0.0, 1.0]);
//! let mesh = TetMesh::assemble(&points, &[[0, 1, 2, 3]], vec![height])?;
//! assert_eq!(mesh.validate().boundary_faces, 4);
//! assert_eq!(mesh.scalar("height", Component::Magnitude)?.range, [0.0, 1.0]);
//! # Ok::<(), tetlux_mesh::MeshError>(())
//! ```

mod adjacency;
mod assemble;
pub mod cache;
mod error;
mod field;
mod gradient;
mod mesh;
pub mod procedural;
mod report;

pub use assemble::{Assembly, coincident};
pub use error::MeshError;
pub use field::{Component, Field, Location, ScalarField};
pub use mesh::{FACES, NONE, TetMesh};
pub use report::{Check, Report};
