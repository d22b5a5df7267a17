//! Pictures of two fields, widgets, images and light against the f64 reference, to every budget, by both back ends.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test's helpers fail and tell like the test")]

use std::sync::Arc;

use glam::DVec3;
use tetlux_mesh::procedural::{Split, cuboid, three_cycle};
use tetlux_mesh::{Component, Field, TetMesh};
use tetlux_optics::widget::{BivariateFunction, Rectangle, Shape, WaveProfile, Widget};
use tetlux_optics::{Classification, ImageFunction, Light, NoData};
use tetlux_render::{Frame, Model, Resources, table_specs};
use tetlux_scene::{
    Backend, Camera, CellProjection, Integrator, Interpolation, Lighting, Method, Order, Plan, Planner, Scene,
    SceneFile, SkipSet, TablePrecision, Target,
};
use tetlux_tables::{Table, TableSpec};
use tetlux_tests::{Random, largest_error, orthographic, perspective, pixel_error, reference, renderer, transfer};

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
        emphasis: None,
        surfaces: Vec::new(),
        scalar,
        second: Some(mesh.scalar(second, Component::Magnitude).unwrap()),
        classification,
        no_data: NoData::default(),
        unit_distance: 1.0,
        camera,
        size: SIZE,
        background: [0.0; 3],
        method: Method::default(),
    }
}

const CPU: Method = method(Backend::Cpu, Order::Exact, CellProjection::Auto);
const CPU_PIXEL: Method = method(Backend::Cpu, Order::Pixel, CellProjection::Auto);
const GPU: Method = method(Backend::Gpu, Order::Exact, CellProjection::Pt);
const GPU_VICP: Method = method(Backend::Gpu, Order::Exact, CellProjection::Vicp);
const GPU_MARCH: Method = method(Backend::Gpu, Order::Auto, CellProjection::March);

const fn method(backend: Backend, order: Order, projection: CellProjection) -> Method {
    Method {
        backend,
        order,
        projection,
        interpolation: Interpolation::Auto,
        integrator: Integrator::Auto,
        classification: tetlux_scene::Classification::Auto,
        table_precision: TablePrecision::Auto,
        target: Target::Auto,
        pieces: None,
        max_error: 1e-3,
        no_skip: SkipSet::NONE,
    }
}

fn frame(mesh: &TetMesh, scene: &Scene, method: Method) -> Frame {
    let scene = Scene { method, ..scene.clone() };
    let plan = Plan::new(&scene, mesh, renderer().device()).unwrap();
    assert_eq!(plan.backend, method.backend, "{plan}");
    renderer().render(&scene, &Model::new(mesh), &plan).unwrap()
}

/// Draws to every budget by each method; gives the errors and the mean pieces, the worst of any method.
fn holds(name: &str, mesh: &TetMesh, scene: &Scene, methods: &[Method]) -> [[f64; 2]; 3] {
    let truth = reference(mesh, scene);
    let seen = truth.iter().filter(|pixel| pixel[3] > 0.05).count();
    assert!(seen >= 8, "{name}: {seen} pixels see something");
    let mut worst = [[0.0; 2]; 3];
    for method in methods {
        let drawn = BUDGETS.map(|max_error| {
            let frame = frame(mesh, scene, Method { max_error, ..*method });
            [largest_error(frame.image.pixels(), &truth), frame.spent.unwrap().mean()]
        });
        let way = format!("{} {} {}", method.backend, method.order, method.projection);
        println!(
            "{name:<40} {way:<16} errors {:.1e} {:.1e} {:.1e}, pieces {:.2} {:.2} {:.2}",
            drawn[0][0], drawn[1][0], drawn[2][0], drawn[0][1], drawn[1][1], drawn[2][1]
        );
        for ([error, _], budget) in drawn.iter().zip(BUDGETS) {
            assert!(*error <= budget, "{name}, {way}: {error:.1e} for {budget:e}");
        }
        assert!(drawn.is_sorted_by(|a, b| a[1] <= b[1]), "{name}, {way}: a looser budget takes no more pieces");
        worst = [0, 1, 2].map(|i| [0, 1].map(|k| drawn[i][k].max(worst[i][k])));
    }
    worst
}

