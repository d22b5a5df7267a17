//! The range of a field in each cell of a mesh, and which ranges lie within intervals.

use std::cmp::Ordering;

use rayon::prelude::*;
use tetlux_mesh::{ScalarField, TetMesh};

use crate::culling::{above, below};
use crate::verdict::{Verdict, Verdicts};

/// Cells that are known by the range of all of them too. Neighbours by number mostly are neighbours.
const BLOCK: usize = 64;

/// So many intervals are sooner all tried than searched.
const FEW: usize = 12;

/// The scalars of each cell: 8 bytes a cell, in single precision, rounded outwards. Where that leaves a question open the
/// field itself is asked.
#[derive(Debug)]
pub(crate) struct Ranges {
    pub(crate) of: ScalarField,
    blocks: Vec<Block>,
    /// The largest difference within a cell.
    pub(crate) widest: f64,
    /// A cell has no finite value.
    pub(crate) has_missing: bool,
}

/// The lowest and the highest scalars of some cells; NaN where a value is missing, and behind the last cell.
#[derive(Debug, Clone)]
struct Block {
    low: [f32; BLOCK],
    high: [f32; BLOCK],
    /// Of all of them; NaN where any of them misses a value.
    around: [f32; 2],
}

/// Closed intervals, ascending and apart.
#[derive(Debug)]
pub(crate) struct Intervals {
    exact: Vec<[f64; 2]>,
    /// Rounded inwards: a rounded range that lies within one lies within the interval.
    inner: Vec<[f32; 2]>,
    /// Rounded outwards: one that does not lie within one does not.
    outer: Vec<[f32; 2]>,
}

impl Intervals {
    pub(crate) fn new(exact: Vec<[f64; 2]>) -> Intervals {
        Intervals {
            inner: exact.iter().map(|&[from, to]| [above(from), below(to)]).collect(),
            outer: exact.iter().map(|&[from, to]| [below(from), above(to)]).collect(),
            exact,
        }
    }
}

/// Whether a range lies within one of some intervals, which ascend; what is not a number does not.
fn within<T: PartialOrd>([low, high]: &[T; 2], intervals: &[[T; 2]]) -> bool {
    let after = intervals.partition_point(|interval| interval[0] <= *low);
    after > 0 && *high <= intervals[after - 1][1]
}

impl Ranges {
    pub(crate) fn new(mesh: &TetMesh, scalar: &ScalarField) -> Ranges {
        let count = mesh.cells().len();
        let block = |index: usize| {
            let mut block = Block { low: [f32::NAN; BLOCK], high: [f32::NAN; BLOCK], around: [f32::NAN; 2] };
            let (mut around, mut widest, mut has_missing) = ([f32::INFINITY, f32::NEG_INFINITY], 0.0f64, false);
            for (i, cell) in (index * BLOCK..count.min((index + 1) * BLOCK)).enumerate() {
                let [low, high] = mesh.scalar_range(scalar, cell);
                (block.low[i], block.high[i]) = (below(low), above(high));
                around = [around[0].min(block.low[i]), around[1].max(block.high[i])];
                widest = widest.max(high - low);
                has_missing |= low.is_nan();
            }
            if !has_missing {
                block.around = around;
            }
            (block, widest)
        };
        let (blocks, widths): (Vec<Block>, Vec<f64>) = (0..count.div_ceil(BLOCK)).into_par_iter().map(block).unzip();
        let has_missing = blocks.iter().any(|block| block.around[0].is_nan());
        let widest = widths.into_iter().fold(0.0, f64::max);
        Ranges { of: scalar.clone(), blocks, widest, has_missing }
    }

    pub(crate) fn is_missing(&self, cell: usize) -> bool {
        self.blocks[cell / BLOCK].low[cell % BLOCK].is_nan()
    }

    /// Overrides the verdicts on the cells from `start` on, a multiple of [`BLOCK`], whose ranges lie within an interval.
    pub(crate) fn mark_within(
        &self,
        mesh: &TetMesh,
        intervals: &Intervals,
        start: usize,
        verdicts: &mut Verdicts,
        verdict: Verdict,
    ) {
        for (index, verdicts) in verdicts.0.chunks_mut(BLOCK).enumerate() {
            let first = start + index * BLOCK;
            let block = &self.blocks[first / BLOCK];
            let [low, high] = block.around;
            // Of what is not a number all may meet.
            let begins_behind = |end: f32| end.partial_cmp(&high) == Some(Ordering::Greater);
            let from = intervals.outer.partition_point(|interval| interval[1] < low);
            let to = intervals.outer.partition_point(|interval| !begins_behind(interval[0])).max(from);
            let (inner, outer) = (&intervals.inner[from..to], &intervals.outer[from..to]);
            if inner.is_empty() {
                continue;
            }
            if within(&block.around, inner) {
                verdicts.fill(verdict);
                continue;
            }
            let (certain, possible) = (block.within(inner), block.within(outer));
            for (now, certain) in verdicts.iter_mut().zip(certain) {
                *now = if certain { verdict } else { *now };
            }
            if certain != possible {
                let exact = |i: usize| within(&mesh.scalar_range(&self.of, first + i), &intervals.exact[from..to]);
                for (i, now) in verdicts.iter_mut().enumerate() {
                    if possible[i] && !certain[i] && exact(i) {
                        *now = verdict;
                    }
                }
            }
        }
    }
}

