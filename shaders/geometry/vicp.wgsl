// View-independent cell projection (Weiler et al. 2003): the front faces are rasterised, and every fragment intersects its
// ray with the planes of the other faces to find the end of its segment.
//
// Published, the rasterised depth is the front end. Rasterisers round vertices, so that a fragment beside an edge may be of
// the wrong face or, next to a face seen edge-on, of the wrong cell. Here each face is drawn with a margin, and a fragment
// counts only if its ray enters the cell through this face's plane: of one cell never two do.
import package::lib::view::{view};
import package::lib::mesh::{corners};
import package::lib::cell::{Cell, HIDDEN, DEEP};
import package::lib::silhouette::{silhouette_corner, face_corner};
import package::lib::span::{Segment};
import package::lib::ray::{crossings};
import package::lib::flat::{FlatFragment, flat_fragment, flat_segment, flat_planes, nowhere};

@group(1) @binding(1) var<storage, read> projected: array<Cell>;

alias Fragment = FlatFragment;

// In place of a face: all of the cell, drawn as its silhouette.
const WHOLE = 4u;

// Whether no face need be where the ray's visible part begins: the eye may be inside, or rounding has made all faces of a
// sliver back faces.
fn is_whole(cell: Cell) -> bool {
    let front = max(max(cell.planes[0].w, cell.planes[1].w), max(cell.planes[2].w, cell.planes[3].w));
    return cell.rise.w == DEEP || front <= 0.0;
}

fn place(vertex_index: u32, instance_index: u32) -> Fragment {
    let i = vertex_index / 12u;
    let face = vertex_index % 12u / 3u;
    let cell = projected[i];
    if cell.rise.w == HIDDEN {
        return nowhere();
    }
    if is_whole(cell) {
        if face > 1u {
            return nowhere();
        }
        let c = corners(i);
        let k = array<u32, 6>(0u, 1u, 2u, 0u, 2u, 3u)[vertex_index % 12u];
        return flat_fragment(silhouette_corner(cell, c.vertices, k), i, cell, c, WHOLE);
    }
    if cell.planes[face].w <= 0.0 {
        return nowhere();
    }
    let c = corners(i);
    return flat_fragment(face_corner(c.vertices, face, vertex_index % 3u), i, cell, c, face);
}

// The front face that a ray meets last: the one that it enters the cell through.
fn entry_face(planes: array<vec4<f32>, 4>, origins: vec4<f32>, at: vec2<f32>) -> u32 {
    let met = crossings(planes, origins, at);
    var entry = WHOLE;
    var least = 0.0;
    for (var i = 0u; i < 4u; i++) {
        if planes[i].w > 0.0 && (entry == WHOLE || met.beyond[i] < least) {
            entry = i;
            least = met.beyond[i];
        }
    }
    return entry;
}

fn segment_in(fragment: Fragment) -> Segment {
    let face = fragment.pieces_entry.w;
    let at = fragment.position.xy - view.size * 0.5;
    if face != WHOLE && face != entry_face(flat_planes(fragment), fragment.origins, at) {
        var none: Segment;
        return none;
    }
    return flat_segment(fragment);
}
