use std::f64::consts::PI;

use proptest::prelude::*;
use tetlux_mesh::{NONE, TetMesh};

use super::stencil::tests::{HIGHEST, LOWEST, dihedral_angles};
use super::*;
use crate::surface::tests::{binary_stl, blob, cuboid, reversed, source, text_stl, together, torus};

/// Coordinates of meshes are rounded to single precision before their angles are measured: an angle changes by that
/// over the shortest edges, a few thousandths of the box.
const ROUNDING: f64 = 0.05;

/// A filled surface as a mesh, with all checked that holds of any: no faults, angles within the bounds.
fn check(surface: &Surface, cell_size: f64) -> (TetMesh, [f64; 2]) {
    let Filled { parts, fields, .. } = fill(surface, cell_size, &[]).unwrap();
    let mut range = [f64::INFINITY, 0.0f64];
    for cell in &parts.cells {
        let corners = cell.map(|v| parts.points[v as usize]);
        let [a, b, c, d] = corners;
        assert!((b - a).cross(c - a).dot(d - a) > 0.0);
        for angle in dihedral_angles(corners) {
            range = [range[0].min(angle), range[1].max(angle)];
        }
    }
    assert!(range[0] >= LOWEST && range[1] <= HIGHEST, "{range:?}");
    let mesh = TetMesh::assemble(&parts.points, &parts.cells, fields).unwrap();
    assert_eq!(mesh.validate().faults(), Vec::<String>::new());
    (mesh, range)
}

/// The boundary of a mesh, as a surface.
fn boundary(mesh: &TetMesh) -> Surface {
    let mut surface = Surface { points: mesh.points().iter().map(|p| p.as_dvec3()).collect(), ..Surface::default() };
    for (cell, around) in mesh.cells().iter().zip(mesh.neighbors()) {
        let faces = (0..4).filter(|&f| around[f] == NONE);
        surface.triangles.extend(faces.map(|f| tetlux_mesh::FACES[f].map(|i| cell[i])));
    }
    surface
}

fn ball() -> Surface {
    blob(5, |_| 1.0)
}

fn ring() -> Surface {
    torus(96, 48, |u, v| {
        let r = 1.0 + 0.35 * v.cos();
        DVec3::new(r * u.cos(), r * u.sin(), 0.35 * v.sin())
    })
}

fn lumps(seed: u64) -> Surface {
    let waves: Vec<DVec3> = (1..4u64)
        .map(|i| {
            let number = |k: u64| ((seed.wrapping_mul(7 * i + k) % 97) as f64 / 97.0 - 0.5) * 8.0;
            DVec3::new(number(1), number(2), number(3))
        })
        .collect();
    blob(5, |d| 1.0 + 0.08 * waves.iter().map(|w| (w.dot(d) * 2.0).sin()).sum::<f64>())
}

#[test]
fn a_ball_a_ring_a_cube_and_a_blob_are_filled_within_the_bounds() {
    for (name, surface, cell_size, handles) in [
        ("ball", ball(), 0.11, 0),
        ("ring", ring(), 0.09, 1),
        ("cube", cuboid(DVec3::splat(-0.5), DVec3::splat(0.5)), 0.07, 0),
        ("tilted cube", tilted(cuboid(DVec3::splat(-0.5), DVec3::splat(0.5))), 0.07, 0),
        ("blob", lumps(5), 0.1, 0),
    ] {
        let (mesh, range) = check(&surface, cell_size);
        let report = mesh.validate();
        println!("{name}: {} cells, angles {range:?}", report.cells);
        // Surfaces that are smooth for the cells stay within the narrower bounds that the paper names first.
        assert!(range[0] > 10.78 && range[1] < 164.74, "{name}: {range:?}");
        assert_eq!(report.components, 1, "{name}");
        let shell = boundary(&mesh).report();
        assert!(shell.closed() && shell.outward() && shell.components == 1, "{name}: {shell:?}");
        // Euler's formula; each triangle has one and a half edges.
        let boundary = boundary(&mesh);
        let mut used: Vec<u32> = boundary.triangles.iter().flatten().copied().collect();
        used.sort_unstable();
        used.dedup();
        let euler = used.len() as i64 - boundary.triangles.len() as i64 / 2;
        assert_eq!(euler, 2 - 2 * handles, "{name}");
    }
}

fn tilted(mut surface: Surface) -> Surface {
    let turn = glam::DQuat::from_euler(glam::EulerRot::XYZ, 0.3, 0.5, 0.7);
    surface.points.iter_mut().for_each(|p| *p = turn * *p);
    surface
}

#[test]
fn the_volume_converges_to_the_surfaces_with_the_square_of_the_cell_size() {
    for (surface, size) in [(ball(), 0.2), (ring(), 0.16)] {
        let exact = surface.report().volume;
        let error = |size: f64| (check(&surface, size).0.validate().volume - exact).abs() / exact;
        let errors = [size, size / 2.0, size / 4.0].map(error);
        // A factor of four each, less what where the lattice happens to lie adds.
        assert!(errors[1] < errors[0] / 2.5 && errors[2] < errors[1] / 2.5, "{errors:?}");
        assert!(errors[2] < 0.005, "{errors:?}");
    }
    // Of a box that lattice planes meet all is there but the edges.
    let error = |size: f64| 1.0 - check(&cuboid(DVec3::ZERO, DVec3::ONE), size).0.validate().volume;
    assert!((0.0..12.0 * 0.1 * 0.1).contains(&error(0.1)), "{}", error(0.1));
}

