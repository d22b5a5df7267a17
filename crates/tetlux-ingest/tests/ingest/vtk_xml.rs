//! VTK XML of all kinds: files that VTK wrote (by tests/files/make_vtk_xml.py), and ones written here.

use std::path::{Path, PathBuf};

use glam::DVec3;
use proptest::prelude::*;
use tetlux_ingest::{IngestError, MixedMesh, ReadOptions, Split, read};
use tetlux_mesh::{Field, Location};

use crate::assert_volume;
use crate::damage::damages;
use crate::hostile::survives;
use crate::writers::Folder;

fn files() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/files/vtk_xml")
}

fn load(name: &str) -> MixedMesh {
    read(&files().join(name), &ReadOptions::default()).unwrap_or_else(|error| panic!("{error}"))
}

fn read_text(text: &str) -> Result<MixedMesh, IngestError> {
    let folder = Folder::new();
    read(&folder.write("a.vtu", text.as_bytes()), &ReadOptions::default())
}

fn field<'a>(mesh: &'a MixedMesh, name: &str) -> &'a Field {
    mesh.fields.iter().find(|f| f.name == name).unwrap_or_else(|| panic!("{name} is not in {:?}", mesh.fields))
}

fn assert_same(read: &MixedMesh, origin: &MixedMesh, what: &str) {
    assert_eq!(read.points, origin.points, "{what}");
    assert_eq!(read.cells, origin.cells, "{what}");
    assert_eq!(read.grids, origin.grids, "{what}");
    assert_eq!(read.fields, origin.fields, "{what}");
}

/// The fields that the script gives each mesh, exact in single precision.
fn assert_fields(mesh: &MixedMesh, cells: usize) {
    let f: Vec<f64> = mesh.points.iter().map(|p| p.x + 2.0 * p.y - p.z).collect();
    let position: Vec<f64> = mesh.points.iter().flat_map(|p| p.to_array()).collect();
    assert_eq!(field(mesh, "f").values, f);
    assert_eq!((&field(mesh, "position").values, field(mesh, "position").components), (&position, 3));
    let number: Vec<f64> = (0..cells).map(|c| c as f64).collect();
    assert_eq!((&field(mesh, "number").values, field(mesh, "number").location), (&number, Location::Cell));
}

/// All files of one mesh: in every layout, compressor, header type and byte order.
fn matrix(stem: &str) -> Vec<(String, MixedMesh)> {
    let names = std::fs::read_dir(files()).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let mut names: Vec<String> = names.filter(|name| name.starts_with(&format!("{stem}-"))).collect();
    names.sort();
    for part in ["ascii", "base64", "appended64", "raw", "none", "zlib", "lz4", "-32-", "-64-", "big", "little"] {
        assert!(names.iter().any(|name| name.contains(part)), "{stem} {part}");
    }
    names.into_iter().map(|name| (name.clone(), load(&name))).collect()
}

#[test]
fn unstructured_grids_of_vtk_in_every_encoding() {
    let matrix = matrix("cells");
    let origin = &matrix[0].1;
    assert_eq!(origin.cells.types, [10, 11, 42, 12, 13, 14, 42]);
    assert_eq!(origin.cells.faces(2).unwrap()[0], [12, 15, 14, 13], "the face 0 3 2 1 of the cube from point 12 on");
    assert_fields(origin, 7);
    for (name, mesh) in &matrix {
        assert_same(mesh, origin, name);
    }
    // Tetrahedron, two cubes and one as polyhedron, prism, pyramid and a prism as polyhedron.
    let volume = 1.0 / 6.0 + 3.0 + 0.5 + 1.0 / 3.0 + 0.5;
    assert_volume(origin.clone().tetrahedralize(Split::Six).unwrap().validate().volume, volume);

    let quadratic = load("quadratic.vtu");
    assert_eq!(quadratic.cells.types, [24, 25, 26, 27, 29]);
    assert_eq!(quadratic.cells.offsets, [10, 30, 45, 58, 85]);
    assert_fields(&quadratic, 5);
}

/// The lattice of the script: first index 2, -1, 0.
fn lattice(place: impl Fn([f64; 3]) -> [f64; 3]) -> Vec<DVec3> {
    let mut points = Vec::new();
    for k in 0..3 {
        for j in -1..2 {
            points.extend((2..6).map(|i| DVec3::from(place([f64::from(i), f64::from(j), f64::from(k)]))));
        }
    }
    points
}

