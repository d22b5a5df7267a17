//! TetGen's files (TetGen user's manual, "File formats"): nodes in one (.node), tetrahedra in the other (.ele).

use std::path::Path;

use glam::DVec3;
use tetlux_mesh::{Field, Location};

use crate::source::{Files, Source};
use crate::words::parse;
use crate::{IngestError, MixedMesh, Place};

/// VTK's numbers of tetrahedra of 4 and of 10 points.
const LINEAR: u8 = 10;
const QUADRATIC: u8 = 24;
/// The edges that the points 4 to 9 of VTK's quadratic tetrahedron lie amid.
const EDGES: [[usize; 2]; 6] = [[0, 1], [1, 2], [2, 0], [0, 3], [1, 3], [2, 3]];

/// Whether a file of this extension, in lower case, is one of the two.
pub(crate) fn recognizes(extension: &str) -> bool {
    ["node", "ele"].contains(&extension)
}

/// Reads either file and the other beside it.
pub(crate) fn read(source: Source, files: &mut Files) -> Result<MixedMesh, IngestError> {
    let is_nodes = source.path.extension().is_some_and(|e| e.eq_ignore_ascii_case("node"));
    let other = files.open(&partner(&source.path, if is_nodes { "ele" } else { "node" }))?;
    let (nodes, elements) = if is_nodes { (source, other) } else { (other, source) };
    let mut mesh = MixedMesh { path: nodes.path.clone(), ..MixedMesh::default() };
    let first = read_nodes(&nodes, &mut mesh)?;
    read_elements(&elements, first, &mut mesh)?;
    Ok(mesh)
}

/// The file of the same name with another extension, in the letters that the first one's is in.
fn partner(path: &Path, extension: &str) -> std::path::PathBuf {
    let upper = path.extension().is_some_and(|e| e.as_encoded_bytes().iter().all(u8::is_ascii_uppercase));
    path.with_extension(if upper { extension.to_ascii_uppercase() } else { extension.into() })
}

/// A file of lines of numbers, of which comments and empty ones are passed over.
struct Table<'a> {
    source: &'a Source,
    /// Lines not yet read.
    rest: &'a [u8],
    /// Where the last line that was read begins.
    at: usize,
}

impl<'a> Table<'a> {
    fn new(source: &'a Source) -> Self {
        Table { source, rest: &source.bytes, at: 0 }
    }

    /// The words of the next line that has any.
    fn line(&mut self, what: &str) -> Result<impl Iterator<Item = &'a [u8]> + use<'a>, IngestError> {
        while !self.rest.is_empty() {
            self.at = self.source.bytes.len() - self.rest.len();
            let length = self.rest.iter().position(|&b| b == b'\n').unwrap_or(self.rest.len());
            let line = &self.rest[..length];
            self.rest = &self.rest[(length + 1).min(self.rest.len())..];
            let line = line.split(|&b| b == b'#').next().unwrap_or_default();
            if !line.trim_ascii().is_empty() {
                return Ok(line.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty()));
            }
        }
        self.at = self.source.bytes.len();
        Err(self.malformed(what, "the end of the file", "the file is cut short: copy or write it again"))
    }

    /// The next line as numbers, of which there must be at least so many; more are left.
    fn numbers(&mut self, what: &str, least: usize, into: &mut Vec<f64>) -> Result<(), IngestError> {
        into.clear();
        for word in self.line(what)? {
            let number = parse(word).ok_or_else(|| self.malformed(what, word.escape_ascii(), "write a number"))?;
            into.push(number);
        }
        if into.len() < least {
            return Err(self.malformed(what, format!("{} numbers", into.len()), &format!("there must be {least}")));
        }
        Ok(())
    }

    /// The first line: whole numbers from 0 on, those that are missing 0.
    fn heading<const N: usize>(&mut self, what: &str) -> Result<[usize; N], IngestError> {
        let mut heading = [0; N];
        for (number, word) in heading.iter_mut().zip(self.line(what)?) {
            let remedy = "write whole numbers from 0 on";
            *number = parse(word).ok_or_else(|| self.malformed(what, word.escape_ascii(), remedy))?;
        }
        // Each item takes a line of two bytes at least for each of its numbers.
        let (count, most) = (heading[0], self.rest.len() / 2 + 1);
        if count > most {
            let found = format!("{count} lines in {} bytes", self.rest.len());
            return Err(self.malformed(what, found, "the file is cut short or its heading is wrong"));
        }
        Ok(heading)
    }

    fn malformed(&self, what: impl Into<String>, found: impl ToString, remedy: &str) -> IngestError {
        self.source.malformed(Place::Byte(self.at as u64), what, found, remedy)
    }

    /// Values of each item as fields.
    fn fields(&self, names: Vec<String>, values: Vec<Vec<f64>>, location: Location) -> Vec<Field> {
        let field = |(name, values)| Field { name, location, components: 1, values };
        names.into_iter().zip(values).map(field).collect()
    }
}

