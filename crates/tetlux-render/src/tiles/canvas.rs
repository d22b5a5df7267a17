//! The picture while it is drawn: tile after tile, so that a tile's pixels lie together, channel by channel.

use rayon::prelude::*;

use super::bins::{TILE, tiles};
use super::block::WIDTH;

/// Pixels of a tile.
pub(crate) const PIXELS: usize = (TILE * TILE) as usize;

/// Blocks across a tile.
pub(crate) const COLUMNS: usize = TILE as usize / WIDTH;

/// Premultiplied colour and alpha of a tile's pixels, block by block.
pub(crate) type Tile = [[f32; PIXELS]; 4];

/// All tiles of a picture.
pub(crate) struct Canvas {
    size: [u32; 2],
    /// The memory of the picture to be: as much a tile as its pixels will take.
    pixels: Vec<[f32; 4]>,
}

/// Where in a tile's vectors of so many lanes the pixel at (x, y) is.
pub(crate) fn place(x: usize, y: usize, lanes: usize) -> usize {
    let rows = lanes / WIDTH;
    (y / rows * COLUMNS + x / WIDTH) * lanes + y % rows * WIDTH + x % WIDTH
}

impl Canvas {
    /// Transparent.
    pub(crate) fn new(size: [u32; 2]) -> Canvas {
        let [columns, rows] = tiles(size).map(|n| n as usize);
        Canvas { size, pixels: vec![[0.0; 4]; columns * rows * PIXELS] }
    }

    /// The tiles, row by row.
    pub(crate) fn tiles(&mut self) -> impl IndexedParallelIterator<Item = &mut Tile> {
        self.pixels.as_flattened_mut().as_chunks_mut().0.as_chunks_mut().0.par_iter_mut()
    }

    /// The pixels, top row first, of tiles drawn in vectors of so many lanes.
    pub(crate) fn into_pixels(self, lanes: usize) -> Vec<[f32; 4]> {
        let (mut pixels, width, height) = (self.pixels, self.size[0] as usize, self.size[1] as usize);
        let side = TILE as usize;
        let across = width.next_multiple_of(side);
        pixels.par_chunks_mut((across * side).max(1)).for_each_with(vec![[0.0; 4]; across * side], |copy, strip| {
            copy.copy_from_slice(strip);
            for (column, tile) in copy.as_flattened().as_chunks::<{ 4 * PIXELS }>().0.iter().enumerate() {
                for row in 0..side {
                    for x in (0..side).step_by(WIDTH) {
                        // Pixels of a row of a block lie together in each channel.
                        let from = place(x, row, lanes);
                        let [red, green, blue, alpha] = [0, 1, 2, 3].map(|c| &tile[c * PIXELS + from..][..WIDTH]);
                        let to = &mut strip[row * across + column * side + x..][..WIDTH];
                        for i in 0..WIDTH {
                            to[i] = [red[i], green[i], blue[i], alpha[i]];
                            #[cfg(feature = "planted")]
                            if crate::planted::is_lost(x + i, row) {
                                to[i] = [0.0; 4];
                            }
                        }
                    }
                }
            }
        });
        if across != width {
            for y in 1..height {
                pixels.copy_within(y * across..y * across + width, y * width);
            }
        }
        pixels.truncate(width * height);
        pixels
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_pixel_comes_from_its_place_in_its_tile() {
        for size in [[16, 16], [48, 32], [50, 35], [7, 3], [1, 40]] {
            for lanes in [4, 8, 16] {
                let mut canvas = Canvas::new(size);
                let columns = tiles(size)[0] as usize;
                // A pixel's own number in every channel, in their own halves.
                canvas.tiles().enumerate().for_each(|(index, tile)| {
                    for i in 0..PIXELS {
                        let [x, y] = [i % TILE as usize, i / TILE as usize];
                        let [left, top] = [index % columns, index / columns].map(|n| n * TILE as usize);
                        for channel in 0..4 {
                            tile[channel][place(x, y, lanes)] =
                                ((left + x) + 100 * (top + y) + 10_000 * channel) as f32;
                        }
                    }
                });
                let pixels = canvas.into_pixels(lanes);
                assert_eq!(pixels.len(), (size[0] * size[1]) as usize);
                for (i, pixel) in pixels.iter().enumerate() {
                    let number = i % size[0] as usize + 100 * (i / size[0] as usize);
                    assert_eq!(*pixel, [0, 1, 2, 3].map(|channel| (number + 10_000 * channel) as f32), "{size:?} {i}");
                }
            }
        }
    }
}
