use glam::DVec3;
use tetlux_mesh::procedural::{Split, cuboid};
use tetlux_mesh::{Component, Field};
use tetlux_scene::View;

use super::*;
use crate::cell::{face_normal, shortest_way};
use crate::device_view::DeviceView;

fn corner(name: u32, x: f32, y: f32) -> Corner {
    Corner { name, offset: Vec2::new(x, y), distance: x + 2.0 * y }
}

#[test]
fn a_ray_passes_an_edge_on_one_side() {
    // On the edge, at its end, and beside it by less than rounding: never both, never neither.
    for (a, b) in
        [([1.0, 1.0], [-2.0, -2.0]), ([0.0, 0.0], [3.0, 1.0]), ([0.1, 0.3], [-0.3, -0.9]), ([0.0; 2], [0.0; 2])]
    {
        let (a, b) = (corner(4, a[0], a[1]), corner(9, b[0], b[1]));
        assert_ne!(turns(&a, &b), turns(&b, &a));
    }
    let (right, down) = (corner(1, 1.0, 0.0), corner(0, 0.0, 1.0));
    assert!(turns(&right, &down) && !turns(&down, &right), "from x towards y");
}

#[test]
fn crossings_are_where_the_offsets_balance() {
    // The origin is 1/2 a + 1/4 b + 1/4 c.
    let [a, b, c] = [corner(0, -1.0, 0.0), corner(1, 1.0, -2.0), corner(2, 1.0, 2.0)];
    assert_eq!(crossing(&a, &b, &c), Vec2::splat(0.25));
    assert_eq!(opposite_longest(&a, &b, &c), 0);
    // Distances are linear in the offsets: at the origin none, from whichever vertex.
    assert_eq!([distance_of(&a, &b, &c), distance_of(&b, &c, &a), distance_of(&c, &a, &b)], [0.0; 3]);
    // Seen edge-on there is no balance to find.
    let flat = corner(3, 3.0, 0.0);
    assert_eq!(crossing(&a, &flat, &a), Vec2::splat(1.0 / 3.0));
}

