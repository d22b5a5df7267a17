mod shapes;
mod writer;

use glam::DVec3;
use proptest::prelude::*;
use tetlux_mesh::Location;
use tetlux_mesh::procedural::Split;
use writer::{CHAR, F32, F64, File, I32, I64};

use super::*;
use crate::damage::{config, damages};

fn load(bytes: Vec<u8>, time: Option<usize>) -> Result<MixedMesh, IngestError> {
    let mesh = read(&Source { path: "a.ex2".into(), bytes }, time)?;
    mesh.check()?;
    Ok(mesh)
}

fn message(file: &File, time: Option<usize>) -> String {
    let message = load(file.bytes(), time).unwrap_err().to_string();
    assert!(message.starts_with("a.ex2: "), "{message}");
    message
}

const STEPS: u64 = 3;

fn value(variable: usize, step: usize, at: usize) -> f64 {
    (100 * variable + 10 * step + at) as f64 * 0.5
}

/// The unit cube, a tetrahedron on it, and a shell; three nodal variables and two of elements at three steps.
fn model(version: u8, real: u32, whole: u32, old: bool) -> File {
    let dimensions = vec![
        ("len_name", 8),
        ("time_step", 0),
        ("num_dim", 3),
        ("num_nodes", 9),
        ("num_el_in_blk1", 1),
        ("num_nod_per_el1", 8),
        ("num_el_in_blk2", 1),
        ("num_nod_per_el2", 4),
        ("num_el_in_blk3", 1),
        ("num_nod_per_el3", 4),
        ("num_nod_var", 3),
        ("num_elem_var", 2),
    ];
    let mut file = File { version, records: STEPS, dimensions, variables: Vec::new() };
    let x = [0., 1., 1., 0., 0., 1., 1., 0., 0.5].to_vec();
    let y = [0., 0., 1., 1., 0., 0., 1., 1., 0.5].to_vec();
    let z = [0., 0., 0., 0., 1., 1., 1., 1., 2.0].to_vec();
    if old {
        file.add("coord", &["num_dim", "num_nodes"], real, [x, y, z].concat());
    } else {
        for (name, values) in [("coordx", x), ("coordy", y), ("coordz", z)] {
            file.add(name, &["num_nodes"], real, values);
        }
    }
    let blocks: [(_, &[&'static str], &[i32]); 3] = [
        ("hex", &["num_el_in_blk1", "num_nod_per_el1"], &[1, 2, 3, 4, 5, 6, 7, 8]),
        ("SHELL4", &["num_el_in_blk2", "num_nod_per_el2"], &[1, 2, 3, 4]),
        ("Tetra4", &["num_el_in_blk3", "num_nod_per_el3"], &[5, 6, 7, 9]),
    ];
    for (block, (kind, dimensions, nodes)) in blocks.into_iter().enumerate() {
        let name = format!("connect{}", block + 1);
        file.add(&name, dimensions, whole, nodes.iter().map(|&n| n.into()).collect());
        file.variable(&name).elem_type = Some(kind);
    }
    file.add_names("name_nod_var", "num_nod_var", &["T", "p", "flux_x"]);
    file.add_names("name_elem_var", "num_elem_var", &["rho", "mu"]);
    // A variable of odd length between others of each record: padded.
    file.add("odd", &["time_step"], 3, vec![7.0; STEPS as usize]);
    let steps = || 0..STEPS as usize;
    file.add("time_whole", &["time_step"], real, steps().map(|t| t as f64 * 0.25).collect());
    let nodal = |v: usize| move |t: usize| (0..9).map(move |p| value(v, t, p));
    if old {
        let values = steps().flat_map(|t| (0..3).flat_map(move |v| nodal(v)(t))).collect();
        file.add("vals_nod_var", &["time_step", "num_nod_var", "num_nodes"], real, values);
    } else {
        for v in 0..3 {
            let name = format!("vals_nod_var{}", v + 1);
            file.add(&name, &["time_step", "num_nodes"], real, steps().flat_map(nodal(v)).collect());
        }
    }
    for (name, dimension, v) in [
        ("vals_elem_var1eb1", "num_el_in_blk1", 5),
        ("vals_elem_var1eb2", "num_el_in_blk2", 6),
        ("vals_elem_var1eb3", "num_el_in_blk3", 7),
        ("vals_elem_var2eb3", "num_el_in_blk3", 8),
    ] {
        file.add(name, &["time_step", dimension], real, steps().map(|t| value(v, t, 0)).collect());
    }
    file
}

#[test]
fn every_encoding_gives_the_same_mesh() {
    for version in [1, 2, 5] {
        for (real, whole) in [(F32, I32), (F64, I32), (F64, I64)] {
            for old in [false, true] {
                for time in [None, Some(0), Some(1), Some(2)] {
                    let mesh = load(model(version, real, whole, old).bytes(), time).unwrap();
                    let step = time.unwrap_or(2);
                    assert_eq!(mesh.points[6], DVec3::ONE);
                    assert_eq!(mesh.points[8], DVec3::new(0.5, 0.5, 2.0));
                    assert_eq!(mesh.cells.types, [12, 10]);
                    assert_eq!(mesh.cells.connectivity, [0, 1, 2, 3, 4, 5, 6, 7, 4, 5, 6, 8]);
                    let fields: Vec<(&str, Location, &[f64])> =
                        mesh.fields.iter().map(|f| (f.name.as_str(), f.location, f.values.as_slice())).collect();
                    let nodal = |v| (0..9).map(|p| value(v, step, p)).collect::<Vec<f64>>();
                    let expected = [nodal(0), nodal(1), nodal(2)];
                    for (v, name) in ["T", "p", "flux_x"].into_iter().enumerate() {
                        assert_eq!(fields[v], (name, Location::Point, expected[v].as_slice()));
                    }
                    assert_eq!(fields[3], ("rho", Location::Cell, [value(5, step, 0), value(7, step, 0)].as_slice()));
                    assert_eq!((fields[4].0, fields[4].2[1]), ("mu", value(8, step, 0)));
                    assert!(fields[4].2[0].is_nan() && fields.len() == 5);
                    let notes = mesh.notes.join("\n");
                    for part in [
                        "SHELL4",
                        "\"mu\" is on some blocks only",
                        &format!("step {step}, time {}", step as f64 * 0.25),
                    ] {
                        assert!(notes.contains(part), "{part}: {notes}");
                    }
                    // The cube, and the tetrahedron of height 1 on half of its top.
                    let volume = mesh.tetrahedralize(Split::Six).unwrap().validate().volume;
                    assert!((volume - (1.0 + 1.0 / 6.0)).abs() < 1e-14, "{volume}");
                }
            }
        }
    }
}

#[test]
fn a_step_out_of_range_is_answered_with_their_number() {
    let mut file = model(1, F64, I32, false);
    let error = load(file.bytes(), Some(3)).unwrap_err();
    assert!(matches!(error, IngestError::NoSuchTimeStep { step: 3, count: 3, .. }), "{error}");
    assert!(error.to_string().contains("the file has 3"), "{error}");
    file.records = 0;
    let mesh = load(file.bytes(), None).unwrap();
    assert!(mesh.fields.is_empty() && mesh.notes.iter().any(|n| n.contains("no time steps")), "{:?}", mesh.notes);
    assert!(load(file.bytes(), Some(0)).unwrap_err().to_string().contains("the file has 0"));
}

#[test]
fn records_of_a_file_that_was_being_written_are_counted() {
    for version in [1, 5] {
        let file = model(version, F64, I32, true);
        let mut bytes = file.bytes();
        bytes[4..if version == 5 { 12 } else { 8 }].fill(0xff);
        let [found, expected] = [bytes, file.bytes()].map(|bytes| load(bytes, None).unwrap());
        assert_eq!(found.notes, expected.notes);
        assert_eq!(found.fields[0], expected.fields[0]);
    }
}

#[test]
fn one_variable_alone_has_records_without_padding() {
    let mut file = model(1, F64, I32, false);
    file.variables.retain(|v| !["odd", "time_whole"].contains(&v.name.as_str()) && !v.name.starts_with("vals"));
    // Three shorts a record: 6 bytes, and 8 if they were padded.
    let values = (0..27).map(f64::from).collect();
    file.add("vals_nod_var1", &["time_step", "num_nodes"], 3, values);
    let mesh = load(file.bytes(), Some(2)).unwrap();
    assert_eq!(mesh.fields[0].values, (18..27).map(f64::from).collect::<Vec<f64>>());
}

#[test]
fn names_that_end_in_x_y_and_z_are_one_vector() {
    let with = |names: [&str; 3]| {
        let mut file = model(1, F64, I32, false);
        file.variables.retain(|v| v.name != "name_nod_var");
        file.add_names("name_nod_var", "num_nod_var", &names);
        load(file.bytes(), Some(0)).unwrap()
    };
    for (names, joined) in [(["VX", "VY", "VZ"], "V"), (["disp_x", "disp_y", "disp_z"], "disp")] {
        let mesh = with(names);
        let vector: Vec<f64> = (0..9).flat_map(|p| [0, 1, 2].map(|v| value(v, 0, p))).collect();
        assert_eq!((mesh.fields[0].name.as_str(), mesh.fields[0].components), (joined, 3));
        assert_eq!(mesh.fields[0].values, vector);
        assert!(mesh.notes.iter().any(|n| n.contains(&format!("components 0, 1 and 2 of {joined}"))));
    }
    for names in [["x", "y", "z"], ["ax", "by", "az"], ["VX", "VY", "Vz"], ["VX", "VZ", "VY"]] {
        let found = with(names).fields;
        assert_eq!([0, 1, 2].map(|v| (found[v].name.as_str(), found[v].components)), names.map(|name| (name, 1)));
    }
}

#[test]
fn every_truncation_is_an_error() {
    for version in [1, 2, 5] {
        let bytes = model(version, F64, I32, version == 1).bytes();
        for length in 0..bytes.len() {
            let error = load(bytes[..length].to_vec(), None).unwrap_err();
            let bare = matches!(error, IngestError::Truncated { .. } | IngestError::Malformed { .. });
            assert!(bare && error.to_string().starts_with("a.ex2: "), "{length}: {error}");
        }
    }
}

#[test]
fn what_is_wrong_is_said() {
    let good = || model(2, F64, I32, false);
    let changed = |change: &dyn Fn(&mut File)| {
        let mut file = good();
        change(&mut file);
        message(&file, None)
    };
    type Case<'a> = (&'a dyn Fn(&mut File), &'a [&'a str]);
    let cases: Vec<Case> = vec![
        (&|f| f.dimensions[2].0 = "dim", &["num_dim", "none", "Exodus II"]),
        (&|f| f.dimensions[2].1 = 2, &["num_dim 2", "three dimensions"]),
        (&|f| f.variables.retain(|v| v.name != "coordy"), &["coordy", "neither"]),
        (&|f| f.variable("coordz").dimensions = vec!["len_name"], &["the length of coordz", "found 8", "has 9"]),
        (&|f| f.variable("connect1").values[3] = 0.0, &["element 0 of connect1", "found 0", "1 to 9"]),
        (&|f| f.variable("connect3").values[3] = 10.0, &["element 0 of connect3", "found 10", "1 to 9"]),
        (&|f| f.variable("coordx").values[4] = f64::NAN, &["point 4", "NaN"]),
        (&|f| f.variable("coordx").kind = CHAR, &["coordx", "text", "numbers"]),
        (&|f| f.variable("coordx").dimensions.clear(), &["the length of coordy"]),
        (&|f| f.variable("vals_nod_var2").dimensions = vec!["time_step", "len_name"], &["\"p\"", "found 8", "have 9"]),
        (&|f| f.variable("vals_nod_var2").dimensions = vec!["num_nodes"], &["\"p\""]),
        (&|f| f.variables.retain(|v| v.name == "connect2" || !v.name.starts_with("con")), &["SHELL4", "volume"]),
        (&|f| f.variables.retain(|v| !v.name.starts_with("con")), &["no element blocks", "volume"]),
        (
            &|f| {
                f.variable("vals_elem_var1eb1").dimensions = vec!["time_step", "num_dim"];
                f.variable("vals_elem_var1eb1").values = vec![0.0; 9];
            },
            &["\"rho\"", "found 3", "have 1"],
        ),
    ];
    for (change, parts) in cases {
        let message = changed(change);
        assert!(parts.iter().all(|part| message.contains(part)), "{parts:?}: {message}");
    }
    let hdf5 = load([file::HDF5, &[0; 100]].concat(), None).unwrap_err().to_string();
    assert!(hdf5.contains("HDF5") && hdf5.contains("nccopy"), "{hdf5}");
}

