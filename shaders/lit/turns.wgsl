// Light on any function: it is held on pieces over which the normal turns by the same angle. How many, and what that bounds:
// the twins of the same names in Rust, tetlux-optics, lit_f32.
import package::lib::segment::{weights_direct};
import package::lib::integrated::{Integrated};
import package::lib::look::{look};
import package::lib::light::{normal, half_way, lit, silhouette_factor};
import package::axes::function::{classified};

// A segment's light is held on no more pieces than this.
const MOST_TURNS = 256.0;

// Pieces are of segments.
fn pieces_met(low: f32, high: f32) -> vec2<u32> {
    return vec2<u32>(0u);
}

// In how many pieces the light of a segment is held over which the normal turns by an angle.
fn turns_of(angle: f32) -> f32 {
    let error = angle * (look.slope / 4.0 + look.curvature * angle / 16.0);
    return clamp(ceil(sqrt(error / look.errors.y)), 1.0, MOST_TURNS);
}

// Where in a piece of even extinction light is absorbed on average: at 1/2 if it is thin, near the front if thick.
fn absorbed_at(alpha: f32) -> f32 {
    let depth = -log(1.0 - min(alpha, 0.999999));
    let w = weights_direct(depth, depth);
    return select(0.5, w.y / max(w.x, 1e-6), w.x > 1e-6);
}

// The angle between two gradients; 0 if one of them is none, as nothing turns then.
fn angle_between(a: vec3<f32>, b: vec3<f32>) -> f32 {
    let p = normal(a);
    let q = normal(b);
    if dot(p, p) == 0.0 || dot(q, q) == 0.0 {
        return 0.0;
    }
    return atan2(length(cross(p, q)), dot(p, q));
}

// A segment with scalars and, in [1], gradients at its ends, of a length in device units; `eye` is the unit vector to it.
fn integrate_lit(
    range: vec2<u32>,
    front: mat2x4<f32>,
    back: mat2x4<f32>,
    length_of_all: f32,
    eye: vec3<f32>,
) -> Integrated {
    let s_front = front[0].xy;
    let s_rise = back[0].xy - s_front;
    let g_front = front[1].xyz;
    let g_rise = back[1].xyz - g_front;
    var toward = look.direction;
    if dot(toward, toward) == 0.0 {
        toward = eye;
    }
    let half = half_way(toward, eye);
    let angle = angle_between(g_front, back[1].xyz);
    let count = turns_of(angle);
    if count > 1.0 {
        let whole = classified(s_front, back[0].xy, length_of_all);
        if whole.color.w <= 0.0 {
            // Nothing is seen: there is nothing to light.
            return whole;
        }
    }
    let near = length(g_front);
    let far = length(back[1].xyz);
    var result: Integrated;
    var begin = 0.0;
    for (var k = 1.0; k <= count; k += 1.0) {
        // Where the normal has turned by k / count of the angle.
        let turned = angle * (k / count);
        let ahead = near * sin(turned);
        let behind = far * sin(max(angle - turned, 0.0));
        var end = 1.0;
        if k < count {
            end = clamp(ahead / max(ahead + behind, 1e-37), begin, 1.0);
        }
        var factor = 1.0;
        if look.silhouette != 0.0 {
            let first = silhouette_factor(normal(g_front + g_rise * begin), eye);
            let middle = silhouette_factor(normal(g_front + g_rise * (0.5 * (begin + end))), eye);
            let last = silhouette_factor(normal(g_front + g_rise * end), eye);
            factor = (first + 4.0 * middle + last) / 6.0;
        }
        let part = classified(
            s_front + s_rise * begin,
            s_front + s_rise * end,
            length_of_all * (end - begin) * factor,
        );
        let alpha = part.color.w;
        if alpha > 0.0 {
            let n = normal(g_front + g_rise * (begin + (end - begin) * absorbed_at(alpha)));
            let seen = (1.0 - result.color.w) * alpha;
            result.color += vec4<f32>(seen * lit(part.color.rgb / alpha, n, toward, half), seen);
        }
        result.pieces += part.pieces;
        begin = end;
    }
    return result;
}
