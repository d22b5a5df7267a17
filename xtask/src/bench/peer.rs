//! Another program's renderers of the same scene: `benches/peer/vtk_peer.py`, asked for a frame at a time.

use std::fs::File;
use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

use anyhow::{Context, Result, bail};
use serde::{Deserialize, Serialize};
use serde_json::json;
use tetlux_image::{Image, write_atomically};
use tetlux_mesh::{Location, ScalarField, TetMesh};
use tetlux_optics::TransferFunction;
use tetlux_scene::Projection;

use crate::input::Input;
use crate::report::{create_folder, write_json};

const SCRIPT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../benches/peer/vtk_peer.py");

/// The field's name in the job.
const FIELD: &str = "scalar";

/// One of its renderers.
pub(crate) struct Rival {
    /// As the script knows it.
    pub(crate) name: &'static str,
    pub(crate) title: &'static str,
    /// Where in a pixel it samples, from the centre.
    pub(crate) at: [f64; 2],
    /// It is not asked for meshes of more cells, on which it takes minutes.
    pub(crate) most_cells: usize,
}

pub(crate) const VTK: &[Rival] = &[
    Rival { name: "pt", title: "VTK projected tetrahedra", at: [0.0; 2], most_cells: usize::MAX },
    Rival { name: "bunyk-partial", title: "VTK Bunyk, partial pre-integration", at: CORNER, most_cells: usize::MAX },
    Rival { name: "bunyk-linear", title: "VTK Bunyk, linear", at: CORNER, most_cells: usize::MAX },
    Rival { name: "zsweep-partial", title: "VTK Z sweep, partial pre-integration", at: CORNER, most_cells: 20_000 },
];

/// Its ray casters sample the lower left corner of a pixel.
const CORNER: [f64; 2] = [-0.5, 0.5];

/// The program, ready to draw a scene.
pub(crate) struct Peer {
    child: Child,
    /// Ends the program when it is closed.
    ask: Option<ChildStdin>,
    answers: BufReader<ChildStdout>,
    /// What it says on standard error.
    said: PathBuf,
    pub(crate) about: About,
}

#[derive(Deserialize, Serialize, Clone)]
pub(crate) struct About {
    pub(crate) version: String,
    pub(crate) opengl: String,
}

/// What a frame took.
#[derive(Deserialize, Clone, Copy)]
pub(crate) struct Took {
    pub(crate) wall_seconds: f64,
    pub(crate) cpu_seconds: f64,
    pub(crate) peak_bytes: u64,
}

impl Peer {
    /// Starts the program on a job.
    pub(crate) fn start(python: &str, job: &Path) -> Result<Peer> {
        let said = job.with_file_name("stderr.txt");
        let mut child = Command::new(python)
            .args([Path::new(SCRIPT), job, Path::new("--serve")])
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(File::create(&said)?)
            .spawn()
            .with_context(|| format!("{python} cannot be run (--python names another)"))?;
        let (Some(ask), Some(answers)) = (child.stdin.take(), child.stdout.take()) else {
            bail!("{python} has no standard input and output");
        };
        let about = About { version: String::new(), opengl: String::new() };
        let mut peer = Peer { child, ask: Some(ask), answers: BufReader::new(answers), said, about };
        peer.about = peer.answer()?;
        Ok(peer)
    }

    /// A frame, the eye turned by some degrees; its picture if a file is named.
    pub(crate) fn frame(&mut self, rival: &Rival, turn: f64, picture: Option<&Path>) -> Result<Took> {
        let picture = picture.map_or(String::new(), |path| format!("\t{}", path.display()));
        if let Some(ask) = &mut self.ask {
            // Where it has ended, the answer that does not come says why.
            let _ = writeln!(ask, "{}\t{turn}{picture}", rival.name).and_then(|()| ask.flush());
        }
        self.answer()
    }

    fn answer<T: for<'a> Deserialize<'a>>(&mut self) -> Result<T> {
        let mut line = String::new();
        self.answers.read_line(&mut line)?;
        serde_json::from_str(&line).map_err(|_| {
            let said = std::fs::read_to_string(&self.said).unwrap_or_default();
            let last = said.lines().rfind(|line| !line.trim().is_empty()).unwrap_or("nothing").trim().to_owned();
            anyhow::anyhow!("the peer ended; it said: {last} (all of it is in {})", self.said.display())
        })
    }
}

impl Drop for Peer {
    fn drop(&mut self) {
        self.ask = None;
        let _ = self.child.wait();
    }
}

