//! The program as a user runs it: what it writes, what it says, and how it ends.

#![allow(clippy::unwrap_used, reason = "a test's helpers fail like the test")]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use tempfile::TempDir;
use tetlux_image::{Image, read_exr, write_exr};

/// Runs the program in a folder.
fn run(folder: &Path, args: &[&str]) -> Output {
    // A cache of its own, in a folder that is not there unless something is stored.
    run_with_cache(folder, &folder.join("cache"), args)
}

fn run_with_cache(folder: &Path, cache: &Path, args: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_xtask"));
    command.args(args).current_dir(folder).env("TETLUX_CACHE_DIR", cache).output().unwrap()
}

fn stdout(output: &Output) -> String {
    String::from_utf8_lossy(&output.stdout).into_owned()
}

/// What the program said on standard error; a software driver's own remark without a desktop is not the program's.
fn stderr(output: &Output) -> String {
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    text.lines().filter(|line| !line.contains("XDG_RUNTIME_DIR")).collect::<Vec<_>>().join("\n")
}

/// Asserts exit status 2 and one line that begins with "error: " and holds all parts; gives it.
fn assert_fails(output: &Output, parts: &[&str]) -> String {
    let message = stderr(output);
    assert_eq!(output.status.code(), Some(2), "{message}");
    assert!(message.starts_with("error: ") && message.lines().count() == 1, "{message}");
    assert!(!message.contains("panicked"), "{message}");
    for part in parts {
        assert!(message.contains(part), "\"{part}\" is not in: {message}");
    }
    message
}

fn json(path: &Path) -> serde_json::Value {
    serde_json::from_slice(&fs::read(path).unwrap()).unwrap()
}

/// Two tetrahedra with a point field and a vector field.
const VTU: &str = r#"<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian">
<UnstructuredGrid><Piece NumberOfPoints="5" NumberOfCells="2">
<PointData>
  <DataArray type="Float64" Name="heat" format="ascii">0 1 2 3 4</DataArray>
  <DataArray type="Float64" Name="flow" NumberOfComponents="3" format="ascii">3 4 0 0 0 0 0 0 0 0 0 0 0 0 1</DataArray>
</PointData>
<Points><DataArray type="Float64" NumberOfComponents="3" format="ascii">
  0 0 0  1 0 0  0 1 0  0 0 1  1 1 1
</DataArray></Points>
<Cells>
  <DataArray type="Int32" Name="connectivity" format="ascii">0 1 2 3  1 2 3 4</DataArray>
  <DataArray type="Int32" Name="offsets" format="ascii">4 8</DataArray>
  <DataArray type="UInt8" Name="types" format="ascii">10 10</DataArray>
</Cells></Piece></UnstructuredGrid></VTKFile>"#;

const SCENE: &str = r#"
[mesh]
path = "mesh.vtu"
[field]
name = "heat"
[transfer]
color = [[0.0, 0.2, 0.4, 1.0], [4.0, 1.0, 0.5, 0.1]]
opacity = [[0.0, 0.5], [4.0, 3.0]]
[image]
size = [40, 30]
"#;

/// A folder with `mesh.vtu` and `scene.toml`.
fn folder() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("mesh.vtu"), VTU).unwrap();
    fs::write(folder.path().join("scene.toml"), SCENE).unwrap();
    folder
}

/// Every file below a folder.
fn files(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() { found.extend(files(&path)) } else { found.push(path) }
    }
    found
}

#[test]
fn the_built_in_scene_is_rendered() {
    let folder = tempfile::tempdir().unwrap();
    let args = ["render", "--size", "64x64", "--output", "made/here/wing.png", "--json", "made/wing.json"];
    let output = run(folder.path(), &args);
    assert!(output.status.success(), "{}", stderr(&output));
    for part in ["plan", "backend", "order", "cells", "draw", "wing.png", "wing.exr"] {
        assert!(stdout(&output).contains(part), "\"{part}\" is not in:\n{}", stdout(&output));
    }
    let png = fs::read(folder.path().join("made/here/wing.png")).unwrap();
    assert!(png.starts_with(b"\x89PNG\r\n\x1a\n"));
    let image = read_exr(&folder.path().join("made/here/wing.exr")).unwrap();
    assert_eq!((image.width(), image.height()), (64, 64));
    assert!(image.pixels().iter().filter(|p| p[3] > 0.01).count() > 300, "the wing is seen");
    let json = json(&folder.path().join("made/wing.json"));
    assert_eq!(json["size"], serde_json::json!([64, 64]));
    assert!(json["cells"].as_u64().unwrap() > 50_000 && json["stages"].as_array().unwrap().len() > 2, "{json}");
    assert_eq!(files(folder.path()).len(), 3, "nothing else is written");
}

