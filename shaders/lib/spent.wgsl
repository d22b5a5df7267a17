// Counts the segments of a picture and the pieces into which they were cut.
import package::lib::view::{view};

// Counters of each kind: pixels share them in blocks of 64 x 64, so that neighbours do not wait for one another.
const COUNTERS = 4096u;

// Segments, then pieces.
@group(0) @binding(13) var<storage, read_write> spent: array<atomic<u32>, 8192>;

// A segment at a place in pixels from the picture's middle.
fn count_pieces(at: vec2<f32>, pieces: u32) {
    let pixel = vec2<u32>(at + view.size * 0.5) & vec2<u32>(63u);
    let counter = pixel.y * 64u + pixel.x;
    atomicAdd(&spent[counter], 1u);
    atomicAdd(&spent[COUNTERS + counter], pieces);
}
