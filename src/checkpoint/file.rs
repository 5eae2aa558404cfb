//! Checkpoint file format.
//!
//! Layout, little-endian: [`MAGIC`], 8 bytes; format version, 4; length of the header, 4; length of
//! the file, 8; header in JSON; the sections listed in the header; XXH3 of everything before it, 16
//! bytes. Writes are atomic (see `storage`).

use std::io::{self, BufWriter, Write};
use std::path::Path;

use serde::{Deserialize, Serialize};
use xxhash_rust::xxh3::{Xxh3, xxh3_128};

use super::{Checkpoint, CheckpointError, Origin, Totals, values};
use crate::double;
use crate::engine::{LayerState, State};
use crate::film::file::Format;
use crate::kernels;
use crate::memory;
use crate::scene::Aov;
use crate::storage::{self, Lock, LockError, Purpose};

/// Extension of merged checkpoints. Other checkpoints may have any extension except those of
/// images.
pub const EXTENSION: &str = "checkpoint";
/// Signature at the start of a checkpoint.
const MAGIC: [u8; 8] = *b"caustica";
/// Format version.
const FORMAT: u32 = 2;
/// Bytes before the header.
const PREFIX: usize = 24;
/// Bytes after the sections.
const SUM: usize = 16;
/// Bytes of a pixel's `cuts`.
const CUTS_BYTES: usize = 8;
/// Maximum plausible render time in seconds: 35,000 years.
const ELAPSED_MAX: u64 = 1 << 40;

/// Header before the sections.
#[derive(Serialize, Deserialize)]
struct Header {
    origin: Origin,
    totals: Totals,
    first_pass: u32,
    passes: u32,
    bits: u32,
    // length of each section in bytes, in file order
    film: u64,
    statistics: u64,
    cuts: u64,
    aovs: u64,
    parts: u64,
    counts: u64,
    objects: u64,
}

/// Writes a checkpoint atomically: at any time, either the old or the new file is complete.
///
/// # Errors
/// If the file cannot be written. The old file remains.
pub fn write(file: &Path, checkpoint: &Checkpoint) -> Result<(), CheckpointError> {
    let written = storage::write(file, Purpose::Keepsake, |out| write_to(out, checkpoint));
    written.map_err(|cause| CheckpointError::Io { file: file.to_owned(), verb: "written", cause })
}

/// Checks before rendering that a checkpoint can be written to this file.
///
/// # Errors
/// If the name has an image extension, or the file cannot be created.
pub fn check_place(file: &Path) -> Result<(), CheckpointError> {
    if Format::of(file).is_some() {
        return Err(CheckpointError::Unfit {
            file: file.to_owned(),
            what: "this extension belongs to images, not to checkpoints".to_owned(),
            mend: format!("use a name that ends in .{EXTENSION}; -o names images"),
        });
    }
    storage::check(file, Purpose::Keepsake).map_err(|cause| CheckpointError::Io {
        file: file.to_owned(),
        verb: "written",
        cause,
    })
}

/// Locks a checkpoint for as long as a render may write to it.
///
/// # Errors
/// If another process holds the lock, or the file cannot be locked.
pub fn lock(file: &Path) -> Result<Option<Lock>, CheckpointError> {
    Lock::of(file).map_err(|error| match error {
        LockError::Held(holder) => CheckpointError::Unfit {
            file: file.to_owned(),
            what: match holder {
                Some(id) => {
                    format!("another caustica process ({id}) is writing to this checkpoint")
                }
                None => "another caustica process is writing to this checkpoint".to_owned(),
            },
            mend: "wait for it to end, or use another file".to_owned(),
        },
        LockError::Io(cause) => {
            CheckpointError::Io { file: file.to_owned(), verb: "locked", cause }
        }
    })
}

/// Reads a checkpoint. Memory use is limited to a small multiple of the file length.
///
/// # Errors
/// If the file does not exist, is damaged or has another format.
pub fn read(file: &Path) -> Result<Checkpoint, CheckpointError> {
    let bytes = storage::read(file, memory::readable()).map_err(|cause| CheckpointError::Io {
        file: file.to_owned(),
        verb: "read",
        cause,
    })?;
    decode(file, &bytes)
}

