//! The data sets of the literature, where they are present.

use std::path::{Path, PathBuf};

use tetlux_ingest::{MixedMesh, ReadOptions, Split, read};
use tetlux_mesh::procedural::for_each_hexahedron;
use tetlux_mesh::{Component, TetMesh};

fn data(name: &str) -> Option<PathBuf> {
    let path = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/data")).join(name);
    if path.exists() {
        return Some(path);
    }
    println!("the data set {name} is absent: not tested");
    None
}

fn plot3d(grid: &str, solution: &str) -> Option<MixedMesh> {
    let options = ReadOptions { solution: Some(data(solution)?), ..ReadOptions::default() };
    Some(read(&data(grid)?, &options).unwrap())
}

fn range(mesh: &TetMesh, field: &str) -> [f64; 2] {
    mesh.scalar(field, Component::Magnitude).unwrap().range
}

/// Pairs of a hexahedron and an edge of it whose ends coincide.
fn collapsed_edges(mesh: &MixedMesh) -> usize {
    const EDGES: [[usize; 2]; 12] =
        [[0, 1], [1, 2], [2, 3], [3, 0], [4, 5], [5, 6], [6, 7], [7, 4], [0, 4], [1, 5], [2, 6], [3, 7]];
    let mut collapsed = 0;
    for_each_hexahedron(mesh.grids[0].counts, |_, corners| {
        let point = |i: usize| mesh.points[corners[i] as usize];
        collapsed += EDGES.iter().filter(|&&[a, b]| point(a) == point(b)).count();
    });
    collapsed
}

#[test]
fn blunt_fin() {
    let Some(mixed) = plot3d("bluntfinxyz.bin", "bluntfinq.bin") else { return };
    assert_eq!(mixed.cell_counts(), [("hexahedra", 37_479)]);
    assert_eq!(mixed.grids[0].counts, [40, 32, 32]);
    assert!(mixed.notes.len() == 1 && mixed.notes[0].contains("the last 484 bytes"), "{:?}", mixed.notes);

    // An edge of a hexahedron split into five belongs to one of the five: each collapsed edge costs a tetrahedron.
    let collapsed = collapsed_edges(&mixed);
    let mesh = mixed.clone().tetrahedralize(Split::Five).unwrap();
    let report = mesh.validate();
    assert_eq!(report.assembly.cells_given, 187_395);
    assert_eq!(report.assembly.points_merged, 39);
    assert_eq!(report.assembly.cells_repeated, collapsed);
    assert_eq!(report.assembly.cells_repeated + report.assembly.cells_flat, 77);
    assert_eq!(report.quads_split_both_ways, 0);
    assert_eq!(range(&mesh, "Density").map(|v| v as f32), [0.1926, 4.9775]);

    // Six a hexahedron, but for one beside the point where the collapsed line begins: the points of that line have the
    // smallest indices there, so that it is cut from one of them, and the sixth would have two corners in one.
    let six = mixed.tetrahedralize(Split::Six).unwrap().validate();
    assert_eq!((six.assembly.cells_given, six.quads_split_both_ways), (6 * 37_479 - 1, 0));
    // Both splits fill the same hexahedra, but the fin's curved surface with other triangles: a hundredth is far more
    // than that, and far less than any block of hexahedra.
    assert!((six.volume / report.volume - 1.0).abs() < 1e-2, "{} and {}", six.volume, report.volume);

    // VTK made these tetrahedra of the same file, those without volume left out.
    let Some(path) = data("tets/bluntfin_tets.vtu") else { return };
    let vtk = read(&path, &ReadOptions::default()).unwrap().tetrahedralize(Split::Five).unwrap();
    assert_eq!(vtk.points(), mesh.points());
    assert_eq!(vtk.cells().len(), mesh.cells().len());
    assert_eq!(range(&vtk, "scalar"), range(&mesh, "Density"));
    assert_eq!(
        vtk.scalar("scalar", Component::Magnitude).unwrap().values,
        mesh.scalar("Density", Component::Magnitude).unwrap().values
    );
    // VTK splits alternate hexahedra alike: the tetrahedra are the same, whatever their order and corners' order.
    let sets = |mesh: &TetMesh| {
        let mut cells = mesh.cells().to_vec();
        cells.iter_mut().for_each(|cell| cell.sort_unstable());
        cells.sort_unstable();
        cells
    };
    assert!(sets(&vtk) == sets(&mesh));
    // Sums of the same 187 318 terms in another order: each addition rounds by 1.1e-16 at most.
    let tolerance = 187_318.0 * f64::EPSILON;
    let difference = (vtk.validate().volume / report.volume - 1.0).abs();
    assert!(difference < tolerance, "volumes differ by {difference:e}");
}

#[test]
fn oxygen_post() {
    let Some(mixed) = plot3d("postxyz.bin", "postq.bin") else { return };
    assert_eq!(mixed.cell_counts(), [("hexahedra", 102_675)]);
    assert_eq!(mixed.notes, [""; 0]);
    let mesh = mixed.clone().tetrahedralize(Split::Five).unwrap();
    let report = mesh.validate();
    assert_eq!((report.cells, report.assembly.points_merged), (513_375, 1_444));
    // The O-grid has 75 hexahedra round the post, an odd number, so that the five-way split's two colours meet at its
    // seam: each of the 37 x 37 quadrilaterals there is cut both ways.
    assert_eq!(report.quads_split_both_ways, 37 * 37);
    assert_eq!(range(&mesh, "Density"), [1.0, 1.0]);
    assert_eq!(range(&mesh, "StagnationEnergy").map(|v| (v * 1e4).round()), [-5415.0, 43958.0]);

    let six = mixed.tetrahedralize(Split::Six).unwrap().validate();
    assert_eq!((six.cells, six.quads_split_both_ways), (6 * 102_675, 0));
}

/// Points, tetrahedra and range of `scalar` as the scene file that goes with the meshes states them.
#[test]
fn meshes_that_vtk_made() {
    for (name, points, cells, scalar) in [
        ("tets/bluntfin_tets.vtu", 40_960, 187_318, [0.19259999692440033, 4.977499961853027]),
        ("tets/post_tets.vtu", 109_744, 513_375, [0.0, 1.3914440870285034]),
        ("tets/disk_tets.vtu", 8_499, 44_832, [293.1499938964844, 913.1500244140625]),
    ] {
        let Some(path) = data(name) else { continue };
        let mixed = read(&path, &ReadOptions::default()).unwrap();
        assert_eq!((mixed.points.len(), mixed.cell_counts()), (points, vec![("tetrahedra", cells)]), "{name}");
        let mesh = mixed.tetrahedralize(Split::Six).unwrap();
        assert_eq!(mesh.cells().len(), cells, "{name}");
        assert_eq!(range(&mesh, "scalar"), scalar, "{name}");
    }
}
