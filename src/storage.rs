//! Files as the program writes and reads them.
//!
//! A regular file is complete or as it was: it is written under a name of this writer alone in the
//! same folder, then renamed. Links are followed, mode and owner stay, and a file without write
//! permission is refused, even for root. What is no regular file (a pipe, a device) is written to,
//! never replaced.

use std::fs::{self, File, OpenOptions};
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

use xxhash_rust::xxh3::xxh3_64;

/// Links that are followed at most.
const LINKS: u32 = 40;
/// Times that a file is compared with the one that its name leads to.
const LOOKS: u32 = 16;
/// Names of standard output.
const OUTPUT: [&str; 3] = ["/dev/stdout", "/dev/fd/1", "/proc/self/fd/1"];
/// What unfinished files and locks begin with; the rest is short, whatever the name of the file.
const PREFIX: &str = ".caustica-";

/// What stands, or may stand, at the place of an output.
enum Target {
    /// Nothing yet.
    Free(PathBuf),
    /// A regular file.
    Taken(PathBuf, fs::Metadata),
    /// A pipe or a device.
    Special(PathBuf),
    /// This program's standard output, whatever it is.
    Output,
}

/// What a file is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Purpose {
    /// A result: it may go to a pipe or a device, too.
    Result,
    /// Something to be read again: it is brought to the disk, and is a regular file.
    Keepsake,
}

/// Finds out before the work whether `file` can be written after it, and leaves nothing there.
///
/// # Errors
/// Why it cannot.
pub fn check(file: &Path, purpose: Purpose) -> io::Result<()> {
    match place(file)? {
        Target::Special(_) | Target::Output if purpose == Purpose::Keepsake => Err(not_regular()),
        Target::Special(_) | Target::Output => Ok(()),
        Target::Free(target) | Target::Taken(target, _) => {
            let (unfinished, _) = unfinished(&target)?;
            fs::remove_file(&unfinished)
        }
    }
}