impl Block {
    /// Which cells' ranges lie within one of some intervals, which ascend. Without branches, several cells at once.
    fn within(&self, intervals: &[[f32; 2]]) -> [bool; BLOCK] {
        let mut inside = [false; BLOCK];
        if intervals.len() <= FEW {
            for &[from, to] in intervals {
                for i in 0..BLOCK {
                    inside[i] |= (from <= self.low[i]) & (self.high[i] <= to);
                }
            }
        } else {
            for i in 0..BLOCK {
                inside[i] = within(&[self.low[i], self.high[i]], intervals);
            }
        }
        inside
    }
}

#[cfg(test)]
mod tests {
    use tetlux_mesh::procedural::{Split, cuboid};
    use tetlux_mesh::{Component, Field};
    use tetlux_optics::accuracy::Random;

    use super::*;

    /// Cells in blocks of their own and a block in part; values in single precision alone where asked for, and, of one
    /// place, missing ones.
    fn field(single: bool, missing: bool, random: &mut Random) -> (TetMesh, ScalarField) {
        let parts = cuboid([9, 8, 7], Split::Six, [glam::DVec3::ZERO, glam::DVec3::ONE]);
        let values = parts.sample(|p| {
            let near = (p.x - 0.5).abs() < 0.1 && p.y < 0.2;
            // Smooth, so that some blocks are decided at once; with ends of intervals among the values.
            let (smooth, end) = (0.2 * p.z, (4.0 * p.z).round() / 20.0);
            let value = match random.unit() {
                u if u < 0.1 => end,
                u if u < 0.2 => end + 1e-12,
                u => smooth + 0.005 * u,
            };
            let value = if single { f64::from(value as f32) } else { value };
            if missing && near { f64::NAN } else { value }
        });
        let mesh = TetMesh::assemble(&parts.points, &parts.cells, vec![Field::point("s", 1, values)]).unwrap();
        let scalar = mesh.scalar("s", Component::Magnitude).unwrap();
        (mesh, scalar)
    }

    #[test]
    fn ranges_are_within_few_intervals_or_many_as_the_field_itself_is() {
        let mut random = Random::new(8);
        let (mut inside, mut all) = (0, 0);
        for (single, missing) in [(true, false), (false, false), (false, true)] {
            let (mesh, scalar) = field(single, missing, &mut random);
            let (ranges, exact) = (Ranges::new(&mesh, &scalar), mesh.scalar_ranges(&scalar));
            assert_eq!(ranges.has_missing, missing);
            let widest = exact.iter().map(|[low, high]| high - low).fold(0.0, f64::max);
            assert_eq!(ranges.widest, widest);
            for count in [0, 1, FEW, FEW + 1, 20] {
                let ends = |k: i32| [k, k + 1].map(|end| f64::from(end) / 20.0);
                let mut intervals: Vec<[f64; 2]> = (0..count as i32).map(ends).step_by(2).collect();
                // To the ends of the line, as opacities of zero often go.
                if let Some(first) = intervals.first_mut().filter(|_| count > 1) {
                    first[0] = f64::NEG_INFINITY;
                }
                let within = |&[low, high]: &[f64; 2]| intervals.iter().any(|&[from, to]| from <= low && high <= to);
                let expected = |range| if within(range) { Verdict::Faint } else { Verdict::Drawn };
                let asked = Intervals::new(intervals.clone());
                let mut found = Vec::new();
                for start in (0..exact.len()).step_by(16 * BLOCK) {
                    let mut verdicts = Verdicts::new((16 * BLOCK).min(exact.len() - start));
                    ranges.mark_within(&mesh, &asked, start, &mut verdicts, Verdict::Faint);
                    found.extend(verdicts.0);
                }
                assert_eq!(found, exact.iter().map(expected).collect::<Vec<_>>(), "{count} intervals");
                (inside, all) = (inside + exact.iter().filter(|range| within(range)).count(), all + exact.len());
                let mut everywhere = Verdicts::new(exact.len());
                let line = Intervals::new(vec![[f64::NEG_INFINITY, f64::INFINITY]]);
                ranges.mark_within(&mesh, &line, 0, &mut everywhere, Verdict::Faint);
                let is_number = |(i, &verdict): (usize, &Verdict)| (verdict == Verdict::Faint) != ranges.is_missing(i);
                assert!(everywhere.0.iter().enumerate().all(is_number));
            }
        }
        assert!(inside > all / 20 && inside < all / 2, "{inside} of {all}");
    }
}
