//! Scene files: what is wrong is told with its line and its remedy, what is not said has a default.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test's helpers fail and tell like the test")]

use std::fs;
use std::path::Path;

use glam::DVec3;
use tetlux_mesh::procedural::{Split, cuboid};
use tetlux_mesh::{Field, TetMesh};
use tetlux_optics::NoData;
use tetlux_optics::emphasis::{Boundary, Contour, Emphasis, Steepness};
use tetlux_scene::{
    Backend, CellProjection, Classification, Integrator, Interpolation, Method, Order, Projection, SceneFile,
    SurfaceSpec, TablePrecision, Target, UnitDistance,
};

const TRANSFER: &str = "[transfer]\ncolor = [[0.0, 1.0, 1.0, 1.0]]\nopacity = [[0.0, 1.0]]\n";

/// What the parser says to a text that is wrong.
fn error(text: &str) -> String {
    SceneFile::parse("a.toml", text).map(|_| panic!("accepted:\n{text}")).unwrap_or_else(|e| e.to_string())
}

/// A scene of the usual transfer function with more after it: that begins in line 4.
fn error_after(rest: &str) -> String {
    error(&format!("{TRANSFER}{rest}"))
}

fn assert_says(message: &str, parts: &[&str]) {
    assert!(!message.contains('\n'), "one line: {message}");
    for part in parts {
        assert!(message.contains(part), "\"{part}\" is not in: {message}");
    }
}

#[test]
fn unknown_keys_are_named_with_their_line() {
    assert_says(&error_after("[image]\nsizes = [10, 10]"), &["a.toml:5:", "sizes", "size"]);
    assert_says(&error_after("[[camera]]\n\nview_angel = 30.0"), &["a.toml:6:", "view_angel", "view_angle"]);
    assert_says(&error_after("[light]\ncolor = 1"), &["a.toml:5:", "color", "ambient"]);
    assert_says(&error("[transfer]\ncolours = []"), &["a.toml:2:", "colours"]);
    assert_says(&error_after("[emphasis]\nedges = {}"), &["a.toml:5:", "edges", "boundary"]);
    assert_says(&error_after("[emphasis]\ncontour = { value = 0.5 }"), &["a.toml:5:", "width"]);
    assert_says(&error_after("[emphasis]\nboundary = { width = \"wide\" }"), &["a.toml:5:"]);
}

#[test]
fn wrong_types_are_named_with_their_line() {
    for (rest, line) in [
        ("[image]\nsize = \"large\"", 5),
        ("[image]\nsize = [10]", 5),
        ("[image]\nsize = [10, -10]", 5),
        ("[field]\nname = 3", 5),
        ("[[camera]]\nposition = [0.0, 1.0]", 5),
        ("[[camera]]\nview_up = \"z\"", 5),
        ("[method]\nbackend = \"cuda\"", 5),
        ("[method]\n\norder = \"nearest\"", 6),
        ("[method]\nprojection = \"orthographic\"", 5),
        ("[method]\ntable_precision = \"f64\"", 5),
        ("[method]\nmax_error = \"small\"", 5),
        ("not toml", 4),
        ("[image", 4),
    ] {
        assert_says(&error_after(rest), &[&format!("a.toml:{line}:")]);
    }
    // A name that is not on the list is answered with the list.
    assert_says(&error_after("[method]\norder = \"nearest\""), &["nearest", "centroid", "pixel"]);
}

