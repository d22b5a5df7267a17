// Projects the cells of a batch: one invocation a cell.
import package::lib::mesh::{batch, corners};
import package::lib::cell::{Cell, project_cell};

@group(1) @binding(1) var<storage, read_write> projected: array<Cell>;

@compute @workgroup_size(64)
fn project(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= batch.count {
        return;
    }
    let c = corners(id.x);
    projected[id.x] = project_cell(c.vertices, c.scalars, c.parity);
}