#[test]
fn a_method_is_named_by_flags_and_told_in_the_report() {
    let folder = folder();
    let flags =
        "--backend gpu --size 20x10 --integrator q --table-precision u8 --interpolation perspective --json m.json";
    let output = run(folder.path(), &["render"].into_iter().chain(flags.split(' ')).collect::<Vec<_>>());
    assert!(output.status.success(), "{}", stderr(&output));
    let text = stdout(&output);
    for part in ["interpolation  perspective", "integrator     q", "table          u8", "2 textures", "cells drawn"] {
        assert!(text.contains(part), "\"{part}\" is not in:\n{text}");
    }
    let json = json(&folder.path().join("m.json"));
    assert_eq!((&json["integrator"], &json["table_precision"]), (&serde_json::json!("q"), &serde_json::json!("u8")));
    assert_eq!(json["resources"]["textures"], 2);
    // What cannot be is told before anything is drawn.
    let refused = ["render", "--integrator", "preint", "--classification", "vertex"];
    assert_fails(&run(folder.path(), &refused), &["preint", "vertex"]);
}

#[test]
fn flags_override_the_scene() {
    let folder = folder();
    let args = ["render", "scene.toml", "--field", "flow", "--backend", "cpu", "--size", "20x10", "--json", "f.json"];
    let output = run(folder.path(), &args);
    assert!(output.status.success(), "{}", stderr(&output));
    let json = json(&folder.path().join("f.json"));
    assert_eq!((&json["size"], &json["backend"]), (&serde_json::json!([20, 10]), &serde_json::json!("cpu")));
    assert!(folder.path().join("out/scene.png").exists());
    assert_fails(
        &run(folder.path(), &["render", "scene.toml", "--field", "cold"]),
        &["\"cold\"", "\"heat\"", "\"flow\""],
    );
    assert_fails(&run(folder.path(), &["render", "scene.toml", "--unit-distance", "0"]), &["--unit-distance", "0"]);
    assert_fails(&run(folder.path(), &["render", "scene.toml", "--backend", "gpu", "--order", "pixel"]), &["pixel"]);
    for bad in [["--size", "64"], ["--backend", "cuda"], ["--split", "7"], ["--nonsense", "1"]] {
        let output = run(folder.path(), &["render", "scene.toml", bad[0], bad[1]]);
        assert_eq!(output.status.code(), Some(2), "{bad:?}");
        assert!(stderr(&output).contains(bad[0]), "{}", stderr(&output));
    }
}

/// An image with something in it.
fn image() -> Image {
    let pixels = (0..12).map(|i| [0.01 * i as f32, 0.5, 0.25, 0.75]).collect();
    Image::from_pixels(4, 3, pixels).unwrap()
}

