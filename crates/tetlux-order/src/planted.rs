//! Faults for tests to find, of the feature `planted` alone: no program is built with it.

use std::sync::{Mutex, PoisonError};

use crate::signs::ARROWS;

/// An arrow of the graph that a search is not told of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Dropped {
    /// Of the arrows across faces, counted cell by cell, the one of this number.
    Face(usize),
    /// Of the arrows across gaps the one of this number.
    Gap(usize),
}

static DROPPED: Mutex<Option<Dropped>> = Mutex::new(None);

/// Drops an arrow from every graph that this process searches from now on; `None`: no more.
pub fn drop_arrow(dropped: Option<Dropped>) {
    *DROPPED.lock().unwrap_or_else(PoisonError::into_inner) = dropped;
}

/// Takes the arrow out of the cells' states or the list of gaps.
pub(crate) fn apply(states: &mut [u8], gaps: &mut Vec<u64>) {
    match *DROPPED.lock().unwrap_or_else(PoisonError::into_inner) {
        Some(Dropped::Face(mut number)) => {
            for state in states {
                let count = (*state & ARROWS).count_ones() as usize;
                if number < count {
                    let kept = (0..number).fold(*state & ARROWS, |left, _| left & (left - 1));
                    *state ^= kept & kept.wrapping_neg();
                    return;
                }
                number -= count;
            }
        }
        Some(Dropped::Gap(number)) if number < gaps.len() => {
            gaps.remove(number);
        }
        _ => {}
    }
}
