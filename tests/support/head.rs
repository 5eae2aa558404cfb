//! Where a scene file begins.

/// A camera before the origin, and no more.
pub const HEAD: &str =
    "version = 1\n[camera]\nposition = [0, 1, 4]\ntarget = [0, 1, 0]\nfov = 39\n";
