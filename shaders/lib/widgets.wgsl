// Segments through any number of widgets, to a stated error: extinctions add, so that alpha is a closed form; a colour that
// varies is composited from pieces of exact depth. Why so many, and what that bounds: the twins of the same names in Rust,
// tetlux-optics, widgets_f32.
import package::lib::segment::{opacity};
import package::lib::integrated::{Integrated};
import package::lib::widget::{Track, widgets, track, track_depth, track_rate, track_slopes, kinks, next_kink};

// No segment is cut into more pieces than about this.
const MAX_PIECES = 512u;

// An error that thousands of segments do not make visible.
const LEAST_BOUND = 1e-12;

// What decides how finely a segment is cut.
struct Summary {
    depth: f32,
    // Sums over the widgets: largest extinction, first and second derivative.
    rate: f32,
    slope: f32,
    curvature: f32,
    // Kinks, about.
    kinks: f32,
    // The least and the largest colour.
    low: vec3<f32>,
    high: vec3<f32>,
}

fn summary(front: vec2<f32>, back: vec2<f32>, length: f32) -> Summary {
    var sum: Summary;
    sum.low = vec3<f32>(1e30);
    for (var i = 0u; i < arrayLength(&widgets); i++) {
        let t = track(i, front, back, length);
        let depth = track_depth(t, t.begin, t.end);
        if depth > 0.0 {
            let slopes = track_slopes(t);
            sum.depth += depth;
            sum.rate += t.scale;
            sum.slope += slopes.x;
            sum.curvature += slopes.y;
            sum.kinks += kinks(t);
            sum.low = min(sum.low, widgets[i].color.rgb);
            sum.high = max(sum.high, widgets[i].color.rgb);
        }
    }
    return sum;
}

// The number of equal pieces, cut at kinks besides, at which the error of every channel is at most `bound`.
fn piece_count(sum: Summary, spread: f32, alpha: f32, bound: f32) -> f32 {
    let third = alpha * spread * sum.curvature / 96.0;
    let fourth = spread * sum.slope * (sum.slope * sum.rate / 240.0 + sum.curvature / 384.0);
    let fifth = 0.0053091 * spread * sum.slope * sum.slope * sum.slope;
    var count = ceil(clamp(sqrt(0.125 * sum.slope), 1.0, f32(MAX_PIECES)));
    for (var n = 0u; n < 64u; n++) {
        let h = 1.0 / count;
        if h * h * h * (third + h * (fourth + h * fifth)) <= bound {
            break;
        }
        count += max(floor(0.125 * count), 1.0);
    }
    return min(count, f32(MAX_PIECES));
}

// int_0^1 (2v - 1) exp(-x v) dv for x >= 0, alpha = 1 - exp(-x).
fn tilt(x: f32, alpha: f32) -> f32 {
    if x < 0.6 {
        let series = 1.0 / 40.0 - x * (1.0 / 180.0 - x * (1.0 / 1008.0 - x / 6720.0));
        return -x * (1.0 / 6.0 - x * (1.0 / 12.0 - x * series));
    }
    return (2.0 * alpha - x * (2.0 - alpha)) / (x * x);
}

// Composites pieces of the share `step` front to back, cut where a widget begins or ends and, if `at_kinks`, at kinks.
fn composite(front: vec2<f32>, back: vec2<f32>, length: f32, step: f32, at_kinks: bool) -> Integrated {
    var result: Integrated;
    var transmittance = 1.0;
    var u = 0.0;
    while u < 1.0 && result.pieces < 2u * MAX_PIECES {
        // Up to where something begins, ends or has a kink.
        var end = 1.0;
        var seen = false;
        for (var i = 0u; i < arrayLength(&widgets); i++) {
            let t = track(i, front, back, length);
            if t.begin < t.end && t.end > u {
                if t.begin > u {
                    end = min(end, t.begin);
                } else {
                    seen = true;
                    end = min(end, t.end);
                    if at_kinks {
                        end = min(end, next_kink(t, u));
                    }
                }
            }
        }
        if seen {
            end = min(end, u + step);
        }
        // Never less than f32 resolves.
        end = min(max(end, u + 1e-6), 1.0);
        if seen {
            let part = piece(front, back, length, u, end);
            result.color += vec4<f32>(transmittance * part.rgb, 0.0);
            transmittance *= exp(-part.w);
            result.pieces += 1u;
        }
        u = end;
    }
    return result;
}

// Colour and, in w, optical depth of the piece from u to `end`, on which no widget begins or ends.
fn piece(front: vec2<f32>, back: vec2<f32>, length: f32, u: f32, end: f32) -> vec4<f32> {
    let width = end - u;
    var depth = 0.0;
    var growth = 0.0;
    var emission = vec3<f32>(0.0);
    var emission_growth = vec3<f32>(0.0);
    for (var i = 0u; i < arrayLength(&widgets); i++) {
        let t = track(i, front, back, length);
        if t.begin <= u && t.end > u {
            let own = track_depth(t, u, end);
            let own_growth = 0.5 * width * (track_rate(t, end) - track_rate(t, u));
            depth += own;
            growth += own_growth;
            emission += widgets[i].color.rgb * own;
            emission_growth += widgets[i].color.rgb * own_growth;
        }
    }
    if depth < 1e-30 {
        return vec4<f32>(0.0);
    }
    let alpha = opacity(depth);
    let mean = emission / depth;
    return vec4<f32>(mean * alpha + (emission_growth - mean * growth) * tilt(depth, alpha), depth);
}

// Premultiplied colour and alpha of a segment with coordinates `front` and `back`, of a length in device units: alpha exact,
// the error of every channel at most `share` of alpha (and what f32 cannot hold, some 1e-5).
fn integrate_share(front: vec2<f32>, back: vec2<f32>, length: f32, share: f32) -> Integrated {
    let sum = summary(front, back, length);
    var result: Integrated;
    if sum.depth <= 0.0 {
        return result;
    }
    let alpha = opacity(sum.depth);
    let bound = max(share * alpha, LEAST_BOUND);
    result.pieces = 1u;
    let apart = sum.high - sum.low;
    let spread = max(apart.x, max(apart.y, apart.z));
    if spread > 0.0 {
        // The colour stays between the least and the largest whatever the pieces: kinks may not matter.
        let matters = spread * alpha > bound;
        let few = sum.kinks <= f32(MAX_PIECES);
        var step = 1.0;
        if matters {
            step = 1.0 / select(f32(MAX_PIECES), piece_count(sum, spread, alpha, bound), few);
        }
        result = composite(front, back, length, step, matters && few);
    }
    result.color = vec4<f32>(clamp(result.color.rgb, sum.low * alpha, sum.high * alpha), alpha);
    return result;
}
