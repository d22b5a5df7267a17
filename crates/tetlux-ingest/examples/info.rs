//! What a mesh file holds: `cargo run --example info -- mesh.vtu`, or `-- grid.xyz solution.q` for PLOT3D.
#![expect(clippy::print_stdout, reason = "an example shows its result")]

use tetlux_ingest::{ReadOptions, Split, read};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args_os().skip(1);
    let path = arguments.next().ok_or("name a mesh file")?;
    let mixed =
        read(path.as_ref(), &ReadOptions { solution: arguments.next().map(Into::into), ..ReadOptions::default() })?;
    println!("{} points; {:?}", mixed.points.len(), mixed.cell_counts());
    mixed.notes.iter().for_each(|note| println!("note: {note}"));
    let mesh = mixed.tetrahedralize(Split::default())?;
    for field in mesh.fields() {
        println!("{}: {:?}", field.name, field.range(tetlux_mesh::Component::Magnitude));
    }
    println!("{:#?}", mesh.validate());
    Ok(())
}
