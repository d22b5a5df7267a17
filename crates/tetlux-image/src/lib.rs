//! Linear images, their files, and the measure of how far two of them differ.
//!
//! An [`Image`] holds linear RGBA in `f32`, premultiplied by alpha, top row first: what a renderer makes and what a
//! reference is compared with. It is kept without loss as OpenEXR ([`write_exr`], [`read_exr`]), shown as 8-bit PNG
//! ([`write_png`]), judged by [`compare`] and made visible by [`difference_picture`]. Every file is written beside
//! its destination and renamed into place ([`write_atomically`]), so a failure never costs an earlier result. Figures are
//! plotted on logarithmic axes as SVG ([`log_log`]).
//!
//! ```
//! use tetlux_image::{Image, compare, read_exr, write_exr};
//!
//! let mut image = Image::new(4, 3)?;
//! image.pixels_mut()[5] = [0.25, 0.1, 0.0, 0.5];
//!
//! let folder = tempfile::tempdir()?;
//! let path = folder.path().join("image.exr");
//! write_exr(&image, &path, Some(r#"{"scene":"one pixel"}"#))?;
//!
//! let metrics = compare(&image, &read_exr(&path)?, 0.0)?;
//! assert_eq!((metrics.max, metrics.over), (0.0, 0));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod atomic;
mod difference;
mod error;
mod exr_file;
mod file;
mod image;
mod metrics;
mod plot;
mod png_file;

pub use atomic::write_atomically;
pub use difference::{DIFFERENCE_FLOOR, difference_picture};
pub use error::ImageError;
pub use exr_file::{METADATA_ATTRIBUTE, read_exr, read_exr_metadata, write_exr};
pub use file::{open_file, read_image};
pub use image::{Image, MAX_PIXELS, MAX_SIDE};
pub use metrics::{Metrics, compare};
pub use plot::{Curve, Grid, Style, log_log};
pub use png_file::{Encoding, read_png, write_png};
