//! The program, what it is run on, and what it says.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use tempfile::TempDir;

/// Runs the program in a folder.
pub(crate) fn run(folder: &Path, args: &[&str]) -> Output {
    // A cache of its own, in a folder that is not there unless something is stored.
    run_with_cache(folder, &folder.join("cache"), args)
}

pub(crate) fn run_with_cache(folder: &Path, cache: &Path, args: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_xtask"));
    command.args(args).current_dir(folder).env("TETLUX_CACHE_DIR", cache).output().unwrap()
}

/// Runs it by a line of words, and expects it to succeed; gives what it said.
pub(crate) fn succeed(folder: &Path, line: &str) -> String {
    let output = run(folder, &words(line));
    assert!(output.status.success(), "{line}: {}", stderr(&output));
    stdout(&output)
}

/// The same, and expects it to end with status 2 and all parts in what it said.
pub(crate) fn fail(folder: &Path, line: &str, parts: &[&str]) {
    let output = run(folder, &words(line));
    let message = stderr(&output);
    assert_eq!(output.status.code(), Some(2), "{line}: {message}");
    assert!(parts.iter().all(|part| message.contains(part)), "{line}: {parts:?} are not all in: {message}");
}

fn words(line: &str) -> Vec<&str> {
    line.split(' ').collect()
}

pub(crate) fn stdout(output: &Output) -> String {
    String::from_utf8_lossy(&output.stdout).into_owned()
}

pub(crate) fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// Asserts exit status 2 and one line that begins with "error: " and holds all parts; gives it.
pub(crate) fn assert_fails(output: &Output, parts: &[&str]) -> String {
    let message = stderr(output);
    assert_eq!(output.status.code(), Some(2), "{message}");
    assert!(message.starts_with("error: ") && message.lines().count() == 1, "{message}");
    assert!(!message.contains("panicked"), "{message}");
    for part in parts {
        assert!(message.contains(part), "\"{part}\" is not in: {message}");
    }
    message
}

pub(crate) fn json(path: &Path) -> serde_json::Value {
    serde_json::from_slice(&fs::read(path).unwrap()).unwrap()
}

/// Two tetrahedra with a point field and a vector field.
pub(crate) const VTU: &str = r#"<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian">
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

pub(crate) const SCENE: &str = r#"
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

pub(crate) const WIDGETS: &str = r#"
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

/// A folder with `mesh.vtu` and `scene.toml`.
pub(crate) fn folder() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("mesh.vtu"), VTU).unwrap();
    fs::write(folder.path().join("scene.toml"), SCENE).unwrap();
    folder
}

/// Every file below a folder.
pub(crate) fn files(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() { found.extend(files(&path)) } else { found.push(path) }
    }
    found
}
