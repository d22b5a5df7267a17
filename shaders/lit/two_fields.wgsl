// Light on the colour of one field and the opacity of another. The twin in Rust is tetlux-optics, lit_linear_f32.
import package::lib::integrated::{Integrated};
import package::lib::look::{look};
import package::lib::transfer::{pieces, piece_among, classify};
import package::lib::two_fields::{leaves, next};
import package::lib::lit_linear::{illuminated, add};

// Pieces are found for each segment.
fn pieces_met(low: f32, high: f32) -> vec2<u32> {
    return vec2<u32>(0u);
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
    let count = arrayLength(&pieces);
    // The luminance over the first scalar, then the extinction over the second.
    let colors = vec2<u32>(0u, look.color_pieces - 1u);
    let opacities = vec2<u32>(look.color_pieces, count - 1u);
    let s = front[0].xy;
    let rise = back[0].xy - s;
    var i = piece_among(colors, s.x);
    var j = piece_among(opacities, s.y);
    var result: Integrated;
    var begin = 0.0;
    for (var n = 0u; n < count; n++) {
        let leave_color = leaves(i, s.x, rise.x);
        let leave_opacity = leaves(j, s.y, rise.y);
        let end = min(max(min(leave_color, leave_opacity), begin), 1.0);
        if end > begin {
            let near = vec4<f32>(classify(i, s.x + rise.x * begin).rgb, classify(j, s.y + rise.y * begin).w);
            let far = vec4<f32>(classify(i, s.x + rise.x * end).rgb, classify(j, s.y + rise.y * end).w);
            result = add(segment, begin, end, near, far, result);
        }
        begin = end;
        if begin >= 1.0 {
            break;
        }
        if leave_color <= leave_opacity {
            i = next(i, rise.x, colors);
        } else {
            j = next(j, rise.y, opacities);
        }
    }
    return result;
}
