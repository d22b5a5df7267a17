// Classified after interpolation, exactly: the segment is cut at the control points between its two scalars, each part
// has linear luminance and extinction, and the parts are composited front to back.
//
// The twin in Rust is tetlux-optics, transfer_f32.
import package::lib::span::{Segment};
import package::lib::transfer::{pieces, piece_at, piece_among, classify};
import package::axes::weights::{weights};

// The first and the last piece that scalars from `low` to `high` meet.
fn pieces_between(low: f32, high: f32, entry: u32) -> vec2<u32> {
    return vec2<u32>(piece_at(low), piece_at(high));
}

fn shade(range: vec2<u32>, segment: Segment) -> vec4<f32> {
    return integrate(range, segment.front, segment.back, segment.length);
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
        // Where a piece is entered and left it has its own ends and width, however narrow it is.
        let entered = begin > 0.0;
        let left = end < 1.0;
        var part = end - begin;
        if entered && left {
            part = min(pieces[k].s.w / abs(rise), 1.0);
        }
        if part > 0.0 {
            var front = select(pieces[k].high, pieces[k].low, rise > 0.0);
            var back = select(pieces[k].low, pieces[k].high, rise > 0.0);
            if !entered {
                front = classify(k, s_front);
            }
            if !left {
                back = classify(k, s_back);
            }
            part *= length;
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
