//! What a scene asks for beyond one field's transfer function: a second scalar, luminance and extinction at the vertices,
//! light, silhouettes.
//!
//! A segment is shaded from the values at its two ends, between which they are linear: [`Look::shade`].
//!
//! Every segment may err by a share of its own opacity: those of a ray, as far as they are seen, add up to 1 at most, so that
//! the pixel errs by no more than that share, however many segments there are. How light keeps to it is told in
//! [`tetlux_optics::lit_f32`].

#[cfg(test)]
mod tests;

use glam::{DVec3, Vec3};
use tetlux_mesh::{Location, ScalarField};
use tetlux_optics::Classification;
use tetlux_optics::image_f32::{self, Image};
use tetlux_optics::light_f32::LightUniform;
use tetlux_optics::lit_f32::{Turning, integrate_lit};
use tetlux_optics::lit_linear_f32::{Illuminated, one_field, two_fields};
use tetlux_optics::no_data_f32::{NO_DATA_FROM, no_data, shade_no_data};
use tetlux_optics::transfer_f32::{self, Piece, Weights};
use tetlux_optics::two_field_f32;
use tetlux_optics::vertex_f32;
use tetlux_optics::widget_f32::{self, Widget};
use tetlux_optics::widgets_f32::{self, Integrated};
use tetlux_scene::{COLOR_SHARE, COLOR_SHARE_LIT, LIGHT_SHARE, Lighting, Scene};

use crate::RenderError;
use crate::attributes::Attributes;
use crate::device_mesh::normalised;
use crate::eye_space::EyeSpace;
use crate::published::Published;

/// What single precision cannot hold is not asked for.
const LEAST_ERROR: f64 = 1e-6;

/// Luminance and extinction over normalised scalars, or as they are linear in each cell.
#[derive(Debug)]
pub(crate) enum Function {
    OneField(Vec<Piece>, Weights),
    Vertex(Weights),
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
    /// The second scalar if there is one, or luminance and extinction if they are given; then the gradient's coordinates in the axes of eye space if there is light.
    pub(crate) further: Vec<Further>,
    /// The largest luminance, lit.
    pub(crate) brightest: f64,
    pub(crate) has_second: bool,
    pub(crate) function: Function,
    /// Not the integrals of emission-absorption, but those of Song et al., and the unit distances per device unit.
    pub(crate) published: Option<Published>,
    pub(crate) emission: f32,
    pub(crate) light: Option<(LightUniform, Turning)>,
    /// Error of a segment's colour for an opacity of 1.
    pub(crate) color_error: f32,
    /// Luminance and extinction per device unit of cells without data.
    pub(crate) no_data: [f32; 4],
}