#[test]
fn structured_rectilinear_and_image_grids_of_vtk_in_every_encoding() {
    let axes = [[0.0, 1.0, 3.0, 4.5], [-1.0, 0.0, 2.0, f64::NAN], [0.0, 0.5, 4.0, f64::NAN]];
    for (stem, points) in [
        ("curved", lattice(|[i, j, k]| [i, 2.0 * j, 3.0 * k + 0.25 * i])),
        ("axes", lattice(|[i, j, k]| [axes[0][i as usize - 2], axes[1][(j + 1.0) as usize], axes[2][k as usize]])),
        // Turned: i along y, j along -x.
        ("image", lattice(|[i, j, k]| [10.0 - j, 20.0 + 0.5 * i, 30.0 + 2.0 * k])),
    ] {
        let matrix = matrix(stem);
        for (name, mesh) in &matrix {
            assert_eq!(mesh.points, points, "{name}");
            assert_eq!(
                (mesh.grids.len(), mesh.grids[0].counts, &mesh.grids[0].blanked),
                (1, [4, 3, 3], &None),
                "{name}"
            );
            assert_fields(mesh, 12);
            assert_same(mesh, &matrix[0].1, name);
        }
        let report = matrix[0].1.clone().tetrahedralize(Split::Five).unwrap().validate();
        let [low, high] = [points[0], points[35]];
        let volume = if stem == "curved" { 3.0 * 4.0 * 6.0 } else { (high - low).to_array().iter().product::<f64>() };
        assert_volume(report.volume, volume.abs());
        assert_eq!(report.quads_split_both_ways, 0);
    }
}

#[test]
fn another_mesh_does_not_pass_for_the_same() {
    let (mut a, b) = (load("curved-raw-none-64-little.vts"), load("curved-raw-none-64-little.vts"));
    a.fields[0].values[3] += 1.0;
    assert!(std::panic::catch_unwind(|| assert_same(&a, &b, "")).is_err());
    assert!(std::panic::catch_unwind(|| assert_fields(&a, 12)).is_err());
}

#[test]
fn hidden_cells_and_those_at_hidden_points_are_left_out() {
    // One cell hidden, and the last point, a corner of the last cell.
    let mesh = load("blanked.vts");
    assert_eq!(mesh.cell_counts(), [("hexahedra", 10)]);
    assert_eq!(field(&mesh, "number").values, (1..11).map(f64::from).collect::<Vec<_>>());
    assert_eq!(mesh.notes.len(), 2, "{:?}", mesh.notes);
    assert!(mesh.notes[0].contains("hidden cells") && mesh.notes[0].contains(": 1,"), "{:?}", mesh.notes);
    let mesh = load("blanked-point.vts");
    assert_eq!(mesh.cell_counts(), [("hexahedra", 11)]);
    assert_eq!(mesh.grids[0].blanked.as_ref().unwrap().iter().position(|&b| b), Some(35));
    assert!(mesh.notes.len() == 1 && mesh.notes[0].contains("hidden corner"), "{:?}", mesh.notes);
    assert_volume(mesh.tetrahedralize(Split::Six).unwrap().validate().volume, 11.0 * 6.0);
}

#[test]
fn pieces_in_files_of_their_own_are_the_whole_with_ghosts_and_without() {
    for (stem, extension) in [("wave-image", "vti"), ("wave-curved", "vts")] {
        let whole = load(&format!("{stem}.{extension}"));
        assert_eq!(whole.cell_counts(), [("hexahedra", 16)]);
        for ghosts in [0, 1] {
            let name = format!("{stem}-ghosts-{ghosts}.p{extension}");
            assert_same(&load(&name), &whole, &name);
        }
    }
    let whole = load("wave-cells.vtu").tetrahedralize(Split::Six).unwrap().validate();
    // With ghosts the three pieces are 2, 3 and 3 layers of 4 cells, of which 1, 1 and 2 are their own.
    for (ghosts, points) in [(0, 63), (1, 99)] {
        let mesh = load(&format!("wave-cells-ghosts-{ghosts}.pvtu"));
        assert_eq!((mesh.points.len(), mesh.cell_counts()), (points, vec![("voxels", 16)]));
        let noted = mesh.notes.iter().any(|note| note.contains("ghost cells") && note.contains(": 16,"));
        assert_eq!(noted, ghosts == 1, "{:?}", mesh.notes);
        assert_eq!(mesh.fields.iter().map(|f| f.name.as_str()).collect::<Vec<_>>(), ["RTData"]);
        let report = mesh.tetrahedralize(Split::Six).unwrap().validate();
        assert_eq!((report.cells, report.boundary_faces), (whole.cells, whole.boundary_faces));
        assert_eq!((report.quads_split_both_ways, report.assembly.merged_data_differ), (0, 0));
        assert_volume(report.volume, 16.0);
    }
}

