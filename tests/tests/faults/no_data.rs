//! Values that are NaN or infinite, sprinkled over points and cells: cells that miss one have the look that the scene
//! gives them, or are left out, in every way of rendering; and no pixel is poisoned.

use glam::DVec3;
use tetlux_mesh::procedural::Parts;
use tetlux_mesh::{Component, Field, TetMesh};
use tetlux_optics::widget::{BivariateFunction, Shape, Widget};
use tetlux_optics::{Classification, Emphasis, ImageFunction, Light, NoData};
use tetlux_render::Model;
use tetlux_scene::{
    Backend, CellProjection, Emphasized, Integrator, Interpolation, Lighting, Method, Order, Plan, Scene, Target,
};
use tetlux_tests::{
    Random, Recipe, Way, largest_error, reference, render, renderer, scene, transfer, transfer_of, white,
};

/// Some twenty segments a pixel, each with cuts and weights in single precision.
const TOLERANCE: f64 = 1e-4;

/// Where colour keeps to the budget, the error is the budget; a few roundings more.
const OF_BUDGET: f64 = 1.1e-3;

const SEEDS: u64 = 8;

/// Pixels along a side.
const SIDE: u32 = 32;

/// Values of which about one in `every` is not finite.
fn sprinkled(random: &mut Random, values: Vec<f64>, every: usize) -> Vec<f64> {
    let mut values = values;
    for value in &mut values {
        if random.below(every) == 0 {
            *value = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY][random.below(3)];
        }
    }
    // One at least that is there, and one that is not.
    values[0] = 0.25;
    if let Some(last) = values.last_mut() {
        *last = f64::NAN;
    }
    values
}

/// A mesh with the fields "s" and "t", each on points or on cells, both with values missing.
fn random_mesh(random: &mut Random) -> TetMesh {
    let parts = Recipe::random(random.bits(), SIDE).parts;
    let field = |name: &str, random: &mut Random| {
        let wave = DVec3::new(random.between(-2.0, 2.0), random.between(-2.0, 2.0), random.between(-2.0, 2.0));
        if random.below(3) == 0 {
            let values = cell_middles(&parts).map(|p| wave.dot(p).sin()).collect();
            Field::cell(name, 1, sprinkled(random, values, 8))
        } else {
            Field::point(name, 1, sprinkled(random, parts.sample(|p| wave.dot(p).sin()), 20))
        }
    };
    let fields = vec![field("s", random), field("t", random)];
    TetMesh::assemble(&parts.points, &parts.cells, fields).unwrap_or_else(|e| panic!("{e}"))
}

fn cell_middles(parts: &Parts) -> impl Iterator<Item = DVec3> {
    parts.cells.iter().map(|cell| cell.iter().map(|&v| parts.points[v as usize]).sum::<DVec3>() / 4.0)
}

fn random_look(random: &mut Random) -> NoData {
    let opacity = if random.below(4) == 0 { 0.0 } else { random.between(0.1, 3.0) };
    NoData::new([0; 3].map(|_| random.between(0.0, 1.0)), opacity).unwrap_or_default()
}

fn random_scene(random: &mut Random, mesh: &TetMesh, size: [u32; 2]) -> Scene {
    let color = [[-1.0, 0.9, 0.1, 0.2], [0.0, 0.2, 0.8, 0.3], [1.0, 0.1, 0.3, 1.0]];
    let opacity = [[-1.0, 1.5], [-0.2, 0.0], [0.1, 0.2], [0.5, 2.0], [30.0, 7.0]];
    let scene = scene(mesh, transfer(&color, &opacity), Recipe::random(random.bits(), SIDE).camera, size);
    Scene { no_data: random_look(random), ..scene }
}

fn assert_right(what: &str, mesh: &TetMesh, scene: &Scene, truth: &[[f64; 4]], ways: &[Way], tolerance: f64) {
    for &way in ways {
        let error = largest_error(render(mesh, scene, way).pixels(), truth);
        assert!(error <= tolerance, "{what}, {way:?}: off by {error:.1e}");
    }
}

/// In exact order, or without need of one.
const EXACT_WAYS: [Way; 5] = [Way::GpuMarch, Way::GpuTiles, Way::GpuExact, Way::CpuExact, Way::CpuPixel];

/// Of two fields and light.
const LOOK_WAYS: [Way; 4] = [Way::GpuMarch, Way::GpuExact, Way::CpuExact, Way::CpuPixel];

