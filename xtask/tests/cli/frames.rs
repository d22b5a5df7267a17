//! Sequences of frames, and the plan explained, as a user runs them.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use tempfile::TempDir;

use crate::program::{SCENE, VTU, fail, json, succeed};

/// The two tetrahedra, with the heat of the last point and its height.
fn vtu(heat: f64, height: f64) -> String {
    let mesh = VTU.replace(">0 1 2 3 4<", &format!(">0 1 2 3 {heat}<"));
    mesh.replace("1 1 1\n", &format!("1 1 {height}\n"))
}

/// Three steps, of which the third has other points, a collection of them, and a scene.
fn folder() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let mut listed = String::new();
    for (step, (heat, height)) in [(4.0, 1.0), (0.5, 1.0), (2.0, 1.5)].into_iter().enumerate() {
        fs::write(folder.path().join(format!("step-{step}.vtu")), vtu(heat, height)).unwrap();
        write!(listed, r#"<DataSet timestep="{step}" file="step-{step}.vtu"/>"#).unwrap();
    }
    let collection = format!(r#"<VTKFile type="Collection" version="0.1"><Collection>{listed}</Collection></VTKFile>"#);
    fs::write(folder.path().join("steps.pvd"), collection).unwrap();
    // Of no mesh: each command names its own.
    fs::write(folder.path().join("scene.toml"), SCENE.replace("[mesh]\npath = \"mesh.vtu\"\n", "")).unwrap();
    folder
}

fn pixels(folder: &Path, name: &str) -> Vec<u32> {
    let image = tetlux_image::read_exr(&folder.join(name)).unwrap();
    image.pixels().iter().flatten().map(|c| c.to_bits()).collect()
}

#[test]
fn an_orbit_is_numbered_and_each_frame_is_that_rendered_alone() {
    let folder = folder();
    let folder = folder.path();
    for backend in ["cpu", "gpu"] {
        let orbit = format!("render scene.toml --mesh step-0.vtu --backend {backend} --orbit 4");
        let text = succeed(folder, &format!("{orbit} --output {backend}/turn.png --json {backend}.json"));
        assert!(text.contains("4 of 4 frames") && text.contains("turn-0001.png"), "{text}");
        let alone = format!("render scene.toml --mesh step-0.vtu --backend {backend} --output {backend}/alone.png");
        succeed(folder, &alone);
        assert_eq!(
            pixels(folder, &format!("{backend}/turn-0001.exr")),
            pixels(folder, &format!("{backend}/alone.exr"))
        );
        succeed(folder, &format!("{orbit} --frame 3 --output {backend}/one.png"));
        let third = pixels(folder, &format!("{backend}/turn-0003.exr"));
        assert_eq!(third, pixels(folder, &format!("{backend}/one-0003.exr")));
        assert_ne!(third, pixels(folder, &format!("{backend}/turn-0001.exr")), "the eye moves");
        assert!(folder.join(format!("{backend}/turn-0004.png")).exists());
        let report = json(&folder.join(format!("{backend}.json")));
        let frames = report["frames"].as_array().unwrap();
        assert_eq!(frames.len(), 4);
        assert_eq!(frames[3]["turned"], 270.0);
        assert!(report["frames_per_second"].as_f64().unwrap() > 0.0);
        assert!(frames.iter().all(|f| !f["stages"].as_array().unwrap().is_empty() && f["stated_error"].is_f64()));
        assert!(frames.iter().any(|f| f["mesh_reused"] == true), "the mesh stays");
    }
}

#[test]
fn a_sequence_draws_by_what_the_adapter_takes_as_a_picture_alone_does() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    // Large enough that the plan asks what the adapter takes.
    let scene = "render --grid 10 --size 640x640 --backend gpu";
    succeed(folder, &format!("{scene} --orbit 5 --frame 1 --output turn.png --json turn.json"));
    assert!(folder.join("cache/adapter-costs.json").exists(), "measured for the sequence");
    succeed(folder, &format!("{scene} --output alone.png --json alone.json"));
    let [turn, alone] = ["turn.json", "alone.json"].map(|name| json(&folder.join(name)));
    let why = |report: &serde_json::Value| {
        let plan = report["plan"].as_array().unwrap();
        plan.iter().find(|line| line[0] == "projection").unwrap()[1].as_str().unwrap().to_owned()
    };
    assert!(why(&turn).contains("was measured to take"), "{}", why(&turn));
    assert_eq!(why(&turn), why(&alone));
    assert_eq!(pixels(folder, "turn-0001.exr"), pixels(folder, "alone.exr"));
}

