//! Damaged files: whatever is in them, reading gives a mesh or an error and never a panic.

use proptest::prelude::*;
use tetlux_ingest::{ReadOptions, Split, read};

use crate::writers::{Encoding, Folder, Plot3d, two_hexahedra, vtu};

/// One way to damage a file; places are fractions of its length, so that they fit any.
#[derive(Debug, Clone)]
pub(crate) enum Damage {
    Truncate(f64),
    Flip(f64, u8),
    /// Exchanges two stretches of a length.
    Swap(f64, f64, usize),
    Insert(f64, Vec<u8>),
    /// Writes a number over whatever is there, as four or eight bytes in either order.
    Binary(f64, u64, bool, bool),
    /// Writes another number in place of the n-th run of digits.
    Digits(usize, &'static str),
}

pub(crate) fn damage() -> impl Strategy<Value = Damage> {
    let numbers = vec![
        0,
        1,
        7,
        0x7f,
        0xff,
        0x7fff_ffff,
        0x8000_0000,
        0xffff_ffff,
        0x7fc0_0000,
        1 << 40,
        i64::MAX as u64,
        u64::MAX,
    ];
    let digits = vec![
        "0",
        "1",
        "-1",
        "255",
        "4294967295",
        "4294967296",
        "9223372036854775807",
        "18446744073709551616",
        "1e400",
        "nan",
        "",
    ];
    prop_oneof![
        (0.0..1.0).prop_map(Damage::Truncate),
        (0.0..1.0, 1u8..).prop_map(|(at, bits)| Damage::Flip(at, bits)),
        (0.0..1.0, 0.0..1.0, 1usize..64).prop_map(|(a, b, length)| Damage::Swap(a, b, length)),
        (0.0..1.0, prop::collection::vec(any::<u8>(), 1..20)).prop_map(|(at, bytes)| Damage::Insert(at, bytes)),
        (0.0..1.0, prop::sample::select(numbers), any::<bool>(), any::<bool>())
            .prop_map(|(at, number, wide, big)| Damage::Binary(at, number, wide, big)),
        (0usize..60, prop::sample::select(digits)).prop_map(|(n, text)| Damage::Digits(n, text)),
    ]
}

impl Damage {
    pub(crate) fn apply(&self, bytes: &mut Vec<u8>) {
        let place = |at: f64, bytes: &[u8]| (at * bytes.len() as f64) as usize;
        if bytes.is_empty() {
            return;
        }
        match *self {
            Damage::Truncate(at) => bytes.truncate(place(at, bytes)),
            Damage::Flip(at, bits) => {
                let at = place(at, bytes);
                bytes[at] ^= bits;
            }
            Damage::Swap(a, b, length) => {
                let (a, b) = (place(a, bytes), place(b, bytes));
                let length = length.min(bytes.len() - a.max(b));
                (0..length).for_each(|i| bytes.swap(a + i, b + i));
            }
            Damage::Insert(at, ref more) => {
                let at = place(at, bytes);
                bytes.splice(at..at, more.iter().copied());
            }
            Damage::Binary(at, number, wide, big) => {
                let mut word =
                    if wide { number.to_le_bytes().to_vec() } else { (number as u32).to_le_bytes().to_vec() };
                if big {
                    word.reverse();
                }
                // Where numbers begin in files of words.
                let at = place(at, bytes) / 4 * 4;
                let end = (at + word.len()).min(bytes.len());
                bytes[at..end].copy_from_slice(&word[..end - at]);
            }
            Damage::Digits(n, text) => {
                let starts = |i: usize| bytes[i].is_ascii_digit() && (i == 0 || !bytes[i - 1].is_ascii_digit());
                if let Some(start) = (0..bytes.len()).filter(|&i| starts(i)).nth(n) {
                    let length = bytes[start..].iter().take_while(|b| b.is_ascii_digit()).count();
                    bytes.splice(start..start + length, text.bytes());
                }
            }
        }
    }
}

/// Reads and splits a file; true if a mesh came of it. Fails only by panic.
pub(crate) fn survives(grid: &[u8], solution: Option<&[u8]>) -> bool {
    let folder = Folder::new();
    let solution = solution.map(|bytes| folder.write("q.bin", bytes));
    let options = ReadOptions { solution, ..ReadOptions::default() };
    match read(&folder.write("a.xyz", grid), &options) {
        Ok(mesh) => [Split::Five, Split::Six].map(|split| mesh.clone().tetrahedralize(split).is_ok())[0],
        Err(error) => {
            assert!(error.to_string().len() < 1000, "a message of moderate length: {error}");
            false
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn damaged_vtu_files_do_not_panic(which in 0usize..32, damages in prop::collection::vec(damage(), 1..4)) {
        let mut bytes = vtu(&two_hexahedra(), Encoding::all()[which]);
        damages.iter().for_each(|d| d.apply(&mut bytes));
        survives(&bytes, None);
    }

    #[test]
    fn damaged_plot3d_files_do_not_panic(
        big: bool, iblank: bool, both: bool, damages in prop::collection::vec(damage(), 1..4),
    ) {
        let writer = Plot3d { big, iblank };
        let mut grid = writer.grid([3, 2, 3], |_, u| u, |p| [0, 1, -1][p % 3]);
        let mut solution = writer.solution([3, 2, 3], |v, p| (v * p) as f32);
        damages.iter().for_each(|d| d.apply(if both { &mut grid } else { &mut solution }));
        survives(&grid, Some(&solution));
    }
}

#[test]
fn undamaged_files_give_a_mesh_and_others_an_error() {
    assert!(survives(&vtu(&two_hexahedra(), Encoding::default()), None));
    assert!(!survives(b"<VTKFile", None));
}
