//! From arrows to an order: depth-first search, and components of cells that occlude one another.

use std::hint::black_box;
use std::ops::Range;

use tetlux_mesh::NONE;

use crate::signs::ARROWS;

/// State of a cell, beside its [`ARROWS`] that are still to be followed: arrows across gaps are, too.
pub(crate) const GAPS: u8 = 16;
/// It was reached.
const SEEN: u8 = 32;
/// It was reached, and has no place yet.
const OPEN: u8 = 64;
/// Some of its arrows across gaps were followed.
const BEGUN: u8 = 128;

/// What is searched: arrows across faces and gaps.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Graph<'a> {
    pub(crate) neighbors: &'a [[u32; 4]],
    /// The same as differences, in half the memory; zero where one is too far away.
    pub(crate) steps: Option<&'a [[i16; 4]]>,
    /// Arrows across gaps, ascending: from, times 2^32, plus to.
    pub(crate) gaps: &'a [u64],
}

impl Graph<'_> {
    /// The cell across a face.
    #[inline]
    fn across(&self, cell: u32, face: usize) -> Option<u32> {
        self.neighbors[cell as usize].get(face).copied().filter(|&next| next != NONE)
    }

    #[inline]
    fn step(&self, steps: &[[i16; 4]], cell: u32, face: usize) -> Option<u32> {
        match steps[cell as usize].get(face) {
            Some(&step) if step != 0 => Some(cell.wrapping_add_signed(i32::from(step))),
            _ => self.across(cell, face),
        }
    }

    /// Reads what will be needed when the arrows of a cell are followed, long before most of them are: while it waits for
    /// the first one's, memory finds the others'.
    #[inline]
    fn read_ahead(&self, cell: u32, arrows: u8) {
        for (face, &next) in self.neighbors[cell as usize].iter().enumerate() {
            if let Some(around) = self.neighbors.get(next as usize).filter(|_| arrows >> face & 1 == 1) {
                black_box(around[0]);
            }
        }
    }

    /// Places of the arrows across gaps that leave a cell.
    fn gaps_from(&self, cell: u32) -> Range<usize> {
        let start = self.gaps.partition_point(|&arrow| arrow >> 32 < u64::from(cell));
        let count = self.gaps[start..].iter().take_while(|&&arrow| arrow >> 32 == u64::from(cell)).count();
        start..start + count
    }
}

/// Memory of a search, kept for the next.
#[derive(Debug, Default)]
pub(crate) struct Search {
    /// The cells between a seed and the one that is being searched.
    stack: Vec<u32>,
    /// The arrows across gaps that are left of those of them that have begun to follow theirs.
    gaps: Vec<Range<usize>>,
    /// When cells were first reached, from 0.
    reached: Vec<u32>,
    /// The earliest reached cell, as far as known, that each leads back to.
    back: Vec<u32>,
    /// Cells whose component is not yet complete.
    pending: Vec<u32>,
}

impl Search {
    /// Fills `cells` front to back such that no arrow points to the front, searching from `seeds`, then from every
    /// cell. False if there is a cycle; `cells` then holds nothing of use.
    ///
    /// `states` are the arrows of all cells, and [`GAPS`]; the search uses them up. Reverse postorder: a cell takes its
    /// place, from the back, when all that is behind it has its own (Tarjan 1976).
    pub(crate) fn sort(&mut self, graph: Graph, states: &mut [u8], seeds: &[u32], cells: &mut [u32]) -> bool {
        match graph.steps {
            Some(steps) => {
                self.sort_by(graph, |cell, face| graph.step(steps, cell, face), |_, _| {}, states, seeds, cells)
            }
            None => {
                let read_ahead = |cell, arrows| graph.read_ahead(cell, arrows);
                self.sort_by(graph, |cell, face| graph.across(cell, face), read_ahead, states, seeds, cells)
            }
        }
    }

