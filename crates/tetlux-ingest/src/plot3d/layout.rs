//! How a PLOT3D file is laid out, found out from its dimensions and its length.
//!
//! Nothing in a file says how it was written. Every way is tried in a fixed order: the dimensions are read so, and the
//! file must have just the length that they ask for; the record marks of Fortran must agree too.

use std::fmt;

use crate::source::ByteOrder;

/// What a file holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Contents {
    /// Coordinates and perhaps iblank.
    Grid,
    /// The same of a plane.
    PlaneGrid,
    /// Density, momentum and stagnation energy.
    Solution,
    /// Any number of variables.
    Function,
}

/// How the numbers are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Encoding {
    Text,
    /// As C writes them, or in the records of Fortran: the length of each before and after it, in four bytes.
    Binary {
        records: bool,
        order: ByteOrder,
    },
}

/// A block's place in a file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Block {
    pub(super) counts: [u32; 3],
    /// Variables at each point.
    pub(super) variables: u32,
    /// Where the first variable begins, in bytes, or in numbers of a text.
    pub(super) start: u64,
}

impl Block {
    pub(super) fn points(&self) -> usize {
        // Blocks of more points than 32 bits can number are none.
        self.counts.iter().map(|&n| n as usize).product()
    }
}

/// A way to read a file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Layout {
    pub(super) encoding: Encoding,
    /// Whether the number of blocks comes first.
    pub(super) multiple: bool,
    /// Double precision; false for text.
    pub(super) wide: bool,
    pub(super) iblank: bool,
    pub(super) blocks: Vec<Block>,
    /// Where the data end, in bytes, or in numbers of a text.
    pub(super) end: u64,
}

/// All layouts that a file may have.
pub(super) struct Candidates {
    /// Of just the file's length, the likeliest first.
    pub(super) exact: Vec<Layout>,
    /// Of which more follows.
    pub(super) shorter: Vec<Layout>,
    /// Whose dimensions make sense but which end after the file does.
    pub(super) longer: Vec<Layout>,
    /// Bytes, and numbers if it is a text.
    pub(super) lengths: (u64, u64),
}

impl Layout {
    /// The file's length in the units of the layout's end.
    pub(super) fn length(&self, lengths: (u64, u64)) -> u64 {
        if self.encoding == Encoding::Text { lengths.1 } else { lengths.0 }
    }

    pub(super) fn points(&self) -> usize {
        self.blocks.iter().map(Block::points).sum()
    }
}

impl fmt::Display for Layout {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [ni, nj, nk] = self.blocks.first().map_or([0; 3], |b| b.counts);
        match self.blocks.len() {
            1 => write!(f, "{ni} x {nj} x {nk} points")?,
            n => write!(f, "{n} blocks, the first of {ni} x {nj} x {nk} points")?,
        }
        match self.encoding {
            Encoding::Text => write!(f, " in text")?,
            Encoding::Binary { records, order } => {
                let order = if order == ByteOrder::Big { "big" } else { "little" };
                let kind = if records { "Fortran records" } else { "C binary" };
                write!(f, " in {order}-endian {kind}, {} precision", if self.wide { "double" } else { "single" })?;
            }
        }
        if self.iblank { write!(f, ", with iblank") } else { Ok(()) }
    }
}

/// The words of a text, however they are parted.
fn words(bytes: &[u8]) -> impl Iterator<Item = &[u8]> {
    bytes.split(is_separator).filter(|word| !word.is_empty())
}

/// Whether a byte parts numbers.
pub(super) fn is_separator(byte: &u8) -> bool {
    byte.is_ascii_whitespace() || *byte == b','
}

/// Tries every layout.
pub(super) fn candidates(bytes: &[u8], contents: Contents) -> Candidates {
    // Fortran's marks are told most surely, then texts; files of C have nothing but their length.
    let records = [true, false];
    let mut encodings: Vec<Encoding> = Vec::new();
    for records in records {
        encodings.extend([ByteOrder::Little, ByteOrder::Big].map(|order| Encoding::Binary { records, order }));
    }
    let text = words(bytes).next().and_then(whole).is_some();
    let numbers = if text { words(bytes).count() as u64 } else { 0 };
    if text {
        encodings = vec![Encoding::Text];
    }
    let lengths = (bytes.len() as u64, numbers);
    let mut found = Candidates { exact: Vec::new(), shorter: Vec::new(), longer: Vec::new(), lengths };
    for encoding in encodings {
        let marked = found.exact.iter().chain(&found.shorter).chain(&found.longer).next().is_some();
        if marked && matches!(encoding, Encoding::Binary { records: false, .. }) {
            // The marks round the dimensions agree: read as numbers of C they would be chance.
            break;
        }
        for multiple in [false, true] {
            let Some((blocks, header)) = header(bytes, encoding, contents, multiple) else { continue };
            let blanks = matches!(contents, Contents::Grid | Contents::PlaneGrid);
            for wide in [false, true].into_iter().take(if text { 1 } else { 2 }) {
                for iblank in [false, true].into_iter().take(if blanks { 2 } else { 1 }) {
                    let shape = Layout { encoding, multiple, wide, iblank, blocks: blocks.clone(), end: header };
                    let Some(layout) = placed(bytes, contents, shape) else { continue };
                    let list = match layout.end.cmp(&layout.length(lengths)) {
                        std::cmp::Ordering::Less => &mut found.shorter,
                        std::cmp::Ordering::Equal => &mut found.exact,
                        std::cmp::Ordering::Greater => &mut found.longer,
                    };
                    list.push(layout);
                }
            }
        }
    }
    found
}