/// Writes what `fill` gives to `file`.
///
/// # Errors
/// Where the system refuses; what was there stays.
pub fn write(
    file: &Path,
    purpose: Purpose,
    fill: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> io::Result<()> {
    let (target, before) = match place(file)? {
        Target::Special(_) | Target::Output if purpose == Purpose::Keepsake => {
            return Err(not_regular());
        }
        Target::Output => {
            let mut out = io::stdout().lock();
            return fill(&mut out).and_then(|()| out.flush());
        }
        Target::Special(target) => return fill(&mut OpenOptions::new().write(true).open(target)?),
        Target::Free(target) => (target, None),
        Target::Taken(target, found) => (target, Some(found)),
    };
    let (unfinished, mut out) = unfinished(&target)?;
    // first the mode: what is private must not be readable by others while it is written
    let written = before
        .map_or(Ok(()), |before| take_over(&out, &before))
        .and_then(|()| fill(&mut out))
        .and_then(|()| if purpose == Purpose::Keepsake { out.sync_all() } else { Ok(()) })
        .and_then(|()| put_in_place(&unfinished, &target))
        .and_then(|()| if purpose == Purpose::Keepsake { sync_folder(&target) } else { Ok(()) });
    written.inspect_err(|_| {
        // It may not be there; the error to report is the first one.
        let _ = fs::remove_file(&unfinished);
    })
}

/// Moves `unfinished` to the place of `target`. What is mounted there by itself, as a container's
/// volume of one file, cannot be replaced, and is written over.
fn put_in_place(unfinished: &Path, target: &Path) -> io::Result<()> {
    match fs::rename(unfinished, target) {
        Err(error) if is_mount(&error) => {
            let mut out = OpenOptions::new().write(true).truncate(true).open(target)?;
            io::copy(&mut File::open(unfinished)?, &mut out)?;
            out.sync_all()?;
            fs::remove_file(unfinished)
        }
        renamed => renamed,
    }
}

fn is_mount(error: &io::Error) -> bool {
    matches!(error.kind(), io::ErrorKind::ResourceBusy | io::ErrorKind::CrossesDevices)
}

/// Reads a regular file of at most `most` bytes. Others may never end.
///
/// # Errors
/// Where it is none, is larger, or the system refuses.
pub fn read(file: &Path, most: u64) -> io::Result<Vec<u8>> {
    // opening a pipe would wait for its writer
    let found = fs::metadata(file)?;
    if !found.is_file() {
        return Err(not_regular());
    }
    let opened = File::open(file)?;
    let found = opened.metadata()?;
    if !found.is_file() {
        return Err(not_regular());
    }
    if found.len() > most {
        let text = format!("it has {} bytes, and at most {most} are read", found.len());
        return Err(io::Error::new(io::ErrorKind::FileTooLarge, text));
    }
    let mut bytes = Vec::new();
    opened.take(found.len()).read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// Reads a regular file as text.
///
/// # Errors
/// As [`read`], and where it is not UTF-8.
pub fn read_text(file: &Path, most: u64) -> io::Result<String> {
    String::from_utf8(read(file, most)?)
        .map_err(|error| io::Error::new(io::ErrorKind::InvalidData, error))
}

/// Whether two names are of one file, links followed.
pub fn same(a: &Path, b: &Path) -> bool {
    match (target(a), target(b)) {
        (Ok(a), Ok(b)) => {
            let real =
                |path: &Path| path.canonicalize().or_else(|_| std::path::absolute(path)).ok();
            real(&a) == real(&b)
        }
        _ => false,
    }
}

/// Whether a name is one of an open file: `-`, standard output or error, or a number of the
/// process's own.
pub fn is_stream(file: &Path) -> bool {
    let folders = ["/dev/fd", "/proc/self/fd"];
    let names = ["-", "/dev/stdout", "/dev/stderr"];
    names.iter().any(|name| file == Path::new(name))
        || folders.iter().any(|folder| file.starts_with(folder))
}

/// Held while a render writes to a file: no other one that asks can hold it. It ends with the
/// process.
#[derive(Debug)]
pub struct Lock {
    path: PathBuf,
    // the lock is that of the open file
    _file: File,
}

/// Why a lock is not to be had.
#[derive(Debug)]
pub enum LockError {
    /// Another process holds it, with this id if it is known.
    Held(Option<u32>),
    /// The system refuses.
    Io(io::Error),
}

impl Lock {
    /// Locks `file`, which need not exist, and removes what a killed writer left of it. Where the
    /// file system knows no locks there is none to hold.
    ///
    /// # Errors
    /// Where another process holds the lock, or the system refuses.
    pub fn of(file: &Path) -> Result<Option<Self>, LockError> {
        let target = target(file).map_err(LockError::Io)?;
        let path = target.with_file_name(format!("{PREFIX}{}.lock", hash(&target)));
        loop {
            let mut opened = open_lock(&path).map_err(LockError::Io)?;
            match opened.try_lock() {
                Ok(()) => {}
                Err(fs::TryLockError::WouldBlock) => {
                    let mut text = String::new();
                    let _ = opened.take(20).read_to_string(&mut text);
                    return Err(LockError::Held(text.trim().parse().ok()));
                }
                Err(fs::TryLockError::Error(error)) if knows_no_locks(&error) => {
                    let _ = fs::remove_file(&path);
                    return Ok(None);
                }
                Err(fs::TryLockError::Error(error)) => return Err(LockError::Io(error)),
            }
            // the holder before may have removed the name between opening and locking
            if !is_at(&opened, &path) {
                continue;
            }
            // who holds it is for people; the lock does not depend on it
            let _ = opened.set_len(0).and_then(|()| write!(opened, "{}", std::process::id()));
            remove_leftovers(&target);
            return Ok(Some(Self { path, _file: opened }));
        }
    }
}

/// Opens a lock's file, or makes it. Another user's may be read-only here: the lock is the same,
/// and only the holder's number cannot be put in.
fn open_lock(path: &Path) -> io::Result<File> {
    match OpenOptions::new().read(true).write(true).create(true).truncate(false).open(path) {
        Err(error) if error.kind() == io::ErrorKind::PermissionDenied => {
            File::open(path).map_err(|_| error)
        }
        opened => opened,
    }
}

impl Drop for Lock {
    fn drop(&mut self) {
        // while it is still locked, so that nobody else's is removed
        let _ = fs::remove_file(&self.path);
    }
}

/// Whether the file system has no locks at all, or none left (`ENOLCK`, as NFS without its lock
/// service).
fn knows_no_locks(error: &io::Error) -> bool {
    const NO_LOCKS: i32 = 37;
    error.kind() == io::ErrorKind::Unsupported
        || cfg!(target_os = "linux") && error.raw_os_error() == Some(NO_LOCKS)
}

fn is_at(file: &File, path: &Path) -> bool {
    file.metadata().is_ok_and(|found| is_same(&found, &fs::metadata(path).ok()))
}

/// Whether both are of one file.
#[cfg(unix)]
fn is_same(a: &fs::Metadata, b: &Option<fs::Metadata>) -> bool {
    use std::os::unix::fs::MetadataExt;
    b.as_ref().is_some_and(|b| (a.dev(), a.ino()) == (b.dev(), b.ino()))
}

#[cfg(not(unix))]
fn is_same(_: &fs::Metadata, b: &Option<fs::Metadata>) -> bool {
    b.is_some()
}

/// Removes unfinished files of `target`, whose lock is held.
fn remove_leftovers(target: &Path) {
    let start = format!("{PREFIX}{}-", hash(target));
    let folder = folder(target);
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        if entry.file_name().to_str().is_some_and(|name| name.starts_with(&start)) {
            let _ = fs::remove_file(entry.path());
        }
    }
}

fn place(file: &Path) -> io::Result<Target> {
    if is_output(file) {
        return Ok(Target::Output);
    }
    let mut found = match fs::metadata(file) {
        Ok(found) => found,
        Err(error) if error.kind() == io::ErrorKind::NotFound => {
            return Ok(Target::Free(target(file)?));
        }
        Err(error) => return Err(error),
    };
    if found.is_dir() {
        return Err(io::Error::new(io::ErrorKind::IsADirectory, "this is a folder"));
    }
    if found.permissions().readonly() {
        return Err(io::Error::new(io::ErrorKind::PermissionDenied, "the file is read-only"));
    }
    if !found.is_file() {
        return Ok(Target::Special(file.to_owned()));
    }
    // whether this user may, the system knows best
    OpenOptions::new().write(true).open(file)?;
    let target = target(file)?;
    // the links of /proc/self/fd also lead to pipes and to files that have no name any more; another
    // program may replace the file between the two looks
    for _ in 0..LOOKS {
        if is_same(&found, &fs::metadata(&target).ok()) {
            return Ok(Target::Taken(target, found));
        }
        found = fs::metadata(file)?;
    }
    Ok(Target::Special(file.to_owned()))
}

/// Whether a name leads by links to standard output. That may be a file which a shell has opened
/// for several programs: only by the open file itself does each write after the one before.
fn is_output(file: &Path) -> bool {
    let is = |path: &Path| cfg!(unix) && OUTPUT.iter().any(|name| path == Path::new(name));
    let link = |path: &PathBuf| Some(folder(path).join(fs::read_link(path).ok()?));
    std::iter::successors(Some(file.to_owned()), link).take(LINKS as usize).any(|path| is(&path))
}

/// The file that a name stands for, links followed as far as there are any.
fn target(file: &Path) -> io::Result<PathBuf> {
    let mut target = file.to_owned();
    for _ in 0..LINKS {
        match fs::read_link(&target) {
            Ok(link) => target = folder(&target).join(link),
            // no link, or nothing there
            Err(_) => return Ok(target),
        }
    }
    Err(io::Error::other("too many links"))
}

fn folder(file: &Path) -> PathBuf {
    match file.parent() {
        Some(folder) if folder != Path::new("") => folder.to_owned(),
        _ => PathBuf::from("."),
    }
}

/// A new file beside `target`, of this writer alone. Another process may have the same number (in
/// another container, on another machine), and one that was killed may have left its file: such
/// names are passed over.
fn unfinished(target: &Path) -> io::Result<(PathBuf, File)> {
    static COUNT: AtomicU64 = AtomicU64::new(0);
    loop {
        let count = COUNT.fetch_add(1, Ordering::Relaxed);
        let name = format!("{PREFIX}{}-{:x}-{count:x}", hash(target), std::process::id());
        let path = target.with_file_name(name);
        match File::create_new(&path) {
            Ok(file) => return Ok((path, file)),
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {}
            Err(error) => return Err(error),
        }
    }
}

/// Tells names in one folder apart.
fn hash(target: &Path) -> String {
    let name = target.file_name().unwrap_or_default();
    format!("{:08x}", xxh3_64(name.as_encoded_bytes()) as u32)
}

/// Gives `file` the mode of what it replaces, and its owner as far as this user may.
fn take_over(file: &File, before: &fs::Metadata) -> io::Result<()> {
    #[cfg(unix)]
    {
        use std::os::unix::fs::{MetadataExt, fchown};
        let new = file.metadata()?;
        if (new.uid(), new.gid()) != (before.uid(), before.gid()) {
            // only root may give files away; the group alone often may be given
            let _ = fchown(file, Some(before.uid()), Some(before.gid()))
                .or_else(|_| fchown(file, None, Some(before.gid())));
        }
    }
    file.set_permissions(before.permissions())
}

/// Brings a new name to the disk, where folders can be opened.
fn sync_folder(file: &Path) -> io::Result<()> {
    if cfg!(unix) { File::open(folder(file))?.sync_all() } else { Ok(()) }
}

fn not_regular() -> io::Error {
    io::Error::other("this is no regular file but a pipe or a device")
}
