// The analytic integrals of widgets as published, with their tables: emission density, one widget at a time and one peak
// along a segment (Song et al. 2009, section 4). Twins of the same names in Rust: tetlux-tables, published.
import package::lib::segment::{opacity};
import package::lib::published::{psi_published};
import package::lib::integrated::{Integrated};
import package::lib::look::{look};
import package::lib::widget::{UNIFORM, GAUSSIAN, TRIANGLE, PI, Track, widgets, inside};
import package::lib::widget::{track, track_depth, track_rate, next_kink};
import package::lib::widget_tables::{LARGEST, sample_gaussian, sample_sine, sample_triangle};

// A segment up to its second peak has four parts between kinks at most; f32 may add slivers.
const MOST_PARTS = 6u;

// Mean transmittance to the front of even extinction.
fn even(depth: f32) -> f32 {
    if depth < 1e-6 {
        return 1.0;
    }
    return opacity(depth) / depth;
}

// Mean transmittance from the part [u, end] of a track to its front, on which it has no kink; `depth` is its own.
fn visible(t: Track, u: f32, end: f32, depth: f32) -> f32 {
    let p0 = t.start + t.step * u;
    let p1 = t.start + t.step * end;
    let step = abs(t.step);
    let travel = abs(p1 - p0);
    if t.kind == UNIFORM || travel < 1e-6 || depth <= 0.0 {
        return even(depth);
    }
    if t.kind == GAUSSIAN {
        let p = 0.88622695 * t.scale / step;
        if p > LARGEST {
            return even(depth);
        }
        return sample_gaussian(p, p0, p1) / travel;
    }
    // The lobe, by the middle: an end may lie on its rim.
    let lobe = floor(0.5 * (p0 + p1));
    let along = clamp(vec2<f32>(p0, p1) - lobe, vec2<f32>(0.0), vec2<f32>(1.0));
    // From the front, phases ascend: a lobe is the same from either side.
    let q = select(along, 1.0 - along, t.step < 0.0);
    if t.kind == TRIANGLE {
        let strength = 0.5 * t.scale / step;
        if strength > LARGEST {
            return even(depth);
        }
        if q.x + q.y < 1.0 {
            return psi_published(track_rate(t, end) * (end - u), track_rate(t, u) * (end - u));
        }
        return sample_triangle(strength, 2.0 * q.x - 1.0, 2.0 * q.y - 1.0) / (2.0 * travel);
    }
    let strength = t.scale / (PI * step);
    if strength > LARGEST {
        return even(depth);
    }
    return sample_sine(strength, PI * q.x, PI * q.y) / (PI * travel);
}

// Where a track comes to its second peak beyond u; 2 if it has none.
fn second_peak(t: Track, u: f32) -> f32 {
    if t.kind == UNIFORM || t.kind == GAUSSIAN || abs(t.step) < 1e-6 {
        return 2.0;
    }
    let p = t.start + t.step * u;
    return (select(ceil(p - 0.5) - 1.5, floor(p - 0.5) + 2.5, t.step > 0.0) - t.start) / t.step;
}

// Of one widget alone along a segment: the transmittance to the front integrated over it, as a share of the segment, and
// the optical depth.
fn alone(i: u32, front: vec2<f32>, back: vec2<f32>, length: f32) -> vec2<f32> {
    let part = inside(i, front, back);
    let t = track(i, front, back, length);
    let last = min(second_peak(t, part.x), part.y);
    var share = 0.0;
    var depth = 0.0;
    var u = part.x;
    for (var n = 0u; n < MOST_PARTS && u < last; n++) {
        let end = min(max(next_kink(t, u), u + 1e-6), last);
        let own = track_depth(t, u, end);
        // Where the published forms cancel they give anything.
        share += exp(-depth) * (end - u) * clamp(visible(t, u, end, own), 0.0, 1.0);
        depth += own;
        u = end;
    }
    return vec2<f32>(share, depth);
}

// Colour and alpha of a segment of a length in device units. Widgets are met one after the other, each as if it were alone.
fn analytic(front: vec2<f32>, back: vec2<f32>, length: f32) -> vec4<f32> {
    let count = arrayLength(&widgets);
    var result = vec4<f32>(0.0);
    var last = -1.0;
    var after = 0u;
    for (var n = 0u; n < count; n++) {
        // The next widget that the segment enters; of several that it enters at one place in their order.
        var next = 0u;
        var entry = 2.0;
        for (var i = 0u; i < count; i++) {
            let part = inside(i, front, back);
            if part.x < part.y && part.x < entry && (part.x > last || (part.x == last && i >= after)) {
                next = i;
                entry = part.x;
            }
        }
        if entry > 1.0 {
            break;
        }
        let met = alone(next, front, back, length);
        let left = 1.0 - result.w;
        let light = left * met.x * length * look.emission;
        result += vec4<f32>(light * widgets[next].color.rgb, left * opacity(met.y));
        last = entry;
        after = next + 1u;
    }
    return result;
}

// A segment with both scalars at its ends, of a length in device units.
fn classified(front: vec2<f32>, back: vec2<f32>, length: f32) -> Integrated {
    return Integrated(analytic(front, back, length), 1u);
}
