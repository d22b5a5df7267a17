//! Functions of two fields and of light: WGSL on the driver, Rust here, the same inputs bit for bit; and the shader's own
//! error against f64.

use tetlux_optics::erf_f32::{erf, erfc, gaussian_mean};
use tetlux_optics::image_f32::{self, Image};
use tetlux_optics::light_f32::{LightUniform, half_way, lit, normal, silhouette_factor};
use tetlux_optics::lit_f32::{Turning, integrate_lit};
use tetlux_optics::lit_linear_f32::{Illuminated, one_field, two_fields};
use tetlux_optics::transfer_f32::{self, Weights};
use tetlux_optics::widget::{BivariateFunction, Rectangle, Shape, WaveProfile, Widget};
use tetlux_optics::widget_f32::{self, kinks, next_kink, track, track_depth, track_rate, track_slopes};
use tetlux_optics::widget_integral::{RaySegment, bivariate_segment};
use tetlux_optics::widgets_f32::{Integrated, integrate_share};
use tetlux_optics::{EmissionConvention, ImageFunction, Light, TransferFunction, two_field_f32};
use tetlux_shaders::{DEFAULTS, choose, compose};
use tetlux_tests::{Random, transfer};

use crate::device::{Bound, run};
use crate::functions::bytes;

/// A driver's exp, sin and log are a few units of the last place off, and of results that are sums of dozens of them the
/// roundings add up.
const ROUNDING: f32 = 2e-5;

/// Of segments that are cut at places which depend on a rounding: one in so many may take other pieces.
const OTHERWISE_CUT: usize = 50;

/// What f32 cannot hold of rims of rectangles and of phases (tetlux-optics, widgets_f32).
const SINGLE: f64 = 3e-5;

pub(crate) const UNIT: [[f64; 2]; 2] = [[0.0, 1.0]; 2];

/// A main function that reads `width` numbers a row as `x`, and writes what `body` puts into `y`.
pub(crate) fn main_of(width: usize, results: usize, body: &str) -> String {
    format!(
        "
fn row(i: u32) {{
    var x: array<f32, {width}>;
    for (var k = 0u; k < {width}u; k++) {{
        x[k] = bitcast<f32>(inputs[{width}u * i + k]);
    }}
    var y: array<f32, {results}>;
    {body}
    for (var k = 0u; k < {results}u; k++) {{
        outputs[{results}u * i + k] = bitcast<u32>(y[k]);
    }}
}}
"
    )
}

/// Colour, alpha and pieces of a result in y.
pub(crate) const PUT: &str = "
    y[0] = r.color.x;
    y[1] = r.color.y;
    y[2] = r.color.z;
    y[3] = r.color.w;
    y[4] = f32(r.pieces);";

/// Where integrals differ: those that took the same pieces by more than rounding, others by more than both may err.
fn difference(
    rows: &[f32],
    width: usize,
    found: &[f32],
    twin: impl Fn(&[f32]) -> Integrated,
    share: f32,
) -> Option<String> {
    let (mut otherwise, mut worst) = (0, 0.0f32);
    for (row, found) in rows.chunks_exact(width).zip(found.chunks_exact(5)) {
        let twin = twin(row);
        let alike = found[4] == twin.pieces as f32;
        otherwise += usize::from(!alike);
        let tolerance = if alike { ROUNDING } else { ROUNDING + 2.0 * share * twin.color[3] };
        for k in 0..4 {
            let error = (found[k] - twin.color[k]).abs();
            worst = worst.max(error);
            if !(found[k].is_finite() && error <= tolerance) {
                return Some(format!("{k} of {row:?}: {found:?} and {twin:?}"));
            }
        }
    }
    let count = rows.len() / width;
    println!("at most {worst:.1e} apart, {otherwise} of {count} otherwise cut");
    (otherwise * OTHERWISE_CUT > count).then(|| format!("{otherwise} of {count} take other pieces"))
}

