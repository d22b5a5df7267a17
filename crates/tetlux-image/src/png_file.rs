//! PNG files, to be looked at: 8 bits a channel.

use std::io::BufReader;
use std::path::Path;

use png::{BitDepth, ColorType, Decoder, Encoder, SrgbRenderingIntent, Transformations};

use crate::image::{pixel_count, zeroed};
use crate::{Image, ImageError, open_file, write_atomically};

/// How a linear value becomes a stored one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Encoding {
    /// The sRGB transfer curve (IEC 61966-2-1): right for linear light.
    Srgb,
    /// The value as it is: right for colours that were composited in display space, as ParaView does.
    Display,
}

/// Writes an 8-bit PNG: RGB if every pixel is opaque, else RGBA.
///
/// PNG is not premultiplied: colour is divided by alpha while still linear, then encoded. Values are clamped to 0..1
/// (NaN becomes 0) and rounded to the nearest of 256 levels.
///
/// # Errors
/// [`ImageError::Io`] if the file cannot be written, [`ImageError::Encode`] if the encoder refuses the image. An
/// earlier file at `path` is then left alone.
pub fn write_png(image: &Image, path: &Path, encoding: Encoding) -> Result<(), ImageError> {
    let bytes = encode(image, encoding).map_err(|error| ImageError::encode(path, error))?;
    write_atomically(path, |file| file.write_all(&bytes))
}

/// Reads a PNG of any colour type as linear RGB and alpha: colours are decoded from sRGB and, as in the file, not
/// premultiplied. Without an alpha channel alpha is 1. Of 16 bits a channel the upper 8 count.
///
/// # Errors
/// [`ImageError::Io`] if the file cannot be opened, [`ImageError::Decode`] if it is no PNG, is damaged or truncated,
/// [`ImageError::Unfit`] if it exceeds the limits of an [`Image`], found before anything of that size is allocated.
pub fn read_png(path: &Path) -> Result<Image, ImageError> {
    let file = open_file(path).map_err(|error| ImageError::io(path, "open", error))?;
    let failed = |error: png::DecodingError| ImageError::decode(path, error);
    let mut decoder = Decoder::new(BufReader::new(file));
    decoder.set_transformations(Transformations::normalize_to_color8() | Transformations::ALPHA);
    let header = decoder.read_header_info().map_err(failed)?;
    let (width, height) = (header.width, header.height);
    let unfit = |error| ImageError::unfit(path, error);
    pixel_count(u64::from(width), u64::from(height)).map_err(unfit)?;
    let mut reader = decoder.read_info().map_err(failed)?;
    let size = reader.output_buffer_size().ok_or_else(|| ImageError::decode(path, "it is too large"))?;
    let memory = || unfit(ImageError::Memory { width, height });
    let mut samples: Vec<u8> = zeroed(size).ok_or_else(memory)?;
    reader.next_frame(&mut samples).map_err(failed)?;
    let linear = |byte: u8| {
        let value = f32::from(byte) / 255.0;
        if value <= 0.040_45 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
    };
    let channels = reader.output_color_type().0.samples();
    let mut pixels = Vec::new();
    pixels.try_reserve_exact(samples.len() / channels).map_err(|_| memory())?;
    pixels.extend(samples.chunks_exact(channels).map(|s| {
        let [r, g, b] = if channels < 3 { [s[0]; 3] } else { [s[0], s[1], s[2]] };
        [linear(r), linear(g), linear(b), f32::from(s[channels - 1]) / 255.0]
    }));
    Image::from_pixels(width, height, pixels)
}

fn encode(image: &Image, encoding: Encoding) -> Result<Vec<u8>, png::EncodingError> {
    let opaque = image.pixels().iter().all(|pixel| pixel[3] >= 1.0);
    let mut samples = Vec::with_capacity(image.pixels().len() * if opaque { 3 } else { 4 });
    for &[r, g, b, a] in image.pixels() {
        // Where alpha is 0 there is no colour to recover: pure emission is then lost, as PNG cannot hold it.
        let scale = if a > 0.0 && a < 1.0 { 1.0 / a } else { 1.0 };
        samples.extend([r, g, b].map(|value| to_byte(encode_value(value * scale, encoding))));
        if !opaque {
            samples.push(to_byte(a));
        }
    }

    let mut bytes = Vec::new();
    let mut encoder = Encoder::new(&mut bytes, image.width(), image.height());
    encoder.set_color(if opaque { ColorType::Rgb } else { ColorType::Rgba });
    encoder.set_depth(BitDepth::Eight);
    // Either way the bytes are meant for an sRGB screen.
    encoder.set_source_srgb(SrgbRenderingIntent::Perceptual);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(&samples)?;
    writer.finish()?;
    Ok(bytes)
}

fn encode_value(value: f32, encoding: Encoding) -> f32 {
    match encoding {
        Encoding::Display => value,
        Encoding::Srgb if value <= 0.003_130_8 => 12.92 * value,
        Encoding::Srgb => 1.055 * value.powf(1.0 / 2.4) - 0.055,
    }
}

fn to_byte(value: f32) -> u8 {
    // The cast saturates and takes NaN to 0.
    (value * 255.0).round() as u8
}

