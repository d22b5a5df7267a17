use std::path::PathBuf;

use glam::DVec3;
use proptest::prelude::*;
use tetlux_mesh::Field;
use tetlux_mesh::procedural::Split;

use super::layout::Encoding::{Binary, Text};
use super::*;
use crate::ReadOptions;
use crate::damage::{config, damages};
use crate::source::ByteOrder::{Big, Little};

/// How a file is written.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Writer {
    encoding: Encoding,
    wide: bool,
    iblank: bool,
    multiple: bool,
}

const SIZES: [[i32; 3]; 2] = [[4, 3, 2], [2, 5, 3]];

impl Writer {
    /// Every encoding, precision, with and without iblank, of one block and of two.
    fn all() -> Vec<Writer> {
        let mut all = Vec::new();
        let orders = [Little, Big];
        let binary = [false, true].iter().flat_map(|&records| orders.map(|order| Binary { records, order }));
        for encoding in binary.chain([Text]) {
            for bits in 0..8 {
                let [wide, iblank, multiple] = [1, 2, 4].map(|bit| bits & bit != 0);
                if encoding != Text || !wide {
                    all.push(Writer { encoding, wide, iblank, multiple });
                }
            }
        }
        all
    }

    fn sizes(self) -> &'static [[i32; 3]] {
        if self.multiple { &SIZES } else { &SIZES[..1] }
    }

    fn whole(self, v: i32) -> Vec<u8> {
        match self.encoding {
            Text => format!("{v} ").into_bytes(),
            Binary { order: Little, .. } => v.to_le_bytes().to_vec(),
            Binary { order: Big, .. } => v.to_be_bytes().to_vec(),
        }
    }

    fn real(self, v: f64) -> Vec<u8> {
        match (self.encoding, self.wide) {
            // As Fortran writes double precision, among commas.
            (Text, _) => format!("{}, ", format!("{v:e}").replace('e', "D")).into_bytes(),
            (Binary { order: Little, .. }, false) => (v as f32).to_le_bytes().to_vec(),
            (Binary { order: Little, .. }, true) => v.to_le_bytes().to_vec(),
            (Binary { order: Big, .. }, false) => (v as f32).to_be_bytes().to_vec(),
            (Binary { order: Big, .. }, true) => v.to_be_bytes().to_vec(),
        }
    }

    fn record(self, bytes: Vec<u8>) -> Vec<u8> {
        match self.encoding {
            Binary { records: true, .. } => {
                let mark = self.whole(bytes.len() as i32);
                [mark.clone(), bytes, mark].concat()
            }
            Binary { .. } => bytes,
            Text => [bytes, b"\n".to_vec()].concat(),
        }
    }

    /// A header with these numbers after the dimensions of each block.
    fn header(self, more: &[i32]) -> Vec<u8> {
        let number = if self.multiple { self.record(self.whole(self.sizes().len() as i32)) } else { Vec::new() };
        let dimensions = self.sizes().iter().flat_map(|n| n.iter().chain(more)).flat_map(|&n| self.whole(n)).collect();
        [number, self.record(dimensions)].concat()
    }

    fn grid(self, place: impl Fn(usize, usize) -> DVec3, iblank: impl Fn(usize, usize) -> i32) -> Vec<u8> {
        let mut bytes = self.header(&[]);
        for (b, n) in self.sizes().iter().enumerate() {
            let points = n.iter().product::<i32>() as usize;
            let mut block: Vec<u8> = (0..3)
                .flat_map(|axis| (0..points).map(move |p| (axis, p)))
                .flat_map(|(axis, p)| self.real(place(b, p)[axis]))
                .collect();
            if self.iblank {
                block.extend((0..points).flat_map(|p| self.whole(iblank(b, p))));
            }
            bytes.extend(self.record(block));
        }
        bytes
    }

    fn variables(self, flow: bool, count: usize) -> Vec<u8> {
        let mut bytes = if flow { self.header(&[]) } else { self.header(&[count as i32]) };
        for (b, n) in self.sizes().iter().enumerate() {
            let points = n.iter().product::<i32>() as usize;
            if flow {
                bytes.extend(self.record([2.95, 0.0, 1e5, 0.0].iter().flat_map(|&v| self.real(v)).collect()));
            }
            let values = (0..count).flat_map(|v| (0..points).map(move |p| value(b, v, p)));
            bytes.extend(self.record(values.flat_map(|v| self.real(v)).collect()));
        }
        bytes
    }
}

