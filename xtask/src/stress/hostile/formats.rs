//! The formats, and a few small files of each.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use tetlux_image::{Encoding, Image, write_exr, write_png};

use super::judge::{self, Kind};
use super::mutation::{Damage, HOSTILE, NUMBERS};
use super::random::Random;

/// Files that other programs wrote.
const FIXTURES: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../crates/tetlux-ingest/tests/files");
const SCENES: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../scenes");

/// A format, how its files are judged, and where they come from.
pub(super) struct Format {
    pub(super) name: &'static str,
    pub(super) kind: Kind,
    origin: Origin,
}

/// Where the files of a format come from.
enum Origin {
    /// Files of a folder, by their extensions; none: all.
    Folder(&'static str, &'static [&'static str]),
    /// Written into a folder.
    Made(fn(&Path) -> Result<()>),
}

/// A whole file, in its place.
pub(super) struct Seed {
    pub(super) path: PathBuf,
    pub(super) bytes: Vec<u8>,
}

const fn fixtures(name: &'static str, folder: &'static str) -> Format {
    Format { name, kind: Kind::Mesh, origin: Origin::Folder(folder, &[]) }
}

const fn made(name: &'static str, kind: Kind, make: fn(&Path) -> Result<()>) -> Format {
    Format { name, kind, origin: Origin::Made(make) }
}

pub(super) const FORMATS: [Format; 15] = [
    fixtures("VTK XML", "vtk_xml"),
    fixtures("VTK legacy", "vtk_legacy"),
    fixtures("Exodus II", "exodus"),
    fixtures("Gmsh", "gmsh"),
    fixtures("TetGen", "tetgen"),
    made("PLOT3D", Kind::Plot3d, plot3d),
    made("OBJ", Kind::Surface, obj),
    made("STL", Kind::Surface, stl),
    made("ParaView preset", Kind::Preset, presets),
    made("image function, EXR", Kind::Image, exr),
    made("image function, PNG", Kind::Image, png),
    Format { name: "scene", kind: Kind::Scene, origin: Origin::Folder(SCENES, &["toml"]) },
    made("table, EXR", Kind::Table, judge::write_table),
    made("kept mesh", Kind::Cache, judge::write_cache),
    made("adapter costs", Kind::Costs, costs),
];

impl Format {
    /// The number of its whole files.
    pub(super) fn files(&self) -> Result<usize> {
        match self.origin {
            Origin::Folder(folder, extensions) => Ok(files(&Path::new(FIXTURES).join(folder), extensions)?.len()),
            Origin::Made(_) => {
                let folder = tempfile::tempdir()?;
                Ok(self.seeds(folder.path())?.len())
            }
        }
    }

    /// Puts its files into a folder, where those lie too that they name.
    pub(super) fn seeds(&self, folder: &Path) -> Result<Vec<Seed>> {
        let paths = match self.origin {
            Origin::Folder(from, extensions) => {
                let from = Path::new(FIXTURES).join(from);
                copy(&from, folder)?;
                let names = files(&from, extensions)?;
                names.iter().filter_map(|path| path.file_name()).map(|name| folder.join(name)).collect()
            }
            Origin::Made(make) => {
                make(folder)?;
                files(&self.kind.folder(folder), self.kind.extensions())?
            }
        };
        let read = |path: PathBuf| Ok(Seed { bytes: fs::read(&path)?, path });
        paths.into_iter().map(read).collect()
    }
}

/// The files of a folder by name, of these extensions if any are given.
fn files(folder: &Path, extensions: &[&str]) -> Result<Vec<PathBuf>> {
    let entries = fs::read_dir(folder).with_context(|| format!("{}: cannot be listed", folder.display()))?;
    let mut paths = Vec::new();
    for entry in entries {
        let path = entry?.path();
        let extension = path.extension().unwrap_or_default().to_string_lossy().into_owned();
        if path.is_file() && (extensions.is_empty() || extensions.contains(&extension.as_str())) {
            paths.push(path);
        }
    }
    paths.sort();
    Ok(paths)
}

fn copy(from: &Path, to: &Path) -> Result<()> {
    for entry in fs::read_dir(from).with_context(|| format!("{}: cannot be listed", from.display()))? {
        let path = entry?.path();
        let to = to.join(path.file_name().unwrap_or_default());
        if path.is_dir() {
            fs::create_dir_all(&to)?;
            copy(&path, &to)?;
        } else {
            fs::copy(&path, &to)?;
        }
    }
    Ok(())
}

/// One of the files, and its bytes with one to three damages; of every eighth the end is another file's.
pub(super) fn damaged(seeds: &[Seed], random: &mut Random) -> (usize, Vec<u8>) {
    let which = random.below(seeds.len());
    let mut bytes = seeds[which].bytes.clone();
    if random.below(8) == 0 {
        let other = &seeds[random.below(seeds.len())].bytes;
        bytes.truncate(random.below(bytes.len() + 1));
        bytes.extend_from_slice(&other[random.below(other.len() + 1)..]);
    }
    for _ in 0..1 + random.below(3) {
        damage(random).apply(&mut bytes);
    }
    (which, bytes)
}

/// Some damage, every other in the first bytes, where headers are.
fn damage(random: &mut Random) -> Damage {
    let [a, b] = [(); 2].map(|()| {
        let end = [1.0, 0.1][random.below(2)];
        random.between(0.0, end)
    });
    let length = 1 + random.below(64);
    match random.below(12) {
        0 => Damage::Truncate(a),
        1..4 => Damage::Flip(a, 1 + random.below(255) as u8),
        4 => Damage::Swap(a, b, length),
        5 => Damage::Insert(a, (0..length / 3).map(|_| random.bits() as u8).collect()),
        6 => Damage::Repeat(a, length),
        7..10 => Damage::Digits(random.below(60), HOSTILE[random.below(HOSTILE.len())]),
        _ => {
            let number = NUMBERS[random.below(NUMBERS.len())];
            Damage::Number(a, number, [4, 8][random.below(2)], random.below(2) == 0)
        }
    }
}

fn plot3d(folder: &Path) -> Result<()> {
    let dimensions = [3i32, 2, 3].map(i32::to_be_bytes).concat();
    let reals = |values: &[f32]| values.iter().flat_map(|v| v.to_be_bytes()).collect::<Vec<u8>>();
    let lattice: Vec<[f32; 3]> =
        (0..18).map(|p| [(p % 3) as f32, (p / 3 % 2) as f32 + 0.1 * (p % 3) as f32, (p / 6) as f32]).collect();
    let places: Vec<f32> = (0..3).flat_map(|axis| lattice.iter().map(move |p| p[axis])).collect();
    fs::write(folder.join("grid.xyz"), [dimensions.clone(), reals(&places)].concat())?;
    let text: Vec<String> = places.iter().map(f32::to_string).collect();
    fs::write(folder.join("text.xyz"), format!("3 2 3\n{}\n", text.join(" ")))?;
    let solution: Vec<f32> = (0..5 * 18).map(|i| 1.0 + (i % 18) as f32 / 8.0).collect();
    fs::write(folder.join("grid.q"), [dimensions, reals(&[0.5, 0.0, 1e5, 0.0]), reals(&solution)].concat())?;
    Ok(())
}

/// The corners and faces of an octahedron.
const CORNERS: [[i32; 3]; 6] = [[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]];
const FACES: [[usize; 3]; 8] = [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];

fn obj(folder: &Path) -> Result<()> {
    let corners: String = CORNERS.iter().map(|[x, y, z]| format!("v {x}.0 {y} {z}e0\n")).collect();
    let faces = |word: fn(usize) -> String| -> String {
        FACES.iter().map(|face| format!("f {}\n", face.map(word).join(" "))).collect()
    };
    fs::write(folder.join("plain.obj"), format!("# octahedron\no a\n{corners}{}", faces(|v| (v + 1).to_string())))?;
    let backwards = faces(|v| format!("{}/1/1", v as i32 - 6));
    fs::write(
        folder.join("rich.obj"),
        format!("mtllib none.mtl\n{corners}vt 0 0\nvn 0 0 1\nusemtl a\ns 1\n{backwards}"),
    )?;
    Ok(())
}

fn stl(folder: &Path) -> Result<()> {
    let mut text = String::from("solid octahedron\n");
    let mut binary = [vec![b' '; 80], (FACES.len() as u32).to_le_bytes().to_vec()].concat();
    for face in FACES {
        text.push_str("facet normal 0 0 0\nouter loop\n");
        binary.extend([0; 12]);
        for [x, y, z] in face.map(|v| CORNERS[v]) {
            text.push_str(&format!("vertex {x} {y} {z}\n"));
            binary.extend([x, y, z].iter().flat_map(|&c| (c as f32).to_le_bytes()));
        }
        text.push_str("endloop\nendfacet\n");
        binary.extend([0; 2]);
    }
    fs::write(folder.join("text.stl"), text + "endsolid octahedron\n")?;
    fs::write(folder.join("binary.stl"), binary)?;
    Ok(())
}

fn presets(folder: &Path) -> Result<()> {
    let maps = [
        ("lab", r#""Lab", "RGBPoints": [0, 0.2, 0.3, 0.7, 0.5, 0.9, 0.9, 0.9, 1, 0.7, 0.1, 0.1]"#),
        ("hsv", r#""HSV", "HSVWrap": 1, "UseLogScale": 1, "RGBPoints": [1, 0, 0, 1, 20, 0, 1, 0, 300, 1, 0, 0]"#),
        ("diverging", r#""Diverging", "RGBPoints": [-1, 0.23, 0.3, 0.75, 0, 0.86, 0.86, 0.86, 1, 0.7, 0.01, 0.15]"#),
    ];
    for (name, map) in maps {
        let points = r#""Points": [0.5, 0, 0.5, 0, 0.7, 0.1, 0.3, 1, 1, 1, 0.5, 0]"#;
        let text = format!(r#"[{{"Name": "{name}", "NanColor": [1, 1, 0], {points}, "ColorSpace": {map}}}]"#);
        fs::write(folder.join(format!("{name}.json")), text)?;
    }
    let xml = "<ColorMaps><ColorMap name=\"old\" space=\"RGB\"><Point x=\"0\" o=\"0\" r=\"0.1\" g=\"0\" b=\"0.5\"/>\
               <Point x=\"0.5\" o=\"0.4\" r=\"1\" g=\"1\" b=\"0\"/><Point x=\"1\" o=\"1\" r=\"1\" g=\"0\" b=\"0\"/>\
               <NaN r=\"1\" g=\"1\" b=\"1\"/></ColorMap></ColorMaps>\n";
    fs::write(folder.join("old.xml"), xml)?;
    Ok(())
}

fn picture() -> Result<Image> {
    let pixels = (0..48).map(|i| [i as f32 / 48.0, 0.5, (i % 8) as f32 / 8.0, (i % 5) as f32 / 4.0]);
    Ok(Image::from_pixels(8, 6, pixels.collect())?)
}

fn exr(folder: &Path) -> Result<()> {
    Ok(write_exr(&picture()?, &folder.join("image.exr"), Some("{\"a\": 1}"))?)
}

fn png(folder: &Path) -> Result<()> {
    write_png(&picture()?, &folder.join("clear.png"), Encoding::Srgb)?;
    Ok(write_png(&picture()?.over([0.1, 0.2, 0.3]), &folder.join("opaque.png"), Encoding::Srgb)?)
}

fn costs(folder: &Path) -> Result<()> {
    let cost = serde_json::json!({ "picture": 1e5, "cell": 12.5, "fragment": 0.25 });
    let costs = serde_json::json!({ "pt": cost, "tiles": cost, "march": cost });
    let kept = serde_json::json!([{ "adapter": "a", "driver": "d 1", "version": "0.1.0", "costs": costs }]);
    Ok(fs::write(folder.join("adapter-costs.json"), serde_json::to_vec_pretty(&kept)?)?)
}
