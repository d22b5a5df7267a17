//! Scenes at random: mesh, transfer function and camera.

use glam::DVec3;
use tetlux_mesh::procedural::{Parts, Split, cuboid};
use tetlux_mesh::{Component, Field, TetMesh};
use tetlux_optics::transfer::TransferFunction;
use tetlux_optics::widget::{BivariateFunction, Rectangle, Shape, WaveProfile, Widget};
use tetlux_optics::{Classification, ImageFunction, Light};
use tetlux_scene::{Camera, Lighting, Scene};

use crate::{
    FIELD, Random, mesh_with, orthographic, perspective, pixel_error, reference, reference_beside, scene, transfer,
    white,
};

/// What a mesh and a scene on it are made of, to be changed before they are made.
#[derive(Debug, Clone)]
pub struct Recipe {
    /// Positions are multiples of 1/1024, a few units large: their middles are exact in single precision too.
    pub parts: Parts,
    /// Of the points or of the cells; of two components where the classification takes two.
    pub field: Field,
    /// Over the field's range.
    pub classification: Classification,
    /// Light, with the gradients at the mesh's points.
    pub light: Option<Light>,
    /// Outside the mesh or inside it.
    pub camera: Camera,
    /// See [`Scene::unit_distance`].
    pub unit_distance: f64,
    /// Width and height in pixels.
    pub side: u32,
}

impl Recipe {
    /// A grid displaced at random, surface included, with a smooth scalar; a transfer function with steps and peaks.
    pub fn random(seed: u64, side: u32) -> Recipe {
        let mut random = Random::new(seed);
        let parts = random_parts(&mut random, 1);
        let field = random_field(&mut random, &parts);
        let range = range_of(&field);
        let classification = Classification::OneField(random_transfer(&mut random, range));
        let camera = random_camera(&mut random);
        Recipe { parts, field, classification, light: None, camera, unit_distance: random.between(0.3, 3.0), side }
    }

    /// The same by two fields: transfer functions, widgets or an image, by turns.
    pub fn of_two_fields(seed: u64, side: u32) -> Recipe {
        let mut random = Random::new(seed ^ 0x2f1);
        let mut recipe = Recipe::random(seed, side);
        let first = range_of(&recipe.field);
        let second = |p: DVec3| (1.3 * p.y - p.x).cos() + 0.2 * p.z;
        let values = recipe.parts.points.iter().zip(&recipe.field.values).flat_map(|(&p, &s)| [s, second(p)]);
        recipe.field = Field::point(FIELD, 2, values.collect());
        recipe.classification = match seed % 3 {
            0 => Classification::Widgets(random_widgets(&mut random, first)),
            1 => Classification::TwoFields(two_axes(
                &random_transfer(&mut random, first),
                &random_transfer(&mut random, SECOND),
            )),
            _ => Classification::Image(random_image(&mut random, [first, SECOND])),
        };
        recipe
    }

    /// The same in the light of the eye.
    pub fn lit(self) -> Recipe {
        Recipe { light: Some(Light::default()), ..self }
    }

    /// The transfer function, where one field is classified.
    pub fn transfer(&self) -> &TransferFunction {
        match &self.classification {
            Classification::OneField(transfer) => transfer,
            other => panic!("the recipe has one field: {other:?}"),
        }
    }

    /// The mesh and the scene.
    pub fn made(&self) -> (TetMesh, Scene) {
        let mesh = mesh_with(&self.parts, self.field.clone());
        let component = |i| mesh.scalar(FIELD, Component::Index(i)).unwrap_or_else(|e| panic!("{e}"));
        let scalar = component(0);
        let lighting = self.light.map(|light| Lighting::new(light, mesh.vertex_gradients(&scalar)));
        let scene = Scene {
            scalar,
            second: (self.field.components == 2).then(|| component(1)),
            classification: self.classification.clone(),
            lighting,
            unit_distance: self.unit_distance,
            ..scene(&mesh, white(&[[0.0, 1.0]]), self.camera, [self.side; 2])
        };
        (mesh, scene)
    }
}

