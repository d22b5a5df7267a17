//! Does the suite find what is wrong? Faults are planted, one at a time, and judged as the suite judges.
//!
//! The switches are of the crates' feature `planted`, which no program is built with (tidy.rs). They hold for the whole
//! process: tests here take turns, and no other test is in this one.

#![allow(clippy::print_stdout, reason = "which judge found which fault")]

use std::collections::BTreeSet;
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};

use glam::DVec3;
use tetlux_image::Image;
use tetlux_mesh::procedural::{Parts, Split, cuboid};
use tetlux_mesh::{Field, TetMesh};
use tetlux_order::planted::{Dropped, drop_arrow};
use tetlux_order::verify::{Pairs, Ray, Verifier};
use tetlux_order::{Facts, Method as Ordering, Orderer};
use tetlux_render::planted::{Fault, plant};
use tetlux_render::{Model, Renderer, sampling, table_specs};
use tetlux_scene::{Backend, Integrator, Method, Plan, Scene, Skip, SkipSet};
use tetlux_shaders::MODULES;
use tetlux_shaders::planted::{Edit, edit};
use tetlux_tables::{Table, TableCache};
use tetlux_tests::{
    Convex, FIELD, Recipe, Way, judge, largest_error, mesh_of, mesh_with, orthographic, perspective, pixel_error, plan,
    reference, render_by, renderer, scene, sensitivity, transfer, twins, view, white,
};

/// What is wrong.
#[derive(Debug, Clone, Copy)]
enum Plant {
    Nothing,
    /// On the processor.
    Tiles(Fault),
    /// On a graphics adapter.
    Shader(Edit),
    /// In the order.
    Arrow(Dropped),
}

/// A fault until it is dropped.
struct Planted {
    _turn: MutexGuard<'static, ()>,
}

static TURN: Mutex<()> = Mutex::new(());

impl Planted {
    fn new(what: Plant) -> Planted {
        // What failed before has cleared its own fault.
        let planted = Planted { _turn: TURN.lock().unwrap_or_else(PoisonError::into_inner) };
        match what {
            Plant::Nothing => {}
            Plant::Tiles(fault) => plant(fault),
            Plant::Shader(wrong) => {
                let text = MODULES.iter().find(|(name, _)| *name == wrong.module).map_or("", |(_, text)| text);
                assert_eq!(text.matches(wrong.from).count(), 1, "{wrong:?} is of an earlier text of the module");
                edit(Some(wrong));
            }
            Plant::Arrow(dropped) => drop_arrow(Some(dropped)),
        }
        planted
    }
}

impl Drop for Planted {
    fn drop(&mut self) {
        plant(Fault::None);
        edit(None);
        drop_arrow(None);
    }
}

/// A scene, its truth, and how far that hangs on rounding.
struct Known {
    mesh: TetMesh,
    scene: Scene,
    truth: Vec<[f64; 4]>,
    moved: Vec<f64>,
}

impl Known {
    fn new((mesh, scene): (TetMesh, Scene)) -> Known {
        let truth = reference(&mesh, &scene);
        let moved = sensitivity(&mesh, &scene, &truth);
        Known { mesh, scene, truth, moved }
    }

    /// Whether a pixel is further off than tolerance and rounding explain.
    fn is_wrong(&self, image: &Image) -> bool {
        let pixels = image.pixels().iter().zip(&self.truth).zip(&self.moved);
        pixels.map(|((&p, &t), moved)| pixel_error(p, t) - moved).any(|off| off > twins::TOLERANCE)
    }
}

/// Scenes at random, most of their pixels covered.
fn known() -> &'static [Known] {
    static KNOWN: OnceLock<Vec<Known>> = OnceLock::new();
    KNOWN.get_or_init(|| (0..4).map(|seed| Known::new(Recipe::random(seed, 32).made())).collect())
}

/// A box of constant opacity along parallel rays: each pixel in it has the optical depth `depth`.
fn slab(depth: f64) -> (TetMesh, Scene) {
    let mesh = mesh_of(&cuboid([2, 2, 2], Split::Six, [DVec3::ZERO, DVec3::ONE]), |_| 1.0);
    let camera = orthographic(DVec3::new(0.53, 0.47, -2.0), DVec3::new(0.53, 0.47, 0.5), 0.4);
    let scene = scene(&mesh, white(&[[0.0, depth]]), camera, [32; 2]);
    (mesh, scene)
}

