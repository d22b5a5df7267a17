//! The colour spaces in which presets are interpolated, as VTK and ParaView mean them.
//!
//! Components are sRGB-encoded in [0, 1] where a space is defined by sRGB's primaries (Lab, Diverging).

#[cfg(test)]
mod tests;

use std::f64::consts::PI;

/// How colours between two preset points are found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ColorSpace {
    /// Linear in the RGB components.
    Rgb,
    /// Linear in hue, saturation and value; with `wrap` the hue takes the shorter way round the circle.
    Hsv {
        /// Whether hue may pass through red from either side.
        wrap: bool,
    },
    /// Linear in CIE L*a*b* under D65.
    Lab,
    /// Moreland's polar form of L*a*b* (magnitude, saturation, hue), with white between two distinct saturated
    /// colours: "Diverging Color Maps for Scientific Visualization", 2009.
    Diverging,
    /// No interpolation: the colour of the interval's second point throughout.
    Step,
}

impl ColorSpace {
    /// The colour at `t` in [0, 1] between `from` and `to`.
    pub fn interpolate(self, from: [f64; 3], to: [f64; 3], t: f64) -> [f64; 3] {
        match self {
            Self::Rgb => mix(from, to, t),
            Self::Step => to,
            Self::Hsv { wrap } => interpolate_hsv(rgb_to_hsv(from), rgb_to_hsv(to), wrap, t),
            Self::Lab => lab_to_rgb(mix(rgb_to_lab(from), rgb_to_lab(to), t)),
            Self::Diverging => interpolate_diverging(from, to, t),
        }
    }
}

fn mix(from: [f64; 3], to: [f64; 3], t: f64) -> [f64; 3] {
    std::array::from_fn(|i| (1.0 - t) * from[i] + t * to[i])
}

fn interpolate_hsv(mut from: [f64; 3], mut to: [f64; 3], wrap: bool, t: f64) -> [f64; 3] {
    if wrap && (from[0] - to[0]).abs() > 0.5 {
        if from[0] > to[0] {
            from[0] -= 1.0;
        } else {
            to[0] -= 1.0;
        }
    }
    let mut hsv = mix(from, to, t);
    if hsv[0] < 0.0 {
        hsv[0] += 1.0;
    }
    hsv_to_rgb(hsv)
}

/// Hue, saturation, value, each in [0, 1] for colours in [0, 1]; the hue of greys is 0.
pub fn rgb_to_hsv([r, g, b]: [f64; 3]) -> [f64; 3] {
    let value = r.max(g).max(b);
    let chroma = value - r.min(g).min(b);
    if chroma <= 0.0 || value <= 0.0 {
        return [0.0, 0.0, value];
    }
    let sixths = if value == r {
        (g - b) / chroma
    } else if value == g {
        2.0 + (b - r) / chroma
    } else {
        4.0 + (r - g) / chroma
    };
    [(sixths / 6.0).rem_euclid(1.0), chroma / value, value]
}

/// The inverse of [`rgb_to_hsv`].
pub fn hsv_to_rgb([hue, saturation, value]: [f64; 3]) -> [f64; 3] {
    let channel = |offset: f64| {
        let k = (offset + 6.0 * hue).rem_euclid(6.0);
        value * (1.0 - saturation * k.min(4.0 - k).clamp(0.0, 1.0))
    };
    [channel(5.0), channel(3.0), channel(1.0)]
}

/// sRGB primaries to CIE XYZ, D65, as VTK rounds them.
const RGB_TO_XYZ: [[f64; 3]; 3] = [[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]];

/// The inverse of [`RGB_TO_XYZ`], rounded alike.
const XYZ_TO_RGB: [[f64; 3]; 3] = [[3.2406, -1.5372, -0.4986], [-0.9689, 1.8758, 0.0415], [0.0557, -0.2040, 1.0570]];

/// XYZ of white under D65.
const WHITE: [f64; 3] = [0.9505, 1.0, 1.089];

