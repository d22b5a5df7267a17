//! Opacity emphasised at the vertices: what the derivatives of known fields make of it, and pictures against the f64
//! reference on both back ends.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test's helpers fail and tell like the test")]

use std::sync::Arc;

use glam::DVec3;
use tetlux_mesh::procedural::{Split, cuboid};
use tetlux_mesh::{Component, Field, TetMesh};
use tetlux_optics::emphasis::{Boundary, Contour, Emphasis, Steepness};
use tetlux_optics::{Light, TransferFunction};
use tetlux_render::{Frame, Model, table_specs};
use tetlux_scene::{
    Backend, Camera, CellProjection, Classification, Emphasized, Integrator, Interpolation, Lighting, Method, Order,
    Plan, Scene, View,
};
use tetlux_tables::TableCache;
use tetlux_tests::{
    Random, largest_error, mesh_of, mesh_with, orthographic, perspective, pixel_error, reference, reference_beside,
    renderer, transfer, transfer_of, white,
};

/// Of pictures: what single precision and the error of q's table make of a few dozen segments.
const TOLERANCE: f64 = 1e-4;

/// Of factors: roundings of sums over a few dozen cells.
const ROUNDING: f64 = 1e-11;

const SIZE: [u32; 2] = [40, 32];

fn gradient(range: Option<[f64; 2]>, power: f64) -> Emphasis {
    Emphasis { gradient: Some(Steepness { range, power }), ..Emphasis::default() }
}

fn contour(value: f64, width: f64) -> Emphasis {
    Emphasis { contour: Some(Contour { value, width }), ..Emphasis::default() }
}

fn boundary(sigma: Option<f64>, width: Option<f64>) -> Emphasis {
    Emphasis { boundary: Some(Boundary { sigma, width, threshold: 0.01 }), ..Emphasis::default() }
}

fn silhouette(power: f64) -> Emphasis {
    Emphasis { silhouette: Some(power), ..Emphasis::default() }
}

/// All of them at once.
fn all() -> Emphasis {
    Emphasis {
        silhouette: Some(0.5),
        contour: Some(Contour { value: 0.0, width: 2.0 }),
        boundary: Some(Boundary { sigma: Some(0.6), width: Some(2.0), threshold: 0.0 }),
        ..gradient(None, 0.5)
    }
}

/// A grid from -1 to 1 of so many steps a side.
fn cube(steps: usize, field: impl FnMut(DVec3) -> f64) -> TetMesh {
    mesh_of(&cuboid([steps; 3], Split::Six, [-DVec3::ONE, DVec3::ONE]), field)
}

/// Points of a cube's grid at which second derivatives are of gradients that are not one-sided.
fn inner(mesh: &TetMesh, steps: usize) -> Vec<(usize, DVec3)> {
    let most = 1.0 - 3.9 / steps as f64;
    let points = (0..mesh.points().len()).map(|i| (i, mesh.world(i as u32)));
    points.filter(|(_, p)| p.abs().max_element() < most).collect()
}

fn emphasized(mesh: &TetMesh, emphasis: Emphasis, transfer: &TransferFunction) -> Emphasized {
    let scalar = mesh.scalar(&mesh.fields()[0].name, Component::Magnitude).unwrap();
    Emphasized::new(&emphasis, transfer, mesh, &scalar).unwrap()
}

/// The factors of an emphasis at the points: the opacities of what is of opacity 1.
fn factors(mesh: &TetMesh, emphasis: Emphasis, view: &View) -> Vec<f64> {
    let colors = emphasized(mesh, emphasis, &white(&[[0.0, 1.0]])).seen(mesh, view);
    colors.iter().map(|color| color[3]).collect()
}

fn outside() -> Camera {
    perspective(DVec3::new(2.5, -3.0, 1.8), DVec3::ZERO, 40.0)
}

fn from_outside() -> View {
    outside().view(SIZE).unwrap()
}

