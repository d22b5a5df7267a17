//! VTK XML unstructured grids.

use glam::DVec3;
use tetlux_ingest::{IngestError, MixedMesh, Place, ReadOptions, Split, read};
use tetlux_mesh::procedural::{Parts, cuboid};
use tetlux_mesh::{Field, TetMesh};

use crate::assert_volume;
use crate::writers::{Encoding, Folder, Layout, base64, deflate, two_hexahedra, vtu, vtu_of_pieces};

/// A box of tetrahedra; positions and data are exact in single precision.
fn box_of_tetrahedra() -> (Parts, MixedMesh) {
    let parts = cuboid([3, 2, 4], Split::Six, [DVec3::new(-1.5, 0.0, 2.0), DVec3::new(1.5, 1.0, 4.0)]);
    let mut mesh = MixedMesh { points: parts.points.clone(), ..MixedMesh::default() };
    mesh.cells.types = vec![10; parts.cells.len()];
    mesh.cells.connectivity = parts.cells.concat();
    mesh.cells.offsets = (1..=parts.cells.len()).map(|c| 4 * c).collect();
    mesh.fields = vec![
        Field::point("ramp", 1, parts.sample(|p| p.x + 2.0 * p.y - 0.25 * p.z)),
        Field::point("position", 3, parts.points.iter().flat_map(|p| p.to_array()).collect()),
        Field::cell("number", 1, (0..parts.cells.len()).map(|c| c as f64 - 7.5).collect()),
    ];
    (parts, mesh)
}

fn read_bytes(bytes: &[u8]) -> Result<MixedMesh, IngestError> {
    let folder = Folder::new();
    read(&folder.write("a.vtu", bytes), &ReadOptions::default())
}

/// Reads a file after one replacement of text in it.
fn read_changed(mesh: &MixedMesh, encoding: Encoding, from: &str, to: &str) -> Result<MixedMesh, IngestError> {
    let bytes = vtu(mesh, encoding);
    let at = bytes.windows(from.len()).position(|w| w == from.as_bytes()).expect(from);
    read_bytes(&[&bytes[..at], to.as_bytes(), &bytes[at + from.len()..]].concat())
}

fn assert_same(read: &MixedMesh, written: &MixedMesh, what: &str) {
    assert_eq!(read.points, written.points, "{what}");
    assert_eq!(read.cells, written.cells, "{what}");
    assert_eq!(read.fields, written.fields, "{what}");
}

const ASCII: Encoding = Encoding {
    layout: Layout::Ascii,
    compressed: false,
    wide: false,
    big: false,
    real: "Float64",
    whole: "Int64",
    block: 40,
};

#[test]
fn every_encoding_gives_back_the_mesh_and_its_fields() {
    let (parts, written) = box_of_tetrahedra();
    let expected = TetMesh::assemble(&parts.points, &parts.cells, written.fields.clone()).unwrap();
    for encoding in Encoding::all() {
        for real in ["Float32", "Float64"] {
            let encoding = Encoding { real, ..encoding };
            let what = format!("{encoding:?}");
            let read = read_bytes(&vtu(&written, encoding)).expect(&what);
            assert_same(&read, &written, &what);
            let mesh = read.tetrahedralize(Split::Six).unwrap();
            assert_eq!((mesh.points(), mesh.cells()), (expected.points(), expected.cells()), "{what}");
            assert_eq!(mesh.fields(), expected.fields(), "{what}");
        }
    }
}

#[test]
fn a_changed_value_does_not_pass_for_the_same() {
    let (_, written) = box_of_tetrahedra();
    let mut other = written.clone();
    other.fields[2].values[3] += 0.5;
    let read = read_bytes(&vtu(&other, Encoding::default())).unwrap();
    assert_eq!(read.points, written.points);
    assert_ne!(read.fields, written.fields);
}

#[test]
fn every_number_type_is_read() {
    let whole = ["Int8", "UInt8", "Int16", "UInt16", "Int32", "UInt32", "Int64", "UInt64"];
    let mut written = two_hexahedra();
    written.fields[1].values = vec![7.0, 8.0];
    for encoding in Encoding::all() {
        for kind in whole {
            // The real arrays too: positions and data here are small whole numbers.
            let encoding = Encoding { real: kind, whole: kind, ..encoding };
            assert_same(&read_bytes(&vtu(&written, encoding)).unwrap(), &written, &format!("{encoding:?}"));
        }
    }
}

