//! The compressors of VTK: each block of an array is a stream of its own, whose length when expanded is known.

use std::io::Read;

use flate2::read::ZlibDecoder;
use lzma_rust2::XzReader;

/// How binary data are compressed.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Compressor {
    None,
    Zlib,
    Lz4,
    Lzma,
    /// Another; an error only where binary data are to be read.
    Other(String),
}

/// Memory in KiB that the dictionary of a LZMA stream may ask for: what its highest preset takes, 64 MiB, and some
/// for the decoder itself. No more is used than data come out.
const DICTIONARY_KIB: u32 = 66 << 10;

impl Compressor {
    /// The compressor that a file's header names.
    pub(super) fn of(name: Option<&str>) -> Compressor {
        match name {
            None | Some("") => Compressor::None,
            Some("vtkZLibDataCompressor") => Compressor::Zlib,
            Some("vtkLZ4DataCompressor") => Compressor::Lz4,
            Some("vtkLZMADataCompressor") => Compressor::Lzma,
            Some(other) => Compressor::Other(other.into()),
        }
    }

    /// How many bytes can come of one at the most, so that no more memory is asked for.
    pub(super) fn most_growth(&self) -> u64 {
        match self {
            Compressor::None | Compressor::Other(_) => 1,
            // RFC 1951: 258 bytes from two bits.
            Compressor::Zlib => 1032,
            // LZ4 block format: 255 bytes from a byte of a length.
            Compressor::Lz4 => 255,
            // 273 bytes from a repeated match, whose 14 binary choices take 0.022 bits each when they are surest
            // (probability 2017/2048): 7091.
            Compressor::Lzma => 7100,
        }
    }

    /// Expands a block and adds it to `bytes`, for which they have room. It must give just `size` bytes; of what it
    /// would give beyond them no more than one byte is made. Else says what was found.
    pub(super) fn expand(&self, block: &[u8], size: u64, bytes: &mut Vec<u8>) -> Result<(), String> {
        match self {
            Compressor::None | Compressor::Other(_) => Err("no compressor".into()),
            Compressor::Zlib => exhaust(ZlibDecoder::new(block), size, bytes),
            Compressor::Lzma => exhaust(XzReader::new_mem_limit(block, false, DICTIONARY_KIB), size, bytes),
            Compressor::Lz4 => {
                let start = bytes.len();
                let end = usize::try_from(size).ok().and_then(|size| start.checked_add(size));
                let end = end.filter(|&end| end <= bytes.capacity()).ok_or("more bytes than the array has")?;
                bytes.resize(end, 0);
                match lz4_flex::block::decompress_into(block, &mut bytes[start..]) {
                    Ok(found) if found as u64 == size => Ok(()),
                    Ok(found) => Err(format!("{found} bytes")),
                    Err(error) => Err(error.to_string()),
                }
            }
        }
    }
}

/// Reads a stream to its end, where its checksum is.
fn exhaust(stream: impl Read, size: u64, bytes: &mut Vec<u8>) -> Result<(), String> {
    // One byte more than there should be, so that the end and the checksum are reached.
    match stream.take(size.saturating_add(1)).read_to_end(bytes) {
        Ok(found) if found as u64 == size => Ok(()),
        Ok(found) => Err(format!("{found} bytes or more")),
        Err(error) => Err(error.to_string()),
    }
}

#[cfg(test)]
mod tests {
    use std::io::Write;

    use super::*;

    fn blocks(data: &[u8]) -> [(Compressor, Vec<u8>); 3] {
        let mut zlib = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::best());
        zlib.write_all(data).unwrap();
        let mut lzma = lzma_rust2::XzWriter::new(Vec::new(), lzma_rust2::XzOptions::with_preset(9)).unwrap();
        lzma.write_all(data).unwrap();
        [
            (Compressor::Zlib, zlib.finish().unwrap()),
            (Compressor::Lz4, lz4_flex::block::compress(data)),
            (Compressor::Lzma, lzma.finish().unwrap()),
        ]
    }

    #[test]
    fn what_was_compressed_comes_back_and_no_other_length_passes() {
        let data: Vec<u8> = (0..5000u32).map(|i| ((i * i) >> 5) as u8).collect();
        for (compressor, block) in blocks(&data) {
            let size = data.len() as u64;
            let mut bytes = Vec::with_capacity(data.len());
            compressor.expand(&block, size, &mut bytes).unwrap();
            assert_eq!(bytes, data, "{compressor:?}");
            for wrong in [0, 1, size - 1, size + 1, u64::MAX] {
                let mut bytes = Vec::with_capacity(data.len() + 1);
                assert!(compressor.expand(&block, wrong, &mut bytes).is_err(), "{compressor:?} {wrong}");
            }
            for cut in (0..block.len()).step_by(97) {
                let mut bytes = Vec::with_capacity(data.len());
                assert!(compressor.expand(&block[..cut], size, &mut bytes).is_err(), "{compressor:?} {cut}");
            }
        }
    }

    #[test]
    fn no_stream_grows_by_more_than_is_said_and_bombs_stop() {
        const SIZE: usize = 4_000_000;
        let data = vec![0; SIZE];
        for (compressor, block) in blocks(&data) {
            let growth = SIZE as u64 / block.len() as u64;
            assert!(growth > 200 && growth <= compressor.most_growth(), "{compressor:?} {growth}");
            let mut bytes = Vec::with_capacity(24);
            assert!(compressor.expand(&block, 24, &mut bytes).is_err());
            // Reading to an end probes with 32 bytes and doubles.
            assert!(bytes.capacity() < 200, "{compressor:?} {}", bytes.capacity());
        }
    }
}
