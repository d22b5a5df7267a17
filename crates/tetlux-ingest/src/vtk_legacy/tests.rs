use glam::DVec3;
use proptest::prelude::*;
use tetlux_mesh::procedural::Split;
use tetlux_mesh::{Field, Location};

use super::read;
use crate::damage::mutation::{HOSTILE, replace_number};
use crate::damage::{config, damages};
use crate::source::Source;
use crate::{IngestError, MixedCells, MixedMesh};

/// Writes files in one of the encodings.
struct Writer {
    binary: bool,
    bytes: Vec<u8>,
}

impl Writer {
    fn new(version: &str, binary: bool, dataset: &str) -> Self {
        let encoding = if binary { "BINARY" } else { "ASCII" };
        let text = format!("# vtk DataFile Version {version}\na title\n{encoding}\nDATASET {dataset}\n");
        Writer { binary, bytes: text.into_bytes() }
    }

    fn text(&mut self, text: &str) -> &mut Self {
        self.bytes.extend(text.bytes());
        self
    }

    /// Values after their heading, which ends its line.
    fn values(&mut self, kind: &str, values: &[f64]) -> &mut Self {
        if !self.binary {
            let words: Vec<String> = values.iter().map(f64::to_string).collect();
            return self.text(&words.join(" ")).text("\n");
        }
        macro_rules! bytes {
            ($($name:literal $t:ty),*) => {
                match kind {
                    $($name => values.iter().for_each(|&v| self.bytes.extend((v as $t).to_be_bytes())),)*
                    "bit" => values.chunks(8).for_each(|c| {
                        self.bytes.push(c.iter().enumerate().map(|(i, &v)| (v as u8) << (7 - i)).sum());
                    }),
                    _ => panic!("no type {kind}"),
                }
            };
        }
        bytes!("char" i8, "unsigned_char" u8, "short" i16, "unsigned_short" u16, "int" i32, "unsigned_int" u32,
               "vtkIdType" i32, "long" i64, "vtktypeint64" i64, "unsigned_long" u64, "vtktypeuint64" u64, "float" f32,
               "double" f64);
        self.text("\n")
    }

    fn array(&mut self, heading: &str, kind: &str, values: &[f64]) -> &mut Self {
        self.text(heading).text("\n").values(kind, values)
    }

    fn unstructured(version: &str, binary: bool, mesh: &MixedMesh) -> Writer {
        let mut w = Writer::new(version, binary, "UNSTRUCTURED_GRID");
        let points: Vec<f64> = mesh.points.iter().flat_map(|p| p.to_array()).collect();
        w.array(&format!("POINTS {} double", mesh.points.len()), "double", &points);
        let cells = &mesh.cells;
        let lists: Vec<Vec<f64>> = (0..cells.types.len())
            .map(|c| match cells.faces(c) {
                Some(faces) => std::iter::once(faces.len() as f64)
                    .chain(
                        faces.iter().flat_map(|f| [f.len() as u32].into_iter().chain(f.iter().copied())).map(f64::from),
                    )
                    .collect(),
                None => cells.cell(c).unwrap().iter().map(|&v| f64::from(v)).collect(),
            })
            .collect();
        let size: usize = lists.iter().map(Vec::len).sum();
        if version.starts_with('5') {
            let mut offsets = vec![0.0];
            lists.iter().for_each(|l| offsets.push(offsets[offsets.len() - 1] + l.len() as f64));
            w.text(&format!("CELLS {} {size}\n", offsets.len()));
            w.array("OFFSETS vtktypeint64", "vtktypeint64", &offsets);
            w.array("CONNECTIVITY vtktypeint64", "vtktypeint64", &lists.concat());
        } else {
            let all: Vec<f64> = lists.iter().flat_map(|l| [&[l.len() as f64], l.as_slice()].concat()).collect();
            w.array(&format!("CELLS {} {}", lists.len(), all.len()), "int", &all);
        }
        let types: Vec<f64> = cells.types.iter().map(|&t| f64::from(t)).collect();
        w.array(&format!("CELL_TYPES {}", types.len()), "int", &types);
        w
    }

