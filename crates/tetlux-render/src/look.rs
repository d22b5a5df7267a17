//! What a scene asks for beyond one field's transfer function: a second scalar, light, silhouettes.
//!
//! A segment is shaded from the values at its two ends, between which they are linear: [`Look::shade`].
//!
//! # Error
//!
//! A ray's segments have opacities a_i and see through T_i of what is before them, and the sum of a_i T_i is the ray's
//! opacity, at most 1. A segment's light that errs by at most e a_i therefore lets the pixel err by at most e, however
//! many segments there are: each is given that share of its own opacity.
//!
//! Light is constant on pieces over which the normal turns by the same angle: it is that of the point at which even
//! extinction would absorb on average. With the slope V and the curvature W of the lit luminance over the normal's
//! angle, and a turn of t in n pieces, a piece errs by at most V t / n times its opacity, whatever is in it. Where
//! opacity and colour vary by no more than themselves over the segment, what varies evenly about that point cancels,
//! and V t / (12 n^2) + W t^2 / (24 n^2) is left; where they end within a piece, that piece alone (a_i / n of the opacity)
//! errs by V t / (2 n). [`Look::turns`] takes n for V t / (4 n^2) + W t^2 / (16 n^2). Peaks that are narrower than a piece
//! are not covered by that: the error is then the larger for its part, and what is measured has to say.

#[cfg(test)]
mod tests;

use glam::{DVec3, Vec3};
use tetlux_mesh::{Location, ScalarField};
use tetlux_optics::Classification;
use tetlux_optics::image_f32::{self, Image};
use tetlux_optics::light_f32::{LightUniform, half_way, lit, normal, silhouette_factor};
use tetlux_optics::lit_linear_f32::{Illuminated, one_field, two_fields};
use tetlux_optics::segment_f32::weights_direct;
use tetlux_optics::transfer_f32::{self, Piece, Weights};
use tetlux_optics::two_field_f32;
use tetlux_optics::widget_f32::{self, Widget};
use tetlux_optics::widgets_f32::{self, Integrated};
use tetlux_scene::{Lighting, Scene};

use crate::RenderError;
use crate::device_mesh::normalised;
use crate::eye_space::EyeSpace;
use crate::published::Published;

/// Shares of the allowed error that the colour of a segment may take, without light and with it, and the light. The
/// rest is for single precision and for what is hidden.
const COLOR_SHARE: f64 = 0.8;
const COLOR_SHARE_LIT: f64 = 0.4;
const LIGHT_SHARE: f64 = 0.4;

/// What single precision cannot hold is not asked for.
const LEAST_ERROR: f64 = 1e-6;

/// A segment's light is held on no more pieces than this.
const MOST_TURNS: f32 = 256.0;

/// Luminance and extinction over normalised scalars.
#[derive(Debug)]
enum Function {
    OneField(Vec<Piece>, Weights),
    TwoFields([Vec<Piece>; 2]),
    Widgets(Vec<Widget>),
    Image(Image),
}

/// A further field of the mesh: linear in each cell like the first scalar, or constant.
#[derive(Debug)]
pub(crate) struct Further {
    pub(crate) location: Location,
    /// Normalised.
    pub(crate) values: Vec<f64>,
}

/// How segments are shaded, and the fields that it takes.
#[derive(Debug)]
pub(crate) struct Look {
    /// The second scalar if there is one, then the gradient's coordinates in the axes of eye space if there is light.
    pub(crate) further: Vec<Further>,
    /// The largest luminance, lit.
    pub(crate) brightest: f64,
    has_second: bool,
    function: Function,
    /// Not the integrals of emission-absorption, but those of Song et al., and the unit distances per device unit.
    published: Option<Published>,
    emission: f32,
    light: Option<LightUniform>,
    /// Errors of colour and of light for an opacity of 1.
    errors: [f32; 2],
    /// Bounds of the lit luminance's slope and curvature over the normal's angle.
    slope: f32,
    curvature: f32,
}

