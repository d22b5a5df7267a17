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

/// Cells that are mostly all drawn or none.
const RUN: usize = 64;

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

    /// The cells to draw, the first of all being `start`.
    pub(crate) fn drawn(&self, start: usize) -> Vec<u32> {
        let mut cells = Vec::with_capacity(self.count(Verdict::Drawn));
        for (index, run) in self.0.chunks(RUN).enumerate() {
            let first = (start + index * RUN) as u32;
            let drawn = count(run, Verdict::Drawn);
            if drawn == run.len() {
                cells.extend(first..first + drawn as u32);
            } else if drawn > 0 {
                // Each is written, and then kept or not, for want of anything to guess.
                let (mut kept, mut count) = ([0; RUN], 0);
                for (cell, &verdict) in (first..).zip(run) {
                    kept[count] = cell;
                    count += usize::from(verdict == Verdict::Drawn);
                }
                cells.extend_from_slice(&kept[..count]);
            }
        }
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
        self.0.chunks(RUN).map(|run| count(run, of)).sum()
    }
}

/// How many of a run are of one kind. Counted in bytes, so that many are counted at once.
fn count(run: &[Verdict], of: Verdict) -> usize {
    usize::from(run.iter().fold(0u8, |sum, &verdict| sum + u8::from(verdict == of)))
}

#[cfg(test)]
mod tests {
    use tetlux_optics::accuracy::Random;

    use super::*;

    #[test]
    fn what_is_drawn_and_what_is_not_is_counted() {
        let mut random = Random::new(8);
        // All of a run, none of it, and some; the last run in part.
        for share in [0.0, 0.001, 0.5, 0.999, 1.0] {
            let of = [Verdict::Faint, Verdict::NoData, Verdict::Flat, Verdict::Outside, Verdict::Transparent];
            let holds: Vec<bool> = (0..3010).map(|_| random.unit() < share).collect();
            let mut verdicts = Verdicts::new(holds.len());
            for (k, verdict) in of.into_iter().enumerate() {
                verdicts.mark(verdict, |i| holds[i] && i % of.len() == k);
            }
            let expected = |i: usize| if holds[i] { of[i % of.len()] } else { Verdict::Drawn };
            assert_eq!(verdicts.0, (0..holds.len()).map(expected).collect::<Vec<_>>());
            let (drawn, skips) = (verdicts.drawn(7), verdicts.skips());
            let left: Vec<u32> = (0..holds.len()).filter(|&i| !holds[i]).map(|i| i as u32 + 7).collect();
            assert_eq!(drawn, left);
            let counts = [skips.faint, skips.no_data, skips.flat, skips.outside, skips.transparent];
            for (k, count) in counts.into_iter().enumerate() {
                assert_eq!(count, (k..holds.len()).step_by(of.len()).filter(|&i| holds[i]).count());
            }
        }
    }
}
