use glam::DVec3;
use proptest::prelude::*;
use tetlux_mesh::Field;
use tetlux_mesh::procedural::Split;

use super::{element, read};
use crate::damage::mutation::{HOSTILE, replace_number};
use crate::damage::{config, damages};
use crate::source::Source;
use crate::{IngestError, MixedMesh};

/// How a file is written.
#[derive(Debug, Clone, Copy)]
struct Format {
    version: u8,
    /// Byte order: big-endian or not; `None` for words.
    big: Option<bool>,
    wide: bool,
    parametric: bool,
}

fn formats() -> Vec<Format> {
    let mut all = Vec::new();
    for big in [None, Some(false), Some(true)] {
        for parametric in [false, true] {
            all.push(Format { version: 2, big, wide: true, parametric });
            all.extend([false, true].map(|wide| Format { version: 4, big, wide, parametric }));
        }
    }
    all
}

/// Section, name, step, components, and each tag with its values.
type View = (&'static str, &'static str, u64, usize, Vec<(u64, Vec<f64>)>);

/// A mesh and views as they are written.
#[derive(Default)]
struct Model {
    nodes: Vec<(u64, DVec3)>,
    /// Tag, type and nodes.
    elements: Vec<(u64, u8, Vec<u64>)>,
    views: Vec<View>,
}

struct Writer {
    format: Format,
    bytes: Vec<u8>,
}

impl Writer {
    fn text(&mut self, text: &str) {
        self.bytes.extend(text.bytes());
    }

    fn number<const N: usize>(&mut self, mut little: [u8; N], word: String) {
        match self.format.big {
            None => return self.text(&format!("{word} ")),
            Some(true) => little.reverse(),
            Some(false) => {}
        }
        self.bytes.extend(little);
    }

    fn int(&mut self, v: u64) {
        self.number((v as i32).to_le_bytes(), v.to_string());
    }

    fn size(&mut self, v: u64) {
        if self.format.wide { self.number(v.to_le_bytes(), v.to_string()) } else { self.int(v) }
    }

    fn real(&mut self, v: f64) {
        self.number(v.to_le_bytes(), v.to_string());
    }

    fn line(&mut self) {
        if self.format.big.is_none() {
            self.text("\n");
        }
    }

    fn mesh(&mut self, model: &Model) {
        let Format { version, big, wide, parametric } = self.format;
        let name = if version == 2 { "2.2" } else { "4.1" };
        self.text(&format!("$MeshFormat\n{name} {} {}\n", u8::from(big.is_some()), if wide { 8 } else { 4 }));
        if big.is_some() {
            self.int(1);
            self.text("\n");
        }
        self.text("$EndMeshFormat\n$PhysicalNames\n1\n3 1 \"a volume\"\n$EndPhysicalNames\n");
        let section = if version == 2 && parametric { "ParametricNodes" } else { "Nodes" };
        self.text(&format!("${section}\n"));
        if version == 2 {
            self.text(&format!("{}\n", model.nodes.len()));
            for &(tag, p) in &model.nodes {
                self.int(tag);
                p.to_array().iter().for_each(|&v| self.real(v));
                if parametric {
                    // On surface 7, at two parameters.
                    self.int(2);
                    self.int(7);
                    self.real(0.5);
                    self.real(0.25);
                }
                self.line();
            }
        } else {
            // Two blocks: the first node, then the others, on a surface.
            for v in [2, model.nodes.len() as u64, 1, 100] {
                self.size(v);
            }
            for block in [&model.nodes[..1], &model.nodes[1..]] {
                self.line();
                self.int(2);
                self.int(1);
                self.int(u64::from(parametric));
                self.size(block.len() as u64);
                self.line();
                block.iter().for_each(|&(tag, _)| self.size(tag));
                self.line();
                for (_, p) in block {
                    p.to_array().iter().for_each(|&v| self.real(v));
                    (0..if parametric { 2 } else { 0 }).for_each(|_| self.real(0.5));
                }
            }
        }
        self.text(&format!("\n$End{section}\n$Elements\n"));
        if version == 2 {
            self.text(&format!("{}\n", model.elements.len()));
        } else {
            let n = model.elements.len() as u64;
            [n, n, 1, 100].iter().for_each(|&v| self.size(v));
        }
        for (tag, kind, nodes) in &model.elements {
            match (version, big) {
                (2, None) => [*tag, u64::from(*kind), 2, 1, 7].iter().for_each(|&v| self.int(v)),
                (2, _) => [u64::from(*kind), 1, 2, *tag, 1, 7].iter().for_each(|&v| self.int(v)),
                _ => {
                    [3, 1, u64::from(*kind)].iter().for_each(|&v| self.int(v));
                    self.size(1);
                    self.size(*tag);
                }
            }
            nodes.iter().for_each(|&v| if version == 2 { self.int(v) } else { self.size(v) });
            self.line();
        }
        self.text("\n$EndElements\n$Periodic\n0\n$EndPeriodic\n");
    }

