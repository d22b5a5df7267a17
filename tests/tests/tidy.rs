//! What must hold of the repository as a whole: licences, the direction of dependencies, the text of its files.
//!
//! Each check is a function over its input that returns the faults it finds, and has a test that plants one. The
//! patterns are spelt in two parts where this file would otherwise match itself.

#![allow(clippy::unwrap_used, reason = "a test stops at its first surprise")]

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::{env, fs};

use serde_json::Value;

/// Which crate must not, by any path of normal or build dependencies, come to know which others.
const FORBIDDEN: &[(&str, &[&str])] = &[
    ("tetlux-mesh", &["tetlux-ingest", "tetlux-optics", "tetlux-scene", "tetlux-render", "wgpu"]),
    ("tetlux-ingest", &["tetlux-optics", "tetlux-scene", "tetlux-render", "wgpu"]),
    ("tetlux-optics", &["tetlux-mesh", "tetlux-render", "wgpu"]),
    ("tetlux-image", &["tetlux-mesh", "tetlux-render", "wgpu"]),
    (
        "tetlux-order",
        &[
            "tetlux-ingest",
            "tetlux-optics",
            "tetlux-image",
            "tetlux-scene",
            "tetlux-shaders",
            "tetlux-render",
            "wgpu",
            "wgpu-types",
            "naga",
        ],
    ),
    // The truth shares no code with what it judges.
    ("tetlux-reference", &["tetlux-tables", "tetlux-order", "tetlux-render", "tetlux-shaders", "wgpu"]),
    ("tetlux-scene", &["tetlux-render", "tetlux-shaders", "wgpu"]),
    ("tetlux-render", &["tetlux-reference", "clap"]),
    ("tetlux-tables", &["tetlux-mesh", "tetlux-order", "tetlux-render", "wgpu"]),
];

/// Largest file of the repository, in bytes: a clone stays small.
const MAX_FILE_BYTES: u64 = 600 * 1024;

/// Marks of unfinished or silenced code.
const UNFINISHED: [&str; 3] = [concat!("to", "do!("), concat!("unimple", "mented!("), concat!("#[ig", "nore")];

/// Roots of paths that exist on one machine only.
const MACHINE_PATHS: [&str; 4] =
    [concat!("/", "home/"), concat!("/", "root/"), concat!("/", "tmp/"), concat!("/", "work/")];

/// A lint exception, in an attribute or within `cfg_attr`.
const LINT_EXCEPTIONS: [&str; 2] = [concat!("allow", "("), concat!("expect", "(")];

#[test]
fn every_licence_is_on_the_list() {
    let policy: toml::Table = fs::read_to_string(root().join("deny.toml")).unwrap().parse().unwrap();
    let allowed: Vec<&str> =
        policy["licenses"]["allow"].as_array().unwrap().iter().map(|id| id.as_str().unwrap()).collect();
    assert_no_faults(licence_faults(&metadata(), &allowed));
}

