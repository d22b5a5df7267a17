// A table of three axes. The twin in Rust is tetlux-tables, Table::interpolate.
import package::lib::lookup::{lookup, position_on};

@group(2) @binding(2) var volume: texture_3d<f32>;

fn volume_texel(i: u32, j: u32, k: u32) -> vec4<f32> {
    return lookup.low[1] + lookup.range[1] * textureLoad(volume, vec3<u32>(i, j, k), 0);
}

fn volume_row(i: u32, share: f32, j: u32, k: u32) -> vec4<f32> {
    return mix(volume_texel(i, j, k), volume_texel(i + 1u, j, k), share);
}

// Trilinear interpolation at coordinates in [0, 1].
fn interpolate_volume(coordinates: vec3<f32>) -> vec4<f32> {
    let nodes = textureDimensions(volume);
    let x = position_on(coordinates.x, nodes.x);
    let y = position_on(coordinates.y, nodes.y);
    let z = position_on(coordinates.z, nodes.z);
    let near = mix(volume_row(x.low, x.share, y.low, z.low), volume_row(x.low, x.share, y.low + 1u, z.low), y.share);
    let k = z.low + 1u;
    let far = mix(volume_row(x.low, x.share, y.low, k), volume_row(x.low, x.share, y.low + 1u, k), y.share);
    return mix(near, far, z.share);
}

fn volume_slices() -> u32 {
    return textureDimensions(volume).z;
}