#[test]
fn a_linear_field_is_steep_everywhere_and_a_boundary_everywhere() {
    let mesh = cube(4, |p| 2.0 * p.x - p.y + 2.0 * p.z);
    let all_are = |emphasis, expected: f64| {
        factors(&mesh, emphasis, &from_outside()).iter().all(|f| (f - expected).abs() < ROUNDING)
    };
    // Its gradient is 3 long.
    assert!(all_are(gradient(None, 2.0), 1.0));
    assert!(all_are(gradient(Some([1.0, 5.0]), 1.0), 0.5));
    assert!(all_are(gradient(Some([3.5, 5.0]), 1.0), 0.0));
    assert!(all_are(boundary(Some(0.5), Some(1.0)), 1.0));
    // Sigma is found where nothing bends, too.
    assert!(all_are(boundary(None, None), 1.0));
    // The contour is a plane; its distance is known at every vertex.
    for (i, f) in factors(&mesh, contour(1.0, 0.75), &from_outside()).into_iter().enumerate() {
        let p = mesh.world(i as u32);
        let apart = (2.0 * p.x - p.y + 2.0 * p.z - 1.0).abs() / 3.0;
        assert!((f - (1.0 - apart / 0.75).max(0.0)).abs() < ROUNDING, "{f} at {p}");
    }
}

#[test]
fn a_parabola_is_as_steep_as_it_is_far_from_its_axis() {
    let mesh = cube(8, |p| 0.5 * p.x * p.x);
    let found = factors(&mesh, gradient(Some([0.0, 2.0]), 1.0), &from_outside());
    for (i, p) in inner(&mesh, 8) {
        assert!((found[i] - 0.5 * p.x.abs()).abs() < ROUNDING, "{} at {p}", found[i]);
    }
}

#[test]
fn a_constant_field_shows_nothing_and_no_data_stay_apart() {
    let view = from_outside();
    let flat = cube(3, |_| 7.0);
    assert!(factors(&flat, gradient(None, 1.0), &view).iter().all(|&f| f == 0.0));
    assert!(factors(&flat, boundary(None, None), &view).iter().all(|&f| f == 0.0));
    assert!(factors(&flat, silhouette(2.0), &view).iter().all(|&f| f == 1.0), "there is no surface to turn away");
    let mut scene = scene_with(&flat, gradient(None, 1.0), outside());
    let plan = Plan::new(&scene, &flat, None).unwrap();
    assert_eq!((plan.cells.len(), plan.skips.transparent), (0, flat.cells().len()));
    let frame = renderer().render(&scene, &Model::new(&flat), &plan).unwrap();
    assert!(frame.image.pixels().iter().all(|&pixel| pixel == [0.0; 4]));
    // Missing values: nothing of them is drawn, all else is finite and as the reference has it.
    let holes =
        cube(5, |p| if p.distance(DVec3::new(0.2, 0.2, -0.2)) < 0.3 { f64::NAN } else { (2.0 * p.x).sin() + p.y });
    for emphasis in [gradient(None, 1.0), boundary(None, None), silhouette(1.0), all()] {
        let found = factors(&holes, emphasis, &view);
        assert!(found.iter().all(|f| (0.0..=1.0).contains(f)));
    }
    scene = scene_with(&holes, all(), outside());
    let truth = reference(&holes, &scene);
    for backend in [Backend::Cpu, Backend::Gpu] {
        let frame = drawn(&holes, &scene, Method { backend, ..Method::default() });
        let error = largest_error(frame.image.pixels(), &truth);
        assert!(error <= TOLERANCE, "{backend}: {error:.1e}");
    }
}

/// Half the width of the blurred step.
const WIDTH: f64 = 0.5;

/// The largest difference between the factors at a blurred step and their closed form, a tent of 1.5 over the distance.
fn boundary_error(steps: usize) -> f64 {
    // A step along a direction of the grid's steps, and one oblique to them.
    let directions = [DVec3::X, DVec3::new(2.0, -1.0, 2.0) / 3.0];
    let errors = directions.map(|along| {
        let mesh = cube(steps, |p| (along.dot(p) / WIDTH).tanh());
        let sigma = 0.4;
        let emphasis = Emphasis {
            boundary: Some(Boundary { sigma: Some(sigma), width: Some(1.5), threshold: 0.0 }),
            ..Emphasis::default()
        };
        let found = factors(&mesh, emphasis, &from_outside());
        let error = |(i, p): (usize, DVec3)| {
            // s' = (1 - s^2) / W, s'' = -2 s s' / W.
            let distance = 2.0 * sigma * sigma * (along.dot(p) / WIDTH).tanh() / WIDTH;
            (found[i] - (1.0 - distance.abs() / 1.5)).abs()
        };
        inner(&mesh, steps).into_iter().map(error).fold(0.0, f64::max)
    });
    errors[0].max(errors[1])
}

