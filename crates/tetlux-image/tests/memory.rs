//! What memory a small file can make the readers take. The only test of its program, for the system counts what all
//! threads take.
#![cfg(target_os = "linux")]
#![expect(clippy::unwrap_used, reason = "a test's helpers fail like the test")]

use std::fs;
use std::path::Path;

use tetlux_image::{Image, ImageError, read_exr, read_png, write_exr};

/// Pixels a side that the files promise: four gigabytes of pixels.
const SIDE: u32 = 16_384;

/// Bytes that may be resident on the way: those of one row of blocks, and what decompressors take.
const MOST: u64 = 64 << 20;

/// The most bytes that were resident since the last call.
fn peak() -> u64 {
    let status = fs::read_to_string("/proc/self/status").unwrap();
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:")).unwrap();
    fs::write("/proc/self/clear_refs", "5").unwrap();
    1024 * line.split_whitespace().next().unwrap().parse::<u64>().unwrap()
}

/// An EXR of one pixel whose header promises more, and room for the table of its blocks.
fn exr(path: &Path) {
    write_exr(&Image::new(1, 1).unwrap(), path, None).unwrap();
    let mut bytes = fs::read(path).unwrap();
    for name in ["dataWindow\0box2i\0", "displayWindow\0box2i\0"] {
        let at = bytes.windows(name.len()).position(|window| window == name.as_bytes()).unwrap();
        // Behind the length of the value, its first corner.
        let last = at + name.len() + 4 + 8;
        let corner = (SIDE - 1).to_le_bytes();
        bytes[last..last + 8].copy_from_slice(&[corner, corner].concat());
    }
    bytes.extend(vec![0; 8 * SIDE as usize / 16]);
    fs::write(path, bytes).unwrap();
}

/// A PNG of the same, without data.
fn png(path: &Path) {
    let mut encoder = png::Encoder::new(fs::File::create(path).unwrap(), SIDE, SIDE);
    encoder.set_color(png::ColorType::Rgba);
    drop(encoder.write_header().unwrap());
}

#[test]
fn a_file_that_promises_more_than_it_gives_takes_little_memory() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("small");
    peak();
    let before = peak();
    // What is taken is seen.
    drop(std::hint::black_box(vec![1u8; 2 * MOST as usize]));
    assert!(peak() - before > MOST);
    for (make, read) in [(exr as fn(&Path), read_exr as fn(&Path) -> Result<Image, ImageError>), (png, read_png)] {
        make(&path);
        peak();
        let before = peak();
        let error = read(&path).unwrap_err();
        assert!(matches!(error, ImageError::Decode { .. } | ImageError::Unfit { .. }), "{error}");
        let taken = peak() - before;
        assert!(taken < MOST, "{taken} bytes for {}: {error}", fs::metadata(&path).unwrap().len());
    }
}
