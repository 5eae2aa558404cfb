//! The beginning of a scene file.

/// A camera in front of the origin, and nothing else.
pub const HEAD: &str =
    "version = 1\n[camera]\nposition = [0, 1, 4]\ntarget = [0, 1, 0]\nfov = 39\n";