#[test]
fn a_ray_on_a_vertex_crosses_one_of_the_triangles_around_it() {
    // A vertex on the ray among others on the rows, columns and diagonals of a grid.
    let middle = corner(5, 0.0, 0.0);
    let ring = [[1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [-1.0, 1.0], [-1.0, 0.0], [-1.0, -1.0], [0.0, -1.0], [1.0, -1.0]];
    for first in 0..8 {
        // Whatever the names.
        let corners: Vec<Corner> =
            (0..8).map(|i| corner((i * 3 + first) % 8 + 6, ring[i as usize][0], ring[i as usize][1])).collect();
        let crossed = (0..8).filter(|&i| {
            let (a, b) = (&corners[i], &corners[(i + 1) % 8]);
            turns(&middle, a) && turns(a, b) && turns(b, &middle)
        });
        assert_eq!(crossed.count(), 1);
    }
}

/// The shader's `volume_of`, of positions.
fn volume_of([a, b, c]: [Vec3; 3], apex: Vec3) -> f32 {
    face_normal(a, b, c).dot(shortest_way([a, b, c], apex)).abs()
}

/// The shader's, of the distances and the areas of the two places.
fn way_through(along: Vec3, volume: f32, beside: f32, front: [f32; 2], back: [f32; 2]) -> f32 {
    const THIN: f32 = 0.0625;
    const DISTANCE_ROUNDING: f32 = 3e-5;
    let difference = back[0] - front[0];
    if front[1].min(back[1]) <= 0.0 {
        return difference;
    }
    let way = along.length() * (volume / front[1]) * (beside / back[1]);
    let unsure = DISTANCE_ROUNDING * front[0].abs().max(back[0].abs());
    let is_thin = way * way < THIN * THIN * front[1];
    if is_thin && (way - difference).abs() < unsure { way } else { difference }
}

#[test]
fn the_way_through_a_thin_cell_keeps_its_digits() {
    // Parallel rays along z at the origin; a triangle aslant, and an apex a millionth behind its first vertex.
    let [a, b, c] = [Vec3::new(-0.3, -0.2, 1.6), Vec3::new(0.4, -0.1, 1.9), Vec3::new(0.05, 0.5, 1.7)];
    let apex = a + Vec3::new(0.0, 0.0, 1e-6);
    let as_seen = |name: u32, p: Vec3| Corner { name, offset: p.truncate(), distance: p.z };
    let [p, q, r, s] = [as_seen(0, a), as_seen(1, b), as_seen(2, c), as_seen(3, apex)];
    let area = |a: &Corner, b: &Corner, c: &Corner| (b.offset - a.offset).perp_dot(c.offset - a.offset);
    let (front, back) = ([distance_of(&p, &q, &r), area(&p, &q, &r)], [distance_of(&s, &q, &r), area(&s, &q, &r)]);
    let beside = q.offset.perp_dot(r.offset);
    // The share of the first vertex in what is interpolated at the origin, of the height there.
    let exact = f64::from(beside) / f64::from(front[1]) * (f64::from(apex.z) - f64::from(a.z));
    let off = |found: f32| (f64::from(found) / exact - 1.0).abs();
    let volume = volume_of([a, b, c], apex);
    // Some roundings; the difference of distances about 2 has but a digit.
    assert!(off(way_through(Vec3::Z, volume, beside, front, back)) < 1e-6);
    assert!(off(back[0] - front[0]) > 1e-3);
    // Elsewhere that is the way: where the triangles are seen narrow, and where the ray is not in them.
    assert_eq!(way_through(Vec3::Z, volume, beside, [front[0], 0.0], back), back[0] - front[0]);
    assert_eq!(way_through(Vec3::Z, volume, beside, front, [2.5, back[1]]), 2.5 - front[0]);
}

/// A row of four cubes along x, seen along it, four pixels wide and high.
fn row() -> (TetMesh, View) {
    let parts = cuboid([4, 1, 1], Split::Six, [DVec3::ZERO, DVec3::new(4.0, 1.0, 1.0)]);
    let mesh = TetMesh::assemble(&parts.points, &parts.cells, vec![Field::point("x", 1, parts.sample(|p| p.x))]);
    let view = View {
        eye: DVec3::new(-3.0, 0.5, 0.5),
        right: DVec3::NEG_Y,
        down: DVec3::NEG_Z,
        forward: DVec3::X,
        size: [4, 4],
        pixel: 0.25,
        orthographic: true,
        near: 0.0,
    };
    (mesh.unwrap(), view)
}

fn march_of(mesh: &TetMesh, view: &View, drawn: &[u32]) -> March {
    let device = DeviceMesh::new(mesh, &mesh.scalar("x", Component::Magnitude).unwrap(), &[]);
    let lens = Lens { view: DeviceView::new(view, mesh, &device), orthographic: view.orthographic };
    March::new(mesh, &device, &lens, drawn, view.size)
}

#[test]
fn each_ray_comes_in_once_for_each_stretch_of_drawn_cells() {
    let (mesh, view) = row();
    // All of the far end is in the picture.
    let perspective = View { pixel: 0.25 / 7.0, orthographic: false, ..view };
    // The first cube, and the last two: a gap between.
    let drawn: Vec<u32> = (0..24).filter(|cell| !(6..12).contains(cell)).collect();
    for view in [view, perspective] {
        let march = march_of(&mesh, &view, &drawn);
        assert_eq!(march.starts, (0..=16).map(|i| 2 * i).collect::<Vec<u32>>());
        for pair in march.entries.chunks(2) {
            let [near, far] = [pair[0] / 4, pair[1] / 4];
            assert!(near < 6 && (12..18).contains(&far), "nearest first: {near}, {far}");
        }
    }
    assert!(march_of(&mesh, &view, &[]).entries.is_empty());
}

#[test]
fn cells_across_a_face_have_its_vertices_and_are_drawn() {
    let (mesh, view) = row();
    let drawn: Vec<u32> = (0..18).collect();
    let march = march_of(&mesh, &view, &drawn);
    let ascending = |cell: usize| {
        let mut names = mesh.cells()[cell];
        names.sort_unstable();
        names
    };
    let mut inner = 0;
    for (cell, neighbors) in march.neighbors.iter().enumerate() {
        for (k, &other) in neighbors.iter().enumerate().filter(|(_, other)| **other != NONE) {
            assert!(other < 18);
            let across = ascending(other as usize);
            let face = ascending(cell).into_iter().enumerate().filter(|&(i, _)| i != k);
            assert!(face.into_iter().all(|(_, name)| across.contains(&name)));
            inner += usize::from(cell < 18);
        }
    }
    // Six in each of three cubes, and two triangles between each two, from both sides.
    assert_eq!(inner, 2 * (3 * 6 + 2 * 2));
}