#[test]
fn hostile_headers_are_refused() {
    let file = model(1, F64, I32, false);
    let bytes = file.bytes();
    let with = |at: usize, number: u32| {
        let mut bytes = bytes.clone();
        bytes[at..at + 4].copy_from_slice(&number.to_be_bytes());
        load(bytes, None).unwrap_err().to_string()
    };
    assert!(with(8, 11).contains("the tag of the list of dimensions"));
    assert!(with(12, u32::MAX).contains("netCDF header") || with(12, u32::MAX).contains("tag"));
    assert!(with(16, u32::MAX).contains("the netCDF header at byte 20 needs"));
    assert!(with(4, 1 << 30).contains("cut short"));
    // Two variables of as many values as the file has bytes: they overlap.
    let mut many = file.clone();
    for v in 0..40 {
        many.add(&format!("vals_elem_var{}eb1", v + 3), &["time_step", "num_el_in_blk1"], F64, vec![0.0; 3]);
    }
    let names: Vec<String> = (0..42).map(|v| format!("n{v}")).collect();
    many.variables.retain(|v| v.name != "name_elem_var");
    many.dimensions.push(("many", 42));
    many.add_names("name_elem_var", "many", &names.iter().map(String::as_str).collect::<Vec<&str>>());
    assert_eq!(load(many.bytes(), None).unwrap().fields.len(), 3 + 42);
}