/// Segments that were shaded one by one: those of a scene with two fields or light.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Spent {
    /// Segments of rays in cells.
    pub segments: u64,
    /// Pieces into which they were cut to keep to the error budget.
    pub pieces: u64,
}

impl Spent {
    /// Mean pieces of a segment.
    pub fn mean(&self) -> f64 {
        self.pieces as f64 / self.segments.max(1) as f64
    }

    pub(crate) fn and(self, other: Spent) -> Spent {
        Spent { segments: self.segments + other.segments, pieces: self.pieces + other.pieces }
    }
}

/// A part of a ray in a cell, by the values at its two ends.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Segment {
    /// Normalised scalars.
    pub(crate) front: [f32; 2],
    pub(crate) back: [f32; 2],
    /// Gradients in eye space, of any unit.
    pub(crate) gradients: [Vec3; 2],
    /// In device units.
    pub(crate) length: f32,
    /// Unit vector to the eye, in eye space.
    pub(crate) view: [f32; 3],
    /// The first and the last piece of the transfer function that the cell meets, where there is one.
    pub(crate) pieces: [usize; 2],
}

fn mix<const N: usize>(front: [f32; N], back: [f32; N], u: f32) -> [f32; N] {
    std::array::from_fn(|i| front[i] + (back[i] - front[i]) * u)
}

impl Look {
    /// None where one field's transfer function is all there is: nothing is made then. `pieces` are its pieces,
    /// `extinction` is that of opacity 1 per device unit, `across` the longest ray, in device units.
    ///
    /// # Errors
    ///
    /// A scene that lacks the second scalar or the gradients that it needs.
    pub(crate) fn new(
        scene: &Scene,
        points: usize,
        eye: &EyeSpace,
        (pieces, weights): (&[Piece], Weights),
        extinction: f64,
        published: Option<Published>,
        across: f64,
    ) -> Result<Option<Look>, RenderError> {
        let bivariate = scene.classification.is_bivariate();
        if !bivariate && scene.lighting.is_none() {
            return Ok(None);
        }
        let second = scene.second.as_ref().filter(|_| bivariate);
        if bivariate && second.is_none() {
            return Err(RenderError::Missing("a second scalar"));
        }
        let ranges = [scene.scalar.range, second.map_or([0.0, 1.0], |second| second.range)];
        let function = match &scene.classification {
            Classification::OneField(_) => Function::OneField(pieces.to_vec(), weights),
            Classification::TwoFields(transfer) => {
                Function::TwoFields(two_field_f32::axes(transfer, ranges, extinction))
            }
            Classification::Widgets(function) if published.is_some() => {
                Function::Widgets(widget_f32::widgets(&function.as_published(), ranges, extinction))
            }
            Classification::Widgets(function) => Function::Widgets(widget_f32::widgets(function, ranges, extinction)),
            Classification::Image(image) => Function::Image(image_f32::image(image, ranges, extinction)),
        };
        let mut further: Vec<Further> = second.map(scalar_values).into_iter().collect();
        let mut brightest = scene.classification.brightest();
        if published.is_some() {
            // All along a ray may glow.
            brightest *= across * extinction;
        }
        let (mut slope, mut curvature) = (0.0, 0.0);
        let mut light = None;
        if let Some(lighting) = &scene.lighting {
            if lighting.gradients.len() != points {
                return Err(RenderError::Missing("a gradient for every point"));
            }
            further.extend(gradient_values(lighting, eye));
            light = Some(LightUniform::new(&lighting.light, |d| eye.frame(DVec3::from(d)).to_array()));
            let ([ambient, diffuse, specular], p) = (lighting.light.shares(), lighting.light.shininess());
            let k = lighting.light.silhouette();
            let plain = brightest;
            brightest = plain * (ambient + diffuse) + specular;
            // cos^p is steepest where cos^2 = 1 - 1/p; (1 - |cos|)^k has the slope k at most, for k of 1 and more.
            slope = plain * diffuse + specular * (p / std::f64::consts::E).sqrt().min(p) + brightest * k;
            curvature = plain * diffuse + specular * p + brightest * k * (k + 1.0);
        }
        let share = if light.is_some() { COLOR_SHARE_LIT } else { COLOR_SHARE };
        let error = |share: f64| (share * scene.method.max_error).max(LEAST_ERROR) as f32;
        Ok(Some(Look {
            further,
            brightest,
            has_second: bivariate,
            function,
            published,
            emission: extinction as f32,
            light,
            errors: [error(share), error(LIGHT_SHARE)],
            slope: slope as f32,
            curvature: curvature as f32,
        }))
    }

