// The second scalar belongs to cells.
@group(0) @binding(8) var<storage, read> seconds: array<f32>;

// Whether the second scalar is the same throughout a cell.
const SECOND_CELLWISE = true;

// The second scalars of a cell at its vertices.
fn seconds_of(cell: u32, names: vec4<u32>) -> vec4<f32> {
    return vec4<f32>(seconds[cell]);
}

// The second scalar of a cell at one of its vertices.
fn second_of(cell: u32, name: u32) -> f32 {
    return seconds[cell];
}