#[test]
fn what_is_filled_with_nan_is_bounded() {
    const CELLS: usize = 20_000;
    const VARIABLES: usize = 200;
    let dimensions =
        vec![("len_name", 8), ("time_step", 0), ("num_dim", 3), ("n", 4), ("one", 1), ("many", CELLS as u64)];
    let mut file = File { version: 1, records: 1, dimensions, variables: Vec::new() };
    let corners = [[0.0; 3], [1., 0., 0.], [0., 1., 0.], [0., 0., 1.]];
    file.add("coord", &["num_dim", "n"], F64, (0..3).flat_map(|axis| corners.map(|c| c[axis])).collect());
    for (name, dimension, cells) in [("connect1", "one", 1), ("connect2", "many", CELLS)] {
        file.add(name, &[dimension, "n"], I32, [1., 2., 3., 4.].repeat(cells));
        file.variable(name).elem_type = Some("TET4");
    }
    file.dimensions.push(("variables", VARIABLES as u64));
    let names: Vec<String> = (0..VARIABLES).map(|v| format!("v{v}")).collect();
    file.add_names("name_elem_var", "variables", &names.iter().map(String::as_str).collect::<Vec<&str>>());
    for v in 1..=VARIABLES {
        file.add(&format!("vals_elem_var{v}eb1"), &["time_step", "one"], F64, vec![1.0]);
    }
    let bytes = file.bytes();
    let fillable = (16 << 20) + 4 * bytes.len();
    let mesh = load(bytes, None).unwrap();
    assert_eq!(mesh.fields.len(), fillable / (8 * CELLS));
    assert!(mesh.fields.len() < VARIABLES && mesh.notes.iter().any(|n| n.contains("left out")));
}

