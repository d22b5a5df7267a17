//! Light on segments whose luminance and extinction are linear between the nodes of a transfer function, in f32: to a
//! stated error, which is proved here.
//!
//! The gradient g is linear along a segment, so that the normal turns on a great circle. A piece between two nodes is cut
//! where the absolute value of a cosine has a kink, g.l = 0, g.v = 0 and, for shininess below 2, g.h = 0, and then into n
//! parts over which the normal turns by the same angle t / n. On a part the lit luminance l is taken to be linear between
//! its ends: the light is l_f w_f + l_b w_b with the exact weights of [`crate::segment_f32`], which are positive and add up
//! to alpha. So the error is at most alpha times the largest distance of l from its chord, |l''| / 8, u from 0 to 1 along
//! the part. With the angle a(u), |g'| = D, and m and M the least and the largest |g| on the piece,
//!
//! ```text
//! a' <= t/n (1 + R/n),  |a''| <= 2 a' D_n / m_n,  D_n / m_n <= R / n,  R = t M D / |g_f x g_b|
//! l = L c(a) + s(a):  |l''| <= (L |c''| + |s''|) a'^2 + (L |c'| + |s'|) |a''| + 2 |L'| |c'| a'
//! ```
//!
//! as the distances of the line from 0 is |g_f x g_b| / D, and a part's share of the piece is at most
//! K / n, K = t M^2 / |g_f x g_b|. With the bounds V and W of the slope and the curvature of the lit luminance, and dL of the
//! luminance along the piece, the error is at most alpha (t / 8 n^2) r (r W t + 2 V R + 2 dL diffuse K), r = 1 + R/n: the
//! least n for that is taken. Slope and curvature: diffuse and diffuse of c; specular sqrt(p/e) and specular p of cos^p for
//! p of 2 and more, which is taken for smaller ones too.
//!
//! A silhouette multiplies the extinction with f = (1 - cos)^k, which is about phi^(2k) of the angle phi to the eye. A part's
//! depth is Simpson's sum, of relative error C (t^2 / 2(1 - cos))^2 / n^4, C about (k-1)(k-1.5)/12: exact for k of 1 and 3/2.
//! That is an estimate; by the tests it keeps to the error, too.

#[cfg(test)]
pub(crate) mod tests;

use crate::light_f32::{LightUniform, half_way, lit, normal, silhouette_factor};
use crate::segment_f32::{weights_average, weights_direct};
use crate::transfer_f32::{Piece, Weights, classify, piece_at};
use crate::two_field_f32::{leaves, next};
use crate::widgets_f32::Integrated;

/// No piece between two nodes is cut into more parts.
pub const MAX_PARTS: f32 = 256.0;

/// A segment's light.
#[derive(Clone, Copy, Debug)]
pub struct Illuminated {
    /// The light, in the frame of the gradients.
    pub light: LightUniform,
    /// Unit vector to the eye.
    pub eye: [f32; 3],
    /// At the front and the back end.
    pub gradients: [[f32; 3]; 2],
    /// In device units.
    pub length: f32,
    /// What light may err by, as a share of the segment's alpha.
    pub error: f32,
}

/// What does not change along a segment.
struct Vectors {
    toward: [f32; 3],
    half: [f32; 3],
}

fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn along(ends: [[f32; 3]; 2], u: f32) -> [f32; 3] {
    let [f, b] = ends;
    [f[0] + (b[0] - f[0]) * u, f[1] + (b[1] - f[1]) * u, f[2] + (b[2] - f[2]) * u]
}

fn vectors(segment: &Illuminated) -> Vectors {
    let mut toward = segment.light.direction;
    if dot(toward, toward) == 0.0 {
        toward = segment.eye;
    }
    Vectors { toward, half: half_way(toward, segment.eye) }
}

/// Angle between two gradients; 0 if one of them is none.
fn turn(ends: [[f32; 3]; 2]) -> f32 {
    let [f, b] = ends.map(normal);
    let across = cross(f, b);
    dot(across, across).sqrt().atan2(dot(f, b))
}

