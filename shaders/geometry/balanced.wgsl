// Balanced cell projection (Moreland and Angel 2004, section 3.1): at each vertex the distances to all faces along its ray
// and the scalars there, as two four-tuples; they are interpolated over the front faces, and a fragment takes the
// nearest. The tuples are the same for all faces at a vertex, so that four vertices a cell are drawn by index.
//
// Published are Euclidean distances and plain scalars, which are not linear in a perspective picture: here they are inverse
// depths and scalars times these, which are. What is left is the rasteriser's rounding of vertices.
import package::lib::view::{view, ORTHOGRAPHIC};
import package::lib::mesh::{corners, entry_of};
import package::lib::cell::{STEEPEST, project_cell, cell_reference};
import package::lib::silhouette::{silhouette_corner};
import package::lib::span::{Segment};
import package::lib::ray::{cell_segment};
import package::lib::balanced::{Balanced};
import package::axes::quantity::{linear_in};
import package::axes::shading::{pieces_between};
import package::axes::surface::{cut};

@group(1) @binding(1) var<storage, read> projected: array<Balanced>;

struct Fragment {
    @builtin(position) position: vec4<f32>,
    // Inverse depth and the scalar times it, at the front; orthographic, the depth from the pivot and the scalar.
    @location(0) @interpolate(linear) front: vec2<f32>,
    @location(1) @interpolate(linear) distances: vec4<f32>,
    @location(2) @interpolate(linear) scalars: vec4<f32>,
    // Smallest and largest scalar.
    @location(3) @interpolate(flat) range: vec2<f32>,
    // The pieces of the transfer function that the cell's scalars meet, the cell's place in the order, and 1 + its place in
    // the batch if it is drawn as a whole.
    @location(4) @interpolate(flat) pieces_entry: vec4<u32>,
}

// Front faces are never the nearest behind.
const NEVER = STEEPEST;

fn place(vertex_index: u32, instance_index: u32) -> Fragment {
    let i = vertex_index / 4u;
    let balanced = projected[i];
    var fragment: Fragment;
    if all(balanced.distances == vec4<f32>(0.0)) {
        // Outside the clip volume: nothing is drawn.
        fragment.position = vec4<f32>(2.0, 2.0, 2.0, 1.0);
        return fragment;
    }
    let c = corners(i);
    // Positively oriented in any case.
    let slot = vertex_index % 4u;
    let k = select(slot, array<u32, 4>(0u, 1u, 3u, 2u)[slot], c.parity < 0.0);
    let v = c.vertices[k];
    var at = v.pixel;
    let s = c.scalars;
    fragment.range = vec2<f32>(min(min(s.x, s.y), min(s.z, s.w)), max(max(s.x, s.y), max(s.z, s.w)));
    let entry = entry_of(i);
    fragment.pieces_entry = vec4<u32>(pieces_between(fragment.range.x, fragment.range.y, entry), entry, 0u);
    if all(balanced.distances < vec4<f32>(0.0)) {
        // A quadrilateral: of its two halves, each drawn either way round, culling leaves one each.
        at = silhouette_corner(project_cell(c.vertices, c.scalars, c.parity), c.vertices, slot);
        fragment.pieces_entry.w = i + 1u;
    } else {
        fragment.front = vec2<f32>(v.frame.z, s[k]);
        if !ORTHOGRAPHIC {
            fragment.front = vec2<f32>(1.0, s[k]) / v.eye.z;
        }
        // In a face the distance to it is none and the scalar its own.
        fragment.scalars = vec4<f32>(fragment.front.y);
        fragment.scalars[k] = balanced.scalars[k];
        fragment.distances[k] = balanced.distances[k];
        fragment.distances = select(fragment.distances, vec4<f32>(NEVER), balanced.distances < vec4<f32>(0.0));
    }
    fragment.position = vec4<f32>(at.x * 2.0 / view.size.x, -at.y * 2.0 / view.size.y, 0.5, 1.0);
    return fragment;
}

fn segment_in(fragment: Fragment) -> Segment {
    let at = fragment.position.xy - view.size * 0.5;
    if fragment.pieces_entry.w > 0u {
        let c = corners(fragment.pieces_entry.w - 1u);
        let cell = project_cell(c.vertices, c.scalars, c.parity);
        let reference = cell_reference(c.vertices, c.scalars, cell.gradient.w);
        return cell_segment(cell.planes, linear_in(cell, reference, c), reference, at);
    }
    var distance = NEVER;
    var scalar = 0.0;
    for (var k = 0u; k < 4u; k++) {
        if fragment.distances[k] < distance {
            distance = fragment.distances[k];
            scalar = fragment.scalars[k];
        }
    }
    var segment: Segment;
    if !(distance > 0.0 && distance < NEVER) {
        return segment;
    }
    segment.at = at;
    segment.front = fragment.front.y;
    segment.back = scalar;
    segment.length = distance;
    var ends = fragment.front.x + vec2<f32>(0.0, distance);
    if !ORTHOGRAPHIC {
        let near = fragment.front.x;
        let far = max(near - distance, 1e-30);
        segment.front /= near;
        segment.back /= far;
        segment.length *= length(vec3<f32>(at * view.pixel, 1.0)) / (near * far);
        ends = vec2<f32>(1.0 / near, 1.0 / far) - view.forward.w;
    }
    segment.front = clamp(segment.front, fragment.range.x, fragment.range.y);
    segment.back = clamp(segment.back, fragment.range.x, fragment.range.y);
    return cut(segment, ends, at);
}
