// Each fragment finds its own segment from the planes of the cell's faces: nothing is interpolated, so nothing depends
// on how a rasteriser rounds vertices. One or two triangles cover the cell's silhouette with a margin.
import package::lib::view::{view};
import package::lib::mesh::{corners, entry_of};
import package::lib::cell::{Cell, Reference, HIDDEN, cell_reference};
import package::lib::silhouette::{silhouette_corner};
import package::lib::span::{Segment};
import package::lib::ray::{cell_segment};
import package::axes::quantity::{RayFragment, linear_in, linear_of, with_linear};
import package::axes::shading::{pieces_between};

@group(1) @binding(1) var<storage, read> projected: array<Cell>;

alias Fragment = RayFragment;

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
    fragment.origins = reference.origins;
    fragment.range_depth = vec3<f32>(reference.w, reference.depth);
    let entry = entry_of(i);
    fragment.pieces_entry = vec3<u32>(pieces_between(reference.s.x, reference.s.y, entry), entry);
    return with_linear(fragment, linear);
}

fn segment_in(fragment: Fragment) -> Segment {
    let at = fragment.position.xy - view.size * 0.5;
    let planes = array<vec4<f32>, 4>(fragment.plane_0, fragment.plane_1, fragment.plane_2, fragment.plane_3);
    var reference: Reference;
    reference.origins = fragment.origins;
    reference.w = fragment.range_depth.xy;
    reference.depth = fragment.range_depth.z;
    return cell_segment(planes, linear_of(fragment), reference, at);
}
