//! Gmsh's mesh files (Gmsh reference manual, "MSH file format"), versions 2 and 4.1, in words or binary.

mod data;
mod element;
mod input;
mod mesh2;
mod mesh4;
mod tags;

use tetlux_mesh::Location;

use crate::source::{ByteOrder, Source};
use crate::words::Words;
use crate::{IngestError, MixedMesh, Place};
use data::Views;
use element::Elements;
use input::Input;
use tags::Tags;

const SAVE: &str = "in Gmsh, save it as version 4.1 (Mesh.MshFileVersion = 4.1)";

/// Whether these bytes begin as a mesh file does.
pub(crate) fn recognizes(bytes: &[u8]) -> bool {
    let text = bytes.trim_ascii_start();
    ["$MeshFormat", "$NOD", "$Comments", "$PhysicalNames"].iter().any(|start| text.starts_with(start.as_bytes()))
}

/// Reads nodes, the elements that have a volume, and of each view one step: the one numbered `time` among its steps
/// from 0 on, or the last.
pub(crate) fn read(source: Source, time: Option<usize>) -> Result<MixedMesh, IngestError> {
    let mut file = File::open(&source)?;
    let mut element_node_data = false;
    while let Some(section) = file.section()? {
        match section.as_str() {
            // Gmsh adds views to a file with the mesh before each, its format too.
            "MeshFormat" => file.format()?,
            "Nodes" | "ParametricNodes" => file.nodes(section == "ParametricNodes")?,
            "Elements" => file.elements()?,
            "NodeData" => file.views.read(&mut file.input, Location::Point)?,
            "ElementData" => file.views.read(&mut file.input, Location::Cell)?,
            other => {
                let end = format!("$End{other}");
                if !file.input.words.skip_past(end.as_bytes()) {
                    return Err(file.input.words.cut(&end));
                }
                // Other sections hold nothing to be missed here.
                element_node_data |= other == "ElementNodeData";
                continue;
            }
        }
        file.end(&section)?;
    }
    let mut mesh = file.finish(time)?;
    let note = "values on the nodes of each element ($ElementNodeData) cannot be read: they are left out";
    mesh.notes.extend(element_node_data.then(|| note.to_string()));
    Ok(mesh)
}

/// What has been read of a file.
struct File<'a> {
    input: Input<'a>,
    /// 2 or 4: how nodes and elements are laid out.
    version: u8,
    mesh: MixedMesh,
    nodes: Tags,
    elements: Elements,
    views: Views,
}

impl<'a> File<'a> {
    /// Reads up to the end of the section $MeshFormat.
    fn open(source: &'a Source) -> Result<Self, IngestError> {
        let mut words = Words::new(source);
        loop {
            let word = words.expect("$MeshFormat")?;
            match word {
                b"$MeshFormat" => break,
                b"$NOD" => return Err(source.unsupported(words.place(), "Gmsh's format of version", "1", SAVE)),
                _ => {}
            }
            let end = [b"$End", word.strip_prefix(b"$").unwrap_or(word)].concat();
            if !word.starts_with(b"$") || !words.skip_past(&end) {
                return Err(words.malformed("the first section", word.escape_ascii(), "it must be $MeshFormat"));
            }
        }
        let input = Input { words, order: None, wide: true };
        let mesh = MixedMesh { path: source.path.clone(), ..MixedMesh::default() };
        let (nodes, elements, views) = (Tags::default(), Elements::default(), Views::default());
        let mut file = File { input, version: 0, mesh, nodes, elements, views };
        file.format()?;
        file.end("MeshFormat")?;
        Ok(file)
    }

