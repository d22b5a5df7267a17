use glam::DVec3;
use tetlux_mesh::procedural::{self, Split};
use tetlux_mesh::{Component, Field};
use tetlux_optics::Classification;
use tetlux_optics::transfer::{ColorNode, OpacityNode, TransferFunction};

use super::*;
use crate::{Camera, Cost, Method, Projection};

/// Cubes side by side along x, six cells each, from 0 to `n`, with the scalar x; the last point's value is missing.
fn row(n: usize) -> TetMesh {
    let parts = procedural::cuboid([n, 1, 1], Split::Six, [DVec3::ZERO, DVec3::new(n as f64, 1.0, 1.0)]);
    let mut x = parts.sample(|p| p.x);
    *x.last_mut().unwrap() = f64::NAN;
    // A flat cell between three of the first cube's corners and the middle of one of its edges.
    let mut parts = parts;
    parts.points.push(DVec3::new(0.5, 0.0, 0.0));
    x.push(0.5);
    let flat = [0, 1, (n + 1) as u32, parts.points.len() as u32 - 1];
    parts.cells.push(flat);
    TetMesh::assemble(&parts.points, &parts.cells, vec![Field::point("x", 1, x)]).unwrap()
}

fn scene(mesh: &TetMesh, color: &[[f64; 3]], method: Method) -> Scene {
    let node = |(i, &rgb): (usize, &[f64; 3])| ColorNode { s: i as f64, rgb };
    Scene {
        scalar: mesh.scalar("x", Component::Magnitude).unwrap(),
        second: None,
        no_data: tetlux_optics::NoData::default(),
        // Transparent up to 2.
        classification: Classification::OneField(
            TransferFunction::new(
                color.iter().enumerate().map(node).collect(),
                vec![OpacityNode { s: 2.0, opacity: 0.0 }, OpacityNode { s: 3.0, opacity: 1.0 }],
            )
            .unwrap(),
        ),
        lighting: None,
        emphasis: None,
        surfaces: Vec::new(),
        unit_distance: 1.0,
        camera: Camera {
            position: DVec3::new(4.5, -3.0, 0.5),
            focal_point: DVec3::new(4.5, 0.0, 0.5),
            view_up: DVec3::Z,
            projection: Projection::Orthographic { parallel_scale: 0.75 },
            near: 0.0,
        },
        size: [10, 10],
        background: [0.0; 3],
        method,
    }
}

const GREY: [f64; 3] = [0.5; 3];

fn device(software: bool, blends_f32: bool) -> Device {
    Device { name: "adapter".into(), driver: "1.2".into(), software, blends_f32, norm16: false, costs: None }
}

#[test]
fn each_cell_is_skipped_for_its_reason() {
    let mesh = row(7);
    let plan = Plan::new(&scene(&mesh, &[GREY], Method::default()), &mesh, None).unwrap();
    // The view spans x from 3.75 to 5.25: the cubes 3 to 6 x in [3, 6] are seen, of which all have opacity.
    // Cubes 0 and 1 and the flat cell lie below scalar 2. In the last cube the far corner's six cells (each holds
    // the diagonal's end) have no data.
    let expected = Skips { no_data: 6, transparent: 2 * 6 + 1, outside: 6, ..Skips::default() };
    assert_eq!(plan.skips, expected);
    assert_eq!(plan.cells, (3 * 6..6 * 6).collect::<Vec<u32>>());
    assert_eq!(plan.warnings.len(), 1, "missing data are warned of: {:?}", plan.warnings);
}

#[test]
fn flat_cells_are_skipped() {
    let mesh = row(2);
    let mut scene = scene(&mesh, &[GREY], Method::default());
    let fog = TransferFunction::new(vec![ColorNode { s: 0.0, rgb: GREY }], vec![OpacityNode { s: 0.0, opacity: 1.0 }]);
    scene.classification = Classification::OneField(fog.unwrap());
    scene.camera.projection = Projection::Orthographic { parallel_scale: 10.0 };
    let plan = Plan::new(&scene, &mesh, None).unwrap();
    assert_eq!((plan.skips.flat, plan.skips.outside), (1, 0));
    assert!(!plan.cells.contains(&12));
}

#[test]
fn cells_behind_the_eye_are_outside() {
    let mesh = row(2);
    let mut scene = scene(&mesh, &[GREY], Method::default());
    (scene.camera.position, scene.camera.focal_point) = (DVec3::new(0.0, 5.0, 0.5), DVec3::new(0.0, 9.0, 0.5));
    scene.camera.projection = Projection::Perspective { view_angle: 30.0 };
    assert!(Plan::new(&scene, &mesh, None).unwrap().cells.is_empty());
}