#[test]
fn cargo_deny_agrees_where_it_is_installed() {
    let cargo = |args: &[&str]| Command::new(cargo_program()).args(args).current_dir(root()).output().unwrap();
    if !cargo(&["deny", "--version"]).status.success() {
        println!("cargo-deny is absent: bans and sources are not checked");
        return;
    }
    let output = cargo(&["deny", "check", "licenses", "bans", "sources"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

#[test]
fn dependencies_point_one_way() {
    assert_no_faults(direction_faults(&metadata(), FORBIDDEN));
}

#[test]
fn no_program_is_built_with_planted_faults() {
    assert_no_faults(planted_faults(&metadata()));
}

#[test]
fn the_reference_uses_no_closed_form() {
    let sources = texts().filter(|(path, _)| path.starts_with("crates/tetlux-reference/") && path.ends_with(".rs"));
    assert_no_faults(sources.flat_map(|(path, text)| closed_form_faults(&path, &text)).collect());
}

#[test]
fn files_are_small() {
    let sizes = files().into_iter().map(|path| {
        let bytes = fs::symlink_metadata(root().join(&path)).unwrap().len();
        (path, bytes)
    });
    assert_no_faults(size_faults(sizes));
}

#[test]
fn code_is_finished_and_every_lint_exception_has_a_reason() {
    let code = texts().filter(|(path, _)| path.ends_with(".rs") || path.ends_with(".wgsl"));
    assert_no_faults(
        code.flat_map(|(path, text)| [unfinished_faults(&path, &text), exception_faults(&path, &text)].concat())
            .collect(),
    );
}

#[test]
fn no_path_of_one_machine_is_named() {
    assert_no_faults(texts().flat_map(|(path, text)| machine_path_faults(&path, &text)).collect());
}

#[test]
fn every_crate_says_what_it_is() {
    let files = files();
    let manifests = files.iter().filter_map(|path| path.strip_suffix("/Cargo.toml"));
    let faults = manifests.filter_map(|folder| {
        let main = ["src/lib.rs", "src/main.rs"].map(|file| format!("{folder}/{file}"));
        let main = main.iter().find(|path| files.contains(*path))?;
        crate_doc_fault(main, &fs::read_to_string(root().join(main)).unwrap())
    });
    assert_no_faults(faults.collect());
}

// The checks.

fn licence_faults(metadata: &Value, allowed: &[&str]) -> Vec<String> {
    let packages = metadata["packages"].as_array().unwrap();
    let fault = |package: &Value| {
        let expression = package["license"].as_str().unwrap_or("no licence");
        let accepted = satisfied(expression, allowed);
        (!accepted).then(|| format!("{} {}: {expression}", package["name"], package["version"]))
    };
    packages.iter().filter_map(fault).collect()
}

/// Whether the licences allowed satisfy an SPDX expression: OR needs one side, AND both, and AND binds tighter. The
/// old "MIT/Apache-2.0" is a choice. "X WITH Y" is a licence of its own name; an expression that is none is refused.
fn satisfied(expression: &str, allowed: &[&str]) -> bool {
    let spaced = expression.replace('(', " ( ").replace(')', " ) ").replace('/', " OR ");
    let tokens: Vec<&str> = spaced.split_whitespace().collect();
    let mut rest = tokens.as_slice();
    any_of(&mut rest, allowed) == Some(true) && rest.is_empty()
}

fn any_of(rest: &mut &[&str], allowed: &[&str]) -> Option<bool> {
    let mut result = all_of(rest, allowed)?;
    while let Some(tail) = rest.strip_prefix(&["OR"]) {
        *rest = tail;
        result |= all_of(rest, allowed)?;
    }
    Some(result)
}

fn all_of(rest: &mut &[&str], allowed: &[&str]) -> Option<bool> {
    let mut result = one(rest, allowed)?;
    while let Some(tail) = rest.strip_prefix(&["AND"]) {
        *rest = tail;
        result &= one(rest, allowed)?;
    }
    Some(result)
}

fn one(rest: &mut &[&str], allowed: &[&str]) -> Option<bool> {
    let (first, tail) = rest.split_first()?;
    *rest = tail;
    match *first {
        "(" => {
            let result = any_of(rest, allowed)?;
            *rest = rest.strip_prefix(&[")"])?;
            Some(result)
        }
        ")" | "OR" | "AND" | "WITH" => None,
        id => match **rest {
            ["WITH", exception, ref tail @ ..] => {
                *rest = tail;
                Some(allowed.contains(&format!("{id} WITH {exception}").as_str()))
            }
            _ => Some(allowed.contains(&id)),
        },
    }
}

fn direction_faults(metadata: &Value, forbidden: &[(&str, &[&str])]) -> Vec<String> {
    let names: BTreeMap<&str, &str> = metadata["packages"]
        .as_array()
        .unwrap()
        .iter()
        .map(|package| (package["id"].as_str().unwrap(), package["name"].as_str().unwrap()))
        .collect();
    let nodes = metadata["resolve"]["nodes"].as_array().unwrap();
    let edges: BTreeMap<&str, Vec<&str>> = nodes
        .iter()
        .map(|node| {
            let kept = node["deps"].as_array().unwrap().iter().filter(|dependency| {
                dependency["dep_kinds"].as_array().unwrap().iter().any(|kind| kind["kind"] != "dev")
            });
            (node["id"].as_str().unwrap(), kept.map(|dependency| dependency["pkg"].as_str().unwrap()).collect())
        })
        .collect();

    let mut faults = Vec::new();
    for (subject, forbidden) in forbidden {
        let Some(start) = names.iter().find_map(|(id, name)| (name == subject).then_some(*id)) else {
            faults.push(format!("{subject} is no package: bring the table up to date"));
            continue;
        };
        let (mut seen, mut stack) = (BTreeSet::from([start]), vec![start]);
        while let Some(id) = stack.pop() {
            stack.extend(edges[id].iter().filter(|next| seen.insert(**next)));
        }
        let known: BTreeSet<&str> = seen.iter().map(|id| names[id]).collect();
        faults.extend(
            forbidden.iter().filter(|name| known.contains(**name)).map(|name| format!("{subject} knows {name}")),
        );
    }
    faults
}

/// Modules of optics that hold integrals, by how their names begin; those of shaders' twins end alike.
const INTEGRALS: [&str; 4] = ["segment", "widget_integral", "emission", "published"];

/// Who may switch on the feature of faults for tests to find: a development dependency, on purpose.
const PLANTED: &str = "planted";

/// Dependencies, and features of other names, that switch it on in what is not a test.
fn planted_faults(metadata: &Value) -> Vec<String> {
    let mut faults = Vec::new();
    for package in metadata["packages"].as_array().unwrap() {
        let name = package["name"].as_str().unwrap();
        for dependency in package["dependencies"].as_array().unwrap() {
            let asks = dependency["features"].as_array().unwrap().iter().any(|feature| feature == PLANTED);
            if asks && dependency["kind"] != "dev" {
                faults.push(format!("{name} depends on {} with {PLANTED}", dependency["name"]));
            }
        }
        for (feature, others) in package["features"].as_object().unwrap() {
            let is_planted = |other: &Value| other.as_str().unwrap().rsplit('/').next() == Some(PLANTED);
            if others.as_array().unwrap().iter().any(is_planted) {
                faults.push(format!("{name}: feature {feature} switches on {PLANTED}"));
            }
        }
    }
    faults
}

/// Uses of optics' integrals: by path, in a group, by glob or under another name.
fn closed_form_faults(path: &str, text: &str) -> Vec<String> {
    let integral = |item: &str| {
        let module = item.split("::").next().unwrap_or_default();
        INTEGRALS.iter().any(|start| module.starts_with(start)) || module.ends_with("_f32")
    };
    let uses = text.match_indices("tetlux_optics").filter(|(at, name)| {
        let after: String = text[at + name.len()..].split(';').next().unwrap_or_default().split_whitespace().collect();
        let group = after.strip_prefix("::{").is_some_and(|group| {
            group.split([',', '{', '}']).any(|item| integral(item) || item == "*" || item.starts_with("self"))
        });
        let path = after.strip_prefix("::").is_some_and(integral);
        group || path || ["::*", "as"].iter().any(|start| after.starts_with(start))
    });
    uses.map(|(at, _)| format!("{}: optics' closed forms", place(path, text, at))).collect()
}

fn size_faults(sizes: impl Iterator<Item = (String, u64)>) -> Vec<String> {
    sizes
        .filter(|(_, bytes)| *bytes > MAX_FILE_BYTES)
        .map(|(path, bytes)| format!("{path}: {bytes} bytes, more than {MAX_FILE_BYTES}"))
        .collect()
}

fn unfinished_faults(path: &str, text: &str) -> Vec<String> {
    let marks = UNFINISHED.iter().flat_map(|mark| text.match_indices(mark));
    marks.map(|(at, mark)| format!("{}: {mark}", place(path, text, at))).collect()
}

/// Machine paths that begin a word: a URL may well have such a part.
fn machine_path_faults(path: &str, text: &str) -> Vec<String> {
    let found = MACHINE_PATHS.iter().flat_map(|start| text.match_indices(start)).filter(|(at, _)| {
        !text[..*at].ends_with(|before: char| before.is_alphanumeric() || matches!(before, '.' | '-' | '_' | '}' | ')'))
    });
    found.map(|(at, start)| format!("{}: {start}", place(path, text, at))).collect()
}

/// Lint exceptions in attributes that give no reason.
fn exception_faults(path: &str, text: &str) -> Vec<String> {
    let mut faults = Vec::new();
    for (start, _) in text.match_indices("#[").chain(text.match_indices("#![")) {
        // Up to the bracket that closes the attribute; those within are balanced.
        let mut depth = 0;
        let end = text[start..].find(|c| {
            depth += i32::from(c == '[') - i32::from(c == ']');
            c == ']' && depth == 0
        });
        let attribute = end.map_or("", |end| &text[start..start + end]);
        let excepts = LINT_EXCEPTIONS
            .iter()
            .any(|word| attribute.match_indices(word).any(|(at, _)| attribute[..at].ends_with(['[', ' ', ',', '('])));
        if excepts && !attribute.contains("reason =") {
            faults.push(format!("{}: a lint exception without a reason", place(path, text, start)));
        }
    }
    faults
}

fn crate_doc_fault(path: &str, text: &str) -> Option<String> {
    (!text.starts_with("//! ")).then(|| format!("{path}: does not begin with the crate's documentation"))
}

// What the checks are given.

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap()
}

fn cargo_program() -> PathBuf {
    env::var_os("CARGO").map_or_else(|| "cargo".into(), PathBuf::from)
}

/// `cargo metadata` of the workspace, without the network where that will do.
fn metadata() -> Value {
    let run = |extra: &[&str]| {
        let mut command = Command::new(cargo_program());
        command
            .args(["metadata", "--format-version", "1", "--locked"])
            .args(extra)
            .current_dir(root())
            .output()
            .unwrap()
    };
    let mut output = run(&["--offline"]);
    if !output.status.success() {
        output = run(&[]);
    }
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

/// Paths of the files that are in the repository or would be added to it, with slashes, relative to the root.
fn files() -> BTreeSet<String> {
    let output = Command::new("git")
        // Whoever owns the clone, as where it is made by another user than the one who tests.
        .args(["-c", "safe.directory=*"])
        .args(["ls-files", "-z", "--cached", "--others", "--exclude-standard"])
        .current_dir(root())
        .output()
        .unwrap();
    assert!(output.status.success(), "git lists the files: {}", String::from_utf8_lossy(&output.stderr));
    let files: BTreeSet<String> = String::from_utf8(output.stdout)
        .unwrap()
        .split_terminator('\0')
        .filter(|path| root().join(path).is_file()) // one that is deleted but not yet committed is still listed
        .map(str::to_owned)
        .collect();
    assert!(files.contains("Cargo.toml"), "an empty list would pass every check");
    files
}

/// The files that are text, with their text.
fn texts() -> impl Iterator<Item = (String, String)> {
    files().into_iter().filter_map(|path| {
        let text = String::from_utf8(fs::read(root().join(&path)).unwrap()).ok()?;
        Some((path, text))
    })
}

fn place(path: &str, text: &str, at: usize) -> String {
    format!("{path}:{}", 1 + text[..at].matches('\n').count())
}

#[track_caller]
fn assert_no_faults(faults: Vec<String>) {
    assert!(faults.is_empty(), "{} faults:\n{}", faults.len(), faults.join("\n"));
}

/// Each check finds the fault that is planted for it, and lets the sound twin pass.
mod planted {
    use serde_json::json;

    use super::*;

    #[test]
    fn licences() {
        let allowed = ["MIT", "Apache-2.0", "Unicode-3.0"];
        for sound in [
            "MIT",
            "MIT OR GPL-3.0-only",
            "LGPL-2.1/MIT",
            "(MIT OR GPL-3.0-only) AND Unicode-3.0",
            "GPL-3.0-only AND ISC OR MIT",
            "Apache-2.0 WITH LLVM-exception OR Apache-2.0",
        ] {
            assert!(satisfied(sound, &allowed), "{sound}");
        }
        for faulty in [
            "GPL-3.0-only",
            "MIT AND GPL-3.0-only",
            "MIT AND (GPL-3.0-only OR ISC)",
            "Apache-2.0 WITH LLVM-exception",
            "(MIT",
            "MIT)",
            "MIT OR",
            "MIT MIT",
            "",
            "no licence",
        ] {
            assert!(!satisfied(faulty, &allowed), "{faulty}");
        }
        let packages = json!({ "packages": [
            { "name": "sound", "version": "1.0.0", "license": "MIT" },
            { "name": "silent", "version": "1.0.0", "license": null },
            { "name": "copyleft", "version": "1.0.0", "license": "AGPL-3.0-only" },
        ]});
        let faults = licence_faults(&packages, &allowed);
        assert_eq!(faults.len(), 2, "{faults:?}");
        assert!(faults[0].contains("silent") && faults[1].contains("copyleft"));
    }

    #[test]
    fn directions() {
        // a -> b -> c, and a -> d in tests only.
        let edge = |to: &str, kind: Value| json!({ "pkg": to, "dep_kinds": [{ "kind": kind }] });
        let package = |name: &str| json!({ "id": name, "name": name });
        let graph = json!({
            "packages": [package("a"), package("b"), package("c"), package("d")],
            "resolve": { "nodes": [
                { "id": "a", "deps": [edge("b", Value::Null), edge("d", json!("dev"))] },
                { "id": "b", "deps": [edge("c", json!("build"))] },
                { "id": "c", "deps": [] },
                { "id": "d", "deps": [] },
            ]},
        });
        assert_eq!(direction_faults(&graph, &[("a", &["d", "x"]), ("c", &["a"])]), [""; 0]);
        assert_eq!(direction_faults(&graph, &[("a", &["b", "c"])]), ["a knows b", "a knows c"]);
        assert_eq!(direction_faults(&graph, &[("gone", &["a"])]).len(), 1);
    }

    #[test]
    fn planted() {
        let metadata = |kind: Value, asked: &[&str], features: Value| {
            let dependency = json!({ "name": "tetlux-render", "kind": kind, "features": asked });
            json!({ "packages": [{ "name": "p", "dependencies": [dependency], "features": features }] })
        };
        let none = || json!({ "planted": [] });
        assert!(planted_faults(&metadata(json!("dev"), &["planted"], none())).is_empty());
        assert!(planted_faults(&metadata(Value::Null, &["other"], none())).is_empty());
        for kind in [Value::Null, json!("build")] {
            assert_eq!(planted_faults(&metadata(kind, &["other", "planted"], none())).len(), 1);
        }
        for features in [json!({ "default": ["planted"] }), json!({ "all": ["x", "tetlux-render/planted"] })] {
            assert_eq!(planted_faults(&metadata(Value::Null, &[], features)).len(), 1);
        }
    }

    #[test]
    fn closed_forms() {
        for sound in [
            "use tetlux_optics::transfer::TransferFunction;",
            "use tetlux_optics::{transfer, preset::{read}}; let segment = 1;",
            "use tetlux_optics::widget::{Shape, Widget};",
        ] {
            assert_eq!(closed_form_faults("a.rs", sound), [""; 0], "{sound}");
        }
        for faulty in [
            "use tetlux_optics::segment::segment;",
            "tetlux_optics :: segment_f32::weights(1.0)",
            "use tetlux_optics::{transfer,\n    segment};",
            "use tetlux_optics::widget_integral::optical_depth;",
            "use tetlux_optics::{transfer, widgets_f32::integrate};",
            "use tetlux_optics::*;",
            "use tetlux_optics as optics;",
        ] {
            assert_eq!(closed_form_faults("a.rs", faulty), ["a.rs:1: optics' closed forms"], "{faulty}");
        }
    }

    #[test]
    fn sizes() {
        let sizes = [("sound", MAX_FILE_BYTES), ("faulty", MAX_FILE_BYTES + 1)];
        let faults = size_faults(sizes.into_iter().map(|(path, bytes)| (path.to_owned(), bytes)));
        assert_eq!(faults.len(), 1);
        assert!(faults[0].starts_with("faulty"));
    }

    #[test]
    fn unfinished_code() {
        assert_eq!(unfinished_faults("a.rs", "let todo = list(); // to do!"), [""; 0]);
        for mark in UNFINISHED {
            let faults = unfinished_faults("a.rs", &format!("fn f() {{\n    {mark}"));
            assert_eq!(faults, [format!("a.rs:2: {mark}")]);
        }
    }

    #[test]
    fn machine_paths() {
        for start in MACHINE_PATHS {
            for sound in ["https://example.org", "..", "${x}"] {
                assert_eq!(machine_path_faults("a.md", &format!("see {sound}{start}x")), [""; 0]);
            }
            for before in ["", "\"", " ", "(", "="] {
                assert_eq!(machine_path_faults("a.md", &format!("{before}{start}x")), [format!("a.md:1: {start}")]);
            }
        }
    }

    #[test]
    fn lint_exceptions() {
        for word in LINT_EXCEPTIONS {
            for sound in [
                format!("#[{word}dead_code, reason = \"why\")]"),
                format!("#![{word}\n    dead_code,\n    reason = \"why [1]\"\n)]"),
                format!("#[cfg_attr(test, {word}dead_code, reason = \"why\"))]"),
                format!("#[test]\nfn f() {{ g.{word}1) }}"),
            ] {
                assert_eq!(exception_faults("a.rs", &sound), [""; 0], "{sound}");
            }
            for faulty in [
                format!("#[{word}dead_code)] // reason"),
                format!("#![{word}\n    dead_code\n)]"),
                format!("#[cfg_attr(test, {word}dead_code))]"),
            ] {
                assert_eq!(exception_faults("a.rs", &faulty).len(), 1, "{faulty}");
            }
        }
    }

    #[test]
    fn crate_docs() {
        assert_eq!(crate_doc_fault("lib.rs", "//! What it is.\n"), None);
        assert!(crate_doc_fault("lib.rs", "mod a;\n//! late\n").is_some());
        assert!(crate_doc_fault("lib.rs", "").is_some());
    }
}
