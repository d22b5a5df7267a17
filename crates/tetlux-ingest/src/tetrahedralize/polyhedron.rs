//! Polyhedra: cells of any number of faces.

use super::{Tetrahedra, fan};

/// Splits a polyhedron, given by the points round each face, into tetrahedra between a point in its middle and the
/// triangles of its faces. It should be visible from there; where it is not, tetrahedra are inverted.
pub(super) fn split(faces: &[&[u32]], origin: usize, made: &mut Tetrahedra) {
    let mut loops: Vec<Vec<u32>> = faces.iter().map(|face| without_repeats(face, made)).collect();
    loops.retain(|face| face.len() >= 3);
    let mut corners: Vec<u32> = loops.concat();
    corners.sort_unstable_by_key(|&v| (made.rank(v), v));
    corners.dedup_by_key(|v| made.rank(*v));
    if loops.len() < 4 || corners.len() < 4 {
        return;
    }
    orient(&mut loops, made);
    if let &[a, b, c, d] = corners.as_slice() {
        return made.mend(|made| made.push([a, b, c, d], origin));
    }
    let weight = 1.0 / corners.len() as f64;
    let center = made.add_point(&corners.iter().map(|&v| (v, weight)).collect::<Vec<_>>());
    made.mend(|made| {
        for face in &loops {
            let key = |made: &Tetrahedra, i: usize| made.rank(face[i]);
            fan(face.len(), key, made, |made, [i, j, k]| {
                made.push_split([center, face[i], face[j], face[k]], origin);
            });
        }
    });
}

/// The corners of a face, of neighbours that coincide only the first.
fn without_repeats(face: &[u32], made: &Tetrahedra) -> Vec<u32> {
    let mut corners = face.to_vec();
    corners.dedup_by_key(|v| made.rank(*v));
    while corners.len() > 1 && made.rank(corners[0]) == made.rank(corners[corners.len() - 1]) {
        corners.pop();
    }
    corners
}

/// Turns faces round so that all are seen from outside in the same sense, or all from inside: writers do not agree
/// on it. Two faces that do run opposite ways along the edge between them.
fn orient(loops: &mut [Vec<u32>], made: &Tetrahedra) {
    // (edge, face, whether the face runs from the edge's smaller end)
    let mut edges: Vec<([u32; 2], usize, bool)> = Vec::new();
    for (f, face) in loops.iter().enumerate() {
        for (i, &v) in face.iter().enumerate() {
            let (a, b) = (made.rank(v), made.rank(face[(i + 1) % face.len()]));
            edges.push(([a.min(b), a.max(b)], f, a < b));
        }
    }
    edges.sort_unstable();
    let mut around: Vec<Vec<(usize, bool)>> = vec![Vec::new(); loops.len()];
    for edge in edges.chunk_by(|a, b| a.0 == b.0) {
        if let &[(_, f, forward), (_, g, other)] = edge {
            around[f].push((g, forward == other));
            around[g].push((f, forward == other));
        }
    }
    let mut turned: Vec<Option<bool>> = vec![None; loops.len()];
    for start in 0..loops.len() {
        let mut stack = vec![(start, false)];
        while let Some((face, turn)) = stack.pop() {
            if turned[face].is_some() {
                continue;
            }
            turned[face] = Some(turn);
            stack.extend(around[face].iter().map(|&(next, same)| (next, turn ^ same)));
        }
    }
    for (face, _) in loops.iter_mut().zip(turned).filter(|(_, turned)| *turned == Some(true)) {
        face.reverse();
    }
}

#[cfg(test)]
mod tests;
