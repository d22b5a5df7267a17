//! What the workspace's tests share: meshes and scenes in a line, pictures by every way of rendering, the truth, and
//! the difference between them.
//!
//! Everything here stops with a message where something cannot be had: a test that cannot run must fail.
//!
//! ```
//! use glam::DVec3;
//! use tetlux_mesh::procedural::{Split, cuboid};
//! use tetlux_tests::{Way, largest_error, mesh_of, perspective, reference, render, scene, white};
//!
//! let mesh = mesh_of(&cuboid([2, 2, 2], Split::Six, [DVec3::ZERO, DVec3::ONE]), |p| p.x);
//! let camera = perspective(DVec3::new(3.0, 1.0, 2.0), DVec3::splat(0.5), 40.0);
//! let scene = scene(&mesh, white(&[[0.0, 0.0], [1.0, 2.0]]), camera, [16, 16]);
//! let picture = render(&mesh, &scene, Way::CpuPixel);
//! assert!(largest_error(picture.pixels(), &reference(&mesh, &scene)) < 1e-5);
//! ```

mod closed_form;
mod random;
mod random_scene;
pub mod twins;

use std::sync::OnceLock;

use glam::DVec3;
use tetlux_image::Image;
use tetlux_mesh::procedural::Parts;
use tetlux_mesh::{Component, Field, TetMesh};
use tetlux_optics::transfer::{ColorNode, OpacityNode, TransferFunction};
use tetlux_optics::{Classification, NoData};
use tetlux_reference::{Caster, Ray};
use tetlux_render::{Model, Renderer};
use tetlux_scene::{Backend, Camera, CellProjection, Method, Order, Plan, Projection, Scene, Surface, View};

pub use closed_form::{Convex, Judged, composite, depth_of, judge};
pub use random::Random;
pub use random_scene::{Recipe, random_camera, random_field, random_parts, range_of, sensitivity};

/// A back end and an order.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Way {
    /// wgpu, cells as they come.
    GpuNone,
    /// wgpu, cells by centroid.
    GpuCentroid,
    /// wgpu, front faces by centroid.
    GpuVicp,
    /// wgpu, every pixel from cell to cell.
    GpuMarch,
    /// wgpu, tiles of the picture in exact order.
    GpuTiles,
    /// The processor, cells by centroid.
    CpuCentroid,
    /// wgpu, in exact order.
    GpuExact,
    /// The processor, in exact order.
    CpuExact,
    /// The processor, segments sorted in every pixel.
    CpuPixel,
}

impl Way {
    /// Every way there is.
    pub const ALL: [Way; 9] = [
        Way::GpuNone,
        Way::GpuCentroid,
        Way::GpuVicp,
        Way::GpuMarch,
        Way::GpuTiles,
        Way::GpuExact,
        Way::CpuCentroid,
        Way::CpuExact,
        Way::CpuPixel,
    ];

    /// Those that are right whatever the scene.
    pub const RIGHT: [Way; 5] = [Way::CpuExact, Way::CpuPixel, Way::GpuExact, Way::GpuTiles, Way::GpuMarch];

    fn method(self) -> Method {
        let projection = match self {
            Way::GpuVicp => CellProjection::Vicp,
            Way::GpuMarch => CellProjection::March,
            Way::GpuTiles => CellProjection::Tiles,
            _ => CellProjection::Auto,
        };
        let (backend, order) = match self {
            Way::GpuNone => (Backend::Gpu, Order::None),
            Way::GpuCentroid | Way::GpuVicp => (Backend::Gpu, Order::Centroid),
            Way::GpuMarch => (Backend::Gpu, Order::None),
            Way::CpuCentroid => (Backend::Cpu, Order::Centroid),
            Way::GpuExact | Way::GpuTiles => (Backend::Gpu, Order::Exact),
            Way::CpuExact => (Backend::Cpu, Order::Exact),
            Way::CpuPixel => (Backend::Cpu, Order::Pixel),
        };
        Method { backend, order, projection, ..Method::default() }
    }
}

