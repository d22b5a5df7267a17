//! Every skip of the plan: it is told, it can be switched off, and the picture is the same with it and without.

use glam::DVec3;
use tetlux_mesh::TetMesh;
use tetlux_mesh::procedural::{Split, cuboid};
use tetlux_optics::TransferFunction;
use tetlux_order::{Orderer, Thorough};
use tetlux_render::{Model, Renderer};
use tetlux_scene::{Backend, Fate, Method, Order, Plan, Scene, Skip};
use tetlux_tests::{mesh_of, perspective, renderer, scene, transfer, white};

use super::{largest_difference, planned, same_bits};

/// Roundings of some thirty segments a pixel, composited in another order or cut elsewhere.
const ROUNDING: f64 = 1e-5;

const BACKENDS: [Backend; 2] = [Backend::Cpu, Backend::Gpu];

/// A grid of 1296 cells, of which the camera sees a part; convex.
fn mesh() -> TetMesh {
    mesh_of(&cuboid([6, 6, 6], Split::Six, [DVec3::splat(-1.0), DVec3::ONE]), |p| (2.0 * p.x).sin() + 0.5 * p.y * p.z)
}

fn seen(mesh: &TetMesh, transfer: TransferFunction, method: Method) -> Scene {
    let camera = perspective(DVec3::new(2.6, -3.1, 1.7), DVec3::new(0.3, 0.2, 0.1), 28.0);
    Scene { method, unit_distance: 0.3, ..scene(mesh, transfer, camera, [64, 48]) }
}

/// Clear below 0, dense above; luminance constant above 1/2.
fn partly_clear() -> TransferFunction {
    transfer(
        &[[-1.5, 0.1, 0.4, 0.9], [0.5, 0.9, 0.5, 0.2], [1.5, 0.9, 0.5, 0.2]],
        &[[0.0, 0.0], [0.3, 2.0], [1.0, 0.5], [1.5, 4.0]],
    )
}

/// The pictures with a skip and without it, and the cells that it spares.
fn both(mesh: &TetMesh, with: &Scene, skip: Skip, name: &str) -> (tetlux_image::Image, tetlux_image::Image, usize) {
    let mut without = with.clone();
    without.method.no_skip = without.method.no_skip.with(skip);
    let ((plan, frame), (plan_without, frame_without)) = (planned(mesh, with), planned(mesh, &without));
    let line = |plan: &Plan| plan.lines.iter().find(|line| line.skip == skip).cloned().unwrap();
    let (line, off) = (line(&plan), line(&plan_without));
    assert!(matches!(line.fate, Fate::Skipped | Fate::Later), "{name}: {line:?}");
    assert!(!line.why.is_empty());
    assert_eq!((off.fate, off.cells), (Fate::Kept, 0), "{name}");
    // Some of the cells may be skipped for another reason too.
    let more = plan_without.cells.len() - plan.cells.len();
    assert!(more <= line.cells && (more > 0) == (line.cells > 0), "{name}: {more} cells more");
    (frame.image, frame_without.image, line.cells)
}

#[test]
fn a_picture_is_the_same_bit_for_bit_without_what_it_does_not_need() {
    let mesh = mesh();
    for backend in BACKENDS {
        let scene = seen(&mesh, partly_clear(), Method { backend, ..Method::default() });
        for (skip, on, spares_cells) in [
            (Skip::Transparent, &BACKENDS[..], true),
            (Skip::Outside, &BACKENDS, true),
            (Skip::LastOrder, &BACKENDS, false),
            (Skip::Gaps, &BACKENDS, false),
            (Skip::Components, &BACKENDS, false),
            (Skip::Weights, &BACKENDS[..1], false),
            (Skip::Gradients, &BACKENDS, false),
            (Skip::Tables, &BACKENDS, false),
            (Skip::Pipelines, &BACKENDS[1..], false),
            (Skip::Uploads, &BACKENDS, false),
        ] {
            if on.contains(&backend) {
                let name = format!("{skip} on {backend}");
                let (with, without, cells) = both(&mesh, &scene, skip, &name);
                assert!(same_bits(&with, &without), "{name}: {:.1e}", largest_difference(&with, &without));
                assert_eq!(cells > 10, spares_cells, "{name}: {cells} cells");
                assert!(with.pixels().iter().filter(|p| p[3] > 0.5).count() > 300, "{name}: something is seen");
            }
        }
    }
}

#[test]
fn a_picture_is_the_same_but_for_rounding_in_any_order_or_cut_anywhere() {
    let mesh = mesh();
    let one_luminance = white(&[[-0.5, 0.0], [1.5, 1.5]]);
    for (skip, transfer, backends) in
        [(Skip::Order, one_luminance, &BACKENDS[..]), (Skip::Cuts, partly_clear(), &BACKENDS[..1])]
    {
        for &backend in backends {
            let scene = seen(&mesh, transfer.clone(), Method { backend, ..Method::default() });
            let (with, without, _) = both(&mesh, &scene, skip, &format!("{skip} on {backend}"));
            let difference = largest_difference(&with, &without);
            assert!(difference < ROUNDING, "{skip} on {backend}: {difference:.1e}");
        }
    }
}