/// Holds the second field of [`Recipe::of_two_fields`].
const SECOND: [f64; 2] = [-1.5, 1.5];

/// The lowest and the highest of a field's values.
pub fn range_of(field: &Field) -> [f64; 2] {
    field.values.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], &s| [low.min(s), high.max(s)])
}

/// A grid displaced at random, surface included, within a few units of the origin, of so many hexahedra along each axis at
/// the least and three more at the most.
pub fn random_parts(random: &mut Random, least: usize) -> Parts {
    let counts = [0; 3].map(|_| least + random.below(4));
    let corner = DVec3::new(random.between(0.5, 2.0), random.between(0.5, 2.0), random.between(0.5, 2.0));
    let split = if random.below(2) == 0 { Split::Five } else { Split::Six };
    let mut parts = cuboid(counts, split, [-corner, corner]);
    for p in &mut parts.points {
        // An eighth of a spacing either way: no cell turns inside out.
        for axis in 0..3 {
            p[axis] += 2.0 * corner[axis] / counts[axis] as f64 * random.between(-0.125, 0.125);
        }
        *p = (*p * 1024.0).round() / 1024.0;
    }
    parts
}

/// A smooth scalar at the points.
pub fn random_field(random: &mut Random, parts: &Parts) -> Field {
    let wave = DVec3::new(random.between(-2.0, 2.0), random.between(-2.0, 2.0), random.between(-2.0, 2.0));
    Field::point(FIELD, 1, parts.sample(|p| wave.dot(p).sin() + 0.3 * p.z))
}

/// Up to 12 nodes of each kind over the range, among them steps and narrow peaks.
fn random_transfer(random: &mut Random, [low, high]: [f64; 2]) -> TransferFunction {
    let place = |u: f64| low + (high - low) * u;
    let mut places = |count: usize| {
        let mut places: Vec<f64> = (0..count).map(|_| place(random.between(-0.1, 1.1))).collect();
        places.sort_by(f64::total_cmp);
        places
    };
    let (color, opacity) = (places(6), places(6));
    let mut nodes = Vec::new();
    for s in color {
        let rgb = [0; 3].map(|_| random.between(0.0, 1.0));
        nodes.push([s, rgb[0], rgb[1], rgb[2]]);
        if random.below(3) == 0 {
            nodes.push([s, rgb[2], rgb[0], rgb[1]]);
        }
    }
    let mut heights = Vec::new();
    for s in opacity {
        match random.below(4) {
            // A step.
            0 => heights.extend([[s, random.between(0.0, 2.0)], [s, random.between(0.0, 2.0)]]),
            // A peak of a hundredth of the range.
            1 => {
                let half = 0.005 * (high - low);
                heights.extend([[s - half, 0.0], [s, random.between(0.0, 30.0)], [s + half, 0.0]]);
            }
            2 => heights.push([s, 0.0]),
            _ => heights.push([s, random.between(0.0, 3.0)]),
        }
    }
    heights.sort_by(|a, b| a[0].total_cmp(&b[0]));
    heights.truncate(12);
    transfer(&nodes, &heights)
}

/// The colour of one function and the opacity of another.
fn two_axes(color: &TransferFunction, opacity: &TransferFunction) -> TransferFunction {
    let color: Vec<[f64; 4]> = color.color_nodes().iter().map(|n| [n.s, n.rgb[0], n.rgb[1], n.rgb[2]]).collect();
    let opacity: Vec<[f64; 2]> = opacity.opacity_nodes().iter().map(|n| [n.s, n.opacity]).collect();
    transfer(&color, &opacity)
}

