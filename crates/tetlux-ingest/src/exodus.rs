//! Exodus II: element blocks with nodal and element variables, in netCDF's classic formats or in HDF5 (netCDF-4).
//!
//! The file names its parts by convention: `coordx` or `coord` holds the points, `connectN` block N with its kind in the
//! attribute `elem_type`, `vals_nod_varV` a nodal variable and `vals_elem_varVebN` one of the elements of a block, each
//! by time step (Schoof and Yarberry, EXODUS II: A Finite Element Data Model, Sandia report SAND92-2137, 1994).

mod blocks;
mod file;
#[cfg(feature = "hdf5")]
mod hdf5;
mod netcdf;
#[cfg(test)]
mod tests;
mod variables;

use file::File;
use glam::DVec3;

use crate::source::Source;
use crate::{IngestError, MixedMesh, Place};

/// Whether these bytes begin like a netCDF file of any format.
pub(crate) fn recognizes(bytes: &[u8]) -> bool {
    netcdf::recognizes(bytes) || bytes.starts_with(file::HDF5)
}

/// Reads the blocks of cells with volume, and all variables at a time step numbered from 0, the last without it.
pub(crate) fn read(source: &Source, time: Option<usize>) -> Result<MixedMesh, IngestError> {
    let file = File::open(source)?;
    let mut mesh = MixedMesh { path: source.path.clone(), points: points(source, &file)?, ..MixedMesh::default() };
    let blocks = blocks::read(source, &file, &mut mesh)?;
    let step = time_step(source, &file, time, &mut mesh)?;
    variables::read(source, &file, step, &blocks, &mut mesh)?;
    Ok(mesh)
}

fn points(source: &Source, file: &File) -> Result<Vec<DVec3>, IngestError> {
    let Some(dimensions) = file.dimension("num_dim") else {
        let remedy = "of netCDF and HDF5 files Exodus II alone is read: save others (VTKHDF, CGNS) as .vtu, in ParaView by Save Data";
        return Err(source.malformed(Place::File, "Exodus II's dimension num_dim", "none", remedy));
    };
    if dimensions != 3 {
        let remedy = "only meshes in three dimensions have cells with volume";
        return Err(source.unsupported(Place::File, "a mesh with num_dim", &dimensions.to_string(), remedy));
    }
    let mut points = Vec::new();
    for (axis, name) in ["coordx", "coordy", "coordz"].into_iter().enumerate() {
        let values = match (file.variable(name), file.variable("coord")) {
            (Some(variable), _) => file.numbers(name, variable, &[])?,
            (None, Some(all)) => file.numbers("coord", all, &[axis as u64])?,
            (None, None) => {
                let remedy = "the points' coordinates are missing: write the file again";
                return Err(source.malformed(Place::File, name, "neither it nor coord", remedy));
            }
        };
        if axis == 0 {
            points = vec![DVec3::ZERO; values.len()];
        }
        if values.len() != points.len() {
            let remedy = format!("coordx has {}", points.len());
            return Err(source.malformed(Place::File, format!("the length of {name}"), values.len(), remedy));
        }
        points.iter_mut().zip(values).for_each(|(point, value)| point[axis] = value);
    }
    Ok(points)
}

/// The step to read. `None` if there is none.
fn time_step(
    source: &Source,
    file: &File,
    time: Option<usize>,
    mesh: &mut MixedMesh,
) -> Result<Option<u64>, IngestError> {
    let count = file.dimension("time_step").unwrap_or_default();
    let Some(step) = time.map(|t| t as u64).or(count.checked_sub(1)) else { return Ok(None) };
    if step >= count {
        return Err(IngestError::NoSuchTimeStep { path: source.path.clone(), step, count });
    }
    if count > 1 {
        let time = match file.variable("time_whole") {
            Some(times) => file.numbers("time_whole", times, &[step])?.first().copied(),
            None => None,
        };
        let time = time.map_or(String::new(), |t| format!(", time {t}"));
        mesh.notes.push(format!("of {count} time steps (0 to {}) step {step}{time} is read", count - 1));
    }
    Ok(Some(step))
}