#[test]
fn what_the_budget_spares_changes_no_pixel_by_more_than_its_share() {
    let mesh = mesh();
    // A haze over half the mesh, and a dense half.
    let haze = transfer(
        &[[-1.5, 0.2, 0.6, 0.9], [1.5, 0.9, 0.5, 0.1]],
        &[[-1.5, 2e-4], [0.0, 2e-4], [0.2, 20.0], [1.5, 30.0]],
    );
    // A curve of 129 colours.
    let nodes: Vec<[f64; 4]> = (0..=128)
        .map(|k| f64::from(k) / 128.0)
        .map(|t| [3.0 * t - 1.5, t * t, (3.0 * t).sin().abs(), 1.0 - t])
        .collect();
    let many = transfer(&nodes, &[[-1.5, 0.5], [1.5, 2.0]]);
    let budget = 1e-1;
    for (skip, transfer, share) in [(Skip::Faint, &haze, 0.1), (Skip::Opaque, &haze, 0.1), (Skip::Cuts, &many, 0.4)] {
        // Nothing else is spent.
        let off = Skip::ALL
            .iter()
            .copied()
            .filter(|other| *other != skip && matches!(other, Skip::Faint | Skip::Opaque | Skip::Cuts | Skip::Order));
        let integrator = tetlux_scene::Integrator::Direct;
        let method = Method {
            backend: Backend::Cpu,
            max_error: budget,
            integrator,
            no_skip: off.collect(),
            ..Method::default()
        };
        let scene = seen(&mesh, transfer.clone(), method);
        let (with, without, cells) = both(&mesh, &scene, skip, &skip.to_string());
        let difference = largest_difference(&with, &without);
        assert!(difference > 0.0, "{skip}: something is spared");
        assert!(difference < share * budget + ROUNDING, "{skip}: {difference:.1e}");
        assert_eq!(cells > 100, skip == Skip::Faint, "{skip}: {cells} cells");
    }
}

#[test]
fn the_second_picture_of_a_view_is_spared_the_order_and_the_mesh() {
    let mesh = mesh();
    for backend in BACKENDS {
        let scene = seen(&mesh, partly_clear(), Method { backend, ..Method::default() });
        let (renderer, model) = (Renderer::new(), Model::new(&mesh));
        let frame = |scene: &Scene| {
            let plan = Plan::new(scene, &mesh, renderer.device()).unwrap();
            renderer.render(scene, &model, &plan).unwrap()
        };
        let (first, second) = (frame(&scene), frame(&scene));
        assert_eq!([first.order.reused, first.mesh_reused], [false; 2]);
        assert_eq!([second.order.reused, second.mesh_reused], [true; 2]);
        assert!(same_bits(&first.image, &second.image));
        // Another function on the same field, from the same eye.
        let clear = seen(&mesh, white(&[[0.0, 0.0], [1.0, 1.0]]), scene.method);
        let clear = Scene { method: Method { order: Order::Exact, ..clear.method }, ..clear };
        let third = frame(&clear);
        assert_eq!([third.order.reused, third.mesh_reused], [true; 2]);
        assert!(same_bits(&third.image, &planned(&mesh, &clear).1.image), "as if rendered alone");
        // Another eye, then the first again.
        let turned = Scene { camera: scene.camera.turned(10.0), ..scene.clone() };
        assert!(!frame(&turned).order.reused);
        assert!(!frame(&scene).order.reused);
        assert!(same_bits(&frame(&scene).image, &first.image));
        // Other values: the mesh is prepared anew.
        let mut other = scene.clone();
        other.scalar.values[17] += 0.25;
        let changed = frame(&other);
        assert!(changed.order.reused && !changed.mesh_reused);
        assert!(!same_bits(&changed.image, &first.image));
    }
}

#[test]
fn a_thorough_search_finds_the_same_order() {
    let mesh = mesh();
    let facts = tetlux_order::Facts::new(&mesh);
    assert!(facts.convex());
    let view = seen(&mesh, partly_clear(), Method::default()).camera.view([64, 48]).unwrap();
    let sampling = tetlux_render::sampling(&view);
    let mut orderer = Orderer::new();
    let plain = orderer.order(&mesh, &facts, &sampling, tetlux_order::Method::Exact).clone();
    assert!(!plain.report.gap_pass && !plain.report.component_search);
    for (thorough, expected) in [
        (Thorough { again: true, ..Thorough::default() }, [false, false]),
        (Thorough { gaps: true, ..Thorough::default() }, [true, false]),
        (Thorough { components: true, ..Thorough::default() }, [false, true]),
    ] {
        orderer.set_thorough(thorough);
        for _ in 0..2 {
            let order = orderer.order(&mesh, &facts, &sampling, tetlux_order::Method::Exact);
            assert_eq!([order.report.gap_pass, order.report.component_search], expected);
            assert_eq!(order.groups, plain.groups);
            if !thorough.components {
                assert_eq!(order.cells, plain.cells);
            }
            assert!(!(order.report.reused && thorough.again));
        }
    }
}

#[test]
fn every_line_says_why() {
    let mesh = mesh();
    let scene = seen(&mesh, partly_clear(), Method::default());
    let plan = Plan::new(&scene, &mesh, renderer().device()).unwrap();
    let named: Vec<Skip> = plan.lines.iter().map(|line| line.skip).collect();
    assert_eq!(named, Skip::ALL);
    assert!(plan.lines.iter().all(|line| !line.why.is_empty()));
    let cells: usize = plan.lines.iter().map(|line| line.cells).sum();
    assert_eq!(plan.cells.len() + cells + plan.skips.flat + plan.skips.no_data, mesh.cells().len());
}
