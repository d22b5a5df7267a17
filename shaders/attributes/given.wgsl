// A vertex has the luminance and, in w, the extinction per device unit that the host gives it: any classification.
@group(0) @binding(7) var<storage, read> attributes: array<vec4<f32>>;

fn attributes_of(scalar: f32, name: u32) -> vec4<f32> {
    return attributes[name];
}
