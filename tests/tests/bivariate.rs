//! Pictures of two fields, widgets, images and light against the f64 reference, to every budget.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test's helpers fail and tell like the test")]

use glam::DVec3;
use tetlux_mesh::procedural::{Split, cuboid, three_cycle};
use tetlux_mesh::{Component, Field, TetMesh};
use tetlux_optics::widget::{BivariateFunction, Rectangle, Shape, WaveProfile, Widget};
use tetlux_optics::{Classification, ImageFunction, Light};
use tetlux_render::{Frame, Model};
use tetlux_scene::{Backend, Camera, Lighting, Method, Order, Plan, Scene};
use tetlux_tests::{Random, largest_error, orthographic, perspective, reference, renderer, transfer};

const BUDGETS: [f64; 3] = [1e-2, 1e-3, 1e-4];

/// Of functions without a budget: single-precision scalars and weights, where a ray grazes a step.
const EXACT: f64 = 3e-5;

const SIZE: [u32; 2] = [26, 20];

/// A grid with displaced points and two fields.
fn mesh() -> TetMesh {
    let mut parts = cuboid([4, 3, 3], Split::Six, [-DVec3::ONE, DVec3::ONE]);
    let mut random = Random::new(7);
    for p in &mut parts.points {
        *p += DVec3::new(random.between(-0.05, 0.05), random.between(-0.05, 0.05), random.between(-0.05, 0.05));
    }
    let fields = vec![
        Field::point("x", 1, parts.sample(|p| (2.0 * p.x).sin() + p.y * p.z)),
        Field::point("y", 1, parts.sample(|p| 5.0 + p.z + 0.5 * (2.0 * p.y).cos())),
        Field::cell("by cell", 1, (0..parts.cells.len()).map(|_| random.between(4.0, 6.5)).collect()),
    ];
    TetMesh::assemble(&parts.points, &parts.cells, fields).unwrap()
}

fn cameras() -> [Camera; 3] {
    let (outside, inside) = (DVec3::new(2.5, -3.0, 1.8), DVec3::new(0.2, 0.1, -0.3));
    [
        perspective(outside, DVec3::ZERO, 40.0),
        orthographic(outside, DVec3::ZERO, 1.6),
        perspective(inside, DVec3::X, 90.0),
    ]
}

fn widget(shape: Shape, support: Option<Rectangle>, color: [f64; 3]) -> Widget {
    Widget::new(shape, support, 2.5, color).unwrap()
}

fn wave(profile: WaveProfile, frequency: [f64; 2]) -> Shape {
    Shape::Wave { profile, frequency, offset: 0.2 }
}