/// Writes the mesh and the job that names it; gives the job's path. What the peer cannot draw is an error.
pub(crate) fn write_job(folder: &Path, input: &Input) -> Result<PathBuf> {
    let scene = &input.scene;
    let Some(transfer) = scene.transfer().filter(|_| scene.lighting.is_none()) else {
        bail!("{}: a peer draws transfer functions of one field without light", input.name);
    };
    let [color, opacity] = nodes(transfer, scene.scalar.range);
    // Its opacities end at 1: what is above it is put into the unit distance.
    let scale = opacity.iter().map(|node| node[1]).fold(1.0, f64::max);
    let camera = &scene.camera;
    let mut job = json!({
        "mesh": "mesh.vtk",
        "field": FIELD,
        "color": color,
        "opacity": opacity.iter().map(|node| [node[0], node[1] / scale]).collect::<Vec<_>>(),
        "unit_distance": scene.unit_distance / scale,
        "camera": {
            "position": camera.position.to_array(),
            "focal_point": camera.focal_point.to_array(),
            "view_up": camera.view_up.to_array(),
        },
        "size": scene.size,
        "background": [0.0, 0.0, 0.0],
    });
    match camera.projection {
        Projection::Perspective { view_angle } => job["camera"]["view_angle"] = view_angle.into(),
        Projection::Orthographic { parallel_scale } => job["camera"]["parallel_scale"] = parallel_scale.into(),
    }
    let mesh = folder.join("mesh.vtk");
    create_folder(&mesh)?;
    let bytes = legacy_vtk(&input.mesh, &scene.scalar)?;
    write_atomically(&mesh, |file| file.write_all(&bytes))?;
    let path = folder.join("job.json");
    write_json(&path, &job)?;
    Ok(path)
}

/// Share of the field's range that a step in the transfer function takes, where two nodes cannot have one place.
const STEP: f64 = 1e-9;

/// Scalar, red, green, blue; and scalar, opacity. VTK takes no notice of opacities between the nodes of colours: both have
/// nodes wherever one of them does, which changes neither.
fn nodes(transfer: &TransferFunction, range: [f64; 2]) -> [Vec<Vec<f64>>; 2] {
    let (mut color, mut opacity) = (Vec::new(), Vec::new());
    for s in transfer.control_points() {
        let below = (s - STEP * (range[1] - range[0]), transfer.luminance_below(s), transfer.opacity_below(s));
        let at = (s, transfer.luminance(s), transfer.opacity(s));
        let steps = (below.1, below.2) != (at.1, at.2);
        for (s, [red, green, blue], value) in steps.then_some(below).into_iter().chain([at]) {
            color.push(vec![s, red, green, blue]);
            opacity.push(vec![s, value]);
        }
    }
    [color, opacity]
}

/// A mesh and its scalar as a legacy VTK file, binary.
fn legacy_vtk(mesh: &TetMesh, scalar: &ScalarField) -> Result<Vec<u8>> {
    if scalar.location != Location::Point {
        bail!("a peer draws fields on points alone, and \"{}\" is on cells", scalar.name);
    }
    let (points, cells) = (mesh.points().len(), mesh.cells().len());
    let mut bytes =
        format!("# vtk DataFile Version 3.0\ntetlux\nBINARY\nDATASET UNSTRUCTURED_GRID\nPOINTS {points} double\n")
            .into_bytes();
    bytes.extend((0..points as u32).flat_map(|i| mesh.world(i).to_array()).flat_map(f64::to_be_bytes));
    bytes.extend(format!("\nCELLS {cells} {}\n", 5 * cells).into_bytes());
    bytes.extend(mesh.cells().iter().flat_map(|&[a, b, c, d]| [4, a, b, c, d]).flat_map(u32::to_be_bytes));
    bytes.extend(format!("\nCELL_TYPES {cells}\n").into_bytes());
    // Tetrahedra are of type 10.
    bytes.extend((0..cells).flat_map(|_| 10_u32.to_be_bytes()));
    bytes.extend(format!("\nPOINT_DATA {points}\nSCALARS {FIELD} double 1\nLOOKUP_TABLE default\n").into_bytes());
    bytes.extend(scalar.values.iter().flat_map(|value| value.to_be_bytes()));
    Ok(bytes)
}

