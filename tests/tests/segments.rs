//! The device's arithmetic for two fields against the f64 reference, which shares none of it: whole rays through a box in
//! which both fields are linear, hence one segment each.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test's helpers fail and tell like the test")]

use glam::DVec3;
use tetlux_mesh::procedural::{Split, cuboid};
use tetlux_mesh::{Component, Field, ScalarField, TetMesh};
use tetlux_optics::widget::{BivariateFunction, Rectangle, Shape, WaveProfile, Widget};
use tetlux_optics::{
    Classification, ColorNode, ImageFunction, OpacityNode, TransferFunction, image_f32, two_field_f32, widgets_f32,
};
use tetlux_reference::{Caster, Ray};
use tetlux_tests::Random;

/// Single-precision segments (some 1e-5), and rims of rectangles and phases that are rounded to 1e-7 of a range.
const TOLERANCE: f64 = 3e-5;

const LENGTH: f64 = 2.0;
const EXTINCTION: f64 = 0.8;

/// A box along z with both fields linear from one end to the other.
struct Column {
    mesh: TetMesh,
    fields: [ScalarField; 2],
    ends: [[f64; 2]; 2],
}

impl Column {
    fn new(random: &mut Random) -> Column {
        let mut point = || [random.between(-1.0, 3.0), random.between(5.0, 6.0)];
        let ends = [point(), point()];
        let parts = cuboid([1, 1, 2], Split::Six, [DVec3::ZERO, DVec3::new(1.0, 1.0, LENGTH)]);
        let field =
            |axis: usize| parts.sample(|p| ends[0][axis] * (1.0 - p.z / LENGTH) + ends[1][axis] * (p.z / LENGTH));
        let fields = vec![Field::point("x", 1, field(0)), Field::point("y", 1, field(1))];
        let mesh = TetMesh::assemble(&parts.points, &parts.cells, fields).unwrap();
        let fields = ["x", "y"].map(|name| mesh.scalar(name, Component::Magnitude).unwrap());
        Column { mesh, fields, ends }
    }

    fn ranges(&self) -> [[f64; 2]; 2] {
        [self.fields[0].range, self.fields[1].range]
    }

    /// Normalised scalars at the front and the back.
    fn places(&self) -> [[f32; 2]; 2] {
        let ranges = self.ranges();
        self.ends.map(|p| [0, 1].map(|k| ((p[k] - ranges[k][0]) / (ranges[k][1] - ranges[k][0])) as f32))
    }

    fn truth(&self, classification: &Classification) -> [f64; 4] {
        let caster = Caster::new(tetlux_reference::Scene {
            mesh: &self.mesh,
            scalar: &self.fields[0],
            second: Some(&self.fields[1]),
            classification,
            lighting: None,
            colors: None,
            unit_distance: 1.0 / EXTINCTION,
            tolerance: 1e-9,
        });
        let ray = Ray { origin: DVec3::new(0.3, 0.4, -1.0), direction: DVec3::Z, start: 0.0, end: f64::INFINITY };
        let seen = caster.unwrap().cast(&ray);
        [seen.color[0], seen.color[1], seen.color[2], seen.alpha]
    }
}

fn error(got: [f32; 4], truth: [f64; 4]) -> f64 {
    (0..4).map(|k| (f64::from(got[k]) - truth[k]).abs()).fold(0.0, f64::max)
}

fn color(random: &mut Random) -> [f64; 3] {
    [random.between(0.0, 1.0), random.between(0.0, 1.0), random.between(0.0, 1.0)]
}

fn widget(random: &mut Random) -> Widget {
    let shape = match random.below(5) {
        0 => Shape::Uniform,
        1 => Shape::Gaussian {
            center: [random.between(-1.0, 3.0), random.between(5.0, 6.0)],
            sigma: [random.between(0.1, 1.0), random.between(0.05, 0.3)],
        },
        k => Shape::Wave {
            profile: [WaveProfile::Triangle, WaveProfile::AbsSine, WaveProfile::SineSquared][k - 2],
            frequency: [random.between(-1.0, 1.0), random.between(-3.0, 3.0)],
            offset: random.between(-2.0, 2.0),
        },
    };
    let support = (random.below(2) == 0).then(|| {
        let [s, g] = [random.between(-1.0, 1.0), random.between(5.0, 5.5)];
        Rectangle { s: [s, s + random.between(0.5, 2.0)], g: [g, g + random.between(0.2, 0.5)] }
    });
    Widget::new(shape, support, random.between(0.2, 6.0), color(random)).unwrap()
}