#[test]
fn outside_is_what_lies_beyond_one_plane_of_the_frustum() {
    let parts = procedural::cuboid([6, 5, 4], Split::Six, [DVec3::splat(-1.0), DVec3::ONE]);
    let field = Field::point("x", 1, parts.sample(|p| 3.0 + p.x));
    let mesh = TetMesh::assemble(&parts.points, &parts.cells, vec![field]).unwrap();
    let mut scene = scene(&mesh, &[GREY], Method::default());
    let (perspective, orthographic) =
        (Projection::Perspective { view_angle: 40.0 }, Projection::Orthographic { parallel_scale: 0.7 });
    let (mut all, mut none) = (false, false);
    // From far away, from nearby, from within, and along parallel rays.
    for (distance, projection) in
        [(9.0, perspective), (1.9, perspective), (0.4, perspective), (4.0, orthographic), (0.3, orthographic)]
    {
        for turn in 0..7 {
            let (sin, cos) = (0.3 + 0.9 * f64::from(turn)).sin_cos();
            scene.camera.position = DVec3::new(cos, sin, 0.31) * distance;
            scene.camera.focal_point = DVec3::new(0.05, -0.12, 0.07);
            (scene.camera.projection, scene.size) = (projection, [40, 30]);
            let plan = Plan::new(&scene, &mesh, None).unwrap();
            let outside = |cell: &&[u32; 4]| {
                let corners = cell.map(|v| plan.view.to_eye(mesh.world(v)));
                plan.view.frustum().iter().any(|&(n, c)| corners.iter().all(|&q| n.dot(q) + c < 0.0))
            };
            let expected = mesh.cells().iter().filter(outside).count();
            assert_eq!(plan.skips.outside, expected, "{distance} {turn}");
            assert_eq!(plan.cells.len() + expected, mesh.cells().len());
            (all, none) = (all || expected > mesh.cells().len() / 2, none || expected == 0);
        }
    }
    assert!(all && none, "much and nothing lies outside");
}

