//! Every hot routine on the way from points to a picture. CPU seconds on shared machines are noisy: compare ratios
//! within one run.

use std::hint::black_box;

use criterion::{BatchSize, Criterion, Throughput, criterion_group, criterion_main};
use tetlux_benches::{cube, cube_mesh, scene, transfer};
use tetlux_mesh::{Component, TetMesh};
use tetlux_optics::Classification;
use tetlux_optics::accuracy::Random;
use tetlux_optics::emission::density_weights;
use tetlux_optics::segment::weights;
use tetlux_optics::segment_f32::weights_direct;
use tetlux_optics::symmetric_f32::weights_symmetric;
use tetlux_optics::transfer_f32::{Weights, integrate, piece_at, pieces};
use tetlux_optics::widget::{BivariateFunction, Shape, Widget};
use tetlux_order::{Eye, centroid};
use tetlux_reference::{Caster, DEFAULT_TOLERANCE, Ray};
use tetlux_render::{Model, Renderer};
use tetlux_scene::{Backend, CellBoxes, Method, Order, Plan};
use tetlux_tables::{Table, TableSpec};

/// Hexahedra along an edge of the cube: 93 312 tetrahedra.
const SIDE: usize = 25;

fn mesh(c: &mut Criterion) {
    let (parts, field) = cube(SIDE);
    let mut group = c.benchmark_group("mesh");
    group.throughput(Throughput::Elements(parts.cells.len() as u64));
    group.bench_function("assemble", |b| {
        b.iter_batched(
            || vec![field.clone()],
            |fields| TetMesh::assemble(&parts.points, &parts.cells, fields),
            BatchSize::LargeInput,
        );
    });
    let mesh = cube_mesh(SIDE);
    group.bench_function("validate", |b| b.iter(|| black_box(&mesh).validate()));
    group.finish();
}

fn order(c: &mut Criterion) {
    let mesh = cube_mesh(SIDE);
    let cells: Vec<u32> = (0..mesh.cells().len() as u32).collect();
    let mut group = c.benchmark_group("order");
    group.throughput(Throughput::Elements(cells.len() as u64));
    group.bench_function("centroid", |b| b.iter(|| centroid(&mesh, Eye::Point([3.0, -4.0, 2.0].into()), &cells)));
    group.finish();
}

fn optics(c: &mut Criterion) {
    let depths: Vec<(f64, f64)> = (0..1000).map(|i| (1e-4 * 1.02f64.powi(i), 1e-3 * 1.015f64.powi(999 - i))).collect();
    let mut group = c.benchmark_group("optics");
    group.throughput(Throughput::Elements(depths.len() as u64));
    group.bench_function("weights f64", |b| {
        b.iter(|| depths.iter().map(|&(p, q)| weights(p, q).back).sum::<f64>());
    });
    group.bench_function("density_weights f64", |b| {
        b.iter(|| depths.iter().map(|&(p, q)| density_weights(p, q).back).sum::<f64>());
    });
    group.bench_function("weights_symmetric f32", |b| {
        b.iter(|| depths.iter().map(|&(p, q)| weights_symmetric(p as f32, q as f32)[1]).sum::<f32>());
    });
    group.bench_function("weights_direct f32", |b| {
        b.iter(|| depths.iter().map(|&(p, q)| weights_direct(p as f32, q as f32)[1]).sum::<f32>());
    });
    for (name, smooth) in [("integrate smooth", true), ("integrate peaks", false)] {
        let pieces = pieces(&transfer(smooth), [-2.0, 2.0], 1.0);
        group.bench_function(name, |b| {
            b.iter(|| {
                let segment = |i: usize| {
                    let (front, back) = (i as f32 * 1e-3, 0.05 + i as f32 * 0.95e-3);
                    let range = [piece_at(&pieces, front.min(back)), piece_at(&pieces, front.max(back))];
                    integrate(&pieces, range, Weights::Direct, front, back, 0.1)[3]
                };
                (0..1000).map(segment).sum::<f32>()
            });
        });
    }
    group.bench_function("pieces", |b| b.iter(|| pieces(&transfer(true), [-2.0, 2.0], 1.0)));
    group.finish();
}

