//! The parts of `stress` about faults, hostile input and endurance, in their short form.

#![allow(clippy::unwrap_used, reason = "a test's helpers fail like the test")]

use std::fs;
use std::path::Path;
use std::process::Command;

/// Runs a part, and expects that all held; gives its figures.
fn figures(folder: &Path, part: &str) -> serde_json::Value {
    let mut command = Command::new(env!("CARGO_BIN_EXE_xtask"));
    command.args(["stress", "--short", "--only", part, "--output", "made"]);
    // Every thread's share of the allocator keeps some of what it once held: as many on every machine, the driver's too.
    command.env("RAYON_NUM_THREADS", "2").env("LP_NUM_THREADS", "2");
    let output = command.current_dir(folder).env("TETLUX_CACHE_DIR", folder.join("cache")).output().unwrap();
    let said = String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(0), "{said}");
    assert!(fs::read_to_string(folder.join("made/stress.md")).unwrap().contains("| threads |"));
    let mut sections: serde_json::Value =
        serde_json::from_slice(&fs::read(folder.join("made/stress.json")).unwrap()).unwrap();
    assert_eq!(sections.as_array().unwrap().len(), 1, "one part was asked for");
    assert_eq!(sections[0]["failures"], serde_json::json!([]));
    sections[0]["figures"].take()
}

#[test]
fn hostile_input_is_refused_or_read_right() {
    let folder = tempfile::tempdir().unwrap();
    let formats = figures(folder.path(), "hostile")["formats"].take();
    for format in formats.as_array().unwrap() {
        let count = |name: &str| format[name].as_u64().unwrap();
        // Damage that nothing notices is as rare as a file of which damage makes another that is right is common.
        assert!(count("refused") > 20 && count("accepted") > 0, "{format}");
        if cfg!(target_os = "linux") {
            let share = format["memory_share"].as_f64().unwrap();
            assert!(format["memory"].is_u64() && share <= 1.0, "{format}");
        }
    }
    assert_eq!(formats.as_array().unwrap().len(), 16);
}

#[test]
fn faults_leave_nothing_torn_and_nothing_believed() {
    let folder = tempfile::tempdir().unwrap();
    let rows = figures(folder.path(), "faults");
    let times: Vec<u64> = rows.as_array().unwrap().iter().map(|row| row["times"].as_u64().unwrap()).collect();
    assert!(times.len() >= 13 && times.iter().sum::<u64>() > 100, "{rows}");
}

#[test]
fn frames_in_sequence_keep_their_pictures_and_their_memory() {
    let folder = tempfile::tempdir().unwrap();
    let figures = figures(folder.path(), "endurance");
    assert_eq!((&figures["frames"], &figures["different"]), (&serde_json::json!(300), &serde_json::json!(20)));
    for none in ["non_finite_pixels", "other_pictures", "other_device_bytes"] {
        assert_eq!(figures[none], 0, "{none}");
    }
    assert!(!cfg!(target_os = "linux") || figures["resident_bytes"].as_array().unwrap().len() == 300);
}
