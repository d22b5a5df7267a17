//! From raw points and cells to a mesh.

use std::hash::{BuildHasher, RandomState};

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use crate::adjacency::{Pair, face_pairs, neighbors};
use crate::{Field, Location, MeshError, NONE, TetMesh};

/// What assembling a mesh found and mended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Assembly {
    /// Points as given.
    pub points_given: usize,
    /// Points that coincide with an earlier one and were merged into it.
    pub points_merged: usize,
    /// Merged points whose data differed from those they were merged into (the first one's are kept).
    pub merged_data_differ: usize,
    /// Cells as given.
    pub cells_given: usize,
    /// Cells dropped because two of their vertices are one point.
    pub cells_repeated: usize,
    /// Cells whose vertex order was reversed to make their volume positive.
    pub cells_inverted: usize,
    /// Cells of exactly zero volume: kept in the adjacency, without optical depth.
    pub cells_flat: usize,
    /// Faces that three or more cells share; treated as boundary.
    pub faces_non_manifold: usize,
    /// Faces whose two cells lie on the same side of them; treated as boundary.
    pub faces_folded: usize,
}

/// Most points, and most cells: u32::MAX is NONE, and half-faces, four a cell, are numbered with a bit to spare.
const LARGEST: usize = u32::MAX as usize / 8;

/// Cells that one thread looks at in one go.
const CELLS: usize = 8192;

impl TetMesh {
    /// Assembles a mesh of points in world space, cells by point index in any orientation, and fields.
    ///
    /// Points that coincide (after rounding to single precision about the bounding box's centre) are merged, the
    /// first one's data kept; cells with repeated vertices are dropped; the others oriented by the exact sign of
    /// their volume; faces matched. [`assembly`](Self::assembly) counts it all.
    pub fn assemble(points: &[DVec3], cells: &[[u32; 4]], fields: Vec<Field>) -> Result<TetMesh, MeshError> {
        for (what, count) in [("points", points.len()), ("cells", cells.len())] {
            if count > LARGEST {
                return Err(MeshError::TooLarge { what, count, limit: LARGEST });
            }
        }
        for field in &fields {
            let tuples = if field.location == Location::Point { points.len() } else { cells.len() };
            let expected = tuples.saturating_mul(field.components.max(1));
            if field.values.len() != expected || field.components == 0 {
                return Err(MeshError::FieldLength {
                    name: field.name.clone(),
                    found: field.values.len(),
                    expected,
                    tuples,
                    location: field.location.plural(),
                    components: field.components,
                });
            }
        }
        let largest = |cells: &[[u32; 4]]| cells.as_flattened().iter().fold(0, |largest, &v| v.max(largest));
        if cells.par_chunks(CELLS).any(|cells| largest(cells) as usize >= points.len()) {
            let vertices = cells.as_flattened().iter().enumerate();
            if let Some((i, &index)) = { vertices }.find(|&(_, &v)| v as usize >= points.len()) {
                return Err(MeshError::Index { cell: i / 4, index, points: points.len() });
            }
        }

        let mut assembly = Assembly { points_given: points.len(), cells_given: cells.len(), ..Assembly::default() };
        let (origin, local) = recentre(points)?;
        let (kept, target) = merge_coincident(&local);
        assembly.points_merged = points.len() - kept.len();
        let fields = merge_fields(fields, &kept, &target, &mut assembly);
        let points: Vec<Vec3> = kept.iter().map(|&i| local[i as usize]).collect();
        drop(local);

        let vertices = |cell: &[u32; 4]| cell.map(|v| target[v as usize]);
        let repeats = |cell: &[u32; 4]| (0..4).any(|i| (0..i).any(|j| cell[i] == cell[j]));
        let mut tets: Vec<[u32; 4]> = cells.par_iter().map(vertices).collect();
        let mut fields = fields;
        assembly.cells_repeated = tets.par_iter().filter(|cell| repeats(cell)).count();
        if assembly.cells_repeated == cells.len() {
            return Err(MeshError::Empty { dropped: assembly.cells_repeated });
        }
        if assembly.cells_repeated > 0 {
            let kept: Vec<usize> = (0..cells.len()).filter(|&c| !repeats(&tets[c])).collect();
            tets = kept.iter().map(|&c| tets[c]).collect();
            fields = keep_cells(fields, &kept);
        }

        let signs: Vec<i8> = tets
            .par_iter_mut()
            .map(|cell| {
                let sign = volume_sign(&points, cell);
                if sign < 0 {
                    cell.swap(2, 3);
                }
                sign
            })
            .collect();
        assembly.cells_inverted = signs.iter().filter(|&&s| s < 0).count();
        assembly.cells_flat = signs.iter().filter(|&&s| s == 0).count();

        let (mut pairs, non_manifold) = face_pairs(points.len(), &tets);
        assembly.faces_non_manifold = non_manifold;
        if assembly.cells_flat > 0 {
            orient_flat(&mut tets, &signs, &mut pairs);
        }
        assembly.faces_folded = pairs.iter().filter(|p| p.same_way()).count();
        let neighbors = neighbors(tets.len(), &pairs, |p| !p.same_way());
        Ok(TetMesh { origin, points, cells: tets, neighbors, fields, assembly })
    }
}

