// Balanced cell projection (Moreland and Angel 2004, section 3.1): at each vertex the distances to all faces along its ray
// and the scalars there, as two four-tuples; they are interpolated over the front faces, and a fragment takes the nearest.
// The tuples are the same for all faces at a vertex, so that four vertices a cell are drawn by index. All but one of their
// members are the vertex's own: in a face the distance to it is none and the scalar its own.
//
// Published are Euclidean distances and plain scalars, which are not linear in a perspective picture: here they are inverse
// depths and scalars times these, which are. Rasterisers round vertices: front faces are drawn a little too large, and
// fragments interpolate from the vertices' own places (lib::triangle). Where a pixel's centre lies beyond the face, the
// distances to the other front faces tell, and the segment begins at the farthest.
import package::lib::view::{Seen, view, ORTHOGRAPHIC, rest_of};
import package::lib::mesh::{corners, entry_of, seen_corners};
import package::lib::cell::{project_cell};
import package::lib::silhouette::{SLIGHT, outline, moved_corner, silhouette_corner};
import package::lib::span::{Segment};
import package::lib::triangle::{shares_of};
import package::lib::whole::{whole_segment};
import package::lib::balanced::{Balanced, balanced_fronts};
import package::axes::shading::{pieces_between};
import package::axes::surface::{cut};

@group(1) @binding(1) var<storage, read> projected: array<Balanced>;

struct Fragment {
    @builtin(position) position: vec4<f32>,
    // The pixel of vertex 0, as two summands: the origin of places.
    @location(0) @interpolate(flat) origin: vec4<f32>,
    // The places of vertices 1 and 2, and of vertex 3 with the smallest and the largest scalar.
    @location(1) @interpolate(flat) places: vec4<f32>,
    @location(2) @interpolate(flat) place_range: vec4<f32>,
    // Inverse depths (orthographic: depths from the pivot) of the vertices, and their scalars times these (their scalars).
    @location(3) @interpolate(flat) inverse: vec4<f32>,
    @location(4) @interpolate(flat) own: vec4<f32>,
    // The same where their rays meet the faces opposite: by how much the inverse depths are less, and the scalars.
    @location(5) @interpolate(flat) distances: vec4<f32>,
    @location(6) @interpolate(flat) scalars: vec4<f32>,
    // The pieces of the transfer function that the cell's scalars meet, and the cell's place in the order.
    @location(7) @interpolate(flat) pieces_entry: vec3<u32>,
    // A bit for each front face, all if the cell is drawn as a whole; the face that is drawn; and the cell's place in the
    // batch.
    @location(8) @interpolate(flat) fronts_face_cell: vec3<u32>,
}

const WHOLE = 15u;

fn place(vertex_index: u32, instance_index: u32) -> Fragment {
    let i = vertex_index / 4u;
    let balanced = projected[i];
    var fragment: Fragment;
    if all(balanced.distances == vec4<f32>(0.0)) {
        // Outside the clip volume: nothing is drawn.
        fragment.position = vec4<f32>(2.0, 2.0, 2.0, 1.0);
        return fragment;
    }
    let seen = seen_corners(i);
    // Positively oriented in any case.
    let slot = vertex_index % 4u;
    let k = select(slot, array<u32, 4>(0u, 1u, 3u, 2u)[slot], seen.parity < 0.0);
    let s = seen.scalars;
    let p = seen.points;
    let range = vec2<f32>(min(min(s.x, s.y), min(s.z, s.w)), max(max(s.x, s.y), max(s.z, s.w)));
    let entry = entry_of(i);
    let fronts = balanced_fronts(balanced);
    fragment.pieces_entry = vec3<u32>(pieces_between(range.x, range.y, entry), entry);
    // The first vertex of a face speaks for it; each is the first of one.
    var face = array<u32, 4>(2u, 0u, 3u, 1u)[slot];
    face = select(face, array<u32, 4>(0u, 1u, 3u, 2u)[face], seen.parity < 0.0);
    fragment.fronts_face_cell = vec3<u32>(fronts, face, i);
    var at = p[k].pixel;
    if fronts == WHOLE {
        // A quadrilateral: of its two halves, each drawn either way round, culling leaves one each.
        let c = corners(i);
        at = silhouette_corner(project_cell(c.vertices, c.scalars, c.parity), c.vertices, slot);
    } else {
        let o = outline(fronts, array<vec2<f32>, 4>(p[0].pixel, p[1].pixel, p[2].pixel, p[3].pixel));
        for (var n = 0u; n < o.count; n++) {
            if o.names[n] == k {
                at = moved_corner(o, n, SLIGHT);
            }
        }
        fragment.origin = vec4<f32>(p[0].pixel, rest_of(p[0]));
        fragment.places = vec4<f32>(place_from(p[0], p[1]), place_from(p[0], p[2]));
        fragment.place_range = vec4<f32>(place_from(p[0], p[3]), range);
        let depths = vec4<f32>(p[0].depth, p[1].depth, p[2].depth, p[3].depth);
        if ORTHOGRAPHIC {
            let v = corners(i).vertices;
            fragment.inverse = vec4<f32>(v[0].frame.z, v[1].frame.z, v[2].frame.z, v[3].frame.z);
            fragment.own = s;
        } else {
            fragment.inverse = 1.0 / depths;
            fragment.own = s * fragment.inverse;
        }
        fragment.distances = balanced.distances;
        fragment.scalars = balanced.scalars;
    }
    fragment.position = vec4<f32>(at.x * 2.0 / view.size.x, -at.y * 2.0 / view.size.y, 0.5, 1.0);
    return fragment;
}