#[test]
fn a_boundary_is_found_where_it_is_the_better_the_finer_the_mesh() {
    let [coarse, fine] = [16, 32].map(boundary_error);
    println!("largest error of the factor: {coarse:.1e}, at half the steps {fine:.1e}");
    // Central differences: second order.
    assert!(fine < coarse / 3.0 && fine < 0.02, "{coarse:.1e} {fine:.1e}");
    // With what the field itself says, the middle is where a boundary is, and the flat ends are none.
    let mesh = cube(16, |p| (p.x / 0.2).tanh());
    let found = factors(&mesh, boundary(None, None), &from_outside());
    for (i, p) in inner(&mesh, 16) {
        let expected = [(0.0, 1.0), (0.75, 0.0)].into_iter().find(|(x, _)| *x == p.x.abs());
        assert!(expected.is_none_or(|(_, f)| (found[i] - f).abs() < ROUNDING), "{} at {p}", found[i]);
    }
}

#[test]
fn silhouettes_of_spheres() {
    // The gradient of r^2 is exact inside: the normal is the place itself.
    let mesh = cube(8, |p| p.length_squared());
    let eye = DVec3::new(2.5, -3.0, 1.8);
    for camera in [outside(), orthographic(eye, DVec3::ZERO, 1.5)] {
        let view = camera.view(SIZE).unwrap();
        let found = factors(&mesh, silhouette(1.5), &view);
        for (i, p) in inner(&mesh, 8).into_iter().filter(|(_, p)| *p != DVec3::ZERO) {
            let toward_eye = if view.orthographic { eye } else { eye - p };
            let expected = (1.0 - p.normalize().dot(toward_eye.normalize()).abs()).max(0.0).powf(1.5);
            assert!((found[i] - expected).abs() < 1e-6, "{} for {expected} at {p}", found[i]);
        }
    }
}

#[test]
fn only_silhouettes_depend_on_the_view() {
    let mesh = cube(3, |p| p.length_squared());
    let views = [outside(), orthographic(DVec3::X * 3.0, DVec3::ZERO, 1.0)].map(|camera| camera.view(SIZE).unwrap());
    let fog = white(&[[0.0, 1.0]]);
    let seen = |emphasis| views.map(|view| emphasized(&mesh, emphasis, &fog).seen(&mesh, &view));
    let still = emphasized(&mesh, gradient(None, 1.0), &fog);
    assert!(Arc::ptr_eq(&still.seen(&mesh, &views[0]), &still.seen(&mesh, &views[1])), "nothing is computed anew");
    let [a, b] = seen(silhouette(1.0));
    assert_ne!(a, b);
}

/// A grid with displaced points.
fn displaced() -> TetMesh {
    let mut parts = cuboid([5, 4, 4], Split::Six, [-DVec3::ONE, DVec3::ONE]);
    let mut random = Random::new(17);
    for p in &mut parts.points {
        *p += DVec3::new(random.between(-0.05, 0.05), random.between(-0.05, 0.05), random.between(-0.05, 0.05));
    }
    mesh_of(&parts, |p| (2.0 * p.x).sin() + p.y * p.z)
}

fn colors() -> TransferFunction {
    let color = [[-1.5, 0.9, 0.1, 0.2], [0.0, 0.2, 0.8, 0.3], [0.0, 0.1, 0.3, 1.0], [1.5, 1.0, 0.9, 0.2]];
    transfer(&color, &[[-1.5, 4.0], [-0.2, 1.0], [0.2, 8.0], [0.9, 1.0], [1.5, 5.0]])
}

fn scene_with(mesh: &TetMesh, emphasis: Emphasis, camera: Camera) -> Scene {
    let scene = tetlux_tests::scene(mesh, colors(), camera, SIZE);
    let emphasis = Some(emphasized(mesh, emphasis, transfer_of(&scene)));
    Scene { emphasis, ..scene }
}

fn planned(mesh: &TetMesh, scene: &Scene, method: Method) -> Plan {
    let scene = Scene { method, ..scene.clone() };
    Plan::new(&scene, mesh, renderer().device()).unwrap_or_else(|e| panic!("{method:?}: {e}"))
}