#[test]
fn error_functions() {
    let mut random = Random::new(21);
    let rows = 200_000;
    let inputs: Vec<f32> = (0..rows)
        .flat_map(|_| {
            let reach = 10f64.powf(random.between(-6.0, 1.2));
            let t0 = random.between(-1.0, 1.0) * reach;
            [t0 as f32, (t0 + 10f64.powf(random.between(-8.0, 1.0))) as f32]
        })
        .collect();
    let body = "y[0] = erf(x[0]);
    y[1] = erfc(x[0]);
    y[2] = gaussian_mean(x[0], x[1]);";
    let source = compose("lib::erf", DEFAULTS).unwrap() + &main_of(2, 3, body);
    let found = run(&source, &[], &inputs, rows, 3);
    for (row, found) in inputs.chunks_exact(2).zip(found.chunks_exact(3)) {
        let twin = [erf(row[0]), erfc(row[0]), gaussian_mean(row[0], row[1])];
        for k in 0..3 {
            // exp is off by up to 62 units at -80.
            let tolerance = 2e-6 + 1e-5 * twin[k].abs();
            assert!(
                found[k].is_finite() && (found[k] - twin[k]).abs() <= tolerance,
                "{k} of {row:?}: {found:?}, {twin:?}"
            );
        }
    }
}

/// A widget of any kind over the unit square.
pub(crate) fn random_widget(random: &mut Random) -> Widget {
    let shape = match random.below(5) {
        0 => Shape::Uniform,
        1 => Shape::Gaussian {
            center: [random.between(0.0, 1.0), random.between(0.0, 1.0)],
            sigma: [10f64.powf(random.between(-1.7, 0.0)), 10f64.powf(random.between(-1.7, 0.0))],
        },
        kind => Shape::Wave {
            profile: [WaveProfile::Triangle, WaveProfile::AbsSine, WaveProfile::SineSquared][kind - 2],
            frequency: [random.between(-4.0, 4.0), random.between(-4.0, 4.0)],
            offset: random.between(-9.0, 9.0),
        },
    };
    let support = (random.below(2) == 0).then(|| {
        let [x, y] = [random.between(0.0, 0.5), random.between(0.0, 0.5)];
        Rectangle { s: [x, x + random.between(0.1, 0.5)], g: [y, y + random.between(0.1, 0.5)] }
    });
    let color = [0; 3].map(|_| random.between(0.0, 1.0));
    Widget::new(shape, support, 10f64.powf(random.between(-1.0, 1.0)), color).unwrap()
}

/// Both scalars at the front, both at the back, and a length; mesh cells span anything from nothing to all of the range.
pub(crate) fn random_segment(random: &mut Random) -> [f32; 5] {
    let front = [random.between(0.0, 1.0), random.between(0.0, 1.0)];
    let reach = 10f64.powf(random.between(-4.0, 0.0));
    let back = front.map(|f| f + reach * (random.between(0.0, 1.0) - f));
    let length = 10f64.powf(random.between(-3.0, 0.5));
    [front[0], front[1], back[0], back[1], length].map(|v| v as f32)
}

pub(crate) fn ends(row: &[f32]) -> ([f32; 2], [f32; 2], f32) {
    ([row[0], row[1]], [row[2], row[3]], row[4])
}

pub(crate) fn widget_bytes(widgets: &[widget_f32::Widget]) -> Vec<u8> {
    let rows = widgets.iter().flat_map(|w| {
        let floats = [w.color, w.support, w.shape].concat();
        floats.into_iter().map(f32::to_bits).chain(w.kind)
    });
    rows.flat_map(u32::to_ne_bytes).collect()
}