/// Segments that were shaded one by one: those of a scene with two fields, light, or classified at the vertices.
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
    /// Luminance and extinction per device unit, where they are given.
    pub(crate) colors: [[f32; 4]; 2],
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
    /// `attributes` what takes their place, `extinction` is that of opacity 1 per device unit, `across` the longest ray, in
    /// device units.
    ///
    /// # Errors
    ///
    /// A scene that lacks the second scalar or the gradients that it needs.
    pub(crate) fn new(
        scene: &Scene,
        points: usize,
        eye: &EyeSpace,
        (pieces, weights): (&[Piece], Weights),
        attributes: Option<&Attributes>,
        extinction: f64,
        published: Option<Published>,
        across: f64,
    ) -> Result<Option<Look>, RenderError> {
        let bivariate = scene.classification.is_bivariate();
        if !bivariate && scene.lighting.is_none() && attributes.is_none() {
            return Ok(None);
        }
        let second = scene.second.as_ref().filter(|_| bivariate);
        if bivariate && second.is_none() {
            return Err(RenderError::Missing("a second scalar"));
        }
        let ranges = [scene.scalar.range, second.map_or([0.0, 1.0], |second| second.range)];
        let function = match &scene.classification {
            _ if attributes.is_some() => Function::Vertex(weights),
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
        further.extend(attributes.into_iter().flat_map(attribute_values));
        let mut brightest = scene.classification.brightest();
        if published.is_some() {
            // All along a ray may glow.
            brightest *= across * extinction;
        }
        let share = if scene.lighting.is_some() { COLOR_SHARE_LIT } else { COLOR_SHARE };
        let error = |share: f64| (share * scene.method.max_error).max(LEAST_ERROR) as f32;
        let mut light = None;
        if let Some(lighting) = &scene.lighting {
            if lighting.gradients.len() != points {
                return Err(RenderError::Missing("a gradient for every point"));
            }
            further.extend(gradient_values(lighting, eye));
            let uniform = LightUniform::new(&lighting.light, |d| eye.frame(DVec3::from(d)).to_array());
            light = Some((uniform, Turning::new(&lighting.light, brightest, error(LIGHT_SHARE))));
            let [ambient, diffuse, specular] = lighting.light.shares();
            brightest = brightest * (ambient + diffuse) + specular;
        }
        let no_data = no_data(&scene.no_data, extinction);
        let brightest = scene.no_data.luminance().into_iter().fold(brightest, f64::max);
        Ok(Some(Look {
            further,
            brightest,
            has_second: bivariate,
            function,
            published,
            emission: extinction as f32,
            light,
            color_error: error(share),
            no_data,
        }))
    }

    /// Both scalars', the given and the gradient's values at the two ends, of the first scalar's and those of [`Look::further`].
    pub(crate) fn values(&self, first: [f32; 2], mut further: impl Iterator<Item = [f32; 2]>) -> Ends {
        let mut next = || further.next().unwrap_or_default();
        let second = if self.has_second { next() } else { [0.0; 2] };
        let colors =
            if matches!(self.function, Function::Vertex(_)) { [(); 4].map(|()| next()) } else { [[0.0; 2]; 4] };
        let [x, y, z] = [next(), next(), next()];
        Ends {
            colors: [0, 1].map(|end| colors.map(|channel| channel[end])),
            scalars: [0, 1].map(|end| [first[end], second[end]]),
            gradients: [0, 1].map(|end| Vec3::new(x[end], y[end], z[end])),
        }
    }

    /// Premultiplied colour and alpha of a segment, and the pieces that it took.
    pub(crate) fn shade(&self, segment: &Segment) -> Integrated {
        if segment.front[0] >= NO_DATA_FROM {
            return Integrated { color: shade_no_data(self.no_data, segment.length), pieces: 1 };
        }
        match &self.light {
            None => self.classify(segment, 0.0, 1.0, 1.0),
            Some((light, turning)) => match &self.function {
                Function::OneField(pieces, weights) => {
                    let lit = self.illuminated(light, turning, segment);
                    one_field(&lit, pieces, *weights, segment.front[0], segment.back[0])
                }
                Function::TwoFields([color, opacity]) => {
                    let lit = self.illuminated(light, turning, segment);
                    two_fields(&lit, color, opacity, segment.front, segment.back)
                }
                Function::Vertex(_) | Function::Widgets(_) | Function::Image(_) => {
                    let gradients = segment.gradients.map(|g| g.to_array());
                    let classified = |from, to, factor| self.classify(segment, from, to, factor);
                    integrate_lit(light, turning, gradients, segment.view, classified)
                }
            },
        }
    }

    /// Of functions that are linear between nodes colour is exact: light may err by all that is allowed.
    fn illuminated(&self, light: &LightUniform, turning: &Turning, segment: &Segment) -> Illuminated {
        Illuminated {
            light: *light,
            eye: segment.view,
            gradients: segment.gradients.map(|g| g.to_array()),
            length: segment.length,
            error: self.color_error + turning.error,
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
            Function::Vertex(weights) => {
                let [front, back] = [from, to].map(|u| mix(segment.colors[0], segment.colors[1], u));
                one(vertex_f32::shade(*weights, front, back, length))
            }
            Function::TwoFields([color, opacity]) => one(two_field_f32::integrate(color, opacity, front, back, length)),
            Function::Widgets(widgets) => match &self.published {
                None => widgets_f32::integrate_share(widgets, front, back, length, self.color_error),
                Some(published) => published.widgets(widgets, front, back, length, self.emission),
            },
            Function::Image(image) => match &self.published {
                None => image_f32::integrate_counted(image, front, back, length, self.color_error),
                Some(published) => published.image(image, front, back, length, self.emission),
            },
        }
    }
}

/// Values at the two ends of a segment.
pub(crate) struct Ends {
    pub(crate) scalars: [[f32; 2]; 2],
    pub(crate) colors: [[f32; 4]; 2],
    pub(crate) gradients: [Vec3; 2],
}

fn scalar_values(scalar: &ScalarField) -> Further {
    Further { location: scalar.location, values: scalar.values.iter().map(|&s| normalised(scalar, s)).collect() }
}

fn attribute_values(attributes: &Attributes) -> [Further; 4] {
    let channel = |k: usize| attributes.values.iter().map(|value| f64::from(value[k])).collect();
    [0, 1, 2, 3].map(|k| Further { location: attributes.location, values: channel(k) })
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
