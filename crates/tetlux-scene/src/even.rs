//! Opacity by how much of a mesh lies where: the first look at data that nobody has looked at yet.

use glam::DVec3;
use rayon::prelude::*;
use tetlux_mesh::{FACES, Location, NONE, ScalarField, TetMesh};
use tetlux_optics::transfer::OpacityNode;

/// Parts of the field's range.
const BINS: usize = 24;

/// Optical depth, at most, of a stretch as long as the diagonal of the mesh's bounding box: what is rare is opaque within
/// a fiftieth of it, and no thinner.
const MOST: f64 = 100.0;

/// A cell's volume is counted where a quadratic's integral samples it: a twentieth at each vertex, the rest in its middle.
const AT_VERTEX: f64 = 0.05;

/// An opacity with which every part of the field's range has an equal share of the optical depth that the mesh has in
/// all, and a ray on average the depth given: what fills the mesh is nearly transparent, what is rare stands out.
///
/// The average is over all rays that meet the mesh: its extinction, integrated over its volume, over its mean projected
/// area, which for a convex body is a quarter of its surface (Cauchy 1832). It is met to some ten percent, but where the
/// mesh is so small or the depth so large that extinction would pass 100 over the diagonal.
///
/// Nodes span `range`, ascending; opacity is extinction times `unit_distance`. Cells without data, and what lies outside
/// the range, do not count. The same bits for any number of threads.
pub fn even_opacity(
    mesh: &TetMesh,
    scalar: &ScalarField,
    [low, high]: [f64; 2],
    depth: f64,
    unit_distance: f64,
) -> Vec<OpacityNode> {
    let volumes = volumes(mesh, scalar, [low, high]);
    let [near, far] = mesh.local_bounds();
    let most = MOST / near.distance(far).max(f64::MIN_POSITIVE);
    let extinctions = shared_out(&volumes, depth * surface(mesh) / 4.0, most);
    let node = |at: f64, k: usize| OpacityNode { s: low + (high - low) * at, opacity: extinctions[k] * unit_distance };
    let middles = (0..BINS).map(|k| node((k as f64 + 0.5) / BINS as f64, k));
    let mut nodes: Vec<_> = [node(0.0, 0)].into_iter().chain(middles).chain([node(1.0, BINS - 1)]).collect();
    // A range that has next to no width beside its place has not so many places.
    nodes.dedup_by(|next, last| next.s <= last.s);
    nodes
}

/// World volume over equal parts of the range.
fn volumes(mesh: &TetMesh, scalar: &ScalarField, [low, high]: [f64; 2]) -> [f64; BINS] {
    // Chunks of fixed size, summed in their order: threads change nothing.
    let size = mesh.cells().len().div_ceil(32).max(1);
    let parts: Vec<[f64; BINS]> = mesh
        .cells()
        .par_chunks(size)
        .enumerate()
        .map(|(chunk, cells)| {
            let mut volumes = [0.0; BINS];
            for (k, cell) in cells.iter().enumerate() {
                let values = match scalar.location {
                    Location::Point => cell.map(|v| scalar.values[v as usize]),
                    Location::Cell => [scalar.values[chunk * size + k]; 4],
                };
                if values.iter().any(|value| !value.is_finite()) {
                    continue;
                }
                let volume = volume(cell.map(|v| mesh.points()[v as usize].as_dvec3()));
                let places = values.map(|value| (value - low) / (high - low));
                let middle = places.iter().sum::<f64>() / 4.0;
                for (place, share) in
                    places.map(|p| (p, AT_VERTEX)).into_iter().chain([(middle, 1.0 - 4.0 * AT_VERTEX)])
                {
                    if (0.0..=1.0).contains(&place) {
                        volumes[((place * BINS as f64) as usize).min(BINS - 1)] += share * volume;
                    }
                }
            }
            volumes
        })
        .collect();
    let mut sum = [0.0; BINS];
    for part in parts {
        sum.iter_mut().zip(part).for_each(|(sum, volume)| *sum += volume);
    }
    sum
}

fn volume([a, b, c, d]: [DVec3; 4]) -> f64 {
    (b - a).cross(c - a).dot(d - a).abs() / 6.0
}

/// Area of the faces with a cell on one side alone.
fn surface(mesh: &TetMesh) -> f64 {
    let faces = mesh.cells().iter().zip(mesh.neighbors()).map(|(cell, neighbors)| {
        let free = (0..4).filter(|&face| neighbors[face] == NONE);
        free.map(|face| {
            let [a, b, c] = FACES[face].map(|k| mesh.points()[cell[k] as usize].as_dvec3());
            (b - a).cross(c - a).length() / 2.0
        })
        .sum::<f64>()
    });
    faces.sum()
}

