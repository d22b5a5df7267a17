// Light on segments whose luminance and extinction are linear between the nodes of a transfer function, to a proved error.
// Into how many parts pieces are cut, and what that bounds: the twins of the same names in Rust, tetlux-optics,
// lit_linear_f32.
import package::lib::integrated::{Integrated};
import package::lib::look::{look};
import package::lib::light::{normal, half_way, lit, silhouette_factor};
import package::axes::weights::{weights};

// No piece between two nodes is cut into more parts.
const MAX_PARTS = 256.0;

// A segment's light.
struct Illuminated {
    // Unit vectors to the eye and to the light, and half-way between.
    eye: vec3<f32>,
    toward: vec3<f32>,
    half: vec3<f32>,
    // Gradients at the front and at the back end.
    front: vec3<f32>,
    back: vec3<f32>,
    // In device units.
    length: f32,
}

fn illuminated(front: vec3<f32>, back: vec3<f32>, length: f32, eye: vec3<f32>) -> Illuminated {
    var toward = look.direction;
    if dot(toward, toward) == 0.0 {
        toward = eye;
    }
    return Illuminated(eye, toward, half_way(toward, eye), front, back, length);
}

// What light may err by, as a share of the segment's alpha: colour is exact, so that light has all that is allowed.
fn allowed() -> f32 {
    return look.errors.x + look.errors.y;
}

// Angle between two gradients; 0 if one of them is none.
fn turn(front: vec3<f32>, back: vec3<f32>) -> f32 {
    let f = normal(front);
    let b = normal(back);
    let across = cross(f, b);
    let size = sqrt(dot(across, across));
    // Undefined of two zeros.
    if size == 0.0 && dot(f, b) >= 0.0 {
        return 0.0;
    }
    return atan2(size, dot(f, b));
}

// The least number of parts for a stretch of the normal that is not even.
fn count_of(uneven: f32, angle: f32, slope: f32, curvature: f32, stretch: f32, mixed: f32) -> f32 {
    let turning = uneven * (uneven * curvature * angle + 2.0 * slope * stretch + 2.0 * mixed);
    return ceil(clamp(sqrt(0.125 * angle * turning / allowed()), 1.0, MAX_PARTS));
}

// How many parts keep the light of a piece to its error. `low` and `high` are the largest luminances at its two ends.
fn parts(segment: Illuminated, f: vec3<f32>, b: vec3<f32>, angle: f32, low: f32, high: f32) -> f32 {
    if angle <= 0.0 {
        return 1.0;
    }
    let diffuse = look.shares.y;
    let specular = look.shares.z;
    let bright = max(low, high);
    let p = max(look.shares.w, 2.0);
    var slope = bright * diffuse + specular * sqrt(p * 0.36787944);
    var curvature = bright * diffuse + specular * p;
    var mixed = abs(high - low) * diffuse;
    let k = look.silhouette;
    var least = 1.0;
    if k > 0.0 {
        // What is seen of the luminance varies with the silhouette, too.
        slope += 0.5 * bright * k;
        curvature += 0.5 * bright * k * (k + 1.0);
        // The light's centre of a part, by its ends, is off by a twelfth of it.
        mixed += slope / 3.0 + 0.5 * abs(high - low);
        let facing = max(1.0 - abs(dot(normal(f), segment.eye)), 1.0 - abs(dot(normal(b), segment.eye)));
        // No turn goes further from the eye's direction than that.
        let bend = min(0.5 * angle * angle / max(facing, 1e-12), 4.0);
        let depth = (0.01 + 0.16 * abs((k - 1.0) * (k - 1.5))) * bend * bend;
        least = ceil(clamp(sqrt(sqrt(depth / allowed())), 1.0, MAX_PARTS));
    }
    let across = cross(f, b);
    let area = sqrt(dot(across, across));
    let largest = sqrt(max(dot(f, f), dot(b, b)));
    let rise = b - f;
    let ratio = angle * largest / max(area, 1e-30);
    let stretch = min(ratio * sqrt(dot(rise, rise)), 1e6);
    let share = min(ratio * largest, 1e6);
    let first = count_of(1.0, angle, slope, curvature, stretch, mixed * share);
    return max(count_of(1.0 + stretch / first, angle, slope, curvature, stretch, mixed * share), least);
}

