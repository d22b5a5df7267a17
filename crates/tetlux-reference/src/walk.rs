//! From cell to cell along a line.

use glam::DVec3;
use tetlux_mesh::{FACES, Location, NONE, ScalarField, TetMesh};

use crate::hierarchy::Hierarchy;
use crate::line::{Line, Vertex};

/// What is known of a point: what it is classified by, which is two scalars, or its luminance and opacity themselves; from
/// [`GRADIENT`] on the gradient of the first scalar. What a scene does not use is 0.
pub(crate) type Values = [f64; 7];

/// Where the gradient begins.
pub(crate) const GRADIENT: usize = 4;

/// A stretch of a line with all values linear along it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Segment {
    /// Parameter of its ends, ascending.
    pub(crate) t: [f64; 2],
    /// Values at its ends; NaN in a cell without data.
    pub(crate) values: [Values; 2],
}

impl Segment {
    /// Values at a parameter; a value that is the same at both ends is that everywhere.
    pub(crate) fn at(&self, t: f64) -> Values {
        let share = (t - self.t[0]) / (self.t[1] - self.t[0]);
        let [front, back] = &self.values;
        std::array::from_fn(|k| if front[k] == back[k] { front[k] } else { front[k] * (1.0 - share) + back[k] * share })
    }
}

/// The mesh in coordinates of about unit size: relative to its origin, times a power of two, hence exact.
pub(crate) struct Space<'a> {
    pub(crate) mesh: &'a TetMesh,
    /// The first scalar, and the second if there is one.
    pub(crate) scalars: [Option<&'a ScalarField>; 2],
    /// The gradient of the first scalar at the points, if it is asked for.
    pub(crate) gradients: Option<&'a [DVec3]>,
    /// Luminance and opacity at the points, if they are given.
    pub(crate) colors: Option<&'a [[f64; 4]]>,
    /// Power of two that takes the mesh's half-width into [0.5, 1).
    pub(crate) scale: f64,
    /// What there is to see in each cell.
    pub(crate) contents: Vec<Contents>,
}

/// What there is to see in a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Contents {
    /// Nothing: it has no volume.
    Nothing,
    /// What its values look like.
    Data,
    /// A value is missing.
    NoData,
}

impl Space<'_> {
    pub(crate) fn position(&self, vertex: u32) -> DVec3 {
        self.mesh.points()[vertex as usize].as_dvec3() * self.scale
    }

    fn vertex(&self, line: &Line, index: u32) -> Vertex {
        let position = self.position(index);
        let by_point = |scalar: Option<&ScalarField>| {
            scalar.filter(|s| s.location == Location::Point).map_or(0.0, |s| s.values[index as usize])
        };
        let [x, y] = self.scalars.map(by_point);
        let [a, b, c, d] = self.colors.map_or([x, y, 0.0, 0.0], |colors| colors[index as usize]);
        let gradient = self.gradients.map_or(DVec3::ZERO, |gradients| gradients[index as usize]);
        let values = [a, b, c, d, gradient.x, gradient.y, gradient.z];
        Vertex { index, position, t: line.parameter(position), values }
    }

    /// The values of a segment in a cell, with those that are the cell's own.
    fn in_cell(&self, cell: usize, mut values: [Values; 2]) -> [Values; 2] {
        if self.colors.is_some() {
            return values;
        }
        for (axis, scalar) in self.scalars.into_iter().enumerate() {
            if let Some(scalar) = scalar.filter(|s| s.location == Location::Cell) {
                for end in &mut values {
                    end[axis] = scalar.values[cell];
                }
            }
        }
        values
    }
}

/// A boundary face: four times its cell, plus its number in it. Assembling a mesh keeps this within 32 bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct BoundaryFace(u32);

impl BoundaryFace {
    /// Bounding volumes over those of a mesh.
    pub(crate) fn hierarchy(space: &Space) -> Hierarchy<Self> {
        let (cells, around) = (space.mesh.cells(), space.mesh.neighbors());
        let faces = (0..around.len())
            .flat_map(|c| (0..4).filter(move |&f| around[c][f] == NONE).map(move |f| (c, f)))
            .map(|(c, f)| Self((4 * c + f) as u32))
            .collect();
        Hierarchy::new(faces, &|face: &Self| face.vertices(cells).map(|v| space.position(v)))
    }

    fn cell(self) -> u32 {
        self.0 / 4
    }

    /// Vertices, counter-clockwise from outside.
    fn vertices(self, cells: &[[u32; 4]]) -> [u32; 3] {
        FACES[self.0 as usize % 4].map(|i| cells[self.cell() as usize][i])
    }
}

/// A face that the line crosses into the next cell.
struct Crossing {
    vertices: [Vertex; 3],
    /// The line's side of the edges 01, 12 and 20; all positive.
    sides: [f64; 3],
}