#[test]
fn blocks_are_joined_and_surfaces_left_out() {
    let mesh = load("blocks.vtm");
    assert_eq!((mesh.points.len(), mesh.cells.types.len(), mesh.grids.len()), (45 + 36, 7, 1));
    assert_eq!((mesh.grids[0].first_point, mesh.grids[0].counts), (45, [4, 3, 3]));
    assert!(mesh.notes.iter().any(|n| n.contains("blocks_3.vtp")), "{:?}", mesh.notes);
    let number: Vec<f64> = (0..7).chain(0..12).map(f64::from).collect();
    assert_eq!(field(&mesh, "number").values, number);
    // 4.5 of the cells, and 4.5 x 3 x 4.
    assert_volume(mesh.tetrahedralize(Split::Six).unwrap().validate().volume, 4.5 + 54.0);
}

#[test]
fn time_steps_in_one_file_are_told_apart() {
    for (time, first) in [(Some(0), 0.0), (Some(1), 10.0), (Some(2), 20.0), (None, 20.0)] {
        let mesh = read(&files().join("times.vtu"), &ReadOptions { time, ..ReadOptions::default() }).unwrap();
        assert_eq!(mesh.cells.types, [10, 11]);
        assert_eq!(field(&mesh, "number").values, [first, first + 1.0]);
    }
    let options = ReadOptions { time: Some(3), ..ReadOptions::default() };
    let error = read(&files().join("times.vtu"), &options).unwrap_err();
    assert!(matches!(error, IngestError::NoSuchTimeStep { step: 3, count: 3, .. }), "{error}");
    assert!(matches!(
        read(&files().join("wave-cells.vtu"), &options),
        Err(IngestError::NoSuchTimeStep { count: 0, .. })
    ));
}

/// A data array in words.
fn words(name: &str, kind: &str, components: usize, values: &str) -> String {
    format!(
        "<DataArray Name=\"{name}\" type=\"{kind}\" NumberOfComponents=\"{components}\" format=\"ascii\">{values}</DataArray>"
    )
}

/// A prism as polyhedron and a tetrahedron on its top, with these arrays for the faces.
fn polyhedron(faces: &str) -> String {
    let points = words("Points", "Float64", 3, "0 0 0  0 1 0  1 0 0  0 0 1  0 1 1  1 0 1  0 0 2");
    let cells = words("connectivity", "Int64", 1, "3 4 5 6  0 1 2 3 4 5")
        + &words("offsets", "Int64", 1, "4 10")
        + &words("types", "UInt8", 1, "10 42");
    format!(
        "<VTKFile type=\"UnstructuredGrid\" version=\"2.0\" compressor=\"vtkZLibDataCompressor\"><UnstructuredGrid>\
         <Piece NumberOfPoints=\"7\" NumberOfCells=\"2\"><Points>{points}</Points><Cells>{cells}{faces}</Cells></Piece>\
         </UnstructuredGrid></VTKFile>"
    )
}

const PRISM: &str = "5  3 0 1 2  3 3 5 4  4 0 3 4 1  4 1 4 5 2  4 2 5 3 0";

#[test]
fn polyhedra_of_both_layouts_are_the_same() {
    let stream = words("faces", "Int64", 1, PRISM) + &words("faceoffsets", "Int64", 1, "-1 24");
    let listed = words("face_connectivity", "Int32", 1, "0 1 2  3 5 4  0 3 4 1  1 4 5 2  2 5 3 0")
        + &words("face_offsets", "Int32", 1, "3 6 10 14 18")
        + &words("polyhedron_to_faces", "Int32", 1, "0 1 2 3 4")
        + &words("polyhedron_offsets", "Int32", 1, "0 5");
    let [old, new] = [stream, listed].map(|faces| read_text(&polyhedron(&faces)).unwrap());
    assert_same(&old, &new, "both layouts");
    assert_eq!(old.cells.faces(0), None);
    assert_eq!(old.cells.faces(1).unwrap(), [&[0, 1, 2][..], &[3, 5, 4], &[0, 3, 4, 1], &[1, 4, 5, 2], &[2, 5, 3, 0]]);
    assert_volume(old.tetrahedralize(Split::Six).unwrap().validate().volume, 0.5 + 1.0 / 6.0);
}

