// Up to four triangles a cell around its thick vertex; the segment's ends are interpolated over them. Outer vertices are
// pulled from the mesh, so that cells which share one draw it at the same place.
import package::lib::view::{view};
import package::lib::mesh::{corners, entry_of};
import package::lib::cell::{Cell, HIDDEN, cell_reference};
import package::lib::silhouette::{silhouette_corner};
import package::lib::span::{Segment};
import package::lib::ray::{cell_segment};
import package::lib::thick::{THICK, front_of, back_of, ends_of};
import package::axes::quantity::{Quantity, quantity_of, unpacked, linear_in};
import package::axes::interpolation::{carried, carried_ends, segment_between, depths_between};
import package::axes::shading::{pieces_between};
import package::axes::source::{projected_cell};
import package::axes::surface::{cut};

struct Fragment {
    @builtin(position) position: vec4<f32>,
    @location(0) @interpolate(linear) front: Quantity,
    @location(1) @interpolate(linear) back: Quantity,
    @location(2) @interpolate(linear) ends: vec2<f32>,
    // The pieces of the transfer function that the cell's scalars meet, and the cell's place in the order.
    @location(3) @interpolate(flat) pieces_entry: vec3<u32>,
    // 1 + the cell's place in the batch if it is not decomposed.
    @location(4) @interpolate(flat) whole: u32,
}

fn at_pixel(at: vec2<f32>) -> vec4<f32> {
    return vec4<f32>(at.x * 2.0 / view.size.x, -at.y * 2.0 / view.size.y, 0.5, 1.0);
}

fn place(vertex_index: u32, instance_index: u32) -> Fragment {
    let i = instance_index + vertex_index / 12u;
    let cell = projected_cell(i);
    let entry = entry_of(i);
    var fragment: Fragment;
    // Outside the clip volume: nothing is drawn.
    fragment.position = vec4<f32>(2.0, 2.0, 2.0, 1.0);
    let kind = cell.gradient.w;
    if kind == HIDDEN {
        return fragment;
    }
    let c = corners(i);
    if kind != THICK {
        if vertex_index % 12u < 6u {
            let k = array<u32, 6>(0u, 1u, 2u, 0u, 2u, 3u)[vertex_index % 6u];
            let s = cell_reference(c.vertices, c.scalars, kind).s;
            fragment.position = at_pixel(silhouette_corner(cell, c.vertices, k));
            fragment.pieces_entry = vec3<u32>(pieces_between(s.x, s.y, entry), entry);
            fragment.whole = i + 1u;
        }
        return fragment;
    }
    let triangle = vertex_index % 12u / 3u;
    let corner = vertex_index % 3u;
    let count = u32(cell.planes[3].y);
    if triangle >= count {
        return fragment;
    }
    var at = cell.planes[0].xy;
    var ends = cell.planes[0].zw;
    var front = unpacked(cell.planes[1]);
    var back = unpacked(cell.planes[2]);
    if corner > 0u {
        let k = u32(cell.planes[3].x) >> (2u * ((triangle + corner - 1u) % count)) & 3u;
        let v = c.vertices[k];
        at = v.pixel;
        ends = ends_of(v);
        front = quantity_of(c.scalars[k], c.names[k]);
        back = front;
    }
    fragment.position = at_pixel(at);
    fragment.front = carried(front, front_of(ends));
    fragment.back = carried(back, back_of(ends));
    fragment.ends = carried_ends(ends, at);
    fragment.pieces_entry = vec3<u32>(vec2<u32>(cell.planes[3].zw), entry);
    return fragment;
}

fn segment_in(fragment: Fragment) -> Segment {
    let at = fragment.position.xy - view.size * 0.5;
    if fragment.whole > 0u {
        let i = fragment.whole - 1u;
        let cell = projected_cell(i);
        let c = corners(i);
        let reference = cell_reference(c.vertices, c.scalars, cell.gradient.w);
        return cell_segment(cell.planes, linear_in(cell, reference, c), reference, at);
    }
    let segment = segment_between(fragment.front, fragment.back, fragment.ends, at);
    return cut(segment, depths_between(fragment.ends, at), at);
}