    fn read(&self) -> Result<MixedMesh, IngestError> {
        read_bytes(&self.bytes)
    }
}

fn read_bytes(bytes: &[u8]) -> Result<MixedMesh, IngestError> {
    let mesh = read(Source { path: "a.vtk".into(), bytes: bytes.to_vec() })?;
    mesh.check()?;
    Ok(mesh)
}

/// A cube with a pyramid on it, then a cell of every kind that is linear, each on its own points.
fn zoo() -> MixedMesh {
    let corners = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]];
    let cube: Vec<DVec3> = corners.iter().map(|c| DVec3::from(c.map(f64::from))).collect();
    let mut mesh = MixedMesh { points: cube.clone(), ..MixedMesh::default() };
    mesh.points.push(DVec3::new(0.5, 0.5, 2.0));
    mesh.cells.push(14, &[4, 5, 6, 7, 8]);
    let faces: [&[u32]; 6] = [&[0, 3, 2, 1], &[4, 5, 6, 7], &[0, 1, 5, 4], &[1, 2, 6, 5], &[2, 3, 7, 6], &[3, 0, 4, 7]];
    mesh.cells.push_polyhedron(&[0, 3, 2, 1, 4, 5, 6, 7], &faces);
    for (i, (kind, which)) in [
        (10, &[0u32, 1, 3, 4][..]),
        (11, &[0, 1, 3, 2, 4, 5, 7, 6]),
        (12, &[0, 1, 2, 3, 4, 5, 6, 7]),
        (13, &[0, 3, 1, 4, 7, 5]),
    ]
    .into_iter()
    .enumerate()
    {
        let first = mesh.points.len() as u32;
        mesh.points.extend(cube.iter().map(|&p| p + DVec3::X * (3 * (i + 1)) as f64));
        mesh.cells.push(kind, &which.iter().map(|v| v + first).collect::<Vec<u32>>());
    }
    mesh
}

#[test]
fn cells_of_all_kinds_are_read_in_both_layouts_and_encodings() {
    let mesh = zoo();
    for version in ["1.0", "2.0", "3.0", "4.2", "5.0", "5.1"] {
        for binary in [false, true] {
            let found = Writer::unstructured(version, binary, &mesh).read().unwrap();
            assert_eq!((&found.points, &found.cells), (&mesh.points, &mesh.cells), "{version} {binary}");
            assert_eq!(found.notes, [""; 0]);
            // Pyramid 1/3, polyhedron, voxel and hexahedron 1, tetrahedron 1/6, wedge 1/2.
            let volume = found.tetrahedralize(Split::default()).unwrap().validate().volume;
            assert!((volume - 4.0).abs() < 1e-14, "{volume}");
        }
    }
}

