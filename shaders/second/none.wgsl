// There is no second scalar.

// Whether the second scalar is the same throughout a cell.
const SECOND_CELLWISE = false;

// The second scalars of a cell at its vertices.
fn seconds_of(cell: u32, names: vec4<u32>) -> vec4<f32> {
    return vec4<f32>(0.0);
}

// The second scalar of a cell at one of its vertices.
fn second_of(cell: u32, name: u32) -> f32 {
    return 0.0;
}
