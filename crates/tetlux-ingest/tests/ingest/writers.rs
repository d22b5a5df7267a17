//! Writers of the formats read, for tests only: every encoding, as their specifications have them.

use std::fmt::Write as _;
use std::io::Write as _;
use std::path::{Path, PathBuf};

use glam::DVec3;
use tetlux_ingest::{MixedCells, MixedMesh};
use tetlux_mesh::{Field, Location};

/// A folder that goes when it is dropped.
pub(crate) struct Folder(tempfile::TempDir);

impl Folder {
    pub(crate) fn new() -> Self {
        Folder(tempfile::tempdir().unwrap())
    }

    pub(crate) fn path(&self) -> &Path {
        self.0.path()
    }

    pub(crate) fn write(&self, name: &str, bytes: &[u8]) -> PathBuf {
        let path = self.0.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        path
    }
}

/// Two unit cubes on one another, with a vector on the points and a number on the cells.
pub(crate) fn two_hexahedra() -> MixedMesh {
    let mut mesh = MixedMesh::default();
    for k in 0..3 {
        for [x, y] in [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]] {
            mesh.points.push(DVec3::new(x, y, f64::from(k)));
        }
    }
    mesh.cells = MixedCells {
        types: vec![12; 2],
        connectivity: (0..8).chain(4..12).collect(),
        offsets: vec![8, 16],
        ..MixedCells::default()
    };
    let position = mesh.points.iter().flat_map(|p| p.to_array()).collect();
    mesh.fields = vec![Field::point("position & <more>", 3, position), Field::cell("number", 1, vec![7.0, -8.5])];
    mesh
}

/// Where a VTU file's data are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Layout {
    Ascii,
    InlineBase64,
    AppendedBase64,
    AppendedRaw,
}

/// How a VTU file is written.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Encoding {
    pub(crate) layout: Layout,
    pub(crate) compressed: bool,
    pub(crate) wide: bool,
    pub(crate) big: bool,
    pub(crate) real: &'static str,
    pub(crate) whole: &'static str,
    /// Bytes of a block before compression.
    pub(crate) block: usize,
}

impl Default for Encoding {
    /// As ParaView writes.
    fn default() -> Self {
        let layout = Layout::AppendedRaw;
        Encoding { layout, compressed: true, wide: false, big: false, real: "Float64", whole: "Int64", block: 32768 }
    }
}

impl Encoding {
    /// Every layout, with and without compression, both header types, both byte orders.
    pub(crate) fn all() -> Vec<Encoding> {
        let mut all = Vec::new();
        for layout in [Layout::Ascii, Layout::InlineBase64, Layout::AppendedBase64, Layout::AppendedRaw] {
            for bits in 0..8 {
                let [compressed, wide, big] = [1, 2, 4].map(|bit| bits & bit != 0);
                // Blocks of 40 bytes: full ones and a rest.
                all.push(Encoding { layout, compressed, wide, big, block: 40, ..Encoding::default() });
            }
        }
        all
    }

    fn number(self, kind: &str, value: f64) -> Vec<u8> {
        macro_rules! bytes {
            ($($name:literal $t:ty),*) => {
                match kind {
                    $($name if self.big => (value as $t).to_be_bytes().to_vec(),
                      $name => (value as $t).to_le_bytes().to_vec(),)*
                    _ => panic!("no type {kind}"),
                }
            };
        }
        bytes!("Int8" i8, "UInt8" u8, "Int16" i16, "UInt16" u16, "Int32" i32, "UInt32" u32, "Int64" i64,
               "UInt64" u64, "Float32" f32, "Float64" f64)
    }

    fn header(self, words: &[usize]) -> Vec<u8> {
        let kind = if self.wide { "UInt64" } else { "UInt32" };
        words.iter().flat_map(|&w| self.number(kind, w as f64)).collect()
    }

    /// Header and data in binary: the parts that are encoded each as one stream.
    fn streams(self, data: &[u8]) -> Vec<Vec<u8>> {
        if !self.compressed {
            return vec![[self.header(&[data.len()]), data.to_vec()].concat()];
        }
        let blocks: Vec<Vec<u8>> = data.chunks(self.block).map(deflate).collect();
        let mut words = vec![blocks.len(), self.block, data.len() % self.block];
        words.extend(blocks.iter().map(Vec::len));
        vec![self.header(&words), blocks.concat()]
    }
}

pub(crate) fn deflate(data: &[u8]) -> Vec<u8> {
    let mut encoder = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::default());
    encoder.write_all(data).unwrap();
    encoder.finish().unwrap()
}

pub(crate) fn base64(bytes: &[u8]) -> String {
    const ALPHABET: &[u8] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::new();
    for group in bytes.chunks(3) {
        let bits = (0..3).fold(0, |bits, i| bits << 8 | u32::from(*group.get(i).unwrap_or(&0)));
        for i in 0..4 {
            let digit = ALPHABET[(bits >> (18 - 6 * i)) as usize & 63] as char;
            text.push(if i <= group.len() { digit } else { '=' });
        }
    }
    text
}

/// A VTU file of one piece.
pub(crate) fn vtu(mesh: &MixedMesh, encoding: Encoding) -> Vec<u8> {
    vtu_of_pieces(&[mesh], encoding)
}