#[test]
fn tracks_of_widgets() {
    let mut random = Random::new(22);
    let function = BivariateFunction { widgets: (0..40).map(|_| random_widget(&mut random)).collect() };
    let device = widget_f32::widgets(&function, UNIT, 1.0);
    let rows = 100_000;
    let inputs: Vec<f32> = (0..rows)
        .flat_map(|_| {
            let widget = random.below(device.len()) as f32;
            let [u, v] = [random.between(0.0, 1.0) as f32, random.between(0.0, 1.0) as f32];
            [&random_segment(&mut random)[..], &[widget, u.min(v), u.max(v)]].concat()
        })
        .collect();
    let body = "let t = track(u32(x[5]), vec2<f32>(x[0], x[1]), vec2<f32>(x[2], x[3]), x[4]);
    y[0] = t.begin;
    y[1] = t.end;
    y[2] = track_rate(t, x[6]);
    y[3] = track_depth(t, x[6], x[7]);
    y[4] = track_slopes(t).x;
    y[5] = track_slopes(t).y;
    y[6] = kinks(t);
    y[7] = next_kink(t, x[6]);";
    let source = compose("lib::widget", DEFAULTS).unwrap() + &main_of(8, 8, body);
    let found = run(&source, &[Bound::Storage(0, 11, &widget_bytes(&device))], &inputs, rows, 8);
    let mut others = 0;
    for (row, found) in inputs.chunks_exact(8).zip(found.chunks_exact(8)) {
        let (front, back, length) = ends(row);
        let t = track(&device[row[5] as usize], front, back, length);
        let [slope, curvature] = track_slopes(&t);
        let twin = [
            t.from,
            t.to,
            track_rate(&t, row[6]),
            track_depth(&t, row[6], row[7]),
            slope,
            curvature,
            kinks(&t),
            next_kink(&t, row[6]),
        ];
        for k in 0..8 {
            let close = (found[k] - twin[k]).abs() <= ROUNDING * twin[k].abs().max(1.0);
            // Of two kinks that a rounding decides between either may be found, and what is only just seen may not be.
            others += usize::from(!close);
            assert!(found[k].is_finite() && (close || [0, 1, 7].contains(&k)), "{k} of {row:?}: {found:?}, {twin:?}");
        }
    }
    assert!(others * OTHERWISE_CUT <= rows, "{others}");
}

const WIDGETS: &str = "let r = integrate_share(vec2<f32>(x[0], x[1]), vec2<f32>(x[2], x[3]), x[4], x[5]);";

/// Segments, half of them right across the plane, with the share that each may err by.
fn shared_segments(random: &mut Random, rows: usize) -> Vec<[f32; 5]> {
    let segments = (0..rows).map(|i| {
        let mut segment = random_segment(random);
        if i % 2 == 0 {
            (segment[2], segment[3]) = (random.between(0.0, 1.0) as f32, random.between(0.0, 1.0) as f32);
        }
        segment
    });
    segments.collect()
}

