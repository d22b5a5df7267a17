use tetlux_mesh::procedural::{Parts, Split, cuboid, sphere_shell};

use super::*;

fn assemble(parts: &Parts) -> TetMesh {
    TetMesh::assemble(&parts.points, &parts.cells, vec![]).unwrap()
}

fn block(counts: [usize; 3], low: [f64; 3], high: [f64; 3]) -> Parts {
    cuboid(counts, Split::Six, [low.into(), high.into()])
}

/// `count` cells round the z axis, the first and the last of them joined after `turns` full turns.
fn fan(count: u32, turns: u32) -> Parts {
    let mut points = vec![DVec3::NEG_Z, DVec3::Z];
    points.extend((0..count).map(|i| {
        let angle = std::f64::consts::TAU * f64::from(turns * i) / f64::from(count);
        // Apart by a little, so that sheets one upon the other are not merged.
        DVec3::new(angle.cos(), angle.sin(), 0.0) * (1.0 + 1e-3 * f64::from(i * turns / count))
    }));
    Parts { points, cells: (0..count).map(|i| [0, 1, 2 + i, 2 + (i + 1) % count]).collect() }
}

#[test]
fn every_face_knows_its_cells() {
    let mesh = assemble(&block([3, 2, 2], [0.0; 3], [3.0, 2.0, 2.0]));
    let facts = Facts::new(&mesh);
    assert_eq!(facts.owners.len() + facts.interior, 4 * mesh.cells().len());
    assert_eq!(facts.boundary_faces(), mesh.validate().boundary_faces);
    let mut met = vec![0; facts.owners.len()];
    for (c, faces) in facts.faces.iter().enumerate() {
        for (f, &face) in faces.iter().enumerate() {
            let number = (face >> 1) as usize;
            met[number] += 1;
            let (owner, mut vertices) = facts.vertices(&mesh, number);
            let mut own = FACES[f].map(|i| mesh.cells()[c][i]);
            assert_eq!(face & 1 == 0, owner as usize == c);
            assert_eq!(number >= facts.interior, mesh.neighbors()[c][f] == NONE);
            vertices.sort_unstable();
            own.sort_unstable();
            assert_eq!(vertices, own);
        }
    }
    assert!(met.iter().enumerate().all(|(face, &cells)| cells == if face < facts.interior { 2 } else { 1 }));
}

#[test]
fn planes_have_their_cell_behind_them() {
    let mesh = assemble(&sphere_shell([8, 6, 2], Split::Six, DVec3::ZERO, [1.0, 2.0]));
    let facts = Facts::new(&mesh);
    for (face, &owner) in facts.owners.iter().enumerate() {
        let [x, y, z, d] = facts.planes[face / LANES].map(|row| row[face % LANES]);
        let distance = |v: u32| Vec3::new(x, y, z).dot(mesh.points()[v as usize]) + d;
        let cell = mesh.cells()[(owner >> 2) as usize];
        // Coordinates up to 2, a few roundings.
        assert!(facts.vertices(&mesh, face).1.into_iter().all(|v| distance(v).abs() < 1e-6));
        assert!(distance(cell[(owner & 3) as usize]) < 1e-6);
        assert!((Vec3::new(x, y, z).length() - 1.0).abs() < 1e-6);
    }
}

#[test]
fn a_cell_takes_little_memory() {
    let mesh = assemble(&block([20; 3], [0.0; 3], [1.0; 3]));
    assert!(Facts::new(&mesh).bytes() < 70 * mesh.cells().len());
}

#[test]
fn edges_of_the_boundary_join_faces_that_run_opposite_ways() {
    let pieces = [block([2; 3], [0.0; 3], [1.0; 3]), block([1; 3], [1.0, 1.0, 0.0], [2.0, 2.0, 1.0])];
    let mut touching = pieces[0].clone();
    touching.append(&pieces[1]);
    for parts in [pieces[0].clone(), touching, sphere_shell([8, 6, 2], Split::Six, DVec3::ZERO, [1.0, 2.0])] {
        let mesh = assemble(&parts);
        let facts = Facts::new(&mesh);
        let surface = facts.surface(&mesh);
        assert_eq!(surface.corners.len(), facts.boundary_faces());
        for (i, corners) in surface.corners.iter().enumerate() {
            let points = corners.map(|corner| surface.points[corner as usize]);
            assert_eq!(points, facts.vertices(&mesh, facts.interior + i).1);
        }
        // Every side of every face once, from one of its ends to the other.
        let mut sides: Vec<(u32, [u32; 2])> = Vec::new();
        for edge in &surface.edges {
            let [from, to] = edge.ends;
            sides.extend([(edge.faces[0], [from, to]), (edge.faces[1], [to, from])]);
        }
        sides.sort_unstable();
        let of_face =
            |(i, &[a, b, c]): (usize, &[u32; 3])| [(i as u32, [a, b]), (i as u32, [b, c]), (i as u32, [c, a])];
        let mut expected: Vec<_> = surface.corners.iter().enumerate().flat_map(of_face).collect();
        expected.sort_unstable();
        assert_eq!(sides, expected);
    }
}