/// Relative, of single precision.
const FAINT: f64 = 1e-5;

/// The judges that find something wrong with a way of rendering.
fn findings(way: Way) -> BTreeSet<&'static str> {
    let mut findings = BTreeSet::new();
    // What an earlier renderer made is without the fault.
    let renderer = Renderer::new();
    let picture = |mesh: &TetMesh, scene: &Scene| render_by(&renderer, mesh, scene, way);
    if known().iter().any(|known| known.is_wrong(&picture(&known.mesh, &known.scene))) {
        findings.insert("reference");
    }
    let (mesh, scene) = slab(3.0);
    let body = Convex::cuboid([DVec3::ZERO, DVec3::ONE]);
    let truth = |o, d, start| body.chord(o, d, start).map(|[a, b]| [-(3.0 * (a - b)).exp_m1(); 4]);
    if judge(&picture(&mesh, &scene), &scene, FAINT, truth).wrong > 0 {
        findings.insert("closed form");
    }
    let (mesh, scene) = slab(1e-6);
    let faint = picture(&mesh, &scene);
    if faint.pixels().iter().any(|pixel| (f64::from(pixel[3]) / 1e-6 - 1.0).abs() > FAINT) {
        findings.insert("faint alpha");
    }
    if faint.pixels().iter().any(|pixel| pixel[..3].iter().any(|c| ((c - pixel[3]) / pixel[3]).abs() > 1e-6)) {
        findings.insert("energy");
    }
    for (name, make) in twins::ALL {
        let twins = make(Recipe::random(1, 32), 1);
        let [first, second] = twins.pair.each_ref().map(|(mesh, scene)| picture(mesh, scene));
        if twins.compare(&first, &second).wrong > 0 {
            findings.insert(name);
        }
    }
    findings
}

const CPU: [Way; 2] = [Way::CpuExact, Way::CpuPixel];
const GPU: [Way; 3] = [Way::GpuExact, Way::GpuTiles, Way::GpuMarch];

/// Asserts that a fault is found, in every way that it concerns, by these judges among others.
fn assert_found(name: &str, what: Plant, ways: &[Way], by: &[&str]) {
    let _planted = Planted::new(what);
    for &way in ways {
        let findings = findings(way);
        println!("{name}, {way:?}: {findings:?}");
        for judge in by {
            assert!(findings.contains(judge), "{name}, {way:?}: \"{judge}\" does not find it");
        }
    }
}

#[test]
fn nothing_is_found_where_nothing_is_planted() {
    let _planted = Planted::new(Plant::Nothing);
    for way in Way::RIGHT {
        assert_eq!(findings(way), BTreeSet::new(), "{way:?}");
    }
}

/// Where light comes from inside a segment matters the less the shorter it is.
const REFINED: [&str; 3] = ["reference", "cells split in four at their middles", "cells split in eight at their edges"];

#[test]
fn a_wrong_sign_in_an_integrator() {
    assert_found("wrong sign", Plant::Tiles(Fault::WrongSign), &CPU, &REFINED);
    let module = "lib::segment";
    let wrong = Edit { module, from: "let s = 2.0 * rho - 1.0;", to: "let s = 1.0 - 2.0 * rho;" };
    assert_found("wrong sign", Plant::Shader(wrong), &GPU, &REFINED);
}

#[test]
fn the_ends_of_a_segment_exchanged() {
    let from = "weights(back.w * part, front.w * part)";
    let wrong = Edit { module: "shading::post_exact", from, to: "weights(front.w * part, back.w * part)" };
    assert_found("ends exchanged", Plant::Shader(wrong), &GPU, &REFINED);
}

