//! Space and extinction in other units.

use tetlux_scene::{Camera, Projection};

use super::{Agreement, Twins};
use crate::{Random, Recipe};

/// By a power of two, up to 1e12 either way: every number on the way to the pixels is the same but for its exponent.
pub fn by_power_of_two(first: Recipe, seed: u64) -> Twins {
    let mut random = Random::new(seed);
    let exponent = [-40, 40, -1, 1].get(seed as usize).copied().unwrap_or(random.below(81) as i32 - 40);
    Twins { agreement: Agreement::Bits, ..scaled(&first, 2f64.powi(exponent)) }
}

/// By any number from 1e-12 to 1e12.
pub fn by_any(first: Recipe, seed: u64) -> Twins {
    let mut random = Random::new(seed);
    let exponent = [-12.0, 12.0].get(seed as usize).copied().unwrap_or(random.between(-12.0, 12.0));
    scaled(&first, 10f64.powf(exponent))
}

fn scaled(first: &Recipe, factor: f64) -> Twins {
    let mut second = first.clone();
    second.parts.points.iter_mut().for_each(|p| *p *= factor);
    second.unit_distance *= factor;
    let Camera { position, focal_point, projection, near, .. } = first.camera;
    let projection = match projection {
        Projection::Orthographic { parallel_scale } => {
            Projection::Orthographic { parallel_scale: parallel_scale * factor }
        }
        perspective @ Projection::Perspective { .. } => perspective,
    };
    let (position, focal_point) = (position * factor, focal_point * factor);
    second.camera = Camera { position, focal_point, projection, near: near * factor, ..first.camera };
    Twins::new(first, &second)
}
