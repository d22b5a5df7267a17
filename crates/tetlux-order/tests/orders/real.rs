//! The NASA data sets, where they are at hand.

use std::path::PathBuf;

use glam::DVec3;
use tetlux_ingest::{ReadOptions, Split, read_tet_mesh};
use tetlux_order::Method::{Centroid, Exact};

use crate::Judge;
use crate::random::Random;
use crate::views::{orthographic, perspective};

/// Pixels along each side: what the test may take of time.
const SIDE: u32 = 128;

/// A file of the data sets; `None`, with a line that says so, where it is absent.
fn data(name: &str) -> Option<PathBuf> {
    let path = PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/data")).join(name);
    if !path.exists() {
        println!("the data set {name} is absent: not tested");
    }
    path.exists().then_some(path)
}

fn assert_real(file: &str, solution: Option<&str>, split: Split) {
    let Some(path) = data(file) else { return };
    let Some(solution) = solution.map_or(Some(None), |name| data(name).map(Some)) else { return };
    let mesh = read_tet_mesh(&path, &ReadOptions { solution, ..ReadOptions::default() }, split).unwrap();
    let [low, high] = mesh.bounds();
    let (middle, radius) = (0.5 * (low + high), 0.5 * low.distance(high));
    let mut random = Random::new(3);
    let mut judge = Judge::new(file, &mesh);
    let away = middle + random.point(1.0).normalize() * (2.5 * radius);
    let within = middle + random.point(0.3) * (high - low);
    for (from, view) in [
        ("away", perspective(away, middle, 0.4, SIDE)),
        ("inside", perspective(within, middle + DVec3::splat(0.01), 1.0, SIDE)),
        ("parallel", orthographic(away, middle, 0.8 * radius, SIDE)),
    ] {
        let found = judge.assert_right(from, &view, Exact);
        assert!(found.rays > 1000 && found.intervals > 5 * found.rays as u64, "{file}, {from}: {} rays", found.rays);
        assert!(judge.judge(&view, Centroid).inverted.len() > found.rays / 2, "{file}, {from}: by centroid");
    }
}

#[test]
fn blunt_fin() {
    assert_real("tets/bluntfin_tets.vtu", None, Split::Six);
    assert_real("bluntfinxyz.bin", Some("bluntfinq.bin"), Split::Five);
}

#[test]
fn post() {
    assert_real("tets/post_tets.vtu", None, Split::Six);
    assert_real("postxyz.bin", Some("postq.bin"), Split::Six);
}

#[test]
fn disk() {
    assert_real("disk_out_ref.ex2", None, Split::Six);
    assert_real("notch_stress.vtk", None, Split::Six);
}