#[test]
fn attributes_of_all_kinds_and_types_are_read() {
    let mut mesh = zoo();
    mesh.points.truncate(9);
    mesh.cells = MixedCells::default();
    mesh.cells.push(10, &[0, 1, 3, 4]);
    mesh.cells.push(14, &[4, 5, 6, 7, 8]);
    let n = 9;
    let values = |count: usize| -> Vec<f64> { (0..count).map(|i| (i % 100) as f64).collect() };
    for binary in [false, true] {
        let mut w = Writer::unstructured("4.2", binary, &mesh);
        let mut expected = Vec::new();
        w.text("CELL_DATA 2\n");
        w.text("SCALARS c%20%25d float\nLOOKUP_TABLE default\n").values("float", &[7.0, -8.5]);
        expected.push(Field::cell("c %d", 1, vec![7.0, -8.5]));
        w.text(&format!("METADATA\nCOMPONENT_NAMES\nX\nSCALARS\n\n\nPOINT_DATA {n}\n"));
        w.text("SCALARS table double 2\nLOOKUP_TABLE mine\n").values("double", &values(2 * n));
        expected.push(Field::point("table", 2, values(2 * n)));
        let colors: Vec<f64> = (0..8).map(f64::from).collect();
        w.text("LOOKUP_TABLE mine 2\n").values("unsigned_char", &colors);
        for (keyword, components) in
            [("VECTORS", 3), ("NORMALS", 3), ("TENSORS", 9), ("TENSORS6", 6), ("GLOBAL_IDS", 1), ("PEDIGREE_IDS", 1)]
        {
            w.text(&format!("{keyword} {keyword} int\n")).values("int", &values(n * components));
            expected.push(Field::point(keyword, components, values(n * components)));
        }
        w.text("TEXTURE_COORDINATES texture 2 float\n").values("float", &values(2 * n));
        expected.push(Field::point("texture", 2, values(2 * n)));
        let bytes: Vec<f64> = (0..4 * n).map(|i| (7 * i) as f64).collect();
        let fractions: Vec<f64> = bytes.iter().map(|b| b / 255.0).collect();
        w.text("COLOR_SCALARS color 4\n").values("unsigned_char", if binary { &bytes } else { &fractions });
        expected.push(Field::point("color", 4, bytes));
        let kinds = [
            "char",
            "unsigned_char",
            "short",
            "unsigned_short",
            "int",
            "unsigned_int",
            "vtkIdType",
            "long",
            "vtktypeint64",
            "unsigned_long",
            "vtktypeuint64",
            "float",
            "double",
        ];
        w.text(&format!("FIELD FieldData {}\n", kinds.len() + 3));
        for kind in kinds {
            w.text(&format!("{kind} 2 {n} {kind}\n")).values(kind, &values(2 * n));
            expected.push(Field::point(kind, 2, values(2 * n)));
        }
        let bits: Vec<f64> = (0..n).map(|i| f64::from(i % 3 == 0)).collect();
        w.text(&format!("METADATA\nINFORMATION 0\n\nNULL_ARRAY\nbits 1 {n} bit\n")).values("bit", &bits);
        expected.push(Field::point("bits", 1, bits));
        w.text("short 1 1 int\n").values("int", &[1.0]);
        w.text("# a comment\n\nEDGE_FLAGS edges int\n").values("int", &values(n));
        expected.push(Field::point("edges", 1, values(n)));
        let found = w.read().unwrap();
        assert_eq!(found.fields, expected, "{binary}");
        assert_eq!(found.notes, ["field \"short\" has 1 tuples for 9 points: it is left out"]);
    }
}

#[test]
fn text_and_data_of_the_whole_file_are_passed_over_with_a_note() {
    let text = "# vtk DataFile Version 3.0\r\n\r\nascii\r\ndataset unstructured_grid\r\nfield FieldData 1\r\n\
                TIME 1 1 double\r\n0.5\r\npoints 4 float\r\n0 0 0 1 0 0 0 1 0 0 0 1\r\ncells 1 5\r\n4 0 1 2 3\r\n\
                cell_types 1\r\n10\r\npoint_data 4\r\nfield FieldData 3\r\nnames 1 4 string\r\na\r\n\r\nb c\r\n1 2\r\n\
                any 1 2 variant\r\n0 \r\n13 a%20b\r\nx 1 4 float\r\n1 2 3 4\r\n";
    let mesh = read_bytes(text.as_bytes()).unwrap();
    assert_eq!(mesh.fields, [Field::point("x", 1, vec![1.0, 2.0, 3.0, 4.0])]);
    assert_eq!(mesh.notes.len(), 3, "{:?}", mesh.notes);
    for (note, part) in mesh.notes.iter().zip(["\"TIME\"", "\"names\" holds no numbers", "\"any\" holds no numbers"]) {
        assert!(note.contains(part), "{note}");
    }
}

