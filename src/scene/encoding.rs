//! Text encoding of input files: UTF-8 with or without a byte order mark, and detection of UTF-16
//! and UTF-32.

use thiserror::Error;

/// The file is in UTF-16 or UTF-32 instead of UTF-8.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[error("the file is in {0}, expected UTF-8")]
pub(super) struct Foreign(&'static str);

impl Foreign {
    /// Remedy, for the message.
    pub fn help(&self) -> String {
        "save it as UTF-8, with or without a byte order mark".to_owned()
    }
}

/// Strips the UTF-8 byte order mark, if there is one.
///
/// # Errors
/// Text in UTF-16 or UTF-32, detected by its byte order mark or, because every input text begins
/// with ASCII, by its zero bytes.
pub(super) fn unmarked(bytes: &[u8]) -> Result<&[u8], Foreign> {
    match bytes {
        [0xef, 0xbb, 0xbf, text @ ..] => Ok(text),
        [0xff, 0xfe, 0, 0, ..] | [0, 0, 0xfe, 0xff, ..] => Err(Foreign("UTF-32")),
        [0xff, 0xfe, ..] | [0xfe, 0xff, ..] => Err(Foreign("UTF-16")),
        [(1..), 0, 0, 0, ..] | [0, 0, 0, (1..), ..] => Err(Foreign("UTF-32")),
        [(1..), 0, (1..), 0, ..] | [0, (1..), 0, (1..), ..] => Err(Foreign("UTF-16")),
        text => Ok(text),
    }
}

/// Theory: the first four bytes identify the encoding.
#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_and_zeros() {
        let utf16 = |text: &str, mark: bool| -> Vec<u16> {
            mark.then_some(0xfeff).into_iter().chain(text.encode_utf16()).collect()
        };
        let utf32 = |text: &str| text.chars().map(u32::from).collect::<Vec<_>>();
        for text in ["version = 1", "# caf\u{e9}", "v 0 0 0"] {
            assert_eq!(unmarked(text.as_bytes()), Ok(text.as_bytes()));
            assert_eq!(unmarked(format!("\u{feff}{text}").as_bytes()), Ok(text.as_bytes()));
            for mark in [false, true] {
                let little: Vec<u8> =
                    utf16(text, mark).iter().flat_map(|unit| unit.to_le_bytes()).collect();
                let big: Vec<u8> =
                    utf16(text, mark).iter().flat_map(|unit| unit.to_be_bytes()).collect();
                assert_eq!(unmarked(&little), Err(Foreign("UTF-16")));
                assert_eq!(unmarked(&big), Err(Foreign("UTF-16")));
                let text = if mark { format!("\u{feff}{text}") } else { text.to_owned() };
                let little: Vec<u8> =
                    utf32(&text).iter().flat_map(|unit| unit.to_le_bytes()).collect();
                let big: Vec<u8> =
                    utf32(&text).iter().flat_map(|unit| unit.to_be_bytes()).collect();
                assert_eq!(unmarked(&little), Err(Foreign("UTF-32")));
                assert_eq!(unmarked(&big), Err(Foreign("UTF-32")));
            }
        }
        for short in [&b""[..], b"v", b"\xef\xbb", b"\xff"] {
            assert_eq!(unmarked(short), Ok(short));
        }
        assert_eq!(unmarked(b"\xef\xbb\xbf"), Ok(&b""[..]));
    }
}