/// A VTU file of several pieces.
pub(crate) fn vtu_of_pieces(pieces: &[&MixedMesh], e: Encoding) -> Vec<u8> {
    let mut appended = Vec::new();
    let mut xml = format!(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"{}\" \
         header_type=\"{}\"{}>\n<UnstructuredGrid>\n",
        if e.big { "BigEndian" } else { "LittleEndian" },
        if e.wide { "UInt64" } else { "UInt32" },
        if e.compressed { " compressor=\"vtkZLibDataCompressor\"" } else { "" },
    );
    for mesh in pieces {
        let cells = &mesh.cells;
        writeln!(xml, "<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">", mesh.points.len(), cells.types.len())
            .unwrap();
        for (section, location) in [("PointData", Location::Point), ("CellData", Location::Cell)] {
            writeln!(xml, "<{section}>").unwrap();
            for f in mesh.fields.iter().filter(|f| f.location == location) {
                array(&mut xml, &mut appended, e, e.real, &f.name, f.components, &f.values);
            }
            writeln!(xml, "</{section}>").unwrap();
        }
        let points: Vec<f64> = mesh.points.iter().flat_map(|p| p.to_array()).collect();
        xml += "<Points>\n";
        array(&mut xml, &mut appended, e, e.real, "Points", 3, &points);
        xml += "</Points>\n<Cells>\n";
        let connectivity: Vec<f64> = cells.connectivity.iter().map(|&v| f64::from(v)).collect();
        let offsets: Vec<f64> = cells.offsets.iter().map(|&v| v as f64).collect();
        let types: Vec<f64> = cells.types.iter().map(|&t| f64::from(t)).collect();
        array(&mut xml, &mut appended, e, e.whole, "connectivity", 1, &connectivity);
        array(&mut xml, &mut appended, e, e.whole, "offsets", 1, &offsets);
        array(&mut xml, &mut appended, e, "UInt8", "types", 1, &types);
        xml += "</Cells>\n</Piece>\n";
    }
    xml += "</UnstructuredGrid>\n";
    let mut bytes = xml.into_bytes();
    if matches!(e.layout, Layout::AppendedBase64 | Layout::AppendedRaw) {
        let encoding = if e.layout == Layout::AppendedRaw { "raw" } else { "base64" };
        bytes.extend(format!("<AppendedData encoding=\"{encoding}\">\n   _").bytes());
        bytes.extend(appended);
        bytes.extend(b"\n</AppendedData>\n");
    }
    bytes.extend(b"</VTKFile>\n");
    bytes
}

fn array(
    xml: &mut String,
    appended: &mut Vec<u8>,
    e: Encoding,
    kind: &str,
    name: &str,
    components: usize,
    values: &[f64],
) {
    let name = name.replace('&', "&amp;").replace('<', "&lt;");
    write!(xml, "<DataArray type=\"{kind}\" Name=\"{name}\" NumberOfComponents=\"{components}\" ").unwrap();
    let data: Vec<u8> = values.iter().flat_map(|&v| e.number(kind, v)).collect();
    let streams = e.streams(&data);
    match e.layout {
        Layout::Ascii => {
            let words: Vec<String> = values.iter().map(f64::to_string).collect();
            writeln!(xml, "format=\"ascii\">\n{}\n</DataArray>", words.join(" ")).unwrap();
        }
        Layout::InlineBase64 => {
            let text: String = streams.iter().map(|s| base64(s)).collect();
            // A child element, as VTK adds them, is no data.
            let key = "<InformationKey name=\"L2_NORM_RANGE\"><Value index=\"0\">0</Value></InformationKey>";
            writeln!(xml, "format=\"binary\">\n{key}\n  {text}\n</DataArray>").unwrap();
        }
        Layout::AppendedBase64 | Layout::AppendedRaw => {
            writeln!(xml, "format=\"appended\" offset=\"{}\"/>", appended.len()).unwrap();
            for stream in streams {
                appended.extend(if e.layout == Layout::AppendedRaw { stream } else { base64(&stream).into_bytes() });
            }
        }
    }
}

/// How a PLOT3D file is written.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Plot3d {
    pub(crate) big: bool,
    pub(crate) iblank: bool,
}

/// Big-endian, as the classic files are, without iblank.
pub(crate) const PLAIN: Plot3d = Plot3d { big: true, iblank: false };

impl Plot3d {
    fn word(self, little: [u8; 4]) -> [u8; 4] {
        let mut bytes = little;
        if self.big {
            bytes.reverse();
        }
        bytes
    }

    pub(crate) fn int(self, v: i32) -> [u8; 4] {
        self.word(v.to_le_bytes())
    }

    pub(crate) fn real(self, v: f32) -> [u8; 4] {
        self.word(v.to_le_bytes())
    }

    /// A grid of `n` points, placed by index and lattice position, with iblank by index.
    pub(crate) fn grid(
        self,
        n: [i32; 3],
        place: impl Fn(usize, DVec3) -> DVec3,
        iblank: impl Fn(usize) -> i32,
    ) -> Vec<u8> {
        let mut points = Vec::new();
        for k in 0..n[2] {
            for j in 0..n[1] {
                for i in 0..n[0] {
                    points.push(place(points.len(), DVec3::new(i.into(), j.into(), k.into())));
                }
            }
        }
        let mut bytes: Vec<u8> = n.iter().flat_map(|&n| self.int(n)).collect();
        (0..3).for_each(|axis| points.iter().for_each(|p| bytes.extend(self.real(p[axis] as f32))));
        if self.iblank {
            (0..points.len()).for_each(|p| bytes.extend(self.int(iblank(p))));
        }
        bytes
    }

    /// A solution on `n` points: value of each of the five variables by variable and point.
    pub(crate) fn solution(self, n: [i32; 3], value: impl Fn(usize, usize) -> f32) -> Vec<u8> {
        let points = n.iter().product::<i32>() as usize;
        let mut bytes: Vec<u8> = n.iter().flat_map(|&n| self.int(n)).collect();
        [2.95f32, 0.0, 1e5, 0.0].iter().for_each(|&v| bytes.extend(self.real(v)));
        (0..5).for_each(|variable| (0..points).for_each(|p| bytes.extend(self.real(value(variable, p)))));
        bytes
    }
}