impl Crossing {
    /// The boundary face, if the line enters through it.
    fn enter(space: &Space, line: &Line, face: BoundaryFace) -> Option<Self> {
        let v = face.vertices(space.mesh.cells()).map(|index| space.vertex(line, index));
        let mut sides = [0.0; 3];
        for k in 0..3 {
            let side = line.side(&v[k], &v[(k + 1) % 3]);
            if !side.positive {
                return None;
            }
            sides[k] = side.value;
        }
        Some(Self { vertices: v, sides })
    }

    /// Parameter and values where the line crosses: the sides are barycentric coordinates, times a common factor.
    fn place(&self) -> (f64, Values) {
        let [a, b, c] = &self.vertices;
        let [wc, wa, wb] = self.sides;
        let sum = wa + wb + wc;
        // They cannot all be 0: the line would lie in the face's plane, and cross it, after perturbation, at its own
        // origin, which is outside the mesh.
        let per = if sum > 0.0 { 1.0 / sum } else { 0.0 };
        let mix = |x: f64, y: f64, z: f64| (wa * per) * x + (wb * per) * y + (wc * per) * z;
        let values = std::array::from_fn(|k| mix(a.values[k], b.values[k], c.values[k]));
        (mix(a.t, b.t, c.t), values)
    }
}

/// Appends the segments of `line` in the mesh between the parameters `start` and `end`, in ascending order.
///
/// The line's origin must lie outside the mesh's convex hull, the mesh in its direction.
pub(crate) fn segments(
    space: &Space,
    hierarchy: &Hierarchy<BoundaryFace>,
    line: &Line,
    [start, end]: [f64; 2],
    found: &mut Vec<Segment>,
) {
    hierarchy.candidates(line, end, |face| {
        if let Some(entry) = Crossing::enter(space, line, face) {
            walk(space, line, face.cell(), entry, [start, end], found);
        }
    });
    let ascending = |a: &Segment, b: &Segment| a.t[0].total_cmp(&b.t[0]).then(a.t[1].total_cmp(&b.t[1]));
    if !found.is_sorted_by(|a, b| ascending(a, b).is_le()) {
        found.sort_unstable_by(ascending);
    }
}

/// Follows the line from `entry` into `cell` and on until it leaves through a boundary face or passes `end`.
fn walk(
    space: &Space,
    line: &Line,
    mut cell: u32,
    mut face: Crossing,
    [start, end]: [f64; 2],
    found: &mut Vec<Segment>,
) {
    let cells = space.mesh.cells();
    let (mut t, mut values) = face.place();
    // Each cell is crossed at most once; the bound keeps a contradiction from looping for ever.
    for _ in 0..cells.len() {
        if cell == NONE || t >= end {
            return;
        }
        let vertices = cells[cell as usize];
        // The entry face's vertices cancel out of the cell's.
        let apex = face.vertices.iter().fold(vertices.iter().fold(0, |x, v| x ^ v), |x, v| x ^ v.index);
        let apex = space.vertex(line, apex);
        let sides = face.vertices.each_ref().map(|v| line.side(v, &apex));
        let Some(k) = (0..3).find(|&k| !sides[k].positive && sides[(k + 1) % 3].positive) else {
            debug_assert!(false, "the line enters cell {cell} and does not leave it");
            return;
        };
        let [next, behind] = [(k + 1) % 3, (k + 2) % 3];
        let behind = face.vertices[behind].index;
        let exit = (0..4).find(|&i| vertices[i] == behind).unwrap_or(0);
        face = Crossing {
            vertices: [face.vertices[k], face.vertices[next], apex],
            sides: [face.sides[k], sides[next].value, -sides[k].value],
        };
        let (leave, leave_values) = face.place();
        let leave = leave.max(t);
        let values_here = match space.contents[cell as usize] {
            Contents::Nothing => None,
            Contents::Data => Some(space.in_cell(cell as usize, [values, leave_values])),
            Contents::NoData => Some([[f64::NAN; 7]; 2]),
        };
        found.extend(values_here.and_then(|values| clip(Segment { t: [t, leave], values }, [start, end])));
        (t, values) = (leave, leave_values);
        cell = space.mesh.neighbors()[cell as usize][exit];
    }
    debug_assert!(cell == NONE, "the line crosses more cells than there are");
}

/// The part of a segment in an interval; `None` if it has no length.
fn clip(segment: Segment, [start, end]: [f64; 2]) -> Option<Segment> {
    let [from, to] = segment.t;
    let t = [from.max(start), to.min(end)];
    let values = [
        if t[0] == from { segment.values[0] } else { segment.at(t[0]) },
        if t[1] == to { segment.values[1] } else { segment.at(t[1]) },
    ];
    (t[0] < t[1]).then_some(Segment { t, values })
}
