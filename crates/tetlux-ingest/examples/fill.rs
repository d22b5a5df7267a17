//! Fills a closed surface with tetrahedra: `cargo run --example fill -- part.stl 0.5 "x*y"`.
#![expect(clippy::print_stdout, reason = "an example shows its result")]

use std::path::Path;
use std::time::Instant;

use tetlux_ingest::{Expression, Surface, TetMesh, fill};
use tetlux_mesh::Component;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [path, cell_size, formulas @ ..] = arguments.as_slice() else {
        return Err("name an .obj or .stl file, a cell size, and formulas if you like".into());
    };
    let surface = Surface::read(Path::new(path))?;
    println!("{:#?}", surface.report());
    let parse = |text: &String| Expression::parse(text).map(|formula| (text.clone(), formula));
    let expressions = formulas.iter().map(parse).collect::<Result<Vec<_>, _>>()?;
    let start = Instant::now();
    let filled = fill(&surface, cell_size.parse()?, &expressions)?;
    let seconds = start.elapsed().as_secs_f64();
    println!("{} tetrahedra in {seconds:.3} s", filled.parts.cells.len());
    surface.notes.iter().chain(&filled.notes).for_each(|note| println!("note: {note}"));
    let mesh = TetMesh::assemble(&filled.parts.points, &filled.parts.cells, filled.fields)?;
    for field in mesh.fields() {
        println!("{}: {:?}", field.name, field.range(Component::Magnitude));
    }
    println!("{:#?}", mesh.validate());
    Ok(())
}
