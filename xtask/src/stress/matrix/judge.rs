//! A picture against the truth, by the figures of the matrix.

use anyhow::Result;
use serde::Serialize;
use tetlux_image::Image;
use tetlux_scene::View;

use crate::input::Input;
use crate::truth;

/// What is promised of a pixel's worst channel, absolutely, and where the medium is thin relatively.
pub(super) const CLEAN: f64 = 1e-4;
/// Below this alpha a medium is thin: an absolute error says little of it.
const THIN: f32 = 1e-2;
/// What may move a ray, as a share of the picture's larger side: single precision knows a place in a picture this well.
/// Where moving it so far changes the truth by more than is promised, the pixel's centre is on an edge, and which side is
/// seen says nothing of a method.
pub(super) const BESIDE: f64 = 1e-6;
/// What rounding leaves of nothing in the truth.
const NOTHING: f32 = 1e-14;

/// The right picture, and how far it may be trusted at every pixel.
pub(super) struct Truth {
    pub(super) image: Image,
    /// By how much a pixel's worst channel changes with the ray's place.
    moved: Vec<f64>,
    /// Whether anything is seen depends on the ray's place.
    at_rim: Vec<bool>,
}

/// What a method made of a case.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub(super) struct Verdict {
    /// Largest absolute error of a pixel's worst channel, edges apart.
    pub(super) max: f64,
    /// The pixel that has it, what is drawn there, and what is right.
    pub(super) worst: ([usize; 2], [f32; 4], [f32; 4]),
    /// Largest error relative to alpha where the medium is thin, edges apart; none where it is nowhere.
    pub(super) thin: Option<f64>,
    /// Pixels with a value that is infinite or none.
    pub(super) not_finite: usize,
    /// Pixels that are lit where nothing is, or the other way round, rims apart.
    pub(super) coverage: usize,
}

impl Verdict {
    /// Whether it keeps what is promised.
    pub(super) fn is_clean(&self) -> bool {
        self.max <= CLEAN && self.thin.is_none_or(|thin| thin <= CLEAN) && self.not_finite == 0 && self.coverage == 0
    }
}

/// Pixels of a truth.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub(super) struct Count {
    /// That are lit.
    pub(super) lit: usize,
    /// That are lit, and not on an edge.
    pub(super) judged: usize,
    /// That are lit by a thin medium, and not on an edge of what is relative.
    pub(super) thin: usize,
}

impl Truth {
    pub(super) fn new(input: &Input, view: &View) -> Result<Truth> {
        let image = truth::image(input, view, [0.0; 2])?;
        let mut moved = vec![0.0_f64; image.pixels().len()];
        let mut at_rim = vec![false; moved.len()];
        let by = BESIDE * f64::from(view.size[0].max(view.size[1]));
        // Aslant: beside a corner of the silhouette a ray moved along either side stays on it.
        for by in [[-by, -by], [by, -by], [-by, by], [by, by]] {
            let beside = truth::image(input, view, by)?;
            for (i, (a, b)) in image.pixels().iter().zip(beside.pixels()).enumerate() {
                moved[i] = moved[i].max(difference(a, b));
                at_rim[i] |= lit(a) != lit(b);
            }
        }
        Ok(Truth { image, moved, at_rim })
    }

    pub(super) fn count(&self) -> Count {
        let lit = self.image.pixels().iter().zip(&self.moved).filter(|(pixel, _)| lit(pixel) == Some(true));
        let judged = lit.clone().filter(|(_, moved)| **moved <= CLEAN);
        let thin = judged.clone().filter(|(pixel, moved)| is_thin(pixel, **moved));
        Count { lit: lit.count(), judged: judged.count(), thin: thin.count() }
    }

    /// A picture of another size is wrong everywhere.
    pub(super) fn judge(&self, image: &Image) -> Verdict {
        let size = |image: &Image| [image.width(), image.height()];
        if size(image) != size(&self.image) {
            return Verdict { max: f64::INFINITY, coverage: self.moved.len(), ..Verdict::default() };
        }
        let mut verdict = Verdict::default();
        for (i, (found, right)) in image.pixels().iter().zip(self.image.pixels()).enumerate() {
            if found.iter().any(|c| !c.is_finite()) {
                verdict.not_finite += 1;
                continue;
            }
            let is_lit = found.iter().any(|&c| c != 0.0);
            verdict.coverage += usize::from(lit(right).is_some_and(|lit| lit != is_lit) && !self.at_rim[i]);
            if self.moved[i] > CLEAN {
                continue;
            }
            let error = difference(found, right);
            if error > verdict.max {
                verdict.max = error;
                let width = self.image.width() as usize;
                verdict.worst = ([i % width, i / width], *found, *right);
            }
            if is_thin(right, self.moved[i]) {
                let relative = error / f64::from(right[3]);
                verdict.thin = Some(verdict.thin.map_or(relative, |thin| thin.max(relative)));
            }
        }
        verdict
    }
}

