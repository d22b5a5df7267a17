//! The hexahedra of structured grids.

use tetlux_mesh::procedural::Split;

use super::{Tetrahedra, pull};
use crate::StructuredGrid;
use crate::cell_type::{CellType, HEXAHEDRON};

/// Faces of a hexahedron, first the corners on the diagonal along which [`Split::Six`] cuts it.
const DIAGONALS: [[usize; 4]; 6] = [[0, 2, 1, 3], [4, 6, 5, 7], [0, 5, 1, 4], [1, 6, 2, 5], [3, 6, 2, 7], [0, 7, 3, 4]];

/// Splits the hexahedra of all grids; the first one is cell number `first_cell`.
pub(super) fn split(grids: &[StructuredGrid], split: Split, mut first_cell: usize, made: &mut Tetrahedra) {
    let five = (split == Split::Five).then(|| colors(grids, made)).flatten();
    let Some(hexahedron) = CellType::of(HEXAHEDRON) else { return };
    for (g, grid) in grids.iter().enumerate() {
        grid.for_each_visible(|number, [i, j, k], corners| {
            let origin = first_cell + number;
            if let Some(colors) = &five {
                let cells = Split::Five.hexahedron(corners, [i + usize::from(colors[g]), j, k]);
                cells.for_each(|cell| made.push(cell, origin));
            } else if DIAGONALS.iter().all(|face| cut_along_diagonal(face.map(|i| made.rank(corners[i])))) {
                Split::Six.hexahedron(corners, [i, j, k]).for_each(|cell| made.push(cell, origin));
            } else {
                pull(hexahedron, &corners, origin, made);
            }
        });
        first_cell += grid.hexahedra();
    }
}

/// Whether a face cut from its smallest corner is cut along the diagonal of the first two, or is a triangle anyway
/// since two corners coincide. Inside a grid it always is; not where two sides of grids meet that run different ways.
fn cut_along_diagonal([a, b, c, d]: [u32; 4]) -> bool {
    a.min(b) <= c.min(d) || [a, b].iter().any(|v| [c, d].contains(v))
}

/// For each grid whether it must begin with the other of the two kinds of hexahedra that alternate, so that points of
/// different grids that coincide are of one colour. `None` if there is no such choice. What coincides within a grid is
/// not looked at.
fn colors(grids: &[StructuredGrid], made: &Tetrahedra) -> Option<Vec<bool>> {
    // Grids that are joined have one number, and each its colour relative to the others of that number.
    let mut joined: Vec<(usize, bool)> = (0..grids.len()).map(|g| (g, false)).collect();
    if grids.len() < 2 {
        return Some(vec![false; grids.len()]);
    }
    let end = |g: usize| grids[g].first_point + grids[g].points().unwrap_or(0);
    let mut order: Vec<usize> = (0..grids.len()).collect();
    order.sort_unstable_by_key(|&g| grids[g].first_point);
    if order.windows(2).any(|pair| end(pair[0]) > grids[pair[1]].first_point) {
        return None;
    }
    let place = |point: u32| {
        let point = point as usize;
        let next = order.partition_point(|&g| grids[g].first_point <= point);
        let g = *order.get(next.checked_sub(1)?)?;
        let [ni, nj, _] = grids[g].counts;
        let local = point - grids[g].first_point;
        (point < end(g)).then_some((g, (local % ni + local / ni % nj + local / (ni * nj)) % 2 == 1))
    };
    for point in 0..made.points.len() as u32 {
        let first = made.rank(point);
        if first == point {
            continue;
        }
        let (Some((a, odd)), Some((b, other_odd))) = (place(point), place(first)) else { continue };
        if a == b {
            continue;
        }
        let flip = joined[a].1 ^ odd ^ joined[b].1 ^ other_odd;
        let (from, to) = (joined[a].0, joined[b].0);
        if from != to {
            joined.iter_mut().filter(|(number, _)| *number == from).for_each(|(number, color)| {
                (*number, *color) = (to, *color ^ flip);
            });
        } else if flip {
            return None;
        }
    }
    Some(joined.into_iter().map(|(_, color)| color).collect())
}

#[cfg(test)]
mod tests;