fn write_to(out: &mut dyn Write, checkpoint: &Checkpoint) -> io::Result<()> {
    let mut out = Summing { inner: BufWriter::new(out), sum: Box::default() };
    let State { first_pass, passes, bits, film, statistics, layers } = &checkpoint.state;
    let cuts = words(checkpoint.cuts.iter().flatten());
    let (counts, objects) = (words(layers.counts.iter()), words(layers.objects.iter()));
    let header = Header {
        origin: checkpoint.origin.clone(),
        totals: checkpoint.totals,
        first_pass: *first_pass,
        passes: *passes,
        bits: *bits,
        film: film.len() as u64,
        statistics: statistics.len() as u64,
        cuts: cuts.len() as u64,
        aovs: layers.aovs.len() as u64,
        parts: layers.parts.len() as u64,
        counts: counts.len() as u64,
        objects: objects.len() as u64,
    };
    let header = serde_json::to_vec(&header)?;
    let length = u32::try_from(header.len()).map_err(io::Error::other)?;
    let sections =
        [&header, film, statistics, &cuts, &layers.aovs, &layers.parts, &counts, &objects];
    let total = PREFIX + sections.iter().map(|section| section.len()).sum::<usize>() + SUM;
    out.write_all(&MAGIC)?;
    out.write_all(&FORMAT.to_le_bytes())?;
    out.write_all(&length.to_le_bytes())?;
    out.write_all(&(total as u64).to_le_bytes())?;
    for section in sections {
        out.write_all(section)?;
    }
    let sum = out.sum.digest128();
    out.write_all(&sum.to_le_bytes())?;
    out.flush()
}

fn words<'a>(numbers: impl Iterator<Item = &'a u32>) -> Vec<u8> {
    numbers.flat_map(|n| n.to_le_bytes()).collect()
}

fn words_of(bytes: &[u8]) -> Vec<u32> {
    bytes.chunks_exact(4).map(|word| u32::from_le_bytes([0, 1, 2, 3].map(|k| word[k]))).collect()
}

/// Writer that hashes all bytes that it passes on.
struct Summing<W> {
    inner: W,
    sum: Box<Xxh3>,
}

impl<W: Write> Write for Summing<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let written = self.inner.write(bytes)?;
        self.sum.update(&bytes[..written]);
        Ok(written)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.inner.flush()
    }
}

/// Decodes a checkpoint. `file` is used in error messages only.
///
/// # Errors
/// As for [`read`].
pub fn decode(file: &Path, bytes: &[u8]) -> Result<Checkpoint, CheckpointError> {
    let not_one =
        |what: &str| CheckpointError::NotOne { file: file.to_owned(), what: what.to_owned() };
    let damaged = |what: String| CheckpointError::Damaged { file: file.to_owned(), what };
    if !bytes.starts_with(&MAGIC) {
        return Err(not_one("the signature is missing"));
    }
    let Some((prefix, _)) = bytes.split_first_chunk::<PREFIX>() else {
        return Err(not_one("the file is too short"));
    };
    let word = |at: usize| u32::from_le_bytes([0, 1, 2, 3].map(|k| prefix[at + k]));
    let format = word(8);
    if format != FORMAT {
        return Err(CheckpointError::Format {
            file: file.to_owned(),
            expected: FORMAT,
            found: format,
        });
    }
    let expected = u64::from(word(16)) | u64::from(word(20)) << 32;
    if expected != bytes.len() as u64 {
        let found = bytes.len() as u64;
        return Err(CheckpointError::Length { file: file.to_owned(), expected, found });
    }
    let Some((content, sum)) =
        bytes.split_last_chunk::<SUM>().filter(|(content, _)| content.len() >= PREFIX)
    else {
        return Err(damaged("the checksum is missing".to_owned()));
    };
    if xxh3_128(content) != u128::from_le_bytes(*sum) {
        return Err(damaged("the checksum does not match the content".to_owned()));
    }
    let short = || damaged("the sections are longer than the file".to_owned());
    let (header, mut rest) =
        content[PREFIX..].split_at_checked(word(12) as usize).ok_or_else(short)?;
    let header: Header =
        serde_json::from_slice(header).map_err(|error| damaged(format!("header: {error}")))?;
    let mut section = |length: u64| {
        let (section, others) = rest.split_at_checked(usize::try_from(length).ok()?)?;
        rest = others;
        Some(section)
    };
    let Header { film, statistics, cuts, aovs, parts, counts, objects, .. } = header;
    let lengths = [film, statistics, cuts, aovs, parts, counts, objects];
    let mut sections = [&[][..]; 7];
    for (place, length) in sections.iter_mut().zip(lengths) {
        *place = section(length).ok_or_else(short)?;
    }
    let [film, statistics, cuts, aovs, parts, counts, objects] = sections;
    if !rest.is_empty() {
        return Err(damaged("the file is longer than its sections".to_owned()));
    }
    check_header(&header).map_err(damaged)?;
    values::check_space(&header.origin.space).map_err(damaged)?;
    let state = State {
        first_pass: header.first_pass,
        passes: header.passes,
        bits: header.bits,
        film: film.to_vec(),
        statistics: statistics.to_vec(),
        layers: LayerState {
            aovs: aovs.to_vec(),
            parts: parts.to_vec(),
            counts: words_of(counts),
            objects: words_of(objects),
        },
    };
    let cuts: Vec<[u32; 2]> =
        words_of(cuts).chunks_exact(2).map(|pair| [pair[0], pair[1]]).collect();
    values::check(&state, &cuts).map_err(damaged)?;
    Ok(Checkpoint { origin: header.origin, totals: header.totals, state, cuts })
}

