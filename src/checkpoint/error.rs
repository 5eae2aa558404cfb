//! What can be wrong with a checkpoint: which file, what, and how to mend it.

use std::io;
use std::path::PathBuf;

use miette::Diagnostic;
use thiserror::Error;

/// A checkpoint that cannot be written, read or used.
#[derive(Debug, Error, Diagnostic)]
pub enum CheckpointError {
    /// The operating system refused.
    #[error("{}: cannot be {verb}: {cause}", file.display())]
    #[diagnostic(help("check the name, the permissions and the free space"))]
    Io {
        /// The file.
        file: PathBuf,
        /// "written" or "read".
        verb: &'static str,
        /// What the system says.
        cause: io::Error,
    },
    /// It is something else.
    #[error("{}: this is no checkpoint: {what}", file.display())]
    #[diagnostic(help(
        "name a file that `caustica render --checkpoint` or `caustica merge` wrote"
    ))]
    NotOne {
        /// The file.
        file: PathBuf,
        /// What shows it.
        what: String,
    },
    /// It is written in another way.
    #[error("{}: expected a checkpoint of format {expected}, found one of format {found}", file.display())]
    #[diagnostic(help("use the version of caustica that wrote it, or render anew"))]
    Format {
        /// The file.
        file: PathBuf,
        /// The format that this program knows.
        expected: u32,
        /// That of the file.
        found: u32,
    },
    /// Its end is missing, or there is more than its end.
    #[error("{}: the checkpoint should have {expected} bytes, but has {found}", file.display())]
    #[diagnostic(help("it was cut off or written over; take another copy, or render anew"))]
    Length {
        /// The file.
        file: PathBuf,
        /// What it says itself.
        expected: u64,
        /// What there are.
        found: u64,
    },
    /// Its bytes are not those that were written.
    #[error("{}: the checkpoint is damaged: {what}", file.display())]
    #[diagnostic(help("take another copy, or render anew"))]
    Damaged {
        /// The file.
        file: PathBuf,
        /// What shows it.
        what: String,
    },
    /// It is of another scene, version or setting.
    #[error("{}: the checkpoint is of another render:\n  {}", file.display(), differences.join("\n  "))]
    #[diagnostic(help("{mend}"))]
    Other {
        /// The file.
        file: PathBuf,
        /// Each difference with what is expected and what is found.
        differences: Vec<String>,
        /// What to do.
        mend: String,
    },
    /// It cannot be used so.
    #[error("{}: {what}", file.display())]
    #[diagnostic(help("{mend}"))]
    Unfit {
        /// The file.
        file: PathBuf,
        /// Why not.
        what: String,
        /// What to do.
        mend: String,
    },
}