fn drawn(mesh: &TetMesh, scene: &Scene, method: Method) -> Frame {
    let plan = planned(mesh, scene, method);
    let cache = TableCache::new(1 << 24);
    let tables: Vec<_> = table_specs(scene, mesh, &plan).iter().map(|spec| cache.get_or_build(spec).unwrap()).collect();
    renderer().render_with(scene, &Model::new(mesh), &plan, &tables).unwrap_or_else(|e| panic!("{method:?}: {e}"))
}

/// A picture's truth, and by how much each pixel changes when its ray moves by a hundredth of a pixel; infinite on the
/// silhouette.
fn truth_and_slopes(mesh: &TetMesh, scene: &Scene) -> (Vec<[f64; 4]>, Vec<f64>) {
    let truth = reference(mesh, scene);
    let beside = [[0.01, 0.0], [-0.01, 0.0], [0.0, 0.01], [0.0, -0.01]].map(|by| reference_beside(mesh, scene, by));
    let slope = |i: usize| {
        let change = |b: &Vec<[f64; 4]>| {
            let edge = (b[i][3] == 0.0) != (truth[i][3] == 0.0);
            if edge { f64::INFINITY } else { (0..4).map(|c| (b[i][c] - truth[i][c]).abs()).fold(0.0, f64::max) }
        };
        beside.iter().map(change).fold(0.0, f64::max)
    };
    let slopes = (0..truth.len()).map(slope).collect();
    (truth, slopes)
}

#[test]
fn both_back_ends_and_every_projection_make_the_reference_s_picture() {
    let mesh = displaced();
    let eye = DVec3::new(2.5, -3.0, 1.8);
    let cameras =
        [outside(), orthographic(eye, DVec3::ZERO, 1.5), perspective(DVec3::new(0.2, 0.1, -0.3), DVec3::X, 90.0)];
    let gpu = Method { backend: Backend::Gpu, ..Method::default() };
    let by = |projection, interpolation| Method { projection, interpolation, ..gpu };
    let exact = [
        ("cpu", Method { backend: Backend::Cpu, ..Method::default() }),
        ("cpu, order pixel", Method { backend: Backend::Cpu, order: Order::Pixel, ..Method::default() }),
        ("pt", gpu),
        ("pt, q", Method { integrator: Integrator::Q, ..gpu }),
        ("pt, symmetric", Method { integrator: Integrator::Symmetric, ..gpu }),
        ("vicp", by(CellProjection::Vicp, Interpolation::Auto)),
        ("march", by(CellProjection::March, Interpolation::Auto)),
        ("tiles", by(CellProjection::Tiles, Interpolation::Auto)),
    ];
    // Over triangles, whose vertices rasterisers round.
    let rounded = [
        ("pt, perspective", by(CellProjection::Pt, Interpolation::Perspective)),
        ("gator", by(CellProjection::Gator, Interpolation::Perspective)),
    ];
    let emphases = [
        ("gradient", gradient(None, 1.5)),
        ("contour", contour(0.3, 0.4)),
        ("boundary", boundary(None, None)),
        ("all", all()),
    ];
    for (view, camera) in ["perspective", "orthographic", "inside"].into_iter().zip(cameras) {
        // Each alone from outside, all together from everywhere.
        let alone = if view == "perspective" { &emphases[..] } else { &emphases[3..] };
        for &(what, emphasis) in alone {
            let scene = scene_with(&mesh, emphasis, camera);
            let (truth, slopes) = truth_and_slopes(&mesh, &scene);
            assert!(truth.iter().filter(|pixel| pixel[3] > 0.05).count() > 20, "{what}, {view}: something is seen");
            let errors = |method: Method| {
                let image = drawn(&mesh, &scene, method).image;
                let errors = image.pixels().iter().zip(&truth).map(|(&p, &t)| pixel_error(p, t));
                errors.zip(&slopes).filter(|(_, slope)| slope.is_finite()).map(|(e, &s)| [e, e - s]).collect::<Vec<_>>()
            };
            let mut said = String::new();
            for (name, method) in exact {
                let error = errors(method).iter().map(|[e, _]| *e).fold(0.0, f64::max);
                said += &format!(" {name} {error:.0e};");
                assert!(error <= TOLERANCE, "{what}, {view}, {name}: {error:.1e}");
            }
            for (name, method) in rounded {
                let excess = errors(method).iter().filter(|[_, excess]| *excess > TOLERANCE).count();
                said += &format!(" {name} {excess} pixels off;");
                assert!(excess <= truth.len() / 100, "{what}, {view}, {name}: {excess} pixels");
            }
            println!("{what}, {view}:{said}");
        }
    }
}