#[test]
fn impossible_values_are_named_with_key_and_line() {
    for (rest, line, key) in [
        ("[mesh]\nsplit = 4", 5, "split"),
        ("[image]\nsize = [0, 10]", 5, "size"),
        ("[image]\nsize = [10, 40000]", 5, "size"),
        ("[image]\nbackground = [0.0, -0.1, 0.0]", 5, "background"),
        ("[image]\nbackground = [0.0, nan, 0.0]", 5, "background"),
        ("[[camera]]\nview_angle = 0.0", 5, "view_angle"),
        ("[[camera]]\nview_angle = 180.0", 5, "view_angle"),
        ("[[camera]]\nparallel_scale = -1.0", 5, "parallel_scale"),
        ("[[camera]]\nparallel_scale = 1.0\nview_angle = 30.0", 6, "view_angle"),
        ("[[camera]]\nnear = -0.5", 5, "near"),
        ("[[camera]]\nnear = inf", 5, "near"),
        ("[[camera]]\nposition = [0.0, 0.0, 0.0]\ndirection = [1.0, 0.0, 0.0]", 4, "camera"),
        ("[method]\nmax_error = 0.0", 5, "max_error"),
        ("[emphasis]", 4, "silhouette = { power = 2.0 }"),
        ("[emphasis]\ngradient = { range = [1.0, 1.0] }", 5, "gradient: range"),
        ("[emphasis]\ngradient = { power = -1.0 }", 5, "gradient: power"),
        ("[emphasis]\n\ncontour = { value = 1.0, width = 0.0 }", 6, "contour: width"),
        ("[emphasis]\nboundary = { sigma = inf }", 5, "boundary: sigma"),
        ("[emphasis]\nboundary = {}\nsilhouette = { power = nan }", 6, "silhouette: power"),
        ("[method]\nmax_error = nan", 5, "max_error"),
    ] {
        assert_says(&error_after(rest), &[&format!("a.toml:{line}:"), key]);
    }
}

#[test]
fn even_opacity_takes_the_place_of_opacity_nodes() {
    let color = "[transfer]\ncolor = [[0.0, 0.0, 0.0, 1.0], [1.0, 1.0, 0.0, 0.0]]\n";
    for (rest, line, part) in [
        ("even_opacity = 0.0", 3, "even_opacity"),
        ("even_opacity = nan", 3, "even_opacity"),
        ("opacity = [[0.0, 1.0]]\neven_opacity = 1.0", 4, "keep one"),
    ] {
        assert_says(&error(&format!("{color}{rest}")), &[&format!("a.toml:{line}:"), part]);
    }
    let preset = error("[transfer]\npreset = \"a.json\"\neven_opacity = 1.0");
    assert_says(&preset, &["a.toml:3:", "even_opacity", "preset"]);
    assert_says(&error("[transfer]\neven_opacity = 1.0"), &["color"]);
    // A unit cube whose field fills its range evenly, but for the range's end: the mean chord is 4 volumes / surface.
    let mesh = mesh(vec![("x", 1, &|p: DVec3| p.x)]);
    let function = |rest: &str| {
        let scene = SceneFile::parse("a.toml", &format!("{color}{rest}")).unwrap().scene(&mesh, 0).unwrap();
        (scene.transfer().unwrap().clone(), scene.unit_distance)
    };
    let (even, unit) = function("fit_to_field = true\neven_opacity = 2.0");
    let [low, high] = mesh.scalar("x", tetlux_mesh::Component::Magnitude).unwrap().range;
    let ends = |transfer: &tetlux_optics::TransferFunction| {
        let (colors, nodes) = (transfer.color_nodes(), transfer.opacity_nodes());
        [colors[0].s, colors[1].s, nodes[0].s, nodes[nodes.len() - 1].s]
    };
    assert_eq!(ends(&even), [low, high, low, high]);
    let mean = even.opacity_nodes().iter().map(|n| n.opacity).sum::<f64>() / even.opacity_nodes().len() as f64 / unit;
    assert!(mean > 0.0 && mean.is_finite());
    // Colours stay where they are without fit_to_field, depth is proportional, and unit distance scales it as ever.
    assert_eq!(ends(&function("even_opacity = 2.0").0)[..2], [0.0, 1.0]);
    let (half, _) = function("fit_to_field = true\neven_opacity = 1.0");
    let (scaled, length) = function("fit_to_field = true\neven_opacity = 2.0\nunit_distance = 7.0");
    for (node, (half, scaled)) in
        even.opacity_nodes().iter().zip(half.opacity_nodes().iter().zip(scaled.opacity_nodes()))
    {
        assert!((half.opacity / node.opacity - 0.5).abs() < 1e-9, "{half:?}, {node:?}");
        assert_eq!(scaled.opacity, node.opacity);
    }
    assert_eq!(length, 7.0);
}

