//! Pairs of scenes that must look the same: nothing is known of their pictures, but that they are one.
//!
//! ```
//! use tetlux_tests::{Recipe, Way, render, twins};
//!
//! let twins = twins::refining::into_eight(Recipe::random(1, 32), 1);
//! let [first, second] = twins.pair.each_ref().map(|(mesh, scene)| render(mesh, scene, Way::CpuExact));
//! assert_eq!(twins.compare(&first, &second).wrong, 0);
//! ```

pub mod company;
pub mod numbering;
pub mod refining;
pub mod reversing;
pub mod scaling;
pub mod turning;

use tetlux_image::Image;
use tetlux_mesh::TetMesh;
use tetlux_scene::Scene;

use crate::{Recipe, reference, sensitivity};

/// Two scenes that must look the same.
#[derive(Debug, Clone)]
pub struct Twins {
    /// Each on its mesh.
    pub pair: [(TetMesh, Scene); 2],
    /// The second picture is the first one's mirror image, left and right exchanged.
    pub mirrored: bool,
    /// Which values of a pixel are the same.
    pub channels: std::ops::Range<usize>,
    /// How much the same.
    pub agreement: Agreement,
    /// How far values may be apart that agree but for rounding.
    pub tolerance: f64,
}

/// How much two pictures are the same.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Agreement {
    /// Bit for bit.
    Bits,
    /// To a tolerance, but where the truth hangs on the rounding of scalars and rays.
    Rounding,
}

/// Of one field without light: each picture has some twenty segments a pixel, with cuts and weights in single precision.
pub const TOLERANCE: f64 = 3e-5;

/// What all else is drawn to: it is found by approximation.
const BUDGET: f64 = 1e-4;

/// Makes twins of a recipe, by a seed.
pub type Make = fn(Recipe, u64) -> Twins;

/// Every kind of twins, by what is changed.
pub const ALL: [(&str, Make); 16] = [
    ("cells split in four at their middles", refining::into_four),
    ("cells split in eight at their edges", refining::into_eight),
    ("one cell split", refining::one_cell),
    ("cells about an edge split", refining::one_edge),
    ("a linear field on another mesh", refining::another_mesh),
    ("scaled by a power of two", scaling::by_power_of_two),
    ("scaled by any number", scaling::by_any),
    ("turned", turning::turned),
    ("moved by what is exact", turning::moved_exactly),
    ("moved far away", turning::moved_far),
    ("seen from behind in parallel", reversing::parallel),
    ("a ray from its other end", reversing::ray),
    ("cells numbered anew", numbering::cells),
    ("points numbered anew", numbering::points),
    ("holes filled with what is clear", company::filled),
    ("clear bodies about", company::about),
];

/// What came of comparing two pictures.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Compared {
    /// Largest difference of a pixel that does not hang on rounding.
    pub max: f64,
    /// Pixels that are not the same.
    pub wrong: usize,
    /// Pixels whose difference hangs on rounding.
    pub excused: usize,
    /// Pixels of the first picture that are not empty.
    pub covered: usize,
    /// Column and row, in the first picture, of the pixel with the largest difference, and its two values.
    pub worst: ([usize; 2], [[f32; 4]; 2]),
}

impl Twins {
    fn new(first: &Recipe, second: &Recipe) -> Twins {
        let mut pair = [first.made(), second.made()];
        let exact = first.light.is_none() && first.field.components == 1;
        for (_, scene) in &mut pair {
            scene.method.max_error = if exact { scene.method.max_error } else { BUDGET };
        }
        let tolerance = if exact { TOLERANCE } else { 2.0 * BUDGET };
        Twins { pair, mirrored: false, channels: 0..4, agreement: Agreement::Rounding, tolerance }
    }

    /// Compares the two pictures.
    pub fn compare(&self, first: &Image, second: &Image) -> Compared {
        let width = first.width() as usize;
        let other = |i: usize| if self.mirrored { i - i % width + width - 1 - i % width } else { i };
        let mut compared = Compared { max: 0.0, wrong: 0, excused: 0, covered: 0, worst: Default::default() };
        let mut moved: Option<[Vec<f64>; 2]> = None;
        if (first.width(), first.height()) != (second.width(), second.height()) {
            return Compared { max: f64::INFINITY, wrong: first.pixels().len(), ..compared };
        }
        for (i, &pixel) in first.pixels().iter().enumerate() {
            let twin = second.pixels()[other(i)];
            compared.covered += usize::from(pixel[3] > 0.0);
            let parts = self.channels.clone().map(|k| difference(pixel[k], twin[k]));
            let difference = parts.fold(0.0, f64::max);
            let same = self.channels.clone().all(|k| pixel[k].to_bits() == twin[k].to_bits());
            let mut wrong = difference > self.tolerance;
            if wrong && self.agreement == Agreement::Rounding {
                let moved = moved.get_or_insert_with(|| self.sensitivities());
                wrong = difference > self.tolerance + moved[0][i] + moved[1][other(i)];
                if !wrong {
                    compared.excused += 1;
                    continue;
                }
            }
            compared.wrong += usize::from(wrong || self.agreement == Agreement::Bits && !same);
            if difference > compared.max {
                (compared.max, compared.worst) = (difference, ([i % width, i / width], [pixel, twin]));
            }
        }
        compared
    }

    fn sensitivities(&self) -> [Vec<f64>; 2] {
        self.pair.each_ref().map(|(mesh, scene)| sensitivity(mesh, scene, &reference(mesh, scene)))
    }
}

/// Infinite if either is not finite.
fn difference(a: f32, b: f32) -> f64 {
    let difference = (f64::from(a) - f64::from(b)).abs();
    if difference.is_finite() { difference } else { f64::INFINITY }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A picture like any other: each pixel has its own values.
    fn picture(side: u32) -> Image {
        let pixels = (0..side * side).map(|i| [0.1, 0.2, 0.3, 0.5].map(|v| v + 1e-3 * i as f32)).collect();
        Image::from_pixels(side, side, pixels).unwrap_or_else(|e| panic!("{e}"))
    }

    #[test]
    fn a_planted_difference_is_found_in_twins_of_every_kind() {
        for (name, make) in ALL {
            let twins = make(Recipe::random(3, 32), 3);
            let side = twins.pair[0].1.size[0];
            let good = picture(side);
            let mut mirror = good.clone();
            if twins.mirrored {
                mirror.pixels_mut().chunks_mut(side as usize).for_each(<[_]>::reverse);
            }
            let compared = twins.compare(&good, &mirror);
            assert_eq!((compared.max, compared.wrong), (0.0, 0), "{name}");
            for value in [mirror.pixels()[0][3] + 0.3, f32::NAN, f32::INFINITY] {
                let mut bad = mirror.clone();
                bad.pixels_mut()[0][3] = value;
                assert_eq!(twins.compare(&good, &bad).wrong, 1, "{name}: {value}");
            }
            let mut bad = mirror.clone();
            bad.pixels_mut()[0][3] = mirror.pixels()[0][3].next_up();
            let wrong = usize::from(twins.agreement == Agreement::Bits);
            assert_eq!(twins.compare(&good, &bad).wrong, wrong, "{name}: the last bit");
        }
    }

    #[test]
    fn pictures_of_two_sizes_are_not_the_same() {
        let twins = scaling::by_any(Recipe::random(0, 32), 0);
        assert!(twins.compare(&picture(32), &picture(16)).wrong > 0);
    }
}
