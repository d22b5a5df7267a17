import package::lib::no_data::{NO_DATA_FROM};

// A vertex has the luminance and, in w, the extinction per device unit that the host gives it: any classification. The last is that of cells
// without data.
@group(0) @binding(7) var<storage, read> attributes: array<vec4<f32>>;

fn attributes_of(scalar: f32, name: u32) -> vec4<f32> {
    if scalar >= NO_DATA_FROM {
        return attributes[arrayLength(&attributes) - 1u];
    }
    return attributes[name];
}
