//! Errors of image files.

use std::io;
use std::path::PathBuf;

use miette::Diagnostic;
use thiserror::Error;

/// An image file that cannot be written or read.
#[derive(Debug, Error, Diagnostic)]
pub enum FileError {
    /// The extension does not name a format that is supported here.
    #[error("{}: {what}", file.display())]
    #[diagnostic(help("use a file name that ends in {known}"))]
    UnknownFormat {
        /// The file.
        file: PathBuf,
        /// Description of the problem with its name.
        what: String,
        /// The supported extensions.
        known: &'static str,
    },
    /// The output is a stream, such as standard output, whose name does not determine a format.
    #[error("{}: the name of a stream does not determine the image format", file.display())]
    #[diagnostic(help(
        "use a link whose name ends in {known}: ln -s /dev/stdout picture.png, then \
         -o picture.png; results are printed after the image"
    ))]
    StreamName {
        /// The name.
        file: PathBuf,
        /// The supported extensions.
        known: &'static str,
    },
    /// The parent folder of the file does not exist.
    #[error("{}: the folder `{}` does not exist", file.display(), folder.display())]
    #[diagnostic(help("create the folder first, or choose another one"))]
    NoFolder {
        /// The file.
        file: PathBuf,
        /// Its parent folder.
        folder: PathBuf,
    },
    /// The name is that of a folder.
    #[error("{}: is a folder", file.display())]
    #[diagnostic(help("give the name of a file in it"))]
    IsFolder {
        /// The folder.
        file: PathBuf,
    },
    /// The same output is given more than once.
    #[error("{}: given more than once as an output", file.display())]
    #[diagnostic(help("give each output once"))]
    Repeated {
        /// The file.
        file: PathBuf,
    },
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
    /// The content is not a valid image of the file's format.
    #[error("{}: not a readable image: {what}", file.display())]
    #[diagnostic(help("the file may be damaged, or its extension may not match its format"))]
    Malformed {
        /// The file.
        file: PathBuf,
        /// Description of the first problem.
        what: String,
    },
    /// Some pixels are not opaque.
    #[error(
        "{}: {pixels} pixels are not opaque, the first in column {}, row {}",
        file.display(), at.0, at.1
    )]
    #[diagnostic(help(
        "composite the image over a background first: the file does not contain what lies behind it"
    ))]
    Transparent {
        /// The file.
        file: PathBuf,
        /// Number of such pixels.
        pixels: usize,
        /// Column and row of the first in reading order.
        at: (u32, u32),
    },
    /// The image cannot be represented in the format.
    #[error("{}: cannot be encoded: {what}", file.display())]
    #[diagnostic(help("try another format, such as .exr"))]
    Encode {
        /// The file.
        file: PathBuf,
        /// The encoder's error message.
        what: String,
    },
}
