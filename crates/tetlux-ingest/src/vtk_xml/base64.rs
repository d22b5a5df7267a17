//! Base64 as VTK writes it: one or more streams, each padded, one after another.

/// Reads bytes from base64 text, passing over white space.
pub(super) struct Decoder<'a> {
    text: &'a [u8],
    at: usize,
}

impl<'a> Decoder<'a> {
    pub(super) fn new(text: &'a [u8]) -> Self {
        Decoder { text, at: 0 }
    }

    /// The next `count` bytes, or as many as are there before the text ends or a character is no base64. Reads whole
    /// groups of four characters: what is left of the last group is passed over, as at the end of a stream.
    pub(super) fn read(&mut self, count: usize) -> Vec<u8> {
        let mut bytes = Vec::with_capacity(count.min((self.text.len() - self.at) / 4 * 3 + 3));
        while bytes.len() < count {
            let Some((group, length)) = self.group() else { break };
            bytes.extend_from_slice(&group[..length]);
        }
        bytes.truncate(count);
        bytes
    }

    /// The bytes of the next four characters, of which padding leaves one, two or three.
    fn group(&mut self) -> Option<([u8; 3], usize)> {
        let mut at = self.at;
        let (mut bits, mut padding) = (0u32, 0);
        for _ in 0..4 {
            while self.text.get(at)?.is_ascii_whitespace() {
                at += 1;
            }
            let value = match self.text[at] {
                c @ b'A'..=b'Z' => c - b'A',
                c @ b'a'..=b'z' => c - b'a' + 26,
                c @ b'0'..=b'9' => c - b'0' + 52,
                b'+' => 62,
                b'/' => 63,
                b'=' => {
                    padding += 1;
                    0
                }
                _ => return None,
            };
            if padding > 0 && self.text[at] != b'=' {
                return None;
            }
            bits = bits << 6 | u32::from(value);
            at += 1;
        }
        if padding > 2 {
            return None;
        }
        self.at = at;
        let [_, bytes @ ..] = bits.to_be_bytes();
        Some((bytes, 3 - padding))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Test vectors of RFC 4648, section 10.
    #[test]
    fn decodes_the_vectors_of_the_standard() {
        for (text, bytes) in
            [("Zg==", "f"), ("Zm8=", "fo"), ("Zm9v", "foo"), ("Zm9vYmE=", "fooba"), ("Zm9v\n YmFy", "foobar")]
        {
            assert_eq!(Decoder::new(text.as_bytes()).read(100), bytes.as_bytes());
        }
    }

    #[test]
    fn stops_at_what_is_no_base64() {
        for text in ["", "Zg", "Z===", "====", "Zm9*", "Z=9v", "Zm9\u{e9}"] {
            assert!(Decoder::new(text.as_bytes()).read(8).is_empty(), "{text}");
        }
    }

    #[test]
    fn goes_on_after_the_padding_of_one_stream_with_the_next() {
        let mut decoder = Decoder::new(b"Zg==Zm9v");
        assert_eq!(decoder.read(1), b"f");
        assert_eq!(decoder.read(3), b"foo");
    }
}
