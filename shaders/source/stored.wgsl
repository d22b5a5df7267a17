// Projected cells as a compute stage has stored them.
import package::lib::cell::{Cell};

@group(1) @binding(1) var<storage, read> projected: array<Cell>;

fn projected_cell(i: u32) -> Cell {
    return projected[i];
}
