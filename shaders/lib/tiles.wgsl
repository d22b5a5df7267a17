// Which tiles of the picture a cell may be seen in.
//
// A cell is covered by its silhouette with a margin, as it is for a rasteriser (lib::silhouette): a convex quadrilateral or
// triangle. Its half-planes tell which rectangles of pixel centres it may reach into; pixels that it does not hold after
// all are found out by their segments, so that a tile too many costs time and changes nothing.
import package::lib::view::{Vertex, view};
import package::lib::cell::{Cell, HIDDEN};
import package::lib::silhouette::{cross2, silhouette_corner};

// Pixels on a tile's side.
const TILE = 16u;

struct Footprint {
    // In cyclic order, in pixels from the picture's top left corner; of a triangle the last twice.
    corners: array<vec2<f32>, 4>,
    // The first pixel in x and in y whose centre may be inside, and one past the last; zero if none is.
    first: vec2<u32>,
    end: vec2<u32>,
}

fn footprint(cell: Cell, v: array<Vertex, 4>) -> Footprint {
    var result: Footprint;
    if cell.rise.w == HIDDEN {
        return result;
    }
    for (var k = 0u; k < 4u; k++) {
        result.corners[k] = silhouette_corner(cell, v, k) + view.size * 0.5;
    }
    let c = result.corners;
    // The outermost pixels whose centres lie between the outermost corners.
    let first = ceil(max(min(min(c[0], c[1]), min(c[2], c[3])) - 0.5, vec2<f32>(0.0)));
    let last = floor(min(max(max(c[0], c[1]), max(c[2], c[3])) - 0.5, view.size - 1.0));
    if all(first <= last) {
        result.first = vec2<u32>(first);
        result.end = vec2<u32>(last) + 1u;
    }
    return result;
}

// Whether a convex outline may hold any pixel centre of a rectangle of pixels of some size from the pixel `first`, which its
// bounds meet.
fn reaches(corners: array<vec2<f32>, 4>, first: vec2<u32>, size: vec2<u32>) -> bool {
    let low = vec2<f32>(first) + 0.5;
    let high = low + vec2<f32>(size - 1u);
    let c = corners;
    let diagonal = c[2] - c[0];
    let turn = sign(cross2(c[1] - c[0], diagonal) + cross2(diagonal, c[3] - c[0]));
    for (var k = 0u; k < 4u; k++) {
        let edge = (c[(k + 1u) & 3u] - c[k]) * turn;
        // The centre farthest to the inner side of the edge.
        let inmost = select(low, high, vec2<bool>((edge.y < 0.0), (edge.x > 0.0)));
        if cross2(edge, inmost - c[k]) < 0.0 {
            return false;
        }
    }
    return true;
}
