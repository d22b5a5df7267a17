//! Devices that are lost, that have little, and that lack what is asked for.

use tetlux_mesh::procedural::{Split, cuboid};
use tetlux_mesh::{Field, TetMesh};
use tetlux_scene::{
    Backend, CellProjection, Integrator, Method, Order, Plan, Scene, SceneFile, TablePrecision, Target,
};

use super::*;
use crate::{Frame, Model, Renderer};

fn mesh() -> TetMesh {
    let parts = cuboid([6, 5, 5], Split::Six, [[-1.0; 3].into(), [1.0; 3].into()]);
    let field = parts.sample(|p| (2.0 * p.x).sin() + p.y * p.z);
    TetMesh::assemble(&parts.points, &parts.cells, vec![Field::point("s", 1, field)]).unwrap()
}

fn scene(mesh: &TetMesh, method: Method) -> Scene {
    let text = "
        [transfer]
        color = [[-1.0, 0.9, 0.1, 0.2], [0.0, 0.2, 0.8, 0.3], [1.5, 1.0, 0.9, 0.2]]
        opacity = [[-1.0, 1.0], [-0.5, 0.1], [0.2, 0.5], [0.9, 2.0]]
        [image]
        size = [48, 32]
    ";
    let scene = SceneFile::parse("small.toml", text).unwrap().scene(mesh, 0).unwrap();
    Scene { method: Method { backend: Backend::Gpu, ..method }, ..scene }
}

/// The machine's adapter, of which no more is asked than this.
fn restricted(features: wgpu::Features, restrict: impl FnOnce(&mut wgpu::Limits)) -> Renderer {
    let Gpu { adapter, mut limits, .. } = Gpu::find().unwrap();
    restrict(&mut limits);
    Renderer { gpu: Some(Gpu::new(adapter, features, limits)), ..Renderer::without_adapter() }
}

fn planned(renderer: &Renderer, mesh: &TetMesh, method: Method) -> (Scene, Plan) {
    let scene = scene(mesh, method);
    let plan = Plan::new(&scene, mesh, renderer.device()).unwrap();
    (scene, plan)
}

fn render(renderer: &Renderer, mesh: &TetMesh, method: Method) -> Result<Frame, RenderError> {
    let (scene, plan) = planned(renderer, mesh, method);
    renderer.render(&scene, &Model::new(mesh), &plan)
}

fn largest_difference(a: &Frame, b: &Frame) -> f32 {
    let values = a.image.pixels().iter().flatten().zip(b.image.pixels().iter().flatten());
    values.map(|(x, y)| if x.is_finite() && y.is_finite() { (x - y).abs() } else { f32::INFINITY }).fold(0.0, f32::max)
}

#[test]
fn a_lost_device_is_an_error_once_and_opened_anew() {
    let mesh = mesh();
    for projection in [CellProjection::Pt, CellProjection::March, CellProjection::Tiles] {
        let renderer = Renderer::new();
        let method = Method { projection, ..Method::default() };
        let before = render(&renderer, &mesh, method).unwrap();
        renderer.lose_device();
        let error = render(&renderer, &mesh, method).unwrap_err();
        assert!(matches!(error, RenderError::Lost { .. }), "{error:?}");
        assert!(error.to_string().contains("render again") && error.to_string().contains("CPU back end"), "{error}");
        assert_eq!(render(&renderer, &mesh, method).unwrap().image, before.image, "{projection}");
        // With pipelines that were never made before it was lost.
        renderer.lose_device();
        let other = Method { projection, integrator: Integrator::Average, ..Method::default() };
        assert!(matches!(render(&renderer, &mesh, other), Err(RenderError::Lost { .. })));
        render(&renderer, &mesh, other).unwrap();
    }
}

#[test]
fn what_the_driver_reports_is_an_error() {
    let gpu = Gpu::find().unwrap();
    let open = gpu.open().unwrap();
    let make = |size| {
        let usage = wgpu::BufferUsages::STORAGE;
        let descriptor = wgpu::BufferDescriptor { label: None, size, usage, mapped_at_creation: false };
        gpu.checked(&open, || drop(open.device.create_buffer(&descriptor)))
    };
    assert!(make(64).is_ok());
    let error = make(u64::MAX / 8).unwrap_err().to_string();
    assert!(error.contains(&gpu.device.name), "{error}");
    let out = gpu.reported(&open, &wgpu::Error::OutOfMemory { source: "no memory is left".into() });
    assert!(matches!(out, RenderError::OutOfMemory { .. }), "{out:?}");
    assert!(out.to_string().contains("no memory is left") && out.to_string().contains("smaller"), "{out}");
}

/// It once was told as "Texture with 'picture' label is invalid", which is what follows from it.
#[test]
fn no_memory_is_told_before_what_follows_from_it() {
    let validation = || wgpu::Error::Validation { source: "invalid".into(), description: "invalid".into() };
    let errors = [validation(), wgpu::Error::OutOfMemory { source: "none left".into() }];
    assert!(matches!(cause(&errors), Some(wgpu::Error::OutOfMemory { .. })));
    assert!(matches!(cause(&[validation()]), Some(wgpu::Error::Validation { .. })));
    assert!(cause(&[]).is_none());
}

/// A driver made the values of the uniforms that alone decide a branch a part of the shader: it compiled every lit picture's
/// anew, and kept them all.
#[test]
fn a_look_is_no_uniform_and_lit_pictures_share_their_shader() {
    assert!(variant::Binding::Look.is_storage());
}

