// Scalars belong to cells.
@group(0) @binding(4) var<storage, read> cell_scalars: array<f32>;

// Whether a scalar is the same throughout a cell.
fn has_own(cell: u32) -> bool {
    return true;
}

// The scalar throughout such a cell.
fn own_scalar(cell: u32) -> f32 {
    return cell_scalars[cell];
}

// The scalars of a cell at its vertices.
fn scalars_of(cell: u32, names: vec4<u32>) -> vec4<f32> {
    return vec4<f32>(cell_scalars[cell]);
}

// The scalar of a cell at one of its vertices.
fn scalar_of(cell: u32, name: u32) -> f32 {
    return cell_scalars[cell];
}