#[test]
fn every_point_of_the_new_boundary_lies_on_the_surface_and_all_others_inside() {
    let ball = ball();
    let Filled { parts, fields, .. } = fill(&ball, 0.15, &[]).unwrap();
    let mesh = TetMesh::assemble(&parts.points, &parts.cells, vec![]).unwrap();
    assert_eq!((fields.len(), fields[0].name.as_str()), (1, DISTANCE));
    let nearest = Nearest::new(&ball);
    let mut outer = vec![false; parts.points.len()];
    boundary(&mesh).triangles.iter().flatten().for_each(|&v| outer[v as usize] = true);
    for ((&p, &distance), &outer) in parts.points.iter().zip(&fields[0].values).zip(&outer) {
        // Interpolation on an edge and projection on a plane are exact but for rounding.
        assert!((nearest.distance(p) - distance).abs() < 1e-13);
        // The surface's facets cut no deeper than 1 - cos of a quarter of their angle into the ball.
        assert!((distance - (1.0 - p.length())).abs() < 0.002, "{p} {distance}");
        assert!(!outer || distance == 0.0);
    }
    assert!(fields[0].values.iter().all(|&d| d >= 0.0));
}

#[test]
fn parts_stay_apart_holes_stay_empty_and_what_overlaps_is_one() {
    let cube = |low: f64, high: f64| cuboid(DVec3::splat(low), DVec3::splat(high));
    let outcome = |surface: &Surface| {
        let report = check(surface, 0.1).0.validate();
        (report.components, report.volume)
    };
    // Rounded edges take less than a hundredth each.
    let near = |(components, volume): (usize, f64), expected: (usize, f64)| {
        assert_eq!(components, expected.0);
        assert!((volume / expected.1 - 1.0).abs() < 0.05, "{volume}, {expected:?}");
    };
    near(outcome(&together(cube(0.0, 1.0), &cube(1.5, 2.5))), (2, 2.0));
    near(outcome(&together(cube(0.0, 2.0), &reversed(cube(0.5, 1.5)))), (1, 7.0));
    near(outcome(&together(cube(0.0, 2.0), &cube(0.5, 1.5))), (1, 8.0));
    near(outcome(&together(cube(0.0, 1.0), &cube(0.5, 1.5))), (1, 1.875));
    near(outcome(&reversed(cube(0.0, 1.0))), (1, 1.0));
    near(outcome(&together(cube(0.0, 1.0), &reversed(cube(1.5, 2.5)))), (2, 2.0));
}

#[test]
fn a_surface_far_from_the_origin_and_one_on_lattice_planes_lose_nothing() {
    for shift in [0.0, 1e6, -12345.678] {
        let mut cube = cuboid(DVec3::ZERO, DVec3::ONE);
        cube.points.iter_mut().for_each(|p| *p += shift);
        // Nodes of the lattice lie on the surface itself, as nearly as rounding lets them.
        for size in [0.125, 0.25, 0.5] {
            let volume = check(&cube, size).0.validate().volume;
            assert!((volume - 1.0).abs() < 13.0 * size * size, "{volume}");
        }
    }
}

#[test]
fn triangles_that_disagree_are_turned_and_open_surfaces_refused() {
    let mut ball = blob(2, |_| 1.0);
    let volume = check(&ball, 0.3).0.validate().volume;
    (0..9).for_each(|t| ball.triangles[t].swap(1, 2));
    let filled = fill(&ball, 0.3, &[]).unwrap();
    assert_eq!(filled.notes, ["triangles that faced another way than their neighbours: 9, turned round"]);
    let mesh = TetMesh::assemble(&filled.parts.points, &filled.parts.cells, vec![]).unwrap();
    assert_eq!(mesh.validate().volume, volume);

    ball.triangles.truncate(100);
    let open = ball.report().edges_open;
    assert!(open > 0);
    match fill(&ball, 0.3, &[]).unwrap_err() {
        IngestError::NotClosed { open: found, non_manifold: 0, .. } => assert_eq!(found, open),
        other => panic!("{other}"),
    }
    let mut cube = cuboid(DVec3::ZERO, DVec3::ONE);
    cube.triangles.push([0, 1, 7]);
    let message = fill(&cube, 0.3, &[]).unwrap_err().to_string();
    assert!(message.contains("not closed") && message.contains("1 have three or more"), "{message}");
}

