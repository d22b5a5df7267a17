// Adaptive sampling: Moreland and Angel 2004, section 3.2. A cell is drawn once for every piece of the transfer function
// that its scalars meet, and each time clipped to the piece between its two planes of constant scalar.
import package::lib::span::{Segment};
import package::lib::transfer::{pieces, piece_among, classify};
import package::axes::weights::{weights};

// The piece of each entry of the order.
@group(0) @binding(6) var<storage, read> entry_pieces: array<u32>;

fn pieces_between(low: f32, high: f32, entry: u32) -> vec2<u32> {
    return vec2<u32>(entry_pieces[entry], arrayLength(&pieces) - 1u);
}

fn shade(range: vec2<u32>, segment: Segment) -> vec4<f32> {
    return integrate_piece(range, segment.front, segment.back, segment.length);
}

// Premultiplied colour and alpha of the part of a segment whose scalars lie in piece range.x; range.y is the last piece
// of all.
fn integrate_piece(range: vec2<u32>, s_front: f32, s_back: f32, length: f32) -> vec4<f32> {
    let k = range.x;
    let rise = s_back - s_front;
    var begin = 0.0;
    var end = 1.0;
    if abs(rise) < 1e-20 {
        // A constant scalar lies in one piece, as for a segment that is not clipped.
        if piece_among(vec2<u32>(0u, range.y), s_front) != k {
            return vec4<f32>(0.0);
        }
    } else {
        let near = select(pieces[k].s.y, pieces[k].s.x, rise > 0.0);
        let far = select(pieces[k].s.x, pieces[k].s.y, rise > 0.0);
        begin = clamp((near - s_front) / rise, 0.0, 1.0);
        end = clamp((far - s_front) / rise, begin, 1.0);
    }
    let part = (end - begin) * length;
    if !(part > 0.0) {
        return vec4<f32>(0.0);
    }
    let front = classify(k, s_front + rise * begin);
    let back = classify(k, s_front + rise * end);
    let w = weights(back.w * part, front.w * part);
    return vec4<f32>(front.rgb * w.z + back.rgb * w.y, w.x);
}
