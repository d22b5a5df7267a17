// Draws the cells of a batch, back to front.
import package::lib::span::{Segment};
import package::axes::geometry::{Fragment, place, segment_in};
import package::axes::shading::{shade};
import package::axes::output::{stored};

@vertex
fn cover(@builtin(vertex_index) vertex: u32, @builtin(instance_index) instance: u32) -> Fragment {
    return place(vertex, instance);
}

@fragment
fn color(fragment: Fragment) -> @location(0) vec4<f32> {
    let segment = segment_in(fragment);
    if !(segment.length > 0.0) {
        discard;
    }
    let shaded = shade(fragment.pieces_entry.xy, segment);
    return stored(shaded, fragment.position.xy, fragment.pieces_entry.z);
}