    fn views(&mut self, model: &Model) {
        for (section, name, step, components, values) in &model.views {
            self.text(&format!(
                "${section}\n2\n\"{name}\"\n\"scheme\"\n1\n0.5\n3\n{step}\n{components}\n{}\n",
                values.len()
            ));
            for (tag, tuple) in values {
                self.int(*tag);
                tuple.iter().for_each(|&v| self.real(v));
                self.line();
            }
            self.text(&format!("\n$End{section}\n"));
        }
    }
}

fn write(model: &Model, format: Format) -> Vec<u8> {
    let mut writer = Writer { format, bytes: Vec::new() };
    writer.mesh(model);
    writer.views(model);
    writer.bytes
}

fn read_bytes(bytes: &[u8], time: Option<usize>) -> Result<MixedMesh, IngestError> {
    let mesh = read(Source { path: "a.msh".into(), bytes: bytes.to_vec() }, time)?;
    mesh.check()?;
    Ok(mesh)
}

const WORDS: Format = Format { version: 2, big: None, wide: true, parametric: false };

/// A tetrahedron and a triangle, with sparse tags, and values of two steps.
fn tetrahedron() -> Model {
    let nodes = vec![(7, DVec3::ZERO), (3, DVec3::X), (90, DVec3::Y), (91, DVec3::Z)];
    let elements = vec![(11, 2, vec![7, 3, 90]), (20, 4, vec![7, 3, 90, 91])];
    let node = |step| (3..=90).step_by(87).chain([7, 91]).map(|t: u64| (t, vec![(t * step) as f64])).collect();
    let views = vec![
        ("NodeData", "steps", 4, 1, node(4)),
        ("NodeData", "steps", 2, 1, node(2)),
        ("ElementData", "vector", 0, 3, vec![(11, vec![9.0; 3]), (20, vec![1.0, -2.5, 3.0])]),
        ("NodeData", "part", 0, 1, vec![(90, vec![5.0])]),
    ];
    Model { nodes, elements, views }
}

#[test]
fn both_versions_are_read_in_every_encoding() {
    for format in formats() {
        let mesh = read_bytes(&write(&tetrahedron(), format), None).unwrap();
        assert_eq!(mesh.points, [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z], "{format:?}");
        assert_eq!((&mesh.cells.types[..], &mesh.cells.connectivity[..]), (&[10][..], &[0, 1, 2, 3][..]));
        let field = |name: &str| mesh.fields.iter().find(|f| f.name == name).unwrap();
        assert_eq!(field("steps"), &Field::point("steps", 1, vec![28.0, 12.0, 360.0, 364.0]));
        assert_eq!(field("vector"), &Field::cell("vector", 3, vec![1.0, -2.5, 3.0]));
        let part = &field("part").values;
        assert!(part[2] == 5.0 && [0, 1, 3].iter().all(|&p| part[p].is_nan()), "{part:?}");
        let notes = ["without volume: 1", "\"part\" has no value on 3 of 4 points", "\"steps\" has 2 steps: step 1"];
        assert_eq!(mesh.notes.len(), notes.len());
        assert!(mesh.notes.iter().zip(notes).all(|(note, part)| note.contains(part)), "{:?}", mesh.notes);
    }
}

#[test]
fn a_step_may_be_chosen() {
    let bytes = write(&tetrahedron(), WORDS);
    let steps =
        |time| read_bytes(&bytes, time).map(|m| m.fields.into_iter().find(|f| f.name == "steps").unwrap().values);
    assert_eq!(steps(Some(0)).unwrap(), [14.0, 6.0, 180.0, 182.0]);
    assert_eq!(steps(Some(1)).unwrap(), steps(None).unwrap());
    assert!(matches!(steps(Some(2)), Err(IngestError::NoSuchTimeStep { step: 2, count: 2, .. })));
}