#[test]
fn a_planted_difference_is_seen() {
    let mesh = displaced();
    let scene = scene_with(&mesh, gradient(None, 1.0), outside());
    let truth = reference(&mesh, &scene);
    for backend in [Backend::Cpu, Backend::Gpu] {
        let plan = planned(&mesh, &scene, Method { backend, ..Method::default() });
        let error = |plan: &Plan| {
            largest_error(renderer().render(&scene, &Model::new(&mesh), plan).unwrap().image.pixels(), &truth)
        };
        assert!(error(&plan) <= TOLERANCE);
        let short = Plan { colors: Some(vec![[1.0; 4]].into()), ..plan.clone() };
        assert!(renderer().render(&scene, &Model::new(&mesh), &short).unwrap_err().to_string().contains("every point"));
        // One vertex a quarter denser.
        let mut colors = plan.colors.as_ref().unwrap().to_vec();
        let seen = (0..colors.len()).max_by(|&a, &b| colors[a][3].total_cmp(&colors[b][3])).unwrap();
        colors[seen][3] *= 1.25;
        let planted = Plan { colors: Some(colors.into()), ..plan };
        assert!(error(&planted) > 10.0 * TOLERANCE, "{backend}: {:.1e}", error(&planted));
    }
}

#[test]
fn leaving_out_cells_of_clear_vertices_changes_nothing() {
    let mesh = displaced();
    for emphasis in [contour(0.3, 0.2), boundary(Some(1.5), Some(0.3))] {
        let scene = scene_with(&mesh, emphasis, outside());
        for backend in [Backend::Cpu, Backend::Gpu] {
            let culled = planned(&mesh, &scene, Method { backend, ..Method::default() });
            let whole = Plan { cells: (0..mesh.cells().len() as u32).collect(), ..culled.clone() };
            assert!(culled.skips.transparent > 10, "{} cells are left out", culled.skips.transparent);
            assert!(culled.cells.len() > 20);
            let [a, b] =
                [culled, whole].map(|plan| renderer().render(&scene, &Model::new(&mesh), &plan).unwrap().image);
            assert_eq!(a, b, "{backend}");
        }
    }
}

#[test]
fn every_integrator_of_linear_colours_draws_an_emphasis() {
    let mesh = displaced();
    let scene = scene_with(&mesh, all(), outside());
    let alpha = |frame: &Frame| frame.image.pixels().iter().map(|p| p[3]).sum::<f32>();
    let exact = alpha(&drawn(&mesh, &scene, Method { backend: Backend::Gpu, ..Method::default() }));
    for integrator in [Integrator::Average, Integrator::Linear, Integrator::Psi, Integrator::Direct] {
        for backend in [Backend::Gpu, Backend::Cpu] {
            let method = Method { integrator, backend, ..Method::default() };
            if method.refusal().is_none() {
                let frame = drawn(&mesh, &scene, method);
                assert!(frame.image.pixels().iter().flatten().all(|c| c.is_finite()));
                assert!((alpha(&frame) / exact - 1.0).abs() < 0.05, "{integrator} {backend}");
            }
        }
    }
}

#[test]
fn an_emphasis_takes_one_buffer_in_place_of_the_function_and_other_scenes_none() {
    let mesh = displaced();
    let scene = scene_with(&mesh, all(), outside());
    let plain = Scene { emphasis: None, ..scene.clone() };
    let vertex = Method { backend: Backend::Gpu, classification: Classification::Vertex, ..Method::default() };
    // The same cells, so that nothing else differs.
    let taken = |scene: &Scene| {
        let cells = (0..mesh.cells().len() as u32).collect();
        let plan = Plan { cells, ..planned(&mesh, scene, vertex) };
        renderer().render(scene, &Model::new(&mesh), &plan).unwrap().resources
    };
    let (with, without) = (taken(&scene), taken(&plain));
    assert_eq!((with.pipelines, with.buffers, with.textures), (without.pipelines, without.buffers, without.textures));
    // 16 bytes a point, and as much for cells without data, for 48 a piece: of five intervals between six control points,
    // and the ends.
    let pieces = 48 * (transfer_of(&scene).control_points().len() as u64 - 1 + 2);
    assert_eq!(with.bytes + pieces, without.bytes + 16 * (mesh.points().len() as u64 + 1));
    assert!(planned(&mesh, &plain, vertex).colors.is_none());
    assert!(planned(&mesh, &plain, Method::default()).to_string().contains("skipped: nothing asks for them"));
}

