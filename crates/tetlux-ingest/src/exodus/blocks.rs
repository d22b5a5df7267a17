//! Element blocks: which cells they hold, in VTK's order of points.

use super::file::File;
use super::netcdf::Variable;
use crate::source::Source;
use crate::{IngestError, MixedMesh, Place};

/// A block whose cells are in the mesh.
pub(super) struct Block {
    /// Its number in the file, from 1.
    pub(super) number: u64,
    /// Its first cell in the mesh.
    pub(super) first: usize,
    /// Number of its cells.
    pub(super) cells: usize,
}

/// A kind of element with volume.
struct Shape {
    /// How its names begin.
    prefix: &'static str,
    /// VTK's number of the cell type.
    vtk: u8,
    /// For each point of VTK's cell, its place in the element.
    order: &'static [usize],
}

const IDENTITY: [usize; 13] = [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12];

/// The points of hexahedra and wedges at the middle of edges go round the bottom, up and round the top in Exodus, but
/// round the bottom, round the top and up in VTK. The 27-point hexahedron then has its centre, bottom, top, left, right,
/// front and back in Exodus, but left, right, front, back, bottom, top and centre in VTK. Of each kind the larger first.
const SHAPES: &[Shape] = &[
    Shape {
        prefix: "HEX",
        vtk: 29,
        order: &[0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 16, 17, 18, 19, 12, 13, 14, 15, 23, 24, 25, 26, 21, 22, 20],
    },
    Shape { prefix: "HEX", vtk: 25, order: &[0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 16, 17, 18, 19, 12, 13, 14, 15] },
    Shape { prefix: "HEX", vtk: 12, order: IDENTITY.split_at(8).0 },
    Shape { prefix: "TET", vtk: 24, order: IDENTITY.split_at(10).0 },
    Shape { prefix: "TET", vtk: 10, order: IDENTITY.split_at(4).0 },
    Shape { prefix: "WED", vtk: 26, order: &[0, 1, 2, 3, 4, 5, 6, 7, 8, 12, 13, 14, 9, 10, 11] },
    Shape { prefix: "WED", vtk: 13, order: IDENTITY.split_at(6).0 },
    Shape { prefix: "PYR", vtk: 27, order: &IDENTITY },
    Shape { prefix: "PYR", vtk: 14, order: IDENTITY.split_at(5).0 },
];

/// Adds the cells of every block of elements with volume, and notes the others.
pub(super) fn read(source: &Source, file: &File, mesh: &mut MixedMesh) -> Result<Vec<Block>, IngestError> {
    let mut connects: Vec<(u64, &Variable)> = file
        .variables()
        .filter_map(|variable| Some((variable.name.strip_prefix("connect")?.parse().ok()?, variable)))
        .collect();
    connects.sort_by_key(|&(number, _)| number);
    let mut blocks = Vec::new();
    for (number, connect) in connects {
        let kind = file.attribute(connect, "elem_type").unwrap_or_default();
        let elements = connect.shape.first().copied().unwrap_or_default();
        let nodes = connect.shape.get(1).copied().unwrap_or_default();
        let upper = kind.to_ascii_uppercase();
        let fitting = |shape: &&Shape| upper.starts_with(shape.prefix) && shape.order.len() as u64 <= nodes;
        let Some(shape) = SHAPES.iter().find(fitting) else {
            let kind = if kind.is_empty() { "unnamed kind" } else { &kind };
            let what = format!("block {number}: {elements} elements of {kind} with {nodes} nodes");
            mesh.notes.push(format!("{what}, which are no cells with volume that are known: left out"));
            continue;
        };
        if shape.order.len() as u64 != nodes {
            let what = format!("block {number}: elements of {kind} have {nodes} nodes");
            mesh.notes.push(format!("{what}, of which the first {} count", shape.order.len()));
        }
        let first = mesh.cells.types.len();
        add_cells(source, file, mesh, number, connect, shape)?;
        blocks.push(Block { number, first, cells: mesh.cells.types.len() - first });
    }
    if blocks.is_empty() {
        let found = mesh.notes.first().map_or("no element blocks", String::as_str);
        let remedy = "needed are hexahedra, tetrahedra, wedges or pyramids";
        return Err(source.malformed(Place::File, "no block has cells with volume", found, remedy));
    }
    Ok(blocks)
}

fn add_cells(
    source: &Source,
    file: &File,
    mesh: &mut MixedMesh,
    number: u64,
    connect: &Variable,
    shape: &Shape,
) -> Result<(), IngestError> {
    let name = format!("connect{number}");
    let ids = file.numbers(&name, connect, &[])?;
    let known = 1.0..=mesh.points.len() as f64;
    if let Some(at) = ids.iter().position(|id| !known.contains(id) || id.fract() != 0.0) {
        // The number of nodes of an element is a length within the file.
        let element = at as u64 / connect.shape[1];
        let what = format!("a node number of element {element} of {name}");
        let remedy = format!("nodes are numbered from 1 to {}", mesh.points.len());
        return Err(source.malformed(connect.place(), what, ids[at], remedy));
    }
    // There are as many as the shape says, all in the file.
    let nodes = connect.shape[1] as usize;
    mesh.cells.connectivity.reserve(ids.len() / nodes * shape.order.len());
    let mut points = [0u32; 27];
    for element in ids.chunks_exact(nodes) {
        shape.order.iter().zip(&mut points).for_each(|(&from, point)| *point = (element[from] - 1.0) as u32);
        mesh.cells.push(shape.vtk, &points[..shape.order.len()]);
    }
    Ok(())
}
