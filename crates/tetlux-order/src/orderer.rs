//! From a mesh and a view to an order.

use tetlux_mesh::TetMesh;

use crate::{Facts, Method, Order, Sampling, centroid};

/// Finds orders; keeps its memory, and the last order, from view to view.
#[derive(Debug, Default)]
pub struct Orderer {
    order: Order,
}

impl Orderer {
    /// One that has found none yet.
    pub fn new() -> Orderer {
        Orderer::default()
    }

    /// The order of a mesh's cells, front to back: the last one if nothing has changed since.
    ///
    /// `facts` are those of `mesh`.
    pub fn order(&mut self, mesh: &TetMesh, facts: &Facts, sampling: &Sampling, method: Method) -> &Order {
        self.order = Order::default();
        self.order.report.method = method;
        self.order.report.folded_faces = facts.folded_faces();
        let cells: Vec<u32> = (0..mesh.cells().len() as u32).collect();
        self.order.cells = centroid(mesh, sampling.eye(), &cells);
        &self.order
    }
}
