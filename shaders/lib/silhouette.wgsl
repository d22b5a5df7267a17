// What is drawn of a cell: its silhouette with a margin.
//
// The classes of projected tetrahedra (Shirley and Tuchman 1990): with one front face (1a) or one back face (1b) the
// silhouette is a triangle, with two of each (2) a quadrilateral. Fragments find their segments from the planes of the
// faces, so the silhouette need not be cut at the thick vertex; and since they reject what misses the cell, it may be
// drawn a little too large. It must: rasterisers round vertices to 1/256 pixel, and a pixel lost beside a face that is
// seen edge-on would be a visible fault.
import package::lib::view::{Vertex, view, pixel_of};
import package::lib::cell::{Cell, DEEP};

// Pixels by which the silhouette is exceeded.
const MARGIN = 0.03125;

// Silhouettes wider than this, in pixels, are drawn as a rectangle along the axes, cut to the picture: rounding far from
// the picture would eat the margin.
const WIDEST = 8192.0;

// Silhouettes narrower than this, in pixels, or with an edge shorter than SHORTEST, are drawn as a rectangle along their
// longest edge: their corners are too sharp or too close to be moved outwards one by one. All degenerate projections
// (a vertex over a vertex or an edge, faces edge-on) are among these or among the classes.
const NARROWEST = 1.0;
const SHORTEST = 0.01;

// What is interpolated over triangles is drawn larger by this many pixels alone, and what is narrower is not interpolated.
const SLIGHT = 0.0078125;
const NARROW = 0.25;

struct Outline {
    corners: array<vec2<f32>, 4>,
    // Their vertices.
    names: vec4<u32>,
    // 3 or 4; 0 if the faces are all front or all back, as rounding can make those of a sliver.
    count: u32,
}

// A bit for each front face.
fn fronts_of(cell: Cell) -> u32 {
    var fronts = 0u;
    for (var i = 0u; i < 4u; i++) {
        if cell.planes[i].w > 0.0 {
            fronts |= 1u << i;
        }
    }
    return fronts;
}

fn outline(fronts: u32, p: array<vec2<f32>, 4>) -> Outline {
    var result: Outline;
    let count = countOneBits(fronts);
    if count == 2u {
        // Edges of the silhouette join the vertex opposite a front face with one opposite a back face.
        let a = firstTrailingBit(fronts);
        let b = firstLeadingBit(fronts);
        let c = firstTrailingBit(~fronts & 15u);
        let d = firstLeadingBit(~fronts & 15u);
        result.names = vec4<u32>(a, c, b, d);
        result.corners = array<vec2<f32>, 4>(p[a], p[c], p[b], p[d]);
        result.count = 4u;
    } else if count == 1u || count == 3u {
        // The one face that looks the other way; the vertex opposite lies before or behind it.
        let face = firstTrailingBit(select(~fronts & 15u, fronts, count == 1u));
        let a = select(0u, 1u, face == 0u);
        let b = select(1u, 2u, face <= 1u);
        let c = select(2u, 3u, face <= 2u);
        result.names = vec4<u32>(a, b, c, c);
        result.corners = array<vec2<f32>, 4>(p[a], p[b], p[c], p[c]);
        result.count = 3u;
    }
    return result;
}

// Twice the signed area.
fn outline_area(o: Outline) -> f32 {
    let diagonal = o.corners[2] - o.corners[0];
    return cross2(o.corners[1] - o.corners[0], diagonal) + cross2(diagonal, o.corners[3] - o.corners[0]);
}

// Whether the corners of an outline can be moved outwards one by one; `extent` is its longest diameter.
fn is_movable(o: Outline, extent: f32, narrowest: f32) -> bool {
    if o.count == 0u || extent > WIDEST {
        return false;
    }
    let closing = distance(o.corners[3], o.corners[0]);
    let last = select(closing, distance(o.corners[2], o.corners[3]), o.count == 4u);
    let first = min(distance(o.corners[0], o.corners[1]), distance(o.corners[1], o.corners[2]));
    return abs(outline_area(o)) >= narrowest * extent && min(first, min(last, closing)) >= SHORTEST;
}

// Corner i moved outwards.
fn moved_corner(o: Outline, i: u32, margin: f32) -> vec2<f32> {
    let before = select(i, o.count, i == 0u) - 1u;
    let after = select(i + 1u, 0u, i + 1u == o.count);
    return moved_out(o.corners[before], o.corners[i], o.corners[after], margin * sign(outline_area(o)));
}

