//! Reasons why an image cannot be used.

use std::path::Path;

use crate::scene::limits::Refusal;

/// Reason why an image cannot be used; `key` is the scene file key that the error points to.
pub(crate) struct ImageFault {
    pub key: &'static str,
    pub message: String,
    pub expected: &'static str,
    pub help: Option<String>,
    /// True if the file does not exist.
    pub missing: bool,
}

const EXPECTED: &str = "expected a png, jpg, hdr or exr file";

pub(super) fn fault(path: &Path, why: impl std::fmt::Display) -> ImageFault {
    ImageFault {
        key: "file",
        message: format!("cannot read image {}: {why}", path.display()),
        expected: EXPECTED,
        help: None,
        missing: false,
    }
}

pub(super) fn refused(path: &Path, refusal: Refusal) -> ImageFault {
    ImageFault { help: refusal.help(), missing: refusal.is_missing(), ..fault(path, refusal) }
}
