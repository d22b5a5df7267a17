//! The suite of stress in its short form, through the program.

#![allow(clippy::unwrap_used, reason = "a test's helpers fail like the test")]

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;

fn run(folder: &Path, args: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_xtask"));
    command.args(args).current_dir(folder).env("TETLUX_CACHE_DIR", folder.join("cache")).output().unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

#[test]
fn every_case_is_drawn_by_every_method_of_ours_as_promised() {
    let folder = tempfile::tempdir().unwrap();
    let output = run(folder.path(), &["stress", "--short", "--only", "matrix", "--output", "out"]);
    assert!(output.status.success(), "{}{}", text(&output.stdout), text(&output.stderr));
    let sections: Value = serde_json::from_slice(&fs::read(folder.path().join("out/stress.json")).unwrap()).unwrap();
    let figures = &sections[0]["figures"];
    let (methods, cases) = (figures["methods"].as_array().unwrap(), figures["cases"].as_array().unwrap());
    // Ours, and published ones of each kind.
    assert!(figures["ours"] == 10 && methods.len() == 15, "{methods:?}");
    let page = fs::read_to_string(folder.path().join("out/stress.md")).unwrap();
    // Those of geometry, one of each kind by name; the list is the program's.
    assert!(cases.len() >= 39, "{} cases", cases.len());
    for name in ["cube", "flat-cells", "huge-mesh", "eye-on-vertex", "view-of-180", "million-in-a-pixel", "deep-stack"]
    {
        assert!(cases.iter().any(|case| case["case"] == name), "{name}");
    }
    for case in cases {
        let name = case["case"].as_str().unwrap();
        assert!(page.contains(&format!("\n| {name} |")), "{name}: not in\n{page}");
        assert_eq!(case["outcomes"].as_array().unwrap().len(), methods.len(), "{name}");
        // A picture of each, but of what no camera sees.
        assert_eq!(folder.path().join(format!("out/cases/{name}.png")).exists(), !case["pixels"].is_null(), "{name}");
    }
    // A camera that cannot be is refused by all, with the reason.
    assert!(page.contains("view angle is 180"), "{page}");
}

#[test]
fn what_is_not_there_is_refused_with_what_is() {
    let folder = tempfile::tempdir().unwrap();
    for (args, there) in [(["--only", "nonsense"], "matrix"), (["--case", "nonsense"], "flat-cells")] {
        let output = run(folder.path(), &[&["stress", "--short"][..], &args].concat());
        assert_eq!(output.status.code(), Some(2));
        let message = text(&output.stderr);
        assert!(message.contains("nonsense") && message.contains(there), "{message}");
    }
}
