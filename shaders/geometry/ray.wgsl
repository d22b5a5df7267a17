// Each fragment finds its own segment from the planes of the cell's faces: nothing is interpolated, so nothing depends
// on how a rasteriser rounds vertices. One or two triangles cover the cell's silhouette with a margin.
import package::lib::mesh::{corners};
import package::lib::cell::{Cell, HIDDEN};
import package::lib::silhouette::{silhouette_corner};
import package::lib::span::{Segment};
import package::lib::flat::{FlatFragment, flat_fragment, flat_segment, nowhere};

@group(1) @binding(1) var<storage, read> projected: array<Cell>;

alias Fragment = FlatFragment;

fn place(vertex_index: u32, instance_index: u32) -> Fragment {
    let i = vertex_index / 6u;
    let cell = projected[i];
    if cell.rise.w == HIDDEN {
        return nowhere();
    }
    let c = corners(i);
    // Two triangles of a quadrilateral.
    let k = array<u32, 6>(0u, 1u, 2u, 0u, 2u, 3u)[vertex_index % 6u];
    return flat_fragment(silhouette_corner(cell, c.vertices, k), i, cell, c, 0u);
}

fn segment_in(fragment: Fragment) -> Segment {
    return flat_segment(fragment);
}
