//! The kernels of a pass, each the twin of `shaders/kernels/` file of the same stem: a function of
//! the invocation's number and of what the kernel reads, returning what it writes.

use super::{camera, geometry, lights, materials, math, real, shapes, tables};

pub mod aov_trace;
pub mod bytes;
pub mod direct;
pub mod eye_path;
pub mod eye_sample;
pub mod eye_trace;
pub mod gather;
pub mod grid;
pub mod grid_build;
pub mod path_trace;
pub mod photon_trace;
pub mod records;
pub mod resolve;
pub mod resolve_parts;