#[test]
fn two_pictures_are_compared() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    write_exr(&image(), &path("a.exr"), None).unwrap();
    write_exr(&image(), &path("b.exr"), None).unwrap();
    let output = run(folder.path(), &["compare", "a.exr", "b.exr", "--json", "same.json"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert_eq!(json(&path("same.json"))["error"]["max"], 0.0);

    let mut planted = image();
    planted.pixels_mut()[7][2] += 0.125;
    write_exr(&planted, &path("b.exr"), None).unwrap();
    let output = run(folder.path(), &["compare", "a.exr", "b.exr", "--json", "other.json"]);
    assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
    let error = json(&path("other.json"))["error"].clone();
    assert_eq!((&error["max"], &error["worst"]), (&serde_json::json!(0.125), &serde_json::json!([3, 1])));
    assert!(path("out/b-difference.png").exists());
    // The same difference is within a larger budget.
    assert_eq!(run(folder.path(), &["compare", "a.exr", "b.exr", "--max-error", "0.2"]).status.code(), Some(0));

    for (bytes, name) in [(&b""[..], "empty.exr"), (b"\x89PNG not an EXR", "magic.exr")] {
        fs::write(path(name), bytes).unwrap();
        assert_fails(&run(folder.path(), &["compare", "a.exr", name]), &[name]);
    }
    let whole = fs::read(path("a.exr")).unwrap();
    fs::write(path("cut.exr"), &whole[..whole.len() / 2]).unwrap();
    assert_fails(&run(folder.path(), &["compare", "a.exr", "cut.exr"]), &["cut.exr"]);
    write_exr(&Image::new(3, 4).unwrap(), &path("size.exr"), None).unwrap();
    assert_fails(&run(folder.path(), &["compare", "a.exr", "size.exr"]), &["4 x 3", "3 x 4"]);
    assert_fails(&run(folder.path(), &["compare", "a.exr"]), &["a.exr"]);
    let message = assert_fails(&run(folder.path(), &["compare", "a.exr", "none.exr"]), &["none.exr"]);
    assert_eq!(message.matches("os error").count(), 1, "the cause is told once: {message}");
}

#[test]
fn a_scene_is_compared_with_the_reference() {
    let folder = folder();
    let output = run(folder.path(), &["compare", "scene.toml", "--output", "seen", "--json", "e.json"]);
    assert_eq!(output.status.code(), Some(0), "{}{}", stdout(&output), stderr(&output));
    let json = json(&folder.path().join("e.json"));
    assert!(json["error"]["max"].as_f64().unwrap() < 1e-5 && json["error"]["covered"].as_u64().unwrap() > 50, "{json}");
    for name in ["scene.exr", "scene-reference.exr", "scene-difference.png"] {
        assert!(folder.path().join("seen").join(name).exists(), "{name}");
    }
    // No picture in single precision is within a billionth.
    let output = run(folder.path(), &["compare", "scene.toml", "--max-error", "1e-9"]);
    assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
    assert!(stdout(&output).contains("PAST"), "{}", stdout(&output));
}

#[test]
fn broken_meshes_leave_earlier_pictures_alone() {
    let folder = folder();
    let path = |name: &str| folder.path().join(name);
    fs::create_dir(path("out")).unwrap();
    for name in ["out/scene.png", "out/scene.exr", "out/scene.json"] {
        fs::write(path(name), "earlier").unwrap();
    }
    let truncated = &VTU[..VTU.len() / 2];
    for (name, contents) in
        [("cut.vtu", truncated), ("empty.vtu", ""), ("magic.vtu", "OFF\n1 2 3\n"), ("none.vtu", "-")]
    {
        if contents != "-" {
            fs::write(path(name), contents).unwrap();
        }
        let before = files(folder.path());
        for command in ["render", "compare"] {
            let args = [command, "scene.toml", "--mesh", name, "--json", "out/scene.json"];
            assert_fails(&run(folder.path(), &args), &[name]);
        }
        let message = assert_fails(&run(folder.path(), &["info", name, "--json", "out/scene.json"]), &[name]);
        assert!(message.matches("os error").count() <= 1, "the cause is told once: {message}");
        assert_eq!(files(folder.path()), before, "{name}: nothing is written");
        for kept in ["out/scene.png", "out/scene.exr", "out/scene.json"] {
            assert_eq!(fs::read_to_string(path(kept)).unwrap(), "earlier", "{name}: {kept}");
        }
    }
    assert_fails(&run(folder.path(), &["render", "nowhere.toml"]), &["nowhere.toml"]);
    fs::write(path("bad.toml"), "[transfer]\ncolor = 3\n").unwrap();
    assert_fails(&run(folder.path(), &["render", "bad.toml"]), &["bad.toml:2:"]);
}

#[test]
fn a_folder_that_cannot_be_made_is_named() {
    let folder = folder();
    // A file where a folder is needed: not writable for any user.
    fs::write(folder.path().join("file"), "kept").unwrap();
    let output = run(folder.path(), &["render", "scene.toml", "--output", "file/picture.png"]);
    assert_fails(&output, &["file"]);
    let output = run(folder.path(), &["compare", "scene.toml", "--output", "file"]);
    assert_fails(&output, &["file"]);
    assert_eq!(fs::read_to_string(folder.path().join("file")).unwrap(), "kept");
}

#[test]
fn every_command_has_help_with_examples() {
    let folder = tempfile::tempdir().unwrap();
    for command in ["render", "compare", "info", "cache", "order", "bench"] {
        let output = run(folder.path(), &[command, "--help"]);
        assert!(output.status.success());
        let text = stdout(&output);
        assert!(text.contains("Examples:") && text.contains(&format!("cargo xtask {command}")), "{text}");
    }
    let output = run(folder.path(), &["--help"]);
    for command in ["render", "compare", "info", "order", "bench", "test"] {
        assert!(stdout(&output).contains(command), "{command}");
    }
    assert_eq!(run(folder.path(), &[]).status.code(), Some(2));
}

#[test]
fn info_tells_what_a_mesh_holds() {
    let folder = folder();
    let output = run(folder.path(), &["info", "mesh.vtu", "--json", "mesh.json"]);
    assert!(output.status.success(), "{}", stderr(&output));
    for part in ["2 tetrahedra", "\"heat\"", "0 to 4", "\"flow\"", "0 to 5"] {
        assert!(stdout(&output).contains(part), "\"{part}\" is not in:\n{}", stdout(&output));
    }
    let json = json(&folder.path().join("mesh.json"));
    assert_eq!((&json["points"], &json["tetrahedra"]), (&serde_json::json!(5), &serde_json::json!(2)));
    // A corner of the unit cube, 1/6, and the regular tetrahedron behind its face, of volume 1/3.
    assert!((json["volume"].as_f64().unwrap() - 0.5).abs() < 1e-12, "{json}");
    // Eight faces, two of them shared.
    assert_eq!((&json["boundary_faces"], &json["components"]), (&serde_json::json!(6), &serde_json::json!(1)));
    // The corner and the regular tetrahedron behind its face fill a convex body: each angle between them is below 180.
    assert_eq!((&json["ordering"]["convex"], &json["ordering"]["conforming"]), (&true.into(), &true.into()));
    assert_eq!(json["fields"][1]["ranges"][0], serde_json::json!([0.0, 5.0]));
}

#[test]
fn info_tells_what_was_checked_and_what_was_found() {
    let folder = folder();
    // The first tetrahedron inside out, and a point that coincides with another.
    let faulty = VTU.replace("0 1 2 3  1 2 3 4", "1 0 2 3  1 2 3 4").replace("\"5\"", "\"6\"");
    let faulty = faulty.replace("1 1 1\n", "1 1 1  0 0 0\n");
    let faulty = faulty.replace(">0 1 2 3 4<", ">0 1 2 3 4 0<").replace("0 0 0 1</", "0 0 0 1 3 4 0</");
    fs::write(folder.path().join("faulty.vtu"), faulty).unwrap();
    for (name, merged, inverted) in [("mesh.vtu", 0, 0), ("faulty.vtu", 1, 1)] {
        let output = run(folder.path(), &["info", name, "--json", "mesh.json"]);
        assert!(output.status.success(), "{}", stderr(&output));
        let text = stdout(&output);
        let json = json(&folder.path().join("mesh.json"));
        let counts =
            [("merged points", merged), ("inverted cells", inverted), ("flat cells", 0), ("split both ways", 0)];
        for (check, count) in counts {
            let line = text.lines().find(|line| line.starts_with(check)).unwrap();
            assert_eq!(line[check.len()..].split_whitespace().next(), Some(count.to_string().as_str()), "{text}");
            let told = json["checks"].as_array().unwrap().iter().find(|c| c["name"] == check).unwrap();
            assert_eq!(told["count"], count);
        }
        assert_eq!(json["faults"].as_array().unwrap().len(), merged + inverted);
    }
}

#[test]
fn large_meshes_are_kept_listed_and_removed() {
    let folder = tempfile::tempdir().unwrap();
    // 27^3 hexahedra, 118 098 tetrahedra.
    let values: String = (0..28 * 28 * 28).map(|i| format!("{} ", i % 7)).collect();
    let grid = format!(
        "# vtk DataFile Version 3.0\nt\nASCII\nDATASET STRUCTURED_POINTS\nDIMENSIONS 28 28 28\nORIGIN 0 0 0\n\
         SPACING 1 1 1\nPOINT_DATA 21952\nSCALARS f float\nLOOKUP_TABLE default\n{values}\n"
    );
    fs::write(folder.path().join("grid.vtk"), grid).unwrap();
    let info = |args: &[&str], cache: &str| {
        let output = run(folder.path(), &[&["info", "grid.vtk", "--json", "i.json"], args].concat());
        assert!(output.status.success(), "{}", stderr(&output));
        let mut json = json(&folder.path().join("i.json"));
        assert_eq!(json["cache"], cache);
        json["cache"] = serde_json::Value::Null;
        (json, stdout(&output).replace(&format!("mesh cache       {cache}\n"), ""))
    };
    let without = info(&["--no-cache"], "not used");
    assert!(!folder.path().join("cache").exists());
    let (stored, used) = (info(&[], "stored"), info(&[], "used"));
    assert!(stored == without && used == without, "all figures are the same");
    let listing = stdout(&run(folder.path(), &["cache"]));
    assert!(listing.contains("118098") && listing.contains("grid.vtk") && listing.contains("1 meshes"), "{listing}");
    assert!(!listing.contains("stale"), "{listing}");
    fs::write(folder.path().join("grid.vtk"), "another").unwrap();
    assert!(stdout(&run(folder.path(), &["cache"])).contains("stale"));
    assert!(stdout(&run(folder.path(), &["cache", "--clear"])).contains("1 meshes removed"));
    assert!(files(&folder.path().join("cache")).is_empty());
    // A cache that cannot be: said, and rendered all the same.
    let folder = self::folder();
    fs::write(folder.path().join("file"), "kept").unwrap();
    let blocked = folder.path().join("file").join("cache");
    let output = run_with_cache(folder.path(), &blocked, &["render", "scene.toml"]);
    assert!(output.status.success(), "{}", stderr(&output));
    assert_fails(&run_with_cache(folder.path(), &blocked, &["cache"]), &["file", "cannot be listed"]);
}

#[test]
fn flags_that_a_file_has_no_use_for_are_refused() {
    let folder = folder();
    for (flag, value, part) in [
        ("--cell-size", "0.1", "a cell size"),
        ("--expression", "f=x", "a field by an expression"),
        ("--solution", "q.bin", "a solution"),
        ("--time", "0", "time step 0"),
    ] {
        assert_fails(&run(folder.path(), &["info", "mesh.vtu", flag, value]), &[part, "mesh.vtu"]);
        assert_fails(&run(folder.path(), &["render", "scene.toml", flag, value]), &[part, "mesh.vtu"]);
        assert_fails(&run(folder.path(), &["render", flag, value]), &[flag, "no"]);
    }
}

#[test]
fn orders_are_judged() {
    let folder = folder();
    let args = ["order", "--grid", "4", "--views", "2", "--size", "64x64", "--view", "seen/g.png", "--json", "g.json"];
    let output = run(folder.path(), &args);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    for part in ["384 cells", "convex, conforming", "auto used mpvo", "gap arrows", "search"] {
        assert!(stdout(&output).contains(part), "\"{part}\" is not in:\n{}", stdout(&output));
    }
    let judged = json(&folder.path().join("g.json"));
    let method = |name: &str| judged["methods"].as_array().unwrap().iter().find(|m| m["method"] == name).unwrap();
    for name in ["exact", "mpvo", "power", "auto"] {
        assert_eq!((&method(name)["inversions"], &method(name)["max_error"]), (&0.into(), &0.0.into()), "{name}");
    }
    // By index is an order from one side alone, and of two opposite views one is from another.
    let none = method("none");
    assert!(none["inversions"].as_u64().unwrap() > 1000 && none["max_error"].as_f64().unwrap() > 0.01, "{none}");
    assert_eq!(none["rays"], method("exact")["rays"]);
    for name in ["none", "centroid", "exact"] {
        assert!(folder.path().join(format!("seen/g-{name}.png")).exists(), "{name}");
    }

    let output = run(folder.path(), &["order", "scene.toml", "--only", "exact", "--all-pairs", "--rays", "50"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert!(!stdout(&output).contains("centroid"), "{}", stdout(&output));
    assert_eq!(run(folder.path(), &["order", "mesh.vtu"]).status.code(), Some(0));
    assert_fails(&run(folder.path(), &["order", "nowhere.vtu"]), &["nowhere.vtu"]);
    for bad in [["--only", "nearest"], ["--grid", "0"], ["--views", "0"]] {
        let output = run(folder.path(), &["order", bad[0], bad[1]]);
        assert_eq!(output.status.code(), Some(2), "{bad:?}");
        assert!(stderr(&output).contains(bad[1]), "{}", stderr(&output));
    }
}

#[test]
fn tables_are_built_checked_and_distrusted() {
    let folder = TempDir::new().unwrap();
    let built = run(folder.path(), &["build-tables", "--only", "q", "--folder", "tables"]);
    assert!(built.status.success(), "{}", stderr(&built));
    let file = fs::read_dir(folder.path().join("tables"))
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .find(|path| path.extension().is_some_and(|e| e == "exr"))
        .unwrap();
    let checked = run(folder.path(), &["build-tables", "--only", "q", "--folder", "tables", "--check"]);
    assert!(checked.status.success(), "{}{}", stdout(&checked), stderr(&checked));
    // A table cut short is named, with the command that mends it.
    let bytes = fs::read(&file).unwrap();
    fs::write(&file, &bytes[..bytes.len() / 2]).unwrap();
    let damaged = run(folder.path(), &["build-tables", "--only", "q", "--folder", "tables", "--check"]);
    assert!(!damaged.status.success());
    let said = stdout(&damaged) + &stderr(&damaged);
    let name = file.file_name().unwrap().to_string_lossy().into_owned();
    assert!(said.contains(&name) && said.contains("cargo xtask build-tables --only q"), "{said}");
    // Building again replaces it.
    assert!(run(folder.path(), &["build-tables", "--only", "q", "--folder", "tables"]).status.success());
    assert!(run(folder.path(), &["build-tables", "--only", "q", "--folder", "tables", "--check"]).status.success());
    let unknown = run(folder.path(), &["build-tables", "--only", "nonsense", "--folder", "tables"]);
    assert_fails(&unknown, &["nonsense", "psi"]);
}

const WIDGETS: &str = r#"
[mesh]
path = "mesh.vtu"
[field]
name = "heat"
[transfer]
second_field = "flow"
unit_distance = 1.0
[[widget]]
shape = "gaussian"
center = [2.0, 2.0]
sigma = [1.0, 1.0]
max_opacity = 2.0
color = [1.0, 0.5, 0.0]
"#;

#[test]
fn a_histogram_shows_two_fields_and_tells_how_many_bands_they_bear() {
    let folder = folder();
    fs::write(folder.path().join("widgets.toml"), WIDGETS).unwrap();
    let args = ["histogram", "widgets.toml", "--bins", "40x30", "--y-range", "0,4", "--json", "h.json"];
    let output = run(folder.path(), &args);
    assert!(output.status.success(), "{}", stderr(&output));
    // heat spans 0 to 3 in the one cell and 1 to 4 in the other: one band over 3 of a range of 4.
    assert!(stdout(&output).contains("up to 1.333"), "{}", stdout(&output));
    let figures = json(&folder.path().join("h.json"));
    assert_eq!(figures["fields"], serde_json::json!(["heat", "flow"]));
    // 1/6 for the corner of the unit cube, 1/3 for the cell between its far corners.
    let volume = figures["volume"].as_f64().unwrap() + figures["volume_outside"].as_f64().unwrap();
    assert!((volume - 0.5).abs() < 1e-6, "{volume}");
    assert!(figures["volume_outside"].as_f64().unwrap() > 0.0);
    let out = folder.path().join("out");
    assert!(fs::read_to_string(out.join("widgets-histogram.svg")).unwrap().contains("ellipse"));
    assert!(out.join("widgets-histogram.png").exists());
    // Both back ends draw it; a projection that cannot is refused before anything is written.
    for backend in ["cpu", "gpu"] {
        let name = format!("{backend}.png");
        let drawn = run(folder.path(), &["render", "widgets.toml", "--backend", backend, "--output", &name]);
        assert!(drawn.status.success() && folder.path().join(name).exists(), "{}", stderr(&drawn));
    }
    let refused = run(folder.path(), &["render", "widgets.toml", "--projection", "gator", "--output", "refused.png"]);
    assert_fails(&refused, &["use pt, vicp or march"]);
    assert!(!folder.path().join("refused.png").exists());
    // One field is shown over its gradient; impossible ranges are refused.
    let output = run(folder.path(), &["histogram", "scene.toml"]);
    assert!(stdout(&output).contains("gradient magnitude of heat"), "{}", stdout(&output));
    assert_fails(&run(folder.path(), &["histogram", "scene.toml", "--x-range", "2,1"]), &["2 to 1"]);
}

#[test]
fn info_tells_how_many_bands_a_field_bears() {
    let folder = folder();
    let output = run(folder.path(), &["info", "mesh.vtu", "--field", "heat"]);
    let text = stdout(&output);
    assert!(text.contains("up to 1.333") && text.contains("gradient magnitude of heat"), "{text}");
    assert!(!stdout(&run(folder.path(), &["info", "mesh.vtu"])).contains("bands"));
    assert_fails(&run(folder.path(), &["info", "mesh.vtu", "--field", "head"]), &["\"head\""]);
}

#[test]
fn a_second_field_may_be_given_by_flag() {
    let folder = folder();
    let one = run(folder.path(), &["render", "scene.toml", "--output", "one.png"]);
    let two = run(folder.path(), &["render", "scene.toml", "--opacity-field", "flow", "--output", "two.png"]);
    assert!(one.status.success() && two.status.success(), "{}{}", stderr(&one), stderr(&two));
    let [one, two] = ["one.exr", "two.exr"].map(|name| fs::read(folder.path().join(name)).unwrap());
    assert_ne!(one, two, "the opacity is another field's");
    // On a scene that has no use for it the flag is at fault.
    assert_fails(&run(folder.path(), &["render", "scene.toml", "--second-field", "flow"]), &["--opacity-field"]);
    fs::write(folder.path().join("widgets.toml"), WIDGETS).unwrap();
    assert_fails(&run(folder.path(), &["render", "widgets.toml", "--opacity-field", "flow"]), &["--second-field"]);
}

#[test]
fn a_quick_bench_states_time_error_growth_and_targets() {
    let folder = tempfile::tempdir().unwrap();
    let output = run(folder.path(), &["bench", "--quick", "--output", "made"]);
    assert!(output.status.success(), "{}", stderr(&output));
    let made = folder.path().join("made");
    let found = json(&made.join("benchmarks.json"));
    let entries = found["races"][0]["entries"].as_array().unwrap();
    assert!(entries.len() >= 4, "{found}");
    for entry in entries {
        assert!(entry["cost"]["wall_seconds"].as_f64().unwrap() > 0.0, "{entry}");
        assert!(entry["cost"]["stages"].as_array().unwrap().len() > 2, "{entry}");
        assert!(
            entry["error"]["max"].as_f64().is_some() && entry["error"]["covered"].as_u64().unwrap() > 100,
            "{entry}"
        );
    }
    // The plan's own choice keeps to the default budget, and something is on the front.
    assert!(entries[0]["name"] == "default" && entries[0]["error"]["max"].as_f64().unwrap() < 1e-3);
    assert!(entries.iter().any(|entry| entry["on_front"] == true));
    assert_eq!(found["scaling"]["cells"].as_array().unwrap().len(), 2);
    assert!(found["targets"].as_array().unwrap().len() > 20);
    // Every skip: the picture with it and without; pixels change by no more than budgets allow.
    let skips = found["skips"]["rows"].as_array().unwrap();
    assert_eq!(skips.len(), 14);
    for row in skips {
        assert!((5..9).all(|time| row[time].as_f64().unwrap() > 0.0) && row[9].as_f64().unwrap() < 1e-2, "{row}");
    }
    assert_eq!(found["budgets"]["rows"].as_array().unwrap().len(), 4);
    let page = fs::read_to_string(made.join("benchmarks.md")).unwrap();
    for part in [
        "**A quick run**",
        "## Machine",
        "| default",
        "| wgpu, tiles",
        "## Targets",
        "not measured",
        "benchmarks/peak.svg",
        "## Growth",
        "device bytes a cell",
        "## What skipping saves",
        "| `last-order` | box, its second picture |",
        "## What an error budget buys",
    ] {
        assert!(page.contains(part), "\"{part}\" is not in:\n{page}");
    }
    for plot in ["peak", "growth-cells", "growth-pixels", "growth-memory"] {
        let svg = fs::read_to_string(made.join("benchmarks").join(plot).with_extension("svg")).unwrap();
        assert!(svg.starts_with("<svg") && svg.ends_with("</svg>\n"), "{plot}");
    }
    assert_eq!(files(folder.path()).len(), 6, "nothing else is written");
}

#[test]
fn a_paper_is_measured_by_name() {
    let folder = tempfile::tempdir().unwrap();
    let args = "bench --quick --paper moreland-1 --paper moreland-3 --paper moreland-fig5 --output made";
    let output = run(folder.path(), &args.split(' ').collect::<Vec<_>>());
    assert!(output.status.success(), "{}", stderr(&output));
    assert!(stdout(&output).contains("249278"), "theirs is beside ours: {}", stdout(&output));
    let table = json(&folder.path().join("made/paper-moreland-1.json"));
    for row in table["rows"].as_array().unwrap() {
        let [before, after] = [4, 5].map(|column| row[column].as_f64().unwrap());
        assert!(0.0 < before && before < after, "adaptive sampling draws more: {row}");
    }
    let rates = json(&folder.path().join("made/paper-moreland-3.json"));
    let rates = rates["rows"].as_array().unwrap();
    // Three integrators, and two ways of ours that the paper does not have, on three meshes.
    assert_eq!(rates.iter().filter(|row| row[2].is_null()).count(), 6);
    assert!(rates.len() == 15 && rates.iter().all(|row| row[4].as_f64().unwrap() > 0.0), "{rates:?}");
    // Shares of cells, the least first.
    for row in json(&folder.path().join("made/paper-moreland-fig5.json"))["rows"].as_array().unwrap() {
        let [mean, least, most] = [3, 4, 6].map(|column| row[column].as_f64().unwrap());
        assert!(0.0 <= least && least <= mean && mean <= most && most <= 100.0, "{row}");
    }
    let unknown = run(folder.path(), &["bench", "--paper", "moreland-9"]);
    assert_fails(&unknown, &["--paper moreland-9", "moreland-fig9", "kraus-1"]);
    let missing = run(folder.path(), &["bench", "--quick", "--peer", "vtk", "--python", "no-such-python"]);
    assert_fails(&missing, &["no-such-python", "--python"]);
    assert_fails(&run(folder.path(), &["bench", "--data", "no-such-folder"]), &["no-such-folder"]);
}

/// A square across the two tetrahedra.
const OBJ: &str = "v -1 -1 0.25\nv 2 -1 0.25\nv 2 2 0.25\nv -1 2 0.25\nf 1 2 3 4\n";

#[test]
fn surfaces_of_the_scene_and_of_the_command_line_are_shown_and_judged() {
    let folder = folder();
    let file = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    file("square.obj", OBJ);
    file("with.toml", &format!("{SCENE}[[surface]]\npath = \"square.obj\"\n"));
    let by_scene = run(folder.path(), &["compare", "with.toml", "--output", "a", "--backend", "cpu"]);
    assert!(by_scene.status.success(), "{}", stderr(&by_scene));
    let flags = ["compare", "scene.toml", "--surface", "square.obj", "--output", "b", "--backend", "cpu"];
    let by_flag = run(folder.path(), &flags);
    assert!(by_flag.status.success() && stdout(&by_flag).contains("1 of 2 triangles"), "{}", stdout(&by_flag));
    let [a, b] = ["a/with.exr", "b/scene.exr"].map(|path| read_exr(&folder.path().join(path)).unwrap());
    assert_eq!(a, b);
    assert!(a.pixels().iter().filter(|pixel| pixel[3] == 1.0).count() > 100, "the square is seen");

    file("empty.obj", "");
    file("words.obj", "v 1 2\nf 1 1 1\n");
    file("flat.obj", "v 0 0 0\nv 1 0 0\nf 1 2 2\n");
    for (name, part) in
        [("none.obj", "none.obj"), ("empty.obj", "empty"), ("words.obj", "three"), ("flat.obj", "triangle")]
    {
        let output = run(folder.path(), &["render", "scene.toml", "--surface", name]);
        assert_fails(&output, &[name, part]);
    }
    file("bad.toml", &format!("{SCENE}[[surface]]\npath = \"square.obj\"\nscale = -1.0\n"));
    assert_fails(&run(folder.path(), &["render", "bad.toml"]), &["bad.toml:13:", "scale", "-1"]);
}
