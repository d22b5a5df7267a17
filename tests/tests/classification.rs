//! Scenes that classify by two fields, and light: what is read, what is refused, and where gradients are computed.

#![allow(clippy::unwrap_used, reason = "a test's helpers fail like the test")]

use std::fs;

use glam::DVec3;
use tetlux_image::{Image, write_exr};
use tetlux_mesh::procedural::{Split, cuboid};
use tetlux_mesh::{Field, TetMesh};
use tetlux_optics::Classification;
use tetlux_optics::widget::{Shape, WaveProfile};
use tetlux_scene::{Plan, Scene, SceneFile};

const FIELD: &str = "[field]\nname = \"heat\"\n";
const NODES: &str = "color = [[0.0, 0.0, 0.0, 0.0], [1.0, 1.0, 1.0, 1.0]]\nopacity = [[0.0, 0.0], [1.0, 2.0]]\n";

/// heat = 2 x, flow = (y, 0, 0), on a unit cube.
fn mesh() -> TetMesh {
    let parts = cuboid([2, 2, 2], Split::Six, [DVec3::ZERO, DVec3::ONE]);
    let flow = parts.points.iter().flat_map(|p| [3.0 * p.y, 0.0, 0.0]).collect();
    let fields = vec![Field::point("heat", 1, parts.sample(|p| 2.0 * p.x)), Field::point("flow", 3, flow)];
    TetMesh::assemble(&parts.points, &parts.cells, fields).unwrap()
}

fn scene(text: &str) -> Scene {
    SceneFile::parse("a.toml", &format!("{FIELD}{text}")).unwrap().scene(&mesh(), 0).unwrap()
}

#[track_caller]
fn refused(text: &str, parts: &[&str]) {
    let message = match SceneFile::parse("a.toml", &format!("{FIELD}{text}")) {
        Ok(_) => panic!("accepted:\n{text}"),
        Err(error) => error.to_string(),
    };
    assert!(!message.contains('\n'), "one line: {message}");
    for part in parts {
        assert!(message.contains(part), "\"{part}\" is not in: {message}");
    }
}

#[test]
fn one_field_computes_no_gradient() {
    let one = scene(&format!("[transfer]\n{NODES}"));
    assert!(matches!(one.classification, Classification::OneField(_)));
    assert!(one.second.is_none() && one.lighting.is_none());
    // Two fields of the file need none either.
    let two = scene(&format!("[transfer]\n{NODES}opacity_field = \"flow\"\n"));
    assert!(matches!(two.classification, Classification::TwoFields(_)));
    assert!(two.lighting.is_none());
    assert_eq!(two.second.map(|s| (s.name, s.range)), Some(("flow".into(), [0.0, 3.0])));
    // Light does.
    let lit = scene(&format!("[transfer]\n{NODES}[light]\nsilhouette = 2.0\n"));
    let lighting = lit.lighting.unwrap();
    assert_eq!(lighting.light.silhouette(), 2.0);
    assert!(!lighting.light.shades(), "a silhouette alone leaves the luminance");
    assert!(lighting.gradients.iter().all(|g| (*g - DVec3::new(2.0, 0.0, 0.0)).length() < 1e-6));
}

#[test]
fn nodes_that_fit_span_each_its_own_field() {
    let two =
        scene(&format!("[transfer]\n{NODES}opacity_field = \"flow\"\nopacity_component = 0\nfit_to_field = true\n"));
    let Classification::TwoFields(nodes) = two.classification else { panic!("two fields") };
    assert_eq!(nodes.color_nodes().last().unwrap().s, 2.0);
    assert_eq!(nodes.opacity_nodes().last().unwrap().s, 3.0);
}

const GAUSSIAN: &str = "[[widget]]\nshape = \"gaussian\"\ncolor = [1.0, 0.5, 0.0]\nmax_opacity = 4.0\ncenter = [0.5, 0.25]\nsigma = [0.1, 0.2]\n";

