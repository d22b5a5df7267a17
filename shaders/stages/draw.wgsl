// Draws the cells of a batch, back to front: two triangles a cell that cover its silhouette with a margin; the fragment
// finds the segment of its own ray, and whether there is one.
import package::lib::mesh::{corners};
import package::lib::view::{Vertex, view, pixel_of, ORTHOGRAPHIC};
import package::lib::cell::{Cell, Reference, HIDDEN, DEEP, cell_reference, cell_segment};
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

// Pixels by which the drawn rectangle exceeds the silhouette: well above a rasteriser's 1/256, so that every pixel
// centre inside is reached.
const MARGIN = 0.03125;

// Rectangles wider than this, in pixels, are drawn along the axes and cut to the picture: rounding far from the picture
// would eat the margin.
const WIDEST = 8192.0;

// Corner (0 or 1 along, 0 or 1 across) of a rectangle that holds the silhouette, in pixels from the picture's middle.
fn rectangle_corner(v: array<Vertex, 4>, kind: f32, corner: vec2<f32>) -> vec2<f32> {
    if kind == DEEP {
        return boxed(deep_bounds(v), corner);
    }
    // Along the longest edge.
    var axis = vec2<f32>(0.0);
    for (var i = 1u; i < 4u; i++) {
        for (var j = 0u; j < i; j++) {
            let edge = v[i].pixel - v[j].pixel;
            if dot(edge, edge) > dot(axis, axis) {
                axis = edge;
            }
        }
    }
    let extent = length(axis);
    if extent > WIDEST {
        let low = min(min(v[0].pixel, v[1].pixel), min(v[2].pixel, v[3].pixel));
        let high = max(max(v[0].pixel, v[1].pixel), max(v[2].pixel, v[3].pixel));
        return boxed(vec4<f32>(low, high), corner);
    }
    let along = select(vec2<f32>(1.0, 0.0), axis / max(extent, 1e-20), extent > 1e-3);
    let across = vec2<f32>(-along.y, along.x);
    var low = vec2<f32>(0.0);
    var high = vec2<f32>(0.0);
    for (var i = 1u; i < 4u; i++) {
        let p = v[i].pixel - v[0].pixel;
        let q = vec2<f32>(dot(along, p), dot(across, p));
        low = min(low, q);
        high = max(high, q);
    }
    let q = mix(low - MARGIN, high + MARGIN, corner);
    return v[0].pixel + along * q.x + across * q.y;
}

fn boxed(bounds: vec4<f32>, corner: vec2<f32>) -> vec2<f32> {
    let limit = view.size * 0.5 + 1.0;
    return mix(clamp(bounds.xy - MARGIN, -limit, limit), clamp(bounds.zw + MARGIN, -limit, limit), corner);
}

// Pixel bounds of the part of a cell that lies beyond the near plane.
fn deep_bounds(v: array<Vertex, 4>) -> vec4<f32> {
    var bounds = vec4<f32>(1e30, 1e30, -1e30, -1e30);
    for (var i = 0u; i < 4u; i++) {
        if v[i].eye.z >= view.near {
            bounds = vec4<f32>(min(bounds.xy, v[i].pixel), max(bounds.zw, v[i].pixel));
        }
        for (var j = 0u; j < i; j++) {
            let a = v[i].eye;
            let b = v[j].eye;
            if (a.z < view.near) != (b.z < view.near) {
                let t = clamp((view.near - a.z) / (b.z - a.z), 0.0, 1.0);
                let p = pixel_of(vec3<f32>(a.xy + (b.xy - a.xy) * t, view.near));
                bounds = vec4<f32>(min(bounds.xy, p), max(bounds.zw, p));
            }
        }
    }
    return bounds;
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
    // Two triangles: 0 1 2, 2 1 3.
    let k = array<u32, 6>(0u, 1u, 2u, 2u, 1u, 3u)[index % 6u];
    let at = rectangle_corner(c.vertices, kind, vec2<f32>(f32(k & 1u), f32(k >> 1u)));
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
