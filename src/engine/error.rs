//! Errors shared by the f32 and the f64 compilation of the CPU engine.

use crate::accel::profile::ProfileError;

/// Reason why a valid scene cannot be packed.
#[derive(Debug, thiserror::Error)]
pub enum PackError {
    /// More items than an index can represent.
    #[error("the scene has {count} {what}, more than the limit of {limit}")]
    TooMany {
        /// Plural name of the items.
        what: &'static str,
        /// Number of items.
        count: usize,
        /// Maximum number.
        limit: usize,
    },
    /// A group contains a plane or another instance.
    #[error("shape {shape}: a group cannot contain infinite planes or other instances")]
    Group {
        /// Index of the shape that places the group.
        shape: usize,
    },
    /// A profile does not describe a valid surface.
    #[error("shape {shape}: {cause}")]
    Profile {
        /// Index of the shape.
        shape: usize,
        /// Problem of the profile.
        cause: ProfileError,
    },
}
