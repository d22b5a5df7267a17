//! Visibility orderings: permutations of a mesh's cells such that, along every ray, nearer cells come first.
//!
//! ```
//! use tetlux_mesh::{TetMesh, procedural};
//! use tetlux_order::{Facts, Method, Orderer, Sampling};
//!
//! let parts = procedural::cuboid([4, 1, 1], procedural::Split::Six, [[0.0; 3].into(), [4.0, 1.0, 1.0].into()]);
//! let mesh = TetMesh::assemble(&parts.points, &parts.cells, vec![])?;
//! let facts = Facts::new(&mesh);
//! let (right, down, forward) = ([0.0, 1.0, 0.0].into(), [0.0, 0.0, -1.0].into(), [-1.0, 0.0, 0.0].into());
//! let eye = [9.0, 0.5, 0.5].into();
//! let view = Sampling { eye, right, down, forward, pixel: 0.01, size: [64, 64], near: 0.0, orthographic: false };
//! let mut orderer = Orderer::new();
//! let order = orderer.order(&mesh, &facts, &view, Method::Auto);
//! assert!(order.cells[0] >= 18 && order.cells[23] < 6, "the six cells of the nearest cube come first");
//! # Ok::<(), tetlux_mesh::MeshError>(())
//! ```

mod centroid;
mod clock;
mod coverage;
mod exact;
mod facts;
mod gaps;
mod method;
mod order;
mod orderer;
#[cfg(feature = "planted")]
pub mod planted;
mod power;
mod sampling;
mod search;
mod signs;
pub mod verify;

pub use centroid::centroid;
pub use facts::Facts;
pub use method::{Method, UnknownMethod};
pub use order::{Order, OrderReport, Stage};
pub use orderer::{Orderer, Thorough};
pub use sampling::{Eye, Sampling};
