// Where a ray crosses triangles, told by areas.
//
// Seen along the ray, that is in the oblique projection along it, a vertex has an offset from the ray, and the ray crosses
// a triangle if the offsets of its vertices surround the origin. The sign of the area between two offsets is one
// comparison of two products of the vertices' own numbers: all triangles at an edge agree on which side of it the ray
// passes, so that no ray is lost between them. Areas also give the coordinates of the crossing in the triangle, in space
// and not only in the picture, wherever the vertices lie, even behind the eye.
//
// The twin in Rust is tetlux-render, march.
import package::lib::view::{view, ORTHOGRAPHIC};
import package::lib::cell::{NUDGE, face_normal};
import package::axes::quantity::{Quantity};

// Projected is onto two axes of eye space, along the third, which is the ray's main one: a ray far aside in a wide view
// passes all of the mesh at next to no depth.
struct Ray {
    // A product with a position relative to the pivot is the position's offset.
    right: vec3<f32>,
    down: vec3<f32>,
    // Offset of the pivot.
    pivot: vec2<f32>,
    // The product with a position is the distance along the ray at which it is passed.
    along: vec3<f32>,
    // Depth from the pivot is the distance times the first plus the second.
    depth: vec2<f32>,
}

// A vertex as a ray sees it.
struct Corner {
    name: u32,
    // As the mesh has it: differences of these are exact to their own last digit.
    position: vec3<f32>,
    offset: vec2<f32>,
    // Distance along the ray, in device units, from where the pivot is passed.
    distance: f32,
    value: Quantity,
}

// The ray through a place in pixels from the picture's middle.
fn ray_through(at: vec2<f32>) -> Ray {
    let aside = at * view.pixel;
    let eye = vec3<f32>(view.right.w, view.down.w, view.forward.w);
    if ORTHOGRAPHIC {
        let x = vec3<f32>(1.0, 0.0, 0.0);
        let y = vec3<f32>(0.0, 1.0, 0.0);
        return Ray(x, y, eye.xy - aside, vec3<f32>(0.0, 0.0, 1.0), vec2<f32>(1.0, 0.0));
    }
    let direction = vec3<f32>(aside, 1.0);
    // The axes x, y and z in turn, so that x and y still turn the same way about the ray.
    var x = vec3<f32>(1.0, 0.0, 0.0);
    var y = vec3<f32>(0.0, 1.0, 0.0);
    var z = vec3<f32>(0.0, 0.0, 1.0);
    if max(abs(aside.x), abs(aside.y)) > 1.0 {
        let old = z;
        if abs(aside.x) >= abs(aside.y) {
            z = x;
            x = y;
            y = old;
        } else {
            z = y;
            y = x;
            x = old;
        }
        if dot(z, direction) < 0.0 {
            let other = x;
            x = y;
            y = other;
            z = -z;
        }
    }
    let per_main = 1.0 / dot(z, direction);
    let right = x - z * (dot(x, direction) * per_main);
    let down = y - z * (dot(y, direction) * per_main);
    let pivot = vec2<f32>(dot(right, eye), dot(down, eye));
    let stretch = length(direction);
    let depth = vec2<f32>(1.0 / stretch, -(x.z * pivot.x + y.z * pivot.y));
    return Ray(right, down, pivot, z * (stretch * per_main), depth);
}

// The offset of a position relative to the pivot, in the axes of eye space.
fn offset_from(ray: Ray, frame: vec3<f32>) -> vec2<f32> {
    return vec2<f32>(dot(ray.right, frame), dot(ray.down, frame)) + ray.pivot;
}

// Depth from the pivot of the ray's point at a distance.
fn depth_at(ray: Ray, distance: f32) -> f32 {
    return distance * ray.depth.x + ray.depth.y;
}

// Whether the way from a to b turns from x towards y about the ray: exactly one of (a, b) and (b, a) does. Where the ray
// meets the edge, as if it were moved aside by next to nothing, in a direction that no edge of a grid has.
fn turns(a: Corner, b: Corner) -> bool {
    let left = a.offset.x * b.offset.y;
    let right = a.offset.y * b.offset.x;
    if left != right {
        return left > right;
    }
    let along = NUDGE * (a.offset - b.offset).yx;
    if along.x != along.y {
        return along.x > along.y;
    }
    return a.name < b.name;
}

fn area(a: Corner, b: Corner) -> f32 {
    return a.offset.x * b.offset.y - a.offset.y * b.offset.x;
}

