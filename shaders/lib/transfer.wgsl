// A 1D transfer function: piecewise linear luminance and extinction over the scalar.
//
// The twin in Rust is tetlux-optics, transfer_f32.

// An interval of the scalar on which luminance and extinction are linear.
struct Piece {
    // Luminance and, in w, extinction per device unit at the lower end.
    low: vec4<f32>,
    // The same at the upper end.
    high: vec4<f32>,
    // Lower end, upper end, 1 / width, width: of more digits than the ends, which may be one number. Both 0 if the piece is
    // unbounded.
    s: vec4<f32>,
}

// Ascending, from minus to plus "infinity" (1e30), without gaps; the first and the last are constant.
@group(0) @binding(1) var<storage, read> pieces: array<Piece>;

// The last piece that begins at or below s.
fn piece_at(s: f32) -> u32 {
    return piece_among(vec2<u32>(0u, arrayLength(&pieces) - 1u), s);
}

// The same, known to be among the pieces from range.x to range.y.
fn piece_among(range: vec2<u32>, s: f32) -> u32 {
    var low = range.x;
    var high = range.y + 1u;
    while high - low > 1u {
        let middle = (low + high) / 2u;
        if pieces[middle].s.x <= s {
            low = middle;
        } else {
            high = middle;
        }
    }
    return low;
}

fn classify(k: u32, s: f32) -> vec4<f32> {
    let t = clamp((s - pieces[k].s.x) * pieces[k].s.z, 0.0, 1.0);
    return pieces[k].low + (pieces[k].high - pieces[k].low) * t;
}