const C: Writer =
    Writer { encoding: Binary { records: false, order: Big }, wide: false, iblank: false, multiple: false };

/// Exact in single precision.
fn value(block: usize, variable: usize, point: usize) -> f64 {
    (1000 * block + 100 * variable + point) as f64 * 0.25
}

/// The lattice of a block, halved; blocks far apart.
fn lattice(block: usize, point: usize) -> DVec3 {
    let [ni, nj, _] = SIZES[block].map(|n| n as usize);
    let ijk = [point % ni, point / ni % nj, point / ni / nj];
    DVec3::from_array(ijk.map(|i| i as f64 * 0.5)) + DVec3::X * (16 * block) as f64
}

struct Folder(tempfile::TempDir);

impl Folder {
    fn new() -> Self {
        Folder(tempfile::tempdir().unwrap())
    }

    fn write(&self, name: &str, bytes: &[u8]) -> PathBuf {
        let path = self.0.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        path
    }
}

fn load(grid: &[u8], solution: Option<&[u8]>) -> Result<MixedMesh, IngestError> {
    let folder = Folder::new();
    let solution = solution.map(|bytes| folder.write("q.bin", bytes));
    crate::read(&folder.write("g.xyz", grid), &ReadOptions { solution, ..ReadOptions::default() })
}

fn expected(writer: Writer, variables: std::ops::Range<usize>) -> Vec<f64> {
    let points = |b: usize| 0..writer.sizes()[b].iter().product::<i32>() as usize;
    (0..writer.sizes().len())
        .flat_map(|b| points(b).map(move |p| (b, p)))
        .flat_map(|(b, p)| variables.clone().map(move |v| value(b, v, p)))
        .collect()
}

#[test]
fn every_encoding_of_grid_and_solution_is_found_out() {
    for writer in Writer::all() {
        let mesh = load(&writer.grid(lattice, |_, _| -1), Some(&writer.variables(true, 5))).unwrap();
        assert_eq!(mesh.notes, [""; 0], "{writer:?}");
        assert_eq!(mesh.points.len(), if writer.multiple { 54 } else { 24 });
        assert_eq!(mesh.points[23], lattice(0, 23));
        assert_eq!(mesh.grids.len(), writer.sizes().len());
        assert!(mesh.grids.iter().all(|g| g.blanked.is_some() == writer.iblank));
        let wanted = [
            Field::point("Density", 1, expected(writer, 0..1)),
            Field::point("Momentum", 3, expected(writer, 1..4)),
            Field::point("StagnationEnergy", 1, expected(writer, 4..5)),
        ];
        assert_eq!(mesh.fields, wanted, "{writer:?}");
        // 3 x 2 x 1 and 1 x 4 x 2 hexahedra of edge 1/2.
        let hexahedra = if writer.multiple { 6 + 8 } else { 6 };
        assert_eq!(mesh.cell_counts(), [("hexahedra", hexahedra)]);
        let report = mesh.tetrahedralize(Split::Six).unwrap().validate();
        assert_eq!(report.cells, 6 * hexahedra);
        let volume = hexahedra as f64 / 8.0;
        assert!((report.volume - volume).abs() < 1e-14 * volume, "{}", report.volume);
    }
}

#[test]
fn grid_and_solution_may_be_written_in_different_ways() {
    for grid in Writer::all() {
        for solution in Writer::all().into_iter().filter(|s| s.multiple == grid.multiple) {
            let mesh = load(&grid.grid(lattice, |_, _| 1), Some(&solution.variables(true, 5))).unwrap();
            assert_eq!(mesh.fields[0].values, expected(grid, 0..1), "{grid:?} {solution:?}");
        }
    }
}

#[test]
fn function_files_have_any_number_of_variables() {
    for writer in Writer::all() {
        for count in [1, 2, 5] {
            let mesh = load(&writer.grid(lattice, |_, _| 1), Some(&writer.variables(false, count))).unwrap();
            let wanted: Vec<Field> =
                (0..count).map(|v| Field::point(format!("Function{}", v + 1), 1, expected(writer, v..v + 1))).collect();
            assert_eq!(mesh.fields, wanted, "{writer:?}");
        }
    }
}

