//! What can be done to the bytes of a file, by tests and by `cargo xtask stress` alike.

/// One way to damage a file; places are fractions of its length, so that they fit any.
#[derive(Debug, Clone)]
pub(crate) enum Damage {
    Truncate(f64),
    Flip(f64, u8),
    /// Exchanges two stretches of a length.
    Swap(f64, f64, usize),
    Insert(f64, Vec<u8>),
    /// Writes a stretch of a length a second time, behind itself.
    Repeat(f64, usize),
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
            Damage::Repeat(at, length) => {
                let at = place(at, bytes);
                let stretch = bytes[at..(at + length).min(bytes.len())].to_vec();
                bytes.splice(at..at, stretch);
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

/// Counts, lengths and values that a word should not hold: the largest of each size, a NaN, types of cells.
pub(crate) const NUMBERS: [u64; 15] = [
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
