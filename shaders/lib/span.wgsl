// The part of a ray inside a cell.
import package::axes::quantity::{Quantity};

struct Segment {
    // The quantity at the front and at the back end.
    front: Quantity,
    back: Quantity,
    // The ray's place in pixels from the picture's middle.
    at: vec2<f32>,
    // In device units; 0 where the ray misses the cell.
    length: f32,
}
