//! Atomic writing and safe reading of files.
//!
//! A regular file is written under a unique temporary name in the same folder and then renamed, so
//! it is either complete or unchanged. Links are followed, mode and owner are kept, and files
//! without write permission are refused, even for root. Pipes and devices are written to directly
//! and never replaced.

use std::fs::{self, File, OpenOptions};
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

use xxhash_rust::xxh3::xxh3_64;

/// Maximum number of links to follow.
const LINKS: u32 = 40;
/// Maximum number of attempts to resolve a name while another program replaces the file.
const LOOKS: u32 = 16;
/// Names of standard output.
const OUTPUT: [&str; 3] = ["/dev/stdout", "/dev/fd/1", "/proc/self/fd/1"];
/// Prefix of temporary files and locks. The rest of their names is short, regardless of the file
/// name.
const PREFIX: &str = ".caustica-";

/// Kind of file at the location of an output.
enum Target {
    /// No file exists.
    Free(PathBuf),
    /// A regular file.
    Taken(PathBuf, fs::Metadata),
    /// A pipe or a device.
    Special(PathBuf),
    /// Standard output of this program.
    Output,
}

/// Purpose of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Purpose {
    /// Result; may also be a pipe or a device.
    Result,
    /// File to be read again; must be a regular file, and is synced to disk.
    Keepsake,
}

/// Checks that `file` can be written, without leaving a file behind.
///
/// # Errors
/// The reason why it cannot be written.
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

/// Writes the output of `fill` to `file` atomically.
///
/// # Errors
/// If the file cannot be written. An existing file is unchanged.
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
    // set the mode first, so that private data is never readable by others
    let written = before
        .map_or(Ok(()), |before| take_over(&out, &before))
        .and_then(|()| fill(&mut out))
        .and_then(|()| if purpose == Purpose::Keepsake { out.sync_all() } else { Ok(()) })
        .and_then(|()| put_in_place(&unfinished, &target))
        .and_then(|()| if purpose == Purpose::Keepsake { sync_folder(&target) } else { Ok(()) });
    written.inspect_err(|_| {
        // the file may not exist; report the first error
        let _ = fs::remove_file(&unfinished);
    })
}

/// Renames `unfinished` to `target`. A mount point, such as a single-file volume of a container,
/// cannot be replaced and is overwritten instead.
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

/// Reads a regular file of at most `most` bytes. Other files may be endless.
///
/// # Errors
/// If the file is not regular, is too large, or cannot be read.
pub fn read(file: &Path, most: u64) -> io::Result<Vec<u8>> {
    // opening a pipe would block until it has a writer
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
        let text = format!("the file has {} bytes, more than the limit of {most}", found.len());
        return Err(io::Error::new(io::ErrorKind::FileTooLarge, text));
    }
    let mut bytes = Vec::new();
    opened.take(found.len()).read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// Reads a regular file as text.
///
/// # Errors
/// As for [`read`], and if the content is not UTF-8.
pub fn read_text(file: &Path, most: u64) -> io::Result<String> {
    String::from_utf8(read(file, most)?)
        .map_err(|error| io::Error::new(io::ErrorKind::InvalidData, error))
}

/// Returns true if two names refer to the same file after following links.
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

/// Returns true if a name refers to an open stream: `-`, standard output or error, or a file
/// descriptor of this process.
pub fn is_stream(file: &Path) -> bool {
    let folders = ["/dev/fd", "/proc/self/fd"];
    let names = ["-", "/dev/stdout", "/dev/stderr"];
    names.iter().any(|name| file == Path::new(name))
        || folders.iter().any(|folder| file.starts_with(folder))
}

/// Advisory lock on a file that a render writes to. Released when the process ends.
#[derive(Debug)]
pub struct Lock {
    path: PathBuf,
    // the lock belongs to the open file
    _file: File,
}

/// Reason why a lock cannot be acquired.
#[derive(Debug)]
pub enum LockError {
    /// Another process holds it, with this ID if known.
    Held(Option<u32>),
    /// The system reported an error.
    Io(io::Error),
}

impl Lock {
    /// Locks `file`, which need not exist, and removes temporary files of killed writers. Returns
    /// `None` if the file system does not support locks.
    ///
    /// # Errors
    /// If another process holds the lock, or the lock file cannot be opened.
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
            // the previous holder may have removed the file between opening and locking
            if !is_at(&opened, &path) {
                continue;
            }
            // the process ID is for messages only
            let _ = opened.set_len(0).and_then(|()| write!(opened, "{}", std::process::id()));
            remove_leftovers(&target);
            return Ok(Some(Self { path, _file: opened }));
        }
    }
}