fn grids(binary: bool) -> [Writer; 3] {
    let mut points = Writer::new("3.0", binary, "STRUCTURED_POINTS");
    points.text("DIMENSIONS 3 2 2\nASPECT_RATIO 0.5 1 2\nORIGIN 1 2 3\n");
    let mut rectilinear = Writer::new("3.0", binary, "RECTILINEAR_GRID");
    rectilinear.text("DIMENSIONS 3 2 2\n");
    rectilinear.array("X_COORDINATES 3 float", "float", &[1.0, 1.5, 2.0]);
    rectilinear.array("Y_COORDINATES 2 double", "double", &[2.0, 3.0]);
    rectilinear.array("Z_COORDINATES 2 int", "int", &[3.0, 5.0]);
    let mut structured = Writer::new("3.0", binary, "STRUCTURED_GRID");
    structured.text("EXTENT 4 6 0 1 0 1\n");
    structured.array("POINTS 12 float", "float", &expected().iter().flat_map(|p| p.to_array()).collect::<Vec<_>>());
    [points, rectilinear, structured]
}

fn expected() -> Vec<DVec3> {
    let place = |p: usize| DVec3::new(1.0 + 0.5 * (p % 3) as f64, 2.0 + (p / 3 % 2) as f64, 3.0 + 2.0 * (p / 6) as f64);
    (0..12).map(place).collect()
}

#[test]
fn grids_of_all_three_kinds_are_read() {
    for binary in [false, true] {
        for mut w in grids(binary) {
            w.text("CELL_DATA 2\nSCALARS c int\nLOOKUP_TABLE default\n").values("int", &[3.0, 4.0]);
            w.text("POINT_DATA 12\nSCALARS p short\n").values("short", &(0..12).map(f64::from).collect::<Vec<_>>());
            let mesh = w.read().unwrap();
            assert_eq!(mesh.points, expected());
            assert_eq!(mesh.cell_counts(), [("hexahedra", 2)]);
            assert_eq!(mesh.fields[0], Field::cell("c", 1, vec![3.0, 4.0]));
            assert_eq!(mesh.fields[1].values[11], 11.0);
            let report = mesh.tetrahedralize(Split::Six).unwrap().validate();
            assert_eq!((report.cells, report.volume), (12, 2.0));
        }
    }
}

#[test]
fn blanked_points_take_their_cells_with_them() {
    let visible: Vec<f64> = (0..12).map(|p| f64::from(p != 0)).collect();
    let ghosts: Vec<f64> = (0..12).map(|p| if p == 0 { 2.0 } else { 1.0 }).collect();
    let [_, _, blanking] = grids(true);
    let mut blanking = blanking;
    blanking.array("BLANKING 12 int", "int", &visible);
    let [mut flagged, ..] = grids(true);
    flagged
        .text("POINT_DATA 12\nFIELD FieldData 1\nvtkGhostType 1 12 unsigned_char\n")
        .values("unsigned_char", &ghosts);
    flagged
        .text("CELL_DATA 2\nFIELD FieldData 1\nvtkGhostType 1 2 unsigned_char\n")
        .values("unsigned_char", &[0.0, 32.0]);
    for (w, notes) in [(blanking, 1), (flagged, 2)] {
        let mesh = w.read().unwrap();
        assert_eq!((mesh.cell_counts(), mesh.notes.len()), (vec![("hexahedra", 1)], notes));
        assert!(mesh.notes[0].starts_with("1 hexahedra have a blanked corner"), "{:?}", mesh.notes);
        assert_eq!(mesh.tetrahedralize(Split::Six).unwrap().validate().volume, 1.0);
    }
}

