//! Pictures whose every pixel is known in closed form: convex bodies with a scalar that is linear throughout.

use glam::DVec3;
use tetlux_image::Image;
use tetlux_scene::Scene;

use crate::{pixel_error, view};

/// A convex body: a point p is inside where n . p <= c for all (n, c).
#[derive(Debug, Clone)]
pub struct Convex(Vec<(DVec3, f64)>);

impl Convex {
    /// The box between two corners.
    pub fn cuboid([low, high]: [DVec3; 2]) -> Convex {
        let side = |n: DVec3| [(n, n.dot(high)), (-n, -n.dot(low))];
        Convex([DVec3::X, DVec3::Y, DVec3::Z].into_iter().flat_map(side).collect())
    }

    /// The tetrahedron of four points.
    pub fn tetrahedron(p: [DVec3; 4]) -> Convex {
        let face = |i: usize| {
            let [a, b, c] = [p[(i + 1) % 4], p[(i + 2) % 4], p[(i + 3) % 4]];
            let n = (b - a).cross(c - a);
            let n = if n.dot(p[i] - a) > 0.0 { -n } else { n };
            (n, n.dot(a))
        };
        Convex((0..4).map(face).collect())
    }

    /// Parameters at which the line origin + t direction enters and leaves, not before `start`; `None` if it misses.
    pub fn chord(&self, origin: DVec3, direction: DVec3, start: f64) -> Option<[f64; 2]> {
        let [mut enter, mut leave] = [start, f64::INFINITY];
        for &(n, c) in &self.0 {
            let (rate, room) = (n.dot(direction), c - n.dot(origin));
            if rate > 0.0 {
                leave = leave.min(room / rate);
            } else if rate < 0.0 {
                enter = enter.max(room / rate);
            } else if room < 0.0 {
                return None;
            }
        }
        (enter < leave).then_some([enter, leave])
    }
}

/// Optical depth of a stretch of a ray, of a world length, on which the scalar goes from `s[0]` to `s[1]`: length over
/// unit distance times the mean opacity. Opacity is linear between nodes of ascending scalar, constant outside, so its
/// integral over the scalar is a sum of trapezoids.
pub fn depth_of(opacity: &[[f64; 2]], s: [f64; 2], length: f64, unit_distance: f64) -> f64 {
    let at = |x: f64| {
        let next = opacity.partition_point(|node| node[0] <= x);
        match (next.checked_sub(1).map(|i| opacity[i]), opacity.get(next)) {
            (Some([from, a]), Some(&[to, b])) => a + (b - a) * (x - from) / (to - from),
            (Some([_, a]), None) => a,
            (None, first) => first.map_or(0.0, |node| node[1]),
        }
    };
    let [low, high] = [s[0].min(s[1]), s[0].max(s[1])];
    if low == high {
        return at(low) * length / unit_distance;
    }
    let (first, last) = ([low, opacity[0][1]], [high, opacity[opacity.len() - 1][1]]);
    let mut area = 0.0;
    // Outside the nodes: constant; two nodes at one scalar: no width, no area.
    area += (opacity[0][0].min(high) - low).max(0.0) * first[1];
    area += (high - opacity[opacity.len() - 1][0].max(low)).max(0.0) * last[1];
    for pair in opacity.windows(2) {
        let ([from, a], [to, b]) = (pair[0], pair[1]);
        let (begin, end) = (from.max(low), to.min(high));
        if begin < end {
            let value = |x: f64| a + (b - a) * (x - from) / (to - from);
            area += 0.5 * (value(begin) + value(end)) * (end - begin);
        }
    }
    area / (high - low) * length / unit_distance
}

/// Premultiplied colour and alpha of stretches of constant luminance and known optical depth, nearest first.
pub fn composite(stretches: &[([f64; 3], f64)]) -> [f64; 4] {
    let mut pixel = [0.0; 4];
    for &(rgb, depth) in stretches {
        let alpha = (1.0 - pixel[3]) * -(-depth).exp_m1();
        (0..3).for_each(|i| pixel[i] += rgb[i] * alpha);
        pixel[3] += alpha;
    }
    pixel
}

/// What came of a picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Judged {
    /// Largest error of any pixel.
    pub max: f64,
    /// Pixels off by more than the tolerance.
    pub wrong: usize,
    /// Pixels whose ray runs in a surface where the truth jumps: accepted was any value between the two sides', since
    /// the cells along the ray each lie on one side or the other.
    pub on_a_jump: usize,
    /// Pixels whose truth is not empty.
    pub covered: usize,
    /// Column and row of the pixel with the largest error, what it shows, and what it should.
    pub worst: ([usize; 2], [f32; 4], [f64; 4]),
}

/// Pixels by which rays are moved to see whether the truth jumps there: single precision knows positions in pictures
/// of up to a hundred pixels to 1e-5 of a pixel.
const JUMP: f64 = 1e-4;

