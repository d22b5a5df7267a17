//! The stages of the CPU back end's tiles, one thread, on the procedural wing and, where its file is present, on the
//! Blunt Fin. Cells are in centroid order, or sorted in every pixel.

use std::time::Duration;

use criterion::{Criterion, criterion_group, criterion_main};
use tetlux_benches::{blunt_fin_mesh, stage_time, wing_mesh};
use tetlux_mesh::TetMesh;
use tetlux_render::{Model, Renderer};
use tetlux_scene::{Backend, Order, Plan, SceneFile};

const WING: &str = include_str!("../../scenes/wing.toml");
const SCENES: [(&str, &str); 2] = [
    ("blunt fin smooth", include_str!("../../scenes/bluntfin-smooth.toml")),
    ("blunt fin spiky", include_str!("../../scenes/bluntfin-spiky.toml")),
];

fn stages(c: &mut Criterion, name: &str, mesh: &TetMesh, file: &str) {
    let (renderer, model) = (Renderer::new(), Model::new(mesh));
    let file = SceneFile::parse(name, file).unwrap_or_else(|e| panic!("{e}"));
    let mut scene = file.scene(mesh, 0).unwrap_or_else(|e| panic!("{e}"));
    scene.method.backend = Backend::Cpu;
    let mut group = c.benchmark_group(format!("tiles/{name}"));
    group.sample_size(10).warm_up_time(Duration::from_millis(500)).measurement_time(Duration::from_secs(2));
    for (order, names) in [(Order::Centroid, &["set up", "bin", "draw"][..]), (Order::Pixel, &["draw"])] {
        scene.method.order = order;
        let plan = Plan::new(&scene, mesh, renderer.device()).unwrap_or_else(|e| panic!("{e}"));
        for stage in names {
            group.bench_function(format!("{stage}, order {order}"), |b| {
                b.iter_custom(|runs| stage_time(&renderer, &scene, &model, &plan, stage, runs));
            });
        }
    }
    group.finish();
}

fn wing(c: &mut Criterion) {
    stages(c, "wing", &wing_mesh(), WING);
}

fn blunt_fin(c: &mut Criterion) {
    if let Some(mesh) = blunt_fin_mesh() {
        SCENES.into_iter().for_each(|(name, file)| stages(c, name, &mesh, file));
    }
}

criterion_group!(benches, wing, blunt_fin);
criterion_main!(benches);
