//! Meshes of every kind that orders find hard.

use std::collections::HashMap;
use std::f64::consts::TAU;

use glam::DVec3;
use robust::{Coord3D, insphere, orient3d};
use tetlux_mesh::TetMesh;
use tetlux_mesh::procedural::{Parts, Split, cuboid, grid, sphere_shell};

use crate::random::Random;

pub(crate) fn assemble(parts: &Parts) -> TetMesh {
    TetMesh::assemble(&parts.points, &parts.cells, vec![]).unwrap()
}

/// A grid over [-1, 1]^3.
pub(crate) fn cube(counts: [usize; 3], split: Split) -> Parts {
    cuboid(counts, split, [DVec3::splat(-1.0), DVec3::ONE])
}

/// The points moved by up to a share of a grid's spacing: hexahedra with bent sides.
pub(crate) fn jittered(mut parts: Parts, by: DVec3, seed: u64) -> Parts {
    let mut random = Random::new(seed);
    parts.points.iter_mut().for_each(|p| *p += random.point(1.0) * by);
    parts
}

/// A grid over [-1, 1]^3 with each hexahedron split for itself: the sides of neighbours show both diagonals.
pub(crate) fn non_conforming(counts: [usize; 3]) -> Parts {
    let six = cube(counts, Split::Six);
    let mut parts = Parts { points: six.points, cells: Vec::new() };
    tetlux_mesh::procedural::for_each_hexahedron(counts.map(|c| c + 1), |_, corners| {
        parts.cells.extend(Split::Five.hexahedron(corners, [0; 3]));
    });
    parts
}

/// The hexahedra of a grid that are kept.
pub(crate) fn carved(parts: &Parts, counts: [usize; 3], split: Split, keep: impl Fn([usize; 3]) -> bool) -> Parts {
    let per = if split == Split::Six { 6 } else { 5 };
    let place = |h: usize| [h % counts[0], h / counts[0] % counts[1], h / (counts[0] * counts[1])];
    let cells = parts.cells.chunks(per).enumerate().filter(|(h, _)| keep(place(*h))).flat_map(|(_, c)| c).copied();
    Parts { points: parts.points.clone(), cells: cells.collect() }
}

/// A random share of the cells.
pub(crate) fn thinned(parts: &Parts, share: f64, seed: u64) -> Parts {
    let mut random = Random::new(seed);
    let cells = parts.cells.iter().copied().filter(|_| random.unit() < share).collect();
    Parts { points: parts.points.clone(), cells }
}

pub(crate) fn torus(counts: [usize; 3]) -> Parts {
    grid(counts, Split::Six, |u| {
        // The seam is made exact, so that its points coincide bit for bit.
        let angle = if u.x == 1.0 { 0.0 } else { u.x * TAU };
        let radius = 0.65 + 0.35 * (2.0 * u.y - 1.0);
        DVec3::new(radius * angle.cos(), radius * angle.sin(), 0.35 * (2.0 * u.z - 1.0))
    })
}

/// A shell in a shell round a ball's worth of cells: each seen through the one before.
pub(crate) fn nested_spheres() -> Parts {
    let mut parts = sphere_shell([10, 5, 1], Split::Six, DVec3::ZERO, [0.8, 1.0]);
    parts.append(&sphere_shell([8, 4, 1], Split::Six, DVec3::ZERO, [0.4, 0.6]));
    parts.append(&cuboid([2, 2, 2], Split::Five, [DVec3::splat(-0.15), DVec3::splat(0.15)]));
    parts
}

/// Teeth on a back.
pub(crate) fn comb() -> Parts {
    let counts = [15, 6, 2];
    carved(&cube(counts, Split::Six), counts, Split::Six, |[i, j, _]| j == 0 || i % 2 == 0)
}

/// Ten by six holes.
pub(crate) fn plate_with_holes() -> Parts {
    let counts = [21, 13, 1];
    let plate = cuboid(counts, Split::Five, [DVec3::new(-1.0, -0.62, -0.05), DVec3::new(1.0, 0.62, 0.05)]);
    carved(&plate, counts, Split::Five, |[i, j, _]| i % 2 == 0 || j % 2 == 0)
}

/// Thin plates one behind another, each turned a little.
pub(crate) fn plates() -> Parts {
    let mut parts = Parts::default();
    for i in 0..8 {
        let turn = glam::DQuat::from_rotation_z(0.1 * f64::from(i));
        let mut plate = cuboid([4, 4, 1], Split::Six, [DVec3::new(-0.7, -0.7, 0.0), DVec3::new(0.7, 0.7, 0.02)]);
        plate.points.iter_mut().for_each(|p| *p = turn * *p + DVec3::Z * (0.25 * f64::from(i) - 0.9));
        parts.append(&plate);
    }
    parts
}

