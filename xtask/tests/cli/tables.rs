//! Tables and histograms.

use std::fs;

use crate::program::{WIDGETS, assert_fails, folder, json, run, stderr, stdout};

#[test]
fn tables_are_built_checked_and_distrusted() {
    let folder = tempfile::tempdir().unwrap();
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
