// Draws cells that have no order among themselves, in a cycle or overlapping: every pixel composites its segments by
// the depths of their middles, nearest first (Kraus and Ertl 2001). Meant for few cells: a pixel looks at all of them
// once for each segment.
import package::lib::view::{view};
import package::lib::mesh::{batch, corners};
import package::lib::cell::{HIDDEN, cell_reference};
import package::lib::prepared::{Hit, FAR, prepared, color_through, hit_of, next_behind};
import package::axes::source::{projected_cell};
import package::axes::output::{stored};

@vertex
fn cover(@builtin(vertex_index) vertex: u32) -> @builtin(position) vec4<f32> {
    // One triangle over the whole picture.
    return vec4<f32>(f32(vertex & 1u) * 4.0 - 1.0, f32(vertex >> 1u) * 4.0 - 1.0, 0.5, 1.0);
}

@fragment
fn color(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    let at = position.xy - view.size * 0.5;
    var sum = vec4<f32>(0.0);
    var last = Hit(-FAR, 0u);
    for (var n = 0u; n < batch.count; n++) {
        var next = Hit(FAR, 0u);
        for (var i = 0u; i < batch.count; i++) {
            let cell = projected_cell(i);
            if cell.rise.w == HIDDEN {
                continue;
            }
            let c = corners(i);
            let reference = cell_reference(c.vertices, c.scalars, cell.rise.w);
            next = next_behind(last, next, hit_of(cell.planes, reference, i, at));
        }
        if next.depth >= FAR {
            break;
        }
        sum += (1.0 - sum.w) * color_through(prepared(next.cell), at);
        last = next;
    }
    return stored(sum, position.xy, batch.last);
}