#[test]
fn a_lost_ray() {
    let by = ["reference", "closed form", "faint alpha", "seen from behind in parallel"];
    assert_found("lost ray", Plant::Tiles(Fault::LostRay), &CPU, &by);
    let miss = "if !(segment.length > 0.0) {";
    let lost = "if !(segment.length > 0.0) || all(vec2<u32>(fragment.position.xy) % 16u == vec2<u32>(5u, 6u)) {";
    let wrong = Edit { module: "stages::draw", from: miss, to: lost };
    assert_found("lost ray", Plant::Shader(wrong), &[Way::GpuExact], &by);
    // The picture's last column: one off.
    let from = "let inside = all(pixel < vec2<u32>(view.size));";
    let wrong = Edit { module: "stages::tiles", from, to: "let inside = all(pixel + 1u < vec2<u32>(view.size));" };
    assert_found("lost column", Plant::Shader(wrong), &[Way::GpuTiles], &by);
    let wrong = Edit { module: "stages::march", from: "if id.x >= size.x ||", to: "if id.x + 1u >= size.x ||" };
    assert_found("lost column", Plant::Shader(wrong), &[Way::GpuMarch], &by);
}

#[test]
fn opacity_that_cancels() {
    let by = ["faint alpha"];
    assert_found("cancellation", Plant::Tiles(Fault::Cancellation), &CPU, &by);
    let wrong = Edit { module: "lib::segment", from: "if x >= 0.25 {", to: "if x >= 0.0 {" };
    assert_found("cancellation", Plant::Shader(wrong), &GPU, &by);
}

/// The rays of a scene's pixels.
fn rays(scene: &Scene) -> Vec<Ray> {
    let view = view(scene);
    let pixels = (0..view.size[1]).flat_map(|y| (0..view.size[0]).map(move |x| (x, y)));
    pixels
        .map(|(x, y)| {
            let (origin, direction) = view.ray(f64::from(x) + 0.5, f64::from(y) + 0.5);
            Ray { origin, direction, start: view.near }
        })
        .collect()
}

/// Drops arrows, one at a time. Where a picture shows it the verifier finds it, and ways without an order know nothing of
/// it. How many the verifier finds, and how many are seen.
fn without_arrows(known: &Known, dropped: impl Iterator<Item = Dropped>) -> [usize; 2] {
    let Known { mesh, scene, .. } = known;
    let (facts, verifier, rays, renderer) = (Facts::new(mesh), Verifier::new(mesh), rays(scene), Renderer::new());
    let mut scene = scene.clone();
    // Or the order without a fault would do for all.
    scene.method.no_skip = SkipSet::NONE.with(Skip::LastOrder);
    let mut counts = [0; 2];
    for dropped in dropped {
        let _planted = Planted::new(Plant::Arrow(dropped));
        let mut orderer = Orderer::new();
        let order = orderer.order(mesh, &facts, &sampling(&view(&scene)), Ordering::Exact);
        let right = verifier.verify(order, &rays, Pairs::Adjacent).is_right();
        let seen = |way| known.is_wrong(&render_by(&renderer, mesh, &scene, way));
        assert!(!(right && seen(Way::CpuExact)), "{dropped:?}: a picture is wrong, and the verifier has found nothing");
        counts[0] += usize::from(!right);
        if !right && seen(Way::CpuExact) {
            counts[1] += 1;
            for way in [Way::GpuExact, Way::GpuTiles] {
                assert!(seen(way), "{dropped:?}, {way:?}");
            }
            for way in [Way::CpuPixel, Way::GpuMarch] {
                assert!(!seen(way), "{dropped:?}: {way:?} needs no order");
            }
        }
    }
    counts
}

#[test]
fn a_dropped_arrow_in_the_order() {
    // Steps and peaks tell cells apart.
    let of_faces = without_arrows(&known()[0], (0..24).map(|i| Dropped::Face(11 * i)));
    println!("of 24 arrows across faces {of_faces:?} are found and seen");
    assert!(of_faces[1] >= 3);
    // A long cell before a short one whose entry is nearer to the eye: where a search begins does not help.
    let points = [
        [[-1.0, -1.0, 0.0], [-1.0, 1.0, 0.0], [9.0, 0.0, 10.0], [-1.0, 0.0, 0.5]],
        [[-0.9, -0.4, 2.0], [-0.9, 0.4, 2.0], [-0.2, 0.0, 2.0], [-0.6, 0.0, 3.0]],
    ];
    let parts = Parts {
        points: points.as_flattened().iter().map(|&p| p.into()).collect(),
        cells: vec![[0, 1, 2, 3], [4, 5, 6, 7]],
    };
    let mesh = mesh_with(&parts, Field::cell(FIELD, 1, vec![0.0, 1.0]));
    let tf = transfer(&[[0.0, 1.0, 0.0, 0.0], [1.0, 0.0, 0.0, 1.0]], &[[0.0, 2.0]]);
    let camera = orthographic(DVec3::new(-0.5, 0.05, -5.0), DVec3::new(-0.5, 0.05, 0.0), 1.0);
    let pair = Known::new((mesh.clone(), scene(&mesh, tf, camera, [32; 2])));
    assert_eq!(without_arrows(&pair, [Dropped::Gap(0)].into_iter()), [1, 1], "found and seen");
}

