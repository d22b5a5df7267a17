//! Options that a file has no use for: an error, for silence would look like an answer.

use std::path::Path;

use tetlux_ingest::{Expression, ReadOptions, read};

use crate::writers::{Encoding, Folder, PLAIN, two_hexahedra, vtu};

#[test]
fn options_that_a_file_has_no_use_for_are_refused() {
    let folder = Folder::new();
    let solution = || ReadOptions { solution: Some("q.bin".into()), ..ReadOptions::default() };
    let time = || ReadOptions { time: Some(0), ..ReadOptions::default() };
    let size = || ReadOptions { cell_size: Some(0.1), ..ReadOptions::default() };
    let field = || {
        let expressions = vec![("f".to_string(), Expression::parse("x").unwrap())];
        ReadOptions { expressions, ..ReadOptions::default() }
    };
    let files = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/files");
    let surface = folder.write("s.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
    let grid = folder.write("g.xyz", &PLAIN.grid([2, 2, 2], |_, u| u, |_| 1));
    let vtu = folder.write("a.vtu", &vtu(&two_hexahedra(), Encoding::default()));
    let (legacy, gmsh) = (files.join("vtk_legacy/cells_42_ascii.vtk"), files.join("gmsh/tetrahedra_1_41_ascii.msh"));
    let (tetgen, exodus) = (files.join("tetgen/meshio.node"), files.join("exodus/classic.e"));
    for (path, options, asked) in [
        (&vtu, vec![solution(), size(), field()], ["a solution", "a cell size", "a field"].as_slice()),
        (&legacy, vec![solution(), time(), size(), field()], &["a solution", "a time step", "a cell size", "a field"]),
        (&gmsh, vec![solution(), size(), field()], &["a solution", "a cell size", "a field"]),
        (&exodus, vec![solution(), size(), field()], &["a solution", "a cell size", "a field"]),
        (&tetgen, vec![solution(), time(), size(), field()], &["a solution", "a time step", "a cell size", "a field"]),
        (&grid, vec![time(), size(), field()], &["a time step", "a cell size", "a field"]),
        (&surface, vec![solution(), time()], &["a solution", "a time step"]),
    ] {
        assert!(read(path, &ReadOptions::default()).is_ok(), "{}", path.display());
        for (options, asked) in options.iter().zip(asked) {
            let error = read(path, options).unwrap_err().to_string();
            let name = path.file_name().unwrap().to_str().unwrap();
            assert!(error.contains(asked) && error.contains(name) && error.contains("leave it out"), "{error}");
        }
    }
    // Files that can have time steps but have none.
    let plain = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n$EndNodes\n\
                 $Elements\n1\n1 4 0 1 2 3 4\n$EndElements\n";
    let plain = folder.write("plain.msh", plain.as_bytes());
    assert!(read(&plain, &ReadOptions::default()).is_ok());
    for path in [&vtu, &plain] {
        let error = read(path, &time()).unwrap_err().to_string();
        assert!(error.contains("time step 0 is out of range"), "{error}");
    }
    assert!(read(&surface, &ReadOptions { expressions: field().expressions, ..size() }).is_ok());
}
