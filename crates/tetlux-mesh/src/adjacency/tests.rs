use std::collections::HashMap;

use glam::DVec3;
use proptest::prelude::*;

use super::*;
use crate::TetMesh;
use crate::procedural::random::SplitMix64;
use crate::procedural::{Parts, Split, grid};

/// A jittered grid, a random subset of its cells in random order, the vertices of each in random order.
///
/// Returns how many of them the shuffle turned inside out.
fn scrambled(counts: [usize; 3], split: Split, seed: u64, keep: f64) -> (Parts, usize) {
    let mut random = SplitMix64::new(seed);
    let spacing = DVec3::from(counts.map(|c| c as f64)).recip();
    let mut parts = grid(counts, split, |u| u);
    for p in &mut parts.points {
        // Three edges of a cell of six are the axes plus at most twice this each way: diagonally dominant below 1/6.
        *p += DVec3::from([(); 3].map(|()| 0.15 * random.signed())) * spacing;
    }
    parts.cells.retain(|_| random.unit() < keep);
    for i in (1..parts.cells.len()).rev() {
        parts.cells.swap(i, (random.next() % (i as u64 + 1)) as usize);
    }
    let mut turned = 0;
    for cell in &mut parts.cells {
        let mut odd = false;
        for i in (1..4).rev() {
            let j = (random.next() % (i as u64 + 1)) as usize;
            cell.swap(i, j);
            odd ^= i != j;
        }
        turned += usize::from(odd);
    }
    (parts, turned)
}

/// Sorts three indices; the second result is true if the sort is an odd permutation.
fn sorted3(mut v: [u32; 3]) -> ([u32; 3], bool) {
    let mut odd = false;
    for (i, j) in [(0, 1), (1, 2), (0, 1)] {
        if v[i] > v[j] {
            v.swap(i, j);
            odd = !odd;
        }
    }
    (v, odd)
}

/// Cells by face, the vertices of a face in ascending order.
fn cells_by_face(cells: &[[u32; 4]]) -> HashMap<[u32; 3], Vec<usize>> {
    let mut faces: HashMap<_, Vec<usize>> = HashMap::new();
    for (c, cell) in cells.iter().enumerate() {
        for face in FACES {
            faces.entry(sorted3(face.map(|i| cell[i])).0).or_default().push(c);
        }
    }
    faces
}

proptest! {
    #[test]
    fn neighbors_are_those_of_a_hash_map(
        counts in [1usize..5, 1usize..5, 1usize..5], seed: u64, keep in 0.2..1.1f64,
    ) {
        let (parts, turned) = scrambled(counts, Split::Six, seed, keep);
        prop_assume!(!parts.cells.is_empty());
        let mesh = TetMesh::assemble(&parts.points, &parts.cells, vec![]).unwrap();
        let found = mesh.assembly();
        prop_assert_eq!((found.points_merged, found.cells_repeated, found.cells_flat), (0, 0, 0));
        prop_assert_eq!((found.faces_folded, found.faces_non_manifold), (0, 0));
        prop_assert_eq!(found.cells_inverted, turned);

        let faces = cells_by_face(mesh.cells());
        for (c, cell) in mesh.cells().iter().enumerate() {
            for (f, face) in FACES.iter().enumerate() {
                let other = faces[&sorted3(face.map(|i| cell[i])).0].iter().copied().find(|&o| o != c);
                prop_assert_eq!(mesh.neighbors()[c][f], other.map_or(NONE, |o| o as u32));
            }
        }
        prop_assert_eq!(mesh.validate().boundary_faces, faces.values().filter(|cells| cells.len() == 1).count());
    }
}

#[test]
fn sorting_four_knows_the_parity_of_each_face() {
    for code in 0..256u32 {
        let cell = [0, 2, 4, 6].map(|shift| 10 + (code >> shift & 3));
        if (0..4).any(|i| (0..i).any(|j| cell[i] == cell[j])) {
            continue;
        }
        let (sorted, odd) = sorted4(&cell);
        assert_eq!(sorted.map(|(v, _)| v), [10, 11, 12, 13]);
        for (k, (v, place)) in sorted.into_iter().enumerate() {
            assert_eq!(cell[place as usize], v);
            // By definition: the face as it runs counter-clockwise seen from outside.
            let (face, face_odd) = sorted3(FACES[place as usize].map(|i| cell[i]));
            assert!(!face.contains(&v));
            assert_eq!(odd ^ (k % 2 == 1), face_odd, "{cell:?}, opposite {v}");
            assert_eq!(rest(&cell, place as usize), face[1..]);
        }
    }
}

#[test]
fn long_lists_are_matched_as_short_ones_are() {
    // Faces of one, two or three cells, in any order.
    let mut random = SplitMix64::new(9);
    for count in [5, FEW / 2, 3 * FEW] {
        let mut bucket: Vec<HalfFace> = Vec::new();
        let mut expected = [0, 0];
        for i in 0..count as u32 {
            let cells = random.next() % 3;
            for cell in 0..=cells as u32 {
                bucket.push(HalfFace { rest: [i / 7, i], side: (10 * i + cell) << 3 });
            }
            expected[0] += usize::from(cells == 1);
            expected[1] += usize::from(cells == 2);
        }
        for i in (1..bucket.len()).rev() {
            bucket.swap(i, (random.next() % (i as u64 + 1)) as usize);
        }
        let mut pairs = Vec::new();
        let non_manifold = match_faces(&mut bucket, &mut pairs);
        assert_eq!([pairs.len(), non_manifold], expected);
        assert!(pairs.iter().all(|pair| pair.cells()[0] != pair.cells()[1]));
        assert!(pairs.iter().all(|pair| pair.cells()[0] / 10 == pair.cells()[1] / 10));
    }
}

#[test]
fn faces_look_outwards() {
    let p = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
    for (opposite, [a, b, c]) in FACES.into_iter().enumerate() {
        let normal = (p[b] - p[a]).cross(p[c] - p[a]);
        assert!(normal.dot(p[opposite] - p[a]) < 0.0);
    }
}
