//! Reports on the work: its stages with their seconds, seconds by kernel, and the progress of
//! shader compilation.

pub mod clock;
pub mod compilation;
pub mod stage;
