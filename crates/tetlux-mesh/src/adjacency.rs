//! Which cells share a face.

use rayon::prelude::*;

use crate::{FACES, NONE};

/// One side of a face: its vertices but the smallest, in ascending order, and where it belongs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct HalfFace {
    rest: [u32; 2],
    /// The cell times 8, plus the place in it of the vertex opposite, and [`ODD`].
    side: u32,
}

/// Ascending vertices are not in the order in which they run counter-clockwise seen from outside the cell.
const ODD: u32 = 4;

/// Two half-faces with the same three vertices.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Pair([u32; 2]);

impl Pair {
    pub(crate) fn cells(self) -> [u32; 2] {
        self.0.map(|side| side >> 3)
    }

    pub(crate) fn faces(self) -> [u8; 2] {
        self.0.map(|side| (side & 3) as u8)
    }

    /// The outward orders run the same way: the cells lie on one side of the face as their vertices stand.
    pub(crate) fn same_way(self) -> bool {
        (self.0[0] ^ self.0[1]) & ODD == 0
    }

    /// The last two vertices of one of its cells changed places.
    pub(crate) fn flip(&mut self, cell: u32) {
        for side in self.0.iter_mut().filter(|side| **side >> 3 == cell) {
            *side = cell << 3 | (*side & ODD ^ ODD) | [0, 1, 3, 2][(*side & 3) as usize];
        }
    }
}

/// The vertices of a cell in ascending order, each with its place; the second result is true if that is an odd
/// permutation.
fn sorted4(cell: &[u32; 4]) -> ([(u32, u32); 4], bool) {
    let mut v = [0, 1, 2, 3].map(|i| (cell[i], i as u32));
    let mut odd = false;
    for (i, j) in [(0, 1), (2, 3), (0, 2), (1, 3), (1, 2)] {
        let turned = v[i].0 > v[j].0;
        (v[i], v[j]) = if turned { (v[j], v[i]) } else { (v[i], v[j]) };
        odd ^= turned;
    }
    (v, odd)
}

/// The vertices of the face opposite a cell's vertex at a place, but the smallest, in ascending order.
fn rest(cell: &[u32; 4], place: usize) -> [u32; 2] {
    let [a, b, c] = FACES[place].map(|i| cell[i]);
    let (low, high) = (a.min(b).min(c), a.max(b).max(c));
    [a ^ b ^ c ^ low ^ high, high]
}

/// Vertices whose half-faces one thread matches in one go.
const VERTICES: usize = 4096;

/// The pairs of half-faces, and the number of faces that three or more cells share (these stay unpaired).
///
/// A counting sort puts the half-faces with the same smallest vertex together; these are compared with one another.
pub(crate) fn face_pairs(points: usize, cells: &[[u32; 4]]) -> (Vec<Pair>, usize) {
    let mut starts = vec![0u32; points + 2];
    for cell in cells {
        // The face opposite the smallest vertex has the next one for its smallest, the others have the smallest.
        let (low, high) = ([cell[0].min(cell[1]), cell[2].min(cell[3])], [cell[0].max(cell[1]), cell[2].max(cell[3])]);
        let smallest = low[0].min(low[1]);
        let next = low[0].max(low[1]).min(high[0]).min(high[1]);
        starts[smallest as usize + 2] += 3;
        starts[next as usize + 2] += 1;
    }
    for i in 0..points {
        starts[i + 2] += starts[i + 1];
    }
    // Starts move to the next vertex's as the places fill.
    let mut sides = vec![0u32; 4 * cells.len()];
    for (c, cell) in cells.iter().enumerate() {
        let ([p, q, r, s], odd) = sorted4(cell);
        let side = |opposite: u32, odd: bool| (c as u32) << 3 | opposite | if odd { ODD } else { 0 };
        let of_smallest = &mut starts[p.0 as usize + 1];
        let place = *of_smallest as usize;
        *of_smallest += 3;
        // The boundary of an oriented cell: signs alternate.
        sides[place..place + 3].copy_from_slice(&[side(q.1, !odd), side(r.1, odd), side(s.1, !odd)]);
        let of_next = &mut starts[q.0 as usize + 1];
        sides[*of_next as usize] = side(p.1, odd);
        *of_next += 1;
    }

    // One piece of memory: so many small ones are not given back to the system.
    let mut pairs = vec![Pair([0; 2]); 2 * cells.len()];
    let mut room = &mut pairs[..];
    let mut shares = Vec::new();
    for first in (0..points).step_by(VERTICES) {
        let starts = &starts[first..points.min(first + VERTICES) + 1];
        // As many as there may be: no two shares have a place in common.
        let [from, to] = [starts[0], starts[starts.len() - 1]].map(|half_face| half_face.div_ceil(2) as usize);
        let (share, after) = std::mem::take(&mut room).split_at_mut(to - from);
        shares.push((starts, share));
        room = after;
    }
    let matched = shares.into_par_iter().map(|(starts, share)| {
        let (mut non_manifold, mut bucket, mut pairs) = (0, Vec::new(), Vec::with_capacity(share.len()));
        for ends in starts.windows(2) {
            let half_face =
                |&side: &u32| HalfFace { rest: rest(&cells[(side >> 3) as usize], (side & 3) as usize), side };
            bucket.clear();
            bucket.extend(sides[ends[0] as usize..ends[1] as usize].iter().map(half_face));
            non_manifold += match_faces(&mut bucket, &mut pairs);
        }
        share[..pairs.len()].copy_from_slice(&pairs);
        (share.len(), pairs.len(), non_manifold)
    });
    let matched: Vec<(usize, usize, usize)> = matched.collect();
    let (mut from, mut kept, mut non_manifold) = (0, 0, 0);
    for (places, count, shared) in matched {
        pairs.copy_within(from..from + count, kept);
        (from, kept, non_manifold) = (from + places, kept + count, non_manifold + shared);
    }
    pairs.truncate(kept);
    (pairs, non_manifold)
}

/// Half-faces of one smallest vertex above which they are sorted: each is compared with all others else.
const FEW: usize = 100;

/// Pairs those half-faces with one smallest vertex that two cells share; how many faces more cells share.
fn match_faces(bucket: &mut [HalfFace], pairs: &mut Vec<Pair>) -> usize {
    let mut non_manifold = 0;
    let mut meet = |first: HalfFace, others: &[HalfFace]| match others {
        [] => {}
        [other] => pairs.push(Pair([first.side, other.side])),
        _ => non_manifold += 1,
    };
    if bucket.len() > FEW {
        bucket.sort_unstable_by_key(|half| (half.rest, half.side));
        bucket.chunk_by(|a, b| a.rest == b.rest).for_each(|group| meet(group[0], &group[1..]));
        return non_manifold;
    }
    let mut left = bucket;
    while let [first, others @ ..] = left {
        let mut same = 0;
        for i in 0..others.len() {
            if others[i].rest == first.rest {
                others.swap(i, same);
                same += 1;
            }
        }
        meet(*first, &others[..same]);
        left = &mut others[same..];
    }
    non_manifold
}

/// The neighbour table of the pairs that `keep` accepts.
pub(crate) fn neighbors(cells: usize, pairs: &[Pair], keep: impl Fn(&Pair) -> bool) -> Vec<[u32; 4]> {
    let mut table = vec![[NONE; 4]; cells];
    for pair in pairs.iter().filter(|p| keep(p)) {
        let (cells, faces) = (pair.cells(), pair.faces());
        for side in 0..2 {
            table[cells[side] as usize][faces[side] as usize] = cells[1 - side];
        }
    }
    table
}

#[cfg(test)]
mod tests;