#[test]
fn every_function_to_every_budget() {
    let mesh = mesh();
    for (view, camera) in ["perspective", "orthographic", "inside"].into_iter().zip(cameras()) {
        let error = |classification, second| {
            let scene = scene(&mesh, second, classification, None, camera);
            holds(&format!("two fields ({second}), {view}"), &mesh, &scene, &[CPU, GPU])[0][0]
        };
        assert!(error(two_fields(), "y") <= EXACT && error(two_fields(), "by cell") <= EXACT);
        for (name, widget) in shapes() {
            let alone = Classification::Widgets(BivariateFunction { widgets: vec![widget] });
            let drawn = holds(&format!("{name}, {view}"), &mesh, &scene(&mesh, "y", alone, None, camera), &[CPU, GPU]);
            assert!(drawn[0][0] <= EXACT, "one colour is exact");
        }
        for (name, function) in [("four widgets", all_widgets()), ("image", image())] {
            for second in ["y", "by cell"] {
                let scene = scene(&mesh, second, function.clone(), None, camera);
                let drawn = holds(&format!("{name} ({second}), {view}"), &mesh, &scene, &[CPU, GPU]);
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
        holds(name, &mesh, &scene, &[CPU, GPU]);
    }
}

/// A field that fades out has gradients that single precision cannot hold, where a widget may be seen all the same.
#[test]
fn light_where_the_field_fades_out() {
    let parts = cuboid([5, 4, 4], Split::Six, [-DVec3::ONE, DVec3::ONE]);
    let blob = |p: DVec3| (-60.0 * (p - DVec3::new(-0.6, 0.1, 0.2)).length_squared()).exp();
    let fields = vec![Field::point("x", 1, parts.sample(blob)), Field::point("y", 1, parts.sample(|p| p.y))];
    let mesh = TetMesh::assemble(&parts.points, &parts.cells, fields).unwrap();
    let fog = Widget::new(Shape::Gaussian { center: [0.1, 0.0], sigma: [0.3, 2.0] }, None, 1.0, [1.0, 0.5, 0.2]);
    let function = Classification::Widgets(BivariateFunction { widgets: vec![fog.unwrap()] });
    let mut scene = scene(&mesh, "y", function, None, cameras()[0]);
    let light = Light::new(Some([0.4, -0.2, 1.0]), [0.2, 0.8, 0.5], 30.0, 0.0).unwrap();
    let gradients = mesh.vertex_gradients(&scene.scalar);
    let shortest = gradients.iter().map(|g| g.length()).fold(f64::INFINITY, f64::min);
    assert!(shortest < 1e-40, "{shortest:e}");
    scene.lighting = Some(Lighting::new(light, gradients.clone()));
    holds("fading out, lit", &mesh, &scene, &[CPU, GPU]);
    // The planted difference: gradients as they are light what single precision has no normal for.
    scene.lighting = Some(Lighting { light, gradients });
    let wrong = largest_error(frame(&mesh, &scene, CPU).image.pixels(), &reference(&mesh, &scene));
    assert!(wrong > 1e-3, "{wrong:.1e}");
}

#[test]
fn segments_sorted_in_every_pixel() {
    let mesh = mesh();
    for camera in &cameras()[..2] {
        let lit =
            scene(&mesh, "y", all_widgets(), Some(Light::new(None, [0.3, 0.7, 0.2], 20.0, 1.0).unwrap()), *camera);
        holds("four widgets, lit", &mesh, &lit, &[CPU_PIXEL, GPU_VICP, GPU_MARCH]);
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
    assert!(holds("cycle", &cycle, &scene, &[CPU, GPU])[0][0] <= EXACT);
    let centroid = Method { order: Order::Centroid, ..CPU };
    let wrong = largest_error(frame(&cycle, &scene, centroid).image.pixels(), &reference(&cycle, &scene));
    assert!(wrong > 1e-2, "centroids give the cycle no order: {wrong:.1e}");
}

#[test]
fn leaving_cells_out_changes_no_picture() {
    let mesh = mesh();
    let mut skipped = 0;
    let mut same = |function: Classification, camera| {
        let scene = scene(&mesh, "y", function, None, camera);
        let culled = Plan::new(&scene, &mesh, renderer().device()).unwrap();
        // A planner keeps the boxes of the cells from another function of the same fields.
        let planner = Planner::new(&mesh);
        let other = Classification::Widgets(BivariateFunction { widgets: vec![shapes()[0].1] });
        planner.plan(&Scene { classification: other, ..scene.clone() }, renderer().device()).unwrap();
        assert_eq!(planner.plan(&scene, renderer().device()).unwrap().cells, culled.cells, "boxes that were kept");
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

/// The picture of a method and what it took, with the tables that it asks for.
fn drawn_by(mesh: &TetMesh, scene: &Scene, method: Method) -> (Plan, Frame) {
    let scene = Scene { method, ..scene.clone() };
    let plan = Plan::new(&scene, mesh, renderer().device()).unwrap();
    let build = |spec: &TableSpec| Arc::new(Table::build(spec).unwrap());
    let tables: Vec<_> = table_specs(&scene, mesh, &plan).iter().map(build).collect();
    let frame = renderer().render_with(&scene, &Model::new(mesh), &plan, &tables).unwrap();
    (plan, frame)
}

/// Warnings but the one that another model of light keeps to no budget.
fn beside_the_budget(plan: &Plan) -> Vec<&str> {
    plan.warnings.iter().map(String::as_str).filter(|warning| !warning.contains("error budget")).collect()
}

#[test]
fn published_modes_draw_the_integrals_of_emission_density() {
    // Of thin matter of opacity 1 the two conventions differ by little: c (1 - exp(-D)) in both. So the published modes
    // are seen to be right by a uniform widget of that opacity, against the reference.
    let mesh = mesh();
    let rectangle = Rectangle { s: [-1.5, 0.3], g: [4.0, 5.6] };
    let one = Widget::new(Shape::Uniform, Some(rectangle), 1.0, [0.1, 0.3, 1.0]).unwrap();
    let uniform = Classification::Widgets(BivariateFunction { widgets: vec![one] });
    let scene_of = |function| scene(&mesh, "y", function, None, cameras()[0]);
    let scene_one = scene_of(uniform);
    let truth = reference(&mesh, &scene_one);
    for backend in [CPU, GPU] {
        let by = |integrator, pieces| Method { integrator, pieces, ..backend };
        let (plan, frame) = drawn_by(&mesh, &scene_one, by(Integrator::Analytic, None));
        assert_eq!(
            (plan.integrator, plan.order),
            (Integrator::Analytic, Order::Exact),
            "a glow needs an order: {plan}"
        );
        assert_eq!(beside_the_budget(&plan), [""; 0]);
        assert!(largest_error(frame.image.pixels(), &truth) < EXACT);
        // Classified at their ends, pieces lose the rim of the rectangle: the more of them the less.
        let error = |pieces| {
            let (plan, frame) = drawn_by(&mesh, &scene_one, by(Integrator::Approximate, Some(pieces)));
            assert_eq!(frame.spent.unwrap().mean(), f64::from(pieces));
            assert!(plan.to_string().contains(&format!("{pieces} equal pieces")), "{plan}");
            largest_error(frame.image.pixels(), &truth)
        };
        let [few, many] = [10, 100].map(error);
        println!("approximate: {few:.1e} with 10 pieces, {many:.1e} with 100");
        assert!(few < 0.1 && many < 0.3 * few, "{few:.1e} {many:.1e}");
        // The planted difference: of another opacity the conventions part.
        let strong = Widget::new(Shape::Uniform, Some(rectangle), 5.0, [0.1, 0.3, 1.0]).unwrap();
        let strong = scene_of(Classification::Widgets(BivariateFunction { widgets: vec![strong] }));
        let (_, frame) = drawn_by(&mesh, &strong, by(Integrator::Analytic, None));
        assert!(largest_error(frame.image.pixels(), &reference(&mesh, &strong)) > 0.1);
        // Opacity is the same in both conventions, and images have one of the two.
        for (function, integrator) in [(all_widgets(), Integrator::Approximate), (image(), Integrator::Approximate)] {
            let scene = scene_of(function);
            let (_, frame) = drawn_by(&mesh, &scene, by(integrator, Some(200)));
            let alphas = frame.image.pixels().iter().zip(reference(&mesh, &scene));
            let apart = alphas.map(|(pixel, truth)| (f64::from(pixel[3]) - truth[3]).abs()).fold(0.0, f64::max);
            assert!(apart < 2e-2, "{apart:.1e}");
        }
    }
}

/// Apart by what single precision leaves of differences of the tables, as published: up to e^10 times a rounding.
const CANCELLED: f64 = 2e-3;

/// Of a segment on which a widget hardly varies the published differences may give any weight, by a rounding. So many pixels
/// may differ for that.
const UNSTABLE_SHARE: f64 = 0.02;

#[test]
fn published_modes_are_the_same_on_both_back_ends() {
    let mesh = mesh();
    for (name, widget) in &shapes()[..4] {
        let function = Classification::Widgets(BivariateFunction { widgets: vec![*widget] });
        let scene = scene(&mesh, "y", function, None, cameras()[0]);
        for (integrator, pieces) in [(Integrator::Analytic, None), (Integrator::Approximate, Some(10))] {
            let [cpu, gpu] =
                [CPU, GPU].map(|method| drawn_by(&mesh, &scene, Method { integrator, pieces, ..method }).1);
            let pairs = gpu.image.pixels().iter().zip(cpu.image.pixels());
            let apart: Vec<f64> = pairs.map(|(&g, c)| pixel_error(g, c.map(f64::from))).collect();
            let largest = apart.iter().copied().fold(0.0, f64::max);
            let others = apart.iter().filter(|&&a| a > CANCELLED).count();
            println!(
                "{name}, {integrator}: the back ends are {largest:.1e} apart, {others} pixels by more than rounding"
            );
            let share = if integrator == Integrator::Analytic { UNSTABLE_SHARE } else { 0.0 };
            assert!(
                others as f64 <= share * apart.len() as f64,
                "{name}, {integrator}: {others} pixels, {largest:.1e}"
            );
            assert_eq!(cpu.spent.unwrap().pieces > 0, gpu.spent.unwrap().pieces > 0);
        }
    }
}

#[test]
fn a_scene_of_one_field_pays_nothing_for_two() {
    let mesh = mesh();
    let text = "[field]\nname = \"x\"\n[image]\nsize = [26, 20]\n[transfer]\n";
    let of =
        |transfer: &str| SceneFile::parse("a.toml", &format!("{text}{transfer}")).unwrap().scene(&mesh, 0).unwrap();
    let one = of("color = [[-1.5, 0.9, 0.1, 0.2], [1.5, 0.1, 0.3, 1.0]]\nopacity = [[-1.0, 1.5], [1.0, 0.0]]");
    assert!(one.second.is_none() && one.lighting.is_none(), "no gradient is computed, no second field read");
    let plan = Plan::new(&one, &mesh, renderer().device()).unwrap();
    assert!(plan.to_string().contains("skipped: nothing asks for them"), "{plan}");
    assert_eq!(plan.integrator, Integrator::Direct);
    assert!(table_specs(&one, &mesh, &plan).is_empty(), "no table");
    let frame = renderer().render(&one, &Model::new(&mesh), &plan).unwrap();
    assert_eq!(frame.spent, None, "no segment is shaded one by one from further fields");
    // The planted difference: widgets over the gradient pay for all of it.
    let two = of("[[widget]]\nshape = \"gaussian\"\ncenter = [0.0, 1.0]\nsigma = [0.5, 1.0]\nmax_opacity = 1.0\n\
                  color = [1.0, 0.5, 0.1]");
    assert!(two.second.is_some());
    let (plan, frame) = drawn_by(&mesh, &two, Method { integrator: Integrator::Analytic, ..Method::default() });
    assert!(plan.to_string().contains("computed: their magnitude"), "{plan}");
    let scene = Scene { method: Method { integrator: Integrator::Analytic, ..Method::default() }, ..two };
    assert_eq!(table_specs(&scene, &mesh, &plan).len(), 3);
    assert!(frame.spent.is_some());
}

#[test]
fn more_peaks_than_the_published_form_has_are_told_of() {
    let mesh = mesh();
    let plan = |widgets: Vec<Widget>, integrator| {
        let function = Classification::Widgets(BivariateFunction { widgets });
        let method = Method { integrator, ..Method::default() };
        let scene = Scene { method, ..scene(&mesh, "y", function, None, cameras()[0]) };
        Plan::new(&scene, &mesh, renderer().device()).unwrap()
    };
    let wave = |frequency| widget(wave(WaveProfile::AbsSine, [frequency, 0.0]), None, [1.0; 3]);
    let one = plan(vec![wave(0.05)], Integrator::Analytic);
    assert!(beside_the_budget(&one).is_empty() && one.warnings[0].contains("model of light"), "{:?}", one.warnings);
    let many = plan(vec![wave(8.0)], Integrator::Analytic);
    let told = beside_the_budget(&many);
    assert!(told[0].contains("more than one peak") && told[0].contains("adaptive"), "{told:?}");
    assert!(plan(vec![wave(8.0)], Integrator::Auto).warnings.is_empty(), "there is no limit elsewhere");
    let apart = plan(vec![wave(0.05), shapes()[0].1], Integrator::Analytic);
    let told = beside_the_budget(&apart);
    assert!(told[0].contains("overlap") && told[0].contains("adaptive"), "{told:?}");
}

#[test]
fn integrators_that_make_no_sense_are_refused_in_words() {
    let mesh = mesh();
    let refused = |function: Classification, integrator, light: bool, words: &[&str]| {
        let light = light.then(|| Light::new(None, [0.3, 0.7, 0.2], 20.0, 0.0).unwrap());
        let method = Method { integrator, ..Method::default() };
        let scene = Scene { method, ..scene(&mesh, "y", function, light, cameras()[0]) };
        let reason = Plan::new(&scene, &mesh, renderer().device()).unwrap_err().to_string();
        assert!(words.iter().all(|word| reason.contains(word)), "{words:?}: {reason}");
    };
    for integrator in [Integrator::Adaptive, Integrator::Analytic, Integrator::Approximate] {
        refused(one_field(), integrator, false, &["--integrator direct"]);
        refused(two_fields(), integrator, false, &["--integrator direct"]);
    }
    refused(image(), Integrator::Analytic, false, &["closed form", "approximate or adaptive"]);
    refused(all_widgets(), Integrator::Analytic, true, &["[light]", "--integrator adaptive"]);
    refused(image(), Integrator::Approximate, true, &["[light]", "--integrator adaptive"]);
    refused(all_widgets(), Integrator::Direct, false, &["transfer function", "--integrator adaptive"]);
    let squared = Classification::Widgets(BivariateFunction { widgets: vec![shapes()[4].1] });
    refused(squared, Integrator::Analytic, false, &["sine-squared", "sine\""]);
}

#[test]
fn other_ways_are_refused_with_the_remedy() {
    let mesh = mesh();
    let light = || Some(Light::new(None, [0.3, 0.7, 0.2], 20.0, 0.0).unwrap());
    let says = |method: Method, function: Classification, light| {
        let scene = Scene { method, ..scene(&mesh, "y", function, light, cameras()[0]) };
        Plan::new(&scene, &mesh, renderer().device()).map(|plan| plan.to_string()).unwrap_or_else(|e| e.to_string())
    };
    for (method, named) in [
        (Method { projection: CellProjection::Gator, ..GPU }, ["\"gator\"", "use pt, vicp or march"]),
        (Method { projection: CellProjection::Tiles, ..GPU }, ["\"tiles\"", "use pt, vicp or march"]),
        (Method { projection: CellProjection::Balanced, ..GPU }, ["\"balanced\"", "use pt, vicp or march"]),
        (Method { interpolation: Interpolation::Perspective, ..GPU }, ["\"perspective\"", "use ray"]),
        (Method { classification: tetlux_scene::Classification::Vertex, ..GPU }, ["\"vertex\"", "use post-exact"]),
        (Method { integrator: Integrator::Preint, ..GPU }, ["\"preint\"", "direct"]),
    ] {
        for (function, light) in [(two_fields(), None), (one_field(), light())] {
            let reason = says(method, function, light);
            assert!(named.iter().all(|word| reason.contains(word)), "{named:?}: {reason}");
        }
        assert!(!says(method, one_field(), None).contains("goes without"), "one field is another matter");
    }
    for integrator in [Integrator::Average, Integrator::Psi] {
        let method = Method { integrator, ..GPU };
        assert!(says(method, two_fields(), None).contains("--integrator direct"), "{integrator}");
        assert!(
            !says(method, one_field(), light()).contains("goes without"),
            "{integrator} integrates one field's parts"
        );
    }
    let plan = says(Method::default(), two_fields(), None);
    assert!(plan.contains("skipped: nothing asks for them"), "{plan}");
    let lit = says(Method::default(), two_fields(), light());
    assert!(lit.contains("computed: light"), "{lit}");
}

#[test]
fn one_field_takes_nothing_of_this_on_the_device() {
    let mesh = mesh();
    let taken = |function: Classification, second, light: Option<Light>| {
        let frame = frame(&mesh, &scene(&mesh, second, function, light, cameras()[0]), GPU);
        (frame.resources, frame.spent)
    };
    let light = || Some(Light::new(None, [0.3, 0.7, 0.2], 20.0, 0.0).unwrap());
    // The scene has a second scalar; it classifies by one.
    let (plain, spent) = taken(one_field(), "y", None);
    assert_eq!(spent, None, "nothing counts pieces");
    let (cells, points) = (plain.cells as u64, mesh.points().len() as u64);
    let (all_cells, [width, height]) = (mesh.cells().len() as u64, SIZE.map(u64::from));
    // View, pieces, points and as they are seen, cells, order, batch, projected cells, readback, whose rows are aligned to 256 bytes.
    let pieces = 8 * 48;
    let picture = width * height * 16 + height * (width * 16).next_multiple_of(256);
    let bytes = 96 + pieces + points * (16 + 16) + all_cells * 16 + cells * (4 + 80) + 16 + picture;
    let expected = Resources { pipelines: 2, buffers: 9, textures: 1, bytes, cells: plain.cells };
    assert_eq!(plain, expected);
    // What each of the others adds: counters and their readback, the look, and its own buffers.
    let more = |function: Classification, second, light| {
        let (resources, spent) = taken(function, second, light);
        assert!(spent.is_some_and(|spent| spent.pieces > 0));
        assert_eq!((resources.pipelines, resources.textures), (2, 1));
        (resources.buffers - plain.buffers, resources)
    };
    let shared = 2 * 32_768 + 112;
    let (buffers, lit) = more(one_field(), "y", light());
    assert_eq!((buffers, lit.bytes), (4, plain.bytes + shared + points * 16), "gradients");
    // Of two fields the second scalar; widgets or texels stand in for the pieces.
    assert_eq!(more(two_fields(), "y", None).0, 4);
    assert_eq!(more(two_fields(), "by cell", None).0, 4);
    assert_eq!(more(two_fields(), "y", light()).0, 5);
    let (buffers, widgets) = more(all_widgets(), "y", None);
    let of_cells = (plain.cells as u64, widgets.cells as u64);
    let difference = shared + points * 4 + 4 * 64 - pieces;
    assert_eq!((buffers, widgets.bytes + of_cells.0 * 84), (4, plain.bytes + difference + of_cells.1 * 84));
    assert_eq!(more(image(), "y", light()).0, 5);
}
