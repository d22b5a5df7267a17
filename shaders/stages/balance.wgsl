// The vertices' share of balanced cell projection, for the cells of a batch: one invocation a cell.
import package::lib::view::{view, ORTHOGRAPHIC, deeper};
import package::lib::mesh::{batch, corners};
import package::lib::cell::{HIDDEN, DEEP, STEEPEST, project_cell, cell_reference};
import package::lib::silhouette::{NARROW, outline, outline_extent, is_movable};
import package::lib::balanced::{Balanced, balanced_fronts};

@group(1) @binding(1) var<storage, read_write> projected: array<Balanced>;

@compute @workgroup_size(64)
fn balance(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= batch.count {
        return;
    }
    let c = corners(id.x);
    let cell = project_cell(c.vertices, c.scalars, c.parity);
    let kind = cell.gradient.w;
    var balanced: Balanced;
    if kind == HIDDEN {
        projected[id.x] = balanced;
        return;
    }
    let reference = cell_reference(c.vertices, c.scalars, kind);
    var nearest = STEEPEST;
    for (var k = 0u; k < 4u; k++) {
        let v = c.vertices[k];
        let plane = cell.planes[k];
        let from_origin = (v.pixel - select(reference.origins.xy, reference.origins.zw, k == 0u)) + v.rest;
        let here = deeper(v, c.vertices[0]);
        let there = dot(plane.xy, from_origin) + plane.z;
        var distance = here - there;
        var scalar = c.scalars[k] + cell.gradient.z * distance;
        if !ORTHOGRAPHIC {
            distance = (here / v.eye.z - there) / reference.depth;
            scalar = c.scalars[k] * (1.0 / v.eye.z - distance) + dot(cell.gradient.xyz, v.eye) * distance;
        }
        // The plane knows which side it is seen from.
        let is_front = plane.w > 0.0;
        distance = clamp(distance, select(0.0, -STEEPEST, is_front), select(STEEPEST, -1e-30, is_front));
        balanced.distances[k] = distance;
        balanced.scalars[k] = clamp(scalar, -STEEPEST, STEEPEST);
        nearest = min(nearest, v.eye.z);
    }
    let v = c.vertices;
    let o = outline(balanced_fronts(balanced), array<vec2<f32>, 4>(v[0].pixel, v[1].pixel, v[2].pixel, v[3].pixel));
    if kind == DEEP || nearest < view.near || !is_movable(o, outline_extent(o), NARROW) {
        balanced.distances = vec4<f32>(-1.0);
    }
    projected[id.x] = balanced;
}
