use std::fs;
use std::path::PathBuf;

use exr::image::{AnyChannel, AnyChannels, FlatSamples};
use exr::prelude::f16;
use proptest::prelude::*;
use tempfile::TempDir;

use super::*;

/// A folder of its own, and the path of a file in it.
fn scratch() -> (TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("image.exr");
    (folder, path)
}

/// An image whose every pixel differs, taller than a block of 16 scan lines.
fn sample() -> Image {
    let pixels = (0..7 * 40).map(|i| [i as f32, 1.0 / (i as f32 + 1.0), -(i as f32), 0.5]).collect();
    Image::from_pixels(7, 40, pixels).unwrap()
}

fn sample_bytes() -> Vec<u8> {
    let (_folder, path) = scratch();
    write_exr(&sample(), &path, Some(r#"{"a":1}"#)).unwrap();
    fs::read(path).unwrap()
}

fn read_bytes(bytes: &[u8]) -> Result<Image, ImageError> {
    let (_folder, path) = scratch();
    fs::write(&path, bytes).unwrap();
    read_exr(&path)
}

/// Writes a layer of the given channels, as another program might.
fn write_channels(path: &Path, size: (usize, usize), encoding: Encoding, channels: Vec<(&str, FlatSamples)>) {
    let list = channels.into_iter().map(|(name, samples)| AnyChannel::new(name, samples)).collect();
    let layer = Layer::new(size, LayerAttributes::default(), encoding, AnyChannels::sort(list));
    exr::image::Image::from_layer(layer).write().non_parallel().to_file(path).unwrap();
}

/// The position of `pattern` in `bytes`.
fn find(bytes: &[u8], pattern: &[u8]) -> usize {
    bytes.windows(pattern.len()).position(|window| window == pattern).unwrap()
}

proptest! {
    #[test]
    fn every_bit_survives(bits in prop::collection::vec(prop::array::uniform4(any::<u32>()), 35)) {
        let (_folder, path) = scratch();
        let pixels: Vec<[f32; 4]> = bits.iter().map(|pixel| pixel.map(f32::from_bits)).collect();
        write_exr(&Image::from_pixels(5, 7, pixels).unwrap(), &path, None).unwrap();
        let read = read_exr(&path).unwrap();
        prop_assert_eq!((read.width(), read.height()), (5, 7));
        let read: Vec<[u32; 4]> = read.pixels().iter().map(|pixel| pixel.map(f32::to_bits)).collect();
        prop_assert_eq!(read, bits);
        prop_assert_eq!(read_exr_metadata(&path).unwrap(), None);
    }
}

#[test]
fn metadata_survives_whatever_its_length_and_letters() {
    let (_folder, path) = scratch();
    for metadata in [String::new(), r#"{"scene":"Größe τ → 体"}"#.to_owned(), "x".repeat(1 << 20)] {
        write_exr(&sample(), &path, Some(&metadata)).unwrap();
        assert_eq!(read_exr_metadata(&path).unwrap().as_deref(), Some(metadata.as_str()));
        assert_eq!(read_exr(&path).unwrap(), sample());
    }
}

#[test]
fn metadata_that_is_not_utf_8_is_an_error() {
    let mut bytes = sample_bytes();
    let start = find(&bytes, br#"{"a":1}"#);
    bytes[start] = 0xff;
    let (_folder, path) = scratch();
    fs::write(&path, &bytes).unwrap();
    let error = read_exr_metadata(&path).unwrap_err();
    assert!(matches!(error, ImageError::Decode { .. }) && error.to_string().contains("tetlux"), "{error}");
    assert_eq!(read_exr(&path).unwrap(), sample(), "the pixels do not depend on it");
}

#[test]
fn half_rgb_in_tiles_is_read_as_opaque() {
    let (_folder, path) = scratch();
    // Small integers and halves, which a half holds exactly.
    let channel = |factor: f32| FlatSamples::F16((0..15).map(|i| f16::from_f32(i as f32 * factor)).collect());
    let tiles = Encoding { blocks: Blocks::Tiles(Vec2(2, 2)), ..ENCODING };
    write_channels(&path, (5, 3), tiles, vec![("R", channel(1.0)), ("G", channel(0.5)), ("B", channel(-1.0))]);
    let expected: Vec<[f32; 4]> = (0..15).map(|i| i as f32).map(|i| [i, i * 0.5, -i, 1.0]).collect();
    assert_eq!(read_exr(&path).unwrap(), Image::from_pixels(5, 3, expected).unwrap());
}

#[test]
fn other_channels_are_ignored_and_missing_ones_named() {
    let (_folder, path) = scratch();
    let channel = |value: f32| FlatSamples::F32(vec![value]);
    let color = vec![("A", channel(0.5)), ("B", channel(3.0)), ("G", channel(2.0)), ("R", channel(1.0))];
    write_channels(&path, (1, 1), ENCODING, color.into_iter().chain([("Z", channel(9.0))]).collect());
    assert_eq!(read_exr(&path).unwrap().pixels(), [[1.0, 2.0, 3.0, 0.5]]);

    write_channels(&path, (1, 1), ENCODING, vec![("Y", channel(1.0)), ("Z", channel(1.0))]);
    let error = read_exr(&path).unwrap_err();
    assert!(matches!(&error, ImageError::Channels { found, .. } if found == "Y Z"), "{error}");
}

#[test]
fn files_that_are_not_exr_are_clear_errors() {
    let (_folder, path) = scratch();
    assert!(matches!(read_exr(&path), Err(ImageError::Io { action: "open", .. })));
    for bytes in [&b""[..], b"v", b"\x89PNG\r\n\x1a\n and more", &[0; 4096], &[0x76, 0x2f, 0x31, 0x01]] {
        let error = read_bytes(bytes).unwrap_err();
        assert!(matches!(error, ImageError::Decode { .. }), "{error}");
        assert!(error.to_string().contains("image.exr"), "{error}");
    }
}

#[test]
fn every_truncation_is_an_error() {
    let bytes = sample_bytes();
    for length in 0..bytes.len() {
        assert!(matches!(read_bytes(&bytes[..length]), Err(ImageError::Decode { .. })), "{length} bytes");
    }
    assert_eq!(read_bytes(&bytes).unwrap(), sample());
}

#[test]
fn a_hostile_size_is_refused_before_it_is_allocated() {
    let bytes = sample_bytes();
    // dataWindow\0 box2i\0 size(4) xMin yMin xMax yMax: the last two are inclusive and 16 bytes after the size.
    let window = find(&bytes, b"dataWindow\0box2i\0") + b"dataWindow\0box2i\0".len() + 4;
    for [x_max, y_max] in [[40_000, 39], [6, 40_000], [20_000, 20_000], [i32::MAX, i32::MAX], [-9, -9], [i32::MAX, 0]] {
        let mut hostile = bytes.clone();
        hostile[window + 8..window + 12].copy_from_slice(&x_max.to_le_bytes());
        hostile[window + 12..window + 16].copy_from_slice(&y_max.to_le_bytes());
        let error = read_bytes(&hostile).unwrap_err();
        assert!(matches!(error, ImageError::Unfit { .. } | ImageError::Decode { .. }), "{x_max} {y_max}: {error}");
        assert!(error.to_string().contains("image.exr"), "{error}");
    }
}

#[test]
fn a_block_given_twice_instead_of_another_is_found() {
    let mut bytes = sample_bytes();
    // The offset table is the three u64 before the first block; let its second entry name the first block.
    let table = bytes
        .windows(8)
        .enumerate()
        .find_map(|(at, window)| {
            let offset = u64::from_le_bytes(window.try_into().unwrap());
            (offset == at as u64 + 24).then_some(at)
        })
        .unwrap();
    bytes.copy_within(table..table + 8, table + 8);
    let error = read_bytes(&bytes).unwrap_err();
    assert!(error.to_string().contains("no value for pixel (0, 16)"), "{error}");
}

#[test]
fn subsampled_channels_are_refused() {
    let mut bytes = sample_bytes();
    // A channel: name\0 type(4) linear(1) reserved(3) xSampling(4) ySampling(4).
    let first = find(&bytes, b"channels\0chlist\0") + b"channels\0chlist\0".len() + 4;
    bytes[first + 2 + 8] = 7;
    let error = read_bytes(&bytes).unwrap_err();
    assert!(error.to_string().contains("subsampl"), "{error}");
}

#[test]
fn a_failing_write_leaves_what_was_there() {
    // A folder with something in it cannot be replaced by a file: the rename at the very end fails.
    let (folder, path) = scratch();
    fs::create_dir(&path).unwrap();
    fs::write(path.join("inside"), "kept").unwrap();
    assert!(matches!(write_exr(&sample(), &path, None), Err(ImageError::Io { .. })));
    assert_eq!(fs::read_to_string(path.join("inside")).unwrap(), "kept");
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1, "no temporary file is left");
}

/// A small file of each compression, made once.
fn compressed_files() -> Vec<Vec<u8>> {
    let (_folder, path) = scratch();
    let compressions = [
        Compression::Uncompressed,
        Compression::RLE,
        Compression::ZIP1,
        Compression::ZIP16,
        Compression::PIZ,
        Compression::PXR24,
        Compression::B44,
    ];
    let mut files = vec![sample_bytes()];
    for compression in compressions {
        let channel = || FlatSamples::F16((0..30 * 20).map(|i| f16::from_f32((i % 37) as f32)).collect());
        let encoding = Encoding { compression, ..ENCODING };
        write_channels(&path, (30, 20), encoding, vec![("R", channel()), ("G", channel()), ("B", channel())]);
        files.push(fs::read(&path).unwrap());
    }
    files
}

/// Damage of any kind is an error or an image of the stated size, never a panic.
#[test]
fn mutated_bytes_never_panic() {
    let files = compressed_files();
    let mutation = (any::<prop::sample::Index>(), any::<u8>());
    let inputs = (any::<prop::sample::Index>(), prop::collection::vec(mutation, 1..6));
    proptest!(ProptestConfig::with_cases(800), |((file, mutations) in inputs)| {
        let mut bytes = file.get(&files).clone();
        for (index, byte) in mutations {
            let index = index.index(bytes.len());
            bytes[index] = byte;
        }
        let (_folder, path) = scratch();
        fs::write(&path, &bytes).unwrap();
        if let Ok(image) = read_exr(&path) {
            prop_assert_eq!(image.pixels().len() as u64, u64::from(image.width()) * u64::from(image.height()));
        }
        // Only the absence of a panic is asked of the metadata.
        let _ = read_exr_metadata(&path);
    });
}

/// The decoder's own panic, see [`read_exr`]: each value of a B44 block is the one before it plus a step minus a
/// bias, and a block of zeros makes the very first 0 + 0 - 32.
#[test]
fn damaged_b44_blocks_are_errors_or_images() {
    let mut bytes = compressed_files().pop().unwrap();
    let last_blocks = bytes.len() - 30 * 20;
    bytes[last_blocks..].fill(0);
    match read_bytes(&bytes) {
        Ok(image) => assert_eq!((image.width(), image.height()), (30, 20)),
        Err(error) => assert!(matches!(error, ImageError::Decode { .. }), "{error}"),
    }
}
