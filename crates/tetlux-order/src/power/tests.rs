use proptest::prelude::*;
use tetlux_mesh::procedural::{Parts, Split, cuboid, grid};

use super::*;

fn assemble(parts: &Parts) -> TetMesh {
    TetMesh::assemble(&parts.points, &parts.cells, vec![]).unwrap()
}

proptest! {
    #[test]
    fn spheres_pass_through_their_corners(p in prop::array::uniform12(-1.0f32..1.0)) {
        let corners = [0, 3, 6, 9].map(|i| Vec3::new(p[i], p[i + 1], p[i + 2]));
        let [a, b, c, d] = corners.map(|p| p.as_dvec3());
        let volume = (b - a).dot((c - a).cross(d - a));
        // Rounding errors grow as the inverse of the volume, which is at most 8.
        prop_assume!(volume.abs() > 1e-2);
        let [x, y, z, weight] = circumsphere(corners).unwrap();
        let center = DVec3::new(x, y, z);
        for p in [a, b, c, d] {
            // |p - c|^2 = R^2 = |c|^2 - weight.
            prop_assert!((p.length_squared() - 2.0 * p.dot(center) + weight).abs() < 1e-9);
        }
    }
}

#[test]
fn flat_cells_have_no_sphere() {
    assert!(circumsphere([Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::new(1.0, 1.0, 0.0)]).is_none());
}

#[test]
fn a_point_is_inside_on_or_outside() {
    let corners = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
    for (p, expected) in [(Vec3::splat(0.5), 1), (Vec3::ONE, 0), (Vec3::splat(1.0f32.next_up()), -1)] {
        assert_eq!(in_sphere(corners, p), expected);
    }
}

#[test]
fn cells_of_a_cube_share_its_sphere() {
    let mesh = assemble(&cuboid([3, 2, 1], Split::Six, [DVec3::ZERO, DVec3::new(3.0, 2.0, 1.0)]));
    let spheres = Spheres::new(&mesh, &Facts::new(&mesh));
    assert!(spheres.shared && spheres.locally_delaunay);
    // Six cells a cube, one sphere.
    for (cell, sphere) in spheres.spheres.iter().enumerate() {
        assert_eq!(*sphere, spheres.spheres[cell / 6 * 6]);
    }
    let distinct: std::collections::BTreeSet<_> = spheres.spheres.iter().map(|s| s.map(f64::to_bits)).collect();
    assert_eq!(distinct.len(), 6);
}

#[test]
fn sheared_grids_are_not_delaunay() {
    let mesh = assemble(&grid([2; 3], Split::Six, |u| DVec3::new(u.x + 1.5 * u.y, u.y, u.z)));
    let facts = Facts::new(&mesh);
    assert!(facts.convex() && !facts.delaunay(&mesh));
}

#[test]
fn keys_ascend_with_the_power() {
    let mesh = assemble(&grid([3; 3], Split::Six, |u| {
        u + 0.05 * DVec3::new((9.0 * u.y).sin(), (7.0 * u.z).sin(), (8.0 * u.x).cos())
    }));
    let spheres = Spheres::new(&mesh, &Facts::new(&mesh));
    let eye = DVec3::new(2.0, -1.5, 0.7);
    for finite in [true, false] {
        let mut cells: Vec<u32> = (0..mesh.cells().len() as u32).collect();
        spheres.sort(&Viewpoint::new(eye, finite), &mut cells);
        let power = |cell: u32| {
            let [x, y, z, weight] = spheres.spheres[cell as usize];
            let center = DVec3::new(x, y, z);
            if finite { eye.distance_squared(center) - (center.length_squared() - weight) } else { -eye.dot(center) }
        };
        // Powers up to 1e2, in another order of operations.
        assert!(cells.windows(2).all(|w| power(w[0]) <= power(w[1]) + 1e-10));
        assert!(power(cells[0]) < power(cells[cells.len() - 1]));
    }
}
