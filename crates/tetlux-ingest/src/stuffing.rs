//! From a closed surface to tetrahedra: isosurface stuffing (Labelle and Shewchuk 2007, the uniform lattice).

mod crossings;
mod lattice;
mod stencil;

use glam::DVec3;
use rayon::prelude::*;
use tetlux_mesh::Field;
use tetlux_mesh::procedural::Parts;

use crate::cell_type::TETRAHEDRON;
use crate::source::Source;
use crate::surface::{Nearest, Surface};
use crate::{Expression, IngestError, MixedCells, MixedMesh};
use crossings::Crossing;
use lattice::{DIRECTIONS, Lattice, is_long};

/// The field of distances to the surface.
pub const DISTANCE: &str = "distance";

/// A cut nearer than this to a lattice node, as a part of the edge's length, moves the node onto the surface: on long
/// edges and on short ones (Labelle and Shewchuk 2007).
const ALPHA: [f64; 2] = [0.24999, 0.41189];

/// A surface's inside, filled.
#[derive(Debug, Clone, PartialEq)]
pub struct Filled {
    /// Points and tetrahedra, positively oriented.
    pub parts: Parts,
    /// Fields on the points: [`DISTANCE`], and those that were asked for.
    pub fields: Vec<Field>,
    /// What had to be mended, a sentence each.
    pub notes: Vec<String>,
}

/// Fills a closed surface with tetrahedra of one size, of dihedral angles between 9.31 and 161.65 degrees whatever
/// the surface.
///
/// The tetrahedra are those of a body-centred cubic lattice, cut where its edges cross the surface, so that all points
/// of the new boundary lie on the surface; nodes too near to a cut are moved onto it first. `cell_size` is the length
/// of the lattice's long edges; the short ones have 0.87 of it, and a tetrahedron inside a twelfth of its cube as
/// volume. Sharp edges and corners are rounded off over about a cell, and what is thinner than a cell may be lost.
///
/// Inside is where the surface winds round a point at all: parts that overlap are united, and a part that faces the
/// other way inside another is a hole. All triangles may face inwards instead; where neighbours disagree they are
/// turned, and noted.
///
/// The fields are the distance to the nearest triangle, in world units, 0 on the boundary and positive inside, and
/// the expressions under their names.
///
/// Fails if the surface is not closed, if the cell size is not positive, or so small that there were too many cells
/// (the error says which would do), or so large that no lattice node lies inside.
pub fn fill(surface: &Surface, cell_size: f64, expressions: &[(String, Expression)]) -> Result<Filled, IngestError> {
    let mut notes = Vec::new();
    let mended = mend(surface, &mut notes)?;
    let surface = mended.as_ref().unwrap_or(surface);
    let lattice = Lattice::round(surface, cell_size)?;
    let nearest = Nearest::new(surface);

    let crossings = crossings::find(surface, &lattice);
    let mut inside = crossings::windings(&lattice, &crossings);
    let mut cuts = cuts(&lattice, &inside, &crossings, &nearest);
    drop(crossings);
    let warped = warp(&lattice, &mut inside, &mut cuts);
    let Made { parts, on_surface } = make(&lattice, &inside, &cuts, &warped);
    if parts.cells.is_empty() {
        let path = surface.path.clone();
        return Err(IngestError::NothingInside { path, cell_size });
    }
    let distance = |(&p, &on): (&DVec3, &bool)| if on { 0.0 } else { nearest.distance(p) };
    let distances = parts.points.par_iter().zip(&on_surface).map(distance).collect();
    let mut fields = vec![Field::point(DISTANCE, 1, distances)];
    fields.extend(expressions.iter().map(|(name, f)| Field::point(name.as_str(), 1, f.values(&parts.points))));
    Ok(Filled { parts, fields, notes })
}

/// Reads a surface and fills it, by default with cells of a fortieth of its diagonal.
pub(crate) fn read(
    source: &Source,
    cell_size: Option<f64>,
    expressions: &[(String, Expression)],
) -> Result<MixedMesh, IngestError> {
    let surface = Surface::from_source(source)?;
    let [low, high] = surface.bounds();
    let cell_size = cell_size.unwrap_or(low.distance(high) / 40.0);
    let Filled { parts, fields, notes } = fill(&surface, cell_size, expressions)?;
    let mut cells = MixedCells::default();
    parts.cells.iter().for_each(|cell| cells.push(TETRAHEDRON, cell));
    let notes = [surface.notes, notes].concat();
    Ok(MixedMesh { path: surface.path, points: parts.points, cells, fields, notes, ..MixedMesh::default() })
}

/// Refuses a surface that is not closed; one whose triangles disagree is given back turned.
fn mend(surface: &Surface, notes: &mut Vec<String>) -> Result<Option<Surface>, IngestError> {
    let mut report = surface.report();
    let mut mended = None;
    if report.edges_same_way > 0 && report.edges_open + report.edges_non_manifold == 0 {
        let turned = mended.insert(surface.clone()).orient();
        notes.push(format!("triangles that faced another way than their neighbours: {turned}, turned round"));
        report = mended.as_ref().unwrap_or(surface).report();
    }
    if report.closed() {
        return Ok(mended);
    }
    Err(IngestError::NotClosed {
        path: surface.path.clone(),
        open: report.edges_open,
        non_manifold: report.edges_non_manifold,
        same_way: report.edges_same_way,
    })
}

/// Where the surface crosses a lattice edge, one end of which is inside and the other not.
struct Cut {
    /// [`Lattice::edge`].
    edge: u64,
    /// The nodes at its ends.
    ends: [u32; 2],
    /// Where on it, from 0 to 1.
    at: f64,
}

