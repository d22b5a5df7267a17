// The decomposition of a projected tetrahedron into triangles: Shirley and Tuchman 1990; its vertices in depth as in
// Kraus, Qiao and Ebert 2004, figure 3.
//
// The four projected vertices have one affine dependency, sum A_i p_i = 0 with sum A_i = 0, where abs(A_i) is twice the
// area of the triangle of the others. The vertices of positive and those of negative A_i span two simplices that cross
// over one pixel: that of the thick vertex, where a ray is inside the cell for longest. A vertex and the opposite face
// (classes 1a and 1b), or two opposite edges (class 2). An A_i of zero joins the larger simplex: a vertex over an edge, or
// over a vertex, is class 1 with triangles of no area. The triangles are a fan around the thick vertex.
import package::lib::view::{Vertex, view, ORTHOGRAPHIC, deeper, pixels_between};
import package::lib::cell::{Cell, Corners, DEEP, cell_kind, project_cell};
import package::lib::silhouette::{Outline, NARROW, cross2, is_movable, outline_extent};
import package::axes::quantity::{Quantity, quantity_of, packed};
import package::axes::shading::{pieces_between};

// Kind of a cell that is decomposed, as stored in rise.w. Those that reach over the near plane, or far in depth, are
// not: their vertices lie so far from the picture that interpolation over it would lose its digits. Nor are those that are
// seen so narrow that their corners cannot be moved outwards. They keep their planes, and fragments find their segments as
// in lib::ray.
const THICK = 3.0;

// A thick cell as it is stored, in the place of a Cell:
//   planes[0]  the thick vertex: its pixel from vertex 0's, and its ends
//   planes[1]  the quantity at its front end
//   planes[2]  the quantity at its back end
//   planes[3]  outer vertices, two bits each, and their number; the first and the last piece
//
// The ends of a vertex are the inverse depth of its front end, and by how much that is greater than the back end's; in
// orthographic views the depth of the front end from the pivot, and the thickness.

// The length inside the cell between two ends.
fn thickness(ends: vec2<f32>, at: vec2<f32>) -> f32 {
    if ORTHOGRAPHIC {
        return ends.y;
    }
    return length(vec3<f32>(at * view.pixel, 1.0)) * ends.y / (ends.x * back_of(ends));
}

// The inverse depth of the front end; 1 in orthographic views.
fn front_of(ends: vec2<f32>) -> f32 {
    if ORTHOGRAPHIC {
        return 1.0;
    }
    return ends.x;
}

// The inverse depth of the back end; 1 in orthographic views.
fn back_of(ends: vec2<f32>) -> f32 {
    if ORTHOGRAPHIC {
        return 1.0;
    }
    return ends.x - ends.y;
}

// The ends of a vertex where nothing is before or behind it.
fn ends_of(v: Vertex) -> vec2<f32> {
    if ORTHOGRAPHIC {
        return vec2<f32>(v.frame.z, 0.0);
    }
    return vec2<f32>(1.0 / v.eye.z, 0.0);
}

// A point of a simplex.
struct Point {
    // From vertex 0, in pixels.
    pixel: vec2<f32>,
    // As in lib::cell, relative to vertex 0.
    w: f32,
    quantity: Quantity,
}

// The point over the thick vertex of the simplex of the vertices in `members`.
fn point_over(c: Corners, area: vec4<f32>, members: u32) -> Point {
    var point: Point;
    var total = 0.0;
    for (var i = 0u; i < 4u; i++) {
        total += select(0.0, abs(area[i]), (members >> i & 1u) == 1u);
    }
    var weight = 0.0;
    for (var i = 0u; i < 4u; i++) {
        if (members >> i & 1u) == 1u {
            let share = abs(area[i]) / total;
            let v = c.vertices[i];
            var w = deeper(v, c.vertices[0]);
            if !ORTHOGRAPHIC {
                w /= v.eye.z;
            }
            point.pixel += pixels_between(c.vertices[0], v) * share;
            point.w += w * share;
            // Linear in the picture is the quantity over depth.
            let part = select(share * (1.0 + w), share, ORTHOGRAPHIC);
            point.quantity += quantity_of(c.scalars[i], c.names[i]) * part;
            weight += part;
        }
    }
    point.quantity /= weight;
    return point;
}

