//! A balanced tree of boxes over cells: which of them a line may meet.

use glam::{DVec3, Vec3};

/// Cells in a leaf, at most.
const LEAF: usize = 4;

/// A tree in which every node's cells are halved between its two children, so that it is told by its boxes alone.
#[derive(Debug)]
pub(super) struct Hierarchy {
    /// The cells, those of a leaf side by side.
    cells: Vec<u32>,
    /// Box of node i, its children being 2 i + 1 and 2 i + 2.
    boxes: Vec<[Vec3; 2]>,
    /// Number of nodes that have children: the leaves follow.
    inner: usize,
}

impl Hierarchy {
    /// Over the cells whose boxes are given.
    pub(super) fn new(bounds: &[[Vec3; 2]]) -> Hierarchy {
        let leaves = bounds.len().div_ceil(LEAF).next_power_of_two();
        let mut cells: Vec<u32> = (0..bounds.len() as u32).collect();
        halve(&mut cells, bounds, leaves);
        let inner = leaves - 1;
        let mut tree = Hierarchy { cells, boxes: vec![EMPTY; inner + leaves], inner };
        tree.fit(0, 0..bounds.len(), bounds);
        tree
    }

    fn fit(&mut self, node: usize, range: std::ops::Range<usize>, bounds: &[[Vec3; 2]]) -> [Vec3; 2] {
        let fitted = if node >= self.inner {
            self.cells[range].iter().fold(EMPTY, |all, &cell| join(all, bounds[cell as usize]))
        } else {
            let middle = middle(&range);
            let first = self.fit(2 * node + 1, range.start..middle, bounds);
            join(first, self.fit(2 * node + 2, middle..range.end, bounds))
        };
        self.boxes[node] = fitted;
        fitted
    }

    /// Calls `found` with every cell whose leaf's box meets the line o + t d for a t of at least `start`.
    pub(super) fn along(&self, o: DVec3, d: DVec3, start: f64, mut found: impl FnMut(u32)) {
        let mut stack = vec![(0, 0..self.cells.len())];
        while let Some((node, range)) = stack.pop() {
            if range.is_empty() || span(self.boxes[node], o, d, start).is_none() {
                continue;
            }
            if node >= self.inner {
                self.cells[range].iter().for_each(|&cell| found(cell));
            } else {
                let middle = middle(&range);
                stack.push((2 * node + 2, middle..range.end));
                stack.push((2 * node + 1, range.start..middle));
            }
        }
    }
}

const EMPTY: [Vec3; 2] = [Vec3::INFINITY, Vec3::NEG_INFINITY];

fn join(a: [Vec3; 2], b: [Vec3; 2]) -> [Vec3; 2] {
    [a[0].min(b[0]), a[1].max(b[1])]
}

fn middle(range: &std::ops::Range<usize>) -> usize {
    range.start + range.len() / 2
}

/// Brings the cells of each half together, down to the leaves: along the longest side of their centres' box.
fn halve(cells: &mut [u32], bounds: &[[Vec3; 2]], leaves: usize) {
    if leaves == 1 || cells.len() < 2 {
        return;
    }
    let center = |cell: u32| bounds[cell as usize][0] + bounds[cell as usize][1];
    let [lo, hi] = cells.iter().fold(EMPTY, |all, &cell| join(all, [center(cell); 2]));
    let axis = (hi - lo).max_position();
    let half = cells.len() / 2;
    cells.select_nth_unstable_by(half, |&a, &b| center(a)[axis].total_cmp(&center(b)[axis]).then(a.cmp(&b)));
    let (first, second) = cells.split_at_mut(half);
    rayon::join(|| halve(first, bounds, leaves / 2), || halve(second, bounds, leaves / 2));
}

/// The parameters at which the line o + t d is within a box, not before `start`; widened by their rounding errors.
pub(super) fn span([lo, hi]: [Vec3; 2], o: DVec3, d: DVec3, start: f64) -> Option<[f64; 2]> {
    // Each parameter has three roundings.
    const ROUNDING: f64 = 4.0 * f64::EPSILON;
    let (mut first, mut last) = (start, f64::MAX);
    for axis in 0..3 {
        let (lo, hi) = (f64::from(lo[axis]), f64::from(hi[axis]));
        if d[axis].abs() < f64::MIN_POSITIVE.sqrt() {
            // The line keeps to this coordinate over any length there is.
            if o[axis] < lo || o[axis] > hi {
                return None;
            }
            continue;
        }
        let (a, b) = ((lo - o[axis]) / d[axis], (hi - o[axis]) / d[axis]);
        let (a, b) = (a.min(b), a.max(b));
        first = first.max(a - ROUNDING * a.abs());
        last = last.min(b + ROUNDING * b.abs());
    }
    (first <= last).then_some([first, last])
}