    fn sort_by(
        &mut self,
        graph: Graph,
        across: impl Fn(u32, usize) -> Option<u32>,
        reached: impl Fn(u32, u8),
        states: &mut [u8],
        seeds: &[u32],
        cells: &mut [u32],
    ) -> bool {
        self.stack.clear();
        self.gaps.clear();
        let mut end = cells.len();
        for seed in seeds.iter().copied().chain(0..states.len() as u32) {
            let (mut cell, mut state) = (seed, states[seed as usize]);
            if state & SEEN != 0 {
                continue;
            }
            state |= SEEN | OPEN;
            loop {
                if let Some(next) = self.follow(graph, &across, cell, &mut state) {
                    let other = states[next as usize];
                    if other & SEEN == 0 {
                        states[cell as usize] = state;
                        self.stack.push(cell);
                        reached(next, other);
                        (cell, state) = (next, other | SEEN | OPEN);
                    } else if other & OPEN != 0 {
                        return false;
                    }
                } else {
                    states[cell as usize] = SEEN;
                    end -= 1;
                    cells[end] = cell;
                    let Some(previous) = self.stack.pop() else { break };
                    (cell, state) = (previous, states[previous as usize]);
                }
            }
        }
        true
    }

    /// As [`sort`](Self::sort), where there may be cycles: the cells of a strongly connected component of two or more
    /// are neighbours in `cells`, and are one of `groups`, ascending (Tarjan 1972).
    pub(crate) fn sort_components(
        &mut self,
        graph: Graph,
        states: &mut [u8],
        seeds: &[u32],
        cells: &mut [u32],
        groups: &mut Vec<Range<u32>>,
    ) {
        self.stack.clear();
        self.gaps.clear();
        self.pending.clear();
        self.reached.resize(states.len(), 0);
        self.back.resize(states.len(), 0);
        let (mut end, mut time) = (cells.len(), 0);
        for seed in seeds.iter().copied().chain(0..states.len() as u32) {
            let (mut cell, mut state) = (seed, states[seed as usize]);
            if state & SEEN != 0 {
                continue;
            }
            loop {
                if state & SEEN == 0 {
                    state |= SEEN | OPEN;
                    states[cell as usize] = state;
                    self.reached[cell as usize] = time;
                    self.back[cell as usize] = time;
                    time += 1;
                    self.pending.push(cell);
                }
                if let Some(next) = self.follow(graph, &|cell, face| graph.across(cell, face), cell, &mut state) {
                    let other = states[next as usize];
                    if other & SEEN == 0 {
                        states[cell as usize] = state;
                        self.stack.push(cell);
                        (cell, state) = (next, other);
                    } else if other & OPEN != 0 {
                        self.lead_back(cell, self.reached[next as usize]);
                    }
                    continue;
                }
                let back = self.back[cell as usize];
                if back == self.reached[cell as usize] {
                    let group_end = end;
                    while let Some(member) = self.pending.pop() {
                        states[member as usize] = SEEN;
                        end -= 1;
                        cells[end] = member;
                        if member == cell {
                            break;
                        }
                    }
                    if group_end - end > 1 {
                        groups.push(end as u32..group_end as u32);
                    }
                }
                let Some(previous) = self.stack.pop() else { break };
                (cell, state) = (previous, states[previous as usize]);
                self.lead_back(cell, back);
            }
        }
        groups.reverse();
    }

    fn lead_back(&mut self, cell: u32, time: u32) {
        let back = &mut self.back[cell as usize];
        *back = (*back).min(time);
    }

    /// The cell that the next arrow leads to; `None` if no arrow is left.
    #[inline]
    fn follow(
        &mut self,
        graph: Graph,
        across: &impl Fn(u32, usize) -> Option<u32>,
        cell: u32,
        state: &mut u8,
    ) -> Option<u32> {
        if *state & ARROWS != 0 {
            let face = state.trailing_zeros() as usize;
            *state &= *state - 1;
            return across(cell, face);
        }
        if *state & GAPS == 0 { None } else { self.follow_gap(graph, cell, state) }
    }

    #[cold]
    fn follow_gap(&mut self, graph: Graph, cell: u32, state: &mut u8) -> Option<u32> {
        if *state & BEGUN == 0 {
            *state |= BEGUN;
            self.gaps.push(graph.gaps_from(cell));
        }
        let next = self.gaps.last_mut().and_then(Iterator::next).map(|place| graph.gaps[place] as u32);
        if next.is_none() {
            self.gaps.pop();
            *state &= !GAPS;
        }
        next
    }
}

#[cfg(test)]
mod tests;
