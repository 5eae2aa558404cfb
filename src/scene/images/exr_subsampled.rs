//! Luminance of EXR files with subsampled chroma. The exr crate reads the headers and blocks of
//! such files, but assumes that all channels have full resolution. This module computes the true
//! size of each block and splits the block into its channels.

use std::io::{BufRead, Seek};

use exr::block::chunk::{Chunk, CompressedBlock};
use exr::compression::Compression;
use exr::error::{Error, Result};
use exr::math::Vec2;
use exr::meta::MetaData;
use exr::meta::attribute::{ChannelDescription, IntegerBounds, SampleType};
use exr::meta::header::Header;
use exr::prelude::{Text, f16};

use super::exr_image::Picture;

/// Largest absolute data window offset that is accepted.
const FARTHEST: i32 = 1 << 30;

/// Reads a channel of full resolution as gray. `file` has been read up to the end of its headers,
/// `meta`; `part` is the index of the header that contains the channel.
///
/// # Errors
/// A damaged file, tiles, or a compression that does not work at this size.
pub(super) fn read(
    mut file: impl BufRead + Seek,
    meta: &MetaData,
    part: usize,
    channel: &Text,
) -> Result<Picture> {
    let header = meta.headers.get(part).ok_or_else(damaged)?;
    let Vec2(width, height) = header.layer_size;
    let Vec2(left, top) = header.data_window().position;
    let is_far = left.unsigned_abs().max(top.unsigned_abs()) > FARTHEST.unsigned_abs();
    let has_step = |part: &ChannelDescription| part.sampling.x() > 0 && part.sampling.y() > 0;
    if is_far || width * height == 0 || !header.channels.list.iter().all(has_step) {
        return Err(damaged());
    }
    let chunks = meta.headers.iter().map(|header| header.chunk_count as u64).sum::<u64>();
    // Skip the table of block offsets: the blocks follow each other anyway.
    let table = i64::try_from(chunks.saturating_mul(8)).map_err(|_| damaged())?;
    file.seek_relative(table)?;
    let mut texels = vec![[0.0; 3]; width * height];
    for _ in 0..chunks {
        let chunk = Chunk::read(&mut file, meta)?;
        if chunk.layer_index != part {
            continue;
        }
        let CompressedBlock::ScanLine(block) = chunk.compressed_block else {
            return Err(Error::NotSupported("tiles of channels of several resolutions".into()));
        };
        let first = i64::from(block.y_coordinate) - i64::from(top);
        let first =
            usize::try_from(first).ok().filter(|&first| first < height).ok_or_else(damaged)?;
        let lines = header.compression.scan_lines_per_block().min(height - first);
        let section = IntegerBounds::new(Vec2(left, block.y_coordinate), Vec2(width, lines));
        let bytes = decompress(header, block.compressed_pixels_le, section)?;
        let mut rest = &bytes[..];
        for line in 0..lines {
            let y = i64::from(block.y_coordinate) + line as i64;
            let has_line = |part: &&ChannelDescription| y.rem_euclid(part.sampling.y() as i64) == 0;
            for part in header.channels.list.iter().filter(has_line) {
                let (samples, behind) =
                    rest.split_at_checked(line_bytes(part, section)).ok_or_else(damaged)?;
                rest = behind;
                if part.name == *channel {
                    let row = &mut texels[(first + line) * width..][..width];
                    values(part.sample_type, samples)
                        .zip(row)
                        .for_each(|(value, texel)| *texel = [value; 3]);
                }
            }
        }
    }
    Ok(Picture { width, height, texels, transparent: false })
}

fn damaged() -> Error {
    Error::Invalid("header or block".into())
}

/// Number of multiples of `step` among the `length` coordinates from `start` on.
fn multiples(start: i32, length: usize, step: usize) -> usize {
    let (start, step) = (i64::from(start), step as i64);
    let last = start + length as i64 - 1;
    (last.div_euclid(step) - (start - 1).div_euclid(step)) as usize
}

fn line_bytes(channel: &ChannelDescription, section: IntegerBounds) -> usize {
    let samples = multiples(section.position.x(), section.size.width(), channel.sampling.x());
    samples * channel.sample_type.bytes_per_sample()
}

fn values(kind: SampleType, bytes: &[u8]) -> impl Iterator<Item = f32> {
    bytes.chunks_exact(kind.bytes_per_sample()).map(move |bytes| match (kind, bytes) {
        (SampleType::F16, &[a, b]) => f16::from_ne_bytes([a, b]).to_f32(),
        (SampleType::F32, &[a, b, c, d]) => f32::from_ne_bytes([a, b, c, d]),
        (SampleType::U32, &[a, b, c, d]) => u32::from_ne_bytes([a, b, c, d]) as f32,
        _ => 0.0,
    })
}

/// Decompresses a block. The crate computes the block's size from the bytes per pixel, so this
/// passes a value that yields the true size.
fn decompress(header: &Header, compressed: Vec<u8>, section: IntegerBounds) -> Result<Vec<u8>> {
    let Vec2(width, lines) = section.size;
    let of_channel = |channel: &ChannelDescription| {
        line_bytes(channel, section) * multiples(section.position.y(), lines, channel.sampling.y())
    };
    let size: usize = header.channels.list.iter().map(of_channel).sum();
    let even = header.channels.list.iter().all(|channel| {
        width.is_multiple_of(channel.sampling.x()) && lines.is_multiple_of(channel.sampling.y())
    });
    let mut header = header.clone();
    let (section, bytes_per_pixel) = match header.compression {
        // These treat a block as a plain sequence of bytes.
        Compression::Uncompressed | Compression::RLE | Compression::ZIP1 | Compression::ZIP16
            if cfg!(target_endian = "little") =>
        {
            (IntegerBounds::new(Vec2(0, 0), Vec2(1, 1)), size)
        }
        // The crate's B44 assumes that all channels have full resolution, and panics.
        Compression::PIZ | Compression::PXR24 if even && size.is_multiple_of(width * lines) => {
            (section, size / (width * lines))
        }
        other => {
            let what = format!("channels of several resolutions with {other}");
            return Err(Error::NotSupported(what.into()));
        }
    };
    header.channels.bytes_per_pixel = bytes_per_pixel;
    let bytes =
        header.compression.decompress_image_section_from_le(&header, compressed, section, false)?;
    if bytes.len() == size { Ok(bytes) } else { Err(damaged()) }
}
