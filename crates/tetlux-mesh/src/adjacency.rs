//! Which cells share a face.

use crate::{FACES, NONE};

/// One side of a face: its vertices in ascending order, the parity of that sort, and where it belongs.
#[derive(Clone, Copy)]
struct HalfFace {
    rest: [u32; 2],
    cell: u32,
    /// Face number (0..4), with the parity of the outward order in bit 2.
    face: u8,
}

impl HalfFace {
    fn odd(self) -> bool {
        self.face & 4 != 0
    }
}

/// Two half-faces with the same three vertices.
pub(crate) struct Pair {
    pub(crate) cells: [u32; 2],
    pub(crate) faces: [u8; 2],
    /// The outward orders run the same way: the cells lie on one side of the face as their vertices stand.
    pub(crate) same_way: bool,
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

/// Pairs of half-faces, and the number of faces that three or more cells share (these stay unpaired).
///
/// A counting sort puts the half-faces with the same smallest vertex together; each short list is then sorted.
pub(crate) fn face_pairs(points: usize, cells: &[[u32; 4]]) -> (Vec<Pair>, usize) {
    let half_faces = || {
        cells.iter().enumerate().flat_map(|(c, cell)| {
            FACES.iter().enumerate().map(move |(f, face)| {
                let (v, odd) = sorted3(face.map(|i| cell[i]));
                (v[0] as usize, HalfFace { rest: [v[1], v[2]], cell: c as u32, face: f as u8 | u8::from(odd) << 2 })
            })
        })
    };
    let mut start = vec![0usize; points + 1];
    for (smallest, _) in half_faces() {
        start[smallest + 1] += 1;
    }
    for i in 0..points {
        start[i + 1] += start[i];
    }
    let mut next = start.clone();
    let mut sorted = vec![HalfFace { rest: [0; 2], cell: 0, face: 0 }; 4 * cells.len()];
    for (smallest, half) in half_faces() {
        sorted[next[smallest]] = half;
        next[smallest] += 1;
    }
    drop(next);

    let mut pairs = Vec::with_capacity(2 * cells.len());
    let mut non_manifold = 0;
    for i in 0..points {
        let bucket = &mut sorted[start[i]..start[i + 1]];
        bucket.sort_unstable_by_key(|h| (h.rest, h.cell));
        for group in bucket.chunk_by(|a, b| a.rest == b.rest) {
            match group {
                [a, b] => pairs.push(Pair {
                    cells: [a.cell, b.cell],
                    faces: [a.face & 3, b.face & 3],
                    same_way: a.odd() == b.odd(),
                }),
                [_] => {}
                _ => non_manifold += 1,
            }
        }
    }
    (pairs, non_manifold)
}

/// The neighbour table of the pairs that `keep` accepts.
pub(crate) fn neighbors(cells: usize, pairs: &[Pair], keep: impl Fn(&Pair) -> bool) -> Vec<[u32; 4]> {
    let mut table = vec![[NONE; 4]; cells];
    for pair in pairs.iter().filter(|p| keep(p)) {
        for side in 0..2 {
            table[pair.cells[side] as usize][pair.faces[side] as usize] = pair.cells[1 - side];
        }
    }
    table
}

#[cfg(test)]
mod tests;
