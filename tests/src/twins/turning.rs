//! Mesh and camera elsewhere together.

use glam::{DQuat, DVec3};
use tetlux_scene::Camera;

use super::{Agreement, Twins};
use crate::{Random, Recipe};

/// About any axis by any angle.
pub fn turned(first: Recipe, seed: u64) -> Twins {
    let mut random = Random::new(seed ^ 0x7ed);
    let axis = DVec3::from([0; 3].map(|_| random.between(-1.0, 1.0)));
    let turn = DQuat::from_axis_angle(axis.normalize_or(DVec3::X), random.between(-3.0, 3.0));
    placed(first, |p| turn * p, |v| turn * v)
}

/// By multiples of the positions' own spacing: every difference of two positions is the same.
pub fn moved_exactly(first: Recipe, seed: u64) -> Twins {
    let mut random = Random::new(seed ^ 0x40b);
    let by = DVec3::from([0; 3].map(|_| random.between(-1e6, 1e6).round() / 1024.0));
    // The camera is on the same lattice.
    Twins { agreement: Agreement::Bits, ..placed(first, |p| (p * 1024.0).round() / 1024.0 + by, |v| v) }
}

/// By a thousand million times the mesh: doubles are 1e-7 apart there.
pub fn moved_far(mut first: Recipe, seed: u64) -> Twins {
    let mut random = Random::new(seed ^ 0xfa2);
    let by = DVec3::from([0; 3].map(|_| random.between(-1e9, 1e9)));
    // Off the lattice of positions, so that the sums are rounded.
    first.parts.points.iter_mut().for_each(|p| *p *= 0.7);
    placed(first, |p| p + by, |v| v)
}

fn placed(mut first: Recipe, place: impl Fn(DVec3) -> DVec3, turn: impl Fn(DVec3) -> DVec3) -> Twins {
    let Camera { position, focal_point, view_up, .. } = &mut first.camera;
    for p in [position, focal_point, view_up] {
        *p = (*p * 1024.0).round() / 1024.0;
    }
    let mut second = first.clone();
    second.parts.points.iter_mut().for_each(|p| *p = place(*p));
    let Camera { position, focal_point, view_up, .. } = first.camera;
    let (position, focal_point, view_up) = (place(position), place(focal_point), turn(view_up));
    second.camera = Camera { position, focal_point, view_up, ..first.camera };
    Twins::new(&first, &second)
}