/// How many parts keep the light of a piece to its error: see the module's text. `low` and `high` are the largest
/// luminances at its two ends.
fn parts(segment: &Illuminated, ends: [[f32; 3]; 2], angle: f32, low: f32, high: f32) -> f32 {
    if angle <= 0.0 {
        return 1.0;
    }
    let [_, diffuse, specular, shininess] = segment.light.shares;
    let bright = low.max(high);
    let change = (high - low).abs();
    let p = shininess.max(2.0);
    let mut slope = bright * diffuse + specular * (p * 0.36787944).sqrt();
    let mut curvature = bright * diffuse + specular * p;
    let mut mixed = change * diffuse;
    let k = segment.light.silhouette;
    let mut least = 1.0_f32;
    if k > 0.0 {
        // What is seen of the luminance varies with the silhouette, too.
        slope += 0.5 * bright * k;
        curvature += 0.5 * bright * k * (k + 1.0);
        // The light's centre of a part, by its ends, is off by a twelfth of it.
        mixed += slope / 3.0 + 0.5 * change;
        let facing = ends.map(|g| 1.0 - dot(normal(g), segment.eye).abs());
        // No turn goes further from the eye's direction than that.
        let bend = (0.5 * angle * angle / facing[0].max(facing[1]).max(1e-12)).min(4.0);
        let depth = (0.01 + 0.16 * ((k - 1.0) * (k - 1.5)).abs()) * bend * bend;
        least = (depth / segment.error).sqrt().sqrt().clamp(1.0, MAX_PARTS).ceil();
    }
    let [f, b] = ends;
    let across = cross(f, b);
    let area = dot(across, across).sqrt();
    let largest = dot(f, f).max(dot(b, b)).sqrt();
    let rise = [b[0] - f[0], b[1] - f[1], b[2] - f[2]];
    let ratio = angle * largest / area.max(1e-30);
    let stretch = (ratio * dot(rise, rise).sqrt()).min(1e6);
    let share = (ratio * largest).min(1e6);
    let count = |uneven: f32| {
        let turning = uneven * (uneven * curvature * angle + 2.0 * slope * stretch + 2.0 * mixed * share);
        (0.125 * angle * turning / segment.error).sqrt().clamp(1.0, MAX_PARTS).ceil()
    };
    count(1.0 + stretch / count(1.0)).max(least)
}

/// Where a linear quantity with these ends is 0 strictly between them; 2 if nowhere.
fn zero_between(front: f32, back: f32) -> f32 {
    if front * back < 0.0 {
        return front / (front - back);
    }
    2.0
}

/// Adds the piece from `begin` to `end` of a segment, with luminance and extinction per device unit at its ends, behind what
/// is there.
fn add(
    segment: &Illuminated,
    vectors: &Vectors,
    model: Weights,
    [begin, end]: [f32; 2],
    front: [f32; 4],
    back: [f32; 4],
    result: &mut Integrated,
) {
    if front[3] <= 0.0 && back[3] <= 0.0 {
        return;
    }
    let ends = [along(segment.gradients, begin), along(segment.gradients, end)];
    let shares = segment.light.shares;
    let mut cuts = [2.0, 2.0, 2.0, 1.0];
    let kink = |v: [f32; 3]| zero_between(dot(ends[0], v), dot(ends[1], v));
    if shares[1] > 0.0 {
        cuts[0] = kink(vectors.toward);
    }
    if shares[2] > 0.0 && shares[3] < 2.0 {
        cuts[1] = kink(vectors.half);
    }
    if segment.light.silhouette > 0.0 {
        cuts[2] = kink(segment.eye);
    }
    let mut from = 0.0;
    for _ in 0..4 {
        // The next of the cuts; the last is the piece's end.
        let mut to = 1.0_f32;
        for cut in cuts {
            if cut > from {
                to = to.min(cut);
            }
        }
        if to > from {
            let places = [begin + (end - begin) * from, begin + (end - begin) * to];
            smooth(segment, vectors, model, places, mix(front, back, from), mix(front, back, to), result);
        }
        from = to;
        if from >= 1.0 {
            break;
        }
    }
}

fn mix(front: [f32; 4], back: [f32; 4], u: f32) -> [f32; 4] {
    [0, 1, 2, 3].map(|i| front[i] + (back[i] - front[i]) * u)
}

