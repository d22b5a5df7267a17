// The vertices' share of balanced cell projection, for the cells of a batch: one invocation a cell.
import package::lib::view::{view, ORTHOGRAPHIC};
import package::lib::mesh::{batch, corners};
import package::lib::cell::{HIDDEN, DEEP, STEEPEST, cell_kind, cell_reference, leaning, rise_of};
import package::lib::silhouette::{NARROW, outline, outline_extent, is_movable};
import package::lib::balanced::{Balanced, balanced_fronts};

@group(1) @binding(1) var<storage, read_write> projected: array<Balanced>;

@compute @workgroup_size(64)
fn balance(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= batch.count {
        return;
    }
    let c = corners(id.x);
    let v = c.vertices;
    let z = vec4<f32>(v[0].eye.z, v[1].eye.z, v[2].eye.z, v[3].eye.z);
    let kind = cell_kind(z);
    var balanced: Balanced;
    if kind == HIDDEN {
        projected[id.x] = balanced;
        return;
    }
    let is_near = kind == DEEP || min(min(z.x, z.y), min(z.z, z.w)) < view.near;
    if is_near {
        balanced.distances = vec4<f32>(-1.0);
        projected[id.x] = balanced;
        return;
    }
    let seen = leaning(v, kind, c.parity);
    let reference = cell_reference(v, c.scalars, kind);
    let rise = rise_of(seen, c.scalars - reference.scalar);
    for (var k = 0u; k < 4u; k++) {
        // The plane knows which side it is seen from.
        let is_front = seen.planes[k].w > 0.0;
        var distance = select(seen.heights[k], -seen.heights[k], is_front);
        var scalar = c.scalars[k] + rise.z * distance;
        if !ORTHOGRAPHIC {
            distance /= z[k];
            // Along a ray the scalar over the depth is linear in the inverse depth.
            scalar = c.scalars[k] / z[k] - (reference.scalar - rise.z) * distance;
        }
        distance = clamp(distance, select(0.0, -STEEPEST, is_front), select(STEEPEST, -1e-30, is_front));
        balanced.distances[k] = distance;
        balanced.scalars[k] = clamp(scalar, -STEEPEST, STEEPEST);
    }
    let o = outline(balanced_fronts(balanced), array<vec2<f32>, 4>(v[0].pixel, v[1].pixel, v[2].pixel, v[3].pixel));
    if !is_movable(o, outline_extent(o), NARROW) {
        balanced.distances = vec4<f32>(-1.0);
    }
    projected[id.x] = balanced;
}