#[test]
fn segments_through_widgets() {
    let mut random = Random::new(23);
    let source = compose("lib::widgets", DEFAULTS).unwrap() + &main_of(6, 5, &format!("{WIDGETS}{PUT}"));
    let rows = 4000;
    for count in [1, 2, 3, 5] {
        let function = BivariateFunction { widgets: (0..count).map(|_| random_widget(&mut random)).collect() };
        let device = widget_f32::widgets(&function, UNIT, 1.0);
        let segments = shared_segments(&mut random, rows);
        let pieces = [1e-2f32, 1e-3, 1e-4].map(|share| {
            let inputs: Vec<f32> = segments.iter().flat_map(|s| [&s[..], &[share]].concat()).collect();
            let found = run(&source, &[Bound::Storage(0, 11, &widget_bytes(&device))], &inputs, rows, 5);
            let twin = |row: &[f32]| {
                let (front, back, length) = ends(row);
                integrate_share(&device, front, back, length, row[5])
            };
            assert_eq!(difference(&inputs, 6, &found, twin, share), None);
            // The shader itself against f64: what is predicted of pieces of exact depth.
            let mut worst = 0.0f64;
            for (row, found) in inputs.chunks_exact(6).zip(found.chunks_exact(5)).take(100) {
                let [front, back] = [[row[0], row[1]], [row[2], row[3]]].map(|p| p.map(f64::from));
                let ray = RaySegment { front, back, length: f64::from(row[4]) };
                let exact = bivariate_segment(&function, 1.0, &ray, 2000, EmissionConvention::EmissionAbsorption);
                let error = (0..3).map(|c| (f64::from(found[c]) - exact.color[c]).abs()).fold(0.0, f64::max);
                let bound = f64::from(share) * exact.alpha;
                assert!(error <= bound + SINGLE, "{error:.1e} for {bound:.1e}: {row:?} {found:?}");
                assert!((f64::from(found[3]) - exact.alpha).abs() <= SINGLE, "{row:?}");
                worst = worst.max((error - SINGLE).max(0.0) / bound.max(1e-12));
            }
            let pieces = found.chunks_exact(5).map(|f| f64::from(f[4])).sum::<f64>() / rows as f64;
            println!("{count} widgets, share {share:.0e}: at most {worst:.2} of the bound, {pieces:.2} pieces");
            pieces
        });
        assert!(pieces.is_sorted(), "a looser share takes no more pieces: {pieces:?}");
    }
}

/// What shaders know a look by.
pub(crate) struct LookBytes {
    pub(crate) light: LightUniform,
    pub(crate) turning: Turning,
    pub(crate) image: Option<Image>,
    pub(crate) color_pieces: u32,
    /// Of the published modes: pieces, unit distances per device unit, and the table's unit.
    pub(crate) published: (u32, f32, f32),
}

impl LookBytes {
    pub(crate) fn none() -> LookBytes {
        let light = LightUniform { shares: [0.0; 4], direction: [0.0; 3], silhouette: 0.0 };
        LookBytes { light, turning: Turning::default(), image: None, color_pieces: 0, published: (0, 0.0, 0.0) }
    }

    pub(crate) fn bytes(&self) -> Vec<u8> {
        let (light, turning) = (&self.light, &self.turning);
        let image = self.image.as_ref();
        let place = image.map_or([0.0; 4], |i| [i.scale[0], i.scale[1], i.origin[0], i.origin[1]]);
        let floats = [
            &light.shares[..],
            &light.direction,
            &[light.silhouette, 0.0, turning.error, turning.slope, turning.curvature],
            &place,
        ];
        let [width, height] = image.map_or([0; 2], |i| i.size);
        let (pieces, emission, unit) = self.published;
        let last = [width, height, self.color_pieces, pieces, emission.to_bits(), unit.to_bits(), 0, 0];
        let no_data = [0; 4];
        let words = floats.concat().into_iter().map(f32::to_bits).chain(last).chain(no_data);
        words.flat_map(u32::to_ne_bytes).collect()
    }
}

#[test]
fn segments_through_images() {
    let mut random = Random::new(24);
    let rows = 4000;
    let body = format!("let r = integrate_counted(vec2<f32>(x[0], x[1]), vec2<f32>(x[2], x[3]), x[4], x[5]);{PUT}");
    let source = compose("lib::image", DEFAULTS).unwrap() + &main_of(6, 5, &body);
    for size in [1, 2, 5, 17] {
        let texels: Vec<[f32; 4]> = (0..size * size)
            .map(|_| {
                let opacity = (random.between(-2.0, 6.0)).max(0.0);
                [random.between(0.0, 1.0), random.between(0.0, 1.0), random.between(0.0, 1.0), opacity]
                    .map(|v| v as f32)
            })
            .collect();
        let function = ImageFunction::new(size, texels, [[0.1, 0.8], [0.2, 1.1]]).unwrap();
        let image = image_f32::image(&function, UNIT, 1.0);
        let texels: Vec<u8> = image.texels.iter().flatten().flat_map(|v| v.to_ne_bytes()).collect();
        let share = 1e-3f32;
        let inputs: Vec<f32> = (0..rows).flat_map(|_| [&random_segment(&mut random)[..], &[share]].concat()).collect();
        let look = LookBytes { image: Some(image.clone()), ..LookBytes::none() }.bytes();
        let bound = [Bound::Storage(0, 10, &look), Bound::Storage(0, 12, &texels)];
        let found = run(&source, &bound, &inputs, rows, 5);
        let twin = |row: &[f32]| {
            let (front, back, length) = ends(row);
            image_f32::integrate_counted(&image, front, back, length, row[5])
        };
        assert_eq!(difference(&inputs, 6, &found, twin, share), None);
    }
}

