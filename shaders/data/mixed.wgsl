// Scalars belong to points, but for cells without data: these have one of their own, beyond all others.
import package::lib::mesh_buffers::{points};

@group(0) @binding(4) var<storage, read> cell_scalars: array<f32>;

// Whether a scalar is the same throughout a cell.
fn has_own(cell: u32) -> bool {
    return cell_scalars[cell] >= 0.0;
}

// The scalar throughout such a cell.
fn own_scalar(cell: u32) -> f32 {
    return cell_scalars[cell];
}

// The scalars of a cell at its vertices.
fn scalars_of(cell: u32, names: vec4<u32>) -> vec4<f32> {
    if has_own(cell) {
        return vec4<f32>(own_scalar(cell));
    }
    return vec4<f32>(points[names.x].w, points[names.y].w, points[names.z].w, points[names.w].w);
}

// The scalar of a cell at one of its vertices; of no use where it has its own.
fn scalar_of(cell: u32, name: u32) -> f32 {
    return points[name].w;
}