/// Whether a pixel of the truth is lit; none where rounding alone may have lit it.
fn lit(right: &[f32; 4]) -> Option<bool> {
    let most = right.iter().copied().fold(0.0, f32::max);
    if most > 0.0 && most <= NOTHING { None } else { Some(most > 0.0) }
}

/// Whether a pixel is one to be judged relatively: of little opacity, and not on an edge even so.
fn is_thin(right: &[f32; 4], moved: f64) -> bool {
    right[3] > 0.0 && right[3] < THIN && moved <= CLEAN * f64::from(right[3])
}

/// Largest absolute difference of the channels.
fn difference(a: &[f32; 4], b: &[f32; 4]) -> f64 {
    (0..4).map(|i| (f64::from(a[i]) - f64::from(b[i])).abs()).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Nothing, a thin pixel, a thick one, and one on an edge and a rim.
    fn truth() -> Truth {
        let pixels = vec![[0.0; 4], [1e-5, 2e-5, 3e-5, 1e-4], [0.2, 0.3, 0.4, 0.5], [0.1, 0.1, 0.1, 0.5]];
        Truth {
            image: Image::from_pixels(4, 1, pixels).unwrap(),
            moved: vec![0.0, 1e-9, 1e-6, 0.3],
            at_rim: vec![false, false, false, true],
        }
    }

    fn judged(change: impl Fn(&mut [[f32; 4]])) -> Verdict {
        let truth = truth();
        let mut image = truth.image.clone();
        change(image.pixels_mut());
        truth.judge(&image)
    }

    #[test]
    fn the_truth_itself_is_clean() {
        let verdict = judged(|_| ());
        assert_eq!(verdict, Verdict { thin: Some(0.0), ..Verdict::default() });
        assert!(verdict.is_clean());
        assert_eq!(truth().count(), Count { lit: 3, judged: 2, thin: 1 });
    }

    #[test]
    fn planted_differences_are_found() {
        // Absolute.
        for channel in 0..4 {
            let verdict = judged(|p| p[2][channel] += 0.125);
            assert!((verdict.max - 0.125).abs() < 1e-7 && !verdict.is_clean(), "{verdict:?}");
        }
        // Relative: a hundredth of a ten-thousandth, which no absolute figure shows.
        let verdict = judged(|p| p[1][0] += 1e-6);
        assert!(verdict.max < CLEAN && !verdict.is_clean(), "{verdict:?}");
        assert!((verdict.thin.unwrap() - 1e-2).abs() < 1e-6, "{verdict:?}");
        // Not a number, and infinite.
        for bad in [f32::NAN, f32::NEG_INFINITY] {
            let verdict = judged(|p| p[3][1] = bad);
            assert!(verdict.not_finite == 1 && !verdict.is_clean(), "{verdict:?}");
        }
        // Lost, and lit where nothing is: by however little.
        for (pixel, value) in [(1, 0.0), (2, 0.0), (0, 1e-30)] {
            let verdict = judged(|p| p[pixel] = [value; 4]);
            assert!(verdict.coverage == 1 && !verdict.is_clean(), "{verdict:?}");
        }
        // What rounding of the truth has lit may be so or not.
        assert_eq!([lit(&[0.0; 4]), lit(&[0.0, 0.0, 0.0, 1e-15]), lit(&[1e-12; 4])], [Some(false), None, Some(true)]);
        // Of another size.
        let verdict = truth().judge(&Image::from_pixels(2, 2, vec![[0.0; 4]; 4]).unwrap());
        assert!(!verdict.is_clean(), "{verdict:?}");
    }

    #[test]
    fn what_lies_on_an_edge_is_not_judged_but_must_be_finite() {
        assert!(judged(|p| p[3] = [0.0; 4]).is_clean());
        assert!(!judged(|p| p[3] = [f32::INFINITY; 4]).is_clean());
    }
}
