//! The order cut into what is drawn by one call each.

use std::ops::Range;

use glam::DVec3;

use crate::Job;

/// Groups of more cells are composited as they come: a pixel looks at all cells of its group once for each segment.
pub(crate) const LARGEST_GROUP: u32 = 1024;

/// Cells of the order drawn by one call.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Stretch {
    /// Positions in the order.
    pub(super) cells: Range<u32>,
    /// They have no order among themselves.
    pub(super) group: bool,
}

/// All stretches, farthest first: groups whole, what lies between them in batches. At least one, if empty: the picture
/// must be cleared.
pub(super) fn stretches(cells: u32, groups: &[Range<u32>], batch: u32) -> Vec<Stretch> {
    let mut stretches = Vec::new();
    let mut end = cells;
    let small = groups.iter().filter(|group| group.end - group.start <= LARGEST_GROUP.min(batch));
    for group in small.rev() {
        batches(group.end..end, batch, &mut stretches);
        stretches.push(Stretch { cells: group.clone(), group: true });
        end = group.start;
    }
    batches(0..end, batch, &mut stretches);
    if stretches.is_empty() {
        stretches.push(Stretch { cells: 0..0, group: false });
    }
    stretches
}

/// The groups that are sorted for every pixel.
pub(super) fn sorted(groups: &[Range<u32>]) -> impl Iterator<Item = &Range<u32>> {
    groups.iter().filter(|group| group.end - group.start <= LARGEST_GROUP)
}

/// For each position in the order one past the last that has no order against it.
pub(super) fn group_ends(cells: u32, groups: &[Range<u32>]) -> Vec<u32> {
    let mut ends: Vec<u32> = (1..=cells).collect();
    for group in sorted(groups) {
        ends[group.start as usize..group.end as usize].fill(group.end);
    }
    ends
}

/// Appends cells in batches, the last first.
fn batches(cells: Range<u32>, batch: u32, stretches: &mut Vec<Stretch>) {
    let mut end = cells.end;
    while cells.start < end {
        let start = end.saturating_sub(batch).max(cells.start);
        stretches.push(Stretch { cells: start..end, group: false });
        end = start;
    }
}

/// Column, row, width and height in pixels of a box round some cells of the order, clipped to the picture.
pub(super) fn scissor(job: &Job, cells: &Range<u32>) -> [u32; 4] {
    let [mut low, mut high] = [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]];
    let eye = &job.eye;
    for &cell in &job.order[cells.start as usize..cells.end as usize] {
        for vertex in job.cells[cell as usize] {
            let [x, y, z, _] = job.mesh.points[vertex as usize].map(f64::from);
            let at = eye.frame(DVec3::new(x, y, z)) + eye.offset;
            // A cell across the near plane may reach anywhere.
            let pixel = eye.pixel_of(at);
            for i in 0..2 {
                let behind = !eye.orthographic && at.z < eye.near;
                low[i] = if behind { f64::NEG_INFINITY } else { low[i].min(pixel[i]) };
                high[i] = if behind { f64::INFINITY } else { high[i].max(pixel[i]) };
            }
        }
    }
    let [first, end] = [0, 1].map(|end| {
        std::array::from_fn::<u32, 2, _>(|i| {
            // A pixel more each way, for rounding. A conversion of a float saturates.
            let edge = if end == 0 { low[i].floor() - 1.0 } else { high[i].ceil() + 1.0 };
            edge.clamp(0.0, f64::from(job.size[i])) as u32
        })
    });
    [first[0], first[1], end[0].saturating_sub(first[0]), end[1].saturating_sub(first[1])]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_of_small_groups_end_together() {
        let large = 4..5 + LARGEST_GROUP;
        let ends = group_ends(large.end + 1, &[1..3, large.clone()]);
        assert_eq!(ends[..4], [1, 3, 3, 4]);
        // Too large to be sorted.
        assert!((4..=large.end).all(|i| ends[i as usize] == i + 1));
    }

    #[test]
    fn every_cell_is_drawn_once_farthest_first_and_groups_whole() {
        let group = |cells| Stretch { cells, group: true };
        let plain = |cells| Stretch { cells, group: false };
        let some = [2..5, 9..11];
        assert_eq!(
            stretches(20, &some, 4),
            [plain(16..20), plain(12..16), plain(11..12), group(9..11), plain(5..9), group(2..5), plain(0..2)]
        );
        // A group at either end, and one next to another.
        assert_eq!(stretches(6, &[0..2, 2..4, 4..6], 100), [group(4..6), group(2..4), group(0..2)]);
        // Too large for one call.
        assert_eq!(stretches(9, std::slice::from_ref(&(1..8)), 5), [plain(4..9), plain(0..4)]);
        assert_eq!(stretches(0, &[], 5), [plain(0..0)]);
    }
}