#[test]
fn surfaces_and_what_is_wrong_with_them() {
    for (rest, line, key) in [
        ("[[surface]]\ncolor = [1.0, 1.0, 1.0]", 4, "path"),
        ("[[surface]]\npath = \"a.obj\"\ncolour = 3", 6, "color"),
        ("[[surface]]\npath = \"a.obj\"\ncolor = [1.0, -0.5, 1.0]", 6, "-0.5"),
        ("[[surface]]\npath = \"a.obj\"\nscale = 0.0", 6, "scale"),
        ("[[surface]]\npath = \"a.obj\"\ntranslate = [0.0, nan, 0.0]", 6, "translate"),
        ("[[surface]]\npath = \"a.obj\"\nlight = { diffuse = -1.0 }", 6, "diffuse"),
        ("[[surface]]\npath = \"a.obj\"\nlight = { silhouette = 2.0 }", 6, "silhouette"),
    ] {
        assert_says(&error_after(rest), &[&format!("a.toml:{line}:"), key]);
    }
    let text = format!(
        "{TRANSFER}[light]\nambient = 0.5\n[[surface]]\npath = \"b.stl\"\n[[surface]]\npath = \"c.obj\"\n\
         scale = 0.001\ntranslate = [1.0, 2.0, 3.0]\ncolor = [0.5, 0.0, 2.0]\nlight = {{ ambient = 0.25 }}\n"
    );
    let mut file = SceneFile::parse("folder/a.toml", &text).unwrap();
    let [plain, full] = &file.surfaces[..] else { panic!("two surfaces: {:?}", file.surfaces) };
    // The scene's light, where the surface has none.
    assert_eq!((plain.path.as_path(), Some(plain.light)), (Path::new("folder/b.stl"), file.light));
    assert_eq!((plain.scale, plain.translate), (1.0, DVec3::ZERO));
    assert_eq!((full.color, full.scale, full.light.shares()[0]), ([0.5, 0.0, 2.0], 0.001, 0.25));
    let mesh = mesh(vec![("only", 1, &|p: DVec3| p.x)]);
    assert_says(&file.scene(&mesh, 0).unwrap_err().to_string(), &["b.stl", "SurfaceSpec::on"]);
    let full = file.surfaces.remove(1);
    file.surfaces.clear();
    assert!(file.scene(&mesh, 0).unwrap().surfaces.is_empty());
    // Scaled, moved, and relative to the mesh's middle.
    let corners = [DVec3::ZERO, DVec3::new(1000.0, 0.0, 0.0), DVec3::new(0.0, -500.0, 0.0)];
    let surface = full.on(&mesh, &corners, vec![[0, 1, 2]]).unwrap();
    assert_eq!(
        surface.points().iter().map(|p| p.to_array()).collect::<Vec<_>>(),
        [[0.5, 1.5, 2.5], [1.5, 1.5, 2.5], [0.5, 1.0, 2.5]]
    );
    let refusal = |spec: &SurfaceSpec, points: &[DVec3], triangles| {
        spec.on(&mesh, points, triangles)
            .map(|_| panic!("accepted"))
            .unwrap_or_else(|e: tetlux_scene::SceneError| e.to_string())
    };
    assert_says(&refusal(&full, &corners, vec![[0, 1, 2], [0, 1, 3]]), &["c.obj", "triangle 1", "[0, 1, 3]", "of 3"]);
    let far = [DVec3::ZERO, DVec3::ONE, DVec3::splat(1e42)];
    assert_says(&refusal(&full, &far, vec![[0, 1, 2]]), &["c.obj", "point 2", "scale"]);
    for bad in [SurfaceSpec { scale: -1.0, ..full.clone() }, SurfaceSpec { color: [f64::NAN; 3], ..full.clone() }] {
        assert_says(&refusal(&bad, &corners, vec![[0, 1, 2]]), &["c.obj", "finite"]);
    }
}

#[test]
fn impossible_transfer_functions_are_named_with_their_line() {
    let color = "color = [[0.0, 1.0, 1.0, 1.0]]";
    for (text, line, word) in [
        (format!("{color}\nopacity = [[1.0, 1.0],\n[0.0, 1.0]]"), 4, "opacity"),
        (format!("{color}\nopacity = [[0.0, -1.0]]"), 3, "-1"),
        (format!("{color}\nopacity = [[0.0, inf]]"), 3, "inf"),
        (format!("{color}\nopacity = [[nan, 1.0]]"), 3, "NaN"),
        (format!("{color}\nopacity = [[0.0, 1.0], [0.0, 2.0],\n\n [0.0, 3.0]]"), 5, "third"),
        ("color = [[0.0, 1.0, -1.0, 1.0]]\nopacity = [[0.0, 1.0]]".into(), 2, "color"),
        (format!("{color}\nopacity = [[0.0, 1.0]]\nunit_distance = 0.0"), 4, "unit_distance"),
        (format!("{color}\nopacity = [[0.0, 1.0]]\nrange = [1.0, 1.0]"), 4, "range"),
        (format!("{color}\nopacity = [[0.0, 1.0]]\nrange = [0.0, inf]"), 4, "range"),
        (format!("{color}\nopacity = [[0.0, 1.0]]\npreset = \"p.json\""), 1, "preset"),
        (color.into(), 1, "opacity"),
        ("color = []\nopacity = [[0.0, 1.0]]".into(), 1, "color"),
        (format!("{color}\nopacity = []"), 1, "opacity"),
    ] {
        assert_says(&error(&format!("[transfer]\n{text}\n")), &[&format!("a.toml:{line}:"), word]);
    }
    assert_says(&error("[image]\nsize = [10, 10]\n"), &["a.toml:", "transfer"]);
}

