// A table of two axes. The twin in Rust is tetlux-tables, Table::interpolate.
import package::lib::lookup::{lookup, position_on};

@group(2) @binding(1) var plane: texture_2d<f32>;

fn plane_texel(i: u32, j: u32) -> vec4<f32> {
    return lookup.low[0] + lookup.range[0] * textureLoad(plane, vec2<u32>(i, j), 0);
}

// Bilinear interpolation at coordinates in [0, 1].
fn interpolate_plane(coordinates: vec2<f32>) -> vec4<f32> {
    let nodes = textureDimensions(plane);
    let x = position_on(coordinates.x, nodes.x);
    let y = position_on(coordinates.y, nodes.y);
    let low = mix(plane_texel(x.low, y.low), plane_texel(x.low + 1u, y.low), x.share);
    let high = mix(plane_texel(x.low, y.low + 1u), plane_texel(x.low + 1u, y.low + 1u), x.share);
    return mix(low, high, y.share);
}
