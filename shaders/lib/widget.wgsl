// A widget over two normalised scalars: extinction, exact optical depth, and how fast the extinction varies.
//
// Along a segment a widget is a track: a coordinate that is linear, and an extinction that is a fixed function of it.
// Twins of the same names in Rust: tetlux-optics, widget_f32. No step makes an infinity or a NaN.
import package::lib::segment::{clean};
import package::lib::erf::{gaussian_mean};

// Kinds: no variation; exp(-t^2); straight ramps; the absolute value of a sine; its square.
const UNIFORM = 0u;
const GAUSSIAN = 1u;
const TRIANGLE = 2u;
const ABS_SINE = 3u;
const SINE_SQUARED = 4u;

const PI = 3.1415927;
const HALF_PI = 1.5707964;

// Coordinates are limited to this value: their squares stay finite.
const FAR_AWAY = 1e15;

struct Widget {
    // Luminance and, in w, extinction per device unit at the peak.
    color: vec4<f32>,
    // Lower ends of x and y, upper ends of x and y.
    support: vec4<f32>,
    // Gaussian: centre, then 1 / (sqrt 2 sigma). Wave: frequency, then phase at the origin, from 0 to 1.
    shape: vec4<f32>,
    // In x the kind.
    kind: vec4<u32>,
}

@group(0) @binding(11) var<storage, read> widgets: array<Widget>;

// A widget along a segment; u runs from 0 at the front to 1 at the back.
struct Track {
    kind: u32,
    // Optical depth of the segment if the extinction were everywhere that of the coordinate's peak.
    scale: f32,
    // The coordinate at u = 0 and how much it grows: t of a Gaussian, the phase of a wave.
    start: f32,
    step: f32,
    // Where it is seen, empty if the first is not below the second.
    begin: f32,
    end: f32,
}

// The part of [0, 1] on which a scalar, linear from `front` to `back`, lies between `low` and `high`.
fn clip(front: f32, back: f32, low: f32, high: f32) -> vec2<f32> {
    let rise = back - front;
    if abs(rise) < 1e-20 {
        return select(vec2<f32>(1.0, 0.0), vec2<f32>(0.0, 1.0), low <= front && front <= high);
    }
    let one = (low - front) / rise;
    let two = (high - front) / rise;
    return vec2<f32>(clamp(min(one, two), 0.0, 1.0), clamp(max(one, two), 0.0, 1.0));
}

// The part of [0, 1] on which a segment lies in a widget's rectangle.
fn inside(i: u32, front: vec2<f32>, back: vec2<f32>) -> vec2<f32> {
    let support = widgets[i].support;
    let x = clip(front.x, back.x, support.x, support.z);
    let y = clip(front.y, back.y, support.y, support.w);
    return vec2<f32>(max(x.x, y.x), min(x.y, y.y));
}

// The i-th widget along the segment from `front` to `back` of a length in device units.
fn track(i: u32, front: vec2<f32>, back: vec2<f32>, length: f32) -> Track {
    let part = inside(i, front, back);
    let kind = widgets[i].kind.x;
    let whole = Track(kind, clean(widgets[i].color.w * length), 0.0, 0.0, part.x, part.y);
    if kind == GAUSSIAN {
        return gaussian_track(i, front, back, whole);
    }
    if kind == UNIFORM {
        return whole;
    }
    let shape = widgets[i].shape;
    var result = whole;
    result.start = dot(shape.xy, front) + shape.z;
    result.step = dot(shape.xy, back - front);
    return result;
}

// Of a Gaussian: t along the line, and its distance from the centre in the scale.
fn gaussian_track(i: u32, front: vec2<f32>, back: vec2<f32>, whole: Track) -> Track {
    var result = whole;
    let shape = widgets[i].shape;
    let limit = vec2<f32>(FAR_AWAY);
    let at = clamp((front - shape.xy) * shape.zw, -limit, limit);
    let by = clamp((back - front) * shape.zw, -limit, limit);
    let length = sqrt(dot(by, by));
    if length < 1e-6 {
        result.scale *= exp(-dot(at, at));
        return result;
    }
    let along = by / length;
    // As a cross product: |x|^2 - t^2 would cancel. From the end that is nearer to the centre, where it is smaller.
    let beyond = at + by;
    var across = along.x * at.y - along.y * at.x;
    result.start = dot(along, at);
    if dot(beyond, beyond) < dot(at, at) {
        across = along.x * beyond.y - along.y * beyond.x;
        result.start = dot(along, beyond) - length;
    }
    result.step = length;
    result.scale *= exp(-across * across);
    // Beyond this the extinction is below 2e-9 a segment.
    let end = sqrt(max(log(max(result.scale, 1e-30)) + 20.0, 0.0));
    result.begin = max(result.begin, (-end - result.start) / length);
    result.end = min(result.end, (end - result.start) / length);
    return result;
}

// A wave's extinction at a phase, as a share of the peak's.
fn wave_share(kind: u32, phase: f32) -> f32 {
    // Halfway between two integers both are as far.
    let r = abs(phase - round(phase));
    if kind == TRIANGLE {
        return 2.0 * r;
    }
    let sine = sin(PI * r);
    return select(sine * sine, sine, kind == ABS_SINE);
}

// 1 - sin(y)/y for |y| <= pi/2, without cancellation.
fn one_minus_sinc(y: f32) -> f32 {
    let z = y * y;
    return z / 6.0 * (1.0 - z / 20.0 * (1.0 - z / 42.0 * (1.0 - z / 72.0 * (1.0 - z / 110.0))));
}