#[test]
fn pieces_are_joined_and_fields_of_one_alone_are_missing_on_the_others() {
    let mut second = two_hexahedra();
    second.points.iter_mut().for_each(|p| p.x += 1.0);
    second.fields.push(Field::point("alone", 1, vec![0.0; 12]));
    let read = read_bytes(&vtu_of_pieces(&[&two_hexahedra(), &MixedMesh::default(), &second], ASCII)).unwrap();
    assert_eq!(
        read.fields.iter().map(|f| f.name.as_str()).collect::<Vec<_>>(),
        ["position & <more>", "number", "alone"]
    );
    // Missing on the 12 points of the first piece.
    assert_eq!(read.fields[2].values.iter().filter(|v| v.is_nan()).count(), 12);
    assert_eq!(read.fields[1].values, [7.0, -8.5, 7.0, -8.5]);
    assert!(read.notes.len() == 1 && read.notes[0].contains("alone"), "{:?}", read.notes);
    assert_eq!(read.cells.cell(3), Some([16, 17, 18, 19, 20, 21, 22, 23].as_slice()));
    let report = read.tetrahedralize(Split::Six).unwrap().validate();
    assert_eq!((report.cells, report.assembly.points_merged), (24, 6));
    assert_volume(report.volume, 4.0);
    // 2 x 2 x 1 boundary: 16 squares of two triangles, if the four cubes fit together.
    assert_eq!((report.boundary_faces, report.quads_split_both_ways), (32, 0));
}

#[test]
fn surfaces_are_left_out_with_a_note_and_other_cells_named() {
    let mut mesh = two_hexahedra();
    mesh.cells.types.push(9);
    mesh.cells.connectivity.extend([0, 1, 2, 3]);
    mesh.cells.offsets.push(20);
    mesh.fields[1].values.push(0.0);
    let read = read_bytes(&vtu(&mesh, ASCII)).unwrap();
    assert_eq!(read.cell_counts(), [("quadrilaterals", 1), ("hexahedra", 2)]);
    assert!(read.notes[0].contains("without volume: 1,"), "{:?}", read.notes);
    assert_eq!(read.tetrahedralize(Split::Six).unwrap().cells().len(), 12);

    mesh.cells.types[2] = 71;
    match read_bytes(&vtu(&mesh, ASCII)).unwrap().tetrahedralize(Split::Six).unwrap_err() {
        IngestError::Unsupported { place, found, .. } => {
            assert_eq!((place, found.as_str()), (Place::Cell(2), "71 (Lagrange tetrahedron)"))
        }
        error => panic!("{error}"),
    }
}

/// Some writers call quadratic cells linear and list their mid-side points after the corners.
#[test]
fn points_beyond_those_of_a_type_are_passed_over_with_a_note() {
    let mut mesh = two_hexahedra();
    mesh.cells.connectivity.extend([0, 1, 2]);
    mesh.cells.offsets[1] += 3;
    let read = read_bytes(&vtu(&mesh, ASCII)).unwrap();
    assert!(read.notes.len() == 1 && read.notes[0].contains("their type has: 1,"), "{:?}", read.notes);
    let [long, plain] = [read, two_hexahedra()].map(|mesh| mesh.tetrahedralize(Split::Six).unwrap());
    assert_eq!(long.cells(), plain.cells());
}

#[test]
fn every_truncation_is_an_error() {
    let folder = Folder::new();
    let path = folder.path().join("a.vtu");
    for encoding in Encoding::all().into_iter().filter(|e| !e.wide && !e.big) {
        let bytes = vtu(&two_hexahedra(), encoding);
        let end = bytes.windows(9).rposition(|w| w == b"</Append" || w.starts_with(b"</VTKFile")).unwrap();
        let appended = bytes.windows(14).rposition(|w| w == b"</AppendedData");
        // Every third length, for time: no tag or attribute is shorter.
        for length in (1..appended.map_or(end, |at| at + 14)).step_by(3) {
            std::fs::write(&path, &bytes[..length]).unwrap();
            let error = read(&path, &ReadOptions::default()).expect_err("truncated");
            assert!(error.to_string().contains("a.vtu"), "{length}: {error}");
        }
    }
}