#[test]
fn widgets_lie_over_the_gradient_unless_a_second_field_is_named() {
    let over_gradient = scene(&format!("[transfer]\n{GAUSSIAN}"));
    let second = over_gradient.second.unwrap();
    assert!(second.name.contains("gradient magnitude of heat"));
    assert!(second.values.iter().all(|g| (g - 2.0).abs() < 1e-6));
    assert!(over_gradient.lighting.is_none(), "the gradients themselves are not kept");
    let over_flow = scene(&format!("[transfer]\nsecond_field = \"flow\"\nsecond_component = 0\n{GAUSSIAN}"));
    assert_eq!(over_flow.second.unwrap().range, [0.0, 3.0]);
    assert_eq!(over_flow.classification.opacity([0.5, 0.25]), 4.0);
    // Fitted: the middle of heat's range of 0 to 2 and a quarter of flow's of 0 to 3.
    let fitted = scene(&format!("[transfer]\nsecond_field = \"flow\"\nfit_to_field = true\n{GAUSSIAN}"));
    let Classification::Widgets(function) = fitted.classification else { panic!("widgets") };
    assert_eq!(function.widgets[0].shape(), &Shape::Gaussian { center: [1.0, 0.75], sigma: [0.2, 0.6000000000000001] });
}

#[test]
fn every_shape_has_a_name_and_peaks_are_counted() {
    let wave = |shape: &str, rest: &str| {
        let text =
            format!("[transfer]\n[[widget]]\nshape = \"{shape}\"\ncolor = [1.0, 1.0, 1.0]\nmax_opacity = 1.0\n{rest}");
        let Classification::Widgets(function) = scene(&text).classification else { panic!("widgets") };
        function.widgets[0]
    };
    let three = wave("triangle", "x = [1.0, 2.0]\npeaks = 3\n");
    for k in 0..3 {
        let peak = 1.0 + (f64::from(k) + 0.5) / 3.0;
        assert!((three.opacity([peak, 7.0]) - 1.0).abs() < 1e-12, "peak {k}");
        assert!(three.opacity([1.0 + f64::from(k) / 3.0, 7.0]) < 1e-12, "zero {k}");
    }
    assert_eq!(three.opacity([0.5, 7.0]), 0.0, "outside");
    let along_y = wave("sine", "y = [0.0, 2.0]\npeaks = 1\nalong = \"y\"\n");
    assert!((along_y.opacity([9.0, 1.0]) - 1.0).abs() < 1e-15);
    let plain = wave("sine-squared", "frequency = [0.5, 0.25]\noffset = 0.125\n");
    let profile = WaveProfile::SineSquared;
    assert_eq!(plain.shape(), &Shape::Wave { profile, frequency: [0.5, 0.25], offset: 0.125 });
    assert_eq!(wave("uniform", "x = [0.0, 1.0]\ny = [0.0, 1.0]\n").opacity([1.0, 0.5]), 1.0);
}

