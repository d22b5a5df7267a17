// A tetrahedron as a ray sees it.
//
// Along the ray through a pixel the inverse depth at which a face's plane is met is linear in the pixel's position, in
// perspective as it is; in orthographic views the depth itself is. With the depth z_ref of one vertex as reference,
//
//     w = z_ref / z - 1   (perspective)        w = z_ref - z   (orthographic)
//
// grows towards the eye and is linear in the pixel's position on every plane. The ray is inside between the least w of the
// front faces' planes and the greatest w of the back faces'. Nothing is interpolated over triangles, so nothing depends on
// how a rasteriser rounds vertices.
//
// Of a thin cell seen aslant that is a small difference of large w. There w is counted from a face that the cell lies along,
// its lean: d = w - lean. On the lean let M_i be the barycentric coordinate of vertex i, in perspective times 1 + w: it is
// linear in the pixel's position, and none along the edge opposite, which the face opposite has too. So its plane is at
//
//     d_i = f_i M_i        f_i = volume / side_i
//
// with side_i the eye's distance from that plane times the face's area (orthographic: the area as seen). A field s that is s_i
// at the vertices is, along the ray,
//
//     (1 + w) (s - s_ref) = sum of (s_i - s_ref) (M_i - d / f_i)       (orthographic: without 1 + w)
//
// over all vertices but the reference vertex; M_i is none of the one opposite the lean. All are products: no step takes the
// difference of two depths, and the cell keeps its thickness, and what a field does in it, however thin it is. Any other cell
// has no lean: there d is w, and M_i is w_i / f_i with w_i on the face's plane.
//
// A cell may be a thousandth of the mesh wide: what it is made of are differences of the mesh's own positions, which are
// exact to their last digit, and of the pixels of its vertices, of which the host knows the last digits.
import package::lib::view::{View, Vertex, view, ORTHOGRAPHIC, rotated, beside_pivot, deeper, pixels_between};

struct Cell {
    // The plane of the face opposite each vertex: (dw/dx, dw/dy, w at the plane's origin, +1 front or -1 back). An origin
    // is a vertex's pixel as rounded to single precision. Of the lean the last is +2 or -2; it is +3 or -3 where it is d
    // in place of w.
    // Vertices are in ascending order of their index in the mesh. Planes 1, 2 and 3 have their origin at vertex 0,
    // plane 0 at vertex 1 -- the lowest vertex of each -- so that both cells at a face compute the same bits.
    planes: array<vec4<f32>, 4>,
    // The scalar's rise (Leaning) and, in w, the kind.
    rise: vec4<f32>,
}

// A cell of the mesh.
struct Corners {
    // In ascending order of their index in the mesh.
    vertices: array<Vertex, 4>,
    scalars: vec4<f32>,
    // +1 if that order is positively oriented, else -1.
    parity: f32,
    // Its index in the mesh and those of its vertices.
    cell: u32,
    names: vec4<u32>,
}

// Kinds of a cell, as stored in rise.w.
const HIDDEN = 0.0;
const PLAIN = 1.0;
// Reaches over the near plane, or so far in depth that the vertex farthest away is the one good reference: all planes
// have their origin there.
const DEEP = 2.0;

// A cell is DEEP if its vertices' depths differ by more than this factor.
const DEEP_RATIO = 4.0;

// Coefficients are limited to this value: sums and products with pixel positions stay finite.
const STEEPEST = 1e20;

fn cell_kind(z: vec4<f32>) -> f32 {
    let nearest = min(min(z.x, z.y), min(z.z, z.w));
    let farthest = max(max(z.x, z.y), max(z.z, z.w));
    if farthest <= view.near {
        return HIDDEN;
    }
    if !ORTHOGRAPHIC && (nearest < view.near || farthest > DEEP_RATIO * nearest) {
        return DEEP;
    }
    return PLAIN;
}

// One of a cell's vertices. Drivers keep an array that is indexed by a variable in memory, and all that is near it.
fn vertex_at(v: array<Vertex, 4>, index: u32) -> Vertex {
    var found = v[0];
    for (var i = 1u; i < 4u; i++) {
        if i == index {
            found = v[i];
        }
    }
    return found;
}

// Which of a cell's vertices is its reference: the lowest, of a DEEP one that farthest from the eye.
fn reference_index(v: array<Vertex, 4>, kind: f32) -> u32 {
    var index = 0u;
    if kind == DEEP {
        var farthest = v[0].eye.z;
        for (var i = 1u; i < 4u; i++) {
            if v[i].eye.z > farthest {
                index = i;
                farthest = v[i].eye.z;
            }
        }
    }
    return index;
}

