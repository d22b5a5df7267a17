//! A mesh from the cache, against reading the bytes that it is kept in, and against making it of its file.

use std::fs;
use std::path::Path;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use tetlux_ingest::{Cache, CacheOutcome, ReadOptions, Split, read_cached};

/// Points along an edge of a cubic grid: 355 914 tetrahedra.
const SIDE: usize = 40;

/// Writes a grid with a value at each point.
fn write_grid(path: &Path) -> std::io::Result<()> {
    let points = SIDE * SIDE * SIDE;
    let mut bytes = format!(
        "# vtk DataFile Version 3.0\ngrid\nBINARY\nDATASET STRUCTURED_POINTS\nDIMENSIONS {SIDE} {SIDE} {SIDE}\n\
         ORIGIN 0 0 0\nSPACING 1 1 1\nPOINT_DATA {points}\nSCALARS f float\nLOOKUP_TABLE default\n"
    )
    .into_bytes();
    bytes.extend((0..points).flat_map(|i| ((i % 1009) as f32).to_be_bytes()));
    fs::write(path, bytes)
}

fn cached(c: &mut Criterion) {
    let folder = tempfile::tempdir().expect("a folder for temporary files");
    let path = folder.path().join("grid.vtk");
    write_grid(&path).expect("the folder can be written to");
    let cache = Cache::in_folder(folder.path().join("cache"));
    let load = |cache: Option<&Cache>| {
        read_cached(&path, &ReadOptions::default(), Split::Six, cache).expect("the file was just written")
    };
    // Older than the time after which the file's stamp is trusted, as files mostly are.
    std::thread::sleep(std::time::Duration::from_secs(3));
    assert!(matches!(load(Some(&cache)).outcome, CacheOutcome::Stored(_)));
    assert_eq!(load(Some(&cache)).outcome, CacheOutcome::Hit);
    let kept = cache.entries().expect("the cache can be listed").remove(0);

    let mut group = c.benchmark_group("cache");
    group.throughput(Throughput::Bytes(kept.bytes));
    group.bench_function("the bytes alone", |b| b.iter(|| fs::read(&kept.path)));
    group.bench_function("mesh from the cache", |b| b.iter(|| load(Some(&cache))));
    group.sample_size(10);
    group.bench_function("mesh from its file", |b| b.iter(|| load(None)));
    group.finish();
}

criterion_group!(benches, cached);
criterion_main!(benches);