/// Opens or creates a lock file. If it is another user's and read-only, it can still be locked, but
/// the process ID cannot be written.
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
        // remove the file while it is locked, so that it cannot be another holder's
        let _ = fs::remove_file(&self.path);
    }
}

/// Returns true if the file system does not support locks or has none left (`ENOLCK`, e.g. NFS
/// without its lock service).
fn knows_no_locks(error: &io::Error) -> bool {
    const NO_LOCKS: i32 = 37;
    error.kind() == io::ErrorKind::Unsupported
        || cfg!(target_os = "linux") && error.raw_os_error() == Some(NO_LOCKS)
}

fn is_at(file: &File, path: &Path) -> bool {
    file.metadata().is_ok_and(|found| is_same(&found, &fs::metadata(path).ok()))
}

/// Returns true if both belong to the same file.
#[cfg(unix)]
fn is_same(a: &fs::Metadata, b: &Option<fs::Metadata>) -> bool {
    use std::os::unix::fs::MetadataExt;
    b.as_ref().is_some_and(|b| (a.dev(), a.ino()) == (b.dev(), b.ino()))
}

#[cfg(not(unix))]
fn is_same(_: &fs::Metadata, b: &Option<fs::Metadata>) -> bool {
    b.is_some()
}

/// Removes temporary files of `target`, whose lock is held.
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
        return Err(io::Error::new(io::ErrorKind::IsADirectory, "is a folder"));
    }
    if found.permissions().readonly() {
        return Err(io::Error::new(io::ErrorKind::PermissionDenied, "the file is read-only"));
    }
    if !found.is_file() {
        return Ok(Target::Special(file.to_owned()));
    }
    // let the system check the permissions of this user
    OpenOptions::new().write(true).open(file)?;
    let target = target(file)?;
    // links in /proc/self/fd may also lead to pipes and deleted files, and another program may
    // replace the file between the two calls
    for _ in 0..LOOKS {
        if is_same(&found, &fs::metadata(&target).ok()) {
            return Ok(Target::Taken(target, found));
        }
        found = fs::metadata(file)?;
    }
    Ok(Target::Special(file.to_owned()))
}

/// Returns true if a name leads to standard output via links. A shell may have opened that file for
/// several programs, whose outputs follow each other only if all use the open file.
fn is_output(file: &Path) -> bool {
    let is = |path: &Path| cfg!(unix) && OUTPUT.iter().any(|name| path == Path::new(name));
    let link = |path: &PathBuf| Some(folder(path).join(fs::read_link(path).ok()?));
    std::iter::successors(Some(file.to_owned()), link).take(LINKS as usize).any(|path| is(&path))
}

/// Resolves a name by following links.
fn target(file: &Path) -> io::Result<PathBuf> {
    let mut target = file.to_owned();
    for _ in 0..LINKS {
        match fs::read_link(&target) {
            Ok(link) => target = folder(&target).join(link),
            // not a link, or no file
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

/// Creates a unique temporary file next to `target`. Skips names that exist, since another process
/// may have the same ID (in another container or on another machine), or a killed one may have left
/// its file.
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

/// Short hash that distinguishes files in one folder.
fn hash(target: &Path) -> String {
    let name = target.file_name().unwrap_or_default();
    format!("{:08x}", xxh3_64(name.as_encoded_bytes()) as u32)
}

/// Sets the mode of `file` to that of the file it replaces, and the owner if permitted.
fn take_over(file: &File, before: &fs::Metadata) -> io::Result<()> {
    #[cfg(unix)]
    {
        use std::os::unix::fs::{MetadataExt, fchown};
        let new = file.metadata()?;
        if (new.uid(), new.gid()) != (before.uid(), before.gid()) {
            // only root can change the owner, but users can often change the group
            let _ = fchown(file, Some(before.uid()), Some(before.gid()))
                .or_else(|_| fchown(file, None, Some(before.gid())));
        }
    }
    file.set_permissions(before.permissions())
}

/// Syncs a new directory entry to disk, on systems where folders can be opened.
fn sync_folder(file: &Path) -> io::Result<()> {
    if cfg!(unix) { File::open(folder(file))?.sync_all() } else { Ok(()) }
}

fn not_regular() -> io::Error {
    io::Error::other("not a regular file, but a pipe or a device")
}