#[test]
fn backends_and_orders() {
    let mesh = row(4);
    let colors = [[0.1, 0.2, 0.3], [0.3, 0.2, 0.1], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let (hardware, software, half) = (device(false, true), device(true, true), device(false, false));
    for (backend, order, device, expected) in [
        (Backend::Auto, Order::Auto, None, Some((Backend::Cpu, Order::Exact))),
        (Backend::Auto, Order::Auto, Some(&hardware), Some((Backend::Gpu, Order::Exact))),
        (Backend::Auto, Order::Auto, Some(&software), Some((Backend::Cpu, Order::Exact))),
        (Backend::Auto, Order::Auto, Some(&half), Some((Backend::Gpu, Order::None))),
        (Backend::Auto, Order::Centroid, Some(&half), Some((Backend::Cpu, Order::Centroid))),
        (Backend::Gpu, Order::Auto, Some(&software), Some((Backend::Gpu, Order::Exact))),
        (Backend::Gpu, Order::Auto, Some(&half), Some((Backend::Gpu, Order::None))),
        (Backend::Auto, Order::Pixel, Some(&hardware), Some((Backend::Cpu, Order::Pixel))),
        (Backend::Gpu, Order::Auto, None, None),
        (Backend::Gpu, Order::Pixel, Some(&hardware), None),
        (Backend::Cpu, Order::Centroid, Some(&hardware), Some((Backend::Cpu, Order::Centroid))),
    ] {
        let method = Method { backend, order, ..Method::default() };
        let plan = Plan::new(&scene(&mesh, &colors, method), &mesh, device);
        assert_eq!(plan.ok().map(|p| (p.backend, p.order)), expected, "{backend} {order} {device:?}");
    }
}

#[test]
fn a_method_of_graphics_adapters_takes_one() {
    let mesh = row(4);
    let colors = [[0.1, 0.2, 0.3], [0.3, 0.2, 0.1], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let method = Method { integrator: Integrator::Symmetric, ..Method::default() };
    let planned = |method, device| Plan::new(&scene(&mesh, &colors, method), &mesh, device);
    let software = device(true, true);
    assert_eq!(planned(method, Some(&software)).unwrap().backend, Backend::Gpu);
    let error = planned(method, None).unwrap_err().to_string();
    assert!(error.contains("symmetric") && error.contains("no"), "{error}");
    let on_cpu = Method { backend: Backend::Cpu, ..method };
    let error = planned(on_cpu, Some(&software)).unwrap_err().to_string();
    assert!(error.contains("symmetric") && error.contains("--backend gpu"), "{error}");
    let sorted = Method { order: Order::Pixel, ..method };
    assert!(planned(sorted, Some(&software)).is_err());
}

#[test]
fn tables_of_a_format_that_the_adapter_lacks_are_singles_with_a_warning() {
    let mesh = row(4);
    let wanted = Method { table_precision: TablePrecision::U16, ..Method::default() };
    let planned = |integrator| {
        let method = Method { integrator, backend: Backend::Gpu, ..wanted };
        Plan::new(&scene(&mesh, &[GREY], method), &mesh, Some(&device(false, true)))
    };
    let plan = planned(Integrator::Q).unwrap();
    assert_eq!(plan.table_precision, TablePrecision::F32);
    assert!(plan.warnings.iter().any(|w| w.contains("16-bit")), "{:?}", plan.warnings);
    assert!(plan.to_string().contains("f32"), "{plan}");
    assert!(planned(Integrator::Direct).is_err(), "there is no table");
}

#[test]
fn an_adapter_that_cannot_blend_singles_marches_or_gets_halves_and_a_warning() {
    let mesh = row(4);
    let marched = Method { backend: Backend::Gpu, ..Method::default() };
    let on_gpu = Method { projection: CellProjection::Pt, ..marched };
    let planned = |method| Plan::new(&scene(&mesh, &[GREY], method), &mesh, Some(&device(false, false)));
    let plan = planned(marched).unwrap();
    assert_eq!((plan.projection, plan.target), (CellProjection::March, Target::Rgba32f));
    assert!(plan.warnings.iter().all(|w| !w.contains("target")), "{:?}", plan.warnings);
    assert_eq!(planned(Method { target: Target::Rgba16f, ..marched }).unwrap().projection, CellProjection::Pt);
    let plan = planned(on_gpu).unwrap();
    assert_eq!(plan.target, Target::Rgba16f);
    assert!(plan.warnings.iter().any(|w| w.contains("rgba16f") && w.contains("5e-2")), "{:?}", plan.warnings);
    let error = planned(Method { target: Target::Rgba32f, ..on_gpu }).unwrap_err().to_string();
    assert!(error.contains("cannot blend") && error.contains("rgba16f"), "{error}");
}

#[test]
fn a_measured_device_is_drawn_on_the_cheapest_way() {
    let mesh = row(4);
    let cheap = |fragment| Cost { picture: 1e4, cell: 1.0, fragment };
    let costs = Costs { pt: cheap(3.0), tiles: cheap(1.0), march: cheap(2.0) };
    let measured = Device { costs: Some(costs), ..device(false, true) };
    let mut scene = scene(&mesh, &[GREY, [1.0; 3]], Method::default());
    let planned = |scene: &Scene, device: &Device| {
        let plan = Plan::new(scene, &mesh, Some(device)).unwrap();
        (plan.projection, plan.to_string().contains("measured"))
    };
    let asks = |scene: &Scene| Plan::follows_costs(scene, &mesh, Some(&measured)).unwrap();
    // A picture of ten by ten pixels is drawn before any is found to be faster.
    assert_eq!((planned(&scene, &measured), asks(&scene)), ((CellProjection::Pt, false), false));
    scene.size = [4000, 4000];
    assert_eq!((planned(&scene, &measured), asks(&scene)), ((CellProjection::Tiles, true), true));
    assert_eq!(planned(&scene, &device(false, true)), (CellProjection::Pt, false));
    let half = Device { costs: Some(costs), ..device(false, false) };
    let dear = Device { costs: Some(Costs { tiles: cheap(9.0), pt: cheap(0.5), ..costs }), ..half };
    assert_eq!(planned(&scene, &dear), (CellProjection::March, true), "nothing is blended there");
    // Light costs what was not measured.
    let gradients = vec![DVec3::X; mesh.points().len()];
    let lit = Scene {
        lighting: Some(crate::Lighting { light: tetlux_optics::Light::default(), gradients }),
        ..scene.clone()
    };
    assert_eq!((planned(&lit, &measured), asks(&lit)), ((CellProjection::Pt, false), false));
    scene.method.projection = CellProjection::Vicp;
    assert_eq!((planned(&scene, &measured), asks(&scene)), ((CellProjection::Vicp, false), false));
    scene.method = Method { backend: Backend::Cpu, ..Method::default() };
    assert!(!asks(&scene));
}

#[test]
fn one_luminance_needs_no_order() {
    let mesh = row(4);
    let plan = Plan::new(&scene(&mesh, &[GREY], Method::default()), &mesh, Some(&device(false, true))).unwrap();
    assert_eq!(plan.order, Order::None);
    assert!(plan.warnings.iter().all(|w| !w.contains("centroid")));
}
