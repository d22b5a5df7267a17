//! Two scalars and light, against closed forms.

use super::super::*;
use crate::testing::{numbers, ray};
use tetlux_mesh::procedural::{Split, cuboid};
use tetlux_mesh::{Component, Field};
use tetlux_optics::widget::{BivariateFunction, Rectangle, Shape, WaveProfile, Widget};
use tetlux_optics::{ColorNode, ImageFunction, OpacityNode, TransferFunction};

/// The caster's own tolerance of 1e-10, and the rounding of some hundred steps.
const TOLERANCE: f64 = 1e-9;

/// A box from 0 to (1, 1, 2) with the scalars x = z / 2 and y as given; rays along z see both linear.
struct Box2 {
    mesh: TetMesh,
    x: ScalarField,
    y: ScalarField,
}

fn box_with(y: impl FnMut(DVec3) -> f64) -> Box2 {
    // Cells of 1/2: exact in single precision, in which the mesh has its points.
    let parts = cuboid([2, 2, 4], Split::Six, [DVec3::ZERO, DVec3::new(1.0, 1.0, 2.0)]);
    let fields = vec![Field::point("x", 1, parts.sample(|p| 0.5 * p.z)), Field::point("y", 1, parts.sample(y))];
    let mesh = TetMesh::assemble(&parts.points, &parts.cells, fields).unwrap();
    let [x, y] = ["x", "y"].map(|name| mesh.scalar(name, Component::Magnitude).unwrap());
    Box2 { mesh, x, y }
}

impl Box2 {
    fn scene<'a>(&'a self, classification: &'a Classification) -> Scene<'a> {
        Scene {
            mesh: &self.mesh,
            scalar: &self.x,
            second: Some(&self.y),
            classification,
            lighting: None,
            colors: None,
            unit_distance: 1.0,
            tolerance: DEFAULT_TOLERANCE,
        }
    }

    fn seen(&self, classification: &Classification) -> Radiance {
        Caster::new(self.scene(classification)).unwrap().cast(&ray([0.3, 0.4, -1.0], [0.0, 0.0, 1.0]))
    }
}

fn widgets(widgets: Vec<Widget>) -> Classification {
    Classification::Widgets(BivariateFunction { widgets })
}

fn widget(shape: Shape, support: Option<Rectangle>, opacity: f64, color: [f64; 3]) -> Widget {
    Widget::new(shape, support, opacity, color).unwrap()
}

#[track_caller]
fn assert_close(found: f64, expected: f64) {
    assert!((found - expected).abs() < TOLERANCE, "{found} for {expected}");
}

#[test]
fn color_of_one_field_and_opacity_of_another() {
    // x runs from 0 to 1 over a length of 2, y is 0.6 throughout: extinction 0.6 k, luminance x.
    let body = box_with(|_| 0.6);
    let k = 1.5;
    let classification = Classification::TwoFields(
        TransferFunction::new(
            vec![ColorNode { s: 0.0, rgb: [0.0; 3] }, ColorNode { s: 1.0, rgb: [1.0, 0.5, 0.0] }],
            vec![OpacityNode { s: 0.0, opacity: 0.0 }, OpacityNode { s: 1.0, opacity: k }],
        )
        .unwrap(),
    );
    let tau = 0.6 * k;
    let alpha = -(-2.0 * tau).exp_m1();
    let seen = body.seen(&classification);
    assert_close(seen.alpha, alpha);
    // int_0^2 (z/2) tau exp(-tau z) dz = (1/2) ((1 - e)/tau - 2 e), e = exp(-2 tau).
    let expected = 0.5 * (alpha / tau - 2.0 * (1.0 - alpha));
    assert_close(seen.color[0], expected);
    assert_close(seen.color[1], 0.5 * expected);
    assert_eq!(seen.color[2], 0.0);
    // A step of the opacity in y, crossed while the colour goes on: y = x, opacity 0 below 1/2 and 1 above.
    let body = box_with(|p| 0.5 * p.z);
    let step = Classification::TwoFields(
        TransferFunction::new(
            vec![ColorNode { s: 0.0, rgb: [0.0; 3] }, ColorNode { s: 1.0, rgb: [1.0; 3] }],
            vec![OpacityNode { s: 0.5, opacity: 0.0 }, OpacityNode { s: 0.5, opacity: 1.0 }],
        )
        .unwrap(),
    );
    // int_0^1 (1/2 + u/2) exp(-u) du = (1/2) (1 - e) + (1/2) (1 - 2 e), e = exp(-1).
    let e = (-1.0_f64).exp();
    assert_close(body.seen(&step).color[0], 0.5 * (1.0 - e) + 0.5 * (1.0 - 2.0 * e));
}