#[test]
fn what_is_wrong_with_polyhedra_is_named() {
    let old = |faces: &str, ends: &str| words("faces", "Int64", 1, faces) + &words("faceoffsets", "Int64", 1, ends);
    let new = |points: &str, ends: &str, ids: &str, cells: &str| {
        words("face_connectivity", "Int64", 1, points)
            + &words("face_offsets", "Int64", 1, ends)
            + &words("polyhedron_to_faces", "Int64", 1, ids)
            + &words("polyhedron_offsets", "Int64", 1, cells)
    };
    let cases = [
        (String::new(), &["polyhedra", "faces"][..]),
        (words("faces", "Int64", 1, PRISM), &["faceoffsets"]),
        (old(PRISM, "-1 25"), &["cell 1", "faceoffsets", "25"]),
        (old(PRISM, "-1 -1"), &["cell 1", "faceoffsets", "-1"]),
        (old(PRISM, "-1 23"), &["cell 1", "faces"]),
        (old(PRISM, "-1"), &["faceoffsets", "2 values"]),
        (old(&PRISM.replacen('5', "6", 1), "-1 24"), &["cell 1", "faces"]),
        (old(&PRISM.replacen('5', "4", 1), "-1 24"), &["cell 1", "faces"]),
        (old(&PRISM.replacen('5', "4294967295", 1), "-1 24"), &["cell 1", "faces"]),
        (old(&PRISM.replacen("3 5 4", "3 7 4", 1), "-1 24"), &["cell 1", "7", "0 and 6"]),
        (old(&PRISM.replacen("3 5 4", "3 -5 4", 1), "-1 24"), &["cell 1", "-5"]),
        (new("0 1 2", "3", "0", "0"), &["polyhedron_offsets"]),
        (new("0 1 2", "3", "0", "0 2"), &["cell 1", "polyhedron_offsets", "2"]),
        (new("0 1 2", "3", "1", "0 1"), &["cell 1", "a face", "1"]),
        (new("0 1 2", "4", "0", "0 1"), &["cell 1", "a face", "0"]),
        (new("0 1 9", "3", "0", "0 1"), &["cell 1", "9"]),
        (new("0 1 2", "3", &"0 ".repeat(50), "0 50"), &["cell 1", "more than two"]),
    ];
    for (faces, parts) in cases {
        let error = read_text(&polyhedron(&faces)).expect_err(&faces).to_string();
        parts.iter().chain(&["a.vtu"]).for_each(|part| assert!(error.contains(part), "{part}: {error}"));
    }
}

/// An image with this tag and these pieces.
fn image(tag: &str, pieces: &str) -> String {
    format!("<VTKFile type=\"ImageData\" version=\"0.1\"><ImageData {tag}>{pieces}</ImageData></VTKFile>")
}

fn piece(extent: &str, cells: &str) -> String {
    let cells = words("c", "Float32", 1, cells);
    format!("<Piece Extent=\"{extent}\"><PointData></PointData><CellData>{cells}</CellData></Piece>")
}

#[test]
fn pieces_of_one_lattice_make_one_grid_and_others_stay_apart() {
    let whole = "WholeExtent=\"0 3 0 1 0 1\"";
    let mesh = read_text(&image(whole, &(piece("0 1 0 1 0 1", "7") + &piece("1 3 0 1 0 1", "8 9")))).unwrap();
    assert_eq!((mesh.grids.len(), mesh.grids[0].counts, mesh.points.len()), (1, [4, 2, 2], 16));
    assert_eq!(field(&mesh, "c").values, [7.0, 8.0, 9.0]);
    let report = mesh.tetrahedralize(Split::Five).unwrap().validate();
    assert_eq!((report.cells, report.quads_split_both_ways), (15, 0));
    // With a gap between them.
    let apart = piece("0 1 0 1 0 1", "7") + &piece("2147483640 2147483642 0 1 0 1", "8 9");
    let mesh = read_text(&image(whole, &apart)).unwrap();
    assert_eq!((mesh.grids.len(), mesh.points.len(), field(&mesh, "c").values.len()), (2, 8 + 12, 3));
    assert_eq!(mesh.points[8].x, 2_147_483_640.0);
    // Enough points, but with a hole: what no piece has is hidden.
    let holed = piece("0 1 0 1 0 1", "7") + &piece("0 1 0 1 0 1", "7") + &piece("2 3 0 1 0 1", "9");
    let mesh = read_text(&image(whole, &holed)).unwrap();
    assert_eq!(mesh.cell_counts(), [("hexahedra", 2)]);
    assert_eq!(field(&mesh, "c").values, [7.0, 9.0]);
}

