//! Cells and points in another order.

use super::Twins;
use crate::{Random, Recipe};

/// Cells in another order, and the vertices of each.
pub fn cells(first: Recipe, seed: u64) -> Twins {
    let mut second = first.clone();
    let mut random = Random::new(seed ^ 0x9e1);
    shuffle(&mut second.parts.cells, &mut random);
    second.parts.cells.iter_mut().for_each(|cell| shuffle(cell, &mut random));
    Twins::new(&first, &second)
}

/// Points in another order.
pub fn points(first: Recipe, seed: u64) -> Twins {
    let mut second = first.clone();
    let mut of: Vec<u32> = (0..first.parts.points.len() as u32).collect();
    shuffle(&mut of, &mut Random::new(seed ^ 0x9017));
    let mut place = vec![0; of.len()];
    for (new, &old) in of.iter().enumerate() {
        place[old as usize] = new as u32;
        second.parts.points[new] = first.parts.points[old as usize];
        let of = |point: usize| point * first.field.components..(point + 1) * first.field.components;
        second.field.values[of(new)].copy_from_slice(&first.field.values[of(old as usize)]);
    }
    second.parts.cells.iter_mut().for_each(|cell| *cell = cell.map(|v| place[v as usize]));
    Twins::new(&first, &second)
}

/// Every order is as likely (Fisher and Yates).
fn shuffle<T>(items: &mut [T], random: &mut Random) {
    for i in (1..items.len()).rev() {
        items.swap(i, random.below(i + 1));
    }
}