#[test]
fn what_is_wrong_is_told_with_its_place() {
    let start = "# vtk DataFile Version 3.0\nt\nASCII\nDATASET ";
    let ug = "UNSTRUCTURED_GRID\nPOINTS 4 float\n0 0 0 1 0 0 0 1 0 0 0 1\n";
    for (text, parts) in [
        ("POLYDATA\n".to_string(), &["POLYDATA", "surface, which has no volume"][..]),
        ("TABLE\n".into(), &["TABLE", "UNSTRUCTURED_GRID"]),
        (format!("{ug}CELLS 1 5\n4 0 1 2 4\nCELL_TYPES 1\n10\n"), &["cell 0", "found 4", "0 and 3"]),
        (format!("{ug}CELLS 1 5\n4 0 1 2 -1\nCELL_TYPES 1\n10\n"), &["cell 0", "found -1"]),
        (format!("{ug}CELLS 1 5\n5 0 1 2 3\nCELL_TYPES 1\n10\n"), &["cell 0", "found 5"]),
        (format!("{ug}CELLS 2 5\n4 0 1 2 3\nCELL_TYPES 1\n10\n"), &["found 1", "2 by their heading"]),
        (format!("{ug}CELLS 1 5\n4 0 1 2 3\nCELL_TYPES 2\n10 10\n"), &["types of 1 cells", "found 2"]),
        (format!("{ug}CELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n256\n"), &["cell 0", "256"]),
        (format!("{ug}CELLS 1 5\n4 0 1 2 3\n"), &["CELL_TYPES"]),
        (format!("{ug}CELL_TYPES 1\n10\n"), &["CELLS"]),
        (format!("{ug}CELLS 1 5\n4 1 3 0 9\nCELL_TYPES 1\n42\n"), &["cell 0", "polyhedron"]),
        (
            format!("{ug}CELLS 2 4\nOFFSETS vtktypeint64\n0 5\nCONNECTIVITY int\n0 1 2 3\nCELL_TYPES 1\n10\n"),
            &["cell 0", "0 to 5"],
        ),
        (format!("{ug}CELLS 2 4\nOFFSETS float\n0 4\n"), &["whole numbers"]),
        (format!("{ug}POINT_DATA 5\n"), &["POINT_DATA", "found 5", "4"]),
        (format!("{ug}POINT_DATA 4\nSCALARS a quad\n"), &["quad"]),
        (format!("{ug}POINT_DATA 4\nSCALARS a float\nLOOKUP_TABLE default\n1 2 x 4\n"), &["found x", "array \"a\""]),
        (format!("{ug}POINT_DATA 4\nSPLINES a float\n"), &["SPLINES"]),
        (format!("{ug}NONSENSE\n"), &["NONSENSE", "byte"]),
        ("UNSTRUCTURED_GRID\nPOINTS 9999999999999 float\n1".into(), &["needs", "bytes"]),
        ("UNSTRUCTURED_GRID\nPOINTS 1 float\nnan 0 0\n".into(), &["point 0", "NaN"]),
        ("STRUCTURED_POINTS\nDIMENSIONS 9 9 1\n".into(), &["9 x 9 x 1", "no volume"]),
        ("STRUCTURED_POINTS\nDIMENSIONS 1000 1000 1000\n".into(), &["1000 x 1000 x 1000", "no data"]),
        ("STRUCTURED_POINTS\nDIMENSIONS 4294967296 4294967296 4294967296\n".into(), &["32 bits"]),
        ("STRUCTURED_POINTS\nORIGIN 0 0 0\n".into(), &["DIMENSIONS"]),
        ("RECTILINEAR_GRID\nDIMENSIONS 2 2 2\nX_COORDINATES 2 int\n0 1\n".into(), &["Y_COORDINATES", "0 numbers"]),
        ("STRUCTURED_GRID\nDIMENSIONS 2 2 2\nPOINTS 1 int\n0 1 2\n".into(), &["POINTS", "found 1", "8"]),
    ] {
        let error = read_bytes(format!("{start}{text}").as_bytes()).expect_err(&text).to_string();
        assert!(parts.iter().chain(&["a.vtk"]).all(|part| error.contains(part)), "{text}: {error}");
    }
    for (text, part) in [
        ("# vtk DataFile Version 3.0\nt\nHEX\n", "ASCII or BINARY"),
        ("# vtk DataFile Version 3.0\nt\nASCII\nPOINTS 3 float\n", "POINTS"),
        ("# vtk DataFile Version 3.0\nt\nASCII\nFIELD a 0\n", "FIELD"),
        ("something else\n", "vtk DataFile"),
    ] {
        let error = read_bytes(text.as_bytes()).unwrap_err().to_string();
        assert!(error.contains(part), "{error}");
    }
}