#[test]
fn blanked_points_of_each_block_leave_their_cells_out() {
    for writer in Writer::all().into_iter().filter(|w| w.iblank) {
        // The first point of a block is a corner of one hexahedron.
        let mesh = load(&writer.grid(lattice, |_, p| if p == 0 { 0 } else { -7 }), None).unwrap();
        let (blocks, hexahedra) = if writer.multiple { (2, 14) } else { (1, 6) };
        assert_eq!(mesh.cell_counts(), [("hexahedra", hexahedra - blocks)]);
        assert_eq!(mesh.notes.len(), 1);
        assert!(mesh.notes[0].starts_with(&format!("{blocks} hexahedra have a blanked corner")), "{:?}", mesh.notes);
    }
}

#[test]
fn grids_of_a_plane_are_refused_as_such() {
    for writer in Writer::all().into_iter().filter(|w| !w.multiple) {
        let mut bytes = writer.record([7, 5].iter().flat_map(|&n| writer.whole(n)).collect());
        let mut block: Vec<u8> = (0..70).flat_map(|p| writer.real(f64::from(p) * 0.5 + 0.25)).collect();
        if writer.iblank {
            block.extend((0..35).flat_map(|_| writer.whole(1)));
        }
        bytes.extend(writer.record(block));
        let error = load(&bytes, None).unwrap_err();
        assert!(matches!(error, IngestError::Unsupported { .. }), "{writer:?} {error}");
        assert!(error.to_string().contains("2-D PLOT3D grid: 7 x 5"), "{writer:?} {error}");
    }
}

#[test]
fn a_solution_in_place_of_the_grid_is_told() {
    for writer in Writer::all() {
        let error = load(&writer.variables(true, 5), None).unwrap_err().to_string();
        assert!(error.contains("a PLOT3D solution where a grid is needed"), "{writer:?} {error}");
    }
}

/// Whether a file of C cut to this length is another whole one: in single precision, or without iblank.
fn whole_otherwise(writer: Writer, length: usize, written: impl Fn(Writer) -> Vec<u8>) -> bool {
    let ways = [(false, false), (false, true), (true, false)];
    let lengths = ways.map(|(wide, iblank)| written(Writer { wide, iblank, ..writer }).len());
    // The header of two blocks is also that of one of 2 x 4 x 3 points.
    let single = writer.multiple && [12, 16, 24, 28].contains(&(length.saturating_sub(12) / 24)) && length % 24 == 12;
    matches!(writer.encoding, Binary { records: false, .. }) && (single || lengths.contains(&length))
}

#[test]
fn every_truncation_is_an_error() {
    for writer in Writer::all().into_iter().filter(|w| w.encoding != Text) {
        let grid = writer.grid(lattice, |_, _| 1);
        for length in 0..grid.len() {
            let whole = whole_otherwise(writer, length, |w| w.grid(lattice, |_, _| 1));
            assert_eq!(load(&grid[..length], None).is_ok(), whole, "{writer:?} {length}");
        }
        let solution = writer.variables(true, 5);
        for length in 0..solution.len() {
            let result = load(&grid, Some(&solution[..length]));
            let whole = whole_otherwise(writer, length, |w| w.variables(true, 5));
            assert!(whole || result.is_err(), "{writer:?} {length}");
            assert!(whole || result.unwrap_err().to_string().contains("q.bin"), "{writer:?} {length}");
        }
    }
}

#[test]
fn texts_of_too_few_or_too_many_numbers_are_refused() {
    for writer in Writer::all().into_iter().filter(|w| w.encoding == Text) {
        let grid = String::from_utf8(writer.grid(lattice, |_, _| 1)).unwrap();
        let words: Vec<&str> = grid.split_whitespace().collect();
        // The header of two blocks is also that of one of 2 x 4 x 3 points, and cut there the text is whole.
        let single = if writer.multiple { 3 + 3 * 24 } else { 0 };
        for count in (0..words.len()).filter(|&n| n != single) {
            let text = words[..count].join(" ");
            let without = Writer { iblank: false, ..writer }.grid(lattice, |_, _| 1);
            let whole = writer.iblank && String::from_utf8(without).unwrap().split_whitespace().count() == count;
            assert_eq!(load(text.as_bytes(), None).is_ok(), whole, "{writer:?} {count}");
        }
        let error = load(format!("{grid} 7").as_bytes(), None).unwrap_err().to_string();
        assert!(error.contains("numbers") && error.contains("in text"), "{error}");
    }
}