// Of a triangle that the ray crosses the coordinates of the crossing along the edges from the first vertex to the others.
// The first should be opposite the longest edge: the longer two edges of a sliver are nearly parallel, and cancel. A
// triangle that is seen edge-on is crossed in its middle.
fn crossing(a: Corner, b: Corner, c: Corner) -> vec2<f32> {
    let ab = b.offset - a.offset;
    let ac = c.offset - a.offset;
    let whole = ab.x * ac.y - ab.y * ac.x;
    if !(whole > 0.0) {
        return vec2<f32>(1.0 / 3.0);
    }
    let parts = vec2<f32>(ac.x * a.offset.y - ac.y * a.offset.x, ab.y * a.offset.x - ab.x * a.offset.y);
    let along = clamp(parts / max(whole, 1e-37), vec2<f32>(0.0), vec2<f32>(1.0));
    return vec2<f32>(along.x, min(along.y, 1.0 - along.x));
}

// Which of three vertices is opposite the longest edge, as seen: 0, 1 or 2.
fn opposite_longest(a: Corner, b: Corner, c: Corner) -> u32 {
    let ab = b.offset - a.offset;
    let bc = c.offset - b.offset;
    let ca = a.offset - c.offset;
    let squares = vec3<f32>(dot(bc, bc), dot(ca, ca), dot(ab, ab));
    return select(select(2u, 1u, squares.y >= squares.z), 0u, squares.x >= max(squares.y, squares.z));
}

// A place on the ray.
struct Place {
    // Distance along the ray, in device units, from where the pivot is passed.
    distance: f32,
    value: Quantity,
    // Twice the area of the triangle that is crossed there, as seen; none if it is seen narrow, or the ray passes beside it by
    // rounding.
    area: f32,
}

// A triangle is seen narrow if twice its area is less than this share of its longest edge's square.
const NARROW_FACE = 0.0625;

// Where the ray crosses a triangle.
fn place_of(a: Corner, b: Corner, c: Corner) -> Place {
    var first = a;
    var second = b;
    var third = c;
    let turn = opposite_longest(a, b, c);
    if turn == 1u {
        first = b;
        second = c;
        third = a;
    } else if turn == 2u {
        first = c;
        second = a;
        third = b;
    }
    let along = crossing(first, second, third);
    let distance = first.distance + along.x * (second.distance - first.distance) + along.y * (third.distance - first.distance);
    let value = (1.0 - along.x - along.y) * first.value + along.x * second.value + along.y * third.value;
    let ab = second.offset - first.offset;
    let ac = third.offset - first.offset;
    let bc = third.offset - second.offset;
    let whole = ab.x * ac.y - ab.y * ac.x;
    let is_crossed = min(area(a, b), min(area(b, c), area(c, a))) >= 0.0;
    return Place(distance, value, select(0.0, whole, is_crossed && whole > NARROW_FACE * dot(bc, bc)));
}

// Six volumes of the cell between a triangle and an apex, by the shortest way to that: across a thin cell, where nothing
// cancels.
fn volume_of(a: Corner, b: Corner, c: Corner, apex: Corner) -> f32 {
    let to_a = apex.position - a.position;
    let to_b = apex.position - b.position;
    let to_c = apex.position - c.position;
    let lengths = vec3<f32>(dot(to_a, to_a), dot(to_b, to_b), dot(to_c, to_c));
    var way = to_a;
    if lengths.y < lengths.x {
        way = to_b;
    }
    if lengths.z < min(lengths.x, lengths.y) {
        way = to_c;
    }
    return abs(dot(face_normal(a.position, b.position, c.position), way));
}

// A cell is thin if a ray's way through it is less than this share of how wide it is seen.
const THIN = 0.0625;

// A distance between two places is good to this share of the larger of its ends, however steeply the ray meets a face.
const DISTANCE_ROUNDING = 3e-5;

// The length of a ray in a cell of so many volumes that it enters at `front` and leaves at `back`; `beside` is twice the area
// between the ray and the edge that both triangles have. In a thin cell the difference of two distances has lost its digits:
// there six volumes are the area of the first triangle times the way from it to the apex, of which the ray goes as large a part
// as `beside` is of the second triangle. Where these two differ by more than rounding the ray is not in these triangles.
fn way_through(ray: Ray, volume: f32, beside: f32, front: Place, back: Place) -> f32 {
    let difference = back.distance - front.distance;
    if !(min(front.area, back.area) > 0.0) {
        return difference;
    }
    let way = length(ray.along) * (volume / front.area) * (beside / back.area);
    let is_thin = way * way < THIN * THIN * front.area;
    let unsure = DISTANCE_ROUNDING * max(abs(front.distance), abs(back.distance));
    return select(difference, way, is_thin && abs(way - difference) < unsure);
}