#[test]
fn variables_that_overlap_are_refused() {
    let file = model(1, F64, I32, true);
    let source = Source { path: "a.ex2".into(), bytes: file.bytes() };
    let parsed = netcdf::NetCdf::parse(&source).unwrap();
    let coord = parsed.variable("coord").unwrap();
    let within = source.bytes.len() / (3 * 9 * 8);
    for _ in 0..within {
        parsed.numbers("coord", coord, &[]).unwrap();
    }
    assert!(parsed.numbers("coord", coord, &[]).unwrap_err().to_string().contains("overlap"));
}

proptest! {
    #![proptest_config(config())]

    #[test]
    fn damaged_files_do_not_panic(
        version in prop::sample::select(vec![1u8, 2, 5]), old: bool, time in prop::option::of(0usize..4), damages in damages(),
    ) {
        let mut bytes = model(version, F32, I32, old).bytes();
        damages.iter().for_each(|d| d.apply(&mut bytes));
        match load(bytes, time) {
            Ok(mesh) => drop(mesh.tetrahedralize(Split::Six)),
            Err(error) => prop_assert!(error.to_string().len() < 1000, "{}", error),
        }
    }
}

/// Written by meshio and the netCDF library (tests/files/make_exodus.py).
#[test]
fn files_of_another_program() {
    for format in ["classic", "64bit_offset", "64bit_data"] {
        let bytes = std::fs::read(format!("{}/tests/files/exodus/{format}.e", env!("CARGO_MANIFEST_DIR"))).unwrap();
        assert_eq!(
            bytes[3],
            match format {
                "classic" => 1,
                "64bit_offset" => 2,
                _ => 5,
            }
        );
        let mesh = load(bytes, None).unwrap();
        assert_eq!(mesh.cells.types, [12, 12, 13, 14, 10, 24], "{format}");
        assert_eq!(mesh.fields.len(), 1);
        let sum = mesh.points.iter().map(|p| p.x + 2.0 * p.y + 4.0 * p.z).collect();
        assert_eq!(mesh.fields[0], tetlux_mesh::Field::point("sum", 1, sum));
        // Unit cubes, half of one, a third, and tetrahedra of a sixth.
        let volume = mesh.tetrahedralize(Split::Six).unwrap().validate().volume;
        assert!((volume - (2.0 + 1.0 / 2.0 + 1.0 / 3.0 + 2.0 / 6.0)).abs() < 1e-14, "{volume}");
    }
}

