//! Damage to files, for tests that no content makes a reader panic or fill the memory: unit tests and integration tests
//! alike.

use proptest::prelude::*;

/// One way to damage a file; places are fractions of its length, so that they fit any.
#[derive(Debug, Clone)]
pub(crate) enum Damage {
    Truncate(f64),
    Flip(f64, u8),
    /// Exchanges two stretches of a length.
    Swap(f64, f64, usize),
    Insert(f64, Vec<u8>),
    /// Writes a number over whatever is there, in this many bytes, big-endian or not.
    Number(f64, u64, usize, bool),
    /// Writes a text in place of the n-th run of digits.
    Digits(usize, &'static str),
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
            Damage::Digits(n, text) => replace_number(bytes, n, text),
            Damage::Number(at, number, size, big) => {
                let mut word = number.to_le_bytes()[..size].to_vec();
                if big {
                    word.reverse();
                }
                // Where numbers begin in files of words.
                let at = place(at, bytes) / 4 * 4;
                let end = (at + size).min(bytes.len());
                bytes[at..end].copy_from_slice(&word[..end - at]);
            }
        }
    }
}

/// A few damages, many of them in the first bytes, where headers are.
pub(crate) fn damages() -> impl Strategy<Value = Vec<Damage>> {
    let at = || prop_oneof![0.0..1.0, 0.0..0.1];
    let numbers = vec![
        0,
        1,
        2,
        3,
        10,
        12,
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
    let number = prop::sample::select(numbers);
    let one = prop_oneof![
        1 => at().prop_map(Damage::Truncate),
        3 => (at(), 1u8..).prop_map(|(at, bits)| Damage::Flip(at, bits)),
        1 => (at(), at(), 1usize..64).prop_map(|(a, b, length)| Damage::Swap(a, b, length)),
        1 => (at(), prop::collection::vec(any::<u8>(), 1..20)).prop_map(|(at, more)| Damage::Insert(at, more)),
        2 => (0usize..60, prop::sample::select(&HOSTILE[..])).prop_map(|(n, text)| Damage::Digits(n, text)),
        3 => (at(), number, prop::sample::select(vec![4usize, 8]), any::<bool>())
            .prop_map(|(at, number, size, big)| Damage::Number(at, number, size, big)),
    ];
    prop::collection::vec(one, 1..4)
}

/// Some hundreds of cases, or as many as the environment variable `TETLUX_STRESS_CASES` says.
pub(crate) fn config() -> ProptestConfig {
    let cases = std::env::var("TETLUX_STRESS_CASES").ok().and_then(|n| n.parse().ok()).unwrap_or(400);
    ProptestConfig { cases, failure_persistence: None, ..ProptestConfig::default() }
}

/// Writes a text in place of the n-th run of digits, if there are so many.
pub(crate) fn replace_number(bytes: &mut Vec<u8>, n: usize, text: &str) {
    let starts = |i: usize| bytes[i].is_ascii_digit() && (i == 0 || !bytes[i - 1].is_ascii_digit());
    if let Some(start) = (0..bytes.len()).filter(|&i| starts(i)).nth(n) {
        let length = bytes[start..].iter().take_while(|b| b.is_ascii_digit()).count();
        bytes.splice(start..start + length, text.bytes());
    }
}

/// Numbers that a count, an index or a value should not be.
pub(crate) const HOSTILE: [&str; 12] = [
    "0",
    "1",
    "-1",
    "255",
    "4294967295",
    "4294967296",
    "3037000500",
    "9223372036854775807",
    "18446744073709551616",
    "1e400",
    "nan",
    "",
];