/// The name of the field that meshes get here.
pub const FIELD: &str = "s";

/// A mesh with one point field, a function of the position.
pub fn mesh_of(parts: &Parts, field: impl FnMut(DVec3) -> f64) -> TetMesh {
    mesh_with(parts, Field::point(FIELD, 1, parts.sample(field)))
}

/// A mesh with one given field.
pub fn mesh_with(parts: &Parts, field: Field) -> TetMesh {
    TetMesh::assemble(&parts.points, &parts.cells, vec![field]).unwrap_or_else(|e| panic!("the test's mesh: {e}"))
}

/// A transfer function of (scalar, red, green, blue) and (scalar, opacity).
pub fn transfer(color: &[[f64; 4]], opacity: &[[f64; 2]]) -> TransferFunction {
    TransferFunction::new(
        color.iter().map(|&[s, r, g, b]| ColorNode { s, rgb: [r, g, b] }).collect(),
        opacity.iter().map(|&[s, opacity]| OpacityNode { s, opacity }).collect(),
    )
    .unwrap_or_else(|e| panic!("the test's transfer function: {e}"))
}

/// A white transfer function: colour equals alpha.
pub fn white(opacity: &[[f64; 2]]) -> TransferFunction {
    transfer(&[[0.0, 1.0, 1.0, 1.0]], opacity)
}

/// A perspective camera.
pub fn perspective(position: DVec3, focal_point: DVec3, view_angle: f64) -> Camera {
    camera(position, focal_point, Projection::Perspective { view_angle })
}

/// An orthographic camera.
pub fn orthographic(position: DVec3, focal_point: DVec3, parallel_scale: f64) -> Camera {
    camera(position, focal_point, Projection::Orthographic { parallel_scale })
}

fn camera(position: DVec3, focal_point: DVec3, projection: Projection) -> Camera {
    // Upright is the axis most nearly perpendicular to the view: no direction is refused.
    let along = (focal_point - position).abs();
    let view_up = if along.z <= along.x.max(along.y) { DVec3::Z } else { DVec3::Y };
    Camera { position, focal_point, view_up, projection, near: 0.0 }
}

/// A scene on the mesh's first field, of unit distance 1.
pub fn scene(mesh: &TetMesh, transfer: TransferFunction, camera: Camera, size: [u32; 2]) -> Scene {
    let scalar = mesh.scalar(&mesh.fields()[0].name, Component::Magnitude).unwrap_or_else(|e| panic!("{e}"));
    Scene {
        scalar,
        second: None,
        classification: Classification::OneField(transfer),
        no_data: NoData::default(),
        lighting: None,
        emphasis: None,
        surfaces: Vec::new(),
        unit_distance: 1.0,
        camera,
        size,
        background: [0.0; 3],
        method: Method::default(),
    }
}

/// The transfer function of a scene that classifies one field.
pub fn transfer_of(scene: &Scene) -> &TransferFunction {
    match &scene.classification {
        Classification::OneField(transfer) => transfer,
        other => panic!("the test's scene has one field: {other:?}"),
    }
}

/// The one renderer of the process: devices and pipelines are made once.
pub fn renderer() -> &'static Renderer {
    static RENDERER: OnceLock<Renderer> = OnceLock::new();
    RENDERER.get_or_init(Renderer::new)
}

/// The plan of a scene for a way of rendering; the scene's own method says to what error, and what is done
/// though it need not be.
pub fn plan(mesh: &TetMesh, scene: &Scene, way: Way) -> Plan {
    let Method { no_skip, max_error, .. } = scene.method;
    let method = Method { no_skip, max_error, ..way.method() };
    Plan::new(&Scene { method, ..scene.clone() }, mesh, renderer().device())
        .unwrap_or_else(|e| panic!("{way:?} cannot be planned: {e}"))
}

/// The picture.
pub fn render(mesh: &TetMesh, scene: &Scene, way: Way) -> Image {
    render_by(renderer(), mesh, scene, way)
}