#[test]
fn a_uniform_widget_is_a_slab() {
    // y = 1 - x: the rectangle holds x from 0.25 to 0.8 and y up to 0.6, that is x from 0.4 to 0.8: 0.8 long.
    let body = box_with(|p| 1.0 - 0.5 * p.z);
    let support = Rectangle { s: [0.25, 0.8], g: [f64::NEG_INFINITY, 0.6] };
    let seen = body.seen(&widgets(vec![widget(Shape::Uniform, Some(support), 2.0, [0.5, 1.0, 0.25])]));
    let alpha = -(-1.6_f64).exp_m1();
    assert_close(seen.alpha, alpha);
    assert_close(seen.color[0], 0.5 * alpha);
}

/// The error function by its power series.
fn erf(x: f64) -> f64 {
    let (mut term, mut sum) = (x, x);
    for n in 1..200 {
        let n = f64::from(n);
        term *= -x * x / n;
        sum += term / (2.0 * n + 1.0);
    }
    sum * 2.0 / std::f64::consts::PI.sqrt()
}

#[test]
fn a_gaussian_widget_has_an_erf_for_its_depth() {
    // y = 0.5 + 0.3 z: along the ray both move. Narrow ones lie between all the nodes of a rule over a cell.
    let body = box_with(|p| 0.5 + 0.25 * p.z);
    for (center, sigma, opacity) in
        [([0.4, 0.75], [0.2, 0.3], 3.0), ([0.7, 0.9], [0.4, 0.1], 40.0), ([0.51, 0.755], [0.004, 0.003], 500.0)]
    {
        let seen = body.seen(&widgets(vec![widget(Shape::Gaussian { center, sigma }, None, opacity, [1.0; 3])]));
        // (x, y) = (0, 0.5) + u (1, 0.5), u = z / 2 in [0, 1]: exponent -(A u + B)^2 - C.
        let (k, at) = ([1.0, 0.5], [0.0 - center[0], 0.5 - center[1]]);
        let scaled = |v: [f64; 2]| [v[0] / sigma[0], v[1] / sigma[1]].map(|c| c / 2.0_f64.sqrt());
        let (k, at) = (scaled(k), scaled(at));
        let a = k[0].hypot(k[1]);
        let b = (k[0] * at[0] + k[1] * at[1]) / a;
        let c = at[0] * at[0] + at[1] * at[1] - b * b;
        // Far from 0 the series fails, and erf is 1 there.
        let erf = |t: f64| if t.abs() > 5.0 { t.signum() } else { erf(t) };
        let depth = 2.0 * opacity * (-c).exp() * std::f64::consts::PI.sqrt() / (2.0 * a) * (erf(a + b) - erf(b));
        let alpha = -(-depth).exp_m1();
        assert_close(seen.alpha, alpha);
        assert_close(seen.color[2], alpha);
    }
}

#[test]
fn waves_are_seen_to_the_last_period() {
    // 37.25 periods along the ray: a rising ramp, 36 whole periods, and from the middle of a period to the end.
    let body = box_with(|_| 0.5);
    for (profile, mean) in [
        (WaveProfile::Triangle, 0.5),
        (WaveProfile::AbsSine, 2.0 / std::f64::consts::PI),
        (WaveProfile::SineSquared, 0.5),
    ] {
        let shape = Shape::Wave { profile, frequency: [37.0, 1.0], offset: -0.5 };
        let seen = body.seen(&widgets(vec![widget(shape, None, 0.4, [1.0; 3])]));
        // Whole periods: the depth is the mean's.
        let alpha = -(-2.0 * 0.4 * mean).exp_m1();
        assert_close(seen.alpha, alpha);
        assert_close(seen.color[0], alpha);
    }
}