#[test]
fn impossible_widgets_are_named_with_key_and_line() {
    let head = "[transfer]\n[[widget]]\nshape = \"gaussian\"\ncolor = [1.0, 1.0, 1.0]\nmax_opacity = 1.0\n";
    // The first line of what is appended is line 8.
    for (rest, line, key) in [
        ("center = [0.0, 0.0]\nsigma = [0.0, 1.0]", 9, "sigma"),
        ("center = [nan, 0.0]\nsigma = [1.0, 1.0]", 8, "center"),
        ("center = [0.0, 0.0]", 4, "sigma"),
        ("center = [0.0, 0.0]\nsigma = [1.0, 1.0]\nx = [1.0, 1.0]", 10, "x"),
        ("center = [0.0, 0.0]\nsigma = [1.0, 1.0]\ny = [2.0, 1.0]", 10, "y"),
        ("center = [0.0, 0.0]\nsigma = [1.0, 1.0]\nfrequency = [1.0, 1.0]", 10, "frequency"),
        ("center = [0.0, 0.0]\nsigma = [1.0, 1.0]\npeaks = 3", 10, "peaks"),
        ("center = [0.0, 0.0]\nsigma = [1.0, 1.0]\noffset = 3", 10, "offset"),
        ("center = [0.0, 0.0]\nsigma = [1.0, 1.0]\nalong = \"x\"", 10, "along"),
        ("centre = [0.0, 0.0]", 8, "centre"),
    ] {
        refused(&format!("{head}{rest}\n"), &[&format!("a.toml:{line}:"), key]);
    }
    let with = |shape: &str, rest: &str| {
        format!("[transfer]\n[[widget]]\nshape = \"{shape}\"\ncolor = [1.0, 1.0, 1.0]\nmax_opacity = 1.0\n{rest}\n")
    };
    refused(&with("uniform", "center = [0.0, 0.0]"), &["a.toml:8:", "center"]);
    refused(&with("uniform", "sigma = [0.0, 0.0]"), &["a.toml:8:", "sigma"]);
    refused(&with("round", ""), &["a.toml:5:", "round", "gaussian"]);
    refused(&with("sine", ""), &["a.toml:4:", "frequency"]);
    refused(&with("sine", "frequency = [0.0, 0.0]"), &["a.toml:8:", "frequency"]);
    refused(&with("sine", "frequency = [1.0, 0.0]\noffset = inf"), &["a.toml:9:", "offset"]);
    refused(&with("sine", "frequency = [1.0, 0.0]\npeaks = 2"), &["a.toml:9:", "peaks"]);
    refused(&with("sine", "peaks = 2"), &["a.toml:8:", "peaks", "x ="]);
    refused(&with("sine", "peaks = 0\nx = [0.0, 1.0]"), &["a.toml:8:", "peaks"]);
    refused(&with("sine", "peaks = 1\nx = [1.0, 1.0]"), &["a.toml:9:", "x"]);
    for (key, line, bad) in [("color", 6, "[1.0, -1.0, 1.0]"), ("max_opacity", 7, "nan"), ("max_opacity", 7, "-1.0")] {
        let good = with("uniform", "");
        let text: Vec<String> =
            good.lines().map(|l| if l.starts_with(key) { format!("{key} = {bad}") } else { l.into() }).collect();
        refused(&text.join("\n"), &[&format!("a.toml:{line}:"), key]);
    }
}

#[test]
fn combinations_that_cannot_be_are_refused() {
    let image = "image = \"tf.exr\"\n";
    for (text, line, word) in [
        (format!("[transfer]\n{NODES}{GAUSSIAN}"), 3, "keep one"),
        (format!("[transfer]\n{NODES}{image}"), 3, "keep one"),
        (format!("[transfer]\n{image}{GAUSSIAN}"), 3, "keep one"),
        (format!("[transfer]\nopacity_field = \"flow\"\n{GAUSSIAN}"), 4, "second_field"),
        (format!("[transfer]\n{NODES}second_field = \"flow\"\n"), 6, "opacity_field"),
        (format!("[transfer]\n{NODES}opacity_component = 1\n"), 6, "opacity_component"),
        (format!("[transfer]\nsecond_component = 1\n{GAUSSIAN}"), 4, "second_component"),
        (format!("[transfer]\n{NODES}opacity_field = \"flow\"\nrange = [0.0, 1.0]\n"), 6, "opacity_field"),
        (format!("[transfer]\nrange = [0.0, 1.0]\n{GAUSSIAN}"), 4, "range"),
        (format!("[transfer]\nmax_opacity = 1.0\n{GAUSSIAN}"), 4, "max_opacity"),
        (format!("[transfer]\n{NODES}max_opacity = 1.0\n"), 6, "max_opacity"),
        (format!("[transfer]\n{NODES}image_range = [[0.0, 1.0], [0.0, 1.0]]\n"), 6, "image_range"),
        (format!("[transfer]\n{image}image_range = [[0.0, 1.0], [1.0, 1.0]]\n"), 5, "image_range"),
        (format!("[transfer]\n{image}fit_to_field = true\nimage_range = [[0.0, 1.0], [0.0, 1.0]]\n"), 6, "image_range"),
        (format!("[transfer]\n{image}range = [0.0, 1.0]\n"), 5, "range"),
        (format!("[transfer]\n{image}max_opacity = 0.0\n"), 5, "max_opacity"),
    ] {
        refused(&text, &[&format!("a.toml:{line}:"), word]);
    }
    for (key, bad) in [
        ("direction", "[0.0, 0.0, 0.0]"),
        ("ambient", "-1.0"),
        ("diffuse", "nan"),
        ("specular", "inf"),
        ("shininess", "-2.0"),
        ("silhouette", "-2.0"),
    ] {
        refused(&format!("[transfer]\n{NODES}[light]\n{key} = {bad}\n"), &["a.toml:7:", key]);
    }
}

