//! Image format detection by the first bytes, and the headers of JPEG and Radiance files.

use std::io::{self, BufRead, Read};

/// Supported image formats.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Format {
    Png,
    Jpeg,
    Hdr,
    Exr,
}

/// Number of bytes that [`Format::of`] needs, at most.
pub(super) const HEAD: usize = 16;

impl Format {
    /// Format of a file that begins with these bytes.
    ///
    /// # Errors
    /// Any other content; the message names the format if it is known.
    pub fn of(head: &[u8]) -> Result<Self, String> {
        match head {
            [] => Err("it is empty".to_owned()),
            [0x89, b'P', b'N', b'G', ..] => Ok(Self::Png),
            [0xff, 0xd8, 0xff, ..] => Ok(Self::Jpeg),
            [b'#', b'?', ..] => Ok(Self::Hdr),
            [0x76, 0x2f, 0x31, 0x01, ..] => Ok(Self::Exr),
            _ => match image::guess_format(head) {
                Ok(other) => Err(format!("it is a {} file", other.extensions_str()[0])),
                Err(_) => Err("it is not a supported image".to_owned()),
            },
        }
    }

    /// Returns whether the format stores linear values.
    pub fn is_linear(self) -> bool {
        match self {
            Self::Png | Self::Jpeg => false,
            Self::Hdr | Self::Exr => true,
        }
    }
}

/// Replaces the first line of a Radiance file by the one that the decoder accepts; programs other
/// than Radiance write their own.
pub(super) fn with_radiance_line(mut file: impl BufRead) -> io::Result<impl Read> {
    let mut line = Vec::new();
    file.by_ref().take(1024).read_until(b'\n', &mut line)?;
    Ok(io::Cursor::new(b"#?RADIANCE\n").chain(file))
}

/// Reason why the decoder would garble a JPEG file, if it would. If a sequential file divides its
/// components into several scans, zune-jpeg 0.5 loses the blocks at the end of a scan and misplaces
/// those of components with a higher resolution. A broken file gives `None`, so that the decoder
/// reports it.
pub(super) fn jpeg_fault(mut file: impl Read) -> Option<&'static str> {
    let mut components = 0;
    let mut marker = [0; 2];
    file.read_exact(&mut marker).ok()?;
    loop {
        let kind = next_marker(&mut file)?;
        if matches!(kind, 0x01 | 0xd0..=0xd9) {
            continue;
        }
        let mut length = [0; 2];
        file.read_exact(&mut length).ok()?;
        let mut segment = vec![0; usize::from(u16::from_be_bytes(length)).checked_sub(2)?];
        file.read_exact(&mut segment).ok()?;
        match kind {
            // Baseline and extended sequential. Progressive files decode correctly.
            0xc0 | 0xc1 => components = *segment.get(5)?,
            0xda => {
                let is_split = *segment.first()? < components;
                return is_split.then_some(
                    "it is a JPEG file with several sequential scans, which is not supported",
                );
            }
            _ => {}
        }
    }
}

/// Kind of the next JPEG marker: any number of 0xff bytes, then the kind.
fn next_marker(file: &mut impl Read) -> Option<u8> {
    let mut byte = [0];
    let mut read = || file.read_exact(&mut byte).ok().map(|()| byte[0]);
    while read()? != 0xff {}
    loop {
        match read()? {
            0xff => {}
            kind => return Some(kind),
        }
    }
}