#[test]
fn widgets_one_behind_another_are_composed_and_together_are_mixed() {
    let body = box_with(|_| 0.0);
    let slab = |s, color| {
        let support = Rectangle { s, g: [-1.0, 1.0] };
        widget(Shape::Uniform, Some(support), 1.0, color)
    };
    // x in [0, 1/2] red, in [1/4, 1] blue: lengths 1/2, 1/2 (both, extinction 2), 1.
    let seen = body.seen(&widgets(vec![slab([0.0, 0.5], [1.0, 0.0, 0.0]), slab([0.25, 1.0], [0.0, 0.0, 1.0])]));
    let alpha = |depth: f64| -(-depth).exp_m1();
    let (first, second) = (alpha(0.5), (-0.5_f64).exp() * alpha(1.0));
    assert_close(seen.color[0], first + 0.5 * second);
    assert_close(seen.color[2], 0.5 * second + (-1.5_f64).exp() * alpha(1.0));
    assert_close(seen.alpha, alpha(2.5));
}

#[test]
fn an_image_is_its_definition() {
    // Opacity x y on 2 x 2 texels, along y = 1 - x: tau = x (1 - x), depth 2 / 6; with 5 x 3 nodes the same.
    let body = box_with(|p| 1.0 - 0.5 * p.z);
    for [width, height] in [[2, 2], [5, 3]] {
        let texel = |k: usize| {
            let [x, y] = [(k % width) as f32 / (width - 1) as f32, (k / width) as f32 / (height - 1) as f32];
            [1.0, 0.5, 0.0, x * y]
        };
        let image = ImageFunction::new(width, (0..width * height).map(texel).collect(), [[0.0, 1.0]; 2]).unwrap();
        let seen = body.seen(&Classification::Image(image));
        assert_close(seen.alpha, -(-1.0_f64 / 3.0).exp_m1());
        assert_close(seen.color[1], 0.5 * seen.alpha);
    }
}

/// The integral of what the definitions say over z from 0 to 2: Simpson's rule, fine enough.
fn simpson(f: &dyn Fn(f64) -> f64) -> f64 {
    let n = 2000;
    let value = |k: i32| {
        f(2.0 * f64::from(k) / f64::from(n))
            * if k == 0 || k == n {
                1.0
            } else if k % 2 == 1 {
                4.0
            } else {
                2.0
            }
    };
    (0..=n).map(value).sum::<f64>() * 2.0 / f64::from(n) / 3.0
}

#[test]
fn light_and_silhouettes_follow_the_gradient() {
    // Gradients interpolated from (0, 0, 1) at z = 0 to (1, 0, 1) at z = 2: tan of the angle to the view is z / 2.
    let body = box_with(|_| 0.0);
    let gradients: Vec<DVec3> =
        (0..body.mesh.points().len() as u32).map(|v| DVec3::new(0.5 * body.mesh.world(v).z, 0.0, 1.0)).collect();
    let fog = widgets(vec![widget(Shape::Uniform, None, 1.0, [1.0, 0.5, 0.0])]);
    let seen = |light: &Light| {
        let scene = Scene { lighting: Some((light, &gradients)), ..body.scene(&fog) };
        Caster::new(scene).unwrap().cast(&ray([0.3, 0.4, -1.0], [0.0, 0.0, 1.0]))
    };
    let cosine = |z: f64| 1.0 / (1.0 + 0.25 * z * z).sqrt();
    // Diffuse 0.5, ambient 0.25, specular 0.5 with exponent 4, all at the eye.
    let light = Light::new(None, [0.25, 0.5, 0.5], 4.0, 0.0).unwrap();
    let lit = simpson(&|z| (0.25 + 0.5 * cosine(z) + 0.5 * cosine(z).powi(4)) * (-z).exp());
    let found = seen(&light);
    assert_close(found.color[0], lit);
    assert_close(found.color[2], simpson(&|z| 0.5 * cosine(z).powi(4) * (-z).exp()));
    assert_close(found.alpha, -(-2.0_f64).exp_m1());
    // A light along x: n.l = sin.
    let aside = Light::new(Some([-1.0, 0.0, 0.0]), [0.0, 1.0, 0.0], 1.0, 0.0).unwrap();
    assert_close(seen(&aside).color[0], simpson(&|z| 0.5 * z * cosine(z) * (-z).exp()));
    // Silhouette 2: the depth is int (1 - cos)^2.
    let rim = Light::new(None, [1.0, 0.0, 0.0], 1.0, 2.0).unwrap();
    let depth = simpson(&|z| (1.0 - cosine(z)).powi(2));
    assert_close(seen(&rim).alpha, -(-depth).exp_m1());
    assert_close(seen(&rim).color[0], -(-depth).exp_m1());
}

