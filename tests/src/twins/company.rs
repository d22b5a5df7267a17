//! Cells that are clear, and as good as none.

use glam::DVec3;
use tetlux_mesh::Field;
use tetlux_mesh::procedural::{Split, cuboid};
use tetlux_optics::{Classification, TransferFunction};
use tetlux_scene::{Skip, SkipSet};

use super::Twins;
use crate::{FIELD, Random, Recipe, range_of, transfer};

/// A mesh full of holes, and one whose holes are filled. Every cell has a value of its own.
pub fn filled(mut second: Recipe, seed: u64) -> Twins {
    let mut random = Random::new(seed ^ 0xf11);
    let mut values: Vec<f64> = second.parts.cells.iter().map(|_| random.between(0.0, 1.0)).collect();
    // The range is the same with the holes and without.
    (values[0], values[1]) = (0.0, 1.0);
    let colors = [0.0, 0.3, 0.7, 1.0].map(|s| [s, random.between(0.0, 1.0), random.between(0.0, 1.0), s]);
    let mut height = || random.between(0.0, 3.0);
    let opacity = [[0.0, height()], [0.2, height()], [0.3, 0.0], [0.7, 0.0], [0.8, height()], [1.0, height()]];
    second.classification = Classification::OneField(transfer(&colors, &opacity));
    second.field = Field::cell(FIELD, 1, values.clone());
    let mut first = second.clone();
    let is_clear = |value: f64| (0.3..=0.7).contains(&value);
    let mut cells = values.iter();
    first.parts.cells.retain(|_| cells.next().is_some_and(|&value| !is_clear(value)));
    first.field.values.retain(|&value| !is_clear(value));
    undropped(Twins::new(&first, &second))
}

/// Bodies about the mesh, before it and behind it, all of one value whose opacity is zero.
pub fn about(mut first: Recipe, seed: u64) -> Twins {
    let mut random = Random::new(seed ^ 0xab0);
    let [low, high] = range_of(&first.field);
    let clear = [0.45, 0.55].map(|share| low + (high - low) * share);
    first.classification = Classification::OneField(cleared(first.transfer(), clear));
    let mut second = first.clone();
    for _ in 0..3 {
        let direction = DVec3::from([0; 3].map(|_| random.between(-1.0, 1.0))).normalize_or(DVec3::X);
        let middle = (direction * 5.0 * 1024.0).round() / 1024.0;
        second.parts.append(&cuboid([2, 1, 1], Split::Six, [middle - DVec3::splat(0.5), middle + DVec3::splat(0.5)]));
    }
    second.field.values.resize(second.parts.points.len(), 0.5 * (clear[0] + clear[1]));
    undropped(Twins::new(&first, &second))
}

/// With clear cells drawn too: there they could do harm.
fn undropped(mut twins: Twins) -> Twins {
    for (_, scene) in &mut twins.pair {
        scene.method.no_skip = SkipSet::NONE.with(Skip::Transparent);
    }
    twins
}

/// A transfer function without opacity between two scalars.
fn cleared(function: &TransferFunction, [low, high]: [f64; 2]) -> TransferFunction {
    let color: Vec<[f64; 4]> = function.color_nodes().iter().map(|n| [n.s, n.rgb[0], n.rgb[1], n.rgb[2]]).collect();
    let nodes = || function.opacity_nodes().iter().map(|n| [n.s, n.opacity]);
    let before = nodes().filter(|n| n[0] < low).chain([[low, function.opacity_below(low)], [low, 0.0]]);
    let behind = [[high, 0.0], [high, function.opacity(high)]].into_iter().chain(nodes().filter(|n| n[0] > high));
    let opacity: Vec<[f64; 2]> = before.chain(behind).collect();
    transfer(&color, &opacity)
}