#[test]
fn sprinkled_values_poison_no_picture_of_one_field() {
    let mut seen = 0;
    for seed in 0..SEEDS {
        let mut random = Random::new(seed);
        let mesh = random_mesh(&mut random);
        let mut scene = random_scene(&mut random, &mesh, [SIDE; 2]);
        let truth = reference(&mesh, &scene);
        seen += usize::from(truth.iter().any(|pixel| pixel[3] > 0.0));
        assert_right(&format!("seed {seed}"), &mesh, &scene, &truth, &EXACT_WAYS, TOLERANCE);
        // White throughout: in any order.
        scene.classification = Classification::OneField(white(&[[-1.0, 1.5], [0.0, 0.0], [0.4, 2.0]]));
        scene.no_data = NoData::new([1.0; 3], scene.no_data.opacity()).unwrap_or_default();
        let truth = reference(&mesh, &scene);
        assert_right(&format!("white, seed {seed}"), &mesh, &scene, &truth, &Way::ALL, TOLERANCE);
    }
    assert!(seen > SEEDS as usize / 2);
}

#[test]
fn sprinkled_values_poison_no_picture_of_two_fields_or_with_light() {
    for seed in 0..SEEDS {
        let mut random = Random::new(100 + seed);
        let mesh = random_mesh(&mut random);
        let base = random_scene(&mut random, &mesh, [24, 24]);
        let second = mesh.scalar("t", Component::Magnitude).unwrap_or_else(|e| panic!("{e}"));
        // One that is seen everywhere, also where values are missing and count as the lowest.
        let everywhere = Widget::new(Shape::Uniform, None, 0.3, [0.1, 0.3, 1.0]);
        let bump = Widget::new(Shape::Gaussian { center: [0.1, 0.2], sigma: [0.4, 0.3] }, None, 2.0, [1.0, 0.2, 0.1]);
        let widgets = [everywhere, bump].map(|widget| widget.unwrap_or_else(|e| panic!("{e}"))).to_vec();
        let texels = (0..12).map(|i| [0.1 * i as f32, 0.5, 0.9, 0.2 * i as f32]).collect();
        let image = ImageFunction::new(4, texels, [[-1.0, 1.0]; 2]).unwrap_or_else(|e| panic!("{e}"));
        let two_fields = transfer_of(&base).clone();
        let light = Light::new(None, [0.3, 0.7, 0.5], 10.0, 0.0).unwrap_or_else(|e| panic!("{e}"));
        let lighting = Lighting::new(light, mesh.vertex_gradients(&base.scalar));
        let (second, lit) = (Some(second), Some(lighting));
        let scenes = [
            ("light", Scene { lighting: lit.clone(), ..base.clone() }),
            (
                "two fields",
                Scene { classification: Classification::TwoFields(two_fields), second: second.clone(), ..base.clone() },
            ),
            (
                "widgets",
                Scene {
                    classification: Classification::Widgets(BivariateFunction { widgets: widgets.clone() }),
                    second: second.clone(),
                    ..base.clone()
                },
            ),
            ("an image, lit", Scene { classification: Classification::Image(image), second, lighting: lit, ..base }),
        ];
        let (what, scene) = &scenes[seed as usize % scenes.len()];
        let truth = reference(&mesh, scene);
        assert_right(&format!("{what}, seed {seed}"), &mesh, scene, &truth, &LOOK_WAYS, OF_BUDGET);
    }
}

#[test]
fn sprinkled_values_poison_no_emphasis() {
    for seed in 0..4 {
        let mut random = Random::new(200 + seed);
        let parts = Recipe::random(random.bits(), SIDE).parts;
        let values = sprinkled(&mut random, parts.sample(|p| (p.x + p.y * p.z).sin()), 20);
        let mesh = tetlux_tests::mesh_with(&parts, Field::point("s", 1, values));
        let mut scene = random_scene(&mut random, &mesh, [SIDE; 2]);
        let emphasis = Emphasis { silhouette: Some(2.0), ..Emphasis::default() };
        scene.emphasis = Some(
            Emphasized::new(&emphasis, transfer_of(&scene), &mesh, &scene.scalar).unwrap_or_else(|e| panic!("{e}")),
        );
        let truth = reference(&mesh, &scene);
        assert_right(&format!("seed {seed}"), &mesh, &scene, &truth, &EXACT_WAYS, TOLERANCE);
    }
}

