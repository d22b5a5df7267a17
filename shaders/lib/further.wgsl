// A field in a cell, as lib::cell has the first scalar.
import package::lib::cell::{Leaning, Reference, rise_of, rounded_by};

struct Field {
    // Its rise and, in w, the value at the rounded pixel of the reference vertex.
    rise: vec4<f32>,
    // Least and greatest value.
    range: vec2<f32>,
}

// The field of these values at a cell's vertices.
fn field_in(seen: Leaning, reference: Reference, values: vec4<f32>) -> Field {
    let own = values[reference.index];
    var field: Field;
    let rise = rise_of(seen, values - own);
    field.rise = vec4<f32>(rise, own - rounded_by(reference, rise.xy));
    field.range = vec2<f32>(
        min(min(values.x, values.y), min(values.z, values.w)),
        max(max(values.x, values.y), max(values.z, values.w)),
    );
    return field;
}

// The value on the ray at a place in pixels from the reference vertex, as rounded, where w exceeds that of the cell's lean, if
// it has one, by `beyond`; `share` is 1 / (1 + w), in orthographic views 1.
fn field_at(field: Field, place: vec2<f32>, beyond: f32, share: f32) -> f32 {
    let value = field.rise.w + (dot(field.rise.xy, place) - field.rise.z * beyond) * share;
    return clamp(value, field.range.x, field.range.y);
}
