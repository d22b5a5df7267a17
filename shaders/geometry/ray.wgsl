// Each fragment finds its own segment from the planes of the cell's faces: nothing is interpolated, so nothing depends
// on how a rasteriser rounds vertices. One or two triangles cover the cell's silhouette with a margin.
import package::lib::view::{view};
import package::lib::mesh::{corners, entry_of};
import package::lib::cell::{Cell, Reference, HIDDEN, cell_reference};
import package::lib::silhouette::{silhouette_corner};
import package::lib::span::{Segment};
import package::lib::ray::{cell_segment};
import package::axes::quantity::{Linear, linear_in};
import package::axes::shading::{pieces_between};

@group(1) @binding(1) var<storage, read> projected: array<Cell>;

struct Fragment {
    @builtin(position) position: vec4<f32>,
    @location(0) @interpolate(flat) plane_0: vec4<f32>,
    @location(1) @interpolate(flat) plane_1: vec4<f32>,
    @location(2) @interpolate(flat) plane_2: vec4<f32>,
    @location(3) @interpolate(flat) plane_3: vec4<f32>,
    @location(4) @interpolate(flat) linear_0: vec4<f32>,
    @location(5) @interpolate(flat) linear_1: vec4<f32>,
    @location(6) @interpolate(flat) linear_2: vec4<f32>,
    @location(7) @interpolate(flat) linear_3: vec4<f32>,
    @location(8) @interpolate(flat) origins: vec4<f32>,
    // Range of w, and the depth of the reference vertex.
    @location(9) @interpolate(flat) range_depth: vec3<f32>,
    // The pieces of the transfer function that the cell's scalars meet, and the cell's place in the order.
    @location(10) @interpolate(flat) pieces_entry: vec3<u32>,
}

fn place(vertex_index: u32, instance_index: u32) -> Fragment {
    let i = vertex_index / 6u;
    let cell = projected[i];
    var fragment: Fragment;
    let kind = cell.gradient.w;
    if kind == HIDDEN {
        // Outside the clip volume: nothing is drawn.
        fragment.position = vec4<f32>(2.0, 2.0, 2.0, 1.0);
        return fragment;
    }
    let c = corners(i);
    // Two triangles of a quadrilateral.
    let k = array<u32, 6>(0u, 1u, 2u, 0u, 2u, 3u)[vertex_index % 6u];
    let at = silhouette_corner(cell, c.vertices, k);
    let reference = cell_reference(c.vertices, c.scalars, kind);
    let linear = linear_in(cell, reference, c.vertices, c.scalars);
    fragment.position = vec4<f32>(at.x * 2.0 / view.size.x, -at.y * 2.0 / view.size.y, 0.5, 1.0);
    fragment.plane_0 = cell.planes[0];
    fragment.plane_1 = cell.planes[1];
    fragment.plane_2 = cell.planes[2];
    fragment.plane_3 = cell.planes[3];
    fragment.linear_0 = linear[0];
    fragment.linear_1 = linear[1];
    fragment.linear_2 = linear[2];
    fragment.linear_3 = linear[3];
    fragment.origins = reference.origins;
    fragment.range_depth = vec3<f32>(reference.w, reference.depth);
    let entry = entry_of(i);
    fragment.pieces_entry = vec3<u32>(pieces_between(reference.s.x, reference.s.y, entry), entry);
    return fragment;
}

fn segment_in(fragment: Fragment) -> Segment {
    let at = fragment.position.xy - view.size * 0.5;
    let planes = array<vec4<f32>, 4>(fragment.plane_0, fragment.plane_1, fragment.plane_2, fragment.plane_3);
    let linear = Linear(fragment.linear_0, fragment.linear_1, fragment.linear_2, fragment.linear_3);
    var reference: Reference;
    reference.origins = fragment.origins;
    reference.w = fragment.range_depth.xy;
    reference.depth = fragment.range_depth.z;
    return cell_segment(planes, linear, reference, at);
}
