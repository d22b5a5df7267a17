//! The plan: alone, for a new transfer function on a loaded mesh, and a whole picture without each thing that it skips.
//!
//! On the procedural wing and, where its file is present, on the Oxygen Post. Wall time, all cores.

use std::path::Path;
use std::time::{Duration, Instant};

use criterion::{Criterion, criterion_group, criterion_main};
use tetlux_benches::wing_mesh;
use tetlux_ingest::{ReadOptions, Split, read_tet_mesh};
use tetlux_mesh::TetMesh;
use tetlux_render::{Model, Renderer};
use tetlux_scene::{Backend, Order, Planner, Scene, SceneFile, Skip};

const WING: &str = include_str!("../../scenes/wing.toml");
const POST: [&str; 2] = [include_str!("../../scenes/post-smooth.toml"), include_str!("../../scenes/post-spiky.toml")];

/// What comes before the first cell is set up.
const BEFORE: [&str; 4] = ["facts", "order", "prepare", "project"];

fn plans(c: &mut Criterion, name: &str, mesh: &TetMesh, scenes: [&Scene; 2]) {
    let (renderer, model, planner) = (Renderer::new(), Model::new(mesh), Planner::new(mesh));
    let mut group = c.benchmark_group(format!("plan/{name}"));
    group.sample_size(10).warm_up_time(Duration::from_millis(500)).measurement_time(Duration::from_secs(2));
    let plan = |scene: &Scene| planner.plan(scene, renderer.device()).unwrap_or_else(|e| panic!("{e}"));
    let draw = |scene: &Scene| {
        let plan = plan(scene);
        renderer.render(scene, &model, &plan).unwrap_or_else(|e| panic!("{e}"))
    };
    group.bench_function("first", |b| {
        b.iter(|| Planner::new(mesh).plan(scenes[0], renderer.device()).map(|plan| plan.cells.len()));
    });
    // Only the function changes: from one to the other and back.
    group.bench_function("new function: plan", |b| {
        b.iter_custom(|runs| {
            let start = Instant::now();
            (0..runs).for_each(|k| drop(plan(scenes[k as usize % 2])));
            start.elapsed()
        });
    });
    group.bench_function("new function: order and mesh", |b| {
        draw(scenes[1]);
        b.iter_custom(|runs| {
            let seconds = (0..runs).map(|k| {
                let stages = draw(scenes[k as usize % 2]).stages;
                stages.iter().filter(|s| BEFORE.contains(&s.name)).map(|s| s.wall).sum::<f64>()
            });
            Duration::from_secs_f64(seconds.sum())
        });
    });
    for skip in std::iter::once(None).chain(Skip::ALL.iter().copied().map(Some)) {
        let mut scene = scenes[0].clone();
        scene.method.no_skip = skip.into_iter().collect();
        let label = skip.map_or("a further picture".into(), |skip| format!("a further picture without {skip}"));
        group.bench_function(label, |b| b.iter(|| draw(&scene)));
    }
    group.finish();
}

fn scene(mesh: &TetMesh, file: &str) -> Scene {
    let file = SceneFile::parse("scene", file).unwrap_or_else(|e| panic!("{e}"));
    let mut scene = file.scene(mesh, 0).unwrap_or_else(|e| panic!("{e}"));
    (scene.method.backend, scene.method.order) = (Backend::Cpu, Order::Exact);
    scene
}

fn wing(c: &mut Criterion) {
    let mesh = wing_mesh();
    let (first, mut second) = (scene(&mesh, WING), scene(&mesh, WING));
    if let tetlux_optics::Classification::OneField(transfer) = &mut second.classification {
        *transfer = transfer.with_fewer_colors(0.1);
    }
    plans(c, "wing", &mesh, [&first, &second]);
}

fn post(c: &mut Criterion) {
    let path = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../shared/data/tets/post_tets.vtu"));
    if path.exists() {
        let mesh = read_tet_mesh(path, &ReadOptions::default(), Split::default()).unwrap_or_else(|e| panic!("{e}"));
        let [smooth, spiky] = POST.map(|file| scene(&mesh, file));
        plans(c, "post", &mesh, [&smooth, &spiky]);
    }
}

criterion_group!(benches, wing, post);
criterion_main!(benches);
