//! What can be wrong with a scene.

use std::path::PathBuf;

use tetlux_mesh::MeshError;
use tetlux_optics::NoDataError;
use tetlux_optics::preset::PresetError;

/// Why a scene could not be read or made.
#[derive(Debug, thiserror::Error)]
pub enum SceneError {
    /// A file could not be read.
    #[error("{}: {source}", path.display())]
    Read {
        /// The scene or preset file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// The file is not TOML, or has an unknown key or a value of the wrong type.
    #[error("{path}:{line}: {message}")]
    Syntax {
        /// The scene file.
        path: String,
        /// Line, from 1.
        line: usize,
        /// What is wrong there.
        message: String,
    },
    /// A value that cannot be.
    #[error("{path}:{line}: {key}: {message}")]
    Value {
        /// The scene file.
        path: String,
        /// Line, from 1.
        line: usize,
        /// The key.
        key: &'static str,
        /// The value found and what it may be.
        message: String,
    },
    /// Something the scene needs is neither in the file nor given otherwise.
    #[error("{path}: {message}")]
    Missing {
        /// The scene file.
        path: String,
        /// What is missing and how to give it.
        message: String,
    },
    /// Cells without data cannot look so: numbers of a preset, or of a scene that was made in code.
    #[error("{path}: cells without data: {source}")]
    NoData {
        /// The scene file.
        path: String,
        /// The number found and what it may be.
        source: NoDataError,
    },
    /// The preset file does not hold a usable preset.
    #[error("{}: {source}", path.display())]
    Preset {
        /// The preset file.
        path: PathBuf,
        /// What is wrong with it.
        source: PresetError,
    },
    /// An image could not be read.
    #[error(transparent)]
    ImageFile(#[from] tetlux_image::ImageError),
    /// An image holds no transfer function.
    #[error("{}: {source}", path.display())]
    Image {
        /// The image file.
        path: PathBuf,
        /// What is wrong with it.
        source: tetlux_optics::ImageFunctionError,
    },
    /// A surface that cannot be shown.
    #[error("{}: {message}", path.display())]
    Surface {
        /// The file of its triangles.
        path: PathBuf,
        /// The value found and what to do.
        message: String,
    },
    /// The field cannot be had.
    #[error(transparent)]
    Field(#[from] MeshError),
    /// A camera that sees nothing.
    #[error("camera: {reason}")]
    Camera {
        /// Why.
        reason: String,
    },
    /// Impossible numbers of an emphasis.
    #[error(transparent)]
    Emphasis(#[from] tetlux_optics::EmphasisError),
    /// A combination that cannot be.
    #[error("{0}")]
    Method(String),
}
