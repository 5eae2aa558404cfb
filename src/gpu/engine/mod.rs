//! GPU engine: renders one scene on a GPU or a software driver.

mod execute;
mod setup;
mod state;

use super::context::{AdapterSummary, Gpu};
use super::layout::Member;
use super::pace::Pace;
use super::program::Program;
use super::recorder::Recorder;
use crate::engine::{Engine, EngineError, PassReport, State};
use crate::film::exr_file::Channel;
use crate::film::{ErrorMap, Picture, Rejections};
use crate::plan::{Buffer, Kernel, Plan};
use crate::tables::SceneTables;
use crate::telemetry::clock::{Clock, KernelSeconds};
use std::collections::BTreeMap;

pub use setup::{CompileSeconds, sizes};

/// Size of `counters` in bytes: records of the batch, the pass's rays in two words, invocations
/// that the driver stopped, photons by how their paths ended, and one unused word.
const COUNTERS_BYTES: u64 = 32;
/// Size of the readings of a pass in bytes without the records of batches: the counters, and the
/// two words of eye rays. One word per batch follows.
const READINGS_BYTES: u64 = COUNTERS_BYTES + 8;
/// Index of the word that counts the invocations stopped by the driver.
const STOPPED_COUNT: usize = 3;
/// Index of the first word that counts photons by how their paths ended.
const ENDS: usize = 4;

/// Engine that renders one scene on a GPU or a software driver.
pub struct GpuEngine {
    gpu: Gpu,
    plan: Plan,
    passes_done: u32,
    /// True if a pass has begun to be added to the film but is not complete.
    partial: bool,
    recorder: Recorder,
    pace: Pace,
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
    /// Scene for retracing stopped paths, on a software driver only.
    scene: Option<SceneTables>,
    device: String,
    compile_seconds: BTreeMap<Kernel, CompileSeconds>,
    submissions: Submissions,
    /// Seconds of each kernel in the current pass, if requested.
    clock: Clock,
    /// True if the times come from the device's clock rather than from waiting for each kernel.
    stamped: bool,
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

impl GpuEngine {
    /// Compile time of each kernel, if the engine was created by [`measured`](Self::measured).
    pub fn compile_seconds(&self) -> &BTreeMap<Kernel, CompileSeconds> {
        &self.compile_seconds
    }

    /// Makes the driver lose the device, as in a reset; for tests.
    pub fn lose(&self) {
        self.gpu.lose();
    }

    /// Adapter that the engine runs on.
    pub fn adapter(&self) -> &AdapterSummary {
        &self.gpu.summary
    }

    /// Sets the target duration of a submission in seconds; with infinity, passes are not split for
    /// time.
    pub fn set_slice(&mut self, seconds: f64) {
        self.pace.set_slice(seconds);
    }

    /// Returns the statistics since the last call and resets them.
    pub fn take_submissions(&mut self) -> Submissions {
        std::mem::take(&mut self.submissions)
    }

    /// Returns true if [`Engine::timed_pass`] reads the device's clock. Otherwise it waits for each
    /// kernel, and the times include the communication with the device.
    pub fn has_clock(&self) -> bool {
        self.gpu.has_clock()
    }
}

impl Engine for GpuEngine {
    fn device(&self) -> &str {
        &self.device
    }

    fn pass(&mut self) -> Result<PassReport, EngineError> {
        let mut batch = self.plan.batch_photons;
        loop {
            match self.execute(batch)? {
                Some(report) => {
                    self.passes_done += 1;
                    return Ok(report);
                }
                // discard the pass and run it again with batches half as large, which also shortens
                // the loops over photons
                None => batch = (batch / 2).max(1),
            }
        }
    }

    fn timed_pass(&mut self) -> Result<(PassReport, KernelSeconds), EngineError> {
        self.stamped = self.recorder.stamp(&self.gpu, true)?;
        self.clock.enable();
        let report = self.pass();
        let seconds = self.clock.take();
        self.stamped = self.recorder.stamp(&self.gpu, false)?;
        Ok((report?, seconds))
    }

    fn picture(&mut self) -> Result<Picture, EngineError> {
        Ok(self.plan.picture(&self.film()?))
    }

    fn errors(&mut self) -> Result<ErrorMap, EngineError> {
        Ok(self.plan.errors(&self.film()?, self.passes_done))
    }

    fn rejections(&mut self) -> Result<Rejections, EngineError> {
        Ok(self.plan.rejections(&self.film()?))
    }

    fn results(&mut self) -> Result<(Picture, Rejections), EngineError> {
        let film = self.film()?;
        Ok((self.plan.picture(&film), self.plan.rejections(&film)))
    }

    fn save(&mut self) -> Result<State, EngineError> {
        self.state()
    }

    fn restore(&mut self, state: &State) -> Result<(), EngineError> {
        self.take_over(state)
    }

    fn layers(&mut self) -> Result<Vec<Channel>, EngineError> {
        self.with_found(|plan, found| plan.layers(found))
    }

    fn gathered(&mut self) -> Result<u64, EngineError> {
        if self.plan.is_reused(Buffer::Gathered) {
            return Err(EngineError::Unsupported(
                "what tiles have gathered is not kept".to_owned(),
            ));
        }
        Ok(self.gathered_points()?.iter().map(|gathered| u64::from(gathered.count)).sum())
    }
}
