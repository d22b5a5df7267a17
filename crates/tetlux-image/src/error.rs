//! What can go wrong with an image or its file.

use std::io;
use std::path::{Path, PathBuf};

use crate::image::{MAX_PIXELS, MAX_SIDE};

/// An image that cannot be made, compared, read or written.
#[derive(Debug, thiserror::Error)]
pub enum ImageError {
    /// A side is zero, a side exceeds [`MAX_SIDE`], or the area exceeds [`MAX_PIXELS`].
    #[error(
        "an image of {width} x {height} pixels: each side must be 1 to {MAX_SIDE} and the area at most {MAX_PIXELS} \
         pixels; choose a smaller size"
    )]
    Size {
        /// Width asked for, in pixels.
        width: u64,
        /// Height asked for, in pixels.
        height: u64,
    },

    /// The memory of an image within the limits is not to be had.
    #[error("no memory for an image of {width} x {height} pixels; choose a smaller size or free memory")]
    Memory {
        /// Width, in pixels.
        width: u32,
        /// Height, in pixels.
        height: u32,
    },

    /// The number of pixels given is not width times height.
    #[error("an image of {width} x {height} pixels was given {found} pixels; it needs exactly width x height")]
    PixelCount {
        /// Width, in pixels.
        width: u32,
        /// Height, in pixels.
        height: u32,
        /// Number of pixels given.
        found: usize,
    },

    /// Two images of different size were to be compared.
    #[error(
        "the images differ in size: {} x {} and {} x {} pixels; render both at one size",
        .first[0], .first[1], .second[0], .second[1]
    )]
    SizeMismatch {
        /// Width and height of the first image.
        first: [u32; 2],
        /// Width and height of the second image.
        second: [u32; 2],
    },

    /// A parameter of a comparison is outside its range.
    #[error("{name} is {found}; it must be {expected}")]
    Parameter {
        /// The parameter.
        name: &'static str,
        /// The value found.
        found: f64,
        /// What it must be.
        expected: &'static str,
    },

    /// The system refused to open, read, write or rename a file.
    #[error("{path}: cannot {action}: {source}", path = .path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What was attempted.
        action: &'static str,
        /// The system's reason.
        source: io::Error,
    },

    /// The file is no readable image of its kind: another format, damaged, truncated, or of an unsupported kind.
    #[error("{path}: cannot decode the image: {reason}; export it again as a flat RGB or RGBA image", path = .path.display())]
    Decode {
        /// The file.
        path: PathBuf,
        /// What the decoder found.
        reason: String,
    },

    /// The file holds an image that cannot be made.
    #[error("{path}: {source}", path = .path.display())]
    Unfit {
        /// The file.
        path: PathBuf,
        /// Why: [`ImageError::Size`] or [`ImageError::Memory`].
        source: Box<ImageError>,
    },

    /// No layer of the file has the channels R, G and B.
    #[error("{path}: no layer has the channels R, G and B (found: {found}); export it again as RGB or RGBA", path = .path.display())]
    Channels {
        /// The file.
        path: PathBuf,
        /// The channels of each layer, as text.
        found: String,
    },

    /// An image could not be encoded.
    #[error("{path}: cannot encode the image: {reason}", path = .path.display())]
    Encode {
        /// The file that was to be written.
        path: PathBuf,
        /// What the encoder refused.
        reason: String,
    },
}

impl ImageError {
    pub(crate) fn io(path: &Path, action: &'static str, source: io::Error) -> Self {
        Self::Io { path: path.to_owned(), action, source }
    }

    /// An image that cannot be made, of a file.
    pub(crate) fn unfit(path: &Path, source: ImageError) -> Self {
        Self::Unfit { path: path.to_owned(), source: Box::new(source) }
    }

    pub(crate) fn decode(path: &Path, reason: impl ToString) -> Self {
        Self::Decode { path: path.to_owned(), reason: reason.to_string() }
    }

    pub(crate) fn encode(path: &Path, reason: impl ToString) -> Self {
        Self::Encode { path: path.to_owned(), reason: reason.to_string() }
    }
}