/// The same of a part without kinks.
fn smooth(
    segment: &Illuminated,
    vectors: &Vectors,
    model: Weights,
    [begin, end]: [f32; 2],
    front: [f32; 4],
    back: [f32; 4],
    result: &mut Integrated,
) {
    let ends = [along(segment.gradients, begin), along(segment.gradients, end)];
    let angle = turn(ends);
    let largest = |c: [f32; 4]| c[0].max(c[1].max(c[2]));
    let count = parts(segment, ends, angle, largest(front), largest(back));
    let [near, far] = ends.map(|g| dot(g, g).sqrt());
    let point = |u: f32| {
        let c = mix(front, back, u);
        let n = normal(along(ends, u));
        let [r, g, b] = lit(&segment.light, [c[0], c[1], c[2]], n, vectors.toward, vectors.half);
        [r, g, b, c[3] * silhouette_factor(&segment.light, n, segment.eye)]
    };
    let mut from = 0.0;
    let mut f = point(0.0);
    for k in 1..=count as u32 {
        // Where the normal has turned by k / count of the angle.
        let mut to = 1.0;
        if (k as f32) < count {
            let turned = angle * (k as f32 / count);
            let ahead = near * turned.sin();
            let behind = far * (angle - turned).sin();
            to = (ahead / (ahead + behind).max(1e-30)).clamp(from, 1.0);
        }
        let b = point(to);
        let part = (to - from) * (end - begin) * segment.length;
        let mut tau = [f[3], b[3]];
        if segment.light.silhouette > 0.0 {
            // The depth by Simpson's rule; how it is shared by the ends.
            let ends = 0.5 * (f[3] + b[3]);
            let mean = (ends + 2.0 * point(0.5 * (from + to))[3]) / 3.0;
            tau = if ends > 1e-20 { tau.map(|t| t * (mean / ends)) } else { [mean, mean] };
        }
        let w = match model {
            Weights::Direct => weights_direct(tau[1] * part, tau[0] * part),
            Weights::Average => weights_average(tau[1] * part, tau[0] * part),
        };
        let seen = 1.0 - result.color[3];
        for channel in 0..3 {
            result.color[channel] += seen * (f[channel] * w[2] + b[channel] * w[1]);
        }
        result.color[3] += seen * w[0];
        result.pieces += 1;
        from = to;
        f = b;
    }
}

/// A segment of one field, lit: see [`crate::transfer_f32::integrate`].
pub fn one_field(segment: &Illuminated, pieces: &[Piece], model: Weights, s_front: f32, s_back: f32) -> Integrated {
    let vectors = vectors(segment);
    let mut result = Integrated::default();
    let rise = s_back - s_front;
    let mut k = piece_at(pieces, s_front);
    let mut begin = 0.0_f32;
    while begin < 1.0 {
        let mut end = 1.0;
        if rise.abs() >= 1e-20 {
            let bound = if rise > 0.0 { pieces[k].s[1] } else { pieces[k].s[0] };
            end = ((bound - s_front) / rise).max(begin).min(1.0);
        }
        if end > begin {
            let front = classify(&pieces[k], s_front + rise * begin);
            let back = classify(&pieces[k], s_front + rise * end);
            add(segment, &vectors, model, [begin, end], front, back, &mut result);
        }
        begin = end;
        let next = if rise > 0.0 { (k + 1).min(pieces.len() - 1) } else { k.max(1) - 1 };
        if next == k {
            break;
        }
        k = next;
    }
    result
}

/// A segment with the colour of one field and the opacity of another, lit: see [`crate::two_field_f32::integrate`].
pub fn two_fields(
    segment: &Illuminated,
    color: &[Piece],
    opacity: &[Piece],
    front: [f32; 2],
    back: [f32; 2],
) -> Integrated {
    let vectors = vectors(segment);
    let mut result = Integrated::default();
    let rise = [back[0] - front[0], back[1] - front[1]];
    let mut i = piece_at(color, front[0]);
    let mut j = piece_at(opacity, front[1]);
    let mut begin = 0.0_f32;
    for _ in 0..color.len() + opacity.len() {
        let leave_color = leaves(&color[i], front[0], rise[0]);
        let leave_opacity = leaves(&opacity[j], front[1], rise[1]);
        let end = leave_color.min(leave_opacity).max(begin).min(1.0);
        if end > begin {
            let ends = [begin, end].map(|u| {
                let [r, g, b, _] = classify(&color[i], front[0] + rise[0] * u);
                [r, g, b, classify(&opacity[j], front[1] + rise[1] * u)[3]]
            });
            add(segment, &vectors, Weights::Direct, [begin, end], ends[0], ends[1], &mut result);
        }
        begin = end;
        if begin >= 1.0 {
            break;
        }
        if leave_color <= leave_opacity {
            i = next(i, rise[0], color.len());
        } else {
            j = next(j, rise[1], opacity.len());
        }
    }
    result
}