#[test]
fn what_is_wrong_with_a_lattice_is_named_and_a_flat_one_has_no_cells() {
    let one = piece("0 1 0 1 0 1", "7");
    let cases = [
        (image("WholeExtent=\"0 1 0 1\"", &one), &["WholeExtent", "six"][..]),
        (image("Spacing=\"1 1\"", &one), &["Spacing", "3 numbers"]),
        (image("Spacing=\"1 1 nan\"", &one), &["point 0", "NaN"]),
        (image("Origin=\"0 0 1e999\"", &one), &["point 0", "inf"]),
        (image("Direction=\"1 0 0\"", &one), &["Direction", "9 numbers"]),
        (image("", &piece("0 1 0 1 0 2", "7")), &["\"c\"", "2 values"]),
        (image("", &piece("0 1 0 1 0 1.5", "7")), &["Extent", "1.5"]),
        (image("", &piece("0 2147483647 0 2147483647 0 1", "7")), &["extent", "2147483648"]),
        (image("", &piece("-2147483648 2147483647 0 0 0 0", "7")), &["extent", "4294967296"]),
        (image("", "<Piece></Piece>"), &["Extent"]),
        (image("WholeExtent=\"0 1000 0 1000 0 1000\"", "<Piece></Piece>"), &["1003003001 points", "data"]),
        (image("", ""), &["ImageData", "<Piece>"]),
    ];
    for (text, parts) in cases {
        let error = read_text(&text).expect_err(&text).to_string();
        parts.iter().chain(&["a.vtu"]).for_each(|part| assert!(error.contains(part), "{part}: {error}"));
    }
    assert!(read_text(&image("", &one)).is_ok());
    let flat = read_text(&image("", &piece("0 2 0 2 4 4", "1 2 3 4"))).unwrap();
    assert_eq!((flat.points.len(), flat.grids.len(), flat.fields.len()), (9, 0, 0));
    assert!(flat.notes[0].contains("3 x 3 x 1"), "{:?}", flat.notes);
    let coordinates = words("x", "Float32", 1, "0 1") + &words("y", "Float32", 1, "0 1");
    let rectilinear = format!(
        "<VTKFile type=\"RectilinearGrid\"><RectilinearGrid WholeExtent=\"0 1 0 1 0 1\"><Piece Extent=\"0 1 0 1 0 1\">\
         <Coordinates>{coordinates}</Coordinates></Piece></RectilinearGrid></VTKFile>"
    );
    assert!(read_text(&rectilinear).unwrap_err().to_string().contains("Coordinates"));
}

fn list(kind: &str, element: &str, attribute: &str, files: &[&str]) -> String {
    let entries: String = files.iter().map(|file| format!("<{element} {attribute}=\"{file}\"/>")).collect();
    format!("<VTKFile type=\"{kind}\"><{kind}>{entries}</{kind}></VTKFile>")
}

#[test]
fn collections_name_the_file_at_fault() {
    let folder = Folder::new();
    let good = image("", &piece("0 1 0 1 0 1", "7"));
    folder.write("good.vti", good.as_bytes());
    folder.write("bad.vti", good.replace("0 1 0 1 0 1", "0 1 0 1 0 9").as_bytes());
    folder.write("nan.vti", good.replace("<ImageData ", "<ImageData Origin=\"nan 0 0\"").as_bytes());
    folder.write("surface.vtp", b"<VTKFile type=\"PolyData\"><PolyData/></VTKFile>");
    for n in 0..20 {
        let next = format!("{}.vtm", n + 1);
        folder.write(&format!("{n}.vtm"), list("vtkMultiBlockDataSet", "DataSet", "file", &[&next]).as_bytes());
    }
    let load = |text: String| read(&folder.write("all.pvti", text.as_bytes()), &ReadOptions::default());
    let pieces = |files: &[&str]| load(list("PImageData", "Piece", "Source", files));
    let blocks = |files: &[&str]| load(list("vtkMultiBlockDataSet", "DataSet", "file", files));
    assert_eq!(pieces(&["good.vti"]).unwrap().grids.len(), 1);
    assert_eq!(blocks(&["good.vti", "surface.vtp"]).unwrap().grids.len(), 1);
    for (result, parts) in [
        (pieces(&["good.vti", "missing.vti"]), &["missing.vti", "cannot be read"][..]),
        (blocks(&["good.vti", "missing.vti"]), &["missing.vti", "cannot be read"]),
        (pieces(&["bad.vti"]), &["bad.vti", "\"c\""]),
        (pieces(&["nan.vti"]), &["nan.vti", "point 0"]),
        (pieces(&["good.vti", "good.vti"]), &["good.vti", "listed before"]),
        (blocks(&["./good.vti", "good.vti"]), &["good.vti", "listed before"]),
        (pieces(&["all.pvti"]), &["listed before"]),
        (pieces(&[""]), &["a directory"]),
        (pieces(&[]), &["without a <Piece>"]),
        (blocks(&[]), &["without a <DataSet>"]),
        (pieces(&["surface.vtp"]), &["surface.vtp", "PolyData"]),
        (blocks(&["surface.vtp"]), &["surface.vtp", "PolyData"]),
        (blocks(&["0.vtm"]), &["more than 8 deep"]),
    ] {
        let error = result.unwrap_err().to_string();
        parts.iter().chain(&["all.pvti"]).for_each(|part| assert!(error.contains(part), "{part}: {error}"));
    }
    let path = folder.path().join("surface.vtp");
    assert!(
        matches!(read(&path, &ReadOptions::default()), Err(IngestError::Unsupported { found, .. }) if found == "PolyData")
    );
}