#[test]
fn what_is_wrong_is_named() {
    let mesh = two_hexahedra();
    let raw = Encoding { compressed: false, ..Encoding::default() };
    let points_12 = "NumberOfPoints=\"12\"";
    // Encoding, text, its replacement, what the message must say.
    let cases: &[(Encoding, &str, &str, &[&str])] = &[
        (raw, "UnstructuredGrid\"", "HyperTreeGrid\"", &["HyperTreeGrid", "unstructured"]),
        (raw, "<VTKFile", "<VTKFilm", &["VTKFilm"]),
        (raw, "LittleEndian", "MiddleEndian", &["MiddleEndian"]),
        (raw, "UInt32\"", "UInt16\"", &["UInt16"]),
        (Encoding::default(), "vtkZLibDataCompressor", "vtkSnappyCompressor", &["vtkSnappyCompressor", "ZLib"]),
        (raw, points_12, "NumberOfPoints=\"-12\"", &["NumberOfPoints", "-12"]),
        (raw, points_12, "", &["NumberOfPoints", "nothing"]),
        (raw, points_12, "NumberOfPoints=\"13\"", &["Points", "312 bytes", "288 bytes"]),
        (raw, points_12, "NumberOfPoints=\"18446744073709551615\"", &["18446744073709551615"]),
        (raw, points_12, "NumberOfPoints=\"4294967295\"", &["bytes"]),
        (Encoding::default(), points_12, "NumberOfPoints=\"4000000000\"", &["288 bytes"]),
        (ASCII, points_12, "NumberOfPoints=\"4294967295\"", &["36"]),
        (raw, "NumberOfCells=\"2\"", "NumberOfCells=\"9999999999999999999\"", &["bytes"]),
        (raw, "NumberOfComponents=\"3\"", "NumberOfComponents=\"0\"", &["NumberOfComponents"]),
        (raw, "NumberOfComponents=\"3\"", "NumberOfComponents=\"9223372036854775807\"", &["9223372036854775807"]),
        (raw, "offset=\"0\"", "offset=\"99999999\"", &["position & <more>", "cut short"]),
        (raw, "offset=\"0\"", "offset=\"18446744073709551615\"", &["cut short"]),
        (raw, "offset=\"0\"", "", &["offset"]),
        (raw, "Float64", "Bit", &["Bit", "Float64"]),
        (raw, "encoding=\"raw\"", "encoding=\"hex\"", &["hex", "base64"]),
        (raw, "   _", "   ", &["underscore"]),
        (raw, "Name=\"connectivity\"", "Name=\"conn\"", &["\"connectivity\""]),
        (raw, "Name=\"offsets\"", "Name=\"off\"", &["\"offsets\""]),
        (raw, "Name=\"types\"", "Name=\"kinds\"", &["\"types\""]),
        (raw, "<Points>", "<Punkte>", &["XML"]),
        (ASCII, "format=\"ascii\"", "format=\"appended\" offset=\"0\"", &["AppendedData"]),
        (ASCII, "0 1 2 3 4 5 6 7", "0 1 2 3 4 5 6 12", &["cell 0", "12"]),
        (ASCII, "0 1 2 3 4 5 6 7", "0 1 2 3 4 5 6 -7", &["cell 0", "-7"]),
        (ASCII, "0 1 2 3 4 5 6 7", "0 1 2 3 4 5 6 7 8", &["connectivity", "16"]),
        (ASCII, "0 1 2 3 4 5 6 7", "0 1 2 3 4 5 6", &["connectivity", "15"]),
        (ASCII, "8 16", "16 8", &["cell 1", "decrease"]),
        (ASCII, "8 16", "-8 16", &["cell 0", "-8"]),
        (ASCII, "8 16", "7 16", &["cell 0", "7"]),
        (ASCII, "8 16", "8 9223372036854775807", &["connectivity"]),
        (ASCII, "12 12", "12 256", &["cell 1", "256"]),
        (
            ASCII,
            "Name=\"Points\" NumberOfComponents=\"3\" format=\"ascii\">\n0",
            "Name=\"Points\" NumberOfComponents=\"3\" format=\"ascii\">\nnan",
            &["point 0", "NaN"],
        ),
        (ASCII, "7 -8.5", "7 x8.5", &["number", "x8.5"]),
    ];
    for (encoding, from, to, parts) in cases {
        let error = read_changed(&mesh, *encoding, from, to).expect_err(to).to_string();
        for part in parts.iter().chain(&["a.vtu"]) {
            assert!(error.contains(part), "{to}: {error}");
        }
    }
    assert!(read_changed(&mesh, raw, "LittleEndian", "LittleEndian").is_ok());
}

