//! What is computed of fields, tables and pictures beside the way of a cell to a pixel: gradients, ranges, histograms,
//! lookups, classification by two fields, and what judges and writes a picture.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use glam::DVec3;
use tetlux_benches::{cube_mesh, scene};
use tetlux_image::{Encoding, Image, compare, write_exr, write_png};
use tetlux_mesh::{Component, ScalarField, TetMesh, procedural};
use tetlux_optics::Classification;
use tetlux_optics::widget::{BivariateFunction, Shape, Widget};
use tetlux_render::{Model, Renderer};
use tetlux_scene::{Backend, CellProjection, Classification as Where, Histogram, Method, Plan, gradient_magnitude};
use tetlux_tables::{Table, TableSpec, sample_weights};

/// Hexahedra along an edge of the cube: 93 312 tetrahedra.
const SIDE: usize = 25;
/// Pixels along an edge of pictures.
const PIXELS: u32 = 800;

fn waves(mesh: &TetMesh) -> ScalarField {
    mesh.scalar("waves", Component::Magnitude).unwrap_or_else(|e| panic!("{e}"))
}

fn fields(c: &mut Criterion) {
    let mesh = cube_mesh(SIDE);
    let scalar = waves(&mesh);
    let mut group = c.benchmark_group("fields");
    group.throughput(Throughput::Elements(mesh.cells().len() as u64));
    group.bench_function("ranges of cells", |b| b.iter(|| mesh.scalar_ranges(&scalar)));
    group.bench_function("gradients at points", |b| b.iter(|| mesh.vertex_gradients(&scalar)));
    let magnitude = gradient_magnitude(&scalar, &mesh.vertex_gradients(&scalar));
    group.sample_size(10);
    group.bench_function("histogram", |b| {
        b.iter(|| Histogram::new(&mesh, [&scalar, &magnitude], [None; 2], [400, 300]));
    });
    group.bench_function("procedural wing", |b| b.iter(|| procedural::wing(1, mesh.cells().len())));
    group.finish();
}

fn lookups(c: &mut Criterion) {
    let depths: Vec<(f32, f32)> = (0..1000).map(|i| (1e-4 * 1.02f32.powi(i), 1e-3 * 1.015f32.powi(999 - i))).collect();
    let mut group = c.benchmark_group("lookups");
    group.throughput(Throughput::Elements(depths.len() as u64));
    for id in ["psi", "q"] {
        let spec = TableSpec::named(id).unwrap_or_else(|e| panic!("{e}"));
        let table = Table::build(&spec).unwrap_or_else(|e| panic!("{e}"));
        group.bench_function(id, |b| {
            b.iter(|| depths.iter().map(|&(p, q)| sample_weights(&table, p, q)[1]).sum::<f32>());
        });
    }
    group.finish();
}

/// Pictures that take other ways than those of one field's default.
fn ways(c: &mut Criterion) {
    let mesh = cube_mesh(SIDE);
    let (renderer, model) = (Renderer::new(), Model::new(&mesh));
    let mut group = c.benchmark_group("ways");
    group.sample_size(10);
    let mut draw = |name: &str, scene: &tetlux_scene::Scene| {
        let plan = Plan::new(scene, &mesh, renderer.device()).unwrap_or_else(|e| panic!("{name}: {e}"));
        group.bench_function(name, |b| b.iter(|| renderer.render(scene, &model, &plan)));
    };
    let gpu = Method { backend: Backend::Gpu, ..Method::default() };
    draw("gpu march", &scene(&mesh, true, Method { projection: CellProjection::March, ..gpu }));
    draw("gpu post-clip", &scene(&mesh, true, Method { classification: Where::PostClip, ..gpu }));
    let mut two_fields = scene(&mesh, true, Method::default());
    let magnitude = gradient_magnitude(&two_fields.scalar, &mesh.vertex_gradients(&two_fields.scalar));
    let middle = |range: [f64; 2]| 0.5 * (range[0] + range[1]);
    let center = [middle(two_fields.scalar.range), middle(magnitude.range)];
    let shape = Shape::Gaussian { center, sigma: [0.3, 0.2 * center[1]] };
    let widget = Widget::new(shape, None, 2.0, [1.0, 0.5, 0.2]).unwrap_or_else(|e| panic!("{e}"));
    two_fields.second = Some(magnitude);
    two_fields.classification = Classification::Widgets(BivariateFunction { widgets: vec![widget] });
    draw("cpu widget", &two_fields);
    group.finish();
}

fn pictures(c: &mut Criterion) {
    let value = |i: u32, shift: f32| {
        let p = DVec3::new(f64::from(i % PIXELS), f64::from(i / PIXELS), f64::from(shift)) * 0.01;
        let alpha = (0.5 + 0.5 * p.x.sin() * p.y.cos()) as f32;
        [alpha * 0.8, alpha * 0.4, alpha * (0.1 + shift), alpha]
    };
    let image = |shift: f32| {
        let pixels = (0..PIXELS * PIXELS).map(|i| value(i, shift)).collect();
        Image::from_pixels(PIXELS, PIXELS, pixels).unwrap_or_else(|e| panic!("{e}"))
    };
    let (one, other) = (image(0.0), image(1e-4));
    let folder = tempfile::tempdir().expect("a folder for temporary files");
    let mut group = c.benchmark_group("pictures");
    group.sample_size(20).throughput(Throughput::Elements(u64::from(PIXELS * PIXELS)));
    group.bench_function("compare", |b| b.iter(|| compare(&one, &other, 1e-3)));
    group.bench_function("png", |b| b.iter(|| write_png(&one, &folder.path().join("a.png"), Encoding::Srgb)));
    group.bench_function("exr", |b| b.iter(|| write_exr(&one, &folder.path().join("a.exr"), None)));
    group.finish();
}

criterion_group!(benches, fields, lookups, ways, pictures);
criterion_main!(benches);