#[test]
fn a_collection_of_times_gives_one_of_them() {
    let folder = Folder::new();
    for (name, value) in [("a.vti", "7"), ("b.vti", "8"), ("c.vti", "9")] {
        folder.write(name, image("", &piece("0 1 0 1 0 1", value)).as_bytes());
    }
    let entries: String = [("0", "a"), ("0.5", "b"), ("0.5", "c")]
        .map(|(time, file)| format!("<DataSet timestep=\"{time}\" group=\"\" part=\"0\" file=\"{file}.vti\"/>"))
        .concat();
    let text = format!("<VTKFile type=\"Collection\"><Collection>{entries}</Collection></VTKFile>");
    let path = folder.write("all.pvd", text.as_bytes());
    for (time, values) in [(Some(0), &[7.0][..]), (Some(1), &[8.0, 9.0]), (None, &[8.0, 9.0])] {
        let mesh = read(&path, &ReadOptions { time, ..ReadOptions::default() }).unwrap();
        assert_eq!(field(&mesh, "c").values, values);
        assert!(mesh.notes.iter().any(|note| note.contains("of 2 is read")), "{:?}", mesh.notes);
    }
    let options = ReadOptions { time: Some(2), ..ReadOptions::default() };
    assert!(matches!(read(&path, &options), Err(IngestError::NoSuchTimeStep { step: 2, count: 2, .. })));
}

/// Files of VTK's that stand alone: one of each kind and compressor.
const ALONE: [&str; 9] = [
    "cells-raw-lzma-32-little.vtu",
    "cells-appended64-lz4-32-big.vtu",
    "cells-base64-lzma-32-big.vtu",
    "curved-base64-lz4-64-little.vts",
    "axes-raw-zlib-32-big.vtr",
    "image-appended64-none-32-little.vti",
    "image-ascii-none-32-little.vti",
    "blanked.vts",
    "times.vtu",
];

#[test]
fn every_truncation_is_an_error() {
    let folder = Folder::new();
    let path = folder.path().join("a.vtu");
    for name in ALONE {
        let bytes = std::fs::read(files().join(name)).unwrap();
        let appended = bytes.windows(14).rposition(|w| w == b"</AppendedData").map(|at| at + 14);
        let end = appended.unwrap_or_else(|| bytes.windows(9).rposition(|w| w == b"</VTKFile").unwrap());
        // Every seventh length, for time.
        for length in (1..end).step_by(7) {
            std::fs::write(&path, &bytes[..length]).unwrap();
            let error = read(&path, &ReadOptions::default()).expect_err(name);
            assert!(error.to_string().contains("a.vtu"), "{name} {length}: {error}");
        }
    }
}

/// Number of cases: more in a run of stress tests.
fn cases() -> u32 {
    std::env::var("TETLUX_STRESS_CASES").ok().and_then(|n| n.parse().ok()).unwrap_or(300)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: cases(), failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn damaged_files_do_not_panic(which in 0..ALONE.len(), damages in damages()) {
        let mut bytes = std::fs::read(files().join(ALONE[which])).unwrap();
        damages.iter().for_each(|d| d.apply(&mut bytes));
        survives(&bytes, None);
    }
}
