//! One ray through a box of constant extinction, against 1 - exp(-tau d).

use glam::DVec3;
use tetlux_mesh::procedural::{Split, cuboid};
use tetlux_mesh::{Component, Field, TetMesh};
use tetlux_optics::{Classification, ColorNode, OpacityNode, TransferFunction};
use tetlux_reference::{Caster, DEFAULT_TOLERANCE, Ray, Scene};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let parts = cuboid([4, 4, 4], Split::Five, [DVec3::ZERO, DVec3::new(1.0, 1.0, 2.0)]);
    let mesh = TetMesh::assemble(&parts.points, &parts.cells, vec![Field::point("s", 1, parts.sample(|p| p.z))])?;
    let scalar = mesh.scalar("s", Component::Magnitude)?;
    let orange = vec![ColorNode { s: 0.0, rgb: [1.0, 0.5, 0.0] }];
    let transfer = TransferFunction::new(orange, vec![OpacityNode { s: 0.0, opacity: 0.5 }])?;
    let scene = Scene {
        mesh: &mesh,
        scalar: &scalar,
        second: None,
        classification: &Classification::OneField(transfer),
        lighting: None,
        colors: None,
        unit_distance: 1.0,
        tolerance: DEFAULT_TOLERANCE,
    };
    let ray = Ray { origin: DVec3::new(0.5, 0.5, -3.0), direction: DVec3::Z, start: 0.0, end: f64::INFINITY };
    let seen = Caster::new(scene)?.cast(&ray);
    let expected = 1.0 - (-0.5_f64 * 2.0).exp();
    assert!((seen.alpha - expected).abs() < DEFAULT_TOLERANCE);
    Ok(())
}
