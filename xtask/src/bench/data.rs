//! The data sets of the papers and of the targets, in a folder where they are at hand.

use std::path::{Path, PathBuf};

use anyhow::Result;
use tetlux_mesh::TetMesh;

use crate::input::SceneArgs;

/// The folder, if one is given.
#[derive(Default)]
pub(crate) struct Data {
    folder: Option<PathBuf>,
}

/// The files of a data set, and the field in them that its scenes show.
pub(crate) struct Source {
    mesh: PathBuf,
    solution: Option<PathBuf>,
    field: &'static str,
}

impl Data {
    /// A folder, which must be there.
    pub(crate) fn new(folder: Option<&Path>) -> Result<Data> {
        if let Some(folder) = folder
            && !folder.is_dir()
        {
            anyhow::bail!("--data {}: there is no such folder", folder.display());
        }
        Ok(Data { folder: folder.map(Path::to_path_buf) })
    }

    /// A data set by its stem: tetrahedra as `STEM_tets.vtu`, in the folder or in `tets` below it, or the grid
    /// `STEMxyz.bin` and its solution `STEMq.bin`.
    pub(crate) fn find(&self, stem: &str) -> Option<Source> {
        let folder = self.folder.as_ref()?;
        let vtu = format!("{stem}_tets.vtu");
        if let Some(mesh) = [folder.join(&vtu), folder.join("tets").join(&vtu)].into_iter().find(|path| path.exists()) {
            return Some(Source { mesh, solution: None, field: "scalar" });
        }
        let [mesh, solution] = ["xyz", "q"].map(|part| folder.join(format!("{stem}{part}.bin")));
        let field = if stem == "post" { "Momentum" } else { "Density" };
        (mesh.exists() && solution.exists()).then_some(Source { mesh, solution: Some(solution), field })
    }
}

impl Source {
    /// The flags that name it: five tetrahedra a hexahedron, as the papers have it.
    pub(crate) fn flags(&self, mut flags: SceneArgs) -> SceneArgs {
        flags.mesh = Some(self.mesh.clone());
        flags.field = Some(self.field.to_owned());
        flags.file.solution.clone_from(&self.solution);
        flags.file.split = self.solution.is_some().then_some(5);
        flags
    }

    /// Its mesh, by these flags.
    pub(crate) fn load(&self, flags: &SceneArgs) -> Result<TetMesh> {
        Ok(flags.file.load(&self.mesh, self.solution.clone(), flags.file.split)?.mesh)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tetrahedra_are_taken_before_grids_and_grids_only_whole() {
        let folder = tempfile::tempdir().unwrap();
        let data = Data::new(Some(folder.path())).unwrap();
        let touch = |name: &str| std::fs::write(folder.path().join(name), "").unwrap();
        assert!(data.find("post").is_none() && Data::new(None).unwrap().find("post").is_none());
        touch("postxyz.bin");
        assert!(data.find("post").is_none(), "a grid without its solution");
        touch("postq.bin");
        let grid = data.find("post").unwrap();
        assert_eq!((grid.field, grid.solution.is_some()), ("Momentum", true));
        assert_eq!(grid.flags(SceneArgs::default()).file.split, Some(5));
        touch("post_tets.vtu");
        let tets = data.find("post").unwrap();
        assert_eq!((tets.field, tets.flags(SceneArgs::default()).file.split), ("scalar", None));
        assert!(Data::new(Some(&folder.path().join("none"))).is_err());
    }
}