#[test]
fn a_word_that_is_no_number_is_named_with_its_place() {
    let writer = Writer { encoding: Text, iblank: true, ..C };
    let grid = String::from_utf8(writer.grid(lattice, |_, _| 1)).unwrap();
    let place = grid.find("5D-1").unwrap();
    for word in ["x", "3*1.0", "--1"] {
        let error = load(grid.replacen("5D-1", word, 1).as_bytes(), None).unwrap_err().to_string();
        assert!(error.contains(&format!("at byte {place}")) && error.contains(word), "{error}");
    }
    let error = load(format!("{}0.5", &grid.trim_end()[..grid.trim_end().len() - 1]).as_bytes(), None).unwrap_err();
    assert!(error.to_string().contains("iblank"), "{error}");
}

#[test]
fn what_follows_the_records_of_fortran_is_noted() {
    for writer in Writer::all().into_iter().filter(|w| matches!(w.encoding, Binary { records: true, .. })) {
        let with = |mut bytes: Vec<u8>, more: usize| {
            bytes.extend(vec![1; more]);
            bytes
        };
        let grid = with(writer.grid(lattice, |_, _| 1), 40);
        let mesh = load(&grid, Some(&with(writer.variables(true, 5), 50))).unwrap();
        assert_eq!(mesh.notes.len(), 2, "{:?}", mesh.notes);
        assert!(mesh.notes[0].contains("the last 40 bytes") && mesh.notes[1].contains("the last 50 bytes"));
        assert_eq!(mesh.points[23], lattice(0, 23));
    }
}

#[test]
fn padding_to_a_block_of_a_tape_is_noted() {
    let mut grid = C.grid(lattice, |_, _| 1);
    let length = grid.len();
    grid.resize(TAPE as usize, 0);
    let mesh = load(&grid, None).unwrap();
    assert_eq!(mesh.notes, [format!("the last {} bytes are no data of the grid", 512 - length)]);
    grid.push(0);
    let error = load(&grid, None).unwrap_err().to_string();
    assert!(error.contains("300 or 396 or 588 or 684 bytes") && error.contains("found 513 bytes"), "{error}");
}

#[test]
fn record_marks_that_disagree_are_refused() {
    let writer = Writer { encoding: Binary { records: true, order: Little }, ..C };
    let grid = writer.grid(lattice, |_, _| 1);
    for at in [0, 16, 20, grid.len() - 4] {
        let mut bytes = grid.clone();
        bytes[at] ^= 4;
        let error = load(&bytes, None).unwrap_err().to_string();
        assert!(error.contains("PLOT3D grid"), "{at}: {error}");
    }
}

#[test]
fn a_solution_on_other_blocks_is_refused() {
    let two = Writer { multiple: true, ..C };
    let error = load(&C.grid(lattice, |_, _| 1), Some(&two.variables(true, 5))).unwrap_err().to_string();
    assert!(error.contains("the number of blocks of a solution: found 2"), "{error}");
    assert!(matches!(
        load(&two.grid(lattice, |_, _| 1), Some(&C.variables(true, 5))),
        Err(IngestError::Malformed { .. })
    ));
}

#[test]
fn hostile_headers_are_refused() {
    for writer in Writer::all().into_iter().filter(|w| w.encoding != Text) {
        let grid = writer.grid(lattice, |_, _| 1);
        for at in (0..40).step_by(4) {
            for number in [0, -1, i32::MAX, i32::MIN, 1 << 16] {
                let mut bytes = grid.clone();
                bytes[at..at + 4].copy_from_slice(&writer.whole(number));
                // Where it hits no header the grid stays whole, but for the coordinate.
                if let Ok(mesh) = load(&bytes, None) {
                    assert!(at >= 12 && mesh.points.len() <= 54, "{writer:?} {at} {number}");
                }
            }
        }
    }
}

proptest! {
    #![proptest_config(config())]

    #[test]
    fn damaged_files_do_not_panic(
        writer in prop::sample::select(Writer::all()), which in 0usize..3, flow: bool, damages in damages(),
    ) {
        let mut grid = writer.grid(lattice, |_, p| [0, 1, -1][p % 3]);
        let mut solution = writer.variables(flow, 5);
        for damage in &damages {
            if which != 0 {
                damage.apply(&mut grid);
            }
            if which != 1 {
                damage.apply(&mut solution);
            }
        }
        match load(&grid, Some(&solution)) {
            Ok(mesh) => drop(mesh.tetrahedralize(Split::Six)),
            Err(error) => prop_assert!(error.to_string().len() < 1000, "{}", error),
        }
    }
}
