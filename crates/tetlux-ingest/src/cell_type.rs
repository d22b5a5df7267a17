//! VTK's cell types: what they are called, and the faces of those that can be split.

/// VTK's number of a tetrahedron.
pub(crate) const TETRAHEDRON: u8 = 10;
/// VTK's number of a hexahedron.
pub(crate) const HEXAHEDRON: u8 = 12;
/// VTK's number of a wedge.
pub(crate) const WEDGE: u8 = 13;
/// VTK's number of a pyramid.
pub(crate) const PYRAMID: u8 = 14;
/// VTK's number of a quadratic tetrahedron, of ten points.
pub(crate) const QUADRATIC_TETRAHEDRON: u8 = 24;
/// VTK's number of a quadratic hexahedron, of twenty points.
pub(crate) const QUADRATIC_HEXAHEDRON: u8 = 25;
/// VTK's number of a quadratic wedge, of fifteen points.
pub(crate) const QUADRATIC_WEDGE: u8 = 26;
/// VTK's number of a quadratic pyramid, of thirteen points, or here fourteen: the last in the middle of the base.
pub(crate) const QUADRATIC_PYRAMID: u8 = 27;
/// VTK's number of a quadratic hexahedron of 27 points.
pub(crate) const TRIQUADRATIC_HEXAHEDRON: u8 = 29;
/// VTK's number of a quadratic wedge of eighteen points.
pub(crate) const BIQUADRATIC_WEDGE: u8 = 32;
/// VTK's number of a polyhedron.
pub(crate) const POLYHEDRON: u8 = 42;

/// What is known of a cell type.
pub(crate) struct CellType {
    pub(crate) number: u8,
    pub(crate) name: &'static str,
    pub(crate) plural: &'static str,
    /// 0 to 3; only cells of dimension 3 have a volume to render.
    pub(crate) dimension: u8,
    /// Points of each cell (files may list more: mid-side points of a cell that is called linear); `None` where they differ from cell to cell.
    pub(crate) points: Option<usize>,
    /// Corners of each face of a linear convex cell, in order round the face, seen from outside counter-clockwise (a
    /// wedge's: see the splitting); empty if it is none.
    pub(crate) faces: &'static [&'static [usize]],
}

impl CellType {
    /// Of a quadratic cell the type with the same corners and straight edges; of any other itself.
    pub(crate) fn linear(&'static self) -> &'static CellType {
        let number = match self.number {
            QUADRATIC_TETRAHEDRON => TETRAHEDRON,
            QUADRATIC_HEXAHEDRON | TRIQUADRATIC_HEXAHEDRON => HEXAHEDRON,
            QUADRATIC_WEDGE | BIQUADRATIC_WEDGE => WEDGE,
            QUADRATIC_PYRAMID => PYRAMID,
            _ => return self,
        };
        CellType::of(number).unwrap_or(self)
    }

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
    of(WEDGE, "wedge", "wedges", 3, 6, &[&[0, 1, 2], &[3, 5, 4], &[0, 3, 4, 1], &[1, 4, 5, 2], &[2, 5, 3, 0]]),
    of(PYRAMID, "pyramid", "pyramids", 3, 5, &[&[0, 3, 2, 1], &[0, 1, 4], &[1, 2, 4], &[2, 3, 4], &[3, 0, 4]]),
    of(
        15,
        "pentagonal prism",
        "pentagonal prisms",
        3,
        10,
        &[
            &[0, 4, 3, 2, 1],
            &[5, 6, 7, 8, 9],
            &[0, 1, 6, 5],
            &[1, 2, 7, 6],
            &[2, 3, 8, 7],
            &[3, 4, 9, 8],
            &[4, 0, 5, 9],
        ],
    ),
    of(
        16,
        "hexagonal prism",
        "hexagonal prisms",
        3,
        12,
        &[
            &[0, 5, 4, 3, 2, 1],
            &[6, 7, 8, 9, 10, 11],
            &[0, 1, 7, 6],
            &[1, 2, 8, 7],
            &[2, 3, 9, 8],
            &[3, 4, 10, 9],
            &[4, 5, 11, 10],
            &[5, 0, 6, 11],
        ],
    ),
    of(21, "quadratic edge", "quadratic edges", 1, 3, &[]),
    of(22, "quadratic triangle", "quadratic triangles", 2, 6, &[]),
    of(23, "quadratic quadrilateral", "quadratic quadrilaterals", 2, 8, &[]),
    of(QUADRATIC_TETRAHEDRON, "quadratic tetrahedron", "quadratic tetrahedra", 3, 10, &[]),
    of(QUADRATIC_HEXAHEDRON, "quadratic hexahedron", "quadratic hexahedra", 3, 20, &[]),
    of(QUADRATIC_WEDGE, "quadratic wedge", "quadratic wedges", 3, 15, &[]),
    of(QUADRATIC_PYRAMID, "quadratic pyramid", "quadratic pyramids", 3, 13, &[]),
    of(28, "biquadratic quadrilateral", "biquadratic quadrilaterals", 2, 9, &[]),
    of(TRIQUADRATIC_HEXAHEDRON, "triquadratic hexahedron", "triquadratic hexahedra", 3, 27, &[]),
    of(BIQUADRATIC_WEDGE, "biquadratic wedge", "biquadratic wedges", 3, 18, &[]),
    named(POLYHEDRON, "polyhedron", "polyhedra", 3),
    named(71, "Lagrange tetrahedron", "Lagrange tetrahedra", 3),
    named(72, "Lagrange hexahedron", "Lagrange hexahedra", 3),
    named(73, "Lagrange wedge", "Lagrange wedges", 3),
    named(74, "Lagrange pyramid", "Lagrange pyramids", 3),
];