/// The cuts of all edges with one end inside, by edge. `inside` holds the winding number of each node.
fn cuts(lattice: &Lattice, inside: &[i32], crossings: &[Crossing], nearest: &Nearest) -> Vec<Cut> {
    let mut cuts = Vec::new();
    let mut rest = crossings;
    for node in 0..lattice.nodes() {
        let at = lattice.coordinates(node);
        for direction in 0..DIRECTIONS.len() {
            let Some(other) = lattice.node(lattice::step(at, direction)) else { continue };
            if (inside[node] != 0) == (inside[other] != 0) {
                continue;
            }
            let edge = lattice::edge(node, direction);
            let skipped = rest.iter().take_while(|crossing| crossing.edge < edge).count();
            rest = &rest[skipped..];
            let own = rest.iter().take_while(|crossing| crossing.edge == edge).count();
            let at = leaving(inside[node], inside[other], &rest[..own]).unwrap_or_else(|| {
                // By rounding, a crossing close to a node is on the edge beyond it.
                let [a, b] = [node, other].map(|n| nearest.distance(lattice.position(n)));
                if a + b > 0.0 { a / (a + b) } else { 0.5 }
            });
            cuts.push(Cut { edge, ends: [node as u32, other as u32], at });
        }
    }
    cuts
}

/// Where the winding number becomes 0, going from the end that is inside.
fn leaving(first: i32, last: i32, crossings: &[Crossing]) -> Option<f64> {
    let mut winding = if first != 0 { first } else { last };
    let mut pass = |step: i32, at: f64| {
        winding += step;
        (winding == 0).then_some(at)
    };
    match first {
        0 => crossings.iter().rev().find_map(|c| pass(-i32::from(c.step), c.at)),
        _ => crossings.iter().find_map(|c| pass(i32::from(c.step), c.at)),
    }
}

/// Moves nodes onto the surface that are too near to a cut, and drops the cuts of their edges. Of each node `inside`
/// becomes its sign: 1 inside, 0 on the surface, -1 outside. Gives the nodes that moved, in order, and where to.
fn warp(lattice: &Lattice, inside: &mut [i32], cuts: &mut Vec<Cut>) -> Vec<(u32, DVec3)> {
    inside.iter_mut().for_each(|w| *w = if *w != 0 { 1 } else { -1 });
    let mut near: Vec<(u32, f64, usize)> = Vec::new();
    for (c, cut) in cuts.iter().enumerate() {
        let long = is_long(lattice::direction(cut.edge));
        let (length, alpha) = if long { (2.0, ALPHA[0]) } else { (3f64.sqrt(), ALPHA[1]) };
        for (end, part) in [(0, cut.at), (1, 1.0 - cut.at)] {
            if part < alpha {
                near.push((cut.ends[end], part * length, c));
            }
        }
    }
    near.sort_unstable_by(|a, b| (a.0, a.2).cmp(&(b.0, b.2)).then(a.1.total_cmp(&b.1)));
    let mut moved = Vec::new();
    for of_node in near.chunk_by(|a, b| a.0 == b.0) {
        // An edge with an end that has moved is cut no longer.
        let alive = of_node.iter().filter(|&&(_, _, c)| cuts[c].ends.iter().all(|&n| inside[n as usize] != 0));
        if let Some(&(node, _, c)) = alive.min_by(|a, b| a.1.total_cmp(&b.1)) {
            inside[node as usize] = 0;
            moved.push((node, position(lattice, &cuts[c])));
        }
    }
    cuts.retain(|cut| cut.ends.iter().all(|&n| inside[n as usize] != 0));
    moved
}

fn position(lattice: &Lattice, cut: &Cut) -> DVec3 {
    let [a, b] = cut.ends.map(|n| lattice.position(n as usize));
    a.lerp(b, cut.at)
}

/// The mesh, and for each of its points whether it lies on the surface.
struct Made {
    parts: Parts,
    on_surface: Vec<bool>,
}

/// Makes the tetrahedra of every lattice cell with a node inside.
fn make(lattice: &Lattice, signs: &[i32], cuts: &[Cut], moved: &[(u32, DVec3)]) -> Made {
    const NONE: u32 = u32::MAX;
    let mut made = Made { parts: Parts::default(), on_surface: Vec::new() };
    let (mut of_node, mut of_cut) = (vec![NONE; lattice.nodes()], vec![NONE; cuts.len()]);
    let cut_of = |edge: u64| cuts.partition_point(|cut| cut.edge < edge);
    let moved_to = |node: usize| moved[moved.partition_point(|m| m.0 < node as u32)].1;
    lattice.for_each_cell(|cell| {
        let cell_signs = cell.map(|n| signs[n]);
        if !cell_signs.contains(&1) {
            return;
        }
        let mut point = |[a, b]: [usize; 2]| {
            // The stencil cuts edges between a node inside and one outside alone, and each of these has its cut.
            let c = if a == b { 0 } else { cut_of(lattice.edge_between(cell[a], cell[b])) };
            let place = if a == b { &mut of_node[cell[a]] } else { &mut of_cut[c] };
            if *place == NONE {
                *place = made.parts.points.len() as u32;
                made.parts.points.push(match signs[cell[a]] {
                    _ if a != b => position(lattice, &cuts[c]),
                    0 => moved_to(cell[a]),
                    _ => lattice.position(cell[a]),
                });
                made.on_surface.push(a != b || signs[cell[a]] == 0);
            }
            *place
        };
        let cells = &mut made.parts.cells;
        stencil::tetrahedra(cell_signs, |i| lattice.is_even(cell[i]), |corners| cells.push(corners.map(&mut point)));
    });
    made
}

#[cfg(test)]
mod tests;