/// Corners and edges of elements as Gmsh numbers them: node `corners + i` lies amid edge `i`.
const SOLIDS: [(u8, usize, &[[usize; 2]]); 4] = [
    (11, 4, &[[0, 1], [1, 2], [2, 0], [3, 0], [2, 3], [1, 3]]),
    (17, 8, &[[0, 1], [0, 3], [0, 4], [1, 2], [1, 5], [2, 3], [2, 6], [3, 7], [4, 5], [4, 7], [5, 6], [6, 7]]),
    (18, 6, &[[0, 1], [0, 2], [0, 3], [1, 2], [1, 4], [2, 5], [3, 4], [3, 5], [4, 5]]),
    (19, 5, &[[0, 1], [0, 3], [0, 4], [1, 2], [1, 4], [2, 3], [2, 4], [3, 4]]),
];
/// VTK's: the same of its types.
const VTK: [&[[usize; 2]]; 4] = [
    &[[0, 1], [1, 2], [2, 0], [0, 3], [1, 3], [2, 3]],
    &[[0, 1], [1, 2], [2, 3], [3, 0], [4, 5], [5, 6], [6, 7], [7, 4], [0, 4], [1, 5], [2, 6], [3, 7]],
    &[[0, 1], [1, 2], [2, 0], [3, 4], [4, 5], [5, 3], [0, 3], [1, 4], [2, 5]],
    &[[0, 1], [1, 2], [2, 3], [3, 0], [0, 4], [1, 4], [2, 4], [3, 4]],
];

/// The nodes of a quadratic element: corners of their own, and the middle of each edge and then of each face.
fn quadratic(solid: usize, faces: &[&[usize]]) -> Vec<DVec3> {
    let (_, corners, edges) = SOLIDS[solid];
    // No two sets of corners have one middle.
    let mut nodes: Vec<DVec3> = (0..corners).map(|c| DVec3::new((1 << c) as f64, (c * c) as f64, 0.0)).collect();
    nodes.extend(edges.iter().map(|&[a, b]| (nodes[a] + nodes[b]) / 2.0).collect::<Vec<_>>());
    nodes.extend(faces.iter().map(|f| f.iter().map(|&v| nodes[v]).sum::<DVec3>() / f.len() as f64).collect::<Vec<_>>());
    nodes
}

#[test]
fn nodes_of_quadratic_elements_come_in_the_order_of_vtk() {
    let whole: &[usize] = &[0, 1, 2, 3, 4, 5, 6, 7];
    let gmsh_hexahedron: [&[usize]; 7] =
        [&[0, 3, 2, 1], &[0, 1, 5, 4], &[0, 4, 7, 3], &[1, 2, 6, 5], &[2, 3, 7, 6], &[4, 5, 6, 7], whole];
    let vtk_hexahedron: [&[usize]; 7] =
        [&[0, 4, 7, 3], &[1, 2, 6, 5], &[0, 1, 5, 4], &[3, 2, 6, 7], &[0, 1, 2, 3], &[4, 5, 6, 7], whole];
    let gmsh_prism: [&[usize]; 3] = [&[0, 1, 4, 3], &[0, 2, 5, 3], &[1, 2, 5, 4]];
    let vtk_prism: [&[usize]; 3] = [&[0, 1, 4, 3], &[1, 2, 5, 4], &[2, 0, 3, 5]];
    let base: [&[usize]; 1] = [&[0, 1, 2, 3]];
    for (kind, cell, solid, gmsh, vtk) in [
        (11, 24, 0, &[][..], &[][..]),
        (17, 25, 1, &[], &[]),
        (18, 26, 2, &[], &[]),
        (19, 27, 3, &[], &[]),
        (12, 29, 1, &gmsh_hexahedron, &vtk_hexahedron),
        (13, 32, 2, &gmsh_prism, &vtk_prism),
        (14, 27, 3, &base, &base),
    ] {
        let points = quadratic(solid, gmsh);
        let nodes: Vec<(u64, DVec3)> = points.iter().enumerate().map(|(i, &p)| (i as u64 + 1, p)).collect();
        let elements = vec![(1, kind, (1..=nodes.len() as u64).collect())];
        let mesh = read_bytes(&write(&Model { nodes, elements, views: vec![] }, WORDS), None).unwrap();
        assert_eq!(mesh.cells.types, [cell]);
        let at: Vec<DVec3> = mesh.cells.connectivity.iter().map(|&v| mesh.points[v as usize]).collect();
        let corners = SOLIDS[solid].1;
        let middle = |of: &[usize]| of.iter().map(|&v| at[v]).sum::<DVec3>() / of.len() as f64;
        let expected: Vec<DVec3> = VTK[solid].iter().map(|e| middle(e)).chain(vtk.iter().map(|f| middle(f))).collect();
        assert_eq!(at[corners..], expected, "type {kind}");
    }
}