// Planes whose distance from the eye is this share of the terms that it is the sum of count as edge-on: rounding leaves
// that much of it.
const EDGE_ON = 1e-6;

// A ray in a plane that is seen edge-on is taken for one this many pixels away: then all faces that meet in an edge
// along the ray agree on which side of each it passes. No edge of a grid runs along this direction.
const NUDGE = vec2<f32>(7.3e-5, 4.1e-5);

// A face lies along another, and the cell is thin, if their planes' slopes differ by less than this share: else the difference
// of two w is as good.
const ALONG = 0.25;

// (b-a) x (c-a), of the two shortest edges: those of a sliver are nearly parallel otherwise, and cancel.
fn face_normal(a: vec3<f32>, b: vec3<f32>, c: vec3<f32>) -> vec3<f32> {
    let ab = b - a;
    let ac = c - a;
    let bc = c - b;
    let squares = vec3<f32>(dot(ab, ab), dot(ac, ac), dot(bc, bc));
    if squares.x > max(squares.y, squares.z) {
        return cross(ac, bc);
    }
    if squares.y > squares.z {
        return cross(ab, bc);
    }
    return cross(ab, ac);
}

// How far the eye is on the side of the face a, b, c that its normal points away from, times the normal's length; and the
// sum of the terms without their signs. From the vertex that is least, and in the mesh's own axes: one along which a face
// runs adds nothing, not even rounding, however long the face is.
fn side_of_eye(a: Vertex, b: Vertex, c: Vertex, normal: vec3<f32>, turned: vec3<f32>) -> vec2<f32> {
    let from_a = normal * beside_pivot(a.position);
    let from_b = normal * beside_pivot(b.position);
    let from_c = normal * beside_pivot(c.position);
    let one = vec3<f32>(1.0);
    let sums = vec3<f32>(dot(abs(from_a), one), dot(abs(from_b), one), dot(abs(from_c), one));
    var least = from_a;
    if sums.y < sums.x {
        least = from_b;
    }
    if sums.z < min(sums.x, sums.y) {
        least = from_c;
    }
    let aside = turned * vec3<f32>(view.right.w, view.down.w, view.forward.w);
    return vec2<f32>(dot(least, one) + dot(aside, one), min(sums.x, min(sums.y, sums.z)) + dot(abs(aside), one));
}

// A face as the eye sees it.
struct Side {
    // As face_normal has it, in the mesh's axes and in those of eye space.
    normal: vec3<f32>,
    turned: vec3<f32>,
    // +1 if the normal points away from the eye, else -1.
    toward: f32,
    // The eye's distance from the plane times the normal's length, not zero; next to none if it is seen edge-on.
    reach: f32,
    is_edge_on: bool,
}

// The face a, b, c, its vertices in ascending order of index: both cells at a face find the same bits.
fn side_of(a: Vertex, b: Vertex, c: Vertex) -> Side {
    let normal = face_normal(a.position, b.position, c.position);
    let n = rotated(normal);
    // Positive if the eye is on the side that n points away from, and of terms up to this.
    var side = side_of_eye(a, b, c, normal, n);
    let reach = max(max(abs(a.eye), abs(b.eye)), abs(c.eye));
    var scale = dot(abs(n), vec3<f32>(1.0)) * max(max(reach.x, reach.y), reach.z);
    if ORTHOGRAPHIC {
        scale = abs(n.x) + abs(n.y);
        side = vec2<f32>(n.z, scale);
    }
    // Seen edge-on the plane bounds nothing but the silhouette: any large slope of the right sign does, and both cells
    // at the face choose the same.
    let edge_on = abs(side.x) <= EDGE_ON * side.y;
    let size = max(select(abs(side.x), 1e-12 * scale, edge_on), 1e-30);
    return Side(normal, n, select(-1.0, 1.0, side.x >= 0.0), size, edge_on);
}

fn limited(x: vec3<f32>) -> vec3<f32> {
    return clamp(x, vec3<f32>(-STEEPEST), vec3<f32>(STEEPEST));
}

// Plane of a face with the lowest vertex a: (dw/dx, dw/dy, w at the rounded pixel of `origin`, less that of `origin` itself);
// `rise` is the side of a pixel, in perspective at the depth where w is 0.
fn face_plane(side: Side, a: Vertex, origin: Vertex, rise: f32) -> vec3<f32> {
    let slope = limited(vec3<f32>(side.turned.xy * (rise * side.toward / side.reach), 0.0)).xy;
    let aside = select(vec2<f32>(0.0), NUDGE, side.is_edge_on) - origin.rest;
    let offset = dot(side.normal, origin.position - a.position) * side.toward / side.reach + dot(slope, aside);
    return vec3<f32>(slope, clamp(offset, -STEEPEST, STEEPEST));
}