/// Bytes of the largest buffer that a shader may be given: less than half of what the projected cells take together.
const SMALL_BINDING: u64 = 32 << 10;

#[test]
fn a_mesh_of_more_than_a_binding_is_drawn_in_batches() {
    let mesh = mesh();
    let whole = Renderer::new();
    let small = restricted(FEATURES, |limits| limits.max_storage_buffer_binding_size = SMALL_BINDING);
    assert!(mesh.cells().len() as u64 * variant::CELL_BYTES > 2 * SMALL_BINDING);
    for projection in [CellProjection::Pt, CellProjection::Vicp, CellProjection::Balanced, CellProjection::Gator] {
        let method = Method { projection, order: Order::Exact, ..Method::default() };
        let [one, batches] = [&whole, &small].map(|renderer| render(renderer, &mesh, method).unwrap());
        assert_eq!(one.image, batches.image, "{projection}");
        assert!(batches.resources.buffers > one.resources.buffers, "{projection}: a buffer a batch");
    }
}

/// A cell's share of 2 GiB where there are 8 million.
const SHARE: u64 = (2 << 30) / 8_000_000;

#[test]
fn every_cell_keeps_to_its_share_of_two_gibibytes() {
    let parts = cuboid([16, 16, 12], Split::Six, [[-1.0; 3].into(), [1.0; 3].into()]);
    let field = parts.sample(|p| (2.0 * p.x).sin() + p.y * p.z);
    let mesh = TetMesh::assemble(&parts.points, &parts.cells, vec![Field::point("s", 1, field)]).unwrap();
    let cells = mesh.cells().len() as u64;
    // No buffer is larger than the cells themselves: what is projected comes in batches.
    let binding = 16 * cells;
    let small = restricted(FEATURES, |limits| limits.max_storage_buffer_binding_size = binding);
    assert!(cells * variant::CELL_BYTES > 4 * binding);
    for projection in [
        CellProjection::Pt,
        CellProjection::Gator,
        CellProjection::Vicp,
        CellProjection::Balanced,
        CellProjection::March,
        CellProjection::Tiles,
    ] {
        let bytes = render(&small, &mesh, Method { projection, ..Method::default() }).unwrap().resources.bytes;
        println!("{projection}: {} bytes a cell", bytes / cells);
        // Cells and points at the least.
        assert!((20 * cells..=SHARE * cells).contains(&bytes), "{projection}: {} bytes a cell", bytes / cells);
    }
}

#[test]
fn a_mesh_over_the_limits_is_refused_by_name() {
    let mesh = mesh();
    for (bytes, what) in [(8 << 10, "the mesh's cells"), (2 << 10, "the mesh's points")] {
        let renderer = restricted(FEATURES, |limits| limits.max_storage_buffer_binding_size = bytes);
        for projection in [CellProjection::Pt, CellProjection::March, CellProjection::Tiles] {
            let error = render(&renderer, &mesh, Method { projection, ..Method::default() }).unwrap_err();
            assert!(matches!(error, RenderError::Limit { .. }), "{error:?}");
            let text = error.to_string();
            assert!(text.contains(what) && text.contains("CPU back end") && text.contains("bytes"), "{text}");
        }
    }
    let narrow = restricted(FEATURES, |limits| limits.max_texture_dimension_2d = 32);
    let error = render(&narrow, &mesh, Method::default()).unwrap_err().to_string();
    assert!(error.contains("the picture needs 48 pixels a side"), "{error}");
}

/// Half precision after a few dozen cells; 1e-3 of each.
const HALVES: f32 = 2e-2;

#[test]
fn features_that_are_missing_have_their_fallback() {
    let mesh = mesh();
    let whole = Renderer::new();
    let bare = restricted(wgpu::Features::empty(), |_| ());
    let exact = render(&whole, &mesh, Method::default()).unwrap();
    // Nothing to blend in single precision: every pixel marches.
    let (_, plan) = planned(&bare, &mesh, Method::default());
    assert_eq!((plan.projection, plan.target), (CellProjection::March, Target::Rgba32f));
    assert!(largest_difference(&render(&bare, &mesh, Method::default()).unwrap(), &exact) < 1e-4);
    // A projection that must be blended: in half precision, with a warning.
    let blended = Method { projection: CellProjection::Pt, ..Method::default() };
    let (_, plan) = planned(&bare, &mesh, blended);
    assert_eq!(plan.target, Target::Rgba16f);
    assert!(plan.warnings.iter().any(|w| w.contains("rgba16f")), "{:?}", plan.warnings);
    let halves = largest_difference(&render(&bare, &mesh, blended).unwrap(), &exact);
    assert!(halves > 1e-6 && halves < HALVES, "{halves:.1e}");
    // Tables of 16-bit integers: in single precision, with a warning.
    let tabled = Method { integrator: Integrator::Q, table_precision: TablePrecision::U16, ..Method::default() };
    let (_, plan) = planned(&bare, &mesh, tabled);
    assert_eq!(plan.table_precision, TablePrecision::F32);
    assert!(plan.warnings.iter().any(|w| w.contains("16-bit")), "{:?}", plan.warnings);
    // What is asked for by name is refused.
    let asked = Method { target: Target::Rgba32f, ..blended };
    let refused = Plan::new(&scene(&mesh, asked), &mesh, bare.device()).unwrap_err().to_string();
    assert!(refused.contains("cannot blend") && refused.contains("rgba16f"), "{refused}");
}
