//! Checkpoints as files.
//!
//! In this order, numbers with the least byte first: 8 bytes [`MAGIC`]; the format, 4 bytes; the header's length, 4; the whole
//! file's, 8; the header, JSON; the sections that it lists; XXH3 of all before, 16 bytes. A file is complete or absent: it is
//! written beside its place, brought to the disk, then renamed.

use std::ffi::OsString;
use std::fs::{self, File};
use std::io::{self, BufWriter, Read, Write};
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use xxhash_rust::xxh3::{Xxh3, xxh3_128};

use super::{Checkpoint, CheckpointError, Origin, Totals};
use crate::double;
use crate::engine::State;
use crate::film::file::Format;
use crate::kernels;

/// The extension of merged checkpoints; others may have any that is not a picture's.
pub const EXTENSION: &str = "checkpoint";
/// What a checkpoint begins with.
const MAGIC: [u8; 8] = *b"caustica";
/// The way in which this program writes.
const FORMAT: u32 = 1;
/// Bytes before the header.
const PREFIX: usize = 24;
/// Bytes after the sections.
const SUM: usize = 16;
/// Bytes of a pixel's `parts`.
const PARTS_BYTES: usize = 8;
/// No render takes longer, in seconds: 35,000 years.
const ELAPSED_MAX: u64 = 1 << 40;

/// What stands before the sections.
#[derive(Serialize, Deserialize)]
struct Header {
    origin: Origin,
    totals: Totals,
    first_pass: u32,
    passes: u32,
    bits: u32,
    /// Bytes of each section, in order.
    film: u64,
    statistics: u64,
    parts: u64,
}

/// Writes a checkpoint, so that at any moment either the one before or this one is whole on the disk.
///
/// # Errors
/// Where the system refuses; the one before stays.
pub fn write(file: &Path, checkpoint: &Checkpoint) -> Result<(), CheckpointError> {
    let unfinished = unfinished_name(file);
    let written = write_to(&unfinished, checkpoint)
        .and_then(|()| fs::rename(&unfinished, file))
        .and_then(|()| sync_folder(file));
    written.map_err(|source| {
        // It may not be there; the error to report is the first one.
        let _ = fs::remove_file(&unfinished);
        CheckpointError::Io { file: file.to_owned(), verb: "written", source }
    })
}

/// Finds out before the work whether a checkpoint can be written to this place.
///
/// # Errors
/// Where it has a picture's name, or no file can be made there.
pub fn check_place(file: &Path) -> Result<(), CheckpointError> {
    if Format::of(file).is_some() {
        return Err(CheckpointError::Unfit {
            file: file.to_owned(),
            what: "this is a picture's name, not a checkpoint's".to_owned(),
            mend: format!("end it in .{EXTENSION}; pictures are named by -o"),
        });
    }
    let unfinished = unfinished_name(file);
    let made = match fs::metadata(file) {
        Ok(found) if found.is_dir() => Err(io::Error::other("this is a folder")),
        _ => fs::write(&unfinished, []).and_then(|()| fs::remove_file(&unfinished)),
    };
    made.map_err(|source| CheckpointError::Io { file: file.to_owned(), verb: "written", source })
}

/// Reads a checkpoint. Takes no more memory than some times the file's length.
///
/// # Errors
/// Where there is none, or one that is damaged or of another format.
pub fn read(file: &Path) -> Result<Checkpoint, CheckpointError> {
    let bytes = read_bytes(file).map_err(|source| CheckpointError::Io {
        file: file.to_owned(),
        verb: "read",
        source,
    })?;
    decode(file, &bytes)
}