#[test]
fn a_cell_that_the_plan_forgets() {
    let _planted = Planted::new(Plant::Nothing);
    let Known { mesh, scene, .. } = &known()[0];
    let renderer = Renderer::new();
    for way in Way::RIGHT {
        let mut plan = plan(mesh, scene, way);
        // The first cell that is drawn may be hidden behind others: of a dozen some are seen.
        let wrong = (0..12).filter(|i| {
            let cells = plan.cells.clone();
            plan.cells.remove(i * cells.len() / 12);
            let frame = renderer.render(scene, &Model::new(mesh), &plan);
            plan.cells = cells;
            known()[0].is_wrong(&frame.unwrap_or_else(|e| panic!("{way:?}: {e}")).image)
        });
        let wrong = wrong.count();
        println!("a forgotten cell, {way:?}: {wrong} of 12 are missed");
        assert!(wrong >= 3, "{way:?}: {wrong}");
    }
}

#[test]
fn a_table_that_is_off_by_a_thousandth() {
    // One cell, so that luminance changes by much along each segment.
    let points = [[-1.0, -0.7, 0.1], [1.1, -0.6, -0.2], [0.1, 1.0, 0.0], [0.05, -0.1, 1.2]].map(DVec3::from);
    let parts = Parts { points: points.to_vec(), cells: vec![[0, 1, 2, 3]] };
    let mesh = mesh_with(&parts, Field::point(FIELD, 1, vec![0.0, 1.0, 0.3, 0.7]));
    let tf = transfer(&[[0.0, 0.0, 1.0, 0.2], [1.0, 1.0, 0.0, 0.3]], &[[0.0, 1.0], [1.0, 4.0]]);
    let camera = perspective(DVec3::new(3.0, 3.5, 1.0), DVec3::new(0.05, 0.0, 0.3), 32.0);
    let method = Method { backend: Backend::Gpu, integrator: Integrator::Q, ..Method::default() };
    let scene = Scene { method, ..scene(&mesh, tf, camera, [48; 2]) };
    let truth = reference(&mesh, &scene);
    let error = || {
        let plan = Plan::new(&scene, &mesh, renderer().device()).unwrap_or_else(|e| panic!("{e}"));
        let cache = TableCache::new(1 << 26);
        let build = |spec| cache.get_or_build(spec).unwrap_or_else(|e| panic!("{e}"));
        let tables: Vec<Arc<Table>> = table_specs(&scene, &mesh, &plan).iter().map(build).collect();
        let frame = Renderer::new().render_with(&scene, &Model::new(&mesh), &plan, &tables);
        largest_error(frame.unwrap_or_else(|e| panic!("{e}")).image.pixels(), &truth)
    };
    let sound = {
        let _planted = Planted::new(Plant::Nothing);
        error()
    };
    let from = "return interpolate_plane(vec2<f32>(1.0 - 1.0 / sqrt(sqrt(1.0 + x)), sqrt(rho))).x;";
    let to = "return interpolate_plane(vec2<f32>(1.0 - 1.0 / sqrt(sqrt(1.0 + x)), sqrt(rho))).x + 1e-3;";
    let _planted = Planted::new(Plant::Shader(Edit { module: "weights::q", from, to }));
    let off = error();
    println!("by the table {sound:.1e}, by one that is off {off:.1e}");
    assert!(sound < twins::TOLERANCE && off > twins::TOLERANCE, "{sound:.1e}, {off:.1e}");
}
