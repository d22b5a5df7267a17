//! The same rays from their other ends: what is absorbed does not depend on the way.

use glam::DVec3;
use tetlux_scene::Camera;

use super::Twins;
use crate::{Random, Recipe, orthographic, perspective};

/// Parallel rays through the whole mesh: the picture is mirrored.
pub fn parallel(first: Recipe, seed: u64) -> Twins {
    let first = Recipe { camera: beside(seed, |from, to| orthographic(from, to, 1.5)), ..first };
    Twins { mirrored: true, ..reversed(&first) }
}

/// One ray of perspective, between an eye on this side and one on that.
pub fn ray(first: Recipe, seed: u64) -> Twins {
    let first = Recipe { camera: beside(seed, |from, to| perspective(from, to, 1.0)), side: 1, ..first };
    reversed(&first)
}

/// Outside every random mesh.
const DISTANCE: f64 = 8.0;

fn beside(seed: u64, camera: impl Fn(DVec3, DVec3) -> Camera) -> Camera {
    let mut random = Random::new(seed ^ 0xbac);
    let [toward, focus] = [0; 2].map(|_| DVec3::from([0; 3].map(|_| random.between(-1.0, 1.0))));
    let focus = focus * 0.3;
    camera(focus + toward.normalize_or(DVec3::X) * DISTANCE, focus)
}

fn reversed(first: &Recipe) -> Twins {
    let mut second = first.clone();
    second.camera.position = first.camera.focal_point * 2.0 - first.camera.position;
    Twins { channels: 3..4, ..Twins::new(first, &second) }
}
