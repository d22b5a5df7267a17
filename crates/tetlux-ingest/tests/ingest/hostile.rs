//! Damaged files: whatever is in them, reading gives a mesh or an error and never a panic.

use proptest::prelude::*;
use tetlux_ingest::{ReadOptions, Split, read};

use crate::damage::{config, damages};
use crate::writers::{Encoding, Folder, Plot3d, two_hexahedra, vtu};

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
    #![proptest_config(config())]

    #[test]
    fn damaged_vtu_files_do_not_panic(which in 0usize..32, damages in damages()) {
        let mut bytes = vtu(&two_hexahedra(), Encoding::all()[which]);
        damages.iter().for_each(|d| d.apply(&mut bytes));
        survives(&bytes, None);
    }

    #[test]
    fn damaged_plot3d_files_do_not_panic(
        big: bool, iblank: bool, both: bool, damages in damages(),
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