// (a x b).xy, of what is beside the edge from a to b; in pixels if not DEEP, and then less what all edges of a cell have in
// common in perspective.
fn beside_edge(a: Vertex, b: Vertex, kind: f32) -> vec2<f32> {
    if kind == DEEP {
        // A vertex behind the eye has no pixel.
        let edge = rotated(b.position - a.position);
        return vec2<f32>(a.eye.y * edge.z - a.eye.z * edge.y, a.eye.z * edge.x - a.eye.x * edge.z);
    }
    let edge = pixels_between(a, b);
    return vec2<f32>(-edge.y, edge.x);
}

// A cell as its planes and fields need it.
struct Leaning {
    planes: array<vec4<f32>, 4>,
    // f of each vertex, without its sign, which is that of its plane.
    heights: vec4<f32>,
    // How a field that is 1 at a vertex and 0 at the others rises by pixels and, falling, by d: (d/dx, d/dy of M, 1 / f); none
    // at the reference vertex.
    rises: array<vec3<f32>, 4>,
}

// v: vertices in ascending order of index; parity: +1 if that order is positively oriented, else -1.
fn leaning(v: array<Vertex, 4>, kind: f32, parity: f32) -> Leaning {
    let sides = array<Side, 4>(
        side_of(v[1], v[2], v[3]),
        side_of(v[0], v[2], v[3]),
        side_of(v[0], v[1], v[3]),
        side_of(v[0], v[1], v[2]),
    );
    let reference = reference_index(v, kind);
    let a = vertex_at(v, reference);
    let rise = select(a.eye.z * view.pixel, view.pixel, ORTHOGRAPHIC);
    // Plane 0 does not hold vertex 0: its origin is its own lowest vertex, where its depth is known.
    var origin = v[1];
    var step = deeper(v[1], v[0]);
    if kind == DEEP {
        origin = a;
        step = 0.0;
    } else if !ORTHOGRAPHIC {
        step /= v[1].eye.z;
    }
    let planes = array<vec3<f32>, 4>(
        face_plane(sides[0], v[1], origin, rise) + vec3<f32>(0.0, 0.0, step),
        face_plane(sides[1], v[0], a, rise),
        face_plane(sides[2], v[0], a, rise),
        face_plane(sides[3], v[0], a, rise),
    );
    // Of the faces at the reference vertex the one seen largest, and the vertex opposite.
    var lean = 0u;
    var side = sides[0];
    var plane = planes[0];
    var top = v[0].position;
    var largest = -1.0;
    for (var i = 0u; i < 4u; i++) {
        if i != reference && sides[i].reach > largest {
            lean = i;
            side = sides[i];
            plane = planes[i];
            top = v[i].position;
            largest = side.reach;
        }
    }
    // From there the shortest way to that face: of a sheet that is across it, and nothing cancels.
    var way = top - a.position;
    for (var i = 0u; i < 4u; i++) {
        let to_other = top - v[i].position;
        if i != reference && i != lean && dot(to_other, to_other) < dot(way, way) {
            way = to_other;
        }
    }
    let volume = abs(dot(side.normal, way));
    var result: Leaning;
    var along = 0u;
    for (var i = 0u; i < 4u; i++) {
        let inward = select(parity, -parity, (i & 1u) == 0u);
        let front = sides[i].toward * inward;
        result.planes[i] = vec4<f32>(planes[i], front);
        result.heights[i] = min(volume / sides[i].reach, STEEPEST);
        if i != reference {
            let rate = sides[i].turned.xy * (rise * inward / max(volume, 1e-30));
            result.rises[i] = limited(vec3<f32>(rate, front / max(result.heights[i], 1.0 / STEEPEST)));
        }
        let apart = abs(planes[i].xy - plane.xy);
        let slope = abs(plane.xy);
        let is_along = max(apart.x, apart.y) < ALONG * max(slope.x, slope.y);
        along |= select(0u, 1u << i, is_along && !sides[i].is_edge_on);
    }
    // Nothing but itself lies along it.
    if (along & ~(1u << lean)) == 0u || side.is_edge_on {
        return result;
    }
    let others = 15u & ~(1u << reference | 1u << lean);
    let second = firstTrailingBit(others);
    let third = firstLeadingBit(others);
    let b = vertex_at(v, second);
    let c = vertex_at(v, third);
    // M of its three vertices by pixels.
    var rate_a = beside_edge(b, c, kind);
    var rate_b = beside_edge(c, a, kind);
    var rate_c = beside_edge(a, b, kind);
    if kind == DEEP {
        // Between two vertices in ascending order the reference vertex turns the normal round.
        let is_between = second < reference && reference < third;
        let scale = rise * side.toward / select(side.reach, -side.reach, is_between);
        rate_a *= scale;
        rate_b *= scale;
        rate_c *= scale;
    } else {
        // Twice the area in the picture.
        let area = rate_b.x * rate_c.y - rate_b.y * rate_c.x;
        let scale = 1.0 / select(min(area, -1e-30), max(area, 1e-30), area >= 0.0);
        rate_a *= scale;
        rate_b *= scale;
        rate_c *= scale;
        if !ORTHOGRAPHIC {
            rate_b *= a.eye.z / b.eye.z;
            rate_c *= a.eye.z / c.eye.z;
        }
    }
    for (var i = 0u; i < 4u; i++) {
        let front = result.planes[i].w;
        var rate = vec3<f32>(0.0);
        if i == second {
            rate = vec3<f32>(rate_b, -dot(rate_b, a.rest));
        } else if i == third {
            rate = vec3<f32>(rate_c, -dot(rate_c, a.rest));
        }
        if i == lean {
            result.planes[i].w = 2.0 * front;
        } else if (along >> i & 1u) == 1u {
            if i == reference {
                let here = select(dot(rate_a, pixels_between(b, origin)), 1.0, kind == DEEP);
                rate = vec3<f32>(rate_a, here - dot(rate_a, origin.rest));
            }
            result.planes[i] = vec4<f32>(limited(rate * (result.heights[i] * front)), 3.0 * front);
        }
        if i != reference {
            result.rises[i] = limited(vec3<f32>(rate.xy, result.rises[i].z));
        }
    }
    return result;
}