fn transform(matrix: [[f64; 3]; 3], vector: [f64; 3]) -> [f64; 3] {
    matrix.map(|row| row[0] * vector[0] + row[1] * vector[1] + row[2] * vector[2])
}

/// CIE L*a*b* under D65 of an sRGB-encoded colour.
pub fn rgb_to_lab(rgb: [f64; 3]) -> [f64; 3] {
    let linear = rgb.map(|c| if c > 0.04045 { ((c + 0.055) / 1.055).powf(2.4) } else { c / 12.92 });
    let xyz = transform(RGB_TO_XYZ, linear);
    let [x, y, z] = std::array::from_fn(|i| {
        let part = xyz[i] / WHITE[i];
        if part > 0.008856 { part.cbrt() } else { 7.787 * part + 16.0 / 116.0 }
    });
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

/// The sRGB-encoded colour of CIE L*a*b* under D65. As in VTK, colours outside the gamut are scaled so that none
/// exceeds 1, and negative components become 0.
pub fn lab_to_rgb([l, a, b]: [f64; 3]) -> [f64; 3] {
    let y = (l + 16.0) / 116.0;
    let roots = [y + a / 500.0, y, y - b / 200.0];
    let xyz = std::array::from_fn(|i| {
        let cube = roots[i].powi(3);
        WHITE[i] * if cube > 0.008856 { cube } else { (roots[i] - 16.0 / 116.0) / 7.787 }
    });
    let encoded =
        transform(XYZ_TO_RGB, xyz).map(|c| if c > 0.0031308 { 1.055 * c.powf(1.0 / 2.4) - 0.055 } else { 12.92 * c });
    let largest = encoded.into_iter().fold(1.0, f64::max);
    encoded.map(|c| (c / largest).max(0.0))
}

/// Saturation (an angle) below which Moreland calls a colour unsaturated, its hue meaningless.
const SATURATED: f64 = 0.05;

fn interpolate_diverging(from: [f64; 3], to: [f64; 3], mut t: f64) -> [f64; 3] {
    let (mut from, mut to) = (lab_to_msh(rgb_to_lab(from)), lab_to_msh(rgb_to_lab(to)));
    let turn = (from[2] - to[2]).abs();
    let hue_difference = turn.min(2.0 * PI - turn);
    if from[1] > SATURATED && to[1] > SATURATED && hue_difference > 0.33 * PI {
        let white = [from[0].max(to[0]).max(88.0), 0.0, 0.0];
        if t < 0.5 {
            to = white;
            t *= 2.0;
        } else {
            from = white;
            t = 2.0 * t - 1.0;
        }
    }
    if from[1] < SATURATED && to[1] > SATURATED {
        from[2] = hue_towards_white(to, from[0]);
    } else if to[1] < SATURATED && from[1] > SATURATED {
        to[2] = hue_towards_white(from, to[0]);
    }
    lab_to_rgb(msh_to_lab(mix(from, to, t)))
}

fn lab_to_msh([l, a, b]: [f64; 3]) -> [f64; 3] {
    let magnitude = (l * l + a * a + b * b).sqrt();
    let saturation = if magnitude > 0.001 { (l / magnitude).clamp(-1.0, 1.0).acos() } else { 0.0 };
    let hue = if saturation > 0.001 { b.atan2(a) } else { 0.0 };
    [magnitude, saturation, hue]
}

fn msh_to_lab([magnitude, saturation, hue]: [f64; 3]) -> [f64; 3] {
    let chroma = magnitude * saturation.sin();
    [magnitude * saturation.cos(), chroma * hue.cos(), chroma * hue.sin()]
}

/// The hue to give an unsaturated end so that the perceived change stays even (Moreland 2009, AdjustHue).
fn hue_towards_white([magnitude, saturation, hue]: [f64; 3], white: f64) -> f64 {
    if magnitude >= white - 0.1 {
        return hue;
    }
    let spin = saturation * (white * white - magnitude * magnitude).sqrt() / (magnitude * saturation.sin());
    // Away from purple, which would look like a second hue.
    if hue > -0.3 * PI { hue + spin } else { hue - spin }
}