fn culling(c: &mut Criterion) {
    let widget = |x: f64| {
        let shape = Shape::Gaussian { center: [x, 0.5], sigma: [0.02, 0.02] };
        Widget::new(shape, None, 2.0, [1.0; 3]).unwrap_or_else(|e| panic!("{e}"))
    };
    let mut random = Random::new(3);
    let mut ranges = || -> Vec<[f64; 2]> {
        let low = |_| random.unit();
        (0..500_000).map(low).map(|x| [x, x + 0.03]).collect()
    };
    let (first, second) = (ranges(), ranges());
    let mut group = c.benchmark_group("culling");
    group.throughput(Throughput::Elements(first.len() as u64));
    group.bench_function("boxes", |b| b.iter(|| CellBoxes::new(&first, &second)));
    let boxes = CellBoxes::new(&first, &second);
    for count in [1, 5] {
        let function = BivariateFunction { widgets: (0..count).map(|k| widget(0.1 + 0.2 * f64::from(k))).collect() };
        group.bench_function(format!("{count} widgets"), |b| {
            b.iter(|| boxes.visible(&function));
        });
    }
    group.finish();
}

fn tables(c: &mut Criterion) {
    let mut group = c.benchmark_group("tables");
    group.sample_size(10);
    for spec in TableSpec::defaults() {
        group.bench_function(&spec.id, |b| b.iter(|| Table::build(&spec)));
    }
    group.finish();
}

fn picture(c: &mut Criterion) {
    let mesh = cube_mesh(SIDE);
    let (renderer, model) = (Renderer::new(), Model::new(&mesh));
    let mut group = c.benchmark_group("picture");
    group.sample_size(10);
    for (name, backend, order) in [
        ("cpu centroid", Backend::Cpu, Order::Centroid),
        ("cpu pixel", Backend::Cpu, Order::Pixel),
        ("cpu exact", Backend::Cpu, Order::Exact),
        ("gpu centroid", Backend::Gpu, Order::Centroid),
        ("gpu exact", Backend::Gpu, Order::Exact),
    ] {
        let scene = scene(&mesh, true, Method { backend, order, ..Method::default() });
        let plan = match Plan::new(&scene, &mesh, renderer.device()) {
            Ok(plan) => plan,
            Err(error) => panic!("{name}: {error}"),
        };
        group.bench_function(name, |b| b.iter(|| renderer.render(&scene, &model, &plan)));
    }
    let scene = scene(&mesh, true, Method::default());
    group.bench_function("plan", |b| b.iter(|| Plan::new(&scene, &mesh, renderer.device())));
    group.finish();
}

fn reference(c: &mut Criterion) {
    let mesh = cube_mesh(SIDE);
    let scalar = mesh.scalar("waves", Component::Magnitude).unwrap_or_else(|e| panic!("{e}"));
    let classification = Classification::OneField(transfer(true));
    let scene = tetlux_reference::Scene {
        mesh: &mesh,
        scalar: &scalar,
        second: None,
        classification: &classification,
        lighting: None,
        colors: None,
        unit_distance: 1.0,
        tolerance: DEFAULT_TOLERANCE,
    };
    let caster = Caster::new(scene).unwrap_or_else(|e| panic!("{e}"));
    let ray =
        Ray { origin: [3.0, -4.0, 2.0].into(), direction: [-3.01, 4.02, -1.9].into(), start: 0.0, end: f64::INFINITY };
    let mut group = c.benchmark_group("reference");
    group.throughput(Throughput::Elements(caster.cast(&ray).segments as u64));
    group.bench_function("ray", |b| b.iter(|| caster.cast(black_box(&ray))));
    group.finish();
}

criterion_group!(benches, mesh, order, optics, culling, tables, picture, reference);
criterion_main!(benches);
