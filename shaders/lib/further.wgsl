// A field in a cell, as lib::cell has the first scalar.
import package::lib::view::{rotated};
import package::lib::cell::{Corners, Reference, STEEPEST, rounded_by};

struct Field {
    // Gradient in eye space and, in w, the value at the reference vertex's depth and rounded pixel.
    rise: vec4<f32>,
    // Least and greatest value.
    range: vec2<f32>,
}

// The field of these values at the corners.
fn field_in(reference: Reference, c: Corners, values: vec4<f32>) -> Field {
    let v = c.vertices;
    let e1 = v[1].position - v[0].position;
    let e2 = v[2].position - v[0].position;
    let e3 = v[3].position - v[0].position;
    let volume = dot(e1, cross(e2, e3));
    let inverse = select(-1.0, 1.0, volume >= 0.0) / max(abs(volume), 1e-30);
    let d = values.yzw - values.x;
    let gradient = rotated((d.x * cross(e2, e3) + d.y * cross(e3, e1) + d.z * cross(e1, e2)) * inverse);
    let rise = clamp(gradient, vec3<f32>(-STEEPEST), vec3<f32>(STEEPEST));
    var field: Field;
    field.rise = vec4<f32>(rise, values[reference.index] - rounded_by(reference, rise.xy));
    field.range = vec2<f32>(
        min(min(values.x, values.y), min(values.z, values.w)),
        max(max(values.x, values.y), max(values.z, values.w)),
    );
    return field;
}

// The value where the ray of that direction lies `scaled` depths before the reference vertex, which it passes at a
// distance of `across` depths.
fn field_at(field: Field, depth: f32, across: vec2<f32>, direction: vec3<f32>, scaled: f32) -> f32 {
    let value = field.rise.w + depth * (dot(field.rise.xy, across) - scaled * dot(field.rise.xyz, direction));
    return clamp(value, field.range.x, field.range.y);
}
