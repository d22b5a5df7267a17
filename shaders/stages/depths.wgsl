// Keys that sort the cells of the order by their centroids, nearest first.
import package::lib::view::{view, frame_of, ORTHOGRAPHIC};
import package::lib::mesh_buffers::{points, cells};
import package::lib::mesh::{order};

@group(1) @binding(1) var<storage, read_write> keys: array<u32>;

@compute @workgroup_size(64)
fn depths(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    for (var i = id.x; i < arrayLength(&order); i += 64u * groups.x) {
        let names = cells[order[i]] & vec4<u32>(0x7fffffffu, 0xffffffffu, 0xffffffffu, 0xffffffffu);
        var sum = 4.0 * vec3<f32>(view.right.w, view.down.w, view.forward.w);
        for (var k = 0u; k < 4u; k++) {
            sum += frame_of(points[names[k]].xyz);
        }
        // Distances ascend as their squares do, and depths may be negative.
        let bits = bitcast<u32>(select(dot(sum, sum), sum.z, ORTHOGRAPHIC));
        keys[i] = select(bits | 0x80000000u, ~bits, (bits & 0x80000000u) != 0u);
    }
}
