// Draws the cells of a batch, back to front: one or two triangles a cell that cover its silhouette with a margin; the
// fragment finds the segment of its own ray, and whether there is one.
import package::lib::mesh::{corners};
import package::lib::view::{view};
import package::lib::cell::{Cell, Reference, HIDDEN, cell_reference, cell_segment};
import package::lib::silhouette::{silhouette_corner};
import package::lib::transfer::{piece_at, integrate};

@group(1) @binding(1) var<storage, read> projected: array<Cell>;

struct Fragment {
    @builtin(position) position: vec4<f32>,
    @location(0) @interpolate(flat) plane_0: vec4<f32>,
    @location(1) @interpolate(flat) plane_1: vec4<f32>,
    @location(2) @interpolate(flat) plane_2: vec4<f32>,
    @location(3) @interpolate(flat) plane_3: vec4<f32>,
    @location(4) @interpolate(flat) gradient: vec4<f32>,
    @location(5) @interpolate(flat) origins: vec4<f32>,
    // w and scalar ranges.
    @location(6) @interpolate(flat) ranges: vec4<f32>,
    @location(7) @interpolate(flat) depth_scalar: vec2<f32>,
    // The pieces of the transfer function that the cell's scalars meet.
    @location(8) @interpolate(flat) pieces: vec2<u32>,
}

@vertex
fn cover(@builtin(vertex_index) index: u32) -> Fragment {
    let i = index / 6u;
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
    let k = array<u32, 6>(0u, 1u, 2u, 0u, 2u, 3u)[index % 6u];
    let at = silhouette_corner(cell, c.vertices, k);
    let reference = cell_reference(c.vertices, c.scalars, kind);
    fragment.position = vec4<f32>(at.x * 2.0 / view.size.x, -at.y * 2.0 / view.size.y, 0.5, 1.0);
    fragment.plane_0 = cell.planes[0];
    fragment.plane_1 = cell.planes[1];
    fragment.plane_2 = cell.planes[2];
    fragment.plane_3 = cell.planes[3];
    fragment.gradient = cell.gradient;
    fragment.origins = reference.origins;
    fragment.ranges = vec4<f32>(reference.w, reference.s);
    fragment.depth_scalar = vec2<f32>(reference.depth, reference.scalar);
    fragment.pieces = vec2<u32>(piece_at(reference.s.x), piece_at(reference.s.y));
    return fragment;
}

@fragment
fn shade(fragment: Fragment) -> @location(0) vec4<f32> {
    let at = fragment.position.xy - view.size * 0.5;
    let planes = array<vec4<f32>, 4>(fragment.plane_0, fragment.plane_1, fragment.plane_2, fragment.plane_3);
    let reference = Reference(
        fragment.origins,
        fragment.depth_scalar.x,
        fragment.depth_scalar.y,
        fragment.ranges.xy,
        fragment.ranges.zw,
    );
    let segment = cell_segment(planes, fragment.gradient.xyz, reference, at);
    if !(segment.length > 0.0) {
        discard;
    }
    return integrate(fragment.pieces, segment.s_front, segment.s_back, segment.length);
}
