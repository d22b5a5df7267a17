// What is linear in a cell: one scalar or two, and the gradient that is the normal of light. In space, not in the picture:
// normals are right in perspective.
import package::lib::cell::{Cell, Reference, Corners, leaning, rounded_by};
import package::lib::further::{Field, field_in, field_at};
import package::lib::gradients::{gradients};
import package::axes::data::{has_own, own_scalar, scalar_of};
import package::axes::second::{SECOND_CELLWISE, seconds_of, second_of};

// The two scalars; the gradient. The rest is unused.
alias Quantity = mat2x4<f32>;

struct Linear {
    scalar: Field,
    second: Field,
    gradient: array<Field, 3>,
}

// At one of a cell's vertices.
fn quantity_at(cell: u32, name: u32) -> Quantity {
    return Quantity(vec4<f32>(scalar_of(cell, name), second_of(cell, name), 0.0, 0.0), gradients[name]);
}

// What a value carried over from the cell before is in this one.
fn in_cell(value: Quantity, cell: u32) -> Quantity {
    var result = value;
    if has_own(cell) {
        result[0].x = own_scalar(cell);
    }
    if SECOND_CELLWISE {
        result[0].y = second_of(cell, 0u);
    }
    return result;
}

fn linear_in(cell: Cell, reference: Reference, c: Corners) -> Linear {
    let g = transpose(mat4x4<f32>(
        gradients[c.names.x],
        gradients[c.names.y],
        gradients[c.names.z],
        gradients[c.names.w],
    ));
    let seen = leaning(c.vertices, cell.rise.w, c.parity);
    var linear: Linear;
    linear.scalar = Field(vec4<f32>(cell.rise.xyz, reference.scalar - rounded_by(reference, cell.rise.xy)), reference.s);
    linear.second = field_in(seen, reference, seconds_of(c.cell, c.names));
    for (var i = 0u; i < 3u; i++) {
        linear.gradient[i] = field_in(seen, reference, g[i]);
    }
    return linear;
}

fn linear_at(linear: Linear, place: vec2<f32>, beyond: f32, share: f32) -> Quantity {
    let x = field_at(linear.gradient[0], place, beyond, share);
    let y = field_at(linear.gradient[1], place, beyond, share);
    let z = field_at(linear.gradient[2], place, beyond, share);
    let scalar = field_at(linear.scalar, place, beyond, share);
    let second = field_at(linear.second, place, beyond, share);
    return Quantity(vec4<f32>(scalar, second, 0.0, 0.0), vec4<f32>(x, y, z, 0.0));
}

// What lib::flat hands to fragments: no more than this quantity needs, for every value costs time.
struct RayFragment {
    @builtin(position) position: vec4<f32>,
    @location(0) @interpolate(flat) plane_0: vec4<f32>,
    @location(1) @interpolate(flat) plane_1: vec4<f32>,
    @location(2) @interpolate(flat) plane_2: vec4<f32>,
    @location(3) @interpolate(flat) plane_3: vec4<f32>,
    @location(4) @interpolate(flat) origins: vec4<f32>,
    // Range of w, and the reference vertex's depth from the pivot.
    @location(5) @interpolate(flat) range_level: vec3<f32>,
    // The pieces of the transfer function that the cell's scalars meet, the cell's place in the order, and the face that
    // is drawn, if it is one.
    @location(6) @interpolate(flat) pieces_entry: vec4<u32>,
    @location(7) @interpolate(flat) scalar: vec4<f32>,
    @location(8) @interpolate(flat) second: vec4<f32>,
    @location(9) @interpolate(flat) gradient_x: vec4<f32>,
    @location(10) @interpolate(flat) gradient_y: vec4<f32>,
    @location(11) @interpolate(flat) gradient_z: vec4<f32>,
    @location(12) @interpolate(flat) ranges: vec4<f32>,
    @location(13) @interpolate(flat) lowest: vec3<f32>,
    @location(14) @interpolate(flat) highest: vec3<f32>,
}

fn with_linear(fragment: RayFragment, linear: Linear) -> RayFragment {
    let g = linear.gradient;
    var result = fragment;
    result.scalar = linear.scalar.rise;
    result.second = linear.second.rise;
    result.gradient_x = g[0].rise;
    result.gradient_y = g[1].rise;
    result.gradient_z = g[2].rise;
    result.ranges = vec4<f32>(linear.scalar.range, linear.second.range);
    result.lowest = vec3<f32>(g[0].range.x, g[1].range.x, g[2].range.x);
    result.highest = vec3<f32>(g[0].range.y, g[1].range.y, g[2].range.y);
    return result;
}

fn linear_of(fragment: RayFragment) -> Linear {
    let low = fragment.lowest;
    let high = fragment.highest;
    var linear: Linear;
    linear.scalar = Field(fragment.scalar, fragment.ranges.xy);
    linear.second = Field(fragment.second, fragment.ranges.zw);
    linear.gradient[0] = Field(fragment.gradient_x, vec2<f32>(low.x, high.x));
    linear.gradient[1] = Field(fragment.gradient_y, vec2<f32>(low.y, high.y));
    linear.gradient[2] = Field(fragment.gradient_z, vec2<f32>(low.z, high.z));
    return linear;
}
