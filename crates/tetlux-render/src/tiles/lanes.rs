//! Segments of more than one field, or lit: shaded one pixel at a time.

use fearless_simd::{Simd, SimdBase};

use super::block::Segments;
use super::further::{Inside, Linear};
use super::ramp::Pixels;
use super::record::Record;
use super::walk::{Light, Walk};
use crate::look::{self, Look, Segment, Spent};

/// Most lanes of a vector.
const LANES: usize = 16;

/// A block's segments, lane by lane.
#[derive(Default)]
struct Lanes {
    front: [f32; LANES],
    back: [f32; LANES],
    length: [f32; LANES],
    shares: [[f32; LANES]; 2],
    tilt: [f32; LANES],
    extent: [f32; LANES],
    /// The pixels, from the middle of the cell's box, and from the picture's.
    place: [[f32; LANES]; 2],
    pixel: [[f32; LANES]; 2],
    stretch: [f32; LANES],
}

impl<S: Simd> Walk<'_, S> {
    /// Composites segments of more than one field behind what is there, one pixel at a time.
    #[cold]
    #[inline(never)]
    pub(super) fn shade(
        &mut self,
        cell: u32,
        record: &Record,
        segments: &Segments<S>,
        (block, places): (usize, (S::f32s, S::f32s)),
        pixels: &mut Pixels<S>,
    ) {
        let Some(look) = self.light.look else { return };
        let count = S::f32s::LEN;
        let pixel = self.places_in_view(block);
        let mut lanes = Lanes::default();
        let [x, y] = &mut lanes.place;
        let [across, down] = &mut lanes.pixel;
        let [share, aside] = &mut lanes.shares;
        for (values, to) in [
            (segments.part.scalar - segments.part.rise, &mut lanes.front),
            (segments.part.scalar + segments.part.rise, &mut lanes.back),
            (segments.part.length, &mut lanes.length),
            (segments.shares[0], share),
            (segments.shares[1], aside),
            (segments.tilt, &mut lanes.tilt),
            (segments.half + segments.half, &mut lanes.extent),
            (places.0, x),
            (places.1, y),
            (pixel.0, across),
            (pixel.1, down),
            (self.stretch(block), &mut lanes.stretch),
        ] {
            values.store_slice(&mut to[..count]);
        }
        let mut colors = [[0.0; LANES]; 4];
        for i in 0..4 {
            pixels[i].store_slice(&mut colors[i][..count]);
        }
        let fields = look.further.len();
        let further = &self.light.further[cell as usize * fields..][..fields];
        let spent = shade_lanes(look, self.light, record, further, &lanes, count, &mut colors);
        self.spent = self.spent.and(spent);
        for i in 0..4 {
            pixels[i] = S::f32s::from_slice(self.simd, &colors[i][..count]);
        }
    }
}

/// Composites the segments of so many lanes behind `colors`, but for pixels that are done.
fn shade_lanes(
    look: &Look,
    light: &Light,
    record: &Record,
    further: &[Linear],
    lanes: &Lanes,
    count: usize,
    colors: &mut [[f32; LANES]; 4],
) -> Spent {
    let mut spent = Spent::default();
    let orthographic = light.pixel == 0.0;
    for i in (0..count).filter(|&i| lanes.length[i] > 0.0) {
        if colors[3][i] >= light.opaque {
            continue;
        }
        let place = lanes.place.map(|axis| axis[i]);
        let shares = lanes.shares.map(|share| share[i]);
        let inside = Inside { place, shares, tilt: lanes.tilt[i], extent: lanes.extent[i] };
        let first = [lanes.front[i], lanes.back[i]].map(|s| record.base + s);
        let look::Ends { scalars: [front, back], colors: ends, gradients } =
            look.values(first, further.iter().map(|field| field.ends(&inside, orthographic)));
        let [x, y] = lanes.pixel.map(|axis| -axis[i] * light.pixel / lanes.stretch[i]);
        let view = [x, y, -1.0 / lanes.stretch[i]];
        let pieces = record.pieces.map(|piece| piece as usize);
        let part = look.shade(&Segment { front, back, colors: ends, gradients, length: lanes.length[i], view, pieces });
        let left = 1.0 - colors[3][i];
        for channel in 0..4 {
            colors[channel][i] += left * part.color[channel];
        }
        spent.segments += 1;
        spent.pieces += u64::from(part.pieces);
    }
    spent
}
