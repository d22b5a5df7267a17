// Scalars belong to points.
import package::lib::mesh_buffers::{points};

// Whether a scalar is the same throughout a cell.
fn has_own(cell: u32) -> bool {
    return false;
}

// The scalar throughout such a cell.
fn own_scalar(cell: u32) -> f32 {
    return 0.0;
}

// The scalars of a cell at its vertices.
fn scalars_of(cell: u32, names: vec4<u32>) -> vec4<f32> {
    return vec4<f32>(points[names.x].w, points[names.y].w, points[names.z].w, points[names.w].w);
}

// The scalar of a cell at one of its vertices.
fn scalar_of(cell: u32, name: u32) -> f32 {
    return points[name].w;
}
