//! GPU engine: an [`Executor`] with the repair that its driver needs.

use super::context::{AdapterChoice, AdapterKind, AdapterSummary, Gpu};
use super::executor::execute::Repair;
use super::executor::{CompileSeconds, Executor, Submissions};
use super::program::Compiling;
use super::retrace::{Retracer, Unrepaired};
use crate::engine::{Engine, EngineError, MeasuredEngine, PassReport, State};
use crate::film::exr_file::Channel;
use crate::film::{ErrorMap, Picture, Rejections};
use crate::pack::PackedScene;
use crate::plan::{Buffer, Kernel, Plan};
use crate::scene::settings::Method;
use crate::telemetry::clock::KernelSeconds;
use std::collections::BTreeMap;

/// Engine that renders one scene on a GPU or a software driver.
pub struct GpuEngine {
    executor: Executor,
    repair: Box<dyn Repair + Send>,
}

impl GpuEngine {
    /// Creates an engine for one scene and plan on the adapter of `choice`.
    ///
    /// # Errors
    /// If there is no such adapter, a buffer exceeds its limits, or it cannot run the method.
    pub fn new(
        choice: &AdapterChoice,
        packed: &PackedScene,
        plan: Plan,
    ) -> Result<Self, EngineError> {
        Self::with(choice, packed, plan, Compiling::Together)
    }

    /// Like [`Self::new`], but compiles the kernels one after another, so that
    /// [`Self::compile_seconds`] is available. Slower.
    ///
    /// # Errors
    /// Those of [`Self::new`].
    pub fn measured(
        choice: &AdapterChoice,
        packed: &PackedScene,
        plan: Plan,
    ) -> Result<Self, EngineError> {
        Self::with(choice, packed, plan, Compiling::OneByOne)
    }

    fn with(
        choice: &AdapterChoice,
        packed: &PackedScene,
        plan: Plan,
        compiling: Compiling,
    ) -> Result<Self, EngineError> {
        if plan.settings.method == Method::Path {
            return Err(EngineError::Unsupported(
                "path tracing runs on the CPU alone: take --device cpu".into(),
            ));
        }
        let executor = Executor::new(Gpu::open(choice)?, packed, plan, compiling)?;
        Ok(Self::around(executor, packed))
    }

    /// Creates an engine for another scene, camera or plan on the same device. Keeps the compiled
    /// programs if the new ones would be identical.
    ///
    /// # Errors
    /// Those of [`Self::new`].
    pub fn renewed(self, packed: &PackedScene, plan: Plan) -> Result<Self, EngineError> {
        Ok(Self::around(self.executor.renewed(packed, plan)?, packed))
    }

    fn around(executor: Executor, packed: &PackedScene) -> Self {
        let repair: Box<dyn Repair + Send> = match executor.gpu.summary.kind {
            AdapterKind::Software => Box::new(Retracer { scene: packed.tables.clone() }),
            AdapterKind::Discrete
            | AdapterKind::Integrated
            | AdapterKind::Virtual
            | AdapterKind::Other => Box::new(Unrepaired),
        };
        Self { executor, repair }
    }

    /// Compile time of each kernel, if the engine was created by [`measured`](Self::measured).
    pub fn compile_seconds(&self) -> &BTreeMap<Kernel, CompileSeconds> {
        &self.executor.compile_seconds
    }

    /// Makes the driver lose the device, as in a reset; for tests.
    pub fn lose(&self) {
        self.executor.gpu.lose();
    }

    /// Adapter that the engine runs on.
    pub fn adapter(&self) -> &AdapterSummary {
        &self.executor.gpu.summary
    }

    /// Sets the target duration of a submission in seconds; with infinity, passes are not split for
    /// time.
    pub fn set_slice(&mut self, seconds: f64) {
        self.executor.pace.set_slice(seconds);
    }

    /// Returns the statistics since the last call and resets them.
    pub fn take_submissions(&mut self) -> Submissions {
        std::mem::take(&mut self.executor.submissions)
    }

    /// Returns true if [`MeasuredEngine::timed_pass`] reads the device's clock. Otherwise it waits
    /// for each kernel, and the times include the communication with the device.
    pub fn has_clock(&self) -> bool {
        self.executor.gpu.has_clock()
    }

    /// Contents of a buffer of the plan (of chunk `chunk` if it is per chunk), for tests.
    ///
    /// # Errors
    /// If the device is lost.
    pub fn content(&self, buffer: Buffer, chunk: u32) -> Result<Vec<u8>, EngineError> {
        self.executor.content(buffer, chunk)
    }
}

impl Engine for GpuEngine {
    fn device(&self) -> &str {
        &self.executor.device
    }

    fn pass(&mut self) -> Result<PassReport, EngineError> {
        let mut batch = self.executor.plan.batch_photons;
        loop {
            match self.executor.execute(batch, self.repair.as_ref())? {
                Some(report) => {
                    self.executor.passes_done += 1;
                    return Ok(report);
                }
                // discard the pass and run it again with batches half as large, which also shortens
                // the loops over photons
                None => batch = (batch / 2).max(1),
            }
        }
    }

    fn picture(&mut self) -> Result<Picture, EngineError> {
        Ok(self.executor.plan.picture(&self.executor.film()?))
    }

    fn errors(&mut self) -> Result<ErrorMap, EngineError> {
        Ok(self.executor.plan.errors(&self.executor.film()?, self.executor.passes_done))
    }

    fn rejections(&mut self) -> Result<Rejections, EngineError> {
        Ok(self.executor.plan.rejections(&self.executor.film()?))
    }

    fn results(&mut self) -> Result<(Picture, Rejections), EngineError> {
        let (plan, film) = (&self.executor.plan, self.executor.film()?);
        Ok((plan.picture(&film), plan.rejections(&film)))
    }

    fn can_be_lost(&self) -> bool {
        true
    }

    fn save(&mut self) -> Result<State, EngineError> {
        self.executor.state()
    }

    fn restore(&mut self, state: &State) -> Result<(), EngineError> {
        self.executor.take_over(state)
    }

    fn layers(&mut self) -> Result<Vec<Channel>, EngineError> {
        self.executor.with_found(|plan, found| plan.layers(found))
    }
}

impl MeasuredEngine for GpuEngine {
    fn timed_pass(&mut self) -> Result<(PassReport, KernelSeconds), EngineError> {
        self.executor.measure(true)?;
        let report = self.pass();
        let seconds = self.executor.clock.take();
        self.executor.measure(false)?;
        Ok((report?, seconds))
    }

    fn gathered(&mut self) -> Result<u64, EngineError> {
        if self.executor.plan.is_reused(Buffer::Gathered) {
            return Err(EngineError::Unsupported(
                "what tiles have gathered is not kept".to_owned(),
            ));
        }
        Ok(self.executor.gathered_points()?.iter().map(|gathered| u64::from(gathered.count)).sum())
    }
}
