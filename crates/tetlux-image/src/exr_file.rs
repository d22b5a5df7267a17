//! OpenEXR files: images without loss, with a text that says how they came to be.

use std::fs::File;
use std::io::{BufReader, Cursor};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

use exr::block::reader::Reader;
use exr::image::Encoding;
use exr::meta::attribute::{AttributeValue, LineOrder, Text};
use exr::meta::header::{Header, LayerAttributes};
use exr::prelude::{Blocks, Compression, Layer, ReadChannels, ReadLayers, SpecificChannels, Vec2, WritableImage};

use crate::image::{pixel_count, zeroed};
use crate::{Image, ImageError, open_file, write_atomically};

/// Name of the text attribute that holds an image's metadata (JSON).
pub const METADATA_ATTRIBUTE: &str = "tetlux";

/// Lossless and understood by every reader.
const ENCODING: Encoding =
    Encoding { compression: Compression::ZIP16, blocks: Blocks::ScanLines, line_order: LineOrder::Increasing };

/// Writes an OpenEXR file: one layer of scan lines with the channels R, G, B and A in `f32`, every bit kept.
///
/// `metadata` is stored as it is, as the UTF-8 text of the attribute [`METADATA_ATTRIBUTE`]; JSON by convention.
///
/// # Errors
/// [`ImageError::Io`] if the file cannot be written, [`ImageError::Encode`] if the encoder refuses the image. An
/// earlier file at `path` is then left alone.
pub fn write_exr(image: &Image, path: &Path, metadata: Option<&str>) -> Result<(), ImageError> {
    let (width, height) = (image.width() as usize, image.height() as usize);
    let mut attributes = LayerAttributes::default();
    if let Some(metadata) = metadata {
        // The format's strings are bytes of no stated encoding; `Text::from` would take Latin-1 only.
        let text = Text::from_slice_unchecked(metadata.as_bytes());
        attributes.other.insert(Text::from(METADATA_ATTRIBUTE), AttributeValue::Text(text));
    }
    let channels = SpecificChannels::rgba(|position: Vec2<usize>| {
        let [r, g, b, a] = image.pixels()[position.y() * width + position.x()];
        (r, g, b, a)
    });

    let mut bytes = Vec::new();
    exr::image::Image::from_layer(Layer::new((width, height), attributes, ENCODING, channels))
        .write()
        .non_parallel()
        .to_buffered(Cursor::new(&mut bytes))
        .map_err(|error| ImageError::encode(path, error))?;
    write_atomically(path, |file| file.write_all(&bytes))
}

/// Reads the first layer with the channels R, G and B (half, float or integer) of an OpenEXR file, and its A if it
/// has one, else 1. The image is the layer's data window; other layers, channels and resolution levels are ignored.
///
/// # Errors
/// [`ImageError::Io`] if the file cannot be opened; [`ImageError::Decode`] if it is no OpenEXR file, is damaged or
/// truncated, or is deep or subsampled; [`ImageError::Channels`] if no layer has R, G and B; [`ImageError::Unfit`]
/// if the layer exceeds the limits of an [`Image`], found before anything of that size is allocated.
pub fn read_exr(path: &Path) -> Result<Image, ImageError> {
    let reader = open(path)?;
    let header = color_header(path, reader.headers())?;
    let (width, height) = (header.layer_size.width() as u64, header.layer_size.height() as u64);
    pixel_count(width, height).map_err(|error| ImageError::unfit(path, error))?;

    let decode = || {
        exr::prelude::read()
            .no_deep_data()
            .largest_resolution_level()
            .rgba_channels(
                |size, _| Canvas::new(size),
                |canvas, position, (r, g, b, a)| {
                    if let Ok(canvas) = canvas {
                        canvas.set(position, [r, g, b, a]);
                    }
                },
            )
            .first_valid_layer()
            .all_attributes()
            .non_parallel()
            .from_chunks(reader)
    };
    // exr 1.74 decodes damaged B44 blocks by arithmetic that overflows, a panic where overflow is checked. Nothing
    // that the closure touches outlives it, so no broken state is seen afterwards.
    let decoded = catch_unwind(AssertUnwindSafe(decode))
        .map_err(|_| ImageError::decode(path, "a compressed block is damaged"))?
        .map_err(|error| ImageError::decode(path, error))?;
    decoded.layer_data.channel_data.pixels.map_err(|error| ImageError::unfit(path, error))?.finish(path)
}