#[test]
fn linear_elements_of_every_type_have_their_volume_and_none_is_inverted() {
    let cube = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]];
    for (kind, corners, volume) in [
        (4, &[0, 1, 3, 4][..], 1.0 / 6.0),
        (5, &[0, 1, 2, 3, 4, 5, 6, 7], 1.0),
        (6, &[0, 1, 3, 4, 5, 7], 0.5),
        (7, &[0, 1, 2, 3, 4], 1.0 / 3.0),
    ] {
        let nodes = cube.iter().enumerate().map(|(i, &c)| (i as u64, DVec3::from(c.map(f64::from)))).collect();
        let elements = vec![(1, kind, corners.to_vec())];
        let mesh = read_bytes(&write(&Model { nodes, elements, views: vec![] }, formats()[2]), None).unwrap();
        let report = mesh.tetrahedralize(Split::Six).unwrap().validate();
        assert!((report.volume - volume).abs() < 1e-15, "type {kind}: {}", report.volume);
        assert_eq!(report.assembly.cells_inverted, 0, "type {kind}");
    }
}

#[test]
fn views_that_were_added_with_their_mesh_again_are_read() {
    let model = tetrahedron();
    for format in formats() {
        let mut writer = Writer { format, bytes: Vec::new() };
        writer.mesh(&model);
        writer.mesh(&model);
        writer.views(&model);
        let mesh = read_bytes(&writer.bytes, None).unwrap();
        assert_eq!((mesh.cells.types.len(), mesh.fields.len()), (1, 3), "{format:?}");
        let mut other = tetrahedron();
        other.nodes[1].1 *= 2.0;
        writer.bytes.clear();
        writer.mesh(&model);
        writer.mesh(&other);
        assert!(read_bytes(&writer.bytes, None).unwrap_err().to_string().contains("sections of nodes"));
        (other.nodes, other.elements[1].2[0]) = (tetrahedron().nodes, 91);
        writer.bytes.clear();
        writer.mesh(&model);
        writer.mesh(&other);
        assert!(read_bytes(&writer.bytes, None).unwrap_err().to_string().contains("sections of elements"));
    }
}

