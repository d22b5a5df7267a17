//! Luminance and opacity at a point, by their definitions, and the places along a segment where they are not smooth.

use glam::{DVec2, DVec3};
use tetlux_optics::widget::{Rectangle, Shape, WaveProfile, Widget};
use tetlux_optics::{Classification, Light, NoData};

use crate::walk::{GRADIENT, Segment, Values};

/// More zeros and peaks of a wave than this are not cut at one by one.
const MOST_CUTS: f64 = 65_536.0;

/// Where a Gaussian is cut, in units of sqrt 2 sigma from the middle: so that no rule oversees it.
const GAUSSIAN_CUTS: [f64; 11] = [-8.0, -4.0, -2.0, -1.0, -0.5, 0.0, 0.5, 1.0, 2.0, 4.0, 8.0];

/// How one ray sees: the unit vectors to the eye, to the light, and half-way between them (0 if they are opposite).
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Sight {
    pub(crate) eye: DVec3,
    light: DVec3,
    half: DVec3,
}

impl Sight {
    /// How a ray of this direction sees what a light, if there is one, shines on.
    pub(crate) fn new(light: Option<&Light>, direction: DVec3) -> Self {
        let eye = -direction.normalize_or_zero();
        let Some(light) = light else { return Self { eye, ..Self::default() } };
        let light = light.direction().map_or(eye, DVec3::from);
        Self { eye, light, half: (light + eye).normalize_or_zero() }
    }
}

/// What a stretch without cuts knows of itself, so that steps at its ends are seen from inside.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Inside {
    /// The control points around the scalar of the luminance, and around that of the opacity.
    color: [f64; 2],
    opacity: [f64; 2],
    /// A point inside.
    point: [f64; 2],
}

/// What is asked of a point.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Appearance {
    pub(crate) opacity: f64,
    /// Luminance times opacity.
    pub(crate) emission: [f64; 3],
}

/// A classification, and a light if there is one.
pub(crate) struct Definition<'a> {
    classification: &'a Classification,
    light: Option<&'a Light>,
    /// Luminance and opacity are what is known of a point.
    given: bool,
    /// What is seen where a value is missing.
    pub(crate) no_data: NoData,
    /// Control points of a transfer function: of the luminance and of the opacity. Of an image, its nodes along the
    /// first and the second axis.
    color_points: Vec<f64>,
    opacity_points: Vec<f64>,
}

impl<'a> Definition<'a> {
    pub(crate) fn new(classification: &'a Classification, light: Option<&'a Light>, given: bool) -> Self {
        let (color_points, opacity_points) = match classification {
            Classification::OneField(transfer) => (transfer.control_points(), transfer.control_points()),
            Classification::TwoFields(transfer) => (
                distinct(transfer.color_nodes().iter().map(|node| node.s)),
                distinct(transfer.opacity_nodes().iter().map(|node| node.s)),
            ),
            Classification::Image(image) => {
                let nodes = |axis: usize| {
                    let ([low, high], count) = (image.range()[axis], image.size()[axis]);
                    let share = |k: usize| k as f64 / (count - 1).max(1) as f64;
                    (0..count).map(|k| low * (1.0 - share(k)) + high * share(k)).collect()
                };
                (nodes(0), nodes(1))
            }
            Classification::Widgets(_) => (Vec::new(), Vec::new()),
        };
        Self { classification, light, given, no_data: NoData::default(), color_points, opacity_points }
    }

    /// The largest luminance, at least 1: what an error of the transmittance may cost.
    pub(crate) fn brightest(&self) -> f64 {
        let lit = self.light.map_or([1.0, 0.0], |light| {
            let [ambient, diffuse, specular] = light.shares();
            [ambient + diffuse, specular]
        });
        let no_data = self.no_data.luminance().into_iter().fold(1.0, f64::max);
        (self.classification.brightest() * lit[0] + lit[1]).max(no_data)
    }

    /// How a ray of this direction sees.
    pub(crate) fn sight(&self, direction: DVec3) -> Sight {
        Sight::new(self.light, direction)
    }