#[test]
fn sizes_out_of_range_are_refused_with_one_that_fits() {
    let cube = cuboid(DVec3::ZERO, DVec3::new(3.0, 2.0, 1.0));
    for size in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(fill(&cube, size, &[]), Err(IngestError::CellSize { .. })), "{size}");
    }
    assert!(matches!(fill(&cube, 50.0, &[]), Err(IngestError::NothingInside { .. })));
    for size in [1e-3, 1e-9, 1e-300, f64::MIN_POSITIVE] {
        match fill(&cube, size, &[]).unwrap_err() {
            IngestError::TooFine { nodes, limit, fitting, .. } => {
                assert!(nodes > limit as f64);
                assert!((0.005..0.02).contains(&fitting) && Lattice::round(&cube, fitting).is_ok(), "{fitting}");
            }
            other => panic!("{other}"),
        }
    }
    // Triangles across the whole box, more than can be looked at.
    let mut many = cuboid(DVec3::ZERO, DVec3::ONE);
    many.triangles = many.triangles.repeat(10_000);
    assert!(crossings::tests(&many, &Lattice::round(&cuboid(DVec3::ZERO, DVec3::ONE), 0.02).unwrap()) > 1 << 27);
    assert!(matches!(Lattice::round(&many, 0.02), Err(IngestError::TooFine { fitting, .. }) if fitting > 0.02));
}

#[test]
fn fields_are_the_formulas_at_the_points() {
    let named = |name: &str, text: &str| (name.to_string(), Expression::parse(text).unwrap());
    let filled = fill(&ball(), 0.2, &[named("height", "z"), named("r", "sqrt(x^2+y^2+z^2)")]).unwrap();
    let names: Vec<&str> = filled.fields.iter().map(|f| f.name.as_str()).collect();
    assert_eq!(names, [DISTANCE, "height", "r"]);
    assert_eq!(filled.fields[1].values, filled.parts.sample(|p| p.z));
    let r = filled.parts.sample(DVec3::length);
    assert!(filled.fields[2].values.iter().zip(r).all(|(a, b)| (a - b).abs() < 1e-15));
}

#[test]
fn a_file_is_read_as_what_fills_it() {
    let ball = blob(3, |_| 2.0);
    for (name, bytes) in [("a.stl", binary_stl(&ball)), ("a.stl", text_stl(&ball).into_bytes())] {
        let mesh = read(&source(name, &bytes), None, &[("h".into(), Expression::parse("z").unwrap())]).unwrap();
        assert_eq!(mesh.fields.len(), 2);
        let mesh = mesh.tetrahedralize(tetlux_mesh::procedural::Split::Six).unwrap();
        let report = mesh.validate();
        assert_eq!(report.faults(), Vec::<String>::new());
        // A fortieth of the diagonal of a box of 4.
        let size = 4.0 * 3f64.sqrt() / 40.0;
        assert!((report.edge_lengths[1] / size - 1.0).abs() < 0.6, "{:?}", report.edge_lengths);
        assert!((report.volume / ball.report().volume - 1.0).abs() < 0.01);
    }
}

#[test]
fn the_winding_number_of_every_node_is_that_of_the_solid_angle() {
    let surface = together(ball(), &reversed(cuboid(DVec3::splat(0.2), DVec3::splat(1.3))));
    let lattice = Lattice::round(&surface, 0.21).unwrap();
    let windings = crossings::windings(&lattice, &crossings::find(&surface, &lattice));
    for node in 0..lattice.nodes() {
        let p = lattice.position(node);
        // Van Oosterom and Strackee 1983.
        let angle = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|v| (surface.points[v as usize] - p).normalize());
            2.0 * a.cross(b).dot(c).atan2(1.0 + a.dot(b) + b.dot(c) + c.dot(a))
        };
        let turns = surface.triangles.iter().map(angle).sum::<f64>() / (4.0 * PI);
        assert_eq!(f64::from(windings[node]), turns.round(), "{p}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: crate::damage::config().cases.div_ceil(25), ..crate::damage::config() })]

    #[test]
    fn any_blob_is_filled_within_the_bounds(seed in any::<u64>(), cell_size in 0.12..0.6) {
        let (mesh, _) = check(&lumps(seed), cell_size);
        prop_assert!(mesh.validate().volume > 0.0);
    }

    #[test]
    fn soups_of_closed_parts_are_filled_without_faults(
        corners in prop::collection::vec((prop::array::uniform3(0u8..8), prop::array::uniform3(1u8..6)), 1..5)
    ) {
        // Boxes that touch, overlap and lie in one another's planes.
        let boxes = corners.iter().map(|(low, size)| {
            let low = DVec3::from_array(low.map(f64::from));
            cuboid(low, low + DVec3::from_array(size.map(f64::from)))
        });
        let soup = boxes.fold(Surface::default(), |all, one| together(all, &one));
        check(&soup, 1.0);
    }
}

#[test]
fn the_angles_of_single_precision_meshes_are_those_of_the_bounds_too() {
    let (mesh, _) = check(&ring(), 0.1);
    let angles = mesh.cells().iter().flat_map(|c| dihedral_angles(c.map(|v| mesh.points()[v as usize].as_dvec3())));
    assert!(angles.into_iter().all(|a| (LOWEST - ROUNDING..=HIGHEST + ROUNDING).contains(&a)));
}
