//! Meshes whose cells occlude one another in a cycle: what no visibility order of cells can be right for.

use std::f64::consts::TAU;

use glam::DVec3;

use super::Parts;

/// Three cells without a common face, each before the next as seen from (12, 12, 12).
pub fn three_cycle() -> Parts {
    let first = [[0.0, 1.0, 1.0], [-1.0, 0.0, 0.0], [1.0, 2.0, 1.0], [0.0, -1.0, 1.0]].map(DVec3::from);
    let turn = |p: DVec3| DVec3::new(p.z, p.x, p.y);
    let second = first.map(turn);
    let points = [first, second, second.map(turn)].concat();
    Parts { points, cells: vec![[0, 1, 2, 3], [4, 5, 6, 7], [8, 9, 10, 11]] }
}

/// Two circles of `k` points round the z axis at heights 0 and 1, the upper turned, and the `k` cells
/// (A_i, A_i+1, B_i, B_i+1) between them, which share edges alone: turned by 60 degrees they are a cycle as seen
/// along the axis, for 3 <= k <= 32.
pub fn ring(k: u32, turned_by_degrees: f64) -> Parts {
    let circle = |angle: f64, z: f64| {
        (0..k).map(move |i| f64::from(i) * TAU / f64::from(k) + angle).map(move |t| DVec3::new(t.cos(), t.sin(), z))
    };
    let points = circle(0.0, 0.0).chain(circle(turned_by_degrees.to_radians(), 1.0)).collect();
    let cells = (0..k).map(|i| [i, (i + 1) % k, k + i, k + (i + 1) % k]).collect();
    Parts { points, cells }
}

/// A ring of three cells filled with eight cones to its middle: convex, conforming, and cyclic through faces alone.
pub fn filled_ring() -> Parts {
    let mut parts = ring(3, 30.0);
    let middle = DVec3::new(0.0, 0.0, 0.5);
    // The inner faces of the ring, and the two triangles above and below, as seen from the middle.
    let mut rim = vec![[0, 1, 2], [3, 4, 5]];
    for cell in &parts.cells {
        let p = cell.map(|v| parts.points[v as usize]);
        for [a, b, c, skip] in [[1, 2, 3, 0], [0, 2, 3, 1], [0, 1, 3, 2], [0, 1, 2, 3]] {
            let normal = (p[b] - p[a]).cross(p[c] - p[a]);
            // Faces that the middle sees from outside their cell.
            if normal.dot(p[skip] - p[a]) * normal.dot(middle - p[a]) < 0.0 {
                rim.push([cell[a], cell[b], cell[c]]);
            }
        }
    }
    parts.points.push(middle);
    parts.cells.extend(rim.iter().map(|&[a, b, c]| [a, b, c, 6]));
    parts
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{NONE, TetMesh};

    fn assemble(parts: &Parts) -> TetMesh {
        TetMesh::assemble(&parts.points, &parts.cells, vec![]).unwrap()
    }

    #[test]
    fn the_cells_of_a_ring_share_no_face() {
        for parts in [three_cycle(), ring(3, 60.0), ring(7, 60.0)] {
            assert!(assemble(&parts).neighbors().iter().flatten().all(|&n| n == NONE));
        }
    }

    #[test]
    fn a_filled_ring_is_one_body() {
        let report = assemble(&filled_ring()).validate();
        // 11 cells of 4 faces, 18 of them shared.
        assert_eq!((report.cells, report.boundary_faces, report.components), (11, 44 - 2 * 18, 1));
        assert_eq!((report.assembly.faces_folded, report.assembly.cells_flat), (0, 0));
    }
}
