// Cells are projected where they are drawn, in the vertex stage: Wylie et al. 2002 (GATOR).
import package::lib::cell::{Cell};
import package::lib::mesh::{corners, entry_of};
import package::lib::thick::{decompose};

fn projected_cell(i: u32) -> Cell {
    return decompose(corners(i), entry_of(i));
}