#[test]
fn every_axis_of_the_method_is_a_key() {
    let text = format!(
        "{TRANSFER}[method]\nbackend = \"gpu\"\norder = \"centroid\"\nprojection = \"gator\"\n\
         interpolation = \"screen-linear\"\nintegrator = \"preint-log\"\nclassification = \"post-exact\"\n\
         table_precision = \"u16\"\ntarget = \"rgba8-dither\"\npieces = 20\nmax_error = 0.5\n"
    );
    let method = SceneFile::parse("a.toml", &text).unwrap().method;
    let expected = Method {
        backend: Backend::Gpu,
        order: Order::Centroid,
        projection: CellProjection::Gator,
        interpolation: Interpolation::ScreenLinear,
        integrator: Integrator::PreintLog,
        classification: Classification::PostExact,
        table_precision: TablePrecision::U16,
        target: Target::Rgba8Dither,
        pieces: Some(20),
        max_error: 0.5,
        no_skip: Method::default().no_skip,
    };
    assert_eq!(method, expected);
}

#[test]
fn an_emphasis_is_read_and_goes_with_one_field() {
    let text = format!(
        "{TRANSFER}[emphasis]\ngradient = {{ range = [0.5, 2.0], power = 2.0 }}\ncontour = {{ value = 0.5, width = 0.1 }}\n\
         boundary = {{ sigma = 0.2, width = 0.1, threshold = 0.0 }}\nsilhouette = {{ power = 3.0 }}\n"
    );
    let given = Emphasis {
        gradient: Some(Steepness { range: Some([0.5, 2.0]), power: 2.0 }),
        contour: Some(Contour { value: 0.5, width: 0.1 }),
        boundary: Some(Boundary { sigma: Some(0.2), width: Some(0.1), threshold: 0.0 }),
        silhouette: Some(3.0),
    };
    assert_eq!(SceneFile::parse("a.toml", &text).unwrap().emphasis, Some(given));
    let text = format!("{TRANSFER}[emphasis]\ngradient = {{}}\nboundary = {{}}\nsilhouette = {{}}\n");
    let file = SceneFile::parse("a.toml", &text).unwrap();
    let left_out = Emphasis {
        gradient: Some(Steepness { range: None, power: 1.0 }),
        contour: None,
        boundary: Some(Boundary { sigma: None, width: None, threshold: 0.01 }),
        silhouette: Some(1.0),
    };
    assert_eq!(file.emphasis, Some(left_out));
    let parts = cuboid([1, 1, 1], Split::Five, [DVec3::ZERO, DVec3::ONE]);
    let fields = vec![Field::point("x", 1, parts.sample(|p| p.x)), Field::cell("by cell", 1, vec![0.0; 5])];
    let mesh = TetMesh::assemble(&parts.points, &parts.cells, fields).unwrap();
    let bound = |field: &str, rest: &str| {
        let text = format!("[field]\nname = \"{field}\"\n{TRANSFER}{rest}[emphasis]\nsilhouette = {{}}\n");
        SceneFile::parse("a.toml", &text).unwrap().scene(&mesh, 0).map(|scene| scene.emphasis.is_some())
    };
    assert!(bound("x", "").unwrap());
    assert_says(
        &bound("x", "opacity_field = \"x\"\n").unwrap_err().to_string(),
        &["a.toml", "[emphasis]", "one field"],
    );
    assert_says(&bound("by cell", "").unwrap_err().to_string(), &["by cell", "[emphasis]"]);
}