#[test]
fn steps_lead_to_the_neighbors() {
    let mesh = assemble(&block([6, 5, 4], [0.0; 3], [1.0; 3]));
    let facts = Facts::new(&mesh);
    let steps = facts.steps(&mesh).unwrap();
    for (c, (steps, around)) in steps.iter().zip(mesh.neighbors()).enumerate() {
        for (&step, &neighbor) in steps.iter().zip(around) {
            assert_eq!(step == 0, neighbor == NONE);
            assert!(step == 0 || c as i64 + i64::from(step) == i64::from(neighbor));
        }
    }
    // Two layers of more cells than a step can pass over: too many are far from their neighbours.
    let wide = assemble(&block([80, 80, 2], [0.0; 3], [1.0; 3]));
    assert!(Facts::new(&wide).steps(&wide).is_none());
}

#[test]
fn what_is_convex_is_certified() {
    for counts in [[1, 1, 1], [4, 3, 2], [7, 1, 1]] {
        for split in [Split::Five, Split::Six] {
            let parts = cuboid(counts, split, [DVec3::splat(-0.3), DVec3::new(1.0, 2.0, 0.7)]);
            assert!(Facts::new(&assemble(&parts)).convex(), "{counts:?}");
        }
    }
    for count in [3, 5, 8] {
        assert!(Facts::new(&assemble(&fan(count, 1))).convex(), "{count} cells round an axis");
    }
    let single = Parts { points: vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z], cells: vec![[0, 1, 2, 3]] };
    assert!(Facts::new(&assemble(&single)).convex());
}

#[test]
fn what_is_not_convex_is_not() {
    let join = |parts: &[Parts]| {
        let mut all = Parts::default();
        parts.iter().for_each(|part| all.append(part));
        all
    };
    let first = block([1; 3], [0.0; 3], [1.0; 3]);
    let cases = [
        (
            "an L",
            join(&[
                first.clone(),
                block([1; 3], [1.0, 0.0, 0.0], [2.0, 1.0, 1.0]),
                block([1; 3], [0.0, 1.0, 0.0], [1.0, 2.0, 1.0]),
            ]),
        ),
        ("two pieces", join(&[first.clone(), block([1; 3], [2.0, 0.0, 0.0], [3.0, 1.0, 1.0])])),
        ("pieces that touch at an edge", join(&[first.clone(), block([1; 3], [1.0, 1.0, 0.0], [2.0, 2.0, 1.0])])),
        ("a shell", sphere_shell([8, 6, 2], Split::Six, DVec3::ZERO, [1.0, 2.0])),
        ("one block within another", join(&[first.clone(), block([1; 3], [0.25; 3], [0.75; 3])])),
        ("a fan wound twice", fan(11, 2)),
    ];
    for (what, parts) in cases {
        assert!(!Facts::new(&assemble(&parts)).convex(), "{what}");
    }
    // A dent in a flat side, of one unit in the last place.
    let mut dented = block([2; 3], [-1.0; 3], [1.0; 3]);
    let middle = dented.points.iter_mut().find(|p| **p == DVec3::Z).unwrap();
    middle.z = f64::from(1.0f32.next_down());
    assert!(!Facts::new(&assemble(&dented)).convex());
}

#[test]
fn facts_are_read_back_from_bytes() {
    let mesh = assemble(&sphere_shell([8, 6, 2], Split::Six, DVec3::ZERO, [1.0, 2.0]));
    let facts = Facts::new(&mesh);
    let bytes = facts.to_bytes();
    let back = Facts::from_bytes(&bytes, &mesh).unwrap();
    assert_eq!(back.to_bytes(), bytes);
    assert_eq!((back.known, back.reach), (facts.known, facts.reach));
    assert_ne!(back.id, facts.id);
    // Not aligned.
    let moved = [&[0][..], &bytes].concat();
    assert!(Facts::from_bytes(&moved[1..], &mesh).is_some());
}

#[test]
fn other_bytes_are_refused() {
    let mesh = assemble(&block([2; 3], [0.0; 3], [1.0; 3]));
    let bytes = Facts::new(&mesh).to_bytes();
    for length in (0..bytes.len()).step_by(7) {
        assert!(Facts::from_bytes(&bytes[..length], &mesh).is_none(), "{length} bytes");
    }
    assert!(Facts::from_bytes(&[&bytes[..], &[0; 16]].concat(), &mesh).is_none());
    let other = assemble(&cuboid([2; 3], Split::Five, [DVec3::ZERO, DVec3::ONE]));
    assert!(Facts::from_bytes(&bytes, &other).is_none());
    // Every change of the header's counts and of the faces is noticed, or harmless: it never panics.
    let planes = 12 * 8..12 * 8 + size_of_val(&Facts::new(&mesh).planes[..]);
    let mut refused = 0;
    for at in (0..bytes.len()).filter(|at| !planes.contains(at)) {
        let mut changed = bytes.clone();
        changed[at] ^= 0x41;
        refused += usize::from(Facts::from_bytes(&changed, &mesh).is_none());
        if at >= planes.end {
            assert!(Facts::from_bytes(&changed, &mesh).is_none(), "byte {at}");
        }
    }
    assert!(refused > 0);
}
