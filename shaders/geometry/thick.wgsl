// Up to four triangles a cell around its thick vertex; the segment's ends are interpolated over them. Outer vertices are
// pulled from the mesh.
//
// Rasterisers round vertices: triangles are drawn a little too large, and fragments interpolate from the vertices' own places
// (lib::triangle). Where a pixel's centre lies beyond the triangle, in another of the cell or in none, the planes of the faces
// tell.
import package::lib::view::{view, pixels_between};
import package::lib::mesh::{corners, entry_of};
import package::lib::cell::{HIDDEN, cell_reference};
import package::lib::silhouette::{SLIGHT, silhouette_corner, moved_corner};
import package::lib::span::{Segment};
import package::lib::triangle::{shares_of};
import package::lib::whole::{whole_segment};
import package::lib::thick::{THICK, front_of, back_of, ends_of, thick_outline};
import package::axes::quantity::{Quantity, quantity_of, unpacked};
import package::axes::interpolation::{BY_PLANES, carried, carried_ends, segment_between, depths_between};
import package::axes::shading::{pieces_between};
import package::axes::source::{projected_cell};
import package::axes::surface::{cut};

// All is the same at the three vertices of a triangle.
struct Fragment {
    @builtin(position) position: vec4<f32>,
    // The pixel of vertex 0, as two summands: the origin of places.
    @location(0) @interpolate(flat) origin: vec4<f32>,
    // Place and ends of the thick vertex.
    @location(1) @interpolate(flat) thick: vec4<f32>,
    // Places of the outer vertices, and their ends.
    @location(2) @interpolate(flat) outer: vec4<f32>,
    @location(3) @interpolate(flat) outer_ends: vec4<f32>,
    // What is interpolated of the quantity: at the thick vertex's two ends, and at the outer vertices.
    @location(4) @interpolate(flat) front: Quantity,
    @location(5) @interpolate(flat) back: Quantity,
    @location(6) @interpolate(flat) first: Quantity,
    @location(7) @interpolate(flat) second: Quantity,
    // The pieces of the transfer function that the cell's scalars meet, and the cell's place in the order.
    @location(8) @interpolate(flat) pieces_entry: vec3<u32>,
    // The cell's place in the batch, and 1 if it is not decomposed.
    @location(9) @interpolate(flat) cell: vec2<u32>,
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
    let kind = cell.rise.w;
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
            fragment.cell = vec2<u32>(i, 1u);
        }
        return fragment;
    }
    let triangle = vertex_index % 12u / 3u;
    let corner = vertex_index % 3u;
    let o = thick_outline(u32(cell.planes[3].x), u32(cell.planes[3].y), c.vertices);
    if triangle >= o.count {
        return fragment;
    }
    let origin = c.vertices[0];
    let outer = vec2<u32>(triangle, (triangle + 1u) % o.count);
    let first = c.vertices[o.names[outer.x]];
    let second = c.vertices[o.names[outer.y]];
    let thick = cell.planes[0];
    fragment.origin = vec4<f32>(origin.pixel, origin.rest);
    fragment.outer = vec4<f32>(pixels_between(origin, first), pixels_between(origin, second));
    fragment.thick = vec4<f32>(thick.xy, carried_ends(thick.zw, origin.pixel + thick.xy));
    fragment.outer_ends = vec4<f32>(
        carried_ends(ends_of(first), first.pixel),
        carried_ends(ends_of(second), second.pixel),
    );
    fragment.front = carried(unpacked(cell.planes[1]), front_of(thick.zw));
    fragment.back = carried(unpacked(cell.planes[2]), back_of(thick.zw));
    let names = vec2<u32>(o.names[outer.x], o.names[outer.y]);
    fragment.first = carried(quantity_of(c.scalars[names.x], c.names[names.x]), front_of(ends_of(first)));
    fragment.second = carried(quantity_of(c.scalars[names.y], c.names[names.y]), front_of(ends_of(second)));
    fragment.pieces_entry = vec3<u32>(vec2<u32>(cell.planes[3].zw), entry);
    fragment.cell = vec2<u32>(i, 0u);
    var at = origin.pixel + thick.xy;
    if corner > 0u {
        at = moved_corner(o, select(outer.y, outer.x, corner == 1u), SLIGHT);
    }
    fragment.position = at_pixel(at);
    return fragment;
}

fn segment_in(fragment: Fragment) -> Segment {
    let at = fragment.position.xy - view.size * 0.5;
    let place = (at - fragment.origin.xy) - fragment.origin.zw;
    var shares = shares_of(place, fragment.thick.xy, fragment.outer.xy, fragment.outer.zw);
    let inside = min(min(shares.x, shares.y), shares.z) >= 0.0;
    if fragment.cell.y == 1u || (BY_PLANES && !inside) {
        return whole_segment(fragment.cell.x, at);
    }
    // Beyond the triangle, what there is at its edge.
    shares = max(shares, vec3<f32>(0.0));
    shares /= max(shares.x + shares.y + shares.z, 1e-30);
    let outer = fragment.first * shares.y + fragment.second * shares.z;
    let ends = fragment.thick.zw * shares.x + fragment.outer_ends.xy * shares.y + fragment.outer_ends.zw * shares.z;
    let segment = segment_between(fragment.front * shares.x + outer, fragment.back * shares.x + outer, ends, at);
    return cut(segment, depths_between(ends, at), at);
}