fn place_from(origin: Seen, point: Seen) -> vec2<f32> {
    return (point.pixel - origin.pixel) + (rest_of(point) - rest_of(origin));
}

fn segment_in(fragment: Fragment) -> Segment {
    let at = fragment.position.xy - view.size * 0.5;
    let fronts = fragment.fronts_face_cell.x;
    let face = fragment.fronts_face_cell.y;
    let p = array<vec2<f32>, 4>(vec2<f32>(0.0), fragment.places.xy, fragment.places.zw, fragment.place_range.xy);
    let a = select(0u, 1u, face == 0u);
    let b = select(1u, 2u, face <= 1u);
    let c = select(2u, 3u, face <= 2u);
    let found = shares_of((at - fragment.origin.xy) - fragment.origin.zw, p[a], p[b], p[c]);
    if fronts == WHOLE || max(found.x, max(found.y, found.z)) < 0.0 {
        return whole_segment(fragment.fronts_face_cell.z, at);
    }
    // Of all vertices; the one opposite has none.
    var shares = vec4<f32>(0.0);
    shares[a] = found.x;
    shares[b] = found.y;
    shares[c] = found.z;
    let front = vec2<f32>(dot(shares, fragment.inverse), dot(shares, fragment.own));
    // How far the ray's ends lie behind the face that is drawn, and the scalars there.
    var begin = vec2<f32>(0.0, front.y);
    var end = vec2<f32>(1e30, 0.0);
    for (var k = 0u; k < 4u; k++) {
        if k == face {
            continue;
        }
        let here = vec2<f32>(
            shares[k] * fragment.distances[k],
            front.y + shares[k] * (fragment.scalars[k] - fragment.own[k]),
        );
        if (fronts >> k & 1u) == 1u {
            if here.x > begin.x {
                begin = here;
            }
        } else if here.x < end.x {
            end = here;
        }
    }
    var segment: Segment;
    if !(end.x > begin.x) {
        return segment;
    }
    segment.at = at;
    var ends = front.x + vec2<f32>(begin.x, end.x);
    if ORTHOGRAPHIC {
        segment.length = end.x - begin.x;
        segment.front = begin.y;
        segment.back = end.y;
    } else {
        let near = front.x - begin.x;
        let far = max(front.x - end.x, 1e-30);
        segment.length = length(vec3<f32>(at * view.pixel, 1.0)) * (end.x - begin.x) / (near * far);
        segment.front = begin.y / near;
        segment.back = end.y / far;
        ends = vec2<f32>(1.0 / near, 1.0 / far) - view.forward.w;
    }
    segment.front = clamp(segment.front, fragment.place_range.z, fragment.place_range.w);
    segment.back = clamp(segment.back, fragment.place_range.z, fragment.place_range.w);
    return cut(segment, ends, at);
}