// The outline of a decomposed cell.
fn thick_outline(outer: u32, count: u32, v: array<Vertex, 4>) -> Outline {
    var o: Outline;
    o.count = count;
    for (var i = 0u; i < 4u; i++) {
        let k = outer >> (2u * min(i, count - 1u)) & 3u;
        o.names[i] = k;
        o.corners[i] = v[k].pixel;
    }
    return o;
}

// The cell decomposed, or its planes if it is too close to the eye or seen too narrow.
fn decompose(c: Corners, entry: u32) -> Cell {
    let v = c.vertices;
    let z = vec4<f32>(v[0].eye.z, v[1].eye.z, v[2].eye.z, v[3].eye.z);
    if min(min(z.x, z.y), min(z.z, z.w)) < view.near || cell_kind(z) == DEEP {
        return project_cell(v, c.scalars, c.parity);
    }
    var cell: Cell;
    let e1 = pixels_between(v[0], v[1]);
    let e2 = pixels_between(v[0], v[2]);
    let e3 = pixels_between(v[0], v[3]);
    let area = vec4<f32>(cross2(e3 - e1, e2 - e1), cross2(e2, e3), cross2(e3, e1), cross2(e1, e2));
    var plus = 0u;
    var minus = 0u;
    for (var i = 0u; i < 4u; i++) {
        plus |= select(0u, 1u << i, area[i] > 0.0);
        minus |= select(0u, 1u << i, area[i] < 0.0);
    }
    // Of no area, or of no sign but one, as rounding can make a sliver's: nothing is seen.
    if plus == 0u || minus == 0u {
        return cell;
    }
    var first = plus;
    var second = minus;
    if countOneBits(plus) == 1u {
        second = ~plus & 15u;
    } else if countOneBits(minus) == 1u {
        first = minus;
        second = ~minus & 15u;
    }
    var outer: u32;
    var count = 3u;
    if countOneBits(first) == 1u {
        let a = firstTrailingBit(second);
        let c = firstLeadingBit(second);
        let b = firstTrailingBit(second & ~(1u << a | 1u << c));
        outer = a | b << 2u | c << 4u;
    } else {
        count = 4u;
        outer = firstTrailingBit(first) | firstTrailingBit(second) << 2u
            | firstLeadingBit(first) << 4u | firstLeadingBit(second) << 6u;
    }
    let o = thick_outline(outer, count, v);
    if !is_movable(o, outline_extent(o), NARROW) {
        return project_cell(v, c.scalars, c.parity);
    }
    let over_first = point_over(c, area, first);
    let over_second = point_over(c, area, second);
    var front = over_first;
    var back = over_second;
    if over_second.w > over_first.w {
        front = over_second;
        back = over_first;
    }
    var ends = vec2<f32>(v[0].frame.z - front.w, front.w - back.w);
    if !ORTHOGRAPHIC {
        ends = vec2<f32>(1.0 + front.w, front.w - back.w) / v[0].eye.z;
    }
    let s = c.scalars;
    let pieces = pieces_between(min(min(s.x, s.y), min(s.z, s.w)), max(max(s.x, s.y), max(s.z, s.w)), entry);
    cell.planes[0] = vec4<f32>(over_first.pixel, ends);
    cell.planes[1] = packed(front.quantity);
    cell.planes[2] = packed(back.quantity);
    cell.planes[3] = vec4<f32>(f32(outer), f32(count), vec2<f32>(pieces));
    cell.rise.w = THICK;
    return cell;
}