/// Positions relative to the bounding box's centre.
fn recentre(points: &[DVec3]) -> Result<(DVec3, Vec<Vec3>), MeshError> {
    let bad = |point: usize, at: DVec3| MeshError::Point { point, at: at.to_array() };
    let mut bounds = [DVec3::INFINITY, DVec3::NEG_INFINITY];
    for (i, &p) in points.iter().enumerate() {
        if !p.is_finite() {
            return Err(bad(i, p));
        }
        bounds = [bounds[0].min(p), bounds[1].max(p)];
    }
    let origin = bounds[0] * 0.5 + bounds[1] * 0.5;
    let mut local = Vec::with_capacity(points.len());
    for (i, &p) in points.iter().enumerate() {
        // Adding zero turns -0 into +0, so that equal points are equal bit for bit.
        let q = (p - origin).as_vec3() + Vec3::ZERO;
        if !q.is_finite() || q.abs().max_element() > 1e38 {
            return Err(bad(i, p));
        }
        local.push(q);
    }
    Ok((if points.is_empty() { DVec3::ZERO } else { origin }, local))
}

/// For each point the first of those that coincide with it, itself if none does: the points that
/// [`TetMesh::assemble`] makes one. Fails where that does: at a coordinate that is not finite or out of range.
pub fn coincident(points: &[DVec3]) -> Result<Vec<u32>, MeshError> {
    if points.len() > LARGEST {
        return Err(MeshError::TooLarge { what: "points", count: points.len(), limit: LARGEST });
    }
    recentre(points).map(|(_, local)| first_coincident(&local))
}

/// A table of the points met, by a hash of their bits: open addressing, at most half full.
fn first_coincident(points: &[Vec3]) -> Vec<u32> {
    let bits = |i: u32| points[i as usize].to_array().map(f32::to_bits);
    // Another one every time, so that no mesh is slow by design; what is found does not depend on it.
    let seed = RandomState::new().hash_one(points.len());
    let slots = (2 * points.len()).next_power_of_two().max(2);
    let shift = u64::BITS - slots.trailing_zeros();
    let mut table = vec![NONE; slots];
    (0..points.len() as u32)
        .map(|i| {
            let [x, y, z] = bits(i).map(u64::from);
            let folded = ((x << 32 | y) ^ seed).wrapping_mul(MIX);
            let mut slot = ((folded ^ folded >> 32 ^ z).wrapping_mul(MIX) >> shift) as usize;
            loop {
                match table[slot] {
                    NONE => {
                        table[slot] = i;
                        return i;
                    }
                    met if bits(met) == [x, y, z].map(|b| b as u32) => return met,
                    _ => slot = (slot + 1) % slots,
                }
            }
        })
        .collect()
}

/// Odd, its bits without a pattern: 2^64 over the golden ratio.
const MIX: u64 = 0x9E37_79B9_7F4A_7C15;

/// Points to keep, in their order, and for every point the place of the one it became.
fn merge_coincident(points: &[Vec3]) -> (Vec<u32>, Vec<u32>) {
    let first = first_coincident(points);
    let kept: Vec<u32> = (0..points.len() as u32).filter(|&i| first[i as usize] == i).collect();
    let mut place = vec![NONE; points.len()];
    for (k, &i) in kept.iter().enumerate() {
        place[i as usize] = k as u32;
    }
    let target = first.iter().map(|&i| place[i as usize]).collect();
    (kept, target)
}