    /// Appends the shares of a segment at which something is not smooth; some may lie outside (0, 1).
    pub(crate) fn cuts(&self, segment: &Segment, sight: &Sight, cuts: &mut Vec<f64>) {
        let [front, back] = segment.values;
        if is_missing(&front) {
            return;
        }
        match self.classification {
            // Linear throughout.
            _ if self.given => {}
            Classification::OneField(_) => crossings(&self.color_points, [front[0], back[0]], cuts),
            Classification::TwoFields(_) | Classification::Image(_) => {
                crossings(&self.color_points, [front[0], back[0]], cuts);
                crossings(&self.opacity_points, [front[1], back[1]], cuts);
            }
            Classification::Widgets(function) => {
                for widget in function.widgets.iter().filter(|widget| widget.max_opacity() > 0.0) {
                    widget_cuts(widget, [[front[0], front[1]], [back[0], back[1]]], cuts);
                }
            }
        }
        if self.light.is_some() {
            let [front, back] = [gradient(&front), gradient(&back)];
            // Faces turn over where the gradient is perpendicular to a vector; it turns fastest where it is shortest.
            for vector in [sight.eye, sight.light, sight.half] {
                cuts.push(front.dot(vector) / (front - back).dot(vector));
            }
            cuts.push(front.dot(front - back) / (front - back).length_squared());
        }
    }

    /// The stretch between cuts around a point.
    pub(crate) fn inside(&self, values: &Values) -> Inside {
        let opacity_scalar = self.opacity_scalar(values);
        Inside {
            color: around(&self.color_points, values[0]),
            opacity: around(&self.opacity_points, opacity_scalar),
            point: [values[0], values[1]],
        }
    }

    /// Opacity and emission of a point, as limits from inside a stretch.
    pub(crate) fn look_up(&self, inside: &Inside, values: &Values, sight: &Sight) -> Appearance {
        if is_missing(values) {
            let opacity = self.no_data.opacity();
            return Appearance { opacity, emission: self.no_data.luminance().map(|l| l * opacity) };
        }
        let (opacity, luminance) = self.classify(inside, values);
        if opacity == 0.0 {
            return Appearance::default();
        }
        let (factor, luminance) = self.light.map_or((1.0, luminance), |light| lit(light, luminance, values, sight));
        let opacity = opacity * factor;
        Appearance { opacity, emission: luminance.map(|l| l * opacity) }
    }

    fn opacity_scalar(&self, values: &Values) -> f64 {
        values[usize::from(matches!(self.classification, Classification::TwoFields(_)))]
    }

    fn classify(&self, inside: &Inside, values: &Values) -> (f64, [f64; 3]) {
        if self.given {
            let [r, g, b, opacity, ..] = *values;
            return (opacity, [r, g, b]);
        }
        match self.classification {
            Classification::OneField(transfer) | Classification::TwoFields(transfer) => {
                let within = |s: f64, [low, high]: [f64; 2]| {
                    let s = s.clamp(low, high);
                    (s, s == high)
                };
                let (s, below) = within(self.opacity_scalar(values), inside.opacity);
                let opacity = if below { transfer.opacity_below(s) } else { transfer.opacity(s) };
                if opacity == 0.0 {
                    return (0.0, [0.0; 3]);
                }
                let (s, below) = within(values[0], inside.color);
                (opacity, if below { transfer.luminance_below(s) } else { transfer.luminance(s) })
            }
            Classification::Widgets(function) => {
                let (mut opacity, mut emission) = (0.0, [0.0; 3]);
                for widget in &function.widgets {
                    if widget.support().is_none_or(|support| contains(support, inside.point)) {
                        let own = widget.max_opacity() * share(widget.shape(), [values[0], values[1]]);
                        opacity += own;
                        for channel in 0..3 {
                            emission[channel] += own * widget.color()[channel];
                        }
                    }
                }
                let luminance = if opacity > 0.0 { emission.map(|e| e / opacity) } else { [0.0; 3] };
                (opacity, luminance)
            }
            Classification::Image(image) => {
                let [r, g, b, opacity] = image.at([values[0], values[1]]);
                (opacity, [r, g, b])
            }
        }
    }
}

fn distinct(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut values: Vec<f64> = values.collect();
    values.dedup();
    values
}

/// Whether these are the values of a cell without data.
fn is_missing(values: &Values) -> bool {
    values[0].is_nan()
}

fn gradient(values: &Values) -> DVec3 {
    DVec3::new(values[GRADIENT], values[GRADIENT + 1], values[GRADIENT + 2])
}

/// The ascending `points` around a value; one at the value is below it. Infinite at the ends of the axis.
fn around(points: &[f64], value: f64) -> [f64; 2] {
    let next = points.partition_point(|&point| point <= value);
    let low = next.checked_sub(1).map_or(f64::NEG_INFINITY, |i| points[i]);
    [low, points.get(next).copied().unwrap_or(f64::INFINITY)]
}

