// Segments of cells that are projected where they are drawn: of those that are not interpolated, and beside edges of those
// that are.
import package::lib::mesh::{corners};
import package::lib::cell::{project_cell, cell_reference};
import package::lib::span::{Segment};
import package::lib::ray::{cell_segment};
import package::axes::quantity::{linear_in};

// The segment that the ray through `at`, in pixels from the picture's middle, has in the i-th cell of the batch.
fn whole_segment(i: u32, at: vec2<f32>) -> Segment {
    let c = corners(i);
    let cell = project_cell(c.vertices, c.scalars, c.parity);
    let reference = cell_reference(c.vertices, c.scalars, cell.rise.w);
    return cell_segment(cell.planes, linear_in(cell, reference, c), reference, at);
}
