//! Frames in sequence, two at a time.

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc;

/// Frames that are made at a time: one is planned and ordered while the other is drawn, read back or written.
const LANES: usize = 2;

/// Makes the frames of a sequence, and hands them on in their order.
///
/// Frames are made on two threads, so that one is prepared while the one before is drawn: a device always has its next
/// picture waiting. `make` sees each number once. What it makes of one must not depend on the others: then every frame is
/// what it would be alone.
///
/// # Errors
///
/// Of the first frame that fails, once all frames before it have been handed on; no further frame is begun. Or what `each`
/// says.
pub fn frames<T: Send, E: Send>(
    numbers: std::ops::Range<usize>,
    make: impl Fn(usize) -> Result<T, E> + Sync,
    mut each: impl FnMut(usize, T) -> Result<(), E>,
) -> Result<(), E> {
    let (next, stopped) = (AtomicUsize::new(numbers.start), AtomicBool::new(false));
    std::thread::scope(|scope| {
        // No lane is more than a frame ahead of what was handed on.
        let (sender, receiver) = mpsc::sync_channel(0);
        for _ in 0..LANES.min(numbers.len()) {
            let (sender, numbers, next, stopped, make) = (sender.clone(), &numbers, &next, &stopped, &make);
            scope.spawn(move || {
                while !stopped.load(Ordering::Relaxed) {
                    let number = next.fetch_add(1, Ordering::Relaxed);
                    // Nobody listens any more once a frame has failed.
                    if !numbers.contains(&number) || sender.send((number, make(number))).is_err() {
                        return;
                    }
                }
            });
        }
        drop(sender);
        let mut expected = numbers.start;
        let mut waiting = BTreeMap::new();
        let mut hand_on = || -> Result<(), E> {
            for (number, frame) in &receiver {
                waiting.insert(number, frame);
                while let Some(frame) = waiting.remove(&expected) {
                    each(expected, frame?)?;
                    expected += 1;
                }
            }
            Ok(())
        };
        let result = hand_on();
        stopped.store(true, Ordering::Relaxed);
        drop(receiver);
        result
    })
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;

    #[test]
    fn frames_come_once_and_in_order() {
        let made = AtomicUsize::new(0);
        let make = |number: usize| {
            made.fetch_add(1, Ordering::Relaxed);
            // The even ones take longer: the odd ones have to wait.
            std::thread::sleep(Duration::from_millis(if number.is_multiple_of(2) { 3 } else { 0 }));
            Ok::<_, String>(number * number)
        };
        let mut seen = Vec::new();
        let each = |number, square| {
            seen.push((number, square));
            Ok(())
        };
        assert_eq!(frames(3..12, make, each), Ok(()));
        assert_eq!(seen, (3..12).map(|n| (n, n * n)).collect::<Vec<_>>());
        assert_eq!(made.load(Ordering::Relaxed), 9);
        assert_eq!(frames(0..0, |_| Ok::<(), String>(()), |_, ()| Ok(())), Ok(()));
    }

    #[test]
    fn a_frame_that_fails_leaves_those_before_it() {
        for failing in 0..6 {
            let make = |number| if number == failing { Err(format!("frame {number}")) } else { Ok(number) };
            let mut seen = Vec::new();
            let each = |_, frame| {
                seen.push(frame);
                Ok(())
            };
            assert_eq!(frames(0..100, make, each), Err(format!("frame {failing}")));
            assert_eq!(seen, (0..failing).collect::<Vec<_>>());
        }
    }

    #[test]
    fn what_cannot_be_handed_on_ends_the_sequence() {
        let each = |number, ()| if number == 2 { Err("full".to_string()) } else { Ok(()) };
        assert_eq!(frames(0..100, |_| Ok(()), each), Err("full".to_string()));
    }
}
