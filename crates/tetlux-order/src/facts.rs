//! What no view changes.

use tetlux_mesh::TetMesh;

/// What ordering needs to know of a mesh, found once for all views.
#[derive(Debug, Clone)]
pub struct Facts {
    cells: usize,
    folded_faces: usize,
}

impl Facts {
    /// Finds the facts of a mesh.
    pub fn new(mesh: &TetMesh) -> Facts {
        Facts { cells: mesh.cells().len(), folded_faces: mesh.assembly().faces_folded }
    }

    /// Cells of the mesh.
    pub fn cells(&self) -> usize {
        self.cells
    }

    /// Faces whose two cells lie on one side of them: no order exists there.
    pub fn folded_faces(&self) -> usize {
        self.folded_faces
    }
}