fn read_bytes(file: &Path) -> io::Result<Vec<u8>> {
    let opened = File::open(file)?;
    let found = opened.metadata()?;
    if !found.is_file() {
        return Err(io::Error::other("this is no file"));
    }
    // a device or pipe would never end
    let mut bytes = Vec::new();
    opened.take(found.len()).read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// A hidden name beside `file`, always the same, so that what a killed render leaves there is written over by the next.
fn unfinished_name(file: &Path) -> PathBuf {
    let mut name = OsString::from(".");
    name.push(file.file_name().unwrap_or_default());
    name.push(".part");
    file.with_file_name(name)
}

fn write_to(file: &Path, checkpoint: &Checkpoint) -> io::Result<()> {
    let opened = File::create(file)?;
    let mut out = Summing { inner: BufWriter::new(&opened), sum: Box::default() };
    let parts: Vec<u8> = checkpoint.parts.iter().flatten().flat_map(|n| n.to_le_bytes()).collect();
    let State { first_pass, passes, bits, film, statistics } = &checkpoint.state;
    let header = Header {
        origin: checkpoint.origin.clone(),
        totals: checkpoint.totals,
        first_pass: *first_pass,
        passes: *passes,
        bits: *bits,
        film: film.len() as u64,
        statistics: statistics.len() as u64,
        parts: parts.len() as u64,
    };
    let header = serde_json::to_vec(&header)?;
    let length = u32::try_from(header.len()).map_err(io::Error::other)?;
    let total = PREFIX + header.len() + film.len() + statistics.len() + parts.len() + SUM;
    out.write_all(&MAGIC)?;
    out.write_all(&FORMAT.to_le_bytes())?;
    out.write_all(&length.to_le_bytes())?;
    out.write_all(&(total as u64).to_le_bytes())?;
    for section in [&header, film, statistics, &parts] {
        out.write_all(section)?;
    }
    let sum = out.sum.digest128();
    out.write_all(&sum.to_le_bytes())?;
    out.flush()?;
    drop(out);
    opened.sync_all()
}

/// Brings the new name to the disk, where folders can be opened.
fn sync_folder(file: &Path) -> io::Result<()> {
    let folder = file.parent().filter(|folder| *folder != Path::new("")).unwrap_or(Path::new("."));
    if cfg!(unix) { File::open(folder)?.sync_all() } else { Ok(()) }
}

/// Hashes what it hands on.
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

/// Reads a checkpoint from a file's bytes; `file` names it in messages.
///
/// # Errors
/// As [`read`].
pub fn decode(file: &Path, bytes: &[u8]) -> Result<Checkpoint, CheckpointError> {
    let not_one = |what: &str| CheckpointError::NotOne { file: file.to_owned(), what: what.to_owned() };
    let damaged = |what: String| CheckpointError::Damaged { file: file.to_owned(), what };
    if !bytes.starts_with(&MAGIC) {
        return Err(not_one("it does not begin as one"));
    }
    let Some((prefix, _)) = bytes.split_first_chunk::<PREFIX>() else {
        return Err(not_one("it ends before its length is told"));
    };
    let word = |at: usize| u32::from_le_bytes([0, 1, 2, 3].map(|k| prefix[at + k]));
    let format = word(8);
    if format != FORMAT {
        return Err(CheckpointError::Format { file: file.to_owned(), expected: FORMAT, found: format });
    }
    let expected = u64::from(word(16)) | u64::from(word(20)) << 32;
    if expected != bytes.len() as u64 {
        let found = bytes.len() as u64;
        return Err(CheckpointError::Length { file: file.to_owned(), expected, found });
    }
    let Some((content, sum)) = bytes.split_last_chunk::<SUM>().filter(|(content, _)| content.len() >= PREFIX)
    else {
        return Err(damaged("it ends before its checksum".to_owned()));
    };
    if xxh3_128(content) != u128::from_le_bytes(*sum) {
        return Err(damaged("its checksum is not that of its content".to_owned()));
    }
    let short = || damaged("its parts are longer than it is".to_owned());
    let (header, mut rest) = content[PREFIX..].split_at_checked(word(12) as usize).ok_or_else(short)?;
    let header: Header =
        serde_json::from_slice(header).map_err(|error| damaged(format!("its header: {error}")))?;
    let mut section = |length: u64| {
        let (section, others) = rest.split_at_checked(usize::try_from(length).ok()?)?;
        rest = others;
        Some(section)
    };
    let film = section(header.film).ok_or_else(short)?;
    let statistics = section(header.statistics).ok_or_else(short)?;
    let parts = section(header.parts).ok_or_else(short)?;
    if !rest.is_empty() {
        return Err(damaged("there is more in it than its header tells".to_owned()));
    }
    check_header(&header).map_err(damaged)?;
    let pair = |bytes: &[u8]| [0, 4].map(|at| u32::from_le_bytes([0, 1, 2, 3].map(|k| bytes[at + k])));
    Ok(Checkpoint {
        origin: header.origin,
        totals: header.totals,
        state: State {
            first_pass: header.first_pass,
            passes: header.passes,
            bits: header.bits,
            film: film.to_vec(),
            statistics: statistics.to_vec(),
        },
        parts: parts.chunks_exact(PARTS_BYTES).map(pair).collect(),
    })
}

/// Whether the numbers fit one another.
fn check_header(header: &Header) -> Result<(), String> {
    let (film_bytes, statistics_bytes) = match header.bits {
        32 => (kernels::bytes::FILM_BYTES, kernels::bytes::STATISTICS_BYTES),
        64 => (double::kernels::bytes::FILM_BYTES, double::kernels::bytes::STATISTICS_BYTES),
        bits => return Err(format!("expected numbers of 32 or 64 bits, found {bits}")),
    };
    let pixels = u64::from(header.origin.width) * u64::from(header.origin.height);
    let film = pixels.checked_mul(film_bytes as u64);
    if pixels == 0 || film != Some(header.film) {
        return Err(format!("{} bytes of film for {pixels} pixels", header.film));
    }
    if !header.statistics.is_multiple_of(statistics_bytes as u64) {
        return Err(format!("{} bytes of statistics", header.statistics));
    }
    if header.parts != 0 && Some(header.parts) != pixels.checked_mul(PARTS_BYTES as u64) {
        return Err(format!("{} bytes of parts for {pixels} pixels", header.parts));
    }
    if header.totals.elapsed.as_secs() > ELAPSED_MAX {
        return Err(format!("{} s of rendering", header.totals.elapsed.as_secs()));
    }
    if header.passes == 0 || header.first_pass.checked_add(header.passes).is_none() {
        return Err(format!("{} passes from pass {}", header.passes, header.first_pass));
    }
    Ok(())
}