#[cfg(test)]
mod tests {
    use std::fs;
    use std::io::Cursor;

    use super::*;

    fn decode(bytes: &[u8]) -> (ColorType, Vec<u8>) {
        let mut reader = png::Decoder::new(Cursor::new(bytes)).read_info().unwrap();
        let mut samples = vec![0; reader.output_buffer_size().unwrap()];
        let info = reader.next_frame(&mut samples).unwrap();
        samples.truncate(info.buffer_size());
        (info.color_type, samples)
    }

    fn written(pixels: Vec<[f32; 4]>, encoding: Encoding) -> (ColorType, Vec<u8>) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("image.png");
        let width = u32::try_from(pixels.len()).unwrap();
        write_png(&Image::from_pixels(width, 1, pixels).unwrap(), &path, encoding).unwrap();
        decode(&fs::read(path).unwrap())
    }

    #[test]
    fn opaque_display_values_are_rounded_to_the_nearest_level_as_rgb() {
        // 0.999 / 255 truncates to 0 and rounds to 1; 254.6 / 255 rounds to 255.
        let pixel = [0.999 / 255.0, 127.4 / 255.0, 254.6 / 255.0, 1.0];
        assert_eq!(written(vec![pixel], Encoding::Display), (ColorType::Rgb, vec![1, 127, 255]));
    }

    #[test]
    fn every_level_survives_the_srgb_curve() {
        // The inverse curve of IEC 61966-2-1, in f64: encoding its value must give the level back.
        let decoded = |level: u8| {
            let v = f64::from(level) / 255.0;
            (if v <= 0.040_45 { v / 12.92 } else { ((v + 0.055) / 1.055).powf(2.4) }) as f32
        };
        let levels: Vec<u8> = (0..=255).collect();
        let pixels = levels.iter().map(|&level| [decoded(level), decoded(level), decoded(level), 1.0]).collect();
        let expected: Vec<u8> = levels.iter().flat_map(|&level| [level; 3]).collect();
        assert_eq!(written(pixels, Encoding::Srgb), (ColorType::Rgb, expected));
    }

    #[test]
    fn a_half_transparent_pixel_is_divided_by_alpha_before_the_curve() {
        // Linear 0.5 is level 188 on the sRGB curve: 255 * (1.055 * 0.5^(1/2.4) - 0.055) = 187.5.
        let premultiplied = [0.25, 0.0, 0.5, 0.5];
        let (kind, samples) = written(vec![premultiplied, [0.0; 4]], Encoding::Srgb);
        assert_eq!((kind, samples), (ColorType::Rgba, vec![188, 0, 255, 128, 0, 0, 0, 0]));
    }

    #[test]
    fn values_outside_the_range_are_clamped() {
        let pixels = vec![[-1.0, 2.0, f32::NAN, 1.0], [f32::INFINITY, f32::NEG_INFINITY, 1e30, 3.0]];
        for encoding in [Encoding::Srgb, Encoding::Display] {
            assert_eq!(written(pixels.clone(), encoding), (ColorType::Rgb, vec![0, 255, 0, 255, 0, 255]));
        }
    }

    #[test]
    fn what_was_written_is_read_back() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("image.png");
        let straight = [[0.5, 0.25, 1.0, 0.4], [0.0, 1.0, 0.125, 1.0], [0.0, 0.0, 0.0, 0.0]];
        for pixels in [&straight[..], &straight[1..2]] {
            let premultiplied = pixels.iter().map(|&[r, g, b, a]| [r * a, g * a, b * a, a]).collect();
            write_png(&Image::from_pixels(pixels.len() as u32, 1, premultiplied).unwrap(), &path, Encoding::Srgb)
                .unwrap();
            let read = read_png(&path).unwrap();
            for (got, expected) in read.pixels().iter().zip(pixels) {
                // Half a step of 255 on the steepest part of the inverse curve, slope 2.3.
                assert!((0..4).all(|c| (got[c] - expected[c]).abs() < 1.2 / 255.0), "{got:?} {expected:?}");
            }
        }
    }

    #[test]
    fn damaged_files_are_errors() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("image.png");
        let bytes = encode(&Image::new(5, 4).unwrap(), Encoding::Srgb).unwrap();
        assert!(read_png(&path).is_err(), "absent");
        for end in 0..bytes.len() - 12 {
            fs::write(&path, &bytes[..end]).unwrap();
            assert!(read_png(&path).is_err(), "{end} of {} bytes", bytes.len());
        }
        for at in 0..bytes.len() {
            let mut changed = bytes.clone();
            changed[at] ^= 0x55;
            fs::write(&path, changed).unwrap();
            // An error or a picture, never a panic.
            let _ = read_png(&path);
        }
    }

    #[test]
    fn rows_run_from_the_top() {
        let image = Image::from_pixels(1, 2, vec![[1.0; 4], [0.0, 0.0, 0.0, 1.0]]).unwrap();
        let (_, samples) = decode(&encode(&image, Encoding::Display).unwrap());
        assert_eq!(samples, [255, 255, 255, 0, 0, 0]);
    }
}