// The longest diameter of an outline.
fn outline_extent(o: Outline) -> f32 {
    let diagonals = max(distance(o.corners[0], o.corners[2]), distance(o.corners[1], o.corners[3]));
    let sides = max(distance(o.corners[0], o.corners[1]), distance(o.corners[1], o.corners[2]));
    return max(diagonals, max(sides, max(distance(o.corners[2], o.corners[3]), distance(o.corners[3], o.corners[0]))));
}

// Corner k, 0 to 3 in cyclic order, of what is drawn, in pixels from the picture's middle.
fn silhouette_corner(cell: Cell, v: array<Vertex, 4>, k: u32) -> vec2<f32> {
    if cell.rise.w == DEEP {
        return boxed(deep_bounds(v), k);
    }
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
        return boxed(vec4<f32>(low, high), k);
    }
    let o = outline(fronts_of(cell), array<vec2<f32>, 4>(v[0].pixel, v[1].pixel, v[2].pixel, v[3].pixel));
    if !is_movable(o, extent, NARROWEST) {
        return oblong(v, axis, extent, k);
    }
    return moved_corner(o, min(k, o.count - 1u), MARGIN);
}

// The corner `at` between two others, both its edges moved outwards; `outward` has the sign of the outline's area.
fn moved_out(before: vec2<f32>, at: vec2<f32>, after: vec2<f32>, outward: f32) -> vec2<f32> {
    let e = normalize(at - before);
    let f = normalize(after - at);
    if dot(e, f) > 0.0 {
        let normals = vec2<f32>(e.y + f.y, -e.x - f.x);
        return at + normals * (outward / (1.0 + dot(e, f)));
    }
    return at + (e - f) * (outward / cross2(e, f));
}

// Corner k, 0 to 2, of what is drawn of the face opposite vertex `face` of a cell that is not DEEP: the face with the
// margin or, where its corners cannot be moved one by one, a right triangle round a rectangle that holds it.
fn face_corner(v: array<Vertex, 4>, face: u32, k: u32) -> vec2<f32> {
    let a = v[select(0u, 1u, face == 0u)].pixel;
    let b = v[select(1u, 2u, face <= 1u)].pixel;
    let c = v[select(2u, 3u, face <= 2u)].pixel;
    var axis = b - a;
    axis = select(axis, c - a, dot(c - a, c - a) > dot(axis, axis));
    axis = select(axis, c - b, dot(c - b, c - b) > dot(axis, axis));
    let extent = length(axis);
    let corner = vec2<f32>(f32(k == 1u), f32(k == 2u)) * 2.0;
    if extent > WIDEST {
        let limit = view.size * 0.5 + 1.0;
        let low = clamp(min(a, min(b, c)) - MARGIN, -limit, limit);
        let high = clamp(max(a, max(b, c)) + MARGIN, -limit, limit);
        return mix(low, high, corner);
    }
    let area = cross2(b - a, c - a);
    let shortest = min(distance(a, b), min(distance(b, c), distance(c, a)));
    if abs(area) < NARROWEST * extent || shortest < SHORTEST {
        let along = select(vec2<f32>(1.0, 0.0), axis / max(extent, 1e-20), extent > 1e-3);
        let across = vec2<f32>(-along.y, along.x);
        let p = vec2<f32>(dot(along, b - a), dot(across, b - a));
        let q = vec2<f32>(dot(along, c - a), dot(across, c - a));
        let low = min(min(p, q), vec2<f32>(0.0)) - MARGIN;
        let high = max(max(p, q), vec2<f32>(0.0)) + MARGIN;
        let place = mix(low, high, corner);
        return a + along * place.x + across * place.y;
    }
    let corners = array<vec2<f32>, 3>(a, b, c);
    return moved_out(corners[(k + 2u) % 3u], corners[k], corners[(k + 1u) % 3u], MARGIN * sign(area));
}

fn cross2(a: vec2<f32>, b: vec2<f32>) -> f32 {
    return a.x * b.y - a.y * b.x;
}

// Corner k of a unit square, in cyclic order.
fn square(k: u32) -> vec2<f32> {
    return vec2<f32>(f32((k + 1u) >> 1u & 1u), f32(k >> 1u));
}

// A rectangle along the longest edge.
fn oblong(v: array<Vertex, 4>, axis: vec2<f32>, extent: f32, k: u32) -> vec2<f32> {
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
    let q = mix(low - MARGIN, high + MARGIN, square(k));
    return v[0].pixel + along * q.x + across * q.y;
}

// A rectangle along the axes, cut to the picture.
fn boxed(bounds: vec4<f32>, k: u32) -> vec2<f32> {
    let limit = view.size * 0.5 + 1.0;
    return mix(clamp(bounds.xy - MARGIN, -limit, limit), clamp(bounds.zw + MARGIN, -limit, limit), square(k));
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
