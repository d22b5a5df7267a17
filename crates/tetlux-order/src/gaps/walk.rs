//! Along one ray: which crossings of the boundary belong together.

use super::Crossing;

/// Arrows and overlaps, as they are found.
#[derive(Debug, Default)]
pub(super) struct Findings {
    pub(super) arrows: Vec<u64>,
    pub(super) overlapping: Vec<u32>,
    pub(super) overlap_pixels: usize,
    /// Arrows found of late: neighbouring rays find the same ones.
    recent: Vec<u64>,
}

/// Places for recent arrows: a power of two.
const RECENT: u64 = 1024;

impl Findings {
    pub(super) fn clear(&mut self) {
        self.arrows.clear();
        self.overlapping.clear();
        self.overlap_pixels = 0;
        self.recent.clear();
        self.recent.resize(RECENT as usize, 0);
    }

    /// False if it was found before.
    fn arrow(&mut self, from: u32, to: u32) -> bool {
        let arrow = u64::from(from) << 32 | u64::from(to);
        // A cell has no arrow to itself, so that 0 is none.
        let recent = &mut self.recent[((arrow ^ arrow >> 27) % RECENT) as usize];
        let found = from != to && *recent != arrow;
        if found {
            *recent = arrow;
            self.arrows.push(arrow);
        }
        found
    }

    fn overlap(&mut self, a: u32, b: u32) {
        if self.arrow(a, b) | self.arrow(b, a) {
            self.overlapping.extend([a, b]);
        }
    }
}

/// Pairs the crossings of a ray, which are sorted by depth: a ray enters and leaves by turns.
///
/// Every stretch from an entry to the next exit is one piece of the mesh, and an arrow leads from each piece's last cell
/// to the next one's first. Where crossings alternate only when some that are closer than `tolerance` change places,
/// they do. Where they do not alternate, pieces overlap: all their cells at the boundary get arrows both ways.
pub(super) fn walk(crossings: &mut [Crossing], tolerance: f64, findings: &mut Findings) {
    // More exits than entries: so many pieces hold the eye.
    let mut depth = crossings.iter().map(|c| if c.entry { -1 } else { 1 }).sum::<i32>();
    let (mut tangled, mut overlaps) = (false, false);
    let mut previous = None;
    for i in 0..crossings.len() {
        let wanted = depth <= 0;
        if crossings[i].entry != wanted {
            let near = crossings[i..].iter().take_while(|c| c.depth - crossings[i].depth <= tolerance);
            if let Some(ahead) = near.take(LOOK_AHEAD).position(|c| c.entry == wanted) {
                crossings[i..=i + ahead].rotate_right(1);
            }
        }
        let Crossing { cell, entry, .. } = crossings[i];
        let before = depth;
        depth += if entry { 1 } else { -1 };
        // Within a piece there are no arrows across gaps, unless another piece is there too.
        tangled |= before.min(depth) != 0 || before.max(depth) != 1;
        if let Some(from) = previous {
            if before == 0 {
                findings.arrow(from, cell);
            } else if tangled {
                findings.overlap(from, cell);
            }
        }
        overlaps |= tangled;
        tangled &= depth != 0;
        previous = Some(cell);
    }
    findings.overlap_pixels += usize::from(overlaps);
}

/// Crossings at one depth that are looked at for one that fits.
const LOOK_AHEAD: usize = 16;
