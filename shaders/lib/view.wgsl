// The view, and from a point of the mesh to eye space and pixels.
//
// All lengths are in device units: world units times a power of two that makes the mesh about one unit wide. Eye space
// has x to the right, y down, z forward.

// Rays are parallel.
override ORTHOGRAPHIC: bool = false;

struct View {
    // Rows of the rotation to eye space; in w the pivot's position in eye space.
    right: vec4<f32>,
    down: vec4<f32>,
    forward: vec4<f32>,
    // The point of the mesh's bounding box nearest to the eye, as two summands: differences from it keep their digits
    // whether the eye is inside the mesh or far away.
    pivot_high: vec4<f32>,
    pivot_low: vec4<f32>,
    // Width and height in pixels.
    size: vec2<f32>,
    // Side of a pixel: at unit depth if perspective, in device units if orthographic.
    pixel: f32,
    // Depth before which nothing is seen; above 0 if perspective.
    near: f32,
}

@group(0) @binding(0) var<uniform> view: View;

struct Vertex {
    // As the mesh has it: differences of these are exact to their own last digit.
    position: vec3<f32>,
    // Position relative to the pivot, in the axes of eye space.
    frame: vec3<f32>,
    // Position in eye space.
    eye: vec3<f32>,
    // Position in pixels from the picture's middle, as two summands; of use only in front of the near plane.
    pixel: vec2<f32>,
    rest: vec2<f32>,
}

// A direction of the mesh in the axes of eye space.
fn rotated(direction: vec3<f32>) -> vec3<f32> {
    return vec3<f32>(dot(view.right.xyz, direction), dot(view.down.xyz, direction), dot(view.forward.xyz, direction));
}

// A position relative to the pivot.
fn beside_pivot(position: vec3<f32>) -> vec3<f32> {
    return (position - view.pivot_high.xyz) - view.pivot_low.xyz;
}

// The same in the axes of eye space.
fn frame_of(position: vec3<f32>) -> vec3<f32> {
    return rotated(beside_pivot(position));
}

// A point of the mesh as it is seen; the host finds it in double precision.
struct Seen {
    // Position in pixels from the picture's middle, rounded; of use only in front of the near plane.
    pixel: vec2<f32>,
    // What that leaves of it, as two signed shares of 2^-24 of it.
    rest: u32,
    // Depth from the eye.
    depth: f32,
}

fn rest_of(seen: Seen) -> vec2<f32> {
    return unpack2x16snorm(seen.rest) * (abs(seen.pixel) * 5.9604645e-8);
}

fn vertex(position: vec3<f32>, seen: Seen) -> Vertex {
    let frame = frame_of(position);
    let aside = frame.xy + vec2<f32>(view.right.w, view.down.w);
    return Vertex(position, frame, vec3<f32>(aside, seen.depth), seen.pixel, rest_of(seen));
}

// How much deeper b lies than a.
fn deeper(a: Vertex, b: Vertex) -> f32 {
    return dot(view.forward.xyz, b.position - a.position);
}

// From a to b in pixels.
fn pixels_between(a: Vertex, b: Vertex) -> vec2<f32> {
    return (b.pixel - a.pixel) + (b.rest - a.rest);
}

fn pixel_of(eye: vec3<f32>) -> vec2<f32> {
    if ORTHOGRAPHIC {
        return eye.xy / view.pixel;
    }
    return eye.xy / (max(eye.z, view.near) * view.pixel);
}
