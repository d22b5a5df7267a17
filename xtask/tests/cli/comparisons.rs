//! Pictures compared with one another and with the reference.

use std::fs;

use tetlux_image::{Image, write_exr};

use crate::program::{assert_fails, folder, json, run, stderr, stdout};

/// An image with something in it.
fn image() -> Image {
    let pixels = (0..12).map(|i| [0.01 * i as f32, 0.5, 0.25, 0.75]).collect();
    Image::from_pixels(4, 3, pixels).unwrap()
}

#[test]
fn two_pictures_are_compared() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    write_exr(&image(), &path("a.exr"), None).unwrap();
    write_exr(&image(), &path("b.exr"), None).unwrap();
    let output = run(folder.path(), &["compare", "a.exr", "b.exr", "--json", "same.json"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert_eq!(json(&path("same.json"))["error"]["max"], 0.0);

    let mut planted = image();
    planted.pixels_mut()[7][2] += 0.125;
    write_exr(&planted, &path("b.exr"), None).unwrap();
    let output = run(folder.path(), &["compare", "a.exr", "b.exr", "--json", "other.json"]);
    assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
    let error = json(&path("other.json"))["error"].clone();
    assert_eq!((&error["max"], &error["worst"]), (&serde_json::json!(0.125), &serde_json::json!([3, 1])));
    assert!(path("out/b-difference.png").exists());
    // The same difference is within a larger budget.
    assert_eq!(run(folder.path(), &["compare", "a.exr", "b.exr", "--max-error", "0.2"]).status.code(), Some(0));

    for (bytes, name) in [(&b""[..], "empty.exr"), (b"\x89PNG not an EXR", "magic.exr")] {
        fs::write(path(name), bytes).unwrap();
        assert_fails(&run(folder.path(), &["compare", "a.exr", name]), &[name]);
    }
    let whole = fs::read(path("a.exr")).unwrap();
    fs::write(path("cut.exr"), &whole[..whole.len() / 2]).unwrap();
    assert_fails(&run(folder.path(), &["compare", "a.exr", "cut.exr"]), &["cut.exr"]);
    write_exr(&Image::new(3, 4).unwrap(), &path("size.exr"), None).unwrap();
    assert_fails(&run(folder.path(), &["compare", "a.exr", "size.exr"]), &["4 x 3", "3 x 4"]);
    assert_fails(&run(folder.path(), &["compare", "a.exr"]), &["a.exr"]);
    let message = assert_fails(&run(folder.path(), &["compare", "a.exr", "none.exr"]), &["none.exr"]);
    assert_eq!(message.matches("os error").count(), 1, "the cause is told once: {message}");
}

#[test]
fn a_scene_is_compared_with_the_reference() {
    let folder = folder();
    let output = run(folder.path(), &["compare", "scene.toml", "--output", "seen", "--json", "e.json"]);
    assert_eq!(output.status.code(), Some(0), "{}{}", stdout(&output), stderr(&output));
    let json = json(&folder.path().join("e.json"));
    assert!(json["error"]["max"].as_f64().unwrap() < 1e-5 && json["error"]["covered"].as_u64().unwrap() > 50, "{json}");
    for name in ["scene.exr", "scene-reference.exr", "scene-difference.png"] {
        assert!(folder.path().join("seen").join(name).exists(), "{name}");
    }
    // No picture in single precision is within a billionth.
    let output = run(folder.path(), &["compare", "scene.toml", "--max-error", "1e-9"]);
    assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
    assert!(stdout(&output).contains("PAST"), "{}", stdout(&output));
}