/// Point fields on the points that are kept; counts the merged points whose data differ.
fn merge_fields(mut fields: Vec<Field>, kept: &[u32], target: &[u32], assembly: &mut Assembly) -> Vec<Field> {
    if assembly.points_merged == 0 {
        return fields;
    }
    let mut differs = vec![false; target.len()];
    for field in fields.iter_mut().filter(|f| f.location == Location::Point) {
        let n = field.components;
        let tuple = |i: usize| &field.values[i * n..(i + 1) * n];
        for (i, &t) in target.iter().enumerate() {
            let first = tuple(kept[t as usize] as usize);
            differs[i] |= tuple(i).iter().zip(first).any(|(a, b)| a != b && !(a.is_nan() && b.is_nan()));
        }
        field.values = kept.iter().flat_map(|&i| tuple(i as usize).iter().copied()).collect();
    }
    assembly.merged_data_differ = differs.iter().filter(|&&d| d).count();
    fields
}

/// Cell fields on the cells that are kept.
fn keep_cells(mut fields: Vec<Field>, kept: &[usize]) -> Vec<Field> {
    for field in fields.iter_mut().filter(|f| f.location == Location::Cell) {
        let n = field.components;
        field.values = kept.iter().flat_map(|&c| field.values[c * n..(c + 1) * n].iter().copied()).collect();
    }
    fields
}

/// Exact sign of the volume of a cell.
fn volume_sign(points: &[Vec3], cell: &[u32; 4]) -> i8 {
    let [a, b, c, d] = cell.map(|v| points[v as usize].as_dvec3());
    let (u, v, w) = (b - a, c - a, d - a);
    let (cross, size) = (u.cross(v), u.abs().element_sum() * v.abs().element_sum());
    let volume = cross.dot(w);
    if volume.abs() > VOLUME_ERROR * size * w.abs().element_sum() {
        return if volume > 0.0 { 1 } else { -1 };
    }
    let [a, b, c, d] = [a, b, c, d].map(|p| robust::Coord3D { x: p.x, y: p.y, z: p.z });
    // orient3d is positive where d is below the plane of a, b, c: the opposite of our sign.
    let sign = -robust::orient3d(a, b, c, d);
    i8::from(sign > 0.0) - i8::from(sign < 0.0)
}

/// Above Shewchuk's bound, 7.8e-16 over the sum of the products' magnitudes, which sums of components bound in turn.
const VOLUME_ERROR: f64 = 1e-15;

/// Gives flat cells, which have no orientation of their own, the one that fits their neighbours'.
fn orient_flat(cells: &mut [[u32; 4]], signs: &[i8], pairs: &mut [Pair]) {
    let mut around: Vec<Vec<usize>> = vec![Vec::new(); cells.len()];
    for (p, pair) in pairs.iter().enumerate() {
        if pair.cells().iter().any(|&c| signs[c as usize] == 0) {
            for c in pair.cells() {
                around[c as usize].push(p);
            }
        }
    }
    let mut oriented: Vec<bool> = signs.iter().map(|&s| s != 0).collect();
    let flat_or_beside = |c: usize| !around[c].is_empty();
    let mut queue: Vec<usize> = (0..cells.len()).filter(|&c| oriented[c] && flat_or_beside(c)).collect();
    let mut seed = 0;
    loop {
        while let Some(c) = queue.pop() {
            for &p in &around[c] {
                let cells_of = pairs[p].cells();
                let other = cells_of[usize::from(cells_of[0] as usize == c)] as usize;
                if oriented[other] {
                    continue;
                }
                oriented[other] = true;
                if pairs[p].same_way() {
                    flip(other, cells, &around, pairs);
                }
                queue.push(other);
            }
        }
        // A component of flat cells alone: any one of them sets the orientation of the rest.
        match (seed..cells.len()).find(|&c| !oriented[c]) {
            Some(c) => {
                oriented[c] = true;
                seed = c + 1;
                queue.push(c);
            }
            None => return,
        }
    }
}

/// Reverses a flat cell and all that is known of its faces.
fn flip(cell: usize, cells: &mut [[u32; 4]], around: &[Vec<usize>], pairs: &mut [Pair]) {
    cells[cell].swap(2, 3);
    for &p in &around[cell] {
        pairs[p].flip(cell as u32);
    }
}

#[cfg(test)]
mod tests;