#[cfg(feature = "hdf5")]
mod in_hdf5 {
    use super::*;

    fn file() -> Vec<u8> {
        std::fs::read(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/files/exodus/netcdf4.e")).unwrap()
    }

    #[test]
    fn a_cube_at_two_times_is_read() {
        for (time, factor) in [(None, 2.0), (Some(0), 1.0), (Some(1), 2.0)] {
            let mesh = load(file(), time).unwrap();
            assert_eq!(mesh.cell_counts(), [("hexahedra", 1)]);
            let sum = mesh.points.iter().map(|p| factor * (p.x + 2.0 * p.y + 4.0 * p.z)).collect();
            assert_eq!(mesh.fields, [tetlux_mesh::Field::point("sum", 1, sum)]);
            assert!(mesh.notes.iter().any(|note| note.contains("time 0.5") || note.contains("time 1.5")));
            assert_eq!(mesh.tetrahedralize(Split::Six).unwrap().validate().volume, 1.0);
        }
        assert!(matches!(load(file(), Some(2)), Err(IngestError::NoSuchTimeStep { step: 2, count: 2, .. })));
    }

    /// What a file ends with may be no data: then its mesh is the same.
    #[test]
    fn cut_anywhere_it_is_refused_or_the_same() {
        let whole = file();
        let mesh = load(whole.clone(), None).unwrap();
        let mut refused = 0;
        for length in (8..whole.len()).step_by(61) {
            match load(whole[..length].to_vec(), None) {
                Ok(cut) => assert_eq!((cut.points, cut.fields), (mesh.points.clone(), mesh.fields.clone()), "{length}"),
                Err(error) => {
                    refused += 1;
                    assert!(error.to_string().starts_with("a.ex2: "), "{error}");
                }
            }
        }
        assert!(refused > whole.len() / 61 / 2, "{refused}");
    }

    #[test]
    fn more_than_its_bytes_can_become_is_not_read() {
        let bytes = file();
        let source = Source { path: "a.ex2".into(), bytes };
        let parsed = file::File::open(&source).unwrap();
        let coord = parsed.variable("coordx").unwrap();
        let within = 1032 * source.bytes.len() / (8 * 8);
        for _ in 0..within {
            parsed.numbers("coordx", coord, &[]).unwrap();
        }
        assert!(parsed.numbers("coordx", coord, &[]).unwrap_err().to_string().contains("the size of coordx"));
    }

    proptest! {
        #![proptest_config(config())]

        #[test]
        fn damaged_files_do_not_panic(time in prop::option::of(0usize..3), damages in damages()) {
            let mut bytes = file();
            damages.iter().for_each(|d| d.apply(&mut bytes));
            match load(bytes, time) {
                Ok(mesh) => drop(mesh.tetrahedralize(Split::Six)),
                Err(error) => prop_assert!(error.to_string().len() < 1000, "{}", error),
            }
        }
    }
}

#[test]
fn disk_out_ref() {
    let data = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/data/");
    let read = |name: &str| crate::read(format!("{data}{name}").as_ref(), &crate::ReadOptions::default());
    let [Ok(mixed), Ok(vtk)] = [read("disk_out_ref.ex2"), read("tets/disk_tets.vtu")] else {
        return println!("the data set disk_out_ref is absent: not tested");
    };
    assert_eq!((mixed.points.len(), mixed.cell_counts()), (8_499, vec![("hexahedra", 7_472)]));
    let names: Vec<(&str, usize)> = mixed.fields.iter().map(|f| (f.name.as_str(), f.components)).collect();
    let expected = [("Temp", 1), ("V", 3), ("Pres", 1), ("AsH3", 1), ("GaMe3", 1), ("CH4", 1), ("H2", 1)];
    assert_eq!(names, expected);
    let [mesh, vtk] = [mixed, vtk].map(|m| m.tetrahedralize(Split::Six).unwrap());
    let scalar = |mesh: &crate::TetMesh, name: &str| mesh.scalar(name, tetlux_mesh::Component::Magnitude).unwrap();
    // The values are in single precision.
    assert_eq!(scalar(&mesh, "Temp").range.map(|t| t as f32), [293.15, 913.15]);
    // VTK has the points in another order: that of their use.
    let sorted = |mesh: &crate::TetMesh, name: &str| {
        let temperature = scalar(mesh, name).values;
        let mut points: Vec<[f64; 4]> =
            mesh.points().iter().zip(temperature).map(|(p, t)| [p.x.into(), p.y.into(), p.z.into(), t]).collect();
        points.sort_by(|a, b| a.partial_cmp(b).unwrap());
        points
    };
    assert!(sorted(&mesh, "Temp") == sorted(&vtk, "scalar"));
    let [own, theirs] = [mesh, vtk].map(|m| m.validate());
    assert_eq!((own.cells, theirs.cells), (44_832, 44_832));
    // VTK cuts warped faces along other diagonals, so that parts of cells change sides; the whole changes only by what
    // lies between the diagonals of the boundary's faces.
    let difference = (own.volume / theirs.volume - 1.0).abs();
    assert!(difference < 1e-3, "volumes differ by {difference:e}");
}
