//! What becomes of the cells of a mesh, many at a time: no cell waits for a guess about the one before.

use crate::Skips;

/// What becomes of a cell: the reason why it is not drawn, if there is one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Verdict {
    Drawn,
    NoData,
    Transparent,
    Faint,
    Flat,
    Outside,
}

/// The verdicts on some cells, one after another.
#[derive(Debug)]
pub(crate) struct Verdicts(pub(crate) Vec<Verdict>);

/// So many intervals are sooner all tried than searched.
const FEW: usize = 12;

impl Verdicts {
    /// All are drawn.
    pub(crate) fn new(cells: usize) -> Verdicts {
        Verdicts(vec![Verdict::Drawn; cells])
    }

    /// Overrides the verdicts on cells of which something holds.
    pub(crate) fn mark(&mut self, verdict: Verdict, holds: impl Fn(usize) -> bool) {
        for (i, now) in self.0.iter_mut().enumerate() {
            *now = if holds(i) { verdict } else { *now };
        }
    }

    /// The same for cells whose ranges lie within one of some intervals, which ascend.
    pub(crate) fn mark_within(&mut self, ranges: &[[f64; 2]], intervals: &[[f64; 2]], verdict: Verdict) {
        if intervals.len() <= FEW {
            for &[from, to] in intervals {
                for (now, &[low, high]) in self.0.iter_mut().zip(ranges) {
                    *now = if (from <= low) & (high <= to) { verdict } else { *now };
                }
            }
            return;
        }
        for (now, &[low, high]) in self.0.iter_mut().zip(ranges) {
            let after = intervals.partition_point(|interval| interval[0] <= low);
            if after > 0 && high <= intervals[after - 1][1] {
                *now = verdict;
            }
        }
    }

    /// The cells to draw, the first of all being `start`.
    pub(crate) fn drawn(&self, start: usize) -> Vec<u32> {
        let count = self.count(Verdict::Drawn);
        // One more: each is written, and then kept or not.
        let (mut cells, mut kept) = (vec![0; count + 1], 0);
        for (i, &verdict) in self.0.iter().enumerate() {
            cells[kept] = (start + i) as u32;
            kept += usize::from(verdict == Verdict::Drawn);
        }
        cells.truncate(count);
        cells
    }

    /// How many are not drawn, by reason.
    pub(crate) fn skips(&self) -> Skips {
        Skips {
            no_data: self.count(Verdict::NoData),
            transparent: self.count(Verdict::Transparent),
            faint: self.count(Verdict::Faint),
            flat: self.count(Verdict::Flat),
            outside: self.count(Verdict::Outside),
        }
    }

    fn count(&self, of: Verdict) -> usize {
        self.0.iter().filter(|&&verdict| verdict == of).count()
    }
}

#[cfg(test)]
mod tests {
    use tetlux_optics::accuracy::Random;

    use super::*;

    #[test]
    fn ranges_are_within_few_intervals_or_many_by_the_same_rule() {
        let mut random = Random::new(8);
        let ranges: Vec<[f64; 2]> = (0..3000)
            .map(|i| {
                let low = random.unit();
                let high = low + 0.05 * random.unit();
                // Ends of intervals too, which count as within, and missing values.
                match i % 10 {
                    0 => [(low * 40.0).round() / 40.0; 2],
                    1 => [f64::NAN; 2],
                    _ => [low, high],
                }
            })
            .collect();
        for count in [0, 1, FEW, FEW + 1, 20] {
            let intervals: Vec<[f64; 2]> = (0..count).map(|k| [k, k + 1].map(|end| end as f64 / 20.0)).collect();
            let intervals: Vec<[f64; 2]> = intervals.into_iter().step_by(2).collect();
            let mut verdicts = Verdicts::new(ranges.len());
            verdicts.mark_within(&ranges, &intervals, Verdict::Faint);
            verdicts.mark(Verdict::NoData, |i| ranges[i][0].is_nan());
            let expected = |&[low, high]: &[f64; 2]| match () {
                () if low.is_nan() => Verdict::NoData,
                () if intervals.iter().any(|&[from, to]| from <= low && high <= to) => Verdict::Faint,
                () => Verdict::Drawn,
            };
            assert_eq!(verdicts.0, ranges.iter().map(expected).collect::<Vec<_>>());
            let (drawn, skips) = (verdicts.drawn(7), verdicts.skips());
            assert_eq!(drawn.len() + skips.faint + skips.no_data, ranges.len());
            assert!(drawn.iter().all(|&cell| verdicts.0[cell as usize - 7] == Verdict::Drawn));
            assert!(drawn.windows(2).all(|pair| pair[0] < pair[1]) && skips.no_data == 300);
            assert_eq!(skips.faint > 0, count > 0);
        }
    }
}
