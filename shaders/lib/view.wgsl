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
    // Position relative to the pivot, in the axes of eye space.
    frame: vec3<f32>,
    // Position in eye space.
    eye: vec3<f32>,
    // Position in pixels from the picture's middle; of use only in front of the near plane.
    pixel: vec2<f32>,
}

fn vertex(position: vec3<f32>) -> Vertex {
    let p = (position - view.pivot_high.xyz) - view.pivot_low.xyz;
    let frame = vec3<f32>(dot(view.right.xyz, p), dot(view.down.xyz, p), dot(view.forward.xyz, p));
    let eye = frame + vec3<f32>(view.right.w, view.down.w, view.forward.w);
    return Vertex(frame, eye, pixel_of(eye));
}

fn pixel_of(eye: vec3<f32>) -> vec2<f32> {
    if ORTHOGRAPHIC {
        return eye.xy / view.pixel;
    }
    return eye.xy / (max(eye.z, view.near) * view.pixel);
}
