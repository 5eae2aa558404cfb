//! Errors of checkpoints.

use std::io;
use std::path::PathBuf;

use miette::Diagnostic;
use thiserror::Error;

/// A checkpoint that cannot be written, read or used.
#[derive(Debug, Error, Diagnostic)]
pub enum CheckpointError {
    /// The operating system reported an error.
    #[error("{}: cannot be {verb}: {cause}", file.display())]
    #[diagnostic(help("check the name, the permissions and the free space"))]
    Io {
        /// The file.
        file: PathBuf,
        /// "written" or "read".
        verb: &'static str,
        /// The system's error.
        cause: io::Error,
    },
    /// The file is not a checkpoint.
    #[error("{}: not a checkpoint: {what}", file.display())]
    #[diagnostic(help(
        "give a file written by `caustica render --checkpoint` or `caustica merge`"
    ))]
    NotOne {
        /// The file.
        file: PathBuf,
        /// Reason.
        what: String,
    },
    /// The format version is not supported.
    #[error(
        "{}: expected a checkpoint of format {expected}, found one of format {found}",
        file.display()
    )]
    #[diagnostic(help("use the version of caustica that wrote it, or render again"))]
    Format {
        /// The file.
        file: PathBuf,
        /// Supported format version.
        expected: u32,
        /// Format version of the file.
        found: u32,
    },
    /// The file is truncated or has extra bytes.
    #[error("{}: the checkpoint should have {expected} bytes, but has {found}", file.display())]
    #[diagnostic(help("it was truncated or overwritten; use another copy, or render again"))]
    Length {
        /// The file.
        file: PathBuf,
        /// Length in bytes according to the header.
        expected: u64,
        /// Actual length in bytes.
        found: u64,
    },
    /// The content is corrupt.
    #[error("{}: the checkpoint is damaged: {what}", file.display())]
    #[diagnostic(help("use another copy, or render again"))]
    Damaged {
        /// The file.
        file: PathBuf,
        /// Description of the first problem.
        what: String,
    },
    /// The scene, the version of caustica or a setting differs.
    #[error(
        "{}: the checkpoint belongs to a different render:\n  {}",
        file.display(), differences.join("\n  ")
    )]
    #[diagnostic(help("{mend}"))]
    Other {
        /// The file.
        file: PathBuf,
        /// Differences, each with the expected and the found value.
        differences: Vec<String>,
        /// Suggested remedy.
        mend: String,
    },
    /// The file cannot be used in this way.
    #[error("{}: {what}", file.display())]
    #[diagnostic(help("{mend}"))]
    Unfit {
        /// The file.
        file: PathBuf,
        /// Reason.
        what: String,
        /// Suggested remedy.
        mend: String,
    },
}
