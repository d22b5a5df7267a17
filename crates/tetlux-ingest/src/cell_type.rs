//! VTK's cell types: what they are called, and the faces of those that can be split.

/// VTK's number of a tetrahedron.
pub(crate) const TETRAHEDRON: u8 = 10;
/// VTK's number of a hexahedron.
pub(crate) const HEXAHEDRON: u8 = 12;

/// What is known of a cell type.
pub(crate) struct CellType {
    pub(crate) number: u8,
    pub(crate) name: &'static str,
    pub(crate) plural: &'static str,
    /// 0 to 3; only cells of dimension 3 have a volume to render.
    pub(crate) dimension: u8,
    /// Points of each cell (files may list more: mid-side points of a cell that is called linear); `None` where they differ from cell to cell.
    pub(crate) points: Option<usize>,
    /// Corners of each face of a linear convex cell, in order round the face; empty if it cannot be split here.
    pub(crate) faces: &'static [&'static [usize]],
}

impl CellType {
    /// The type of a VTK number.
    pub(crate) fn of(number: u8) -> Option<&'static CellType> {
        TYPES.iter().find(|t| t.number == number)
    }
}

const fn named(number: u8, name: &'static str, plural: &'static str, dimension: u8) -> CellType {
    CellType { number, name, plural, dimension, points: None, faces: &[] }
}

const fn of(
    number: u8,
    name: &'static str,
    plural: &'static str,
    dimension: u8,
    points: usize,
    faces: &'static [&'static [usize]],
) -> CellType {
    CellType { number, name, plural, dimension, points: Some(points), faces }
}

/// In the order of their numbers (vtkCellType.h; corners as in the VTK User's Guide, "VTK file formats").
const TYPES: &[CellType] = &[
    named(0, "empty cell", "empty cells", 0),
    of(1, "vertex", "vertices", 0, 1, &[]),
    named(2, "poly-vertex", "poly-vertices", 0),
    of(3, "line", "lines", 1, 2, &[]),
    named(4, "poly-line", "poly-lines", 1),
    of(5, "triangle", "triangles", 2, 3, &[]),
    named(6, "triangle strip", "triangle strips", 2),
    named(7, "polygon", "polygons", 2),
    of(8, "pixel", "pixels", 2, 4, &[]),
    of(9, "quadrilateral", "quadrilaterals", 2, 4, &[]),
    of(TETRAHEDRON, "tetrahedron", "tetrahedra", 3, 4, &[&[1, 2, 3], &[0, 3, 2], &[0, 1, 3], &[0, 2, 1]]),
    of(
        11,
        "voxel",
        "voxels",
        3,
        8,
        &[&[0, 2, 3, 1], &[4, 5, 7, 6], &[0, 1, 5, 4], &[2, 6, 7, 3], &[0, 4, 6, 2], &[1, 3, 7, 5]],
    ),
    of(
        HEXAHEDRON,
        "hexahedron",
        "hexahedra",
        3,
        8,
        &[&[0, 3, 2, 1], &[4, 5, 6, 7], &[0, 1, 5, 4], &[1, 2, 6, 5], &[2, 3, 7, 6], &[3, 0, 4, 7]],
    ),
    of(13, "wedge", "wedges", 3, 6, &[&[0, 1, 2], &[3, 5, 4], &[0, 3, 4, 1], &[1, 4, 5, 2], &[2, 5, 3, 0]]),
    of(14, "pyramid", "pyramids", 3, 5, &[&[0, 3, 2, 1], &[0, 1, 4], &[1, 2, 4], &[2, 3, 4], &[3, 0, 4]]),
    named(15, "pentagonal prism", "pentagonal prisms", 3),
    named(16, "hexagonal prism", "hexagonal prisms", 3),
    of(21, "quadratic edge", "quadratic edges", 1, 3, &[]),
    of(22, "quadratic triangle", "quadratic triangles", 2, 6, &[]),
    of(23, "quadratic quadrilateral", "quadratic quadrilaterals", 2, 8, &[]),
    of(24, "quadratic tetrahedron", "quadratic tetrahedra", 3, 10, &[]),
    of(25, "quadratic hexahedron", "quadratic hexahedra", 3, 20, &[]),
    of(26, "quadratic wedge", "quadratic wedges", 3, 15, &[]),
    of(27, "quadratic pyramid", "quadratic pyramids", 3, 13, &[]),
    of(28, "biquadratic quadrilateral", "biquadratic quadrilaterals", 2, 9, &[]),
    of(29, "triquadratic hexahedron", "triquadratic hexahedra", 3, 27, &[]),
    named(42, "polyhedron", "polyhedra", 3),
];