// Where a linear quantity with these ends is 0 strictly between them; 2 if nowhere.
fn zero_between(front: f32, back: f32) -> f32 {
    if front * back < 0.0 {
        return front / (front - back);
    }
    return 2.0;
}

// The piece from `begin` to `end` of a segment, with luminance and extinction per device unit at its ends, added behind what
// is there.
fn add(
    segment: Illuminated,
    begin: f32,
    end: f32,
    front: vec4<f32>,
    back: vec4<f32>,
    before: Integrated,
) -> Integrated {
    if front.w <= 0.0 && back.w <= 0.0 {
        return before;
    }
    let f = segment.front + (segment.back - segment.front) * begin;
    let b = segment.front + (segment.back - segment.front) * end;
    // The kinks of the light, and the piece's end.
    var cuts = vec4<f32>(2.0, 2.0, 2.0, 1.0);
    if look.shares.y > 0.0 {
        cuts.x = zero_between(dot(f, segment.toward), dot(b, segment.toward));
    }
    if look.shares.z > 0.0 && look.shares.w < 2.0 {
        cuts.y = zero_between(dot(f, segment.half), dot(b, segment.half));
    }
    if look.silhouette > 0.0 {
        cuts.z = zero_between(dot(f, segment.eye), dot(b, segment.eye));
    }
    var result = before;
    var near = 0.0;
    for (var n = 0u; n < 4u && near < 1.0; n++) {
        let ahead = select(vec4<f32>(1.0), cuts, cuts > vec4<f32>(near));
        let far = min(min(min(ahead.x, ahead.y), min(ahead.z, ahead.w)), 1.0);
        if far > near {
            let places = begin + (end - begin) * vec2<f32>(near, far);
            let rise = back - front;
            result = smooth_part(segment, places, front + rise * near, front + rise * far, result);
        }
        near = far;
    }
    return result;
}

// Lit luminance and, in w, extinction at a point between the ends of a part.
fn lit_point(segment: Illuminated, n: vec3<f32>, c: vec4<f32>) -> vec4<f32> {
    return vec4<f32>(lit(c.rgb, n, segment.toward, segment.half), c.w * silhouette_factor(n, segment.eye));
}

// A part without kinks between two places, added behind what is there.
fn smooth_part(
    segment: Illuminated,
    places: vec2<f32>,
    front: vec4<f32>,
    back: vec4<f32>,
    before: Integrated,
) -> Integrated {
    let g_front = segment.front + (segment.back - segment.front) * places.x;
    let g_back = segment.front + (segment.back - segment.front) * places.y;
    let g_rise = g_back - g_front;
    let rise = back - front;
    let angle = turn(g_front, g_back);
    let low = max(front.x, max(front.y, front.z));
    let high = max(back.x, max(back.y, back.z));
    let count = parts(segment, g_front, g_back, angle, low, high);
    let near = sqrt(dot(g_front, g_front));
    let far = sqrt(dot(g_back, g_back));
    var result = before;
    var begin = 0.0;
    var f = lit_point(segment, normal(g_front), front);
    for (var k = 1.0; k <= count; k += 1.0) {
        // Where the normal has turned by k / count of the angle.
        var end = 1.0;
        if k < count {
            let turned = angle * (k / count);
            let ahead = near * sin(turned);
            let behind = far * sin(angle - turned);
            end = clamp(ahead / max(ahead + behind, 1e-30), begin, 1.0);
        }
        let b = lit_point(segment, normal(g_front + g_rise * end), front + rise * end);
        let part = (end - begin) * (places.y - places.x) * segment.length;
        var tau = vec2<f32>(f.w, b.w);
        if look.silhouette > 0.0 {
            // The depth by Simpson's rule; how it is shared by the ends.
            let middle = 0.5 * (begin + end);
            let ends = 0.5 * (f.w + b.w);
            let between = lit_point(segment, normal(g_front + g_rise * middle), front + rise * middle).w;
            let mean = (ends + 2.0 * between) / 3.0;
            tau = select(vec2<f32>(mean), tau * (mean / max(ends, 1e-20)), ends > 1e-20);
        }
        let w = weights(tau.y * part, tau.x * part);
        let seen = 1.0 - result.color.w;
        result.color += vec4<f32>(seen * (f.rgb * w.z + b.rgb * w.y), seen * w.x);
        result.pieces += 1u;
        begin = end;
        f = b;
    }
    return result;
}
