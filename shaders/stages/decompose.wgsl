// Decomposes the cells of a batch: one invocation a cell.
import package::lib::mesh::{batch, corners, entry_of};
import package::lib::cell::{Cell};
import package::lib::thick::{decompose};

@group(1) @binding(1) var<storage, read_write> projected: array<Cell>;

@compute @workgroup_size(64)
fn decompose_batch(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= batch.count {
        return;
    }
    projected[id.x] = decompose(corners(id.x), entry_of(id.x));
}
