// Image functions over two normalised scalars, bilinear between texels. A segment is cut at the lines of the grid of texels
// and between them into pieces. How many, and what that bounds: the twins of the same names in Rust, tetlux-optics,
// image_f32.
import package::lib::segment::{opacity};
import package::lib::integrated::{Integrated};
import package::lib::look::{look};

// No segment is cut into more pieces than about this.
const MAX_PIECES = 1024u;

// Luminance and, in w, extinction per device unit; row by row, the lowest second scalar first.
@group(0) @binding(12) var<storage, read> texels: array<vec4<f32>>;

// The four texels of the cell of the grid that holds a place: (0, 0), (1, 0), (0, 1), (1, 1).
fn texels_around(cell: vec2<u32>) -> array<vec4<f32>, 4> {
    let next = min(cell + 1u, look.size - 1u);
    let row = look.size.x;
    return array<vec4<f32>, 4>(
        texels[cell.y * row + cell.x],
        texels[cell.y * row + next.x],
        texels[next.y * row + cell.x],
        texels[next.y * row + next.x],
    );
}

// Bilinear in a cell; the place is clamped to it.
fn bilinear(c: array<vec4<f32>, 4>, place: vec2<f32>) -> vec4<f32> {
    let share = clamp(place, vec2<f32>(0.0), vec2<f32>(1.0));
    let low = c[0] + (c[1] - c[0]) * share.x;
    let high = c[2] + (c[3] - c[2]) * share.x;
    return low + (high - low) * share.y;
}

// The cell of the grid that holds a place, of the two at a line the one ahead.
fn cell_of(place: f32, last: u32) -> u32 {
    return min(u32(clamp(floor(place), 0.0, 1e9)), max(last, 1u) - 1u);
}

// The next u beyond `u` at which a place that runs from `start` by `step` crosses a line of the grid; 2 if none.
fn next_line(start: f32, step: f32, u: f32, last: u32) -> f32 {
    if abs(step) < 1e-6 {
        return 2.0;
    }
    let place = start + step * (u + 1e-5);
    // Outside the function is constant.
    let line = select(min(ceil(place) - 1.0, f32(last)), max(floor(place) + 1.0, 0.0), step > 0.0);
    if line < 0.0 || line > f32(last) {
        return 2.0;
    }
    return (line - start) / step;
}

// Largest difference of a luminance between two texels.
fn difference(a: vec4<f32>, b: vec4<f32>) -> f32 {
    let apart = abs(a.rgb - b.rgb);
    return max(apart.x, max(apart.y, apart.z));
}

// Premultiplied colour and alpha of a segment with normalised scalars `front` and `back`, of a length in device units: the
// error of every channel at most `bound` times the segment's alpha (and what f32 cannot hold, some 1e-5).
fn integrate_counted(front: vec2<f32>, back: vec2<f32>, length: f32, bound: f32) -> Integrated {
    let start = front * look.scale + look.origin;
    let step = (back - front) * look.scale;
    let last = look.size - 1u;
    var result: Integrated;
    var u = 0.0;
    while u < 1.0 && result.pieces < MAX_PIECES {
        let line = min(next_line(start.x, step.x, u, last.x), next_line(start.y, step.y, u, last.y));
        let end = min(max(line, u + 1e-6), 1.0);
        // By the middle: an end may lie on a line.
        let middle = start + step * (0.5 * (u + end));
        let cell = vec2<u32>(cell_of(middle.x, last.x), cell_of(middle.y, last.y));
        let c = texels_around(cell);
        let thickest = max(max(c[0].w, c[1].w), max(c[2].w, c[3].w));
        if thickest > 0.0 {
            let width = end - u;
            let across = max(difference(c[0], c[1]), difference(c[2], c[3])) * abs(step.x);
            let along = max(difference(c[0], c[2]), difference(c[1], c[3])) * abs(step.y);
            let product = thickest * width * length * (across + along) * width;
            let count = ceil(clamp(sqrt(0.25 * product / bound), 1.0, 256.0));
            let place = start - vec2<f32>(cell);
            for (var k = 0.0; k < count; k += 1.0) {
                result.color = piece(c, place, step, u + width * (k / count), width / count, length, result.color);
                result.pieces += 1u;
            }
        }
        u = end;
    }
    return result;
}

// Composites the piece from u0 on behind what is there.
fn piece(
    c: array<vec4<f32>, 4>,
    start: vec2<f32>,
    step: vec2<f32>,
    u0: f32,
    width: f32,
    length: f32,
    before: vec4<f32>,
) -> vec4<f32> {
    // Three nodes of Gauss and Legendre.
    let first = bilinear(c, start + step * (u0 + width * 0.11270167));
    let second = bilinear(c, start + step * (u0 + width * 0.5));
    let third = bilinear(c, start + step * (u0 + width * 0.8872983));
    let tau = vec3<f32>(first.w, second.w, third.w) * vec3<f32>(5.0 / 18.0, 8.0 / 18.0, 5.0 / 18.0) * (width * length);
    let depth = tau.x + tau.y + tau.z;
    if !(depth > 1e-30) {
        return before;
    }
    let emission = tau.x * first.rgb + tau.y * second.rgb + tau.z * third.rgb;
    let seen = (1.0 - before.w) * opacity(depth);
    return before + vec4<f32>(seen * (emission / depth), seen);
}