/// One of each shape, anywhere.
fn random_widgets(random: &mut Random, [low, high]: [f64; 2]) -> BivariateFunction {
    let width = high - low;
    let wave = |profile| Shape::Wave { profile, frequency: [1.0 / width, 0.4], offset: 0.2 };
    let shapes = [
        Shape::Uniform,
        Shape::Gaussian {
            center: [low + random.between(0.2, 0.8) * width, random.between(-1.0, 1.0)],
            sigma: [0.2 * width, 0.5],
        },
        wave(WaveProfile::Triangle),
        wave(WaveProfile::AbsSine),
    ];
    let mut interval = |low: f64, high: f64| {
        let middle = random.between(low, high);
        [middle - 0.2 * (high - low), middle + 0.2 * (high - low)]
    };
    let widgets = shapes.into_iter().enumerate().map(|(i, shape)| {
        let support = Rectangle { s: interval(low, high), g: interval(SECOND[0], SECOND[1]) };
        let color = [[1.0, 0.2, 0.1], [0.1, 0.3, 1.0], [0.2, 0.9, 0.2], [0.9, 0.8, 0.1]][i];
        Widget::new(shape, Some(support), 2.0, color).unwrap_or_else(|e| panic!("{e}"))
    });
    BivariateFunction { widgets: widgets.collect() }
}

fn random_image(random: &mut Random, ranges: [[f64; 2]; 2]) -> ImageFunction {
    let mut channel = |most: f64| random.between(-0.2 * most, most).max(0.0) as f32;
    let texels = (0..30).map(|_| [channel(1.0), channel(1.0), channel(1.0), channel(3.0)]).collect();
    ImageFunction::new(6, texels, ranges).unwrap_or_else(|e| panic!("{e}"))
}

/// A camera that looks towards the origin's neighbourhood, from well outside to deep inside.
pub fn random_camera(random: &mut Random) -> Camera {
    let mut direction = || DVec3::new(random.between(-1.0, 1.0), random.between(-1.0, 1.0), random.between(-1.0, 1.0));
    let (toward, focus) = (direction(), direction() * 0.3);
    let position = focus + toward.normalize_or(DVec3::X) * random.between(0.2, 6.0);
    match random.below(2) {
        0 => perspective(position, focus, random.between(20.0, 100.0)),
        _ => orthographic(position, focus, random.between(0.8, 2.5)),
    }
}

/// Scalars, normalised to the field's range, are good to this share of it: a few units of the last place.
const SCALAR_ROUNDING: f64 = 3e-7;

/// Positions in pictures of a hundred pixels are good to this many pixels: a few units of the last place.
const PIXEL_ROUNDING: f64 = 1.5e-5;

/// How far the truth itself moves where scalars and rays are moved by their rounding: more than any tolerance where a
/// ray runs along a step or grazes a face.
pub fn sensitivity(mesh: &TetMesh, scene: &Scene, truth: &[[f64; 4]]) -> Vec<f64> {
    // To move the scalars is to move the function over them.
    let shifted = |sign: f64| {
        let mut scene = scene.clone();
        for scalar in [Some(&mut scene.scalar), scene.second.as_mut()].into_iter().flatten() {
            let by = sign * SCALAR_ROUNDING * (scalar.range[1] - scalar.range[0]);
            scalar.values.iter_mut().for_each(|s| *s += by);
        }
        reference(mesh, &scene)
    };
    let by_scalars = [-1.0, 1.0].map(shifted);
    let p = PIXEL_ROUNDING;
    let by_pixels = [[-p, 0.0], [p, 0.0], [0.0, -p], [0.0, p]].map(|by| reference_beside(mesh, scene, by));
    let moved = |pictures: &[Vec<[f64; 4]>], i: usize| {
        pictures.iter().map(|picture| pixel_error(picture[i].map(|c| c as f32), truth[i])).fold(0.0, f64::max)
    };
    (0..truth.len()).map(|i| moved(&by_scalars, i) + moved(&by_pixels, i)).collect()
}
