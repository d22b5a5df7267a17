// What all lookups in tables of integrals share. Tables are read texel by texel and interpolated here in single
// precision: fixed-function filters may keep 8 bits of the weights.

struct Lookup {
    // A channel's value is low + range * texel: that of the table of two axes, and of the table of three.
    low: array<vec4<f32>, 2>,
    range: array<vec4<f32>, 2>,
    // In x the factor from a length in device units to the tables'.
    length: vec4<f32>,
}

@group(2) @binding(0) var<uniform> lookup: Lookup;

// The nearest value in [0, 1]; 0 for NaN.
fn unit(g: f32) -> f32 {
    if g > 0.0 {
        return min(g, 1.0);
    }
    return 0.0;
}

// Index of the node at or below coordinate g in [0, 1] of an axis of `nodes` nodes, and the share of the next.
struct Position {
    low: u32,
    share: f32,
}

fn position_on(g: f32, nodes: u32) -> Position {
    let last = nodes - 1u;
    let position = unit(g) * f32(last);
    let low = min(u32(position), last - 1u);
    return Position(low, position - f32(low));
}
