// The mesh on the device.

// Position in device units relative to the mesh's origin; in w the scalar of point data, normalised to its range.
@group(0) @binding(2) var<storage, read> points: array<vec4<f32>>;
// Vertices in ascending order; the top bit of the first is set if that order is negatively oriented.
@group(0) @binding(3) var<storage, read> cells: array<vec4<u32>>;