#[test]
fn an_image_spans_the_fields_and_has_its_top_row_at_the_upper_end() {
    let folder = tempfile::tempdir().unwrap();
    let pixels = vec![[1.0, 0.0, 0.0, 0.5], [1.0, 0.0, 0.0, 0.5], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 1.0, 1.0]];
    write_exr(&Image::from_pixels(2, 2, pixels).unwrap(), &folder.path().join("tf.exr"), None).unwrap();
    let path = folder.path().join("scene.toml");
    fs::write(
        &path,
        format!(
            "{FIELD}[transfer]\nimage = \"tf.exr\"\nsecond_field = \"flow\"\nmax_opacity = 8.0\nunit_distance = 1.0"
        ),
    )
    .unwrap();
    let scene = SceneFile::read(&path).unwrap().scene(&mesh(), 0).unwrap();
    // heat 2, flow 0: the lower right texel; flow 3: the upper row.
    assert_eq!((scene.classification.opacity([2.0, 0.0]), scene.classification.opacity([0.0, 0.0])), (8.0, 0.0));
    assert_eq!(
        (scene.classification.opacity([1.0, 3.0]), scene.classification.luminance([1.0, 3.0])),
        (4.0, [1.0, 0.0, 0.0])
    );
    fs::remove_file(folder.path().join("tf.exr")).unwrap();
    let error = SceneFile::read(&path).unwrap().scene(&mesh(), 0).unwrap_err().to_string();
    assert!(error.contains("tf.exr"), "{error}");
}

#[test]
fn both_back_ends_draw_two_fields_and_light_and_the_plan_says_what_gradients_are_for() {
    let mesh = mesh();
    let says = |text: &str| Plan::new(&scene(text), &mesh, None).unwrap().to_string();
    let one = says(&format!("[transfer]\n{NODES}"));
    assert!(one.contains("skipped: nothing asks for them"), "{one}");
    let widgets = says(&format!("[transfer]\n{GAUSSIAN}"));
    assert!(widgets.contains("cpu: ") && widgets.contains("magnitude is the second scalar"), "{widgets}");
    let lit = says(&format!("[transfer]\n{NODES}[light]\n"));
    assert!(lit.contains("for normals"), "{lit}");
    let hardware = tetlux_scene::Device {
        name: "adapter".into(),
        driver: "1.2".into(),
        software: false,
        blends_f32: true,
        norm16: false,
        costs: None,
    };
    for text in [format!("[transfer]\n{GAUSSIAN}"), format!("[transfer]\n{NODES}[light]\n")] {
        let plan = Plan::new(&scene(&text), &mesh, Some(&hardware)).unwrap();
        assert_eq!(plan.backend, tetlux_scene::Backend::Gpu, "{plan}");
    }
}
