// What is linear in a cell: the scalar. It is classified after it has been interpolated.
import package::lib::cell::{Cell, Corners, Reference, rounded_by};
import package::axes::data::{has_own, own_scalar, scalar_of};

alias Quantity = f32;

// The rise (lib::cell, Leaning) and, in w, the value at its rounded pixel; the least and the greatest value. The rest is
// unused.
alias Linear = array<vec4<f32>, 4>;

fn quantity_of(scalar: f32, name: u32) -> Quantity {
    return scalar;
}

// At one of a cell's vertices.
fn quantity_at(cell: u32, name: u32) -> Quantity {
    return scalar_of(cell, name);
}

// What a value carried over from the cell before is in this one.
fn in_cell(value: Quantity, cell: u32) -> Quantity {
    if has_own(cell) {
        return own_scalar(cell);
    }
    return value;
}

// As it is stored, and back.
fn packed(value: Quantity) -> vec4<f32> {
    return vec4<f32>(value, 0.0, 0.0, 0.0);
}

fn unpacked(stored: vec4<f32>) -> Quantity {
    return stored.x;
}

fn linear_in(cell: Cell, reference: Reference, c: Corners) -> Linear {
    return Linear(
        vec4<f32>(cell.rise.xyz, reference.scalar - rounded_by(reference, cell.rise.xy)),
        vec4<f32>(reference.s, 0.0, 0.0),
        vec4<f32>(0.0),
        vec4<f32>(0.0),
    );
}

// The value on the ray at a place in pixels from the reference vertex, as rounded, where w exceeds that of the cell's lean, if
// it has one, by `beyond`; `share` is 1 / (1 + w), in orthographic views 1.
fn linear_at(linear: Linear, place: vec2<f32>, beyond: f32, share: f32) -> Quantity {
    let value = linear[0].w + (dot(linear[0].xy, place) - linear[0].z * beyond) * share;
    return clamp(value, linear[1].x, linear[1].y);
}

// What lib::flat hands to fragments: no more than this quantity needs, for every value costs time.
struct RayFragment {
    @builtin(position) position: vec4<f32>,
    @location(0) @interpolate(flat) plane_0: vec4<f32>,
    @location(1) @interpolate(flat) plane_1: vec4<f32>,
    @location(2) @interpolate(flat) plane_2: vec4<f32>,
    @location(3) @interpolate(flat) plane_3: vec4<f32>,
    @location(4) @interpolate(flat) origins: vec4<f32>,
    // Range of w, and the depth of the reference vertex from the pivot.
    @location(5) @interpolate(flat) range_level: vec3<f32>,
    // The pieces of the transfer function that the cell's scalars meet, the cell's place in the order, and the face that
    // is drawn, if it is one.
    @location(6) @interpolate(flat) pieces_entry: vec4<u32>,
    @location(7) @interpolate(flat) rise_value: vec4<f32>,
    @location(8) @interpolate(flat) range: vec2<f32>,
}

fn with_linear(fragment: RayFragment, linear: Linear) -> RayFragment {
    var result = fragment;
    result.rise_value = linear[0];
    result.range = linear[1].xy;
    return result;
}

fn linear_of(fragment: RayFragment) -> Linear {
    let none = vec4<f32>(0.0);
    return Linear(fragment.rise_value, vec4<f32>(fragment.range, 0.0, 0.0), none, none);
}
