//! Meshes: what they hold, how they are kept, in what order their cells are seen.

use std::fs;

use crate::program::{VTU, assert_fails, files, folder, json, run, run_with_cache, stderr, stdout};

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
fn info_tells_how_many_bands_a_field_bears() {
    let folder = folder();
    let output = run(folder.path(), &["info", "mesh.vtu", "--field", "heat"]);
    let text = stdout(&output);
    assert!(text.contains("up to 1.333") && text.contains("gradient magnitude of heat"), "{text}");
    assert!(!stdout(&run(folder.path(), &["info", "mesh.vtu"])).contains("bands"));
    assert_fails(&run(folder.path(), &["info", "mesh.vtu", "--field", "head"]), &["\"head\""]);
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
