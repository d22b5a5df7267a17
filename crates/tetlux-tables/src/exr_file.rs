//! The OpenEXR file of a table: one layer of named channels and one text attribute.

use std::fs::File;
use std::io::{BufReader, Cursor};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

use exr::block::reader::Reader;
use exr::image::{AnyChannel, AnyChannels, Encoding, FlatSamples};
use exr::meta::attribute::{AttributeValue, LineOrder, Text};
use exr::meta::header::LayerAttributes;
use exr::prelude::{Blocks, Compression, Layer, ReadChannels, ReadLayers, Vec2, WritableImage, f16};
use tetlux_image::{ImageError, METADATA_ATTRIBUTE, write_atomically};

/// Lossless and understood by every reader.
const ENCODING: Encoding =
    Encoding { compression: Compression::ZIP16, blocks: Blocks::ScanLines, line_order: LineOrder::Increasing };

/// Width and height of the picture of a table: slices of the third axis are stacked downwards.
pub(crate) fn picture_size(size: [u32; 3]) -> [usize; 2] {
    [size[0] as usize, size[1] as usize * size[2] as usize]
}

/// Writes interleaved texels; in half precision if `half`.
pub(crate) fn write(
    path: &Path,
    size: [usize; 2],
    channels: &[&str],
    texels: &[f32],
    half: bool,
    metadata: &str,
) -> Result<(), ImageError> {
    let mut attributes = LayerAttributes::default();
    // The format's strings are bytes of no stated encoding; `Text::from` would take Latin-1 only.
    let text = Text::from_slice_unchecked(metadata.as_bytes());
    attributes.other.insert(Text::from(METADATA_ATTRIBUTE), AttributeValue::Text(text));
    let list = channels.iter().enumerate().map(|(index, name)| {
        let values = texels.iter().skip(index).step_by(channels.len()).copied();
        let samples = if half {
            FlatSamples::F16(values.map(f16::from_f32).collect())
        } else {
            FlatSamples::F32(values.collect())
        };
        AnyChannel::new(*name, samples)
    });
    let layer = Layer::new((size[0], size[1]), attributes, ENCODING, AnyChannels::sort(list.collect()));
    let mut bytes = Vec::new();
    exr::image::Image::from_layer(layer)
        .write()
        .non_parallel()
        .to_buffered(Cursor::new(&mut bytes))
        .map_err(|error| ImageError::Encode { path: path.to_owned(), reason: error.to_string() })?;
    write_atomically(path, |file| file.write_all(&bytes))
}

/// A file whose headers have been read and nothing else.
pub(crate) struct Opened {
    reader: Reader<BufReader<File>>,
}

impl Opened {
    /// Reads the headers. `Err` says in words what is wrong with them.
    pub(crate) fn new(file: File) -> Result<Self, String> {
        let reader = exr::block::read(BufReader::new(file), false).map_err(|error| error.to_string())?;
        match reader.headers().len() {
            1 => Ok(Self { reader }),
            layers => Err(format!("{layers} layers instead of one")),
        }
    }

    /// The text of the metadata attribute.
    pub(crate) fn metadata(&self) -> Result<String, String> {
        let name = Text::from(METADATA_ATTRIBUTE);
        let value = self.reader.headers()[0].own_attributes.other.get(&name);
        let value = value.ok_or_else(|| format!("no attribute {METADATA_ATTRIBUTE:?}"))?;
        let text = value.to_text().map_err(|error| error.to_string())?;
        let text = std::str::from_utf8(text.as_slice()).map_err(|error| error.to_string())?;
        Ok(text.to_owned())
    }

    /// Width and height.
    pub(crate) fn size(&self) -> [usize; 2] {
        let size = self.reader.headers()[0].layer_size;
        [size.width(), size.height()]
    }

    /// Decodes the texels, interleaved in the order of `channels`. The size must have been found right before: this
    /// allocates by it.
    pub(crate) fn texels(self, channels: &[&str]) -> Result<Vec<f32>, String> {
        let list = &self.reader.headers()[0].channels.list;
        let mut names: Vec<String> = list.iter().map(|channel| channel.name.to_string()).collect();
        let mut expected = channels.to_vec();
        names.sort();
        expected.sort_unstable();
        if names != expected {
            return Err(format!("channels {} instead of {}", names.join(" "), expected.join(" ")));
        }
        if let Some(channel) = list.iter().find(|channel| channel.sampling != Vec2(1, 1)) {
            return Err(format!("channel {} is subsampled", channel.name));
        }
        let count = self.size()[0] * self.size()[1];
        let reader = self.reader;
        let decode = || {
            exr::prelude::read()
                .no_deep_data()
                .largest_resolution_level()
                .all_channels()
                .first_valid_layer()
                .all_attributes()
                .non_parallel()
                .from_chunks(reader)
        };
        // exr 1.74 decodes damaged B44 blocks by arithmetic that overflows, a panic where overflow is checked. Nothing
        // that the closure touches outlives it, so no broken state is seen afterwards.
        let image = catch_unwind(AssertUnwindSafe(decode))
            .map_err(|_| "a compressed block is damaged".to_owned())?
            .map_err(|error| error.to_string())?;
        let mut texels = vec![0.0; count * channels.len()];
        for channel in &image.layer_data.channel_data.list {
            let index = channels.iter().position(|name| channel.name == **name);
            let values = texels.iter_mut().skip(index.unwrap_or(0)).step_by(channels.len());
            for (texel, value) in values.zip(channel.sample_data.values_as_f32()) {
                *texel = value;
            }
        }
        Ok(texels)
    }
}
