// The part of a ray inside a cell.
import package::axes::quantity::{Quantity};

struct Segment {
    // The quantity at the front and at the back end.
    front: Quantity,
    back: Quantity,
    // In device units; 0 where the ray misses the cell.
    length: f32,
}