/// Where luminance and opacity are constant every method is exact, the published ones too.
#[test]
fn every_method_shows_cells_without_data() {
    let mut random = Random::new(7);
    let mesh = random_mesh(&mut random);
    let plain = transfer(&[[0.0, 0.2, 0.8, 0.3]], &[[0.0, 0.7]]);
    let camera = tetlux_tests::perspective(DVec3::new(3.5, -4.0, 2.8), DVec3::ZERO, 50.0);
    let base = Scene {
        no_data: NoData::new([1.0, 0.1, 0.0], 1.3).unwrap_or_default(),
        ..scene(&mesh, plain, camera, [SIDE; 2])
    };
    let truth = reference(&mesh, &base);
    let mut methods: Vec<Method> = Vec::new();
    let default = Method { backend: Backend::Gpu, order: Order::Exact, target: Target::Rgba32f, ..Method::default() };
    for &projection in CellProjection::ALL {
        let order = if projection == CellProjection::March { Order::Auto } else { Order::Exact };
        methods.push(Method { projection, order, ..default });
    }
    methods.push(Method { interpolation: Interpolation::Perspective, ..default });
    methods.push(Method { interpolation: Interpolation::ScreenLinear, ..default });
    methods.extend(
        [Integrator::Average, Integrator::Linear, Integrator::Symmetric].map(|i| Method { integrator: i, ..default }),
    );
    methods.extend(
        [tetlux_scene::Classification::Vertex, tetlux_scene::Classification::PostClip]
            .map(|c| Method { classification: c, ..default }),
    );
    methods.push(Method {
        classification: tetlux_scene::Classification::Vertex,
        backend: Backend::Cpu,
        target: Target::Auto,
        ..default
    });
    for method in methods {
        let scene = Scene { method, ..base.clone() };
        let plan = Plan::new(&scene, &mesh, renderer().device()).unwrap_or_else(|e| panic!("{method:?}: {e}"));
        let frame = renderer().render(&scene, &Model::new(&mesh), &plan).unwrap_or_else(|e| panic!("{method:?}: {e}"));
        // Screen-linear interpolation is wrong about lengths: that it may be.
        let allowed = if method.interpolation == Interpolation::ScreenLinear { 0.2 } else { TOLERANCE };
        let error = largest_error(frame.image.pixels(), &truth);
        assert!(error <= allowed, "{method:?}: off by {error:.1e}");
    }
    for integrator in Integrator::ALL.iter().copied().filter(|integrator| integrator.is_pre_integrated()) {
        let scene = Scene { method: Method { integrator, ..default }, ..base.clone() };
        let refused = Plan::new(&scene, &mesh, renderer().device()).map(|_| ()).unwrap_err().to_string();
        assert!(refused.contains("cells without data") && refused.contains("direct"), "{refused}");
    }
}

#[test]
fn what_is_seen_of_no_data_is_told_and_the_mesh_is_used_again() {
    let mut random = Random::new(3);
    let mesh = random_mesh(&mut random);
    let hidden = Scene { no_data: NoData::default(), ..random_scene(&mut random, &mesh, [16, 16]) };
    let shown = Scene { no_data: NoData::new([1.0; 3], 0.5).unwrap_or_default(), ..hidden.clone() };
    let plan = |scene: &Scene| Plan::new(scene, &mesh, renderer().device()).unwrap_or_else(|e| panic!("{e}"));
    let (without, with) = (plan(&hidden), plan(&shown));
    assert!(without.skips.no_data > 0 && with.skips.no_data == 0);
    assert!(without.warnings.iter().any(|warning| warning.contains("left out")));
    assert!(with.warnings.iter().all(|warning| !warning.contains("left out")));
    assert!(with.reasons.iter().any(|(what, why)| *what == "no data" && why.contains("opacity 0.5")));
    let model = Model::new(&mesh);
    let reused = |scene: &Scene, plan: &Plan| {
        renderer().render(scene, &model, plan).unwrap_or_else(|e| panic!("{e}")).mesh_reused
    };
    // Another look of what is seen already changes no mesh; that it is seen at all does.
    assert_eq!([reused(&hidden, &without), reused(&hidden, &without)], [false, true]);
    assert_eq!([reused(&shown, &with), reused(&shown, &with)], [false, true]);
    let red = Scene { no_data: NoData::new([1.0, 0.0, 0.0], 2.0).unwrap_or_default(), ..shown };
    assert!(reused(&red, &plan(&red)));
}
