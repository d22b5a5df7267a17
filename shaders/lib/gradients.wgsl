// The gradient at each point, in the axes of eye space, of any unit.
@group(0) @binding(9) var<storage, read> gradients: array<vec4<f32>>;
