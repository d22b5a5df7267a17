//! The points of structured data sets.

use glam::DVec3;
use tetlux_mesh::Location;

use super::Reader;
use super::array::Kind;
use crate::{IngestError, MixedMesh, StructuredGrid};

/// VTK's array of flags, and its flags for points and cells that are not to be seen (vtkDataSetAttributes.h).
const GHOSTS: &str = "vtkGhostType";
const HIDDEN_POINT: u8 = 2;
const HIDDEN_CELL: u8 = 32;
/// A grid may have so many points whatever the length of its file.
const FREE_POINTS: usize = 1 << 16;

/// What a file says of a grid, in any order.
#[derive(Default)]
pub(super) struct Lattice {
    pub(super) points: Option<Vec<DVec3>>,
    counts: Option<[u64; 3]>,
    origin: DVec3,
    spacing: Option<DVec3>,
    coordinates: [Option<Vec<f64>>; 3],
    blanked: Option<Vec<bool>>,
}

impl Lattice {
    /// Reads what follows a keyword; false if it is none of a grid's.
    pub(super) fn read(&mut self, reader: &mut Reader, keyword: &str) -> Result<bool, IngestError> {
        match keyword {
            "dimensions" => self.counts = Some(three(reader, "DIMENSIONS")?),
            "extent" => {
                let ends: Vec<i64> = reader.words.numbers("EXTENT", 6)?;
                let count = |axis: usize| ends[2 * axis + 1].saturating_sub(ends[2 * axis]).saturating_add(1);
                self.counts = Some([0, 1, 2].map(|axis| u64::try_from(count(axis)).unwrap_or(0)));
            }
            "origin" => self.origin = DVec3::from(three(reader, "ORIGIN")?),
            "spacing" | "aspect_ratio" => self.spacing = Some(DVec3::from(three(reader, "SPACING")?)),
            "x_coordinates" => self.coordinates[0] = Some(array(reader, "X_COORDINATES")?),
            "y_coordinates" => self.coordinates[1] = Some(array(reader, "Y_COORDINATES")?),
            "z_coordinates" => self.coordinates[2] = Some(array(reader, "Z_COORDINATES")?),
            "blanking" => {
                self.blanked = Some(array(reader, "BLANKING")?.into_iter().map(|visible| visible == 0.0).collect());
            }
            _ => return Ok(false),
        }
        Ok(true)
    }

    /// Gives the mesh its points and its grid.
    pub(super) fn assemble(self, reader: &Reader, dataset: &str, mesh: &mut MixedMesh) -> Result<(), IngestError> {
        let words = &reader.words;
        let Some([ni, nj, nk]) = self.counts else {
            return Err(words.malformed("DIMENSIONS", "nothing", "write the numbers of points along the three axes"));
        };
        let shown = format!("{ni} x {nj} x {nk} points");
        if ni.min(nj).min(nk) < 2 {
            let remedy = "it has no volume: two points along each axis are the least";
            return Err(words.source.unsupported(words.place(), "a grid of", &shown, remedy));
        }
        let total = ni.checked_mul(nj).and_then(|n| n.checked_mul(nk)).and_then(|n| usize::try_from(n).ok());
        let Some(total) = total.filter(|&n| u32::try_from(n).is_ok()) else {
            return Err(words.malformed("DIMENSIONS", shown, "32 bits must name every point: split the data set"));
        };
        // The product is in range, so its factors are.
        let counts = [ni, nj, nk].map(|n| n as usize);
        mesh.points = match dataset {
            "structured_grid" => self.points.unwrap_or_default(),
            _ => {
                // Points that are only implied could fill any memory. Those with data take a byte each at least.
                if total > words.source.bytes.len().max(FREE_POINTS) {
                    let found = format!("{shown} in {} bytes", words.source.bytes.len());
                    return Err(words.malformed(
                        "a grid larger than its file",
                        found,
                        "it can hold no data: see DIMENSIONS",
                    ));
                }
                if dataset == "structured_points" {
                    let spacing = self.spacing.unwrap_or(DVec3::ONE);
                    let place =
                        |i: usize, j: usize, k: usize| self.origin + spacing * DVec3::new(i as f64, j as f64, k as f64);
                    lattice(counts, place)
                } else {
                    let [x, y, z] = self.axes(reader, counts)?;
                    lattice(counts, |i, j, k| DVec3::new(x[i], y[j], z[k]))
                }
            }
        };
        for (what, found) in [("POINTS", Some(mesh.points.len())), ("BLANKING", self.blanked.as_ref().map(Vec::len))] {
            if let Some(found) = found.filter(|&n| n != total) {
                let what = format!("the length of {what} of a grid of {shown}");
                return Err(words.malformed(what, found, &format!("it must be {total}")));
            }
        }
        mesh.grids = vec![StructuredGrid { first_point: 0, counts, blanked: self.blanked }];
        Ok(())
    }