/// The colours of a PPM file of 8 bits as they are, alpha 0.
pub(crate) fn read_ppm(path: &Path) -> Result<Image> {
    let bytes = std::fs::read(path).with_context(|| path.display().to_string())?;
    let image = || {
        let mut parts = bytes.splitn(4, |&byte| byte == b'\n');
        let (magic, size, most, samples) = (parts.next()?, parts.next()?, parts.next()?, parts.next()?);
        let (width, height) = std::str::from_utf8(size).ok()?.split_once(' ')?;
        let (width, height): (u32, u32) = (width.parse().ok()?, height.parse().ok()?);
        let whole = samples.len() as u64 == 3 * u64::from(width) * u64::from(height);
        let value = |byte: u8| f32::from(byte) / 255.0;
        let pixels = samples.chunks_exact(3).map(|rgb| [value(rgb[0]), value(rgb[1]), value(rgb[2]), 0.0]);
        (magic == b"P6" && most == b"255" && whole).then(|| Image::from_pixels(width, height, pixels.collect()))
    };
    Ok(image().with_context(|| format!("{}: not a picture as the peer writes it", path.display()))??)
}

#[cfg(test)]
mod tests {
    use tetlux_ingest::{ReadOptions, Split, read_tet_mesh};
    use tetlux_optics::transfer::{ColorNode, OpacityNode};

    use super::*;
    use crate::methods::PEAK;

    #[test]
    fn a_job_is_the_mesh_that_is_drawn_and_its_function() {
        let folder = tempfile::tempdir().unwrap();
        let input = PEAK.input("peak", "", 20).unwrap();
        let job = write_job(folder.path(), &input).unwrap();
        let job: serde_json::Value = serde_json::from_slice(&std::fs::read(job).unwrap()).unwrap();
        // The peak of 60 counts as 1 over a sixtieth of the unit; colours have a node there, too.
        let place =
            |nodes: &serde_json::Value| nodes.as_array().unwrap().iter().position(|node| node[0] == 0.75).unwrap();
        assert_eq!(job["opacity"][place(&job["opacity"])], json!([0.75, 1.0]));
        assert_eq!(place(&job["color"]), place(&job["opacity"]));
        assert!((job["unit_distance"].as_f64().unwrap() - 1.0 / 60.0).abs() < 1e-15);
        let mesh = folder.path().join("mesh.vtk");
        let mesh = read_tet_mesh(&mesh, &ReadOptions::default(), Split::Six).unwrap();
        assert_eq!((mesh.cells(), mesh.points()), (input.mesh.cells(), input.mesh.points()));
        let scalar = mesh.scalar(FIELD, tetlux_mesh::Component::Magnitude).unwrap();
        assert_eq!(scalar.values, input.scene.scalar.values);
    }

    #[test]
    fn steps_keep_both_their_sides() {
        let color = vec![ColorNode { s: 0.0, rgb: [1.0; 3] }];
        let opacity =
            [(0.0, 0.0), (1.0, 0.25), (1.0, 0.75), (2.0, 0.75)].map(|(s, opacity)| OpacityNode { s, opacity });
        let [color, opacity] = nodes(&TransferFunction::new(color, opacity.to_vec()).unwrap(), [0.0, 2.0]);
        let values: Vec<f64> = opacity.iter().map(|node| node[1]).collect();
        assert_eq!((color.len(), values), (4, vec![0.0, 0.25, 0.75, 0.75]));
        assert!(opacity[1][0] < 1.0 && opacity[2][0] == 1.0);
    }

    #[test]
    fn pictures_are_read_whole_or_not_at_all() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.ppm");
        // A sample may be a line's end.
        std::fs::write(&path, b"P6\n2 1\n255\n\x0a\xff\x00\x33\x0a\x00").unwrap();
        let image = read_ppm(&path).unwrap();
        assert_eq!(image.pixels(), [[10.0 / 255.0, 1.0, 0.0, 0.0], [0.2, 10.0 / 255.0, 0.0, 0.0]]);
        for bad in [&b"P6\n2 1\n255\n12345"[..], b"P5\n1 1\n255\n123", b"P6\n1 1", b""] {
            std::fs::write(&path, bad).unwrap();
            assert!(read_ppm(&path).is_err(), "{bad:?}");
        }
    }

    #[test]
    fn a_peer_that_cannot_be_says_so() {
        let folder = tempfile::tempdir().unwrap();
        let input = PEAK.input("peak", "", 8).unwrap();
        let job = write_job(folder.path(), &input).unwrap();
        let error = |python: &str| Peer::start(python, &job).err().unwrap().to_string();
        assert!(error("no-such-python-anywhere").contains("--python"));
        #[cfg(unix)]
        assert!(error("true").contains("the peer ended"), "a program that answers nothing");
    }
}