#[test]
fn a_solution_belongs_to_no_vtu_file() {
    let folder = Folder::new();
    let path = folder.write("a.vtu", &vtu(&two_hexahedra(), ASCII));
    let error = read(&path, &ReadOptions { solution: Some(path.clone()), ..ReadOptions::default() }).unwrap_err();
    assert!(error.to_string().contains("solution"), "{error}");
}

/// A file whose first array is this base64 text, compressed.
fn with_array(points: u64, array: &str) -> Vec<u8> {
    format!(
        "<VTKFile type=\"UnstructuredGrid\" compressor=\"vtkZLibDataCompressor\"><UnstructuredGrid>\
         <Piece NumberOfPoints=\"{points}\" NumberOfCells=\"0\"><Points>\
         <DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"binary\">{array}</DataArray>\
         </Points></Piece></UnstructuredGrid></VTKFile>"
    )
    .into_bytes()
}

fn words(words: &[u32]) -> Vec<u8> {
    words.iter().flat_map(|w| w.to_le_bytes()).collect()
}

#[test]
fn inflating_stops_at_the_declared_size_and_is_checked_before_it_begins() {
    // One point is 24 bytes. A stream of just that is read.
    let block = deflate(&[0; 24]);
    let good = base64(&words(&[1, 24, 0, block.len() as u32])) + &base64(&block);
    assert_eq!(read_bytes(&with_array(1, &good)).unwrap().points, [DVec3::ZERO]);

    // A bomb: ten million bytes where 24 are declared.
    let bomb = deflate(&vec![0; 10_000_000]);
    let text = base64(&words(&[1, 24, 0, bomb.len() as u32])) + &base64(&bomb);
    let error = read_bytes(&with_array(1, &text)).unwrap_err().to_string();
    assert!(error.contains("must expand to 24 bytes") && error.contains("25 bytes or more"), "{error}");

    // 2400 million bytes declared in header and points alike, but no deflate stream of this length holds them.
    let text = base64(&words(&[1, 2_400_000_000, 0, block.len() as u32])) + &base64(&block);
    let error = read_bytes(&with_array(100_000_000, &text)).unwrap_err().to_string();
    assert!(error.contains("cannot become 2400000000 bytes"), "{error}");

    // Four thousand million blocks of nothing.
    let text = base64(&words(&[u32::MAX, 0, 0, 0]));
    assert_eq!(read_bytes(&with_array(0, &text)).unwrap().points, [], "a piece of nothing is passed over");
    let error = read_bytes(&with_array(1, &base64(&words(&[u32::MAX, 0, 24, 8])))).unwrap_err().to_string();
    assert!(error.contains("needs 17179869192 bytes"), "{error}");

    // A damaged checksum.
    let mut damaged = block.clone();
    *damaged.last_mut().unwrap() ^= 1;
    let text = base64(&words(&[1, 24, 0, block.len() as u32])) + &base64(&damaged);
    assert!(read_bytes(&with_array(1, &text)).is_err());
}

/// Arrays that lie on one another would make a small file fill any memory.
#[test]
fn appended_arrays_may_not_share_their_bytes() {
    let mesh = two_hexahedra();
    for layout in [Layout::AppendedRaw, Layout::AppendedBase64] {
        for compressed in [false, true] {
            let encoding = Encoding { layout, compressed, ..Encoding::default() };
            let again = "<PointData>\n".to_string()
                + &"<DataArray type=\"Float64\" Name=\"a\" NumberOfComponents=\"3\" format=\"appended\" offset=\"0\"/>\n".repeat(30);
            let error = read_changed(&mesh, encoding, "<PointData>\n", &again).unwrap_err().to_string();
            assert!(error.contains("share"), "{error}");
        }
    }
}