    /// The coordinates along each axis, as many as there are points.
    fn axes(&self, reader: &Reader, counts: [usize; 3]) -> Result<[&[f64]; 3], IngestError> {
        let mut axes: [&[f64]; 3] = [&[]; 3];
        for (axis, name) in ["X_COORDINATES", "Y_COORDINATES", "Z_COORDINATES"].into_iter().enumerate() {
            axes[axis] = self.coordinates[axis].as_deref().unwrap_or_default();
            if axes[axis].len() != counts[axis] {
                let remedy = format!("DIMENSIONS ask for {}", counts[axis]);
                return Err(reader.words.malformed(name, format!("{} numbers", axes[axis].len()), &remedy));
            }
        }
        Ok(axes)
    }
}

fn lattice([ni, nj, nk]: [usize; 3], place: impl Fn(usize, usize, usize) -> DVec3) -> Vec<DVec3> {
    let mut points = Vec::with_capacity(ni * nj * nk);
    for k in 0..nk {
        for j in 0..nj {
            points.extend((0..ni).map(|i| place(i, j, k)));
        }
    }
    points
}

fn three<T: std::str::FromStr + Copy>(reader: &mut Reader, what: &str) -> Result<[T; 3], IngestError> {
    Ok([reader.words.number(what)?, reader.words.number(what)?, reader.words.number(what)?])
}

fn array(reader: &mut Reader, what: &str) -> Result<Vec<f64>, IngestError> {
    let count = reader.words.number(what)?;
    let kind = Kind::read(&mut reader.words)?;
    reader.reals(kind, what, count)
}

/// Blanks the points of a grid that VTK's flags hide, and notes what is blanked or hidden.
pub(super) fn blank(mesh: &mut MixedMesh) {
    let flags = |location: Location, flag: u8| {
        let field = mesh.fields.iter().find(|f| f.name == GHOSTS && f.location == location && f.components == 1)?;
        let hidden: Vec<bool> = field.values.iter().map(|&v| v as u8 & flag != 0).collect();
        hidden.contains(&true).then_some(hidden)
    };
    let (points, cells) = (flags(Location::Point, HIDDEN_POINT), flags(Location::Cell, HIDDEN_CELL));
    if let (Some(hidden), Some(grid)) = (points, mesh.grids.first_mut())
        && hidden.len() == mesh.points.len()
    {
        match &mut grid.blanked {
            Some(blanked) => blanked.iter_mut().zip(hidden).for_each(|(b, h)| *b |= h),
            none => *none = Some(hidden),
        }
    }
    let all: usize = mesh.grids.iter().map(StructuredGrid::hexahedra).sum();
    if mesh.grids.iter().any(|grid| grid.blanked.is_some()) {
        let visible: usize = mesh.cell_counts().iter().map(|&(_, count)| count).sum();
        let note = format!("{} hexahedra have a blanked corner: they are left out", all - visible);
        mesh.notes.extend((all > visible).then_some(note));
    }
    if let Some(hidden) = cells {
        let count = hidden.iter().filter(|&&h| h).count();
        mesh.notes.push(format!("{count} cells are hidden by \"{GHOSTS}\": they are kept all the same"));
    }
}