/// Extinctions inverse to the volumes, smoothed over neighbours, none above the most, which integrate to a total.
fn shared_out(volumes: &[f64; BINS], total: f64, most: f64) -> [f64; BINS] {
    let mut smooth = *volumes;
    for k in 1..BINS - 1 {
        smooth[k] = 0.25 * volumes[k - 1] + 0.5 * volumes[k] + 0.25 * volumes[k + 1];
    }
    let with = |share: f64| smooth.map(|volume| if volume * most > share { share / volume } else { most });
    let integral =
        |share: f64| with(share).iter().zip(volumes).map(|(extinction, volume)| extinction * volume).sum::<f64>();
    // It grows with the share: halved until no share lies between.
    let (mut less, mut more) = (0.0, smooth.iter().copied().fold(0.0, f64::max) * most);
    for _ in 0..f64::MANTISSA_DIGITS {
        let middle = 0.5 * (less + more);
        *(if integral(middle) < total { &mut less } else { &mut more }) = middle;
    }
    with(more)
}

#[cfg(test)]
mod tests {
    use tetlux_mesh::procedural::{Split, cuboid};
    use tetlux_mesh::{Component, Field};

    use super::*;

    fn box_of(size: DVec3, field: impl FnMut(DVec3) -> f64) -> (TetMesh, ScalarField) {
        let parts = cuboid([8, 6, 6], Split::Six, [DVec3::ZERO, size]);
        let field = Field::point("s", 1, parts.sample(field));
        let mesh = TetMesh::assemble(&parts.points, &parts.cells, vec![field]).unwrap();
        let scalar = mesh.scalar("s", Component::Magnitude).unwrap();
        (mesh, scalar)
    }

    #[test]
    fn a_constant_field_has_the_mean_depth_asked_for() {
        // The mean chord of a convex body is 4 volumes over its surface: here 4 * 24 / 52.
        let (mesh, scalar) = box_of(DVec3::new(2.0, 3.0, 4.0), |_| 5.0);
        let nodes = even_opacity(&mesh, &scalar, [5.0, 6.0], 0.75, 10.0);
        let expected = 0.75 / (96.0 / 52.0) * 10.0;
        assert!((nodes[0].opacity / expected - 1.0).abs() < 1e-6, "{nodes:?}");
    }

    #[test]
    fn every_part_of_the_range_has_an_equal_share() {
        // The volume below s is s squared, of a unit cube times 2.
        let (mesh, scalar) = box_of(DVec3::new(2.0, 1.0, 1.0), |p| (p.x / 2.0).sqrt());
        let volumes = volumes(&mesh, &scalar, [0.0, 1.0]);
        assert!((volumes.iter().sum::<f64>() - 2.0).abs() < 1e-6);
        let nodes = even_opacity(&mesh, &scalar, [0.0, 1.0], 1.0, 1.0);
        assert_eq!(nodes.len(), BINS + 2);
        assert!(nodes.windows(2).all(|pair| pair[0].s < pair[1].s));
        let depth: f64 = (0..BINS).map(|k| volumes[k] * nodes[k + 1].opacity).sum();
        assert!((depth / (10.0 / 4.0) - 1.0).abs() < 1e-6, "{depth}");
        // A lattice of 8 is coarse: thirds of the range, not single parts.
        let share =
            |from: usize| (from..from + BINS / 3).map(|k| volumes[k] * nodes[k + 1].opacity).sum::<f64>() / depth;
        for from in [0, BINS / 3, 2 * BINS / 3] {
            assert!((share(from) - 1.0 / 3.0).abs() < 0.1, "{from}: {}", share(from));
        }
    }

    #[test]
    fn what_is_rare_is_opaque_but_no_more_than_that() {
        let (mesh, scalar) = box_of(DVec3::ONE, |p| if p == DVec3::ZERO { 1.0 } else { 0.0 });
        let nodes = even_opacity(&mesh, &scalar, [0.0, 1.0], 1.0, 2.0);
        let most = 2.0 * MOST / 3f64.sqrt();
        assert!(nodes.iter().all(|node| node.opacity > 0.0 && node.opacity <= most * (1.0 + 1e-12)), "{nodes:?}");
        assert!((nodes[BINS + 1].opacity - most).abs() < 1e-9 * most);
        assert!(nodes[0].opacity < 0.05 * most);
    }

    #[test]
    fn nothing_to_see_is_no_fault() {
        // No cell has data at all its vertices.
        let (mesh, scalar) = box_of(DVec3::ONE, |p| if p == DVec3::ZERO { 0.5 } else { f64::NAN });
        let nodes = even_opacity(&mesh, &scalar, [0.0, 1.0], 1.0, 1.0);
        assert!(nodes.iter().all(|node| node.opacity.is_finite()));
    }
}