/// Seven nodes of colour, and seven of opacity up to 20.
fn random_transfer(random: &mut Random) -> TransferFunction {
    let mut heights = |most: f64| -> Vec<[f64; 2]> {
        let mut places: Vec<f64> = (0..7).map(|_| random.between(-0.2, 1.2)).collect();
        places.sort_by(f64::total_cmp);
        places.into_iter().map(|s| [s, random.between(0.0, most)]).collect()
    };
    let color: Vec<[f64; 4]> = heights(1.0).iter().map(|&[s, h]| [s, h, 1.0 - h, 0.5 * h]).collect();
    transfer(&color, &heights(20.0))
}

#[test]
fn segments_of_two_fields() {
    let mut random = Random::new(25);
    let rows = 4000;
    let body = format!("let r = Integrated(integrate(vec2<f32>(x[0], x[1]), vec2<f32>(x[2], x[3]), x[4]), 1u);{PUT}");
    let source = compose("function::two_fields", DEFAULTS).unwrap() + &main_of(5, 5, &body);
    for _ in 0..6 {
        let function = random_transfer(&mut random);
        let [color, opacity] = two_field_f32::axes(&function, UNIT, 1.0);
        let inputs: Vec<f32> = (0..rows).flat_map(|_| random_segment(&mut random)).collect();
        let look = LookBytes { color_pieces: color.len() as u32, ..LookBytes::none() }.bytes();
        let pieces = bytes(&[color.clone(), opacity.clone()].concat());
        let found = run(&source, &[Bound::Storage(0, 10, &look), Bound::Storage(0, 1, &pieces)], &inputs, rows, 5);
        let twin = |row: &[f32]| {
            let (front, back, length) = ends(row);
            Integrated { color: two_field_f32::integrate(&color, &opacity, front, back, length), pieces: 1 }
        };
        assert_eq!(difference(&inputs, 5, &found, twin, 0.0), None);
    }
}

fn random_light(random: &mut Random) -> Light {
    let direction = [0; 3].map(|_| random.between(-1.0, 1.0));
    let shares = [random.between(0.0, 0.4), random.between(0.0, 0.8), random.between(0.0, 0.5)];
    let silhouette = [0.0, random.between(1.0, 4.0)][random.below(2)];
    Light::new((random.below(2) == 0).then_some(direction), shares, random.between(1.0, 30.0), silhouette).unwrap()
}

fn random_gradient(random: &mut Random) -> [f32; 3] {
    let scale = [0.0, 10f64.powf(random.between(-4.0, 0.0))][random.below(20).min(1)];
    [0; 3].map(|_| (random.between(-1.0, 1.0) * scale) as f32)
}

