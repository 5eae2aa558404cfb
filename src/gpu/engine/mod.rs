//! An engine on a GPU or a software driver: passes over one scene.

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
use crate::tables::Scene;
use crate::telemetry::clock::{Clock, KernelSeconds};
use std::collections::BTreeMap;

pub use setup::{CompileSeconds, sizes};

/// Bytes of `counters`: records of the batch, the pass's rays in two words, invocations that the
/// driver stopped, photons by how they ended, and one unused.
const COUNTERS_BYTES: u64 = 32;
/// What is read back of a pass: the counters, their two words of rays before the first photon, and
/// each batch's records.
const READINGS_BYTES: u64 = COUNTERS_BYTES + 8;
/// The word of the invocations that the driver stopped.
const STOPPED_COUNT: usize = 3;
/// The first word of the photons' ends.
const ENDS: usize = 4;

/// Passes over one scene on a GPU or a software driver.
pub struct GpuEngine {
    gpu: Gpu,
    plan: Plan,
    passes_done: u32,
    /// Whether a pass ended while it was adding to the film.
    partial: bool,
    recorder: Recorder,
    pace: Pace,
    programs: BTreeMap<Kernel, Program>,
    /// Of the struct that the programs know the scene's short tables by.
    members: Vec<Member>,
    /// Those that the programs test one after another.
    few: Vec<u32>,
    /// By kernel and chunk (0 where it has none).
    groups: BTreeMap<(Kernel, u32), wgpu::BindGroup>,
    shared: BTreeMap<Buffer, wgpu::Buffer>,
    chunks: Vec<BTreeMap<Buffer, wgpu::Buffer>>,
    /// Copies of the pass's counters and of each batch's record count.
    readings: wgpu::Buffer,
    /// On a software driver: what to trace stopped paths again with.
    scene: Option<Scene>,
    device: String,
    compile_seconds: BTreeMap<Kernel, CompileSeconds>,
    submissions: Submissions,
    /// Seconds of each kernel in the pass at hand, where they are asked for.
    clock: Clock,
    /// Whether these come from the device's own clock, not from waiting for each kernel.
    stamped: bool,
}

/// What was handed to the device.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Submissions {
    /// How many.
    pub count: u64,
    /// Seconds from handing over the longest one until it was known to be done.
    pub longest_seconds: f64,
    /// The kernels in that.
    pub longest: Vec<Kernel>,
}

impl GpuEngine {
    /// What each kernel took to be made ready, if this was [measured](Self::measured).
    pub fn compile_seconds(&self) -> &BTreeMap<Kernel, CompileSeconds> {
        &self.compile_seconds
    }

    /// Has the driver take the device away, as it does when it is reset: for tests.
    pub fn lose(&self) {
        self.gpu.lose();
    }

    /// What it runs on.
    pub fn adapter(&self) -> &AdapterSummary {
        &self.gpu.summary
    }

    /// Sets how many seconds a submission is to take; with infinity, no pass is split for its time.
    pub fn set_slice(&mut self, seconds: f64) {
        self.pace.set_slice(seconds);
    }

    /// What was handed to the device since this was last asked for; counting begins anew.
    pub fn take_submissions(&mut self) -> Submissions {
        std::mem::take(&mut self.submissions)
    }

    /// Whether [`Engine::timed_pass`] reads the device's own clock. If not, it waits for each
    /// kernel, and the times hold the way to the device and back.
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
                // thrown away and run again with batches half as large, which also shortens the
                // loops over photons
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
