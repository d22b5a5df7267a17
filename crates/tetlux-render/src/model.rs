//! A mesh, and what is found once for all its pictures.

use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use tetlux_mesh::{ScalarField, TetMesh};
use tetlux_order::Facts;
use tetlux_scene::Scene;

use crate::device_mesh::DeviceMesh;

/// A mesh to be rendered, any number of times.
#[derive(Debug)]
pub struct Model<'a> {
    mesh: &'a TetMesh,
    facts: OnceLock<Facts>,
    /// The facts came with the mesh.
    known: bool,
    /// As devices have it, with the field of the last picture and those of which cells without data were seen.
    prepared: Mutex<Option<Prepared>>,
}

/// A mesh as devices have it, and the fields that it was made of.
type Prepared = (Vec<ScalarField>, Arc<DeviceMesh>);

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

    /// The mesh as devices have it, and whether it is that of the last picture: if that showed the same fields, and
    /// `reuse` is not refused.
    pub(crate) fn prepared(&self, scene: &Scene, reuse: bool) -> (Arc<DeviceMesh>, bool) {
        // What a panic elsewhere left is as good as before.
        let lock = || self.prepared.lock().unwrap_or_else(PoisonError::into_inner);
        let without = scene.seen_without_data();
        let fields: Vec<&ScalarField> = std::iter::once(&scene.scalar).chain(without.iter().copied()).collect();
        let same = |of: &[ScalarField]| {
            of.len() == fields.len() && of.iter().zip(&fields).all(|(a, b)| a.range == b.range && a.is_same(b))
        };
        if let Some((_, mesh)) = lock().as_ref().filter(|(of, _)| reuse && same(of)) {
            return (mesh.clone(), true);
        }
        let mesh = Arc::new(DeviceMesh::new(self.mesh, &scene.scalar, &without));
        *lock() = Some((fields.into_iter().cloned().collect(), mesh.clone()));
        (mesh, false)
    }

    /// The facts, if a picture needed them and they did not come with the mesh: worth keeping for later.
    pub fn found_facts(&self) -> Option<&Facts> {
        self.facts.get().filter(|_| !self.known)
    }
}