#[test]
fn what_a_second_scalar_or_a_light_needs_is_asked_for() {
    let body = box_with(|_| 0.0);
    let fog = widgets(vec![widget(Shape::Uniform, None, 1.0, [1.0; 3])]);
    let scene = body.scene(&fog);
    let refused = |scene: Scene| Caster::new(scene).err().map(|e| e.to_string()).unwrap_or_default();
    assert!(refused(Scene { second: None, ..scene }).contains("second"));
    let mut short = body.y.clone();
    short.values.pop();
    assert!(refused(Scene { second: Some(&short), ..scene }).contains("\"y\""));
    let light = Light::new(None, [1.0; 3], 1.0, 0.0).unwrap();
    assert!(refused(Scene { lighting: Some((&light, &[DVec3::ZERO; 2])), ..scene }).contains("2 gradients"));
    // A cell that misses its second value is clear, as one that misses the first.
    let mut holes = box_with(|p| if p.z > 1.9 { f64::NAN } else { 0.5 });
    holes.y.range = [0.5; 2];
    assert_close(holes.seen(&fog).alpha, -(-1.5_f64).exp_m1());
}

#[test]
fn a_second_scalar_of_the_cells_is_taken_by_cell() {
    let mut body = box_with(|_| 0.0);
    let mut number = numbers(3);
    let layers = body.mesh.cells().iter().map(|cell| {
        let low = cell.iter().map(|&v| body.mesh.world(v).z).fold(f64::INFINITY, f64::min);
        (2.0 * low).round() + 0.25 * number()
    });
    body.y = ScalarField { location: Location::Cell, values: layers.collect(), ..body.y.clone() };
    // Opacity 1, 0, 2 and 0 of the layers 0 to 3, each 1/2 thick.
    let slab = |g, opacity| widget(Shape::Uniform, Some(Rectangle { s: [-1.0, 2.0], g }), opacity, [1.0; 3]);
    let seen = body.seen(&widgets(vec![slab([0.0, 0.5], 1.0), slab([2.0, 2.5], 2.0)]));
    assert_close(seen.alpha, -(-1.5_f64).exp_m1());
}

#[test]
fn colours_at_the_points_are_linear_in_between() {
    let body = box_with(|_| 0.0);
    let fog = widgets(vec![widget(Shape::Uniform, None, 1.0, [1.0; 3])]);
    // Luminance z / 2 and 1 - z / 2 of an opacity of z: depth z^2 / 2.
    let colors: Vec<[f64; 4]> = (0..body.mesh.points().len())
        .map(|i| body.mesh.world(i as u32).z)
        .map(|z| [0.5 * z, 1.0 - 0.5 * z, 1.0, z])
        .collect();
    let scene = Scene { colors: Some(&colors), ..body.scene(&fog) };
    let seen = Caster::new(scene).unwrap().cast(&ray([0.3, 0.4, -1.0], [0.0, 0.0, 1.0]));
    assert_close(seen.alpha, -(-2.0_f64).exp_m1());
    let red = simpson(&|z| 0.5 * z * z * (-0.5 * z * z).exp());
    assert_close(seen.color[0], red);
    assert_close(seen.color[1], seen.alpha - red);
    assert_close(seen.color[2], seen.alpha);
    // The classification says nothing more, and nothing is seen where nothing is given.
    let clear = vec![[1.0, 1.0, 1.0, 0.0]; colors.len()];
    let scene = Scene { colors: Some(&clear), ..body.scene(&fog) };
    assert_eq!(Caster::new(scene).unwrap().cast(&ray([0.3, 0.4, -1.0], [0.0, 0.0, 1.0])).alpha, 0.0);
    let refused = |colors: &[[f64; 4]]| {
        Caster::new(Scene { colors: Some(colors), ..body.scene(&fog) }).err().map(|e| e.to_string()).unwrap_or_default()
    };
    assert!(refused(&colors[1..]).contains("colours for"));
    let mut bad = colors.clone();
    bad[3][1] = f64::NAN;
    assert!(refused(&bad).contains("NaN"));
}
