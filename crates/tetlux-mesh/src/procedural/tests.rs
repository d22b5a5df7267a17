use super::*;
use crate::TetMesh;

/// Six times the volume: an integer for integer corners.
fn determinant(corners: &[DVec3; 8], cell: [u32; 4]) -> f64 {
    let p = cell.map(|v| corners[v as usize]);
    (p[1] - p[0]).cross(p[2] - p[0]).dot(p[3] - p[0])
}

/// Corners of [0, 1]^3 in VTK's order, each moved.
fn hexahedron(place: impl Fn(DVec3) -> DVec3) -> [DVec3; 8] {
    [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]]
        .map(|c| place(DVec3::from(c.map(f64::from))))
}

#[test]
fn tetrahedra_are_positive_and_fill_their_hexahedron() {
    // Small integers: every volume is exact. A sheared box of determinant 30 and a frustum of a pyramid with
    // squares of side 4 and 2, three apart: 3/3 (16 + 4 + 8) = 28.
    let sheared = hexahedron(|u| DVec3::new(2.0 * u.x + u.y, 3.0 * u.y - u.z, u.x + 5.0 * u.z));
    let frustum = hexahedron(|u| {
        let half = 2.0 - u.z;
        DVec3::new((2.0 * u.x - 1.0) * half, (2.0 * u.y - 1.0) * half, 3.0 * u.z)
    });
    let columns = glam::DMat3::from_cols(sheared[1], sheared[3], sheared[4]);
    for (corners, volume) in [(sheared, columns.determinant()), (frustum, 28.0)] {
        for (split, count) in [(Split::Five, 5), (Split::Six, 6)] {
            for ijk in [[0, 0, 0], [1, 0, 0], [0, 1, 0], [4, 3, 3], [1, 1, 1]] {
                let cells: Vec<_> = split.hexahedron([0, 1, 2, 3, 4, 5, 6, 7], ijk).collect();
                assert_eq!(cells.len(), count);
                assert!(cells.iter().all(|&c| determinant(&corners, c) > 0.0), "{split:?} {ijk:?}");
                assert_eq!(cells.iter().map(|&c| determinant(&corners, c)).sum::<f64>(), 6.0 * volume);
            }
        }
    }
}

#[test]
fn five_mirrors_in_every_other_hexahedron() {
    let cells = |ijk| Split::Five.hexahedron([0, 1, 2, 3, 4, 5, 6, 7], ijk).collect::<Vec<_>>();
    assert_ne!(cells([0, 0, 0]), cells([1, 0, 0]));
    assert_eq!(cells([0, 0, 0]), cells([1, 0, 1]));
}

#[test]
fn grids_conform_and_have_the_boundary_of_a_box() {
    let [a, b, c] = [4, 3, 5];
    for (split, per) in [(Split::Five, 5), (Split::Six, 6)] {
        let parts = cuboid([a, b, c], split, [DVec3::ZERO, DVec3::new(1.0, 2.0, 3.0)]);
        let report = TetMesh::assemble(&parts.points, &parts.cells, vec![]).unwrap().validate();
        assert_eq!((report.points, report.cells), ((a + 1) * (b + 1) * (c + 1), per * a * b * c));
        // Six sides of squares, two triangles each: any face that did not match would add two.
        assert_eq!(report.boundary_faces, 4 * (a * b + b * c + c * a));
        assert_eq!((report.components, report.faults()), (1, vec![]));
    }
}

#[test]
fn cuboids_reach_both_corners_exactly() {
    let corners = [DVec3::new(-0.1, 0.3, 7.7), DVec3::new(0.7, 1.1, 9.9)];
    let parts = cuboid([3, 3, 3], Split::Six, corners);
    assert_eq!([parts.points[0], *parts.points.last().unwrap()], corners);
}

/// Seam and poles: what a shell of these counts must merge, drop and leave open.
fn check_shell(counts: [usize; 3], split: Split) {
    let [longitudes, latitudes, layers] = counts;
    let parts = sphere_shell(counts, split, DVec3::new(3.0, -2.0, 1.0), [1.0, 2.5]);
    let report = TetMesh::assemble(&parts.points, &parts.cells, vec![]).unwrap().validate();
    let label = format!("{counts:?} {split:?}");

    // A sphere of points: rings of `longitudes` between two poles.
    let sphere = (latitudes - 1) * longitudes + 2;
    assert_eq!(report.points, sphere * (layers + 1), "{label}");
    assert_eq!(report.assembly.points_merged, parts.points.len() - report.points, "{label}");
    // At the poles hexahedra become wedges of three tetrahedra.
    let per = if split == Split::Six { 6 } else { 5 };
    assert_eq!(report.cells, longitudes * layers * (per * (latitudes - 2) + 2 * 3), "{label}");
    // Each seam quadrilateral spans a latitude and a radius; those at the poles too have four corners. An odd ring of
    // mirrored hexahedra meets itself with both sides alike: every one of them is split both ways.
    let crossed = if split == Split::Five && longitudes % 2 == 1 { latitudes * layers } else { 0 };
    assert_eq!(report.quads_split_both_ways, crossed, "{label}");
    // Two spheres, each of quadrilaterals and two rings of triangles; and four triangles where the seam stays open.
    let spheres = 2 * longitudes * (2 * (latitudes - 2) + 2);
    assert_eq!(report.boundary_faces, spheres + 4 * crossed, "{label}");
    assert_eq!((report.components, report.assembly.cells_inverted), (1, 0), "{label}");

    // Inscribed polyhedra: at every height a regular polygon whose radius is linear between rings.
    let n = longitudes as f64;
    let ring = |j: usize| {
        let latitude = (j as f64 / latitudes as f64 - 0.5) * std::f64::consts::PI;
        (latitude.cos(), latitude.sin())
    };
    let unit: f64 = (0..latitudes)
        .map(|j| {
            let ((r, z), (s, w)) = (ring(j), ring(j + 1));
            (w - z) / 3.0 * (r * r + r * s + s * s)
        })
        .sum::<f64>()
        * (n / 2.0 * (std::f64::consts::TAU / n).sin());
    let volume = unit * (2.5f64.powi(3) - 1.0);
    // Coordinates are rounded to single precision, which moves a volume by a few parts in 1e7.
    assert!((report.volume / volume - 1.0).abs() < 1e-6, "{label}: {} for {volume}", report.volume);
}

#[test]
fn six_conforms_across_any_seam_and_five_across_even_ones() {
    for longitudes in [4, 5, 8, 9] {
        for (latitudes, layers) in [(3, 1), (4, 2), (5, 3)] {
            for split in [Split::Five, Split::Six] {
                check_shell([longitudes, latitudes, layers], split);
            }
        }
    }
}

#[test]
fn appending_keeps_both_meshes_apart() {
    let mut parts = cuboid([1, 1, 1], Split::Five, [DVec3::ZERO, DVec3::ONE]);
    parts.append(&cuboid([1, 1, 1], Split::Six, [DVec3::splat(2.0), DVec3::splat(3.0)]));
    let report = TetMesh::assemble(&parts.points, &parts.cells, vec![]).unwrap().validate();
    assert_eq!((report.points, report.cells, report.components), (16, 11, 2));
    assert_eq!(report.volume, 2.0);
    assert_eq!(parts.sample(|p| p.x)[8], 2.0);
}
