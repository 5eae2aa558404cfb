//! GPU engine: executes a plan with wgpu. The only module that uses wgpu or naga.

pub mod compose;
pub mod context;
mod dispatch;
mod engine;
mod executor;
pub mod fragments;
pub mod layout;
mod memory;
pub mod pace;
pub mod program;
pub mod recorder;
mod retrace;
mod stamps;
mod visible;

pub use context::{AdapterChoice, AdapterKind, AdapterSummary, Gpu, list};
pub use engine::GpuEngine;
pub use executor::{CompileSeconds, Submissions, sizes};
pub use visible::{Hidden, hidden};
