//! What is made for which scene, and how light is held on pieces.

use tetlux_mesh::procedural::{Split, cuboid};
use tetlux_mesh::{Component, Field, TetMesh};
use tetlux_optics::widget::{BivariateFunction, Shape};
use tetlux_optics::{ColorNode, Light, OpacityNode, TransferFunction};
use tetlux_scene::{Camera, Method, Projection};

use super::*;
use crate::device_mesh::DeviceMesh;

fn mesh() -> TetMesh {
    let parts = cuboid([2, 2, 2], Split::Six, [DVec3::ZERO, DVec3::ONE]);
    let fields = vec![Field::point("s", 1, parts.sample(|p| p.x)), Field::point("g", 1, parts.sample(|p| p.y))];
    TetMesh::assemble(&parts.points, &parts.cells, fields).unwrap()
}

fn transfer() -> TransferFunction {
    TransferFunction::new(
        vec![ColorNode { s: 0.0, rgb: [1.0, 0.5, 0.25] }],
        vec![OpacityNode { s: 0.0, opacity: 0.0 }, OpacityNode { s: 1.0, opacity: 2.0 }],
    )
    .unwrap()
}

fn scene(mesh: &TetMesh, classification: Classification, light: Option<Light>) -> Scene {
    let scalar = mesh.scalar("s", Component::Magnitude).unwrap();
    let gradients = || mesh.vertex_gradients(&scalar);
    Scene {
        second: Some(mesh.scalar("g", Component::Magnitude).unwrap()),
        no_data: tetlux_optics::NoData::default(),
        lighting: light.map(|light| Lighting { light, gradients: gradients() }),
        emphasis: None,
        surfaces: Vec::new(),
        scalar: scalar.clone(),
        classification,
        unit_distance: 1.0,
        camera: Camera {
            position: DVec3::new(0.5, 0.5, -3.0),
            focal_point: DVec3::splat(0.5),
            view_up: DVec3::Y,
            projection: Projection::Orthographic { parallel_scale: 1.0 },
            near: 0.0,
        },
        size: [8, 8],
        background: [0.0; 3],
        method: Method::default(),
    }
}

fn look(mesh: &TetMesh, scene: &Scene) -> Result<Option<Look>, RenderError> {
    let device = DeviceMesh::new(mesh, &scene.scalar, &[]);
    let eye = EyeSpace::new(&scene.camera.view(scene.size).unwrap(), mesh, &device);
    let pieces = transfer_f32::pieces(&transfer(), scene.scalar.range, 1.0);
    Look::new(scene, mesh.points().len(), &eye, (&pieces, Weights::Direct), None, 1.0, None, 1.0)
}

fn shiny() -> Light {
    Light::new(None, [0.3, 0.7, 0.5], 10.0, 0.0).unwrap()
}

#[test]
fn fields_are_made_where_they_are_asked_for_and_nowhere_else() {
    let mesh = mesh();
    let made = |classification, light| {
        look(&mesh, &scene(&mesh, classification, light)).unwrap().map(|look| look.further.len())
    };
    let one = || Classification::OneField(transfer());
    assert_eq!(made(one(), None), None, "a scene of one field holds no second arrays, though it has a second scalar");
    assert_eq!(made(one(), Some(shiny())), Some(3));
    assert_eq!(made(Classification::TwoFields(transfer()), None), Some(1));
    assert_eq!(made(Classification::TwoFields(transfer()), Some(shiny())), Some(4));
}

#[test]
fn what_a_scene_lacks_is_an_error() {
    let mesh = mesh();
    let mut two = scene(&mesh, Classification::TwoFields(transfer()), None);
    two.second = None;
    assert!(look(&mesh, &two).unwrap_err().to_string().contains("second scalar"));
    let mut lit = scene(&mesh, Classification::OneField(transfer()), Some(shiny()));
    if let Some(lighting) = &mut lit.lighting {
        lighting.gradients.pop();
    }
    assert!(look(&mesh, &lit).unwrap_err().to_string().contains("gradient"));
}

fn segment(gradients: [Vec3; 2], length: f32) -> Segment {
    let (front, back, pieces) = ([0.2, 0.0], [0.9, 0.0], [0, 2]);
    let colors = [[0.0; 4]; 2];
    Segment { front, back, colors, gradients, length, view: [0.0, 0.0, -1.0], pieces }
}

#[test]
fn a_normal_that_does_not_turn_takes_one_piece_and_is_lit_like_a_point() {
    let mesh = mesh();
    let lit_look = look(&mesh, &scene(&mesh, Classification::OneField(transfer()), Some(shiny()))).unwrap().unwrap();
    let (near, far) = (Vec3::new(0.3, 0.0, 0.4), Vec3::new(0.6, 0.0, 0.8));
    let segment = segment([near, far], 1.5);
    let plain = lit_look.classify(&segment, 0.0, 1.0, 1.0).color;
    let got = lit_look.shade(&segment);
    assert_eq!(got.pieces, 1);
    // |n.v| = 0.8: the light is at the eye.
    let expected = |c: f32| c * (0.3 + 0.7 * 0.8) + 0.5 * 0.8_f32.powi(10) * plain[3];
    for channel in 0..3 {
        assert!((got.color[channel] - expected(plain[channel])).abs() < 1e-6, "{got:?} {plain:?}");
    }
    assert!((got.color[3] - plain[3]).abs() < 1e-7);
}

#[test]
fn opposite_and_missing_gradients_stay_finite() {
    let mesh = mesh();
    let light = Light::new(Some([1.0, 2.0, 0.0]), [0.3, 0.7, 0.5], 10.0, 1.5).unwrap();
    let function = BivariateFunction {
        widgets: vec![tetlux_optics::Widget::new(Shape::Uniform, None, 4.0, [1.0, 0.0, 0.5]).unwrap()],
    };
    let look = look(&mesh, &scene(&mesh, Classification::Widgets(function), Some(light))).unwrap().unwrap();
    for gradients in [[Vec3::X, -Vec3::X], [Vec3::ZERO, Vec3::X], [Vec3::ZERO; 2], [Vec3::X * 1e-20, Vec3::Z]] {
        for length in [1e-12, 1.0, 1e12] {
            let got = look.shade(&segment(gradients, length)).color;
            assert!(got.iter().all(|c| (0.0..=2.0).contains(c)), "{gradients:?} {length}: {got:?}");
        }
    }
}