/// Boxes at random places, none touching another.
pub(crate) fn scattered(seed: u64) -> Parts {
    let mut random = Random::new(seed);
    let mut parts = Parts::default();
    for ijk in 0..27 {
        let place = DVec3::from([ijk % 3, ijk / 3 % 3, ijk / 9].map(|i| 0.7 * f64::from(i) - 0.7));
        let turn = glam::DQuat::from_euler(glam::EulerRot::XYZ, random.unit(), random.unit(), random.unit());
        let mut cube = cuboid([2, 1, 1], Split::Six, [DVec3::splat(-0.15), DVec3::splat(0.15)]);
        cube.points.iter_mut().for_each(|p| *p = turn * *p + place);
        parts.append(&cube);
    }
    parts
}

/// Edges from 1e-6 to 1: spacing in equal ratios from the middle outwards.
pub(crate) fn graded(split: Split) -> Parts {
    let n = 20;
    let place = |u: f64| {
        let k = (u * f64::from(2 * n)).round() - f64::from(n);
        k.signum() * if k == 0.0 { 0.0 } else { 2f64.powf(k.abs() - f64::from(n)) }
    };
    grid([2 * n as usize, 4, 4], split, |u| DVec3::new(place(u.x), u.y - 0.5, u.z - 0.5))
}

/// The Delaunay triangulation of points (Bowyer 1981, Watson 1981) inside a large tetrahedron whose own cells are left
/// out: a part of a Delaunay triangulation, nearly convex.
pub(crate) fn delaunay(points: &[DVec3]) -> Parts {
    // In f32, as the mesh will have them.
    let mut all: Vec<DVec3> = points.iter().map(|p| p.as_vec3().as_dvec3()).collect();
    let n = all.len() as u32;
    all.extend(
        [[-50.0, -50.0, -50.0], [150.0, -50.0, -50.0], [-50.0, 150.0, -50.0], [-50.0, -50.0, 150.0]].map(DVec3::from),
    );
    let coord = |v: u32| {
        let DVec3 { x, y, z } = all[v as usize];
        Coord3D { x, y, z }
    };
    let orient = |c: [u32; 4]| orient3d(coord(c[0]), coord(c[1]), coord(c[2]), coord(c[3]));
    let positive = |[a, b, c, d]: [u32; 4]| if orient([a, b, c, d]) > 0.0 { [a, b, c, d] } else { [b, a, c, d] };
    let mut cells = vec![positive([n, n + 1, n + 2, n + 3])];
    for p in 0..n {
        let inside = |c: &[u32; 4]| insphere(coord(c[0]), coord(c[1]), coord(c[2]), coord(c[3]), coord(p)) > 0.0;
        let (taken, kept): (Vec<_>, Vec<_>) = cells.into_iter().partition(inside);
        let mut faces: HashMap<[u32; 3], u32> = HashMap::new();
        for cell in &taken {
            for skip in 0..4 {
                let mut face: Vec<u32> = (0..4).filter(|&i| i != skip).map(|i| cell[i]).collect();
                face.sort_unstable();
                *faces.entry([face[0], face[1], face[2]]).or_default() += 1;
            }
        }
        cells = kept;
        let mut rim: Vec<[u32; 3]> = faces.into_iter().filter(|&(_, count)| count == 1).map(|(face, _)| face).collect();
        rim.sort_unstable();
        cells.extend(rim.into_iter().map(|[a, b, c]| positive([a, b, c, p])));
    }
    cells.retain(|cell| cell.iter().all(|&v| v < n));
    all.truncate(points.len());
    Parts { points: all, cells }
}

/// Random points in a cube, and their Delaunay triangulation.
pub(crate) fn cloud(count: usize, seed: u64) -> Parts {
    let mut random = Random::new(seed);
    let points: Vec<DVec3> = (0..count).map(|_| random.point(1.0)).collect();
    delaunay(&points)
}

/// The Delaunay triangulation of a grid whose points are a hundredth of the spacing from their places: slivers between
/// points that are nearly on one circle.
pub(crate) fn slivers(seed: u64) -> Parts {
    delaunay(&jittered(cube([4, 4, 4], Split::Six), DVec3::splat(0.005), seed).points)
}

/// Random tetrahedra, each for itself: they overlap everywhere.
pub(crate) fn tangle(count: usize, seed: u64) -> Parts {
    let mut random = Random::new(seed);
    let points: Vec<DVec3> = (0..4 * count).map(|_| random.point(1.0)).collect();
    Parts { points, cells: (0..count as u32).map(|c| [4 * c, 4 * c + 1, 4 * c + 2, 4 * c + 3]).collect() }
}