/// Checks that the numbers in the header are consistent.
fn check_header(header: &Header) -> Result<(), String> {
    let [film_bytes, statistics_bytes, aov_bytes, parts_bytes] = match header.bits {
        32 => {
            use kernels::bytes::*;
            [FILM_BYTES, STATISTICS_BYTES, AOV_BYTES, PARTS_BYTES]
        }
        64 => {
            use double::kernels::bytes::*;
            [FILM_BYTES, STATISTICS_BYTES, AOV_BYTES, PARTS_BYTES]
        }
        bits => return Err(format!("expected a precision of 32 or 64 bits, found {bits}")),
    };
    let Origin { width, height, window, aovs, .. } = &header.origin;
    if let Some([x0, y0, x1, y1]) = window
        && !(x0 < x1 && y0 < y1 && x1 <= width && y1 <= height)
    {
        return Err(format!("a crop {x0},{y0},{x1},{y1} of {width} x {height} pixels"));
    }
    let [columns, rows] = header.origin.window_size().map(u64::from);
    let pixels = columns * rows;
    if pixels == 0 {
        return Err("no pixels".to_owned());
    }
    // name, length, whether the section is present, bytes per pixel
    let by_pixel = [
        ("film", header.film, true, film_bytes),
        ("cuts", header.cuts, header.cuts > 0, CUTS_BYTES),
        ("layers", header.aovs, aovs.are_traced(), aov_bytes),
        ("parts", header.parts, header.parts > 0, parts_bytes),
        ("surfaces", header.objects, aovs.has(Aov::Object), 4),
    ];
    for (name, found, wanted, each) in by_pixel {
        let expected = if wanted { pixels.checked_mul(each as u64) } else { Some(0) };
        if expected != Some(found) {
            return Err(format!("{found} bytes of {name} for {pixels} pixels"));
        }
    }
    if !header.statistics.is_multiple_of(statistics_bytes as u64) {
        return Err(format!("{} bytes of statistics", header.statistics));
    }
    if !header.counts.is_multiple_of(4) {
        return Err(format!("{} bytes of counts", header.counts));
    }
    let each = |bytes: u64, size: usize| bytes / size as u64;
    values::check_points(
        &header.origin,
        each(header.statistics, statistics_bytes),
        each(header.counts, 4),
    )?;
    if header.totals.elapsed.as_secs() > ELAPSED_MAX {
        return Err(format!("{} s of rendering", header.totals.elapsed.as_secs()));
    }
    if header.passes == 0 || header.first_pass.checked_add(header.passes).is_none() {
        return Err(format!("{} passes from pass {}", header.passes, header.first_pass));
    }
    Ok(())
}
