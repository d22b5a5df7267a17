// Light on one field's transfer function. The twin in Rust is tetlux-optics, lit_linear_f32.
import package::lib::integrated::{Integrated};
import package::lib::transfer::{pieces, piece_at, piece_among, classify};
import package::lib::lit_linear::{illuminated, add};

// The first and the last piece that scalars from `low` to `high` meet.
fn pieces_met(low: f32, high: f32) -> vec2<u32> {
    return vec2<u32>(piece_at(low), piece_at(high));
}

// A segment with scalars and, in [1], gradients at its ends, of a length in device units; `eye` is the unit vector to it.
fn integrate_lit(
    range: vec2<u32>,
    front: mat2x4<f32>,
    back: mat2x4<f32>,
    length: f32,
    eye: vec3<f32>,
) -> Integrated {
    let segment = illuminated(front[1].xyz, back[1].xyz, length, eye);
    let s_front = front[0].x;
    let rise = back[0].x - s_front;
    var k = piece_among(range, s_front);
    var result: Integrated;
    var begin = 0.0;
    for (var n = range.x; n <= range.y; n++) {
        var end = 1.0;
        // Below this the scalar is constant, and dividing by it might overflow.
        if abs(rise) >= 1e-20 {
            end = clamp((select(pieces[k].s.x, pieces[k].s.y, rise > 0.0) - s_front) / rise, begin, 1.0);
        }
        if end > begin {
            let near = classify(k, s_front + rise * begin);
            result = add(segment, begin, end, near, classify(k, s_front + rise * end), result);
        }
        begin = end;
        if begin >= 1.0 {
            break;
        }
        k = select(k - 1u, k + 1u, rise > 0.0);
    }
    return result;
}