#[test]
fn what_is_not_said_has_a_default() {
    let file = SceneFile::parse("folder/a.toml", TRANSFER).unwrap();
    assert_eq!((file.size, file.background, file.display_space), ([800, 800], [0.0; 3], false));
    assert_eq!((file.mesh.clone(), file.field.clone(), file.split), (None, None, None));
    assert_eq!(file.unit_distance, UnitDistance::MeanEdge);
    let method = Method { max_error: 1e-3, ..Method::default() };
    assert_eq!((method.backend, method.order, method.integrator), (Backend::Auto, Order::Auto, Integrator::Auto));
    assert_eq!(file.method, method);
    let mesh = mesh(vec![("only", 1, &|p: DVec3| p.x)]);
    let scene = file.scene(&mesh, 0).unwrap();
    assert_eq!((scene.scalar.name.as_str(), scene.unit_distance), ("only", mesh.mean_edge_length()));
    // Framed: perspective, the mesh's middle in the middle, all of it in the picture.
    assert_eq!(scene.camera.projection, Projection::Perspective { view_angle: 30.0 });
    let view = scene.camera.view(scene.size).unwrap();
    for point in 0..mesh.points().len() as u32 {
        let p = view.to_eye(mesh.world(point));
        assert!(view.frustum().iter().all(|(n, c)| n.dot(p) + c > 0.0), "{p}");
    }
    // Paths are relative to the scene file.
    let with_mesh = SceneFile::parse("folder/a.toml", &format!("{TRANSFER}[mesh]\npath = \"b.vtu\"")).unwrap();
    assert_eq!(with_mesh.mesh.as_deref(), Some(Path::new("folder/b.vtu")));
}

type Sampler<'a> = (&'a str, usize, &'a dyn Fn(DVec3) -> f64);

fn mesh(fields: Vec<Sampler>) -> TetMesh {
    let parts = cuboid([2, 2, 2], Split::Six, [DVec3::ZERO, DVec3::ONE]);
    let values = |components: usize, f: &dyn Fn(DVec3) -> f64| {
        parts.points.iter().flat_map(|&p| vec![f(p); components]).collect()
    };
    let fields = fields.into_iter().map(|(name, n, f)| Field::point(name, n, values(n, f))).collect();
    TetMesh::assemble(&parts.points, &parts.cells, fields).unwrap()
}

/// What the scene says to a mesh.
fn refusal(rest: &str, mesh: &TetMesh, camera: usize) -> String {
    let file = SceneFile::parse("a.toml", &format!("{TRANSFER}{rest}")).unwrap();
    file.scene(mesh, camera).map(|_| panic!("accepted: {rest}")).unwrap_or_else(|e| e.to_string())
}

#[test]
fn fields_that_cannot_be_had() {
    let two = mesh(vec![("heat", 1, &|p| p.x), ("flow", 3, &|p| p.y), ("void", 1, &|_| f64::NAN)]);
    assert_says(&refusal("[field]\nname = \"head\"", &two, 0), &["\"head\"", "\"heat\"", "\"flow\"", "\"void\""]);
    assert_says(&refusal("[field]\nname = \"void\"", &two, 0), &["\"void\"", "no finite value", "27", "\"heat\""]);
    assert_says(&refusal("[field]\nname = \"flow\"\ncomponent = 3", &two, 0), &["\"flow\"", "3"]);
    assert_says(&refusal("[field]\nname = \"heat\"", &two, 1), &["camera 1", "a.toml"]);
    assert!(SceneFile::parse("a.toml", &format!("{TRANSFER}[field]\nname = \"flow\"\ncomponent = 2")).is_ok());
}

#[test]
fn cameras_that_see_nothing() {
    let mesh = mesh(vec![("heat", 1, &|p| p.x)]);
    let same = "[[camera]]\nposition = [1.0, 0.0, 0.0]\nfocal_point = [1.0, 0.0, 0.0]";
    assert_says(&refusal(same, &mesh, 0), &["camera", "focal point"]);
    let up = "[[camera]]\nposition = [0.0, 0.0, 9.0]\nfocal_point = [0.0, 0.0, 0.0]\nview_up = [0.0, 0.0, 1.0]";
    assert_says(&refusal(up, &mesh, 0), &["camera", "view up"]);
}