#[test]
fn light_of_points() {
    let mut random = Random::new(26);
    let rows = 20_000;
    let body = "let n = normal(vec3<f32>(x[0], x[1], x[2]));
    let eye = vec3<f32>(x[3], x[4], x[5]);
    let color = lit(vec3<f32>(x[6], x[7], x[8]), n, look.direction, half_way(look.direction, eye));
    for (var k = 0u; k < 3u; k++) {
        y[k] = color[k];
    }
    y[3] = silhouette_factor(n, eye);";
    let source = compose("lib::light", DEFAULTS).unwrap() + &main_of(9, 4, body);
    for _ in 0..6 {
        let light = LightUniform::new(&random_light(&mut random), |d| d);
        let inputs: Vec<f32> = (0..rows)
            .flat_map(|_| {
                let eye = normal(random_gradient(&mut random));
                let color = [0; 3].map(|_| random.between(0.0, 1.0) as f32);
                [random_gradient(&mut random), eye, color].concat()
            })
            .collect();
        let look = LookBytes { light, ..LookBytes::none() }.bytes();
        let found = run(&source, &[Bound::Storage(0, 10, &look)], &inputs, rows, 4);
        for (row, found) in inputs.chunks_exact(9).zip(found.chunks_exact(4)) {
            let [gradient, eye, color] = [0, 3, 6].map(|k| [row[k], row[k + 1], row[k + 2]]);
            let n = normal(gradient);
            let [r, g, b] = lit(&light, color, n, light.direction, half_way(light.direction, eye));
            let twin = [r, g, b, silhouette_factor(&light, n, eye)];
            for k in 0..4 {
                assert!((found[k] - twin[k]).abs() <= ROUNDING, "{k} of {row:?}: {found:?} and {twin:?}");
            }
        }
    }
}

/// A mat2x4 of both scalars and the gradient at either end, of a row of 14: both scalars at the front and at the back, the
/// length, the gradients, the unit vector to the eye.
const LIT: &str = "
    let front = mat2x4<f32>(vec4<f32>(x[0], x[1], 0.0, 0.0), vec4<f32>(x[5], x[6], x[7], 0.0));
    let back = mat2x4<f32>(vec4<f32>(x[2], x[3], 0.0, 0.0), vec4<f32>(x[8], x[9], x[10], 0.0));
    let r = integrate_lit(vec2<u32>(0u, RANGE), front, back, x[4], vec3<f32>(x[11], x[12], x[13]));";

fn lit_rows(random: &mut Random, rows: usize) -> Vec<f32> {
    (0..rows)
        .flat_map(|_| {
            let segment = random_segment(random);
            let front = random_gradient(random);
            // Half of them turn as little as they do within a cell.
            let turned = random_gradient(random);
            let back = if random.below(2) == 0 { turned } else { [0, 1, 2].map(|k| front[k] + 0.1 * turned[k]) };
            let eye = normal([0; 3].map(|_| random.between(-1.0, 1.0) as f32));
            [&segment[..], &front, &back, &eye].concat()
        })
        .collect()
}

fn vectors(row: &[f32]) -> ([[f32; 3]; 2], [f32; 3]) {
    let [front, back, eye] = [5, 8, 11].map(|k| [row[k], row[k + 1], row[k + 2]]);
    ([front, back], eye)
}

#[test]
fn lit_segments_of_any_function() {
    let mut random = Random::new(27);
    let rows = 4000;
    let choices = choose(DEFAULTS, &[("function", "function::two_fields")]);
    let source = compose("lit::turns", &choices).unwrap() + &main_of(14, 5, &(LIT.replace("RANGE", "0u") + PUT));
    for error in [1e-2f32, 1e-3, 1e-4] {
        let function = random_transfer(&mut random);
        let [color, opacity] = two_field_f32::axes(&function, UNIT, 1.0);
        let model = random_light(&mut random);
        let light = LightUniform::new(&model, |d| d);
        let turning = Turning::new(&model, 2.0, error);
        let inputs = lit_rows(&mut random, rows);
        let look = LookBytes { light, turning, color_pieces: color.len() as u32, ..LookBytes::none() }.bytes();
        let pieces = bytes(&[color.clone(), opacity.clone()].concat());
        let found = run(&source, &[Bound::Storage(0, 10, &look), Bound::Storage(0, 1, &pieces)], &inputs, rows, 5);
        let twin = |row: &[f32]| {
            let (gradients, eye) = vectors(row);
            let classified = |from: f32, to: f32, factor: f32| {
                let at = |u: f32| [0, 1].map(|k| row[k] + (row[2 + k] - row[k]) * u);
                let length = row[4] * (to - from) * factor;
                let color = two_field_f32::integrate(&color, &opacity, at(from), at(to), length);
                Integrated { color, pieces: 1 }
            };
            integrate_lit(&light, &turning, gradients, eye, classified)
        };
        // The light of two cuts by the same error is within twice that of each other, of luminances up to 2.
        assert_eq!(difference(&inputs, 14, &found, twin, 2.0 * error), None);
    }
}