/// Judges a picture by the value of each ray (origin, direction, parameter from which it sees).
pub fn judge(
    image: &Image,
    scene: &Scene,
    tolerance: f64,
    truth: impl Fn(DVec3, DVec3, f64) -> Option<[f64; 4]>,
) -> Judged {
    let view = view(scene);
    let mut judged = Judged { max: 0.0, wrong: 0, on_a_jump: 0, covered: 0, worst: Default::default() };
    for (index, &pixel) in image.pixels().iter().enumerate() {
        let width = view.size[0] as usize;
        let value = |dx: f64, dy: f64| {
            let (x, y) = ((index % width) as f64 + 0.5 + dx, (index / width) as f64 + 0.5 + dy);
            let (origin, direction) = view.ray(x, y);
            truth(origin, direction, view.near).unwrap_or_default()
        };
        let exact = value(0.0, 0.0);
        let around = [(-JUMP, -JUMP), (-JUMP, JUMP), (JUMP, -JUMP), (JUMP, JUMP)].map(|(x, y)| value(x, y));
        // Steeper than a hundred a pixel is no slope.
        let jump = |other: &[f64; 4]| (0..4).any(|i| (other[i] - exact[i]).abs() > 100.0 * JUMP);
        let error = if around.iter().any(jump) {
            judged.on_a_jump += 1;
            // Between the two sides; moving the ray changes each by a slope times JUMP besides.
            let sides = || around.iter().chain([&exact]);
            let nearest: [f64; 4] = std::array::from_fn(|i| {
                let low = sides().fold(f64::INFINITY, |m, side| m.min(side[i])) - 10.0 * JUMP;
                let high = sides().fold(0.0, |m: f64, side| m.max(side[i])) + 10.0 * JUMP;
                f64::from(pixel[i]).clamp(low, high)
            });
            pixel_error(pixel, nearest)
        } else {
            pixel_error(pixel, exact)
        };
        judged.covered += usize::from(exact[3] > 0.0);
        judged.wrong += usize::from(error > tolerance);
        if error > judged.max {
            judged.max = error;
            judged.worst = ([index % width, index / width], pixel, exact);
        }
    }
    judged
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Way, mesh_of, orthographic, render, scene, white};
    use tetlux_mesh::procedural::{Split, cuboid};

    /// A few roundings.
    const ROUNDING: f64 = 1e-14;

    #[test]
    fn chords_of_a_box_and_of_a_tetrahedron() {
        let body = Convex::cuboid([DVec3::ZERO, DVec3::new(1.0, 2.0, 3.0)]);
        assert_eq!(body.chord(DVec3::new(0.5, 0.5, -2.0), DVec3::Z, 0.0), Some([2.0, 5.0]));
        assert_eq!(body.chord(DVec3::new(0.5, 0.5, 1.0), DVec3::Z, 0.0), Some([0.0, 2.0]));
        assert_eq!(body.chord(DVec3::new(1.5, 0.5, -2.0), DVec3::Z, 0.0), None);
        let body = Convex::tetrahedron([DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z]);
        // x + y + z <= 1: at (1/4, 1/4) the height is 1/2.
        assert_eq!(body.chord(DVec3::new(0.25, 0.25, -1.0), DVec3::Z, 0.0), Some([1.0, 1.5]));
    }

    #[test]
    fn depths_are_areas_under_the_opacity() {
        let peak = [[0.4, 0.0], [0.5, 2.0], [0.6, 0.0]];
        // A triangle of base 0.2 and height 2 over a range of 1.
        assert!((depth_of(&peak, [0.0, 1.0], 3.0, 1.0) - 0.2 * 3.0).abs() < ROUNDING);
        assert!((depth_of(&peak, [1.0, 0.0], 3.0, 2.0) - 0.3).abs() < ROUNDING);
        // Its first half of a half: height 1 at 0.45, base 0.05, over a range of 0.45.
        assert!((depth_of(&peak, [0.0, 0.45], 0.45, 1.0) - 0.025).abs() < ROUNDING);
        assert!((depth_of(&peak, [0.45, 0.45], 1.0, 1.0) - 1.0).abs() < ROUNDING);
        // A step from 1 to 3 in the middle, clamped outside.
        let step = [[0.0, 1.0], [0.5, 1.0], [0.5, 3.0]];
        assert!((depth_of(&step, [-1.0, 2.0], 3.0, 1.0) - (1.5 + 4.5)).abs() < ROUNDING);
    }

    #[test]
    fn layers_are_composited_nearest_first() {
        let ln2 = std::f64::consts::LN_2;
        // Half of red, then half of what is left of green.
        let seen = composite(&[([1.0, 0.0, 0.0], ln2), ([0.0, 1.0, 0.0], ln2)]);
        assert!((0..4).all(|i| (seen[i] - [0.5, 0.25, 0.0, 0.75][i]).abs() < ROUNDING), "{seen:?}");
    }

    #[test]
    fn a_planted_wrong_pixel_is_judged_wrong_and_a_jump_takes_what_lies_between() {
        let parts = cuboid([1, 1, 1], Split::Six, [DVec3::ZERO, DVec3::ONE]);
        let mesh = mesh_of(&parts, |_| 0.0);
        // Pixels of 1/4 whose centres fall on the box's sides.
        let camera = orthographic(DVec3::new(0.5, 0.5, -2.0), DVec3::splat(0.5), 0.875);
        let scene = scene(&mesh, white(&[[0.0, 1.0]]), camera, [7, 7]);
        let body = Convex::cuboid([DVec3::ZERO, DVec3::ONE]);
        let truth = |o, d, start| body.chord(o, d, start).map(|[a, b]| [-(a - b).exp_m1(); 4]);
        let mut image = render(&mesh, &scene, Way::CpuPixel);
        let good = judge(&image, &scene, 1e-5, truth);
        // 25 centres on and in the box, 9 of them inside.
        assert_eq!((good.wrong, good.on_a_jump), (0, 16));
        image.pixels_mut()[3 * 7 + 3][1] += 1e-3;
        assert_eq!(judge(&image, &scene, 1e-5, truth).wrong, 1);
        // On the side of the box: nothing, the full value and what lies between are right, more is wrong.
        for (value, wrong) in [(0.0, 1), (-(-1.0f32).exp_m1(), 1), (0.3, 1), (0.7, 2), (f32::NAN, 2)] {
            image.pixels_mut()[7 + 3] = [value; 4];
            assert_eq!(judge(&image, &scene, 1e-5, truth).wrong, wrong, "{value}");
        }
    }
}
