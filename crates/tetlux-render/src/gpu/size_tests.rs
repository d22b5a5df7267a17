//! What pictures take of devices of little memory.

use glam::DVec3;
use tetlux_mesh::procedural::{Split, cuboid};
use tetlux_mesh::{Component, Field, TetMesh};
use tetlux_optics::Classification;
use tetlux_optics::transfer::{ColorNode, OpacityNode, TransferFunction};
use tetlux_scene::{Backend, Camera, CellProjection, Method, Scene};

use super::frame::batch_size;
use super::*;
use crate::Renderer;
use crate::device_mesh::Data;

const MIB: u64 = 1 << 20;
/// Less than this leaves devices idle between batches.
const FEW: u64 = 1 << 17;

/// What every device has: 128 MiB a binding, 256 MiB a buffer.
fn least() -> wgpu::Limits {
    wgpu::Limits { max_storage_buffer_binding_size: 128 * MIB, max_buffer_size: 256 * MIB, ..wgpu::Limits::default() }
}

fn scene(mesh: &TetMesh) -> Scene {
    let colors = [[0.1, 0.4, 0.9], [0.9, 0.5, 0.1]];
    let node = |(i, rgb): (usize, [f64; 3])| ColorNode { s: -1.0 + 2.0 * i as f64, rgb };
    let opacity = vec![OpacityNode { s: -1.0, opacity: 0.0 }, OpacityNode { s: 1.0, opacity: 3.0 }];
    let transfer = TransferFunction::new(colors.into_iter().enumerate().map(node).collect(), opacity);
    Scene {
        scalar: mesh.scalar("s", Component::Magnitude).unwrap(),
        second: None,
        no_data: tetlux_optics::NoData::default(),
        classification: Classification::OneField(transfer.unwrap()),
        lighting: None,
        emphasis: None,
        surfaces: Vec::new(),
        unit_distance: 0.5,
        camera: Camera::framing(mesh.bounds(), DVec3::new(-1.0, 1.5, -0.7), DVec3::Z),
        size: [48, 40],
        background: [0.0; 3],
        method: Method { backend: Backend::Gpu, projection: CellProjection::Pt, ..Method::default() },
    }
}

/// What a picture of so many cells takes of a device at the least limits.
fn bytes_of(cells: u64, points: u64, pixels: u64, geometry: &variant::Geometry) -> u64 {
    let batch = u64::from(batch_size(&least(), geometry)).min(cells);
    let indices = geometry.indices.map_or(0, size_of_val) as u64;
    // Points of 16 bytes and as they are seen, cells of 16 bytes, the order, a batch of projected cells; the picture and its way back.
    32 * points + 16 * cells + 4 * cells + batch * (geometry.bytes + indices) + 2 * 16 * pixels
}

#[test]
fn eight_million_cells_fit_two_gibibytes() {
    let (cells, points) = (8_000_000, 1_400_000);
    for projection in [CellProjection::Pt, CellProjection::Vicp, CellProjection::Balanced] {
        let parts = cuboid([1; 3], Split::Six, [DVec3::ZERO, DVec3::ONE]);
        let mesh = TetMesh::assemble(&parts.points, &parts.cells, vec![Field::point("s", 1, parts.sample(|p| p.x))]);
        let mesh = mesh.unwrap();
        let mut scene = scene(&mesh);
        scene.method.projection = projection;
        let plan = Plan::new(&scene, &mesh, Renderer::new().device()).unwrap();
        let geometry = Variant::new(&plan, Data::Point, None, false).geometry();
        let batch = u64::from(batch_size(&least(), &geometry));
        assert!(batch * geometry.bytes <= least().max_storage_buffer_binding_size);
        assert!(batch >= FEW, "{projection}: {batch} cells a batch are few");
        let bytes = bytes_of(cells, points, 800 * 800, &geometry);
        assert!(bytes < 1024 * MIB, "{projection}: {} MiB", bytes / MIB);
        // The largest binding is that of the cells.
        assert!(16 * cells <= least().max_storage_buffer_binding_size);
    }
}