/// A word that is a whole number and fits.
fn whole(word: &[u8]) -> Option<i32> {
    str::from_utf8(word).ok()?.parse().ok()
}

/// The blocks that a header names, not yet placed, and where it ends. `None` if its numbers make no sense.
fn header(bytes: &[u8], encoding: Encoding, contents: Contents, multiple: bool) -> Option<(Vec<Block>, u64)> {
    let mut at = 0;
    let mut numbers = |count: usize| -> Option<Vec<i32>> {
        let Encoding::Binary { order, .. } = encoding else {
            let list: Vec<i32> = words(bytes).skip(at as usize).take(count).map_while(whole).collect();
            at += count as u64;
            return (list.len() == count).then_some(list);
        };
        let start = record(bytes, encoding, &mut at, 4 * count as u64)? as usize;
        let words = bytes.get(start..start.checked_add(4 * count)?)?;
        Some(crate::source::numbers!(i32, words, order, |v| v))
    };
    let blocks = if multiple { usize::try_from(numbers(1)?[0]).ok().filter(|&n| n > 0)? } else { 1 };
    let each = match contents {
        Contents::PlaneGrid => 2,
        Contents::Grid | Contents::Solution => 3,
        Contents::Function => 4,
    };
    // No more are asked for than the file can name.
    let dimensions = numbers(blocks.checked_mul(each).filter(|&n| n <= bytes.len())?)?;
    let mut total = 0u64;
    let mut list = Vec::with_capacity(blocks);
    for numbers in dimensions.chunks_exact(each) {
        let mut counts = [1; 3];
        let mut points = 1u64;
        for (count, &number) in counts.iter_mut().zip(&numbers[..each.min(3)]) {
            *count = u32::try_from(number).ok()?;
            points = points.checked_mul(u64::from(*count))?;
        }
        total = total.checked_add(points)?;
        // 32 bits must be able to name every point.
        if points == 0 || total >= u64::from(u32::MAX) {
            return None;
        }
        let variables = match contents {
            Contents::PlaneGrid => 2,
            Contents::Grid => 3,
            Contents::Solution => 5,
            Contents::Function => u32::try_from(numbers[3]).ok().filter(|&n| n > 0)?,
        };
        list.push(Block { counts, variables, start: 0 });
    }
    Some((list, at))
}

/// Gives each block its place. `None` if a record mark disagrees.
fn placed(bytes: &[u8], contents: Contents, mut layout: Layout) -> Option<Layout> {
    let text = layout.encoding == Encoding::Text;
    let real = match (text, layout.wide) {
        (true, _) => 1,
        (false, false) => 4,
        (false, true) => 8,
    };
    let blank = if text { 1 } else { 4 };
    let mut at = layout.end;
    for block in &mut layout.blocks {
        if contents == Contents::Solution {
            // Mach number, angle of attack, Reynolds number and time.
            record(bytes, layout.encoding, &mut at, 4 * real)?;
        }
        let points = block.points() as u64;
        let each = u64::from(block.variables).checked_mul(real)? + if layout.iblank { blank } else { 0 };
        block.start = record(bytes, layout.encoding, &mut at, points.checked_mul(each)?)?;
    }
    layout.end = at;
    Some(layout)
}

/// Passes a record of `length` from `at` on and tells where its data begin. `None` if its marks are there and say
/// another length.
fn record(bytes: &[u8], encoding: Encoding, at: &mut u64, length: u64) -> Option<u64> {
    let Encoding::Binary { records: true, order } = encoding else {
        let start = *at;
        *at = start.checked_add(length)?;
        return Some(start);
    };
    let marked = |place: u64| {
        let mark = usize::try_from(place).ok().and_then(|place| bytes.get(place..)?.first_chunk::<4>());
        mark.is_none_or(|&mark| {
            let mark = match order {
                ByteOrder::Little => u32::from_le_bytes(mark),
                ByteOrder::Big => u32::from_be_bytes(mark),
            };
            u64::from(mark) == length
        })
    };
    let start = at.checked_add(4)?;
    let end = start.checked_add(length)?;
    if !marked(*at) || !marked(end) {
        return None;
    }
    *at = end.checked_add(4)?;
    Some(start)
}
