// A tetrahedron as a ray sees it.
//
// Along the ray through a pixel the inverse depth at which a face's plane is met is linear in the pixel's position, in
// perspective as it is; in orthographic views the depth itself is. With the depth z_ref of one vertex as reference,
//
//     w = z_ref / z - 1   (perspective)        w = z_ref - z   (orthographic)
//
// grows towards the eye, is linear in the pixel's position on every plane, and is small for small cells, so that thin
// ones keep their thickness in single precision. The ray is inside between the least w of the front faces' planes and
// the greatest w of the back faces'. Nothing is interpolated over triangles, so nothing depends on how a rasteriser
// rounds vertices.
//
// A cell may be a thousandth of the mesh wide and a thousandth of that thick: what it is made of are differences of the
// mesh's own positions, which are exact to their last digit, and the difference of a pixel from the vertex that the
// cell's planes have their origin at, of which the host knows the last digits.
import package::lib::view::{View, Vertex, view, ORTHOGRAPHIC, rotated, beside_pivot, deeper};

struct Cell {
    // The plane of the face opposite each vertex: (dw/dx, dw/dy, w at the plane's origin, +1 front or -1 back). An origin
    // is a vertex's pixel as rounded to single precision.
    // Vertices are in ascending order of their index in the mesh. Planes 1, 2 and 3 have their origin at vertex 0,
    // plane 0 at vertex 1 -- the lowest vertex of each -- so that both cells at a face compute the same bits.
    planes: array<vec4<f32>, 4>,
    // Gradient of the scalar in eye space; in w the kind.
    gradient: vec4<f32>,
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

// Kinds of a cell, as stored in gradient.w.
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

// The vertex farthest from the eye, which of the four it is, and its scalar. (Constant indices alone: others would move all vertices to memory.)
struct Far {
    vertex: Vertex,
    index: u32,
    scalar: f32,
}

fn farthest_vertex(v: array<Vertex, 4>, s: vec4<f32>) -> Far {
    var far = Far(v[0], 0u, s.x);
    if v[1].eye.z > far.vertex.eye.z {
        far = Far(v[1], 1u, s.y);
    }
    if v[2].eye.z > far.vertex.eye.z {
        far = Far(v[2], 2u, s.z);
    }
    if v[3].eye.z > far.vertex.eye.z {
        far = Far(v[3], 3u, s.w);
    }
    return far;
}

// Planes whose distance from the eye is this share of the terms that it is the sum of count as edge-on: rounding leaves
// that much of it.
const EDGE_ON = 1e-6;

// A ray in a plane that is seen edge-on is taken for one this many pixels away: then all faces that meet in an edge
// along the ray agree on which side of each it passes. No edge of a grid runs along this direction.
const NUDGE = vec2<f32>(7.3e-5, 4.1e-5);

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

// Plane of the face a, b, c, its vertices in ascending order of index; `inward` is +1 if (b-a) x (c-a) points into the
// cell and -1 if out of it; `depth` is that of w = 0; the third component is w at the rounded pixel of `origin`, less
// that of `origin` itself.
fn face_plane(a: Vertex, b: Vertex, c: Vertex, inward: f32, depth: f32, origin: Vertex) -> vec4<f32> {
    let normal = face_normal(a.position, b.position, c.position);
    let n = rotated(normal);
    // Positive if the eye is on the side that n points away from, and of terms up to this.
    var side = side_of_eye(a, b, c, normal, n);
    let reach = max(max(abs(a.eye), abs(b.eye)), abs(c.eye));
    var scale = dot(abs(n), vec3<f32>(1.0)) * max(max(reach.x, reach.y), reach.z);
    var rise = depth * view.pixel;
    if ORTHOGRAPHIC {
        scale = abs(n.x) + abs(n.y);
        side = vec2<f32>(n.z, scale);
        rise = view.pixel;
    }
    // Seen edge-on the plane bounds nothing but the silhouette: any large slope of the right sign does, and both cells
    // at the face choose the same.
    let edge_on = abs(side.x) <= EDGE_ON * side.y;
    let divisor = max(select(abs(side.x), 1e-12 * scale, edge_on), 1e-30);
    let toward = select(-1.0, 1.0, side.x >= 0.0);
    let slope = clamp(n.xy * (rise * toward / divisor), vec2<f32>(-STEEPEST), vec2<f32>(STEEPEST));
    let aside = select(vec2<f32>(0.0), NUDGE, edge_on) - origin.rest;
    let offset = dot(normal, origin.position - a.position) * toward / divisor + dot(slope, aside);
    return vec4<f32>(slope, clamp(offset, -STEEPEST, STEEPEST), toward * inward);
}

// v: vertices in ascending order of index; s: their scalars; parity: +1 if that order is positively oriented, else -1.
fn project_cell(v: array<Vertex, 4>, s: vec4<f32>, parity: f32) -> Cell {
    var cell: Cell;
    let z = vec4<f32>(v[0].eye.z, v[1].eye.z, v[2].eye.z, v[3].eye.z);
    let kind = cell_kind(z);
    if kind == HIDDEN {
        return cell;
    }
    if kind == DEEP {
        let far = farthest_vertex(v, s).vertex;
        cell.planes[0] = face_plane(v[1], v[2], v[3], -parity, far.eye.z, far);
        cell.planes[1] = face_plane(v[0], v[2], v[3], parity, far.eye.z, far);
        cell.planes[2] = face_plane(v[0], v[1], v[3], -parity, far.eye.z, far);
        cell.planes[3] = face_plane(v[0], v[1], v[2], parity, far.eye.z, far);
    } else {
        cell.planes[0] = face_plane(v[1], v[2], v[3], -parity, z.x, v[1]);
        cell.planes[1] = face_plane(v[0], v[2], v[3], parity, z.x, v[0]);
        cell.planes[2] = face_plane(v[0], v[1], v[3], -parity, z.x, v[0]);
        cell.planes[3] = face_plane(v[0], v[1], v[2], parity, z.x, v[0]);
        // Plane 0 does not hold vertex 0: its origin is its own lowest vertex, where its depth is known.
        let step = deeper(v[1], v[0]);
        if ORTHOGRAPHIC {
            cell.planes[0].z += step;
        } else {
            cell.planes[0].z += step / v[1].eye.z;
        }
    }
    let e1 = v[1].position - v[0].position;
    let e2 = v[2].position - v[0].position;
    let e3 = v[3].position - v[0].position;
    let volume = dot(e1, cross(e2, e3));
    let inverse = select(-1.0, 1.0, volume >= 0.0) / max(abs(volume), 1e-30);
    let sum = (s.y - s.x) * cross(e2, e3) + (s.z - s.x) * cross(e3, e1) + (s.w - s.x) * cross(e1, e2);
    let gradient = clamp(rotated(sum * inverse), vec3<f32>(-STEEPEST), vec3<f32>(STEEPEST));
    cell.gradient = vec4<f32>(gradient, kind);
    return cell;
}

// What a ray needs of a cell besides its planes and gradient.
struct Reference {
    // Which of the four vertices it is.
    index: u32,
    // Pixels at which planes 1 to 3, and plane 0, have their origin: those of vertices, rounded.
    origins: vec4<f32>,
    // What the reference vertex's has been rounded by.
    rest: vec2<f32>,
    // Depth of the reference vertex, its depth from the pivot, which keeps its digits however far away the eye is, and
    // its scalar.
    depth: f32,
    level: f32,
    scalar: f32,
    // w of the farthest and of the nearest vertex in front of the near plane.
    w: vec2<f32>,
    // Smallest and largest scalar.
    s: vec2<f32>,
}

fn cell_reference(v: array<Vertex, 4>, s: vec4<f32>, kind: f32) -> Reference {
    var reference: Reference;
    var r = v[0];
    reference.origins = vec4<f32>(v[0].pixel, v[1].pixel);
    reference.scalar = s.x;
    if kind == DEEP {
        let far = farthest_vertex(v, s);
        r = far.vertex;
        reference.index = far.index;
        reference.origins = vec4<f32>(r.pixel, r.pixel);
        reference.scalar = far.scalar;
    }
    reference.rest = r.rest;
    reference.depth = r.eye.z;
    reference.level = r.frame.z;
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

// By how much a value of that rate across the view, a unit of length, exceeds at the reference vertex what it is at the
// pixel that this has been rounded to.
fn rounded_by(reference: Reference, rate: vec2<f32>) -> f32 {
    return dot(rate, reference.rest) * view.pixel * select(reference.depth, 1.0, ORTHOGRAPHIC);
}
