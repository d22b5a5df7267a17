// What is linear in a cell: luminance and, in w, extinction, classified at its vertices. Whatever the transfer function
// does between the vertices' scalars is lost: the artifact that classification after interpolation avoids.
import package::lib::cell::{Cell, Corners, Reference, STEEPEST, leaning, rounded_by};
import package::axes::data::{has_own, own_scalar, scalar_of};
import package::axes::attributes::{attributes_of};

alias Quantity = vec4<f32>;

// The rise (lib::cell, Leaning), and the value at the rounded pixel of the reference vertex.
alias Linear = array<vec4<f32>, 4>;

fn quantity_of(scalar: f32, name: u32) -> Quantity {
    return attributes_of(scalar, name);
}

// At one of a cell's vertices.
fn quantity_at(cell: u32, name: u32) -> Quantity {
    return quantity_of(scalar_of(cell, name), name);
}

// What a value carried over from the cell before is in this one.
fn in_cell(value: Quantity, cell: u32) -> Quantity {
    if has_own(cell) {
        return quantity_of(own_scalar(cell), 0u);
    }
    return value;
}

// As it is stored, and back.
fn packed(value: Quantity) -> vec4<f32> {
    return value;
}

fn unpacked(stored: vec4<f32>) -> Quantity {
    return stored;
}

fn linear_in(cell: Cell, reference: Reference, corners: Corners) -> Linear {
    let s = corners.scalars;
    let names = corners.names;
    let c = array<vec4<f32>, 4>(
        quantity_of(s.x, names.x),
        quantity_of(s.y, names.y),
        quantity_of(s.z, names.z),
        quantity_of(s.w, names.w),
    );
    let seen = leaning(corners.vertices, cell.rise.w, corners.parity);
    var linear: Linear;
    linear[3] = c[reference.index];
    for (var i = 0u; i < 3u; i++) {
        var rise = vec4<f32>(0.0);
        for (var k = 0u; k < 4u; k++) {
            rise += (c[k] - linear[3]) * seen.rises[k][i];
        }
        linear[i] = clamp(rise, vec4<f32>(-STEEPEST), vec4<f32>(STEEPEST));
    }
    for (var k = 0u; k < 4u; k++) {
        linear[3][k] -= rounded_by(reference, vec2<f32>(linear[0][k], linear[1][k]));
    }
    return linear;
}

// The value on the ray at a place in pixels from the reference vertex, as rounded, where w exceeds that of the cell's lean, if
// it has one, by `beyond`; `share` is 1 / (1 + w), in orthographic views 1. Rounding must not make it negative.
fn linear_at(linear: Linear, place: vec2<f32>, beyond: f32, share: f32) -> Quantity {
    let rise = linear[0] * place.x + linear[1] * place.y - linear[2] * beyond;
    return max(linear[3] + rise * share, vec4<f32>(0.0));
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
    @location(7) @interpolate(flat) linear_0: vec4<f32>,
    @location(8) @interpolate(flat) linear_1: vec4<f32>,
    @location(9) @interpolate(flat) linear_2: vec4<f32>,
    @location(10) @interpolate(flat) linear_3: vec4<f32>,
}

fn with_linear(fragment: RayFragment, linear: Linear) -> RayFragment {
    var result = fragment;
    result.linear_0 = linear[0];
    result.linear_1 = linear[1];
    result.linear_2 = linear[2];
    result.linear_3 = linear[3];
    return result;
}

fn linear_of(fragment: RayFragment) -> Linear {
    return Linear(fragment.linear_0, fragment.linear_1, fragment.linear_2, fragment.linear_3);
}
