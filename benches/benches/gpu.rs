//! The wgpu back end: the radix sort, and the stage that draws, by projection, on the procedural wing and, where its file is
//! present, on the Blunt Fin. On a software driver these are processor seconds.

use std::time::Duration;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use tetlux_benches::{blunt_fin_mesh, stage_time, wing_mesh};
use tetlux_mesh::TetMesh;
use tetlux_optics::accuracy::Random;
use tetlux_render::{Model, Renderer};
use tetlux_scene::{Backend, CellProjection, Order, Plan, SceneFile};

const WING: &str = include_str!("../../scenes/wing.toml");
const BLUNT_FIN: &str = include_str!("../../scenes/bluntfin-smooth.toml");

/// Keys are sent, sorted and read back; on the processor they are sorted alone.
fn sort(c: &mut Criterion) {
    let renderer = Renderer::new();
    let mut group = c.benchmark_group("sort");
    group.sample_size(10);
    for count in [1 << 16, 1_000_003] {
        let mut random = Random::new(7);
        let keys: Vec<u32> = (0..count).map(|_| (random.unit() * f64::from(u32::MAX)) as u32).collect();
        group.throughput(Throughput::Elements(count));
        group.bench_function(format!("device, {count}"), |b| {
            b.iter(|| renderer.sort(&keys).unwrap_or_else(|e| panic!("{e}")));
        });
        group.bench_function(format!("std, {count}"), |b| {
            b.iter(|| {
                let mut order: Vec<u32> = (0..count as u32).collect();
                order.sort_by_key(|&i| keys[i as usize]);
                order
            });
        });
    }
    group.finish();
}

fn draw(c: &mut Criterion, name: &str, mesh: &TetMesh, file: &str) {
    let (renderer, model) = (Renderer::new(), Model::new(mesh));
    let file = SceneFile::parse(name, file).unwrap_or_else(|e| panic!("{e}"));
    let mut scene = file.scene(mesh, 0).unwrap_or_else(|e| panic!("{e}"));
    (scene.method.backend, scene.method.order) = (Backend::Gpu, Order::Centroid);
    let mut group = c.benchmark_group(format!("gpu/{name}"));
    group.sample_size(10).warm_up_time(Duration::from_millis(500)).measurement_time(Duration::from_secs(5));
    for projection in [CellProjection::Tiles, CellProjection::Pt] {
        scene.method.projection = projection;
        let plan = Plan::new(&scene, mesh, renderer.device()).unwrap_or_else(|e| panic!("{e}"));
        group.bench_function(format!("draw, {projection}"), |b| {
            b.iter_custom(|runs| stage_time(&renderer, &scene, &model, &plan, "draw", runs));
        });
    }
    group.finish();
}

fn wing(c: &mut Criterion) {
    draw(c, "wing", &wing_mesh(), WING);
}

fn blunt_fin(c: &mut Criterion) {
    if let Some(mesh) = blunt_fin_mesh() {
        draw(c, "blunt fin smooth", &mesh, BLUNT_FIN);
    }
}

criterion_group!(benches, sort, wing, blunt_fin);
criterion_main!(benches);
