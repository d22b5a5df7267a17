//! Orders: a mesh assembled, what is found once for all its orders, and what each view costs by every method. On
//! procedural meshes, and on the NASA data sets where they are at hand.

use std::f64::consts::TAU;
use std::path::Path;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use glam::DVec3;
use tetlux_ingest::{ReadOptions, read_tet_mesh};
use tetlux_mesh::procedural::{Parts, Split, cuboid, sphere_shell};
use tetlux_mesh::{MeshError, TetMesh};
use tetlux_order::{Facts, Method, Orderer, Sampling};

/// Pixels along each side of the picture.
const SIDE: u32 = 800;

/// Views round a mesh, taken in turn.
const VIEWS: usize = 12;

fn views(mesh: &TetMesh) -> Vec<Sampling> {
    let [low, high] = mesh.bounds();
    let (middle, radius) = (0.5 * (low + high), 0.5 * low.distance(high));
    (0..VIEWS)
        .map(|i| {
            let t = 0.3 + i as f64 * TAU / VIEWS as f64;
            let away = DVec3::new(t.cos(), t.sin(), 0.7 * (2.0 * t).sin()).normalize();
            let right = away.any_orthonormal_vector();
            Sampling {
                eye: middle + away * (3.0 * radius),
                right,
                down: right.cross(away),
                forward: -away,
                pixel: 0.7 / f64::from(SIDE),
                size: [SIDE; 2],
                near: 0.0,
                orthographic: false,
            }
        })
        .collect()
}

fn meshes() -> Vec<(String, TetMesh)> {
    let assemble =
        |parts: Parts| -> Result<TetMesh, MeshError> { TetMesh::assemble(&parts.points, &parts.cells, vec![]) };
    let procedural = [
        ("grid", cuboid([32; 3], Split::Six, [DVec3::ZERO, DVec3::ONE])),
        ("shell", sphere_shell([64, 32, 16], Split::Six, DVec3::ZERO, [0.5, 1.0])),
    ];
    let mut meshes: Vec<(String, TetMesh)> = procedural
        .into_iter()
        .map(|(name, parts)| match assemble(parts) {
            Ok(mesh) => (name.into(), mesh),
            Err(error) => panic!("{name}: {error}"),
        })
        .collect();
    for (name, file) in [("blunt fin", "bluntfin_tets.vtu"), ("post", "post_tets.vtu")] {
        let path = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../shared/data/tets")).join(file);
        if path.exists() {
            match read_tet_mesh(&path, &ReadOptions::default(), tetlux_ingest::Split::Six) {
                Ok(mesh) => meshes.push((name.into(), mesh)),
                Err(error) => panic!("{name}: {error}"),
            }
        }
    }
    meshes
}

fn order(c: &mut Criterion) {
    for (name, mesh) in meshes() {
        let mut group = c.benchmark_group(format!("order {name}"));
        group.sample_size(10).throughput(Throughput::Elements(mesh.cells().len() as u64));
        let points: Vec<DVec3> = (0..mesh.points().len() as u32).map(|v| mesh.world(v)).collect();
        group.bench_function("assemble", |b| b.iter(|| TetMesh::assemble(&points, mesh.cells(), vec![])));
        group.bench_function("facts", |b| b.iter(|| Facts::new(&mesh)));
        let facts = Facts::new(&mesh);
        let views = views(&mesh);
        for method in Method::ALL {
            let (mut orderer, mut next) = (Orderer::new(), 0);
            group.bench_function(method.name(), |b| {
                b.iter(|| {
                    next = (next + 1) % VIEWS;
                    orderer.order(&mesh, &facts, &views[next], method).cells[0]
                });
            });
        }
        group.finish();
    }
}

criterion_group!(benches, order);
criterion_main!(benches);