#[test]
fn widgets() {
    let mut random = Random::new(31);
    let mut seen = 0;
    for case in 0..60 {
        let column = Column::new(&mut random);
        let widgets = (0..1 + random.below(4)).map(|_| widget(&mut random)).collect();
        let function = BivariateFunction { widgets };
        let device = tetlux_optics::widget_f32::widgets(&function, column.ranges(), EXTINCTION);
        let truth = column.truth(&Classification::Widgets(function));
        let [front, back] = column.places();
        for bound in [1e-2, 1e-3, 1e-4] {
            let got = widgets_f32::integrate(&device, front, back, LENGTH as f32, bound as f32);
            let (color, alpha) = (error([got.color[0], got.color[1], got.color[2], truth[3] as f32], truth), truth[3]);
            assert!(color <= bound + TOLERANCE, "case {case}: colour off by {color:e} for {bound:e}");
            assert!((f64::from(got.color[3]) - alpha).abs() <= TOLERANCE, "case {case}: {got:?} {truth:?}");
        }
        seen += usize::from(truth[3] > 0.1);
    }
    assert!(seen > 30, "{seen} of the rays see something");
}

#[test]
fn two_fields() {
    let mut random = Random::new(32);
    let mut worst = 0.0_f64;
    for _ in 0..60 {
        let column = Column::new(&mut random);
        let nodes = |low: f64, high: f64| (0..6).map(move |k| low + (high - low) * f64::from(k) / 5.0);
        let transfer = TransferFunction::new(
            nodes(-1.0, 3.0).map(|s| ColorNode { s, rgb: color(&mut random) }).collect(),
            nodes(5.0, 6.0).map(|s| OpacityNode { s, opacity: random.between(-1.0, 3.0).max(0.0) }).collect(),
        )
        .unwrap();
        let [colors, opacities] = two_field_f32::axes(&transfer, column.ranges(), EXTINCTION);
        let [front, back] = column.places();
        let got = two_field_f32::integrate(&colors, &opacities, front, back, LENGTH as f32);
        worst = worst.max(error(got, column.truth(&Classification::TwoFields(transfer))));
    }
    println!("two fields: {worst:.1e}");
    assert!(worst < TOLERANCE, "{worst:e}");
}

#[test]
fn images() {
    let mut random = Random::new(33);
    for case in 0..40 {
        let column = Column::new(&mut random);
        let (width, height) = (2 + random.below(5), 2 + random.below(5));
        let texels = (0..width * height)
            .map(|_| {
                let [r, g, b] = color(&mut random);
                [r, g, b, random.between(-1.0, 3.0).max(0.0)].map(|v| v as f32)
            })
            .collect();
        let function = ImageFunction::new(width, texels, [[-0.5, 2.5], [5.1, 5.8]]).unwrap();
        let device = image_f32::image(&function, column.ranges(), EXTINCTION);
        let truth = column.truth(&Classification::Image(function));
        let [front, back] = column.places();
        for bound in [1e-2, 1e-3, 1e-4] {
            let error = error(image_f32::integrate(&device, front, back, LENGTH as f32, bound as f32), truth);
            assert!(error <= bound + TOLERANCE, "case {case}: off by {error:e} for {bound:e}");
        }
    }
}

#[test]
fn a_planted_difference_is_seen() {
    // The same widget, a tenth of a percent more opaque on the device.
    let mut random = Random::new(34);
    let column = Column::new(&mut random);
    let fog =
        |opacity| BivariateFunction { widgets: vec![Widget::new(Shape::Uniform, None, opacity, [1.0; 3]).unwrap()] };
    let device = tetlux_optics::widget_f32::widgets(&fog(1.001), column.ranges(), EXTINCTION);
    let [front, back] = column.places();
    let got = widgets_f32::integrate(&device, front, back, LENGTH as f32, 1e-4);
    assert!(error(got.color, column.truth(&Classification::Widgets(fog(1.0)))) > TOLERANCE);
}