// Mean of a wave between two distances, up to 1/2, from a zero, as a share of the peak.
fn ramp_mean(kind: u32, r0: f32, r1: f32) -> f32 {
    if kind == TRIANGLE {
        return r0 + r1;
    }
    let middle = HALF_PI * (r0 + r1);
    let half = HALF_PI * (r1 - r0);
    let sine = sin(middle);
    if kind == ABS_SINE {
        return sine * (1.0 - one_minus_sinc(half));
    }
    // sin^2(m) + cos(2m)/2 (1 - sinc) = sin^2(m) sinc + (1 - sinc)/2: a sum of positive terms.
    let lost = one_minus_sinc(2.0 * half);
    return sine * sine * (1.0 - lost) + 0.5 * lost;
}

// Mean of a wave between two phases of one ramp, which begins at phase half / 2.
fn part_mean(kind: u32, half: f32, p0: f32, p1: f32) -> f32 {
    let rising = half - 2.0 * floor(half * 0.5) < 0.5;
    let from_low = vec2<f32>(p0, p1) - 0.5 * half;
    let r = clamp(select(0.5 - from_low, from_low, rising), vec2<f32>(0.0), vec2<f32>(0.5));
    return ramp_mean(kind, r.x, r.y);
}

// Mean of a wave from a phase to another not below it, as a share of the peak.
fn wave_mean(kind: u32, low: f32, high: f32) -> f32 {
    let first = floor(2.0 * low);
    let last = floor(2.0 * high);
    if first == last {
        return part_mean(kind, first, low, high);
    }
    let begin = 0.5 * (first + 1.0);
    let end = 0.5 * last;
    let sum = (begin - low) * part_mean(kind, first, low, begin)
        + (end - begin) * ramp_mean(kind, 0.0, 0.5)
        + (high - end) * part_mean(kind, last, end, high);
    return sum / (high - low);
}

// Extinction of a track at u times the segment's length; it ends at the track's ends without notice.
fn track_rate(t: Track, u: f32) -> f32 {
    let p = t.start + t.step * u;
    if t.kind == UNIFORM {
        return t.scale;
    }
    if t.kind == GAUSSIAN {
        return t.scale * exp(-p * p);
    }
    return t.scale * wave_share(t.kind, p);
}

// Optical depth of a track from u0 to u1 >= u0, exact for any number of peaks.
fn track_depth(t: Track, u0: f32, u1: f32) -> f32 {
    let width = u1 - u0;
    if width <= 0.0 {
        return 0.0;
    }
    let p0 = t.start + t.step * u0;
    let p1 = t.start + t.step * u1;
    if t.kind == UNIFORM {
        return t.scale * width;
    }
    if t.kind == GAUSSIAN {
        return t.scale * width * gaussian_mean(p0, max(p0, p1));
    }
    return t.scale * width * wave_mean(t.kind, min(p0, p1), max(p0, p1));
}

// The next u, beyond the one given, at which a track's extinction has a kink; 2 if there is none.
fn next_kink(t: Track, u: f32) -> f32 {
    if (t.kind != TRIANGLE && t.kind != ABS_SINE) || abs(t.step) < 1e-6 {
        return 2.0;
    }
    // A little further, so that the kink at u itself is not found again.
    let p = 2.0 * (t.start + t.step * (u + 1e-5));
    let half = select(ceil(p) - 1.0, floor(p) + 1.0, t.step > 0.0);
    return (0.5 * half - t.start) / t.step;
}

// About how many kinks a track has where it is seen.
fn kinks(t: Track) -> f32 {
    return select(0.0, 2.0 * abs(t.step * (t.end - t.begin)), t.kind == TRIANGLE || t.kind == ABS_SINE);
}

// Bounds of the first and the second derivative of track_rate in u where the track is seen and has no kink.
fn track_slopes(t: Track) -> vec2<f32> {
    let step = abs(t.step);
    let first = t.scale * step;
    let second = first * step;
    if t.kind == GAUSSIAN {
        let t0 = t.start + t.step * t.begin;
        let t1 = t.start + t.step * t.end;
        let near = select(min(abs(t0), abs(t1)), 0.0, t0 * t1 <= 0.0);
        let far = max(abs(t0), abs(t1));
        return vec2<f32>(first * gaussian_slope(near, far), second * gaussian_curvature(near, far));
    }
    if t.kind == TRIANGLE {
        return vec2<f32>(2.0 * first, 0.0);
    }
    if t.kind == ABS_SINE {
        return vec2<f32>(PI * first, 9.869605 * second);
    }
    if t.kind == SINE_SQUARED {
        return vec2<f32>(PI * first, 19.73921 * second);
    }
    return vec2<f32>(0.0);
}

// Largest 2 t exp(-t^2) for t from `near` to `far`: it peaks at sqrt(1/2).
fn gaussian_slope(near: f32, far: f32) -> f32 {
    let t = clamp(0.70710677, near, max(near, far));
    return 2.0 * t * exp(-t * t);
}

// Largest |4 t^2 - 2| exp(-t^2) for t from `near` to `far`: it falls from 2 to 0 at sqrt(1/2), then peaks at sqrt(3/2).
fn gaussian_curvature(near: f32, far: f32) -> f32 {
    let t = clamp(1.2247449, near, max(near, far));
    let at_near = abs(4.0 * near * near - 2.0) * exp(-near * near);
    return max(at_near, abs(4.0 * t * t - 2.0) * exp(-t * t));
}
