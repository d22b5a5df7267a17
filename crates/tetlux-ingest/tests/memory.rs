//! What memory a damaged file can make the readers take. The only test of its program, for the allocator counts what
//! all threads take.
#![expect(clippy::unwrap_used, reason = "a test's helpers fail like the test")]

#[path = "../src/damage.rs"]
mod damage;

use std::fs;
use std::path::{Path, PathBuf};

use damage::{config, damages};
use peak_alloc::PeakAlloc;
use proptest::prelude::*;
use proptest::test_runner::TestRunner;
use tetlux_ingest::{ReadOptions, read};

#[global_allocator]
static MEMORY: PeakAlloc = PeakAlloc;

/// Bytes that reading may take whatever the file: a lattice that no array tells of, what decompressors begin with.
const ALWAYS: usize = 4 << 20;

/// Bytes for each byte of a file: its own, its numbers as `f64` (two characters, or one byte, can be a number), and as
/// points and cells.
const FOR_EACH: usize = 16;

/// Bytes taken at the most while something is done, beside those that were taken before.
fn peak(work: impl FnOnce()) -> usize {
    MEMORY.reset_peak_usage();
    let before = MEMORY.current_usage();
    work();
    MEMORY.peak_usage().saturating_sub(before)
}

/// Files by name: those that other programs wrote, and a PLOT3D grid.
fn files(folder: &str) -> Vec<(String, Vec<u8>)> {
    if folder == "plot3d" {
        let dimensions = [3i32, 2, 3].into_iter().flat_map(i32::to_le_bytes);
        let coordinates = (0..3 * 18).flat_map(|i| ((i * 7 % 5) as f32).to_le_bytes());
        return vec![("grid.xyz".into(), dimensions.chain(coordinates).collect())];
    }
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/files").join(folder);
    let mut paths: Vec<PathBuf> = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    paths.sort();
    let file = |path: PathBuf| (path.file_name().unwrap().to_string_lossy().into_owned(), fs::read(path).unwrap());
    paths.into_iter().filter(|path| path.is_file()).map(file).collect()
}

#[test]
fn no_damage_makes_a_small_file_take_much_memory() {
    let seen = peak(|| drop(std::hint::black_box(vec![1u8; 2 * ALWAYS])));
    assert!((2 * ALWAYS..3 * ALWAYS).contains(&seen), "what is taken is seen: {seen}");
    for folder in ["exodus", "gmsh", "plot3d", "tetgen", "vtk_legacy", "vtk_xml"] {
        let files = files(folder);
        let temporary = tempfile::tempdir().unwrap();
        // So that TetGen's files and collections find theirs.
        files.iter().for_each(|(name, bytes)| fs::write(temporary.path().join(name), bytes).unwrap());
        let all: usize = files.iter().map(|(_, bytes)| bytes.len()).max().unwrap_or_default();
        let mut runner = TestRunner::new(ProptestConfig { cases: config().cases / 2, ..config() });
        let result = runner.run(&(0..files.len(), damages()), |(which, damages)| {
            let (name, whole) = &files[which];
            let mut bytes = whole.clone();
            damages.iter().for_each(|damage| damage.apply(&mut bytes));
            let path = temporary.path().join(name);
            fs::write(&path, &bytes).unwrap();
            let taken = peak(|| drop(read(&path, &ReadOptions::default())));
            fs::write(&path, whole).unwrap();
            // A collection reads others, each no larger than the largest.
            let most = ALWAYS + FOR_EACH * bytes.len().max(all);
            prop_assert!(taken <= most, "{name}: {taken} bytes for {}", bytes.len());
            Ok(())
        });
        result.unwrap();
    }
}
