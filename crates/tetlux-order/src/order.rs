//! An order, and what is known of it.

use std::ops::Range;

use crate::Method;

/// The cells of a mesh, front to back.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Order {
    /// Every cell once, nearest first.
    pub cells: Vec<u32>,
    /// Positions in `cells`, ascending and disjoint, of cells that have no order among themselves: they occlude one
    /// another in a cycle, or overlap. Along every ray the cells of a group follow one another, so that the cells of
    /// a group are to be sorted for every pixel, and nothing else is.
    pub groups: Vec<Range<u32>>,
    /// How it was found.
    pub report: OrderReport,
}

impl Order {
    /// The order of the cells that `keep` accepts. Groups are those of the cells that are left, if two or more are.
    ///
    /// Orders are found for whole meshes, since cells that are not drawn carry the order of those that are.
    pub fn filter(&self, keep: impl Fn(u32) -> bool) -> Order {
        let mut kept = Order { report: self.report.clone(), ..Order::default() };
        let mut at = 0;
        let take = |range: Range<usize>, cells: &mut Vec<u32>| {
            cells.extend(self.cells[range].iter().copied().filter(|&cell| keep(cell)));
        };
        for group in &self.groups {
            take(at..group.start as usize, &mut kept.cells);
            at = group.end as usize;
            let start = kept.cells.len() as u32;
            take(group.start as usize..at, &mut kept.cells);
            let end = kept.cells.len() as u32;
            if end > start + 1 {
                kept.groups.push(start..end);
            }
        }
        take(at..self.cells.len(), &mut kept.cells);
        kept
    }
}

/// How an order was found, and what stood in its way.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct OrderReport {
    /// The method that was used: never `auto`.
    pub method: Method,
    /// Why this method, in a few words.
    pub reason: &'static str,
    /// It is the last order: nothing has changed since.
    pub reused: bool,
    /// Rays were searched for gaps.
    pub gap_pass: bool,
    /// Cells that occlude one another in a cycle were searched for.
    pub component_search: bool,
    /// Signs of faces that single precision could not decide.
    pub signs_in_double: usize,
    /// Of these, signs that double precision could not decide either.
    pub signs_exact: usize,
    /// Arrows from a cell to the next across a gap.
    pub gap_arrows: usize,
    /// Cells that occlude one another in a cycle, or overlap: the cells of all groups.
    pub cells_in_groups: usize,
    /// Pixels on whose ray cells overlap.
    pub overlap_pixels: usize,
    /// Cells of the boundary that were seen to overlap.
    pub overlap_cells: usize,
    /// Faces whose two cells lie on one side of them: no order exists there.
    pub folded_faces: usize,
    /// Time of every stage, in order.
    pub stages: Vec<Stage>,
}

/// The time of one stage.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stage {
    /// What was done.
    pub name: &'static str,
    /// Seconds by the clock.
    pub wall: f64,
    /// Seconds of processor time of the whole process, all threads; `None` where the system does not tell.
    pub cpu: Option<f64>,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn groups_follow_the_cells_that_are_kept() {
        let order = Order { cells: vec![7, 3, 5, 1, 0, 2, 4, 6], groups: vec![1..3, 4..8], ..Order::default() };
        let ends = |order: &Order| order.groups.iter().map(|g| (g.start, g.end)).collect::<Vec<_>>();
        let odd = order.filter(|cell| cell % 2 == 1);
        assert_eq!(odd.cells, [7, 3, 5, 1]);
        assert_eq!(ends(&odd), [(1, 3)]);
        let some = order.filter(|cell| [7, 3, 2, 6].contains(&cell));
        assert_eq!(some.cells, [7, 3, 2, 6]);
        assert_eq!(ends(&some), [(2, 4)]);
        assert_eq!(order.filter(|_| true), order);
        assert_eq!(order.filter(|_| false).groups, vec![]);
    }
}