/// Cut anywhere a file is an error, or if it is cut between two sections a mesh with fewer fields.
#[test]
fn truncation_at_any_place_is_told() {
    for (version, binary) in [("4.2", false), ("4.2", true), ("5.1", false), ("5.1", true)] {
        let mut w = Writer::unstructured(version, binary, &zoo());
        let cells = w.bytes.len();
        w.text("POINT_DATA 41\nVECTORS v double\n").values("double", &[1.5; 3 * 41]);
        for length in 0..w.bytes.len() {
            if let Ok(mesh) = read_bytes(&w.bytes[..length]) {
                assert!(mesh.cells.types.is_empty() || mesh.cells.types.len() == 6);
                // Of a number in words the last digits may be missing, of the last line its end.
                assert!(mesh.fields.is_empty() || length + 3 >= w.bytes.len(), "{length}");
                assert!(mesh.cells.types.is_empty() || length + 2 >= cells, "{length}");
            }
        }
    }
}

#[test]
fn the_notched_plate_is_read() {
    let path = std::path::Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/data/notch_stress.vtk"));
    if !path.exists() {
        println!("the data set notch_stress.vtk is absent: not tested");
        return;
    }
    let mesh = crate::read(path, &crate::ReadOptions::default()).unwrap();
    assert_eq!((mesh.points.len(), mesh.cell_counts()), (12_717, vec![("hexahedra", 2_188), ("wedges", 4)]));
    let field = |name: &str| mesh.fields.iter().find(|f| f.name == name).unwrap();
    let stress = field("Nodal Stress");
    assert_eq!((stress.components, stress.location), (6, Location::Point));
    assert!(stress.values.iter().all(|v| v.is_finite()));
    // Of the points 9180 are mid-side points that no corner of a cell uses: only there the norm is missing.
    let norm = field("Nodal Stress-normed");
    let mut used = vec![false; mesh.points.len()];
    for c in 0..mesh.cells.types.len() {
        let corners = if mesh.cells.types[c] == 12 { 8 } else { 6 };
        mesh.cells.cell(c).unwrap()[..corners].iter().for_each(|&v| used[v as usize] = true);
    }
    assert_eq!(norm.values.iter().filter(|v| v.is_nan()).count(), 9_180);
    assert!(norm.values.iter().zip(&used).all(|(v, used)| v.is_nan() != *used));
    assert!(mesh.tetrahedralize(Split::Six).unwrap().validate().volume > 0.0);
}

proptest! {
    #![proptest_config(config())]

    #[test]
    fn damaged_files_do_not_panic(
        which in 0usize..7, binary: bool, n in 0usize..80, text in prop::sample::select(&HOSTILE[..]), damages in damages(),
    ) {
        let mut bytes = match which {
            0..3 => grids(binary)[which].bytes.clone(),
            _ => {
                let mut w = Writer::unstructured(if which < 5 { "4.2" } else { "5.1" }, binary, &zoo());
                w.text("CELL_DATA 6\nFIELD f 2\na 1 6 int\n").values("int", &[2.0; 6]);
                w.text("b 3 6 bit\n").values("bit", &[1.0; 18]).bytes.clone()
            }
        };
        replace_number(&mut bytes, n, text);
        damages.iter().skip(usize::from(n < 40)).for_each(|d| d.apply(&mut bytes));
        match read_bytes(&bytes) {
            Ok(mesh) => drop(mesh.tetrahedralize(Split::Six)),
            Err(error) => prop_assert!(error.to_string().len() < 1000, "{}", error),
        }
    }
}
