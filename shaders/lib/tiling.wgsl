// What the stages that bin cells into tiles and walk the tiles know of a run of cells.
struct Tiling {
    // Tiles in a row of the picture.
    columns: u32,
    // The cells of this run, by their ranks in the batch, nearest first: the first, and one past the last.
    first: u32,
    end: u32,
    // A pixel of this alpha is done.
    opaque: f32,
}
