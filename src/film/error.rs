//! What can go wrong with picture files: which file, what happened, and how to mend it.

use std::io;
use std::path::PathBuf;

use miette::Diagnostic;
use thiserror::Error;

/// A picture file that cannot be written or read.
#[derive(Debug, Error, Diagnostic)]
pub enum FileError {
    /// The name's extension is none that is known for this use.
    #[error("{}: {what}", file.display())]
    #[diagnostic(help("end the name in {known}"))]
    UnknownFormat {
        /// The file.
        file: PathBuf,
        /// What is wrong with its name.
        what: String,
        /// The extensions that would do.
        known: &'static str,
    },
    /// A name of an open file, such as standard output, which does not say which kind of picture to
    /// write.
    #[error("{}: the name of a stream does not say which kind of picture to write", file.display())]
    #[diagnostic(help(
        "name a link that ends in {known}: ln -s /dev/stdout picture.png, then -o picture.png; results are \
         printed after the picture"
    ))]
    StreamName {
        /// The name.
        file: PathBuf,
        /// The extensions that would do.
        known: &'static str,
    },
    /// The folder that the file should go to does not exist.
    #[error("{}: there is no folder `{}`", file.display(), folder.display())]
    #[diagnostic(help("create the folder first, or choose another one"))]
    NoFolder {
        /// The file.
        file: PathBuf,
        /// Its folder.
        folder: PathBuf,
    },
    /// The name is that of a folder.
    #[error("{}: this is a folder", file.display())]
    #[diagnostic(help("give the name of a file in it"))]
    IsFolder {
        /// The folder.
        file: PathBuf,
    },
    /// The same output is named more than once.
    #[error("{}: named as an output more than once", file.display())]
    #[diagnostic(help("name every output once"))]
    Repeated {
        /// The file.
        file: PathBuf,
    },
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
    /// The file's content is not a picture of its format.
    #[error("{}: not a usable picture: {what}", file.display())]
    #[diagnostic(help("the file may be damaged or of another format than its name says"))]
    Malformed {
        /// The file.
        file: PathBuf,
        /// The first thing that is wrong with it.
        what: String,
    },
    /// Some of its pixels are not opaque.
    #[error("{}: {pixels} pixels are not opaque, the first in column {}, row {}", file.display(), at.0, at.1)]
    #[diagnostic(help(
        "lay it over a background first: what is seen behind it is not in the file"
    ))]
    Transparent {
        /// The file.
        file: PathBuf,
        /// How many.
        pixels: usize,
        /// Column and row of the first in reading order.
        at: (u32, u32),
    },
    /// The picture cannot be expressed in the format.
    #[error("{}: cannot be encoded: {what}", file.display())]
    #[diagnostic(help("try another format, such as .exr"))]
    Encode {
        /// The file.
        file: PathBuf,
        /// What the encoder says.
        what: String,
    },
}
