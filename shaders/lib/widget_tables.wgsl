// The published tables of widgets (Song et al. 2009, section 4). Twins of the same names in Rust: tetlux-tables, lookup.
import package::lib::erf::{erf};
import package::lib::lookup::{lookup, position_on};

// One layer each: a Gaussian, a sine, a triangle wave.
@group(2) @binding(2) var layers: texture_2d_array<f32>;

// Where the axes of P, M and A end, and those of t.
const LARGEST = 10.0;
const MAX_T = 4.0;

fn layer_texel(layer: u32, i: u32, j: u32) -> f32 {
    return lookup.low[0][layer] + lookup.range[0][layer] * textureLoad(layers, vec2<u32>(i, j), layer, 0).x;
}

// Bilinear interpolation at coordinates in [0, 1].
fn interpolate_layer(layer: u32, coordinates: vec2<f32>) -> f32 {
    let nodes = textureDimensions(layers);
    let x = position_on(coordinates.x, nodes.x);
    let y = position_on(coordinates.y, nodes.y);
    let low = mix(layer_texel(layer, x.low, y.low), layer_texel(layer, x.low + 1u, y.low), x.share);
    let high = mix(layer_texel(layer, x.low, y.low + 1u), layer_texel(layer, x.low + 1u, y.low + 1u), x.share);
    return mix(low, high, y.share);
}

fn gaussian_at(p: f32, t: f32) -> f32 {
    return interpolate_layer(0u, vec2<f32>(p / LARGEST, (t + MAX_T) / (2.0 * MAX_T)));
}

// int_t0^t1 exp(-P (erf y - erf t0)) dy: the transmittance to the front end of a Gaussian, integrated.
fn sample_gaussian(p: f32, t0: f32, t1: f32) -> f32 {
    return exp(p * erf(t0)) * (gaussian_at(p, t1) - gaussian_at(p, t0));
}

fn sine_at(m: f32, t: f32) -> f32 {
    return interpolate_layer(1u, vec2<f32>(t / 3.1415927, m / LARGEST));
}

// int_t1^t2 exp(-M (cos t1 - cos y)) dy, 0 <= t1 <= t2 <= pi: the same for one lobe of a sine.
fn sample_sine(m: f32, t1: f32, t2: f32) -> f32 {
    return exp(-m * cos(t1)) * (sine_at(m, t2) - sine_at(m, t1));
}

fn triangle_at(a_max: f32, l: f32) -> f32 {
    return interpolate_layer(2u, vec2<f32>(l, a_max / LARGEST));
}

// int_l0^l1 of the transmittance to l0 along a ramp that falls as A (1 - l), 0 <= l0 <= l1 <= 1.
fn sample_triangle(a_max: f32, l0: f32, l1: f32) -> f32 {
    return exp(a_max * (l0 - 0.5 * l0 * l0)) * (triangle_at(a_max, l1) - triangle_at(a_max, l0));
}
