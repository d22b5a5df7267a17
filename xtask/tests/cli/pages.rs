//! The commands that write pages of measurements, at small sizes.

use std::fs;

use tetlux_image::read_png;

use crate::program::{run, stderr};

/// Figures of a table's row, of one that has numbers alone after its name.
fn figures(page: &str, name: &str) -> Vec<f64> {
    let start = format!("| {name} |");
    let row = page.lines().find(|line| line.starts_with(&start)).unwrap_or_else(|| panic!("{name}: not in\n{page}"));
    row[start.len()..].split(['|', '/']).filter_map(|cell| cell.split_whitespace().next()?.parse().ok()).collect()
}

#[test]
fn a_pair_of_the_test_bed_is_drawn_and_its_errors_told() {
    let folder = tempfile::tempdir().unwrap();
    let output = run(folder.path(), &["testbed", "--side", "48", "--only", "perspective", "--only", "pre-integration"]);
    assert!(output.status.success(), "{}", stderr(&output));
    let page = fs::read_to_string(folder.path().join("docs/testbed.md")).unwrap();
    for (name, artifact, cure) in
        [("perspective", "screen-linear", "perspective"), ("pre-integration", "average", "psi")]
    {
        assert!(page.contains(&format!("(testbed/{name}.png)")), "{page}");
        let picture = read_png(&folder.path().join(format!("docs/testbed/{name}.png"))).unwrap();
        // Two halves of 48 and a gap.
        assert!((97..120).contains(&picture.width()) && picture.width() == picture.height());
        // What the artifact loses, the cure does not.
        let ([before, ..], [after, ..]) = (&figures(&page, artifact)[..], &figures(&page, cure)[..]) else {
            panic!("{page}")
        };
        assert!(*before > 0.05 && *after < 1e-3, "{name}: {before}, {after}");
    }
    let unknown = run(folder.path(), &["testbed", "--only", "nonsense"]);
    assert_eq!(unknown.status.code(), Some(2));
    assert!(stderr(&unknown).contains("nonsense") && stderr(&unknown).contains("perspective"), "{}", stderr(&unknown));
}

#[test]
fn methods_are_measured_into_a_page() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("page.md");
    let args = ["methods", "--markdown", "page.md", "--size", "32x32", "--only", "q", "--only", "vertex"];
    let missing = run(folder.path(), &args);
    assert_eq!(missing.status.code(), Some(2));
    assert!(stderr(&missing).contains("page.md"), "{}", stderr(&missing));
    let marks = ["<!-- begin: cargo xtask methods -->", "<!-- end: cargo xtask methods -->"];
    fs::write(&path, format!("head\n{}\n{}\nfoot\n", marks[0], marks[1])).unwrap();
    let output = run(folder.path(), &args);
    assert!(output.status.success(), "{}", stderr(&output));
    let page = fs::read_to_string(&path).unwrap();
    assert!(page.starts_with("head\n") && page.ends_with("\nfoot\n"), "{page}");
    // Three scenes; largest error, mean and time of each.
    let (q, vertex) = (figures(&page, "`q`"), figures(&page, "`vertex`"));
    assert_eq!((q.len(), vertex.len()), (9, 9), "{page}");
    // The last scene's peak lies within cells: classified at vertices it is lost.
    assert!(q[6] < 1e-4 && vertex[6] > 0.1, "{page}");
}
