//! Errors of what is compiled for f32 and for f64.

use crate::accel::profile::ProfileError;

/// Why a valid scene cannot be flattened.
#[derive(Debug, thiserror::Error)]
pub enum PackError {
    /// More items than an index holds.
    #[error("the scene has {count} {what}, more than the limit of {limit}")]
    TooMany {
        /// What there are too many of.
        what: &'static str,
        /// How many.
        count: usize,
        /// How many there may be.
        limit: usize,
    },
    /// A profile that is no surface.
    #[error("shape {shape}: {cause}")]
    Profile {
        /// Index of the shape.
        shape: usize,
        /// What is wrong.
        cause: ProfileError,
    },
}
