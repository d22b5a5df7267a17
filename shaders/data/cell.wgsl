// Scalars belong to cells.
@group(0) @binding(4) var<storage, read> cell_scalars: array<f32>;

// The scalars of a cell at its vertices.
fn scalars_of(cell: u32, names: vec4<u32>) -> vec4<f32> {
    return vec4<f32>(cell_scalars[cell]);
}