    /// Reads the section $MeshFormat after its name.
    fn format(&mut self) -> Result<(), IngestError> {
        let Input { words, order, wide } = &mut self.input;
        let source = words.source;
        let version = words.expect("the version")?;
        self.version = match version {
            b"4.1" => 4,
            b"2" => 2,
            other if other.starts_with(b"2.") => 2,
            other => {
                let found = other.escape_ascii().to_string();
                return Err(source.unsupported(words.place(), "Gmsh's format of version", &found, SAVE));
            }
        };
        let kind: u8 = words.number("the file type")?;
        let size: u64 = words.number("the data size")?;
        *order = match kind {
            0 => None,
            1 => {
                words.line();
                // The number 1 in the file's byte order.
                match words.bytes("the number that tells the byte order", 4, 1)? {
                    [1, 0, 0, 0] => Some(ByteOrder::Little),
                    [0, 0, 0, 1] => Some(ByteOrder::Big),
                    other => {
                        let remedy = "it must be 1 in either byte order";
                        return Err(words.malformed(
                            "the number that tells the byte order",
                            format!("{other:?}"),
                            remedy,
                        ));
                    }
                }
            }
            _ => return Err(words.malformed("the file type", kind, "it must be 0 (text) or 1 (binary)")),
        };
        if ![4, 8].contains(&size) || (self.version == 2 && size != 8) {
            return Err(source.unsupported(words.place(), "a data size of", &size.to_string(), SAVE));
        }
        *wide = size == 8;
        Ok(())
    }

    /// The name of the next section, without its `$`. `None` at the end of the file.
    fn section(&mut self) -> Result<Option<String>, IngestError> {
        let words = &mut self.input.words;
        let Some(word) = words.word() else { return Ok(None) };
        match word.strip_prefix(b"$") {
            Some(name) if !name.is_empty() => Ok(Some(String::from_utf8_lossy(name).into_owned())),
            _ => Err(words.malformed("a section", word.escape_ascii(), "it must begin with a word such as $Nodes")),
        }
    }

    /// Reads the end of a section.
    fn end(&mut self, section: &str) -> Result<(), IngestError> {
        let words = &mut self.input.words;
        let expected = format!("$End{section}");
        let word = words.expect(&expected)?;
        if word != expected.as_bytes() {
            let remedy = format!("{expected} must follow: a count in the section is wrong");
            return Err(words.malformed(format!("the end of ${section}"), word.escape_ascii(), &remedy));
        }
        Ok(())
    }

    fn nodes(&mut self, parametric: bool) -> Result<(), IngestError> {
        let mut points = Vec::new();
        let tags = match self.version {
            2 => mesh2::nodes(&mut self.input, parametric, &mut points)?,
            _ => mesh4::nodes(&mut self.input, &mut points)?,
        };
        let nodes = Tags::new(tags).map_err(|tag| {
            self.input.words.malformed("the tag of a node", format!("{tag} twice"), "each node needs a tag of its own")
        })?;
        if self.mesh.points.is_empty() {
            (self.nodes, self.mesh.points) = (nodes, points);
        } else if self.nodes != nodes || self.mesh.points != points {
            return Err(self.two("nodes"));
        }
        Ok(())
    }

    fn elements(&mut self) -> Result<(), IngestError> {
        let mut elements = Elements::default();
        match self.version {
            2 => mesh2::elements(&mut self.input, &mut elements)?,
            _ => mesh4::elements(&mut self.input, &mut elements)?,
        }
        if self.elements == Elements::default() {
            self.elements = elements;
        } else if self.elements != elements {
            return Err(self.two("elements"));
        }
        Ok(())
    }

    fn two(&self, what: &str) -> IngestError {
        let found = "two that differ";
        self.input.words.malformed(format!("the sections of {what}"), found, "a file must have one mesh")
    }

    fn finish(mut self, time: Option<usize>) -> Result<MixedMesh, IngestError> {
        if self.mesh.points.is_empty() {
            return Err(self.input.words.malformed("$Nodes", "nothing", "save the file with its mesh"));
        }
        let source = self.input.words.source;
        let mesh = &mut self.mesh;
        let tags = self.elements.assemble(source, &self.nodes, &mut mesh.cells)?;
        let flat = self.elements.flat;
        let note = format!("elements of points, lines or surfaces, without volume: {flat}, left out");
        mesh.notes.extend((flat > 0).then_some(note));
        if self.views.is_empty() && time.is_none() {
            return Ok(self.mesh);
        }
        let tags = Tags::new(tags).map_err(|tag| {
            let found = format!("{tag} twice");
            source.malformed(Place::File, "the tag of an element", found, "each element needs a tag of its own")
        })?;
        self.views.assemble(source, mesh, [&self.nodes, &tags], time)?;
        Ok(self.mesh)
    }
}

#[cfg(test)]
mod tests;
