use proptest::prelude::*;

use super::*;

/// A surface of points by polygons.
pub(crate) fn of(points: &[[f64; 3]], polygons: &[&[u32]]) -> Surface {
    let points: Vec<DVec3> = points.iter().map(|&p| p.into()).collect();
    let mut triangles = Vec::new();
    polygons.iter().for_each(|polygon| polygon::triangles(&points, polygon, &mut triangles));
    Surface { points, triangles, ..Surface::default() }
}

/// The box between two corners, facing outwards.
pub(crate) fn cuboid(low: DVec3, high: DVec3) -> Surface {
    let corner = |i: usize| [0, 1, 2].map(|k| if i >> k & 1 == 1 { high[k] } else { low[k] });
    let points: Vec<[f64; 3]> = (0..8).map(corner).collect();
    of(&points, &[&[0, 2, 3, 1], &[4, 5, 7, 6], &[0, 1, 5, 4], &[2, 6, 7, 3], &[0, 4, 6, 2], &[1, 3, 7, 5]])
}

/// A closed grid of `n` by `m` quadrilaterals: periodic in both directions.
pub(crate) fn torus(n: u32, m: u32, at: impl Fn(f64, f64) -> DVec3) -> Surface {
    let turn = |i: u32, n: u32| f64::from(i) / f64::from(n) * std::f64::consts::TAU;
    let mut surface = Surface::default();
    for j in 0..m {
        for i in 0..n {
            surface.points.push(at(turn(i, n), turn(j, m)));
            let id = |i: u32, j: u32| (j % m) * n + i % n;
            let [a, b, c, d] = [id(i, j), id(i + 1, j), id(i + 1, j + 1), id(i, j + 1)];
            surface.triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    surface
}

/// A sphere about the origin, of a radius in each direction: an octahedron, each triangle cut in four so many times.
pub(crate) fn blob(times: u32, radius: impl Fn(DVec3) -> f64) -> Surface {
    let [x, y, z] = [DVec3::X, DVec3::Y, DVec3::Z];
    let mut faces = vec![[x, y, z], [y, -x, z], [-x, -y, z], [-y, x, z]];
    faces.extend(faces.clone().into_iter().map(|[a, b, c]| [b, a, -c]));
    for _ in 0..times {
        let split = |[a, b, c]: [DVec3; 3]| {
            let [ab, bc, ca] = [(a, b), (b, c), (c, a)].map(|(p, q)| (p + q).normalize());
            [[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]
        };
        faces = faces.into_iter().flat_map(split).collect();
    }
    let given: Vec<DVec3> = faces.into_iter().flatten().map(|d| d * radius(d)).collect();
    let triangles = (0..given.len() as u32 / 3).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    Surface::assemble(&source("blob", b"-"), given, triangles, Vec::new()).unwrap()
}

/// One beside the other.
pub(crate) fn together(mut a: Surface, b: &Surface) -> Surface {
    let offset = a.points.len() as u32;
    a.points.extend_from_slice(&b.points);
    a.triangles.extend(b.triangles.iter().map(|t| t.map(|v| v + offset)));
    a
}

/// The same surface facing the other way.
pub(crate) fn reversed(mut surface: Surface) -> Surface {
    surface.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    surface
}

pub(crate) fn source(name: &str, bytes: &[u8]) -> Source {
    Source { path: name.into(), bytes: bytes.to_vec() }
}

pub(crate) fn binary_stl(surface: &Surface) -> Vec<u8> {
    let mut bytes = b"solid, as some binary files begin".to_vec();
    bytes.resize(80, b' ');
    bytes.extend((surface.triangles.len() as u32).to_le_bytes());
    for triangle in &surface.triangles {
        bytes.extend([0; 12]);
        let corners = triangle.iter().flat_map(|&v| surface.points[v as usize].to_array());
        bytes.extend(corners.flat_map(|x| (x as f32).to_le_bytes()));
        bytes.extend([0; 2]);
    }
    bytes
}

pub(crate) fn text_stl(surface: &Surface) -> String {
    let mut text = "solid a name\n".to_string();
    for triangle in &surface.triangles {
        text += "  facet normal 0 0 0\n    outer loop\n";
        for &v in triangle {
            let p = surface.points[v as usize];
            text += &format!("      vertex {:e} {} {}\n", p.x, p.y, p.z);
        }
        text += "    endloop\n  endfacet\n";
    }
    text + "endsolid a name\n"
}

pub(crate) fn obj(surface: &Surface) -> String {
    let vertices = surface.points.iter().map(|p| format!("v {} {} {}\n", p.x, p.y, p.z)).collect::<String>();
    let face = |t: &[u32; 3]| format!("f {} {}/1 {}//1\n", t[0] + 1, t[1] + 1, t[2] + 1);
    format!("# a comment\no name\n{vertices}vt 0 0\nvn 0 0 1\n")
        + &surface.triangles.iter().map(face).collect::<String>()
}

fn read(name: &str, bytes: &[u8]) -> Result<Surface, IngestError> {
    Surface::from_source(&source(name, bytes))
}

/// The corners of each triangle, in order, whatever the numbering.
fn corners(surface: &Surface) -> Vec<[[f64; 3]; 3]> {
    surface.triangles.iter().map(|t| t.map(|v| surface.points[v as usize].to_array())).collect()
}

#[test]
fn each_encoding_gives_the_surface_that_was_written() {
    let cube = cuboid(DVec3::new(-1.0, 0.0, 0.5), DVec3::new(1.0, 0.25, 4.0));
    for (name, bytes) in [
        ("a.stl", binary_stl(&cube)),
        ("a.stl", text_stl(&cube).into_bytes()),
        ("a.obj", obj(&cube).into_bytes()),
        ("a", binary_stl(&cube)),
        ("a", text_stl(&cube).replace('\n', "\r\n").into_bytes()),
        ("a", obj(&cube).into_bytes()),
    ] {
        let found = read(name, &bytes).unwrap();
        assert_eq!(corners(&found), corners(&cube));
        let report = found.report();
        assert!(report.closed() && report.outward(), "{report:?}");
        // 2 x 0.25 x 3.5.
        assert_eq!((report.points, report.triangles, report.components, report.volume), (8, 12, 1, 1.75));
        assert_eq!(report.bounds, [[-1.0, 0.0, 0.5], [1.0, 0.25, 4.0]]);
    }
}

#[test]
fn obj_faces_are_polygons_of_any_shape_and_count_backwards_too() {
    // An L of area 3, extruded: concave ends, quadrilateral sides, one line over two.
    let text = "v 0 0 0\nv 2 0 0\nv 2 1 0\nv 1 1 0\nv 1 2 0\nv 0 2 0\n\
                v 0 0 1 9 9 9\nv 2 0 1\nv 2 1 1\nv 1 1 1\nv 1 2 1\nv 0 2 1\nl 1 2\n\
                f 6 5 4 3 2 1\nf -6 -5 -4 \\\n-3 -2 -1 # the top\nf 1 2 8 7\nf 2 3 9 8\nf 3 4 10 9\nf 4 5 11 10\n\
                f 5 6 12 11\nf 6 1 7 12\n";
    let surface = read("l.obj", text.as_bytes()).unwrap();
    let report = surface.report();
    assert!(report.closed());
    assert_eq!((report.triangles, report.volume), (2 * 4 + 6 * 2, 3.0));
    assert_eq!(surface.notes, ["lines and points: 1, left out"]);
    // No triangle of the ends reaches out of the L: their areas sum to its own.
    let area = |t: &[[f64; 3]; 3]| {
        let [a, b, c] = t.map(DVec3::from_array);
        (b - a).cross(c - a).z.abs() / 2.0
    };
    assert_eq!(corners(&surface).iter().map(area).sum::<f64>(), 6.0);
}

#[test]
fn degenerate_triangles_are_dropped_and_counted_and_zeros_of_either_sign_coincide() {
    let mut cube = cuboid(DVec3::ZERO, DVec3::ONE);
    cube.triangles.extend([[0, 1, 1], [2, 2, 2]]);
    cube.points.push(DVec3::new(-0.0, 0.0, -0.0));
    cube.triangles[0] = cube.triangles[0].map(|v| if v == 0 { 8 } else { v });
    let found = read("a.stl", text_stl(&cube).as_bytes()).unwrap();
    assert_eq!(found.notes, ["triangles with two corners in one point: 2, dropped"]);
    assert!(found.report().closed());
    assert_eq!(found.points.len(), 8);
}

#[test]
fn open_non_manifold_and_disagreeing_edges_are_told_apart() {
    let cube = || cuboid(DVec3::ZERO, DVec3::ONE);
    let counts = |surface: &Surface| {
        let report = surface.report();
        assert_eq!(report.closed(), report.edges_open + report.edges_non_manifold + report.edges_same_way == 0);
        [report.edges_open, report.edges_non_manifold, report.edges_same_way, report.components]
    };
    assert_eq!(counts(&cube()), [0, 0, 0, 1]);
    let mut surface = cube();
    surface.triangles.pop();
    assert_eq!(counts(&surface), [3, 0, 0, 1]);
    let mut surface = cube();
    surface.triangles.push(surface.triangles[0]);
    assert_eq!(counts(&surface), [0, 3, 0, 1]);
    let mut surface = cube();
    surface.triangles[5].swap(0, 1);
    assert_eq!(counts(&surface), [0, 0, 3, 1]);
    let apart = cuboid(DVec3::splat(2.0), DVec3::splat(3.0));
    assert_eq!(counts(&together(cube(), &apart)), [0, 0, 0, 2]);
    assert!(!reversed(cube()).report().outward());
}

#[test]
fn triangles_are_turned_until_they_agree_and_face_outwards() {
    let mut surface =
        together(cuboid(DVec3::ZERO, DVec3::ONE), &reversed(cuboid(DVec3::splat(2.0), DVec3::splat(4.0))));
    let expected = corners(&surface);
    // Of the first cube most are turned: it is those few that agree with the outside that tell.
    (0..9).for_each(|t| surface.triangles[t].swap(1, 2));
    assert_eq!(surface.orient(), 9);
    let report = surface.report();
    // The second cube agrees with itself and stays as it is: 1 - 8.
    assert!(report.closed());
    assert!((report.volume + 7.0).abs() < 1e-12, "{report:?}");
    let facing = |t: &[[f64; 3]; 3]| {
        let [a, b, c] = t.map(DVec3::from_array);
        (b - a).cross(c - a)
    };
    assert!(corners(&surface).iter().zip(&expected).all(|(a, b)| facing(a) == facing(b)));
}

#[test]
fn a_surface_with_one_side_stays_in_disagreement() {
    // A Klein bottle in the figure-of-eight immersion: half a turn more on the way round.
    let bottle = |n: u32, m: u32| {
        let mut surface = torus(n, m, |u, v| {
            let (s, c) = (u / 2.0).sin_cos();
            let r = 3.0 + c * v.sin() - s * (2.0 * v).sin();
            DVec3::new(r * u.cos(), r * u.sin(), s * v.sin() + c * (2.0 * v).sin())
        });
        // Across the seam v becomes -v.
        for triangle in &mut surface.triangles {
            let seam = triangle.iter().any(|&v| v % n == n - 1);
            *triangle = triangle.map(|v| if seam && v % n == 0 { (m - v / n) % m * n } else { v });
        }
        surface
    };
    let mut surface = bottle(12, 8);
    assert!(surface.report().edges_same_way > 0 && surface.report().edges_open == 0);
    surface.orient();
    assert!(surface.report().edges_same_way > 0);
}

#[test]
fn errors_name_the_place() {
    let cube = cuboid(DVec3::ZERO, DVec3::ONE);
    let (stl, text, obj) = (binary_stl(&cube), text_stl(&cube), obj(&cube));
    let error = |name: &str, bytes: &[u8]| read(name, bytes).unwrap_err().to_string();
    for (message, part) in [
        (error("a.stl", &stl[..70]), "84 bytes"),
        (error("a.stl", &stl[..300]), "600 bytes"),
        (error("a.stl", &[[0; 80].as_slice(), &[255; 4]].concat()), "cut short"),
        (error("a.stl", &[0; 84]), "none of 0"),
        (error("a.stl", text.split("endloop").next().unwrap().as_bytes()), "endfacet"),
        (error("a.stl", text.replacen("vertex", "vortex", 1).as_bytes()), "vortex"),
        (error("a.stl", text.replacen("vertex 0e0", "vertex zero", 1).as_bytes()), "zero"),
        (error("a.stl", text.replacen("vertex 0e0", "vertex nan", 1).as_bytes()), "finite"),
        (error("a.stl", text.replacen("endloop", "vertex 0 0 0", 1).as_bytes()), "three"),
        (error("a.obj", obj.replacen("v 0 0 0", "v 0 0", 1).as_bytes()), "byte 19"),
        (error("a.obj", obj.replacen("v 0 0 0", "v 0 0 inf", 1).as_bytes()), "finite"),
        (error("a.obj", obj.replacen("v 0 0 0", "v 0 0 o", 1).as_bytes()), "coordinate"),
        (error("a.obj", (obj.clone() + "f 1 2 9").as_bytes()), "8 vertices"),
        (error("a.obj", (obj.clone() + "f 1 2 0").as_bytes()), "8 vertices"),
        (error("a.obj", (obj.clone() + "f 1 2 -9").as_bytes()), "8 vertices"),
        (error("a.obj", (obj.clone() + "f 1 2//9223372036854775807 99999999999999999999").as_bytes()), "8 vertices"),
        (error("a.obj", (obj.clone() + "f 1 2").as_bytes()), "three corners"),
        (error("a.obj", b"# nothing\n"), "none of 0"),
    ] {
        assert!(message.contains(part), "{part}: {message}");
    }
}

#[test]
fn the_distance_to_a_box_and_to_a_sphere_is_that() {
    let nearest = Nearest::new(&cuboid(DVec3::ZERO, DVec3::new(4.0, 2.0, 2.0)));
    for (p, distance) in [
        ([2.0, 1.0, 0.25], 0.25),
        ([1.0, 1.0, 1.0], 1.0),
        ([-3.0, -4.0, 1.0], 5.0),
        ([5.0, 3.0, 3.0], 3f64.sqrt()),
        ([4.0, 2.0, 2.0], 0.0),
        ([2.0, 9.0, 1.0], 7.0),
    ] {
        assert!((nearest.distance(p.into()) - distance).abs() < 1e-14, "{p:?}");
    }
}

proptest! {
    #![proptest_config(crate::damage::config())]

    #[test]
    fn the_tree_finds_what_all_triangles_together_do(seed in any::<u64>(), p in prop::array::uniform3(-2.0..2.0)) {
        let wave = |d: DVec3| 1.0 + 0.3 * (d.dot(DVec3::new(3.0, 5.0, (seed % 7) as f64))).sin();
        let surface = blob(2, wave);
        let one = |t: &[u32; 3]| {
            Nearest::new(&Surface { points: surface.points.clone(), triangles: vec![*t], ..Surface::default() })
                .distance(p.into())
        };
        let least = surface.triangles.iter().map(one).fold(f64::INFINITY, f64::min);
        // A box may be passed over whose distance rounds to that of the nearest triangle known.
        prop_assert!((Nearest::new(&surface).distance(p.into()) - least).abs() < 1e-14);
    }

    #[test]
    fn damaged_files_give_a_surface_or_an_error(which in 0usize..3, damages in crate::damage::damages()) {
        let cube = cuboid(DVec3::ZERO, DVec3::ONE);
        let (name, mut bytes) = match which {
            0 => ("a.stl", binary_stl(&cube)),
            1 => ("a.stl", text_stl(&cube).into_bytes()),
            _ => ("a.obj", obj(&cube).into_bytes()),
        };
        damages.iter().for_each(|d| d.apply(&mut bytes));
        if bytes.is_empty() {
            return Ok(());
        }
        match crate::stuffing::read(&source(name, &bytes), None, &[]) {
            Ok(mesh) => prop_assert!(mesh.check().is_ok()),
            Err(error) => prop_assert!(error.to_string().len() < 1000, "{}", error),
        }
    }
}
