// A 1D transfer function, integrated exactly along a segment on which the scalar is linear.
//
// The function is piecewise linear: the segment is cut at the control points between its two scalars, each part has
// linear luminance and extinction, and the parts are composited front to back. The twin in Rust is tetlux-optics,
// transfer_f32.
import package::lib::segment::{weights_direct, weights_average};

// 0: weights_direct; 1: weights_average.
override INTEGRATOR: u32 = 0u;

// An interval of the scalar on which luminance and extinction are linear.
struct Piece {
    // Luminance and, in w, extinction per device unit at the lower end.
    low: vec4<f32>,
    // The same at the upper end.
    high: vec4<f32>,
    // Lower end, upper end, 1 / (upper - lower) or 0 if the piece is unbounded.
    s: vec4<f32>,
}

// Ascending, from minus to plus "infinity" (1e30), without gaps; the first and the last are constant.
@group(0) @binding(1) var<storage, read> pieces: array<Piece>;

// The last piece that begins at or below s.
fn piece_at(s: f32) -> u32 {
    return piece_among(vec2<u32>(0u, arrayLength(&pieces) - 1u), s);
}

// The same, known to be among the pieces from range.x to range.y.
fn piece_among(range: vec2<u32>, s: f32) -> u32 {
    var low = range.x;
    var high = range.y + 1u;
    while high - low > 1u {
        let middle = (low + high) / 2u;
        if pieces[middle].s.x <= s {
            low = middle;
        } else {
            high = middle;
        }
    }
    return low;
}

fn classify(k: u32, s: f32) -> vec4<f32> {
    let t = clamp((s - pieces[k].s.x) * pieces[k].s.z, 0.0, 1.0);
    return pieces[k].low + (pieces[k].high - pieces[k].low) * t;
}

fn weights(a: f32, b: f32) -> vec3<f32> {
    if INTEGRATOR == 1u {
        return weights_average(a, b);
    }
    return weights_direct(a, b);
}

// Premultiplied colour and alpha of a segment with scalars s_front and s_back, of a length in device units. `range` are
// the first and the last piece that its cell's scalars meet: for most cells one.
fn integrate(range: vec2<u32>, s_front: f32, s_back: f32, length: f32) -> vec4<f32> {
    let rise = s_back - s_front;
    var k = piece_among(range, s_front);
    // Below this the scalar is constant, and dividing by it might overflow.
    if abs(rise) < 1e-20 {
        let c = classify(k, s_front);
        let w = weights(c.w * length, c.w * length);
        return vec4<f32>(c.rgb * w.x, w.x);
    }
    var color = vec3<f32>(0.0);
    var alpha = 0.0;
    var begin = 0.0;
    for (var n = range.x; n <= range.y; n++) {
        let bound = select(pieces[k].s.x, pieces[k].s.y, rise > 0.0);
        let end = clamp((bound - s_front) / rise, begin, 1.0);
        if end > begin {
            let front = classify(k, s_front + rise * begin);
            let back = classify(k, s_front + rise * end);
            let part = (end - begin) * length;
            let w = weights(back.w * part, front.w * part);
            color += (1.0 - alpha) * (front.rgb * w.z + back.rgb * w.y);
            alpha += (1.0 - alpha) * w.x;
        }
        begin = end;
        if begin >= 1.0 {
            break;
        }
        k = select(k - 1u, k + 1u, rise > 0.0);
    }
    return vec4<f32>(color, alpha);
}
