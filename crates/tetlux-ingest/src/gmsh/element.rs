//! Types of elements, and the elements of a file.

use super::tags::Tags;
use crate::source::Source;
use crate::{IngestError, MixedCells, Place};

/// A type of element.
pub(super) struct Kind {
    pub(super) nodes: usize,
    /// VTK's type, and for each point of it the element's node; `None` if the element has no volume.
    pub(super) cell: Option<(u8, &'static [usize])>,
}

/// Both list the same points in the same order.
const SAME: &[usize] = &[0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13];

/// The type of a number (Gmsh reference manual, "Node ordering"). VTK's wedge has its first triangle turned outwards,
/// Gmsh's prism inwards.
pub(super) fn kind(number: i64) -> Option<Kind> {
    let solid = |cell, order: &'static [usize]| Some(Kind { nodes: order.len(), cell: Some((cell, order)) });
    let flat = |nodes| Some(Kind { nodes, cell: None });
    match number {
        4 => solid(10, &SAME[..4]),
        5 => solid(12, &SAME[..8]),
        6 => solid(13, &[0, 2, 1, 3, 5, 4]),
        7 => solid(14, &SAME[..5]),
        11 => solid(24, &[0, 1, 2, 3, 4, 5, 6, 7, 9, 8]),
        12 => solid(
            29,
            &[0, 1, 2, 3, 4, 5, 6, 7, 8, 11, 13, 9, 16, 18, 19, 17, 10, 12, 14, 15, 22, 23, 21, 24, 20, 25, 26],
        ),
        13 => solid(32, &[0, 2, 1, 3, 5, 4, 7, 9, 6, 13, 14, 12, 8, 11, 10, 16, 17, 15]),
        // VTK has no pyramid with a node amid its base alone: it stays last, as one more than the type has.
        14 => solid(27, &[0, 1, 2, 3, 4, 5, 8, 10, 6, 7, 9, 11, 12, 13]),
        17 => solid(25, &[0, 1, 2, 3, 4, 5, 6, 7, 8, 11, 13, 9, 16, 18, 19, 17, 10, 12, 14, 15]),
        18 => solid(26, &[0, 2, 1, 3, 5, 4, 7, 9, 6, 13, 14, 12, 8, 11, 10]),
        19 => solid(27, &[0, 1, 2, 3, 4, 5, 8, 10, 6, 7, 9, 11, 12]),
        // A point; lines, triangles and quadrilaterals of every order that has a number of its own.
        15 => flat(1),
        1 => flat(2),
        8 => flat(3),
        26..=28 => flat(number as usize - 22),
        62..=66 => flat(number as usize - 55),
        2 => flat(3),
        9 => flat(6),
        20 => flat(9),
        21 => flat(10),
        22 => flat(12),
        23 | 24 => flat(15),
        25 => flat(21),
        42 => flat(28),
        43 => flat(36),
        44 => flat(45),
        45 => flat(55),
        46 => flat(66),
        3 => flat(4),
        10 => flat(9),
        16 => flat(8),
        36 => flat(16),
        37 => flat(25),
        38 => flat(36),
        47 => flat(49),
        48 => flat(64),
        49 => flat(81),
        50 => flat(100),
        51 => flat(121),
        39 => flat(12),
        40 => flat(16),
        41 => flat(20),
        _ => None,
    }
}

/// The elements of a file that have a volume, by the tags of their nodes.
#[derive(Default, PartialEq, Eq)]
pub(super) struct Elements {
    tags: Vec<u64>,
    types: Vec<u8>,
    nodes: Vec<u64>,
    ends: Vec<usize>,
    /// Elements without volume.
    pub(super) flat: usize,
}

impl Elements {
    /// Takes an element; its nodes must be as many as its kind has.
    pub(super) fn push(&mut self, tag: u64, kind: &Kind, nodes: impl Fn(usize) -> u64) {
        let Some((cell, order)) = kind.cell else {
            self.flat += 1;
            return;
        };
        self.tags.push(tag);
        self.types.push(cell);
        self.nodes.extend(order.iter().map(|&i| nodes(i)));
        self.ends.push(self.nodes.len());
    }

    /// Makes cells of the elements, and gives their tags.
    pub(super) fn assemble(
        &mut self,
        source: &Source,
        nodes: &Tags,
        cells: &mut MixedCells,
    ) -> Result<Vec<u64>, IngestError> {
        cells.connectivity.reserve_exact(self.nodes.len());
        for (i, &tag) in self.nodes.iter().enumerate() {
            let Some(place) = nodes.get(tag) else {
                let cell = self.ends.partition_point(|&end| end <= i);
                let what = format!("a node of element {}", self.tags[cell]);
                return Err(source.malformed(Place::Cell(cell), what, tag, "no node has this tag"));
            };
            cells.connectivity.push(place);
        }
        self.nodes = Vec::new();
        cells.types = std::mem::take(&mut self.types);
        cells.offsets = std::mem::take(&mut self.ends);
        Ok(std::mem::take(&mut self.tags))
    }
}