    /// Both scalars' and the gradient's values at the two ends, of the first scalar's and those of [`Look::further`].
    pub(crate) fn values(&self, first: [f32; 2], mut further: impl Iterator<Item = [f32; 2]>) -> Ends {
        let mut next = || further.next().unwrap_or_default();
        let second = if self.has_second { next() } else { [0.0; 2] };
        let [x, y, z] = [next(), next(), next()];
        Ends {
            scalars: [0, 1].map(|end| [first[end], second[end]]),
            gradients: [0, 1].map(|end| Vec3::new(x[end], y[end], z[end])),
        }
    }

    /// Premultiplied colour and alpha of a segment, and the pieces that it took.
    pub(crate) fn shade(&self, segment: &Segment) -> Integrated {
        match &self.light {
            None => self.classify(segment, 0.0, 1.0, 1.0),
            Some(light) => match &self.function {
                Function::OneField(pieces, weights) => {
                    let lit = self.illuminated(light, segment);
                    one_field(&lit, pieces, *weights, segment.front[0], segment.back[0])
                }
                Function::TwoFields([color, opacity]) => {
                    two_fields(&self.illuminated(light, segment), color, opacity, segment.front, segment.back)
                }
                Function::Widgets(_) | Function::Image(_) => self.lit(light, segment),
            },
        }
    }

    /// Of functions that are linear between nodes colour is exact: light may err by all that is allowed.
    fn illuminated(&self, light: &LightUniform, segment: &Segment) -> Illuminated {
        Illuminated {
            light: *light,
            eye: segment.view,
            gradients: segment.gradients.map(|g| g.to_array()),
            length: segment.length,
            error: self.errors[0] + self.errors[1],
        }
    }

    /// The part of a segment between two shares, unlit, with its extinction times a factor.
    fn classify(&self, segment: &Segment, from: f32, to: f32, factor: f32) -> Integrated {
        let front = mix(segment.front, segment.back, from);
        let back = mix(segment.front, segment.back, to);
        let length = segment.length * (to - from) * factor;
        let one = |color| Integrated { color, pieces: 1 };
        match &self.function {
            Function::OneField(pieces, weights) => {
                one(transfer_f32::integrate(pieces, segment.pieces, *weights, front[0], back[0], length))
            }
            Function::TwoFields([color, opacity]) => one(two_field_f32::integrate(color, opacity, front, back, length)),
            Function::Widgets(widgets) => match &self.published {
                None => widgets_f32::integrate_share(widgets, front, back, length, self.errors[0]),
                Some(published) => published.widgets(widgets, front, back, length, self.emission),
            },
            Function::Image(image) => match &self.published {
                None => image_f32::integrate_counted(image, front, back, length, self.errors[0]),
                Some(published) => published.image(image, front, back, length, self.emission),
            },
        }
    }

    /// In how many pieces the light of a segment is held over which the normal turns by an angle.
    fn turns(&self, angle: f32) -> f32 {
        let error = angle * (self.slope / 4.0 + self.curvature * angle / 16.0);
        (error / self.errors[1]).sqrt().ceil().clamp(1.0, MOST_TURNS)
    }