#[test]
fn time_steps_and_files_become_frames() {
    let folder = folder();
    let folder = folder.path();
    succeed(folder, "render scene.toml --mesh steps.pvd --times --output t.png --json t.json");
    succeed(folder, "render scene.toml --series step-0.vtu step-1.vtu step-2.vtu --output s.png --json s.json");
    let frames: Vec<_> = (1..=3).map(|k| pixels(folder, &format!("t-000{k}.exr"))).collect();
    assert!(frames[0] != frames[1] && frames[1] != frames[2]);
    for (k, frame) in frames.iter().enumerate() {
        assert_eq!(*frame, pixels(folder, &format!("s-000{}.exr", k + 1)), "frame {}", k + 1);
    }
    // The first two have one camera, unit distance and function with the scene itself.
    succeed(folder, "render scene.toml --mesh step-0.vtu --output alone.png");
    assert_eq!(frames[0], pixels(folder, "alone.exr"));
    let report = json(&folder.join("t.json"));
    assert_eq!(report["frames"][2]["time_step"], 2);
    let report = json(&folder.join("s.json"));
    assert_eq!(report["frames"][2]["mesh"], "step-2.vtu");
    succeed(folder, "render scene.toml --mesh steps.pvd --times --frame 2 --output second.png");
    assert_eq!(frames[1], pixels(folder, "second-0002.exr"));
}

#[test]
fn a_sequence_that_cannot_be_is_refused() {
    let folder = folder();
    let folder = folder.path();
    fail(folder, "render scene.toml --mesh step-0.vtu --times", &["step-0.vtu", "time steps"]);
    fail(folder, "render --times", &["--times", "mesh file"]);
    fail(folder, "render --frame 2", &["--frame", "--orbit N"]);
    fail(folder, "render scene.toml --mesh step-0.vtu --orbit 3 --frame 4", &["--frame 4", "3 frames"]);
    fail(folder, "render scene.toml --mesh step-0.vtu --orbit 3 --explain", &["--explain"]);
}

#[test]
fn a_frame_that_fails_leaves_the_earlier_ones() {
    let folder = folder();
    let folder = folder.path();
    fs::write(folder.join("step-1.vtu"), "not a mesh").unwrap();
    let series = "render scene.toml --series step-0.vtu step-1.vtu step-2.vtu --output s.png --json s.json";
    fail(folder, series, &["frame 2", "step-1.vtu"]);
    assert!(folder.join("s-0001.png").exists() && folder.join("s-0001.exr").exists());
    assert!(!folder.join("s-0002.png").exists());
    assert_eq!(json(&folder.join("s.json"))["frames"].as_array().unwrap().len(), 1);
}

#[test]
fn the_plan_is_explained_and_measured() {
    let folder = folder();
    let folder = folder.path();
    let text = succeed(folder, "render scene.toml --mesh step-0.vtu --backend cpu --explain --json e.json");
    for part in ["skip", "transparent", "last-order", "gradients", "measured by rendering without each", "error"] {
        assert!(text.contains(part), "\"{part}\" is not in:\n{text}");
    }
    let report = json(&folder.join("e.json"));
    let skips = report["skips"].as_array().unwrap();
    let named = |name: &str| skips.iter().find(|s| s["skip"] == name).unwrap();
    assert_eq!(skips.len(), 14);
    assert_eq!(named("gradients")["fate"], "skipped");
    assert_eq!(named("gradients")["bytes"], 5 * 24);
    assert_eq!(named("gradients")["difference"], 0.0);
    assert!(named("gradients")["cpu_ms"][0].is_f64());
    assert_eq!(named("transparent")["fate"], "done");
    assert!(report["stated_error"].as_f64().unwrap() < 1e-3);
    // What is switched off is told, and the picture stays.
    let text =
        succeed(folder, "render scene.toml --mesh step-0.vtu --no-skip cuts --no-skip weights --explain -o k.png");
    assert!(text.contains("cuts         kept") && text.contains("weights      kept"), "{text}");
    fail(folder, "render scene.toml --mesh step-0.vtu --no-skip nothing", &["nothing", "last-order"]);
}

#[test]
fn a_comparison_states_and_measures() {
    let folder = folder();
    let folder = folder.path();
    let text = succeed(folder, "compare scene.toml --mesh step-0.vtu --max-error 1e-2 --json c.json");
    assert!(text.contains("stated") && text.contains("within the error budget"), "{text}");
    let report = json(&folder.join("c.json"));
    let (stated, measured) = (report["stated_error"].as_f64().unwrap(), report["error"]["max"].as_f64().unwrap());
    assert!(measured <= stated && stated <= 1e-2, "{measured:e} {stated:e}");
    // A budget beyond single precision cannot be kept, and is warned of.
    let text = succeed(folder, "render scene.toml --mesh step-0.vtu --max-error 1e-9");
    assert!(text.contains("error budget of 1.0e-9") && text.contains("single precision"), "{text}");
}
