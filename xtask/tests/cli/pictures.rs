//! Pictures, and what cannot be one.

use std::fs;

use tetlux_image::read_exr;

use crate::program::{SCENE, VTU, WIDGETS, assert_fails, files, folder, json, run, stderr, stdout};

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
