// Colour of one scalar and opacity of another. Both are linear along a segment: it is cut at the nodes of both functions, so
// that on each piece luminance and extinction are linear. Twins of the same names in Rust: tetlux-optics, two_field_f32.
import package::lib::transfer::{pieces, piece_among, classify};
import package::lib::look::{look};
import package::axes::weights::{weights};

// Where a scalar that rises by `rise` from `front` leaves a piece; 2 if it does not move.
fn leaves(k: u32, front: f32, rise: f32) -> f32 {
    if abs(rise) < 1e-20 {
        return 2.0;
    }
    return (select(pieces[k].s.x, pieces[k].s.y, rise > 0.0) - front) / rise;
}

// The piece after this one in the direction of a scalar, within its list from range.x to range.y.
fn next(k: u32, rise: f32, range: vec2<u32>) -> u32 {
    return select(max(k, range.x + 1u) - 1u, min(k + 1u, range.y), rise > 0.0);
}

// Premultiplied colour and alpha of a segment with both scalars at its ends, of a length in device units.
fn integrate(front: vec2<f32>, back: vec2<f32>, length: f32) -> vec4<f32> {
    let count = arrayLength(&pieces);
    // The luminance over the first scalar, then the extinction over the second.
    let colors = vec2<u32>(0u, look.color_pieces - 1u);
    let opacities = vec2<u32>(look.color_pieces, count - 1u);
    let rise = back - front;
    var i = piece_among(colors, front.x);
    var j = piece_among(opacities, front.y);
    var color = vec3<f32>(0.0);
    var alpha = 0.0;
    var begin = 0.0;
    for (var n = 0u; n < count; n++) {
        let leave_color = leaves(i, front.x, rise.x);
        let leave_opacity = leaves(j, front.y, rise.y);
        let end = min(max(min(leave_color, leave_opacity), begin), 1.0);
        if end > begin {
            let light_f = classify(i, front.x + rise.x * begin).rgb;
            let light_b = classify(i, front.x + rise.x * end).rgb;
            let tau_f = classify(j, front.y + rise.y * begin).w;
            let tau_b = classify(j, front.y + rise.y * end).w;
            let part = (end - begin) * length;
            let w = weights(tau_b * part, tau_f * part);
            color += (1.0 - alpha) * (light_f * w.z + light_b * w.y);
            alpha += (1.0 - alpha) * w.x;
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
    return vec4<f32>(color, alpha);
}
