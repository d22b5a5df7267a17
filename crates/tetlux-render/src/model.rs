//! A mesh, and what is found once for all its pictures.

use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use tetlux_mesh::{ScalarField, TetMesh};
use tetlux_order::Facts;

use crate::device_mesh::DeviceMesh;

/// A mesh to be rendered, any number of times.
#[derive(Debug)]
pub struct Model<'a> {
    mesh: &'a TetMesh,
    facts: OnceLock<Facts>,
    /// The facts came with the mesh.
    known: bool,
    /// As devices have it, with the field of the last picture.
    prepared: Mutex<Option<(ScalarField, Arc<DeviceMesh>)>>,
}

impl<'a> Model<'a> {
    /// Nothing is found before a picture needs it.
    pub fn new(mesh: &'a TetMesh) -> Model<'a> {
        Model { mesh, facts: OnceLock::new(), known: false, prepared: Mutex::default() }
    }

    /// With the mesh's facts as they were found before.
    pub fn with_facts(mesh: &'a TetMesh, facts: Facts) -> Model<'a> {
        Model { mesh, facts: OnceLock::from(facts), known: true, prepared: Mutex::default() }
    }

    /// The mesh.
    pub fn mesh(&self) -> &'a TetMesh {
        self.mesh
    }

    /// What ordering its cells needs to know, found when first asked for.
    pub fn facts(&self) -> &Facts {
        self.facts.get_or_init(|| Facts::new(self.mesh))
    }

    /// The mesh as devices have it, and whether it is that of the last picture: if that showed the same field, and
    /// `reuse` is not refused.
    pub(crate) fn prepared(&self, scalar: &ScalarField, reuse: bool) -> (Arc<DeviceMesh>, bool) {
        // What a panic elsewhere left is as good as before.
        let lock = || self.prepared.lock().unwrap_or_else(PoisonError::into_inner);
        let same = |of: &ScalarField| of.range == scalar.range && of.is_same(scalar);
        if let Some((_, mesh)) = lock().as_ref().filter(|(of, _)| reuse && same(of)) {
            return (mesh.clone(), true);
        }
        let mesh = Arc::new(DeviceMesh::new(self.mesh, scalar));
        *lock() = Some((scalar.clone(), mesh.clone()));
        (mesh, false)
    }

    /// The facts, if a picture needed them and they did not come with the mesh: worth keeping for later.
    pub fn found_facts(&self) -> Option<&Facts> {
        self.facts.get().filter(|_| !self.known)
    }
}
