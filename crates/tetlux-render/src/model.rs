//! A mesh, and what is found once for all its pictures.

use std::sync::OnceLock;

use tetlux_mesh::TetMesh;
use tetlux_order::Facts;

/// A mesh to be rendered, any number of times.
#[derive(Debug)]
pub struct Model<'a> {
    mesh: &'a TetMesh,
    facts: OnceLock<Facts>,
    /// The facts came with the mesh.
    known: bool,
}

impl<'a> Model<'a> {
    /// Nothing is found before a picture needs it.
    pub fn new(mesh: &'a TetMesh) -> Model<'a> {
        Model { mesh, facts: OnceLock::new(), known: false }
    }

    /// With the mesh's facts as they were found before.
    pub fn with_facts(mesh: &'a TetMesh, facts: Facts) -> Model<'a> {
        Model { mesh, facts: OnceLock::from(facts), known: true }
    }

    /// The mesh.
    pub fn mesh(&self) -> &'a TetMesh {
        self.mesh
    }

    /// What ordering its cells needs to know, found when first asked for.
    pub fn facts(&self) -> &Facts {
        self.facts.get_or_init(|| Facts::new(self.mesh))
    }

    /// The facts, if a picture needed them and they did not come with the mesh: worth keeping for later.
    pub fn found_facts(&self) -> Option<&Facts> {
        self.facts.get().filter(|_| !self.known)
    }
}