#[test]
fn light_goes_with_an_emphasis() {
    let mesh = displaced();
    let mut scene = scene_with(&mesh, gradient(None, 1.0), outside());
    let light = Light::new(Some([0.4, -0.2, 1.0]), [0.3, 0.7, 0.3], 10.0, 0.0).unwrap();
    scene.lighting = Some(Lighting { light, gradients: mesh.vertex_gradients(&scene.scalar) });
    let truth = reference(&mesh, &scene);
    for max_error in [1e-2, 1e-3] {
        let method = Method { max_error, ..Method::default() };
        let scene = Scene { method, ..scene.clone() };
        let plan = Plan::new(&scene, &mesh, renderer().device()).unwrap();
        assert_eq!((plan.backend, plan.classification), (Backend::Cpu, Classification::Vertex));
        let image = renderer().render(&scene, &Model::new(&mesh), &plan).unwrap().image;
        let error = largest_error(image.pixels(), &truth);
        assert!(error <= max_error, "{error:.1e} for {max_error:e}");
    }
}

#[test]
fn classification_at_the_vertices_is_one_picture_on_both_back_ends() {
    let points = displaced();
    let mut random = Random::new(4);
    let by_cell = cuboid([3, 3, 2], Split::Six, [-DVec3::ONE, DVec3::ONE]);
    let values = by_cell.cells.iter().map(|_| random.between(-1.5, 1.5)).collect();
    let by_cell = mesh_with(&by_cell, Field::cell("s", 1, values));
    for mesh in [points, by_cell] {
        let scene = tetlux_tests::scene(&mesh, colors(), outside(), SIZE);
        let [gpu, cpu] = [Backend::Gpu, Backend::Cpu].map(|backend| {
            drawn(&mesh, &scene, Method { backend, classification: Classification::Vertex, ..Method::default() }).image
        });
        let pairs = gpu.pixels().iter().flatten().zip(cpu.pixels().iter().flatten());
        let apart = pairs.map(|(a, b)| f64::from((a - b).abs())).fold(0.0, f64::max);
        assert!(apart <= TOLERANCE, "{apart:.1e}");
        assert!(cpu.pixels().iter().filter(|p| p[3] > 0.5).count() > 100);
    }
}

#[test]
fn what_cannot_go_with_an_emphasis_is_refused_in_words() {
    let mesh = displaced();
    let scene = scene_with(&mesh, all(), outside());
    let says = |scene: &Scene| match Plan::new(scene, &mesh, renderer().device()) {
        Ok(plan) => plan.to_string(),
        Err(error) => error.to_string(),
    };
    let with = |method: Method| says(&Scene { method, ..scene.clone() });
    for classification in [Classification::PostExact, Classification::PostClip] {
        let said = with(Method { classification, ..Method::default() });
        assert!(said.contains(&classification.to_string()) && said.contains("use vertex"), "{said}");
    }
    assert!(with(Method { integrator: Integrator::Preint, ..Method::default() }).contains("vertex"));
    assert!(with(Method { projection: CellProjection::Balanced, ..Method::default() }).contains("balanced"));
    let two = Scene {
        second: Some(scene.scalar.clone()),
        classification: tetlux_optics::Classification::TwoFields(colors()),
        ..scene.clone()
    };
    assert!(says(&two).contains("one field"));
    // What is done is said.
    let plan = with(Method::default());
    assert!(plan.contains("silhouettes, power 0.5") && plan.contains("second derivatives"), "{plan}");
    // Data of the cells have no derivatives at the vertices.
    let parts = cuboid([1, 1, 1], Split::Six, [DVec3::ZERO, DVec3::ONE]);
    let by_cell = mesh_with(&parts, Field::cell("heat", 1, vec![1.0; 6]));
    let scalar = by_cell.scalar("heat", Component::Magnitude).unwrap();
    let error = Emphasized::new(&all(), &colors(), &by_cell, &scalar).unwrap_err().to_string();
    assert!(error.contains("\"heat\"") && error.contains("[emphasis]"), "{error}");
}
