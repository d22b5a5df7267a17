// What a fragment needs to find its own segment of a cell, the same at each of the cell's vertices: nothing is
// interpolated, so nothing depends on how a rasteriser rounds vertices.
import package::lib::view::{view};
import package::lib::mesh::{entry_of};
import package::lib::cell::{Cell, Corners, Reference, cell_reference};
import package::lib::span::{Segment};
import package::lib::ray::{cell_segment};
import package::axes::quantity::{RayFragment, linear_in, linear_of, with_linear};
import package::axes::shading::{pieces_between};

alias FlatFragment = RayFragment;

// A vertex outside the clip volume: nothing is drawn.
fn nowhere() -> FlatFragment {
    var fragment: FlatFragment;
    fragment.position = vec4<f32>(2.0, 2.0, 2.0, 1.0);
    return fragment;
}

// The vertex at a place in pixels from the picture's middle, for the i-th cell of the batch.
fn flat_fragment(at: vec2<f32>, i: u32, cell: Cell, c: Corners, face: u32) -> FlatFragment {
    let reference = cell_reference(c.vertices, c.scalars, cell.rise.w);
    let linear = linear_in(cell, reference, c);
    var fragment: FlatFragment;
    fragment.position = vec4<f32>(at.x * 2.0 / view.size.x, -at.y * 2.0 / view.size.y, 0.5, 1.0);
    fragment.plane_0 = cell.planes[0];
    fragment.plane_1 = cell.planes[1];
    fragment.plane_2 = cell.planes[2];
    fragment.plane_3 = cell.planes[3];
    fragment.origins = reference.origins;
    fragment.range_level = vec3<f32>(reference.w, reference.level);
    let entry = entry_of(i);
    fragment.pieces_entry = vec4<u32>(pieces_between(reference.s.x, reference.s.y, entry), entry, face);
    return with_linear(fragment, linear);
}

fn flat_planes(fragment: FlatFragment) -> array<vec4<f32>, 4> {
    return array<vec4<f32>, 4>(fragment.plane_0, fragment.plane_1, fragment.plane_2, fragment.plane_3);
}

fn flat_segment(fragment: FlatFragment) -> Segment {
    var reference: Reference;
    reference.origins = fragment.origins;
    reference.w = fragment.range_level.xy;
    reference.level = fragment.range_level.z;
    reference.depth = reference.level + view.forward.w;
    return cell_segment(flat_planes(fragment), linear_of(fragment), reference, fragment.position.xy - view.size * 0.5);
}
