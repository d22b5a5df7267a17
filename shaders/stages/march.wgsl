// Every pixel walks along its ray from cell to cell through the faces between them (Garrity 1990; Weiler et al. 2003), front
// to back, and composites in registers: no order of the cells and no blending are needed.
//
// Where its ray comes in from outside, each pixel has a list of faces, nearest first; from each it walks until it is
// outside again. Neither holes nor several bodies need a search, nor does an eye inside: its rays come in behind it.
import package::lib::view::{view, frame_of};
import package::lib::mesh_buffers::{points, cells};
import package::lib::span::{Segment};
import package::lib::no_data::{NO_DATA};
import package::lib::walk::{Ray, Corner, ray_through, offset_from, depth_at, turns, area, place_of, volume_of, way_through};
import package::axes::quantity::{quantity_at, in_cell};
import package::axes::shading::{pieces_between, shade};
import package::axes::surface::{cut, is_hidden};

struct March {
    // A pixel of this alpha is done.
    opaque: f32,
    // Steps after which a walk ends, come what may: the number of cells.
    steps: u32,
    unused: vec2<u32>,
}

@group(1) @binding(0) var<uniform> march: March;
// The cell across the face opposite each vertex, vertices in ascending order; NONE if there is no cell to draw.
@group(1) @binding(1) var<storage, read> neighbors: array<vec4<u32>>;
// Where each pixel's list of entries begins; one more for the end of the last.
@group(1) @binding(2) var<storage, read> starts: array<u32>;
// Four times a cell plus the vertex opposite the face.
@group(1) @binding(3) var<storage, read> entries: array<u32>;
@group(1) @binding(4) var picture: texture_storage_2d<rgba32float, write>;

const NONE = 0xffffffffu;

fn corner_of(ray: Ray, cell: u32, name: u32) -> Corner {
    let position = points[name].xyz;
    let frame = frame_of(position);
    return Corner(name, position, offset_from(ray, frame), dot(ray.along, frame), quantity_at(cell, name));
}

// The triangle through which the ray leaves the cell between the triangle abc, through which it came in, and an apex: the
// vertex that is left out, as 0, 1 or 2. The vertices of abc surround the ray from x towards y.
fn left_out(a: Corner, b: Corner, c: Corner, apex: Corner) -> u32 {
    let t = vec3<bool>(turns(apex, a), turns(apex, b), turns(apex, c));
    if t.x && !t.y {
        return 2u;
    }
    if t.y && !t.z {
        return 0u;
    }
    if t.z && !t.x {
        return 1u;
    }
    // No triangle surrounds the ray, by rounding: the one seen largest.
    let s = vec3<f32>(area(apex, a), area(apex, b), area(apex, c));
    let seen = vec3<f32>(area(b, c) + s.y - s.z, area(c, a) + s.z - s.x, area(a, b) + s.x - s.y);
    return select(select(2u, 1u, seen.y >= seen.z), 0u, seen.x >= max(seen.y, seen.z));
}

// The place of a name among four.
fn index_of(names: vec4<u32>, name: u32) -> u32 {
    return select(select(select(3u, 2u, names.z == name), 1u, names.y == name), 0u, names.x == name);
}

fn names_of(cell: u32) -> vec4<u32> {
    return cells[cell] & vec4<u32>(0x7fffffffu, 0xffffffffu, 0xffffffffu, 0xffffffffu);
}

@compute @workgroup_size(8, 8)
fn walk(@builtin(global_invocation_id) id: vec3<u32>) {
    let size = vec2<u32>(view.size);
    if id.x >= size.x || id.y >= size.y {
        return;
    }
    let at = vec2<f32>(id.xy) + 0.5 - view.size * 0.5;
    let ray = ray_through(at);
    let near = ((view.near - view.forward.w) - ray.depth.y) / ray.depth.x;
    // Scalars are normalised to [0, 1], and those of cells without data lie beyond.
    let range = pieces_between(0.0, NO_DATA, 0u);
    let pixel = id.y * size.x + id.x;
    var color = vec4<f32>(0.0);
    for (var e = starts[pixel]; e < starts[pixel + 1u] && color.a < march.opaque; e++) {
        var cell = entries[e] >> 2u;
        let face = entries[e] & 3u;
        var names = names_of(cell);
        var a = corner_of(ray, cell, names[select(0u, 1u, face == 0u)]);
        var b = corner_of(ray, cell, names[select(1u, 2u, face <= 1u)]);
        var c = corner_of(ray, cell, names[select(2u, 3u, face <= 2u)]);
        // Faces opposite vertices 0 and 2 have their ascending normal outward if the cell is positive.
        if ((face & 1u) == 0u) != ((cells[cell].x & 0x80000000u) != 0u) {
            let other = b;
            b = c;
            c = other;
        }
        var front = place_of(a, b, c);
        if is_hidden(depth_at(ray, front.distance), at) {
            break;
        }
        var is_over = false;
        for (var n = 0u; n < march.steps; n++) {
            let apex_name = names.x ^ names.y ^ names.z ^ names.w ^ a.name ^ b.name ^ c.name;
            let apex = corner_of(ray, cell, apex_name);
            let out = left_out(a, b, c, apex);
            let volume = volume_of(a, b, c, apex);
            var dropped = c.name;
            if out == 0u {
                dropped = a.name;
                a = b;
                b = c;
            } else if out == 1u {
                dropped = b.name;
                b = a;
                a = c;
            }
            c = apex;
            let next = neighbors[cell][index_of(names, dropped)];
            var back = place_of(a, b, c);
            let way = way_through(ray, volume, area(a, b), front, back);
            // Rounding alone makes the ray turn back: then it stays where it is.
            if way > 0.0 {
                back.distance = max(back.distance, front.distance);
                let begin = clamp((near - front.distance) / way, 0.0, 1.0);
                let start = max(front.distance, near);
                var segment: Segment;
                segment.length = select(way, back.distance - near, front.distance < near);
                segment.at = at;
                segment.front = in_cell(front.value + begin * (back.value - front.value), cell);
                segment.back = in_cell(back.value, cell);
                segment = cut(segment, vec2<f32>(depth_at(ray, start), depth_at(ray, back.distance)), at);
                if segment.length > 0.0 {
                    color += (1.0 - color.a) * shade(range, segment);
                }
                front = back;
            }
            front.area = back.area;
            if next == NONE || color.a >= march.opaque || is_hidden(depth_at(ray, front.distance), at) {
                is_over = true;
                break;
            }
            cell = next;
            names = names_of(cell);
        }
        if !is_over {
            // No walk takes so many steps: the driver has ended the loop. The host is told.
            color.a = -1.0;
            break;
        }
    }
    textureStore(picture, id.xy, color);
}