#[test]
fn what_is_wrong_is_told_with_its_place() {
    let good = String::from_utf8(write(&tetrahedron(), WORDS)).unwrap();
    let newer = String::from_utf8(write(&tetrahedron(), Format { version: 4, ..WORDS })).unwrap();
    for (text, from, to, parts) in [
        (&good, "2.2 0 8", "4 0 8", &["version 4 ", "4.1"][..]),
        (&good, "2.2 0 8", "1.0 0 8", &["version 1.0"]),
        (&good, "2.2 0 8", "2.2 2 8", &["file type", "found 2"]),
        (&good, "2.2 0 8", "2.2 1 8", &["byte order"]),
        (&good, "2.2 0 8", "2.2 0 7", &["data size of 7"]),
        (&good, "$MeshFormat", "$Nothing", &["$MeshFormat"]),
        (&good, "$Nodes\n4", "$Nodes\n3", &["$EndNodes"]),
        (&good, "$Nodes\n4", "$Nodes\n5", &["$EndNodes"]),
        (&good, "$Nodes\n4", "$Nodes\n-4", &["number of nodes", "-4"]),
        (&good, "$Nodes\n4", "$Nodes\n99999999999999999", &["$EndNodes"]),
        (&good, "\n3 1 0 0", "\n7 1 0 0", &["7 twice"]),
        (&good, "\n3 1 0 0", "\n-3 1 0 0", &["found -3"]),
        (&good, "\n3 1 0 0", "\n3 nan 0 0", &["point 1", "NaN"]),
        (&good, "7 3 90 91", "7 3 90 92", &["element 20", "found 92"]),
        (&good, "20 4 2", "20 29 2", &["type 29", "ElementOrder"]),
        (&good, "$EndPeriodic", "$End", &["$EndPeriodic"]),
        (&good, "\n3\n4\n1\n4\n", "\n2\n4\n1\n4\n", &["three"]),
        (&good, "\n3\n4\n1\n4\n", "\n3\n4\n0\n4\n", &["components", "found 0"]),
        (&good, "\n3\n4\n1\n4\n", "\n3\n4\n1\n5\n", &["$EndNodeData"]),
        (&newer, "2 4 1 100", "2 5 1 100", &["nodes of all blocks", "found 4"]),
        (&newer, "2 2 1 100", "2 3 1 100", &["elements of all blocks", "found 2"]),
        (&newer, "2 4 1 100", "18446744073709551615 4 1 100", &["$EndNodes"]),
    ] {
        assert!(text.contains(from), "{from}");
        let error = read_bytes(text.replacen(from, to, 1).as_bytes(), None).expect_err(to).to_string();
        assert!(parts.iter().chain(&["a.msh"]).all(|part| error.contains(part)), "{to}: {error}");
    }
    assert!(read_bytes(b"$NOD\n", None).unwrap_err().to_string().contains("version 1"));
    assert!(read_bytes(b"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n", None).unwrap_err().to_string().contains("$Nodes"));
}

/// Cut anywhere a file is an error, or between two sections a mesh with fewer cells or fields.
#[test]
fn truncation_at_any_place_is_told() {
    for format in formats() {
        let bytes = write(&tetrahedron(), format);
        for length in 0..bytes.len() {
            if let Ok(mesh) = read_bytes(&bytes[..length], None) {
                let before = bytes[..length].trim_ascii_end();
                let word = before.rsplit(u8::is_ascii_whitespace).next().unwrap_or_default();
                assert!(word.starts_with(b"$End") && mesh.points.len() == 4, "{format:?} {length}");
            }
        }
    }
}

#[test]
fn an_element_s_tag_may_be_there_twice_only_without_views() {
    let mut model = tetrahedron();
    model.elements.push(model.elements[1].clone());
    assert!(read_bytes(&write(&model, WORDS), None).unwrap_err().to_string().contains("20 twice"));
    model.views.clear();
    assert_eq!(read_bytes(&write(&model, WORDS), None).unwrap().cells.types.len(), 2);
}

#[test]
fn every_type_has_as_many_nodes_as_its_order_lists() {
    for (number, nodes) in [(1, 2), (3, 4), (15, 1), (26, 4), (28, 6), (62, 7), (66, 11), (44, 45)] {
        let kind = element::kind(number).unwrap();
        assert_eq!((kind.nodes, kind.cell), (nodes, None));
    }
    for (number, nodes) in
        [(4, 4), (5, 8), (6, 6), (7, 5), (11, 10), (12, 27), (13, 18), (14, 14), (17, 20), (18, 15), (19, 13)]
    {
        let (_, order) = element::kind(number).unwrap().cell.unwrap();
        let mut order = order.to_vec();
        order.sort_unstable();
        assert_eq!(order, (0..nodes).collect::<Vec<_>>(), "type {number}");
    }
}

proptest! {
    #![proptest_config(config())]

    #[test]
    fn damaged_files_do_not_panic(
        format in prop::sample::select(formats()), time in prop::option::of(0usize..3), n in 0usize..120,
        text in prop::sample::select(&HOSTILE[..]), damages in damages(),
    ) {
        let mut bytes = write(&tetrahedron(), format);
        replace_number(&mut bytes, n, text);
        damages.iter().skip(usize::from(n < 60)).for_each(|d| d.apply(&mut bytes));
        match read_bytes(&bytes, time) {
            Ok(mesh) => drop(mesh.tetrahedralize(Split::Six)),
            Err(error) => prop_assert!(error.to_string().len() < 1000, "{}", error),
        }
    }
}