/// Reads points, attributes and markers, and gives the number of the first point, 0 or 1.
fn read_nodes(source: &Source, mesh: &mut MixedMesh) -> Result<u64, IngestError> {
    let mut table = Table::new(source);
    let what = "the heading of the nodes (points, dimension, attributes, markers)";
    let [count, dimension, attributes, markers] = table.heading(what)?;
    if count == 0 {
        return Err(table.malformed(what, "no points", "write the nodes into the .node file itself"));
    }
    if dimension != 3 {
        return Err(table.malformed("the dimension of the nodes", dimension, "it must be 3"));
    }
    if markers > 1 {
        return Err(table.malformed("the markers of a node", markers, "write 0 or 1"));
    }
    let mut names = table_names(&table, "attribute", attributes, source)?;
    names.extend((markers == 1).then(|| "marker".to_string()));
    let mut columns = vec![Vec::new(); names.len()];
    let mut first = 0;
    let mut line = Vec::new();
    for i in 0..count {
        let what = "a node: its number, coordinates, attributes and marker";
        table.numbers(what, 4 + names.len(), &mut line)?;
        if i == 0 {
            first = u64::from(line[0] == 1.0);
        }
        consecutive(&table, "node", line[0], i as u64 + first)?;
        mesh.points.push(DVec3::new(line[1], line[2], line[3]));
        columns.iter_mut().zip(&line[4..]).for_each(|(column, &value)| column.push(value));
    }
    mesh.fields.extend(table.fields(names, columns, Location::Point));
    Ok(first)
}

fn read_elements(source: &Source, first: u64, mesh: &mut MixedMesh) -> Result<(), IngestError> {
    let mut table = Table::new(source);
    let what = "the heading of the tetrahedra (number, nodes of each, attributes)";
    let [count, nodes, attributes] = table.heading(what)?;
    let kind = match nodes {
        4 => LINEAR,
        10 => QUADRATIC,
        _ => return Err(table.malformed("the nodes of a tetrahedron", nodes, "they must be 4 or 10")),
    };
    let names = match attributes {
        1 => vec!["region".to_string()],
        _ => table_names(&table, "region", attributes, source)?,
    };
    let mut columns = vec![Vec::new(); names.len()];
    let (mut line, mut corners) = (Vec::new(), [0; 10]);
    for i in 0..count {
        let what = "a tetrahedron: its number, nodes and attributes";
        table.numbers(what, 1 + nodes + names.len(), &mut line)?;
        consecutive(&table, "tetrahedron", line[0], i as u64 + first)?;
        for (corner, &node) in corners.iter_mut().zip(&line[1..=nodes]) {
            let place = node - first as f64;
            if place.fract() != 0.0 || !(0.0..mesh.points.len() as f64).contains(&place) {
                let remedy = format!("the nodes are numbered from {first} to {}", mesh.points.len() as u64 + first - 1);
                let what = format!("a node of tetrahedron {}", line[0]);
                return Err(source.malformed(Place::Cell(i), what, node, remedy));
            }
            *corner = place as u32;
        }
        let corners = &mut corners[..nodes];
        if kind == QUADRATIC && !sort_edges(&mesh.points, corners) {
            let remedy = "each must be nearest to the middle of an edge of its own";
            return Err(source.malformed(
                Place::Cell(i),
                "nodes 5 to 10 of the tetrahedron",
                format!("{corners:?}"),
                remedy,
            ));
        }
        mesh.cells.push(kind, corners);
        columns.iter_mut().zip(&line[1 + nodes..]).for_each(|(column, &value)| column.push(value));
    }
    mesh.fields.extend(table.fields(names, columns, Location::Cell));
    Ok(())
}

/// Names of columns: a name and a number, as many as a line can hold.
fn table_names(table: &Table, name: &str, count: usize, source: &Source) -> Result<Vec<String>, IngestError> {
    if count > source.bytes.len() / 2 {
        return Err(table.malformed("the number of attributes", count, "no line of the file is so long"));
    }
    Ok((0..count).map(|i| format!("{name}{i}")).collect())
}

fn consecutive(table: &Table, what: &str, found: f64, expected: u64) -> Result<(), IngestError> {
    if found == expected as f64 {
        return Ok(());
    }
    let remedy = format!("numbers must follow one another from 0 or 1 on, in both files alike: {expected} is next");
    Err(table.malformed(format!("the number of a {what}"), found, &remedy))
}

/// Orders the points amid edges as VTK has them, by where they lie: the manual and the program's versions differ in
/// their order. False if two are nearest to one edge.
fn sort_edges(points: &[DVec3], nodes: &mut [u32]) -> bool {
    let at = |node: u32| points[node as usize];
    let mut sorted = [None; 6];
    for &node in &nodes[4..] {
        let distance = |edge: usize| {
            let [a, b] = EDGES[edge].map(|corner| at(nodes[corner]));
            (a * 0.5 + b * 0.5).distance_squared(at(node))
        };
        let nearest = (0..6).min_by(|&a, &b| distance(a).total_cmp(&distance(b))).unwrap_or(0);
        if sorted[nearest].replace(node).is_some() {
            return false;
        }
    }
    nodes[4..].iter_mut().zip(sorted.into_iter().flatten()).for_each(|(to, from)| *to = from);
    true
}

#[cfg(test)]
mod tests;