/// The same by a renderer of the test's own.
pub fn render_by(renderer: &Renderer, mesh: &TetMesh, scene: &Scene, way: Way) -> Image {
    let frame = renderer.render(scene, &Model::new(mesh), &plan(mesh, scene, way));
    frame.unwrap_or_else(|e| panic!("{way:?} cannot be rendered: {e}")).image
}

/// The scene's camera, resolved.
pub fn view(scene: &Scene) -> View {
    scene.camera.view(scene.size).unwrap_or_else(|e| panic!("the test's camera: {e}"))
}

/// Tolerance of the truth: two orders below the smallest that a test asks of a picture.
const REFERENCE_TOLERANCE: f64 = 1e-8;

/// The picture of the f64 ray caster.
pub fn reference(mesh: &TetMesh, scene: &Scene) -> Vec<[f64; 4]> {
    reference_beside(mesh, scene, [0.0; 2])
}

/// The same with every ray moved by some pixels.
pub fn reference_beside(mesh: &TetMesh, scene: &Scene, by: [f64; 2]) -> Vec<[f64; 4]> {
    let view = view(scene);
    let colors = scene.emphasis.as_ref().map(|emphasis| emphasis.seen(mesh, &view));
    let caster = Caster::new(tetlux_reference::Scene {
        mesh,
        scalar: &scene.scalar,
        second: scene.second.as_ref(),
        classification: &scene.classification,
        lighting: scene.lighting.as_ref().map(|lighting| (&lighting.light, &lighting.gradients[..])),
        colors: colors.as_deref(),
        unit_distance: scene.unit_distance,
        tolerance: REFERENCE_TOLERANCE,
    });
    let caster = caster
        .and_then(|caster| {
            caster
                .with_no_data(scene.no_data)
                .with_surfaces(scene.surfaces.iter().map(as_the_reference_takes_it).collect())
        })
        .unwrap_or_else(|e| panic!("the reference: {e}"));
    let ray = |x: u32, y: u32| {
        let (origin, direction) = view.ray(f64::from(x) + 0.5 + by[0], f64::from(y) + 0.5 + by[1]);
        Ray { origin, direction, start: view.near, end: f64::INFINITY }
    };
    caster.render(view.size[0], view.size[1], ray, |_| ())
}

fn as_the_reference_takes_it(surface: &Surface) -> tetlux_reference::Surface<'_> {
    let (color, light) = (surface.color(), surface.light());
    tetlux_reference::Surface { points: surface.points(), triangles: surface.triangles(), color, light }
}

/// Largest absolute difference of a pixel's four values; infinite where any is not finite.
pub fn pixel_error(pixel: [f32; 4], truth: [f64; 4]) -> f64 {
    let error = |i: usize| (f64::from(pixel[i]) - truth[i]).abs();
    (0..4).map(|i| if error(i).is_finite() { error(i) } else { f64::INFINITY }).fold(0.0, f64::max)
}

/// Largest error of any pixel; infinite where the pictures differ in size or a value is not finite.
pub fn largest_error(pixels: &[[f32; 4]], truth: &[[f64; 4]]) -> f64 {
    if pixels.len() != truth.len() {
        return f64::INFINITY;
    }
    pixels.iter().zip(truth).map(|(&p, &t)| pixel_error(p, t)).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_planted_difference_in_any_channel_is_the_largest_error() {
        let truth = vec![[0.25, 0.5, 0.0, 0.75]; 6];
        let good: Vec<[f32; 4]> = truth.iter().map(|t| t.map(|v| v as f32)).collect();
        assert_eq!(largest_error(&good, &truth), 0.0);
        for channel in 0..4 {
            for (value, expected) in [(2.0, 2.0 - truth[0][channel]), (f32::NAN, f64::INFINITY)] {
                let mut bad = good.clone();
                bad[4][channel] = value;
                assert_eq!(largest_error(&bad, &truth), expected, "channel {channel}");
            }
        }
        assert_eq!(largest_error(&good[1..], &truth), f64::INFINITY);
    }
}