#[test]
fn lit_segments_that_are_linear_between_nodes() {
    let mut random = Random::new(29);
    let rows = 4000;
    let [one, two] = ["lit::one_field", "lit::two_fields"].map(|module| {
        let main = main_of(14, 5, &(LIT.replace("RANGE", "arrayLength(&pieces) - 1u") + PUT));
        compose(module, DEFAULTS).unwrap() + &main
    });
    for error in [1e-2f32, 1e-3, 1e-4] {
        let function = random_transfer(&mut random);
        let light = LightUniform::new(&random_light(&mut random), |d| d);
        let inputs = lit_rows(&mut random, rows);
        let illuminated = |row: &[f32]| {
            let (gradients, eye) = vectors(row);
            Illuminated { light, eye, gradients, length: row[4], error }
        };
        let turning = Turning { error, ..Turning::default() };
        let look = LookBytes { light, turning, ..LookBytes::none() };
        let pieces = transfer_f32::pieces(&function, UNIT[0], 1.0);
        let (uniform, buffer) = (look.bytes(), bytes(&pieces));
        let found = run(&one, &[Bound::Storage(0, 10, &uniform), Bound::Storage(0, 1, &buffer)], &inputs, rows, 5);
        let twin = |row: &[f32]| one_field(&illuminated(row), &pieces, Weights::Direct, row[0], row[2]);
        assert_eq!(difference(&inputs, 14, &found, twin, 2.0 * error), None);
        let [color, opacity] = two_field_f32::axes(&function, UNIT, 1.0);
        let uniform = LookBytes { color_pieces: color.len() as u32, ..look }.bytes();
        let buffer = bytes(&[color.clone(), opacity.clone()].concat());
        let found = run(&two, &[Bound::Storage(0, 10, &uniform), Bound::Storage(0, 1, &buffer)], &inputs, rows, 5);
        let twin = |row: &[f32]| {
            let (front, back, _) = ends(row);
            two_fields(&illuminated(row), &color, &opacity, front, back)
        };
        assert_eq!(difference(&inputs, 14, &found, twin, 2.0 * error), None);
    }
}

#[test]
fn a_planted_difference_in_a_shader_is_seen() {
    let mut random = Random::new(28);
    let function = BivariateFunction { widgets: (0..2).map(|_| random_widget(&mut random)).collect() };
    let device = widget_f32::widgets(&function, UNIT, 1.0);
    let sound = compose("lib::widgets", DEFAULTS).unwrap() + &main_of(6, 5, &format!("{WIDGETS}{PUT}"));
    let planted = sound.replace("sum.depth += depth;", "sum.depth += 1.001 * depth;");
    let inputs: Vec<f32> = shared_segments(&mut random, 100).iter().flat_map(|s| [&s[..], &[1e-3]].concat()).collect();
    let [sound, planted] = [sound, planted].map(|source| {
        let found = run(&source, &[Bound::Storage(0, 11, &widget_bytes(&device))], &inputs, 100, 5);
        let twin = |row: &[f32]| {
            let (front, back, length) = ends(row);
            integrate_share(&device, front, back, length, row[5])
        };
        difference(&inputs, 6, &found, twin, 1e-3)
    });
    assert!(sound.is_none() && planted.is_some(), "a depth that is a thousandth too large");
}
