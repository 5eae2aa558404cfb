//! Executes the commands of passes on a GPU or a software driver.

pub mod execute;
mod setup;
mod state;

use super::context::Gpu;
use super::layout::Member;
use super::pace::Pace;
use super::program::Program;
use super::recorder::Recorder;
use crate::plan::{Buffer, Kernel, Plan};
use crate::telemetry::clock::Clock;
use std::collections::BTreeMap;

pub use setup::{CompileSeconds, sizes};

/// Size of `counters` in bytes: records of the batch, the pass's rays in two words, invocations
/// that the driver stopped, photons by how their paths ended, and one unused word.
const COUNTERS_BYTES: u64 = 32;
/// Size of the readings of a pass in bytes without the records of batches: the counters, and the
/// two words of eye rays. One word per batch follows.
const READINGS_BYTES: u64 = COUNTERS_BYTES + 8;
/// Index of the word that counts the invocations stopped by the driver.
pub const STOPPED_COUNT: usize = 3;
/// Index of the first word that counts photons by how their paths ended.
pub const ENDS: usize = 4;

/// Buffers, kernels and state of a render on one device.
pub struct Executor {
    /// Device and queue.
    pub gpu: Gpu,
    /// Plan of the passes.
    pub plan: Plan,
    /// Number of completed passes.
    pub passes_done: u32,
    /// True if a pass has begun to be added to the film but is not complete.
    partial: bool,
    pub(super) recorder: Recorder,
    pub(super) pace: Pace,
    programs: BTreeMap<Kernel, Program>,
    /// Members of the struct in which the programs read the scene's short tables.
    members: Vec<Member>,
    /// References of the shapes that the programs test one after another.
    few: Vec<u32>,
    /// Bind groups by kernel and chunk (chunk 0 if the kernel has none).
    groups: BTreeMap<(Kernel, u32), wgpu::BindGroup>,
    shared: BTreeMap<Buffer, wgpu::Buffer>,
    chunks: Vec<BTreeMap<Buffer, wgpu::Buffer>>,
    /// Copies of the pass's counters and of each batch's record count.
    readings: wgpu::Buffer,
    pub(super) device: String,
    pub(super) compile_seconds: BTreeMap<Kernel, CompileSeconds>,
    pub(super) submissions: Submissions,
    /// Seconds of each kernel in the current pass, if requested.
    pub(super) clock: Clock,
    /// True if the times come from the device's clock rather than from waiting for each kernel.
    pub(super) stamped: bool,
}

/// Statistics of submissions to the device.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Submissions {
    /// Number of submissions.
    pub count: u64,
    /// Seconds from the start of the longest submission to its completion.
    pub longest_seconds: f64,
    /// Kernels in the longest submission.
    pub longest: Vec<Kernel>,
}