/// Reads the text of the attribute [`METADATA_ATTRIBUTE`] of an OpenEXR file, without its pixels; `None` if the
/// file has none.
///
/// # Errors
/// [`ImageError::Io`] if the file cannot be opened; [`ImageError::Decode`] if it is no OpenEXR file or damaged, or
/// if the attribute is not UTF-8 text.
pub fn read_exr_metadata(path: &Path) -> Result<Option<String>, ImageError> {
    let reader = open(path)?;
    let name = Text::from(METADATA_ATTRIBUTE);
    let Some(value) = reader.headers().iter().find_map(|header| header.own_attributes.other.get(&name)) else {
        return Ok(None);
    };
    let text = value.to_text().map_err(|error| ImageError::decode(path, error))?;
    let text = std::str::from_utf8(text.as_slice())
        .map_err(|error| ImageError::decode(path, format!("attribute \"{METADATA_ATTRIBUTE}\": {error}")))?;
    Ok(Some(text.to_owned()))
}

/// Opens the file and reads its headers.
fn open(path: &Path) -> Result<Reader<BufReader<File>>, ImageError> {
    let file = open_file(path).map_err(|source| ImageError::io(path, "open", source))?;
    exr::block::read(BufReader::new(file), false).map_err(|error| ImageError::decode(path, error))
}

/// The header of the layer that is read.
fn color_header<'a>(path: &Path, headers: &'a [Header]) -> Result<&'a Header, ImageError> {
    let has_color = |header: &&Header| {
        ["R", "G", "B"].into_iter().all(|name| header.channels.find_index_of_channel(&Text::from(name)).is_some())
    };
    let header = headers.iter().find(has_color).ok_or_else(|| {
        let names = |header: &Header| -> Vec<String> {
            header.channels.list.iter().map(|channel| channel.name.to_string()).collect()
        };
        let found: Vec<String> = headers.iter().map(|header| names(header).join(" ")).collect();
        ImageError::Channels { path: path.to_owned(), found: found.join("; ") }
    })?;
    // The decoder takes every channel for a full one and would read garbage.
    match header.channels.list.iter().find(|channel| channel.sampling != Vec2(1, 1)) {
        Some(channel) => Err(ImageError::decode(path, format!("channel {} is subsampled", channel.name))),
        None => Ok(header),
    }
}

/// An image being read, and which of its pixels the file has given so far: a damaged file can give one block twice
/// and another never.
struct Canvas {
    image: Image,
    given: Vec<bool>,
}

impl Canvas {
    fn new(size: Vec2<usize>) -> Result<Self, ImageError> {
        let side = |length: usize| u32::try_from(length).unwrap_or(u32::MAX);
        let image = Image::new(side(size.width()), side(size.height()))?;
        let given =
            zeroed(image.pixels().len()).ok_or(ImageError::Memory { width: image.width(), height: image.height() })?;
        Ok(Self { image, given })
    }

    fn set(&mut self, position: Vec2<usize>, pixel: [f32; 4]) {
        let index = position.y() * self.image.width() as usize + position.x();
        if let (Some(target), Some(given)) = (self.image.pixels_mut().get_mut(index), self.given.get_mut(index)) {
            *target = pixel;
            *given = true;
        }
    }

    fn finish(self, path: &Path) -> Result<Image, ImageError> {
        match self.given.iter().position(|given| !given) {
            Some(index) => {
                let (x, y) = (index % self.image.width() as usize, index / self.image.width() as usize);
                Err(ImageError::decode(path, format!("the file has no value for pixel ({x}, {y})")))
            }
            None => Ok(self.image),
        }
    }
}

#[cfg(test)]
mod tests;