#[test]
fn files_and_presets_that_cannot_be_read() {
    let folder = tempfile::tempdir().unwrap();
    let missing = folder.path().join("none.toml");
    assert_says(&SceneFile::read(&missing).unwrap_err().to_string(), &["none.toml"]);
    let mesh = mesh(vec![("heat", 1, &|p| p.x)]);
    let scene = folder.path().join("scene.toml");
    fs::write(&scene, "[transfer]\npreset = \"preset.json\"\n").unwrap();
    let file = SceneFile::read(&scene).unwrap();
    let said = |text: Option<&str>| {
        if let Some(text) = text {
            fs::write(folder.path().join("preset.json"), text).unwrap();
        }
        file.scene(&mesh, 0).map(|_| panic!("accepted: {text:?}")).unwrap_or_else(|e| e.to_string())
    };
    for text in [
        None,
        Some(""),
        Some("{"),
        Some("[]"),
        Some("[{\"Name\": \"x\"}]"),
        Some("<xml"),
        Some("[{\"RGBPoints\": [0, 1]}]"),
    ] {
        assert_says(&said(text), &["preset.json"]);
    }
    // And one that can: two nodes, stretched to the field's range.
    fs::write(folder.path().join("preset.json"), r#"[{"Name": "p", "RGBPoints": [0, 0, 0, 0, 5, 1, 1, 1]}]"#).unwrap();
    let scene = file.scene(&mesh, 0).unwrap();
    assert_eq!(tetlux_tests::transfer_of(&scene).color_nodes().last().unwrap().s, 1.0);
}

#[test]
fn cells_without_data_look_as_the_scene_says_or_else_the_preset() {
    let folder = tempfile::tempdir().unwrap();
    let mesh = mesh(vec![("heat", 1, &|p| p.x)]);
    let no_data = |transfer: &str, preset: &str| {
        let path = folder.path().join("scene.toml");
        fs::write(&path, format!("[transfer]\n{transfer}")).unwrap();
        let preset = format!("[{{\"Name\": \"p\", \"RGBPoints\": [0, 0, 0, 0, 5, 1, 1, 1]{preset}}}]");
        fs::write(folder.path().join("preset.json"), preset).unwrap();
        SceneFile::read(&path).unwrap().scene(&mesh, 0).map(|scene| scene.no_data)
    };
    let of_nodes = "color = [[0.0, 1.0, 1.0, 1.0]]\nopacity = [[0.0, 1.0]]\n";
    let look = |color, opacity| NoData::new(color, opacity).unwrap();
    assert_eq!(no_data(of_nodes, "").unwrap(), NoData::default());
    let both = format!("{of_nodes}nan_color = [0.5, 0.0, 2.0]\nnan_opacity = 3.0");
    assert_eq!(no_data(&both, "").unwrap(), look([0.5, 0.0, 2.0], 3.0));
    let of_preset = "preset = \"preset.json\"\n";
    let green = r#", "NanColor": [0, 1, 0], "NanOpacity": 0.75"#;
    assert_eq!(no_data(of_preset, "").unwrap(), NoData::default());
    assert_eq!(no_data(of_preset, green).unwrap(), look([0.0, 1.0, 0.0], 0.75));
    assert_eq!(no_data(&format!("{of_preset}nan_opacity = 0.0"), green).unwrap(), look([0.0, 1.0, 0.0], 0.0));
    let bad = no_data(of_preset, r#", "NanColor": [0, -1, 0]"#).unwrap_err().to_string();
    assert_says(&bad, &["preset.json", "cells without data", "-1", "at least 0"]);
    assert_says(&error(&format!("{TRANSFER}nan_color = [0.0, -1.0, 0.0]")), &["a.toml:4:", "nan_color", "at least 0"]);
    assert_says(&error(&format!("{TRANSFER}nan_opacity = inf")), &["a.toml:4:", "nan_opacity", "inf"]);
    assert_says(&error(&format!("{TRANSFER}nan_opacity = \"clear\"")), &["a.toml:4:"]);
}

#[test]
fn the_shipped_scenes_are_read() {
    let folder = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../scenes"));
    let mut count = 0;
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|e| e == "toml") {
            let file = SceneFile::read(&path).unwrap_or_else(|e| panic!("{e}"));
            assert_eq!(file.name, path.display().to_string());
            count += 1;
        }
    }
    assert!(count >= 6, "{count} scenes");
}
