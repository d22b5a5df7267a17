//! Why a picture could not be made.

use tetlux_image::ImageError;
use tetlux_shaders::ComposeError;

/// Why a picture could not be made.
#[derive(Debug, thiserror::Error)]
pub enum RenderError {
    /// The scene lacks what its classification or its light needs.
    #[error("the scene needs {0}, and has none: make it with SceneFile::scene on this mesh")]
    Missing(&'static str),
    /// The plan wants a graphics adapter and there is none.
    #[error("there is no graphics adapter: use the CPU back end, or install a driver")]
    NoAdapter,
    /// The adapter gave no device.
    #[error("{adapter} could not be opened: {reason}")]
    Open {
        /// The adapter's name.
        adapter: String,
        /// What the driver said.
        reason: String,
    },
    /// Something does not fit the device.
    #[error("{what} needs {needed} {unit}, but {adapter} allows {limit}: use the CPU back end")]
    Limit {
        /// What is too large.
        what: &'static str,
        /// How much it needs.
        needed: u64,
        /// "bytes", "pixels" or "buffers a stage".
        unit: &'static str,
        /// How much there is.
        limit: u64,
        /// The adapter's name.
        adapter: String,
    },
    /// The device is gone: the driver was reset or removed, or it has crashed.
    #[error("{adapter} was lost ({reason}): render again, which opens it anew, or use the CPU back end")]
    Lost {
        /// The adapter's name.
        adapter: String,
        /// What the driver said.
        reason: String,
    },
    /// The device has not the memory that the picture takes.
    #[error("{adapter} is out of memory ({reason}): make the picture or the mesh smaller, or use the CPU back end")]
    OutOfMemory {
        /// The adapter's name.
        adapter: String,
        /// What the driver said.
        reason: String,
    },
    /// The driver reported another error.
    #[error("{adapter} failed: {reason}")]
    Device {
        /// The adapter's name.
        adapter: String,
        /// What the driver said.
        reason: String,
    },
    /// Rays were left before their end: some drivers end a shader's loops after so many turns (Mesa's software driver after
    /// 65 535 in all).
    #[error(
        "{adapter} ended {rays} rays before they had left the mesh, as drivers do whose loops may take so many turns alone: \
         draw by projected tetrahedra (projection pt), or use the CPU back end"
    )]
    CutShort {
        /// The adapter's name.
        adapter: String,
        /// How many.
        rays: usize,
    },
    /// The method looks values up in a table that was not given.
    #[error(
        "the integrator needs the table \"{id}\", which was not given: hand over every table that table_specs names"
    )]
    NoTable {
        /// The name in its specification.
        id: String,
    },
    /// The pictures that an adapter is measured by could not be set up.
    #[error("the pictures that an adapter is measured by: {0}")]
    Sample(String),
    /// A shader could not be put together.
    #[error(transparent)]
    Shader(#[from] ComposeError),
    /// The picture could not be made.
    #[error(transparent)]
    Image(#[from] ImageError),
}