/// Each shape, every one in its place.
fn shapes() -> [(&'static str, Widget); 5] {
    let lower = Rectangle { s: [-1.5, 0.3], g: [4.0, 5.6] };
    let upper = Rectangle { s: [-0.4, 1.7], g: [4.9, 6.6] };
    let gaussian = Shape::Gaussian { center: [0.4, 5.3], sigma: [0.4, 0.3] };
    [
        ("uniform", widget(Shape::Uniform, Some(lower), [0.1, 0.3, 1.0])),
        ("gaussian", widget(gaussian, None, [1.0, 0.2, 0.1])),
        ("triangle", widget(wave(WaveProfile::Triangle, [1.1, 0.3]), None, [0.2, 0.9, 0.2])),
        ("sine", widget(wave(WaveProfile::AbsSine, [0.2, 1.3]), Some(upper), [0.9, 0.8, 0.1])),
        ("sine-squared", widget(wave(WaveProfile::SineSquared, [2.0, 0.0]), Some(upper), [0.7, 0.1, 0.8])),
    ]
}

fn all_widgets() -> Classification {
    Classification::Widgets(BivariateFunction { widgets: shapes()[..4].iter().map(|(_, w)| *w).collect() })
}

fn two_fields() -> Classification {
    let color = [[-1.5, 0.9, 0.1, 0.2], [0.0, 0.2, 0.8, 0.3], [0.0, 0.1, 0.3, 1.0], [1.5, 1.0, 0.9, 0.2]];
    let opacity = [[4.2, 1.0], [4.6, 0.0], [5.0, 0.0], [5.2, 3.0], [5.4, 0.2], [6.0, 0.2], [6.0, 1.5]];
    Classification::TwoFields(transfer(&color, &opacity))
}

fn one_field() -> Classification {
    let color = [[-1.5, 0.9, 0.1, 0.2], [0.0, 0.2, 0.8, 0.3], [0.0, 0.1, 0.3, 1.0], [1.5, 1.0, 0.9, 0.2]];
    Classification::OneField(transfer(&color, &[[-1.0, 1.5], [0.0, 0.0], [0.4, 0.0], [0.6, 3.0], [1.0, 0.5]]))
}

fn image() -> Classification {
    let mut random = Random::new(11);
    let mut channel = |most: f64| random.between(-0.2 * most, most).max(0.0) as f32;
    let texels = (0..30).map(|_| [channel(1.0), channel(1.0), channel(1.0), channel(3.0)]).collect();
    Classification::Image(ImageFunction::new(6, texels, [[-1.4, 1.6], [4.4, 6.4]]).unwrap())
}

fn scene(mesh: &TetMesh, second: &str, classification: Classification, light: Option<Light>, camera: Camera) -> Scene {
    let scalar = mesh.scalar("x", Component::Magnitude).unwrap();
    Scene {
        lighting: light.map(|light| Lighting { light, gradients: mesh.vertex_gradients(&scalar) }),
        surfaces: Vec::new(),
        scalar,
        second: Some(mesh.scalar(second, Component::Magnitude).unwrap()),
        classification,
        unit_distance: 1.0,
        camera,
        size: SIZE,
        background: [0.0; 3],
        method: Method::default(),
    }
}

fn frame(mesh: &TetMesh, scene: &Scene, order: Order, max_error: f64) -> Frame {
    let scene = Scene { method: Method { order, max_error, ..Method::default() }, ..scene.clone() };
    let plan = Plan::new(&scene, mesh, renderer().device()).unwrap();
    assert_eq!(plan.backend, Backend::Cpu, "{plan}");
    renderer().render(&scene, &Model::new(mesh), &plan).unwrap()
}

/// Draws to every budget; gives the errors and the mean pieces.
fn holds(name: &str, mesh: &TetMesh, scene: &Scene, order: Order) -> [[f64; 2]; 3] {
    let truth = reference(mesh, scene);
    let seen = truth.iter().filter(|pixel| pixel[3] > 0.05).count();
    assert!(seen >= 8, "{name}: {seen} pixels see something");
    let drawn = BUDGETS.map(|budget| {
        let frame = frame(mesh, scene, order, budget);
        [largest_error(frame.image.pixels(), &truth), frame.spent.unwrap().mean()]
    });
    println!(
        "{name:<40} errors {:.1e} {:.1e} {:.1e}, pieces {:.2} {:.2} {:.2}",
        drawn[0][0], drawn[1][0], drawn[2][0], drawn[0][1], drawn[1][1], drawn[2][1]
    );
    for ([error, _], budget) in drawn.iter().zip(BUDGETS) {
        assert!(*error <= budget, "{name}: {error:.1e} for {budget:e}");
    }
    assert!(drawn.is_sorted_by(|a, b| a[1] <= b[1]), "{name}: a looser budget takes no more pieces");
    drawn
}

#[test]
fn every_function_to_every_budget() {
    let mesh = mesh();
    for (view, camera) in ["perspective", "orthographic", "inside"].into_iter().zip(cameras()) {
        let error = |classification, second| {
            let scene = scene(&mesh, second, classification, None, camera);
            holds(&format!("two fields ({second}), {view}"), &mesh, &scene, Order::Exact)[0][0]
        };
        assert!(error(two_fields(), "y") <= EXACT && error(two_fields(), "by cell") <= EXACT);
        for (name, widget) in shapes() {
            let alone = Classification::Widgets(BivariateFunction { widgets: vec![widget] });
            let drawn = holds(&format!("{name}, {view}"), &mesh, &scene(&mesh, "y", alone, None, camera), Order::Exact);
            assert!(drawn[0][0] <= EXACT, "one colour is exact");
        }
        for (name, function) in [("four widgets", all_widgets()), ("image", image())] {
            for second in ["y", "by cell"] {
                let scene = scene(&mesh, second, function.clone(), None, camera);
                let drawn = holds(&format!("{name} ({second}), {view}"), &mesh, &scene, Order::Exact);
                assert!(drawn[0][1] < drawn[2][1], "a looser budget takes fewer pieces");
            }
        }
    }
}

#[test]
fn light_and_silhouettes_to_every_budget() {
    let mesh = mesh();
    let side = Some([0.4, -0.2, 1.0]);
    let [perspective, orthographic, inside] = cameras();
    for (name, light, function, camera) in [
        ("headlight, one field", Light::new(None, [0.3, 0.7, 0.2], 20.0, 0.0), one_field(), perspective),
        ("from the side, one field", Light::new(side, [0.2, 0.8, 0.5], 30.0, 0.0), one_field(), orthographic),
        ("headlight, two fields", Light::new(None, [0.3, 0.7, 0.0], 1.0, 0.0), two_fields(), inside),
        ("from the side, four widgets", Light::new(side, [0.2, 0.8, 0.3], 10.0, 0.0), all_widgets(), perspective),
        ("headlight, image", Light::new(None, [0.3, 0.7, 0.2], 20.0, 0.0), image(), orthographic),
        ("silhouette, one field", Light::new(None, [1.0, 0.0, 0.0], 1.0, 2.0), one_field(), inside),
        ("silhouette, four widgets", Light::new(None, [1.0, 0.0, 0.0], 1.0, 3.0), all_widgets(), orthographic),
        ("all, four widgets", Light::new(side, [0.3, 0.6, 0.3], 15.0, 1.5), all_widgets(), perspective),
    ] {
        let scene = scene(&mesh, "y", function, Some(light.unwrap()), camera);
        holds(name, &mesh, &scene, Order::Exact);
    }
}

#[test]
fn segments_sorted_in_every_pixel() {
    let mesh = mesh();
    for camera in &cameras()[..2] {
        let lit =
            scene(&mesh, "y", all_widgets(), Some(Light::new(None, [0.3, 0.7, 0.2], 20.0, 1.0).unwrap()), *camera);
        holds("four widgets, lit, order pixel", &mesh, &lit, Order::Pixel);
    }
    // Three cells each of which hides a part of the next: no order is right but that of every pixel.
    let parts = three_cycle();
    let fields = vec![Field::cell("x", 1, vec![0.0, 1.0, 2.0]), Field::cell("y", 1, vec![2.0, 1.0, 3.0])];
    let cycle = TetMesh::assemble(&parts.points, &parts.cells, fields).unwrap();
    let color = [[0.0, 1.0, 0.0, 0.0], [1.0, 0.0, 1.0, 0.0], [2.0, 0.0, 0.0, 1.0]];
    let function = Classification::TwoFields(transfer(&color, &[[0.0, 0.0], [3.0, 3.0]]));
    let camera = perspective(DVec3::splat(12.0), DVec3::splat(0.5), 14.0);
    let mut scene = scene(&cycle, "y", function, None, camera);
    scene.size = [48, 48];
    assert!(holds("cycle, order exact", &cycle, &scene, Order::Exact)[0][0] <= EXACT);
    let wrong = largest_error(frame(&cycle, &scene, Order::Centroid, 1e-3).image.pixels(), &reference(&cycle, &scene));
    assert!(wrong > 1e-2, "centroids give the cycle no order: {wrong:.1e}");
}

#[test]
fn leaving_cells_out_changes_no_picture() {
    let mesh = mesh();
    let mut skipped = 0;
    let mut same = |function: Classification, camera| {
        let scene = scene(&mesh, "y", function, None, camera);
        let culled = Plan::new(&scene, &mesh, renderer().device()).unwrap();
        let whole = Plan { cells: (0..mesh.cells().len() as u32).collect(), ..culled.clone() };
        skipped += culled.skips.transparent;
        let [a, b] = [culled, whole].map(|plan| renderer().render(&scene, &Model::new(&mesh), &plan).unwrap().image);
        let truth: Vec<[f64; 4]> = a.pixels().iter().map(|pixel| pixel.map(f64::from)).collect();
        largest_error(b.pixels(), &truth)
    };
    for camera in cameras() {
        assert_eq!(same(two_fields(), camera), 0.0);
        assert_eq!(same(image(), camera), 0.0);
        for (name, widget) in shapes() {
            let apart = same(Classification::Widgets(BivariateFunction { widgets: vec![widget] }), camera);
            // A Gaussian's tail is left out where it falls below 1e-12 of the peak.
            assert!(apart <= if name == "gaussian" { 1e-7 } else { 0.0 }, "{name}: {apart:.1e}");
        }
    }
    assert!(skipped > 100, "{skipped} cells are left out");
}

#[test]
fn other_ways_are_refused_with_the_remedy() {
    let mesh = mesh();
    let says = |method: Method, light| {
        let scene = Scene { method, ..scene(&mesh, "y", two_fields(), light, cameras()[0]) };
        Plan::new(&scene, &mesh, renderer().device()).map(|plan| plan.to_string()).unwrap_or_else(|e| e.to_string())
    };
    assert!(says(Method { backend: Backend::Gpu, ..Method::default() }, None).contains("--backend cpu"));
    let average = Method { integrator: tetlux_scene::Integrator::Average, ..Method::default() };
    assert!(says(average, None).contains("average"));
    let psi = Method { integrator: tetlux_scene::Integrator::Psi, ..Method::default() };
    assert!(says(psi, None).contains("psi"));
    let plan = says(Method::default(), None);
    assert!(plan.contains("two fields needs it") && plan.contains("skipped: nothing asks for them"), "{plan}");
    let lit = says(Method::default(), Some(Light::new(None, [0.3, 0.7, 0.2], 20.0, 0.0).unwrap()));
    assert!(lit.contains("computed: light"), "{lit}");
}
