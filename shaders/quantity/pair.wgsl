// What is linear in a cell: two scalars. They are classified after they have been interpolated.
import package::lib::cell::{Cell, Reference, Corners, leaning, rounded_by};
import package::lib::further::{Field, field_in, field_at};
import package::axes::data::{has_own, own_scalar, scalar_of};
import package::axes::second::{SECOND_CELLWISE, seconds_of, second_of};

alias Quantity = vec2<f32>;

struct Linear {
    scalar: Field,
    second: Field,
}

// At one of a cell's vertices.
fn quantity_at(cell: u32, name: u32) -> Quantity {
    return vec2<f32>(scalar_of(cell, name), second_of(cell, name));
}

// What a value carried over from the cell before is in this one.
fn in_cell(value: Quantity, cell: u32) -> Quantity {
    var result = value;
    if has_own(cell) {
        result.x = own_scalar(cell);
    }
    if SECOND_CELLWISE {
        result.y = second_of(cell, 0u);
    }
    return result;
}

fn linear_in(cell: Cell, reference: Reference, c: Corners) -> Linear {
    let seen = leaning(c.vertices, cell.rise.w, c.parity);
    let scalar = Field(vec4<f32>(cell.rise.xyz, reference.scalar - rounded_by(reference, cell.rise.xy)), reference.s);
    return Linear(scalar, field_in(seen, reference, seconds_of(c.cell, c.names)));
}

fn linear_at(linear: Linear, place: vec2<f32>, beyond: f32, share: f32) -> Quantity {
    return vec2<f32>(field_at(linear.scalar, place, beyond, share), field_at(linear.second, place, beyond, share));
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
    @location(9) @interpolate(flat) ranges: vec4<f32>,
}

fn with_linear(fragment: RayFragment, linear: Linear) -> RayFragment {
    var result = fragment;
    result.scalar = linear.scalar.rise;
    result.second = linear.second.rise;
    result.ranges = vec4<f32>(linear.scalar.range, linear.second.range);
    return result;
}

fn linear_of(fragment: RayFragment) -> Linear {
    return Linear(Field(fragment.scalar, fragment.ranges.xy), Field(fragment.second, fragment.ranges.zw));
}