// s: the scalars of the vertices.
fn project_cell(v: array<Vertex, 4>, s: vec4<f32>, parity: f32) -> Cell {
    var cell: Cell;
    let z = vec4<f32>(v[0].eye.z, v[1].eye.z, v[2].eye.z, v[3].eye.z);
    let kind = cell_kind(z);
    if kind != HIDDEN {
        let seen = leaning(v, kind, parity);
        cell.planes = seen.planes;
        cell.rise = vec4<f32>(rise_of(seen, s - s[reference_index(v, kind)]), kind);
    }
    return cell;
}

// How a field rises that exceeds what it is at the reference vertex by this at each vertex.
fn rise_of(seen: Leaning, more: vec4<f32>) -> vec3<f32> {
    let r = seen.rises;
    return limited(more.x * r[0] + more.y * r[1] + more.z * r[2] + more.w * r[3]);
}

// What a ray needs of a cell besides its planes and what rises in it.
struct Reference {
    // Which of the four vertices it is.
    index: u32,
    // Pixels at which planes 1 to 3, and plane 0, have their origin: those of vertices, rounded.
    origins: vec4<f32>,
    // What the reference vertex's has been rounded by.
    rest: vec2<f32>,
    // Its depth, and its depth from the pivot, which keeps its digits however far away the eye is.
    depth: f32,
    level: f32,
    // Its scalar.
    scalar: f32,
    // w of the farthest and of the nearest vertex in front of the near plane.
    w: vec2<f32>,
    // Smallest and largest scalar.
    s: vec2<f32>,
}

fn cell_reference(v: array<Vertex, 4>, s: vec4<f32>, kind: f32) -> Reference {
    var reference: Reference;
    let index = reference_index(v, kind);
    let r = vertex_at(v, index);
    reference.index = index;
    reference.origins = vec4<f32>(r.pixel, select(v[1].pixel, r.pixel, kind == DEEP));
    reference.rest = r.rest;
    reference.depth = r.eye.z;
    reference.level = r.frame.z;
    reference.scalar = s[index];
    // How much nearer than the reference vertex: the farthest of all, and the nearest beyond the near plane.
    let z = vec4<f32>(deeper(v[0], r), deeper(v[1], r), deeper(v[2], r), deeper(v[3], r));
    let farthest = min(min(z.x, z.y), min(z.z, z.w));
    let nearest = min(max(max(z.x, z.y), max(z.z, z.w)), r.eye.z - view.near);
    reference.w = vec2<f32>(farthest, nearest);
    if !ORTHOGRAPHIC {
        reference.w /= max(r.eye.z - reference.w, vec2<f32>(view.near));
    }
    reference.s = vec2<f32>(min(min(s.x, s.y), min(s.z, s.w)), max(max(s.x, s.y), max(s.z, s.w)));
    return reference;
}

// By how much a value of that rise exceeds at the reference vertex what it is at the pixel that this has been rounded to.
fn rounded_by(reference: Reference, rise: vec2<f32>) -> f32 {
    return dot(rise, reference.rest);
}