    fn lit(&self, light: &LightUniform, segment: &Segment) -> Integrated {
        let [front, back] = segment.gradients;
        let toward = if light.direction == [0.0; 3] { segment.view } else { light.direction };
        let half = half_way(toward, segment.view);
        let normal_at = |u: f32| normal((front + (back - front) * u).to_array());
        let factor_at = |u: f32| silhouette_factor(light, normal_at(u), segment.view);
        let angle = angle_between(front, back);
        let count = self.turns(angle);
        if count > 1.0 {
            let whole = self.classify(segment, 0.0, 1.0, 1.0);
            if whole.color[3] <= 0.0 {
                // Nothing is seen: there is nothing to light.
                return whole;
            }
        }
        let [near, far] = [front.length(), back.length()];
        let mut result = Integrated::default();
        let mut from = 0.0;
        for k in 1..=count as u32 {
            // Where the normal has turned by k / count of the angle.
            let turned = angle * (k as f32 / count);
            let (ahead, behind) = (near * turned.sin(), far * (angle - turned).max(0.0).sin());
            let to = if k as f32 == count { 1.0 } else { (ahead / (ahead + behind)).clamp(from, 1.0) };
            let mut factor = 1.0;
            if light.silhouette != 0.0 {
                factor = (factor_at(from) + 4.0 * factor_at(0.5 * (from + to)) + factor_at(to)) / 6.0;
            }
            let part = self.classify(segment, from, to, factor);
            let alpha = part.color[3];
            if alpha > 0.0 {
                let at = from + (to - from) * absorbed_at(alpha);
                let [r, g, b, _] = part.color.map(|c| c / alpha);
                let luminance = lit(light, [r, g, b], normal_at(at), toward, half);
                let seen = (1.0 - result.color[3]) * alpha;
                for channel in 0..3 {
                    result.color[channel] += seen * luminance[channel];
                }
                result.color[3] += seen;
            }
            result.pieces += part.pieces;
            from = to;
        }
        result
    }
}

/// Values at the two ends of a segment.
pub(crate) struct Ends {
    pub(crate) scalars: [[f32; 2]; 2],
    pub(crate) gradients: [Vec3; 2],
}

/// Where in a piece of even extinction light is absorbed on average: at 1/2 if it is thin, near the front if thick.
fn absorbed_at(alpha: f32) -> f32 {
    let depth = -(-alpha.min(0.999_999)).ln_1p();
    let [alpha, back, _] = weights_direct(depth, depth);
    if alpha > 1e-6 { back / alpha } else { 0.5 }
}

/// The angle between two gradients; 0 if one of them is none, as nothing turns then.
fn angle_between(a: Vec3, b: Vec3) -> f32 {
    let [a, b] = [a, b].map(|g| Vec3::from(normal(g.to_array())));
    if a == Vec3::ZERO || b == Vec3::ZERO { 0.0 } else { a.cross(b).length().atan2(a.dot(b)) }
}

fn scalar_values(scalar: &ScalarField) -> Further {
    Further { location: scalar.location, values: scalar.values.iter().map(|&s| normalised(scalar, s)).collect() }
}

/// The gradient's coordinates in the axes of eye space, the longest gradient of length 1.
fn gradient_values(lighting: &Lighting, eye: &EyeSpace) -> [Further; 3] {
    let finite = |g: &DVec3| if g.is_finite() { *g } else { DVec3::ZERO };
    let largest = lighting.gradients.iter().map(|g| finite(g).abs().max_element()).fold(0.0, f64::max);
    let unit = if largest > 0.0 { largest } else { 1.0 };
    [0, 1, 2].map(|axis| {
        let coordinate = |g: &DVec3| eye.frame(finite(g) / unit)[axis];
        Further { location: Location::Point, values: lighting.gradients.iter().map(coordinate).collect() }
    })
}
