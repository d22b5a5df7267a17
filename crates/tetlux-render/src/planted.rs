//! Faults for tests to find, of the feature `planted` alone: no program is built with it.

use std::sync::atomic::{AtomicU8, Ordering};

use fearless_simd::{Simd, SimdBase};

/// What is wrong with tiles on the processor.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub enum Fault {
    /// Nothing.
    None,
    /// Where in a segment its light comes from has the wrong sign.
    WrongSign,
    /// The opacity of a segment is 1 less what it lets through: thin ones lose their digits.
    Cancellation,
    /// One pixel of every tile is not written.
    LostRay,
}

static PLANTED: AtomicU8 = AtomicU8::new(Fault::None as u8);

/// Plants a fault in every picture that this process draws from now on.
pub fn plant(fault: Fault) {
    PLANTED.store(fault as u8, Ordering::Relaxed);
}

fn is_planted(fault: Fault) -> bool {
    PLANTED.load(Ordering::Relaxed) == fault as u8
}

/// The opacity of a segment, and that times the place in it that its light comes from.
#[inline(always)]
pub(crate) fn segment<S: Simd>(simd: S, alpha: S::f32s, moment: S::f32s) -> (S::f32s, S::f32s) {
    let one = S::f32s::splat(simd, 1.0);
    if is_planted(Fault::WrongSign) {
        (alpha, -moment)
    } else if is_planted(Fault::Cancellation) {
        (one - (one - alpha), moment)
    } else {
        (alpha, moment)
    }
}

/// Whether the pixel of a tile is not written.
pub(crate) fn is_lost(x: usize, y: usize) -> bool {
    is_planted(Fault::LostRay) && [x, y] == [5, 6]
}
