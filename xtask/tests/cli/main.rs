//! The program as a user runs it: what it writes, what it says, and how it ends.

#![allow(clippy::unwrap_used, reason = "a test's helpers fail like the test")]

mod benches;
mod comparisons;
mod frames;
mod meshes;
mod pages;
mod pictures;
mod program;
mod tables;

use program::{run, stdout};

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
