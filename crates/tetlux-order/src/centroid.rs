//! Order by centroid.

use glam::Vec3;
use rayon::prelude::*;
use tetlux_mesh::TetMesh;

use crate::Eye;

/// The cells, nearest centroid first: by distance from a point, or by depth along a direction.
///
/// Exact for no class of meshes: where a large cell lies beside small ones, centroids mislead. Cells at equal
/// distance keep their order. Linear time: a radix sort.
pub fn centroid(mesh: &TetMesh, eye: Eye, cells: &[u32]) -> Vec<u32> {
    // Four times the centroid, relative to the mesh's origin: the order is the same.
    let key: Box<dyn Fn(Vec3) -> f64 + Sync> = match eye {
        Eye::Point(eye) => {
            let eye = (eye - mesh.origin()) * 4.0;
            Box::new(move |sum| (sum.as_dvec3() - eye).length())
        }
        Eye::Direction(direction) => Box::new(move |sum| sum.as_dvec3().dot(direction)),
    };
    let points = mesh.points();
    let mut keyed: Vec<(f64, u32)> = cells
        .par_iter()
        .map(|&c| {
            let sum: Vec3 = mesh.cells()[c as usize].iter().map(|&v| points[v as usize]).sum();
            (key(sum), c)
        })
        .collect();
    radsort::sort_by_key(&mut keyed, |&(key, _)| key);
    keyed.into_iter().map(|(_, cell)| cell).collect()
}

#[cfg(test)]
mod tests {
    use glam::DVec3;
    use tetlux_mesh::procedural::{self, Split};

    use super::*;

    fn slab() -> TetMesh {
        let parts = procedural::cuboid([3, 3, 3], Split::Five, [DVec3::splat(-1.0), DVec3::splat(2.0)]);
        TetMesh::assemble(&parts.points, &parts.cells, vec![]).unwrap()
    }

    fn world_centroid(mesh: &TetMesh, cell: u32) -> DVec3 {
        mesh.cells()[cell as usize].iter().map(|&v| mesh.world(v)).sum::<DVec3>() / 4.0
    }

    #[test]
    fn keys_ascend_and_no_cell_is_lost() {
        let mesh = slab();
        let cells: Vec<u32> = (0..mesh.cells().len() as u32).filter(|c| c % 3 != 1).collect();
        let (point, direction) = (DVec3::new(5.0, -3.0, 0.2), DVec3::new(0.3, 0.2, -1.0));
        let by_distance = |c: u32| world_centroid(&mesh, c).distance(point);
        let by_depth = |c: u32| world_centroid(&mesh, c).dot(direction);
        for (eye, key) in [
            (Eye::Point(point), &by_distance as &dyn Fn(u32) -> f64),
            (Eye::Direction(direction), &by_depth as &dyn Fn(u32) -> f64),
        ] {
            let order = centroid(&mesh, eye, &cells);
            // Single-precision sums of four coordinates below 2: a few roundings of 1e-7.
            assert!(order.windows(2).all(|w| key(w[0]) <= key(w[1]) + 1e-6));
            let mut sorted = order.clone();
            sorted.sort_unstable();
            assert_eq!(sorted, cells);
        }
    }
}
