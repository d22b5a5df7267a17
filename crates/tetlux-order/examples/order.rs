//! An order from a mesh and an eye, and the proof that it is right: `cargo run -p tetlux-order --example order`.

use tetlux_mesh::{TetMesh, procedural};
use tetlux_order::verify::{Ray, verify};
use tetlux_order::{Facts, Method, Orderer, Sampling};

#[allow(clippy::print_stdout, reason = "an example shows what it finds")]
fn main() -> Result<(), tetlux_mesh::MeshError> {
    let parts = procedural::sphere_shell([24, 12, 3], procedural::Split::Six, [0.0; 3].into(), [0.5, 1.0]);
    let mesh = TetMesh::assemble(&parts.points, &parts.cells, vec![])?;
    let eye = [0.2, 0.1, 4.0].into();
    let (right, down, forward) = ([1.0, 0.0, 0.0].into(), [0.0, -1.0, 0.0].into(), [0.0, 0.0, -1.0].into());
    let view = Sampling { eye, right, down, forward, pixel: 0.01, size: [64, 64], near: 0.0, orthographic: false };
    let mut orderer = Orderer::new();
    let order = orderer.order(&mesh, &Facts::new(&mesh), &view, Method::Auto);
    println!("{} cells by {}: {}", order.cells.len(), order.report.method, order.report.reason);
    let ray = |(i, j)| Ray { origin: view.ray(i, j).0, direction: view.ray(i, j).1, start: 0.0 };
    let rays: Vec<Ray> = (0..64).flat_map(|j| (0..64).map(move |i| (i, j))).map(ray).collect();
    let found = verify(&mesh, order, &rays);
    println!("{} inversions of {} pairs along {} rays", found.inversions, found.pairs, found.rays);
    Ok(())
}
