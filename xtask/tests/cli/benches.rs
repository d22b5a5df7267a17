//! Benchmarks, at small sizes.

use std::fs;

use crate::program::{assert_fails, files, json, run, stderr, stdout};

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
