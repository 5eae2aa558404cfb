//! Kernels of a pass, twins of the files of the same stem in `shaders/kernels/`. A kernel is a
//! function of the invocation's index and of the data it reads, and returns what it writes.

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