/// Shares of a segment at which a scalar, linear along it, takes one of the ascending `points` between its ends.
fn crossings(points: &[f64], [front, back]: [f64; 2], cuts: &mut Vec<f64>) {
    let [low, high] = [front.min(back), front.max(back)];
    let first = points.partition_point(|&point| point <= low);
    let crossed = points[first..].iter().take_while(|&&point| point < high);
    // Halves, so that the difference of two large scalars does not overflow.
    cuts.extend(crossed.map(|&point| (0.5 * point - 0.5 * front) / (0.5 * back - 0.5 * front)));
}

fn widget_cuts(widget: &Widget, [front, back]: [[f64; 2]; 2], cuts: &mut Vec<f64>) {
    if let Some(support) = widget.support() {
        for (axis, edges) in [support.s, support.g].into_iter().enumerate() {
            crossings(&edges, [front[axis], back[axis]], cuts);
        }
    }
    match *widget.shape() {
        Shape::Uniform => {}
        Shape::Gaussian { center, sigma } => {
            let place = |p: [f64; 2]| (DVec2::from(p) - DVec2::from(center)) / DVec2::from(sigma);
            let (from, step) = (place(front), place(back) - place(front));
            let squared = step.length_squared();
            if squared > 0.0 {
                let nearest = -from.dot(step) / squared;
                let unit = std::f64::consts::SQRT_2 / squared.sqrt();
                cuts.extend(GAUSSIAN_CUTS.map(|k| nearest + k * unit));
            }
        }
        Shape::Wave { frequency, offset, .. } => {
            let [from, to] = [front, back].map(|p| DVec2::from(frequency).dot(p.into()) + offset);
            let [low, high] = [from.min(to), from.max(to)].map(|phase| 2.0 * phase);
            let stride = ((high - low) / MOST_CUTS).ceil().max(1.0);
            let mut half_period = low.floor() + 1.0;
            // A step that rounding swallows would never end.
            while half_period < high && half_period + stride > half_period {
                cuts.push((0.5 * half_period - from) / (to - from));
                half_period += stride;
            }
        }
    }
}

/// Whether a point lies in a rectangle or on its edge.
fn contains(rectangle: &Rectangle, [x, y]: [f64; 2]) -> bool {
    rectangle.s[0] <= x && x <= rectangle.s[1] && rectangle.g[0] <= y && y <= rectangle.g[1]
}

/// Opacity of a shape as a share of its largest.
fn share(shape: &Shape, [x, y]: [f64; 2]) -> f64 {
    match *shape {
        Shape::Uniform => 1.0,
        Shape::Gaussian { center, sigma } => {
            let [u, v] = [(x - center[0]) / sigma[0], (y - center[1]) / sigma[1]];
            (-0.5 * (u * u + v * v)).exp()
        }
        Shape::Wave { profile, frequency, offset } => {
            let phase = frequency[0] * x + frequency[1] * y + offset;
            let fraction = phase - phase.floor();
            match profile {
                WaveProfile::Triangle => 1.0 - (2.0 * fraction - 1.0).abs(),
                WaveProfile::AbsSine => (std::f64::consts::PI * fraction).sin().max(0.0),
                WaveProfile::SineSquared => (std::f64::consts::PI * fraction).sin().powi(2),
            }
        }
    }
}

/// Factor of the opacity, and the luminance lit.
fn lit(light: &Light, luminance: [f64; 3], values: &Values, sight: &Sight) -> (f64, [f64; 3]) {
    let [ambient, diffuse, _] = light.shares();
    let Some(normal) = gradient(values).try_normalize() else {
        return (1.0, luminance.map(|l| l * (ambient + diffuse)));
    };
    let facing = normal.dot(sight.eye).abs().min(1.0);
    let factor = if light.silhouette() > 0.0 { (1.0 - facing).powf(light.silhouette()) } else { 1.0 };
    (factor, lit_surface(light, luminance, normal, sight))
}

/// The luminance of a surface of this unit normal, lit on both sides.
pub(crate) fn lit_surface(light: &Light, luminance: [f64; 3], normal: DVec3, sight: &Sight) -> [f64; 3] {
    let [ambient, diffuse, specular] = light.shares();
    let cosine = |v: DVec3| normal.dot(v).abs().min(1.0);
    let highlight = specular * cosine(sight.half).powf(light.shininess());
    luminance.map(|l| l * (ambient + diffuse * cosine(sight.light)) + highlight)
}
