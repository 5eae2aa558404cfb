//! Setup of an executor: allocates its buffers and compiles its kernels.

use super::super::context::Gpu;
use super::super::layout::{SceneLayout, long_tables};
use super::super::pace::Pace;
use super::super::program::{Compiling, Program, make_programs};
use super::super::recorder::Recorder;
use super::{Executor, READINGS_BYTES, Submissions};
use crate::engine::EngineError;
use crate::kernels::records::Dispatch;
use crate::pack::PackedScene;
use crate::plan::{Buffer, Kernel, Plan};
use crate::tables::SceneTables;
use crate::telemetry::clock::Clock;
use crate::telemetry::compilation::Running;
use crate::telemetry::stage::stage;
use std::collections::BTreeMap;
use std::time::Instant;

/// Remedy if the device is too small.
const MEND: &str = "make the picture smaller, or take --device cpu";

/// Parts that an engine takes over from a previous one.
struct Reusable {
    gpu: Gpu,
    pace: Pace,
    programs: BTreeMap<Kernel, Program>,
}

/// Time that it took to compile a kernel, seconds.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CompileSeconds {
    /// Time to compose and validate its shader and pass it to the driver.
    pub checking: f64,
    /// Time of the driver until the kernel had run over nothing.
    pub driver: f64,
}

impl CompileSeconds {
    /// Sum of both.
    pub fn total(&self) -> f64 {
        self.checking + self.driver
    }
}

impl Executor {
    /// Allocates the buffers and compiles the kernels of `plan` on an opened device.
    pub(in super::super) fn new(
        gpu: Gpu,
        packed: &PackedScene,
        plan: Plan,
        compiling: Compiling,
    ) -> Result<Self, EngineError> {
        let kept = Reusable { gpu, pace: Pace::default(), programs: BTreeMap::new() };
        Self::on(kept, packed, plan, compiling)
    }

    /// Creates an executor for another scene, camera or plan on the same device. Keeps the compiled
    /// programs if the new ones would be identical.
    pub(in super::super) fn renewed(
        self,
        packed: &PackedScene,
        plan: Plan,
    ) -> Result<Self, EngineError> {
        let tables = SceneLayout::new(&packed.tables);
        let same = self.plan.features == plan.features
            && (&self.members, &self.few) == (&tables.members, &tables.few);
        Self::on(self.kept(same), packed, plan, Compiling::Together)
    }

    /// Frees the buffers and returns the parts that another engine can take over.
    fn kept(self, programs_too: bool) -> Reusable {
        let programs = if programs_too { self.programs } else { BTreeMap::new() };
        Reusable { gpu: self.gpu, pace: self.pace, programs }
    }

    fn on(
        kept: Reusable,
        packed: &PackedScene,
        plan: Plan,
        compiling: Compiling,
    ) -> Result<Self, EngineError> {
        let Reusable { gpu, pace, programs } = kept;
        let scene = SceneLayout::new(&packed.tables);
        gpu.check_sizes(&sizes(&plan, &packed.tables), MEND)?;
        let recorder = Recorder::new(&gpu)?;
        let mut shared = BTreeMap::from([(Buffer::Scene, gpu.upload("scene", &scene.bytes)?)]);
        for (buffer, content) in long_tables(&packed.tables) {
            if !content.is_empty() {
                shared.insert(buffer, gpu.upload(buffer.name(), content)?);
            }
        }
        let mut chunks = vec![BTreeMap::new(); plan.chunks() as usize];
        for (buffer, bytes) in plan.buffers() {
            let name = buffer.name();
            if plan.is_per_chunk(buffer) {
                for (chunk, buffers) in (0..).zip(&mut chunks) {
                    buffers.insert(buffer, gpu.storage(name, chunk_bytes(&plan, bytes, chunk))?);
                }
            } else {
                shared.insert(buffer, gpu.storage(name, bytes)?);
            }
        }
        let readings = gpu.storage("readings", READINGS_BYTES)?;
        let mut executor = Self {
            device: gpu.summary.name.clone(),
            gpu,
            passes_done: 0,
            partial: false,
            recorder,
            pace,
            programs: BTreeMap::new(),
            members: scene.members.clone(),
            few: scene.few.clone(),
            groups: BTreeMap::new(),
            shared,
            chunks,
            readings,
            plan,
            compile_seconds: BTreeMap::new(),
            submissions: Submissions::default(),
            clock: Clock::default(),
            stamped: false,
        };
        executor.compile(&scene, compiling, programs)?;
        Ok(executor)
    }

    /// Compiles the kernels of the plan, except those in `kept`. Each new kernel runs once over
    /// nothing, since some drivers compile at the first run; they do so while the next kernels are
    /// validated.
    fn compile(
        &mut self,
        scene: &SceneLayout,
        compiling: Compiling,
        kept: BTreeMap<Kernel, Program>,
    ) -> Result<(), EngineError> {
        let _stage = stage("compile");
        let used = self.plan.kernels();
        let needed = |kernel: &Kernel| used.iter().any(|(other, _)| other == kernel);
        let missing: Vec<Kernel> =
            Kernel::ALL.into_iter().filter(|k| needed(k) && !kept.contains_key(k)).collect();
        let Self { gpu, plan, recorder, programs, groups, shared, chunks, compile_seconds, .. } =
            self;
        let device = gpu.summary.name.clone();
        let first = missing.first().map(|kernel| kernel.stem());
        let mut running = Running::new(&device, first, missing.len());
        let mut take = |program: Program, checking: Option<f64>| {
            let begun = Instant::now();
            for (number, own) in (0..).zip(chunks.iter()) {
                if !used.contains(&(program.kernel, number)) {
                    continue;
                }
                let buffer = |buffer| own.get(&buffer).or_else(|| shared.get(&buffer));
                let group = program.bind(gpu, &recorder.dispatches, buffer)?;
                if number == 0 && checking.is_some() {
                    let nothing = Dispatch { first: 0, end: 0, ..plan.dispatch(0) };
                    recorder.dispatch(gpu, &program, &group, &nothing);
                    recorder.submit(gpu);
                }
                groups.insert((program.kernel, number), group);
            }
            // a software driver accepts the next submission only after compiling the previous one
            if checking.is_some() {
                running.begin(program.kernel.stem());
            }
            if let (Compiling::OneByOne, Some(checking)) = (compiling, checking) {
                gpu.wait()?;
                let driver = begun.elapsed().as_secs_f64();
                compile_seconds.insert(program.kernel, CompileSeconds { checking, driver });
            }
            match checking {
                Some(seconds) => {
                    log::debug!("{}: checked in {seconds:.3} s", program.kernel.stem())
                }
                None => log::debug!("{}: kept", program.kernel.stem()),
            }
            programs.insert(program.kernel, program);
            Ok(())
        };
        kept.into_values()
            .filter(|program| needed(&program.kernel))
            .try_for_each(|kept| take(kept, None))?;
        make_programs(gpu, &missing, &plan.features, scene, compiling, |program, checking| {
            take(program, Some(checking))
        })?;
        self.gpu.wait()
    }
}

/// Size of a chunk's buffer, from that of the largest chunk.
fn chunk_bytes(plan: &Plan, largest: u64, chunk: u32) -> u64 {
    largest * plan.chunk(chunk).1 as u64 / plan.chunk(0).1.max(1) as u64
}

/// Name and bytes of every buffer that will be allocated.
pub fn sizes(plan: &Plan, scene: &SceneTables) -> Vec<(&'static str, u64)> {
    let mut list = vec![("scene", SceneLayout::new(scene).bytes.len() as u64)];
    list.extend(long_tables(scene).map(|(buffer, content)| (buffer.name(), content.len() as u64)));
    for (buffer, bytes) in plan.buffers() {
        let name = buffer.name();
        if plan.is_per_chunk(buffer) {
            list.extend((0..plan.chunks()).map(|chunk| (name, chunk_bytes(plan, bytes, chunk))));
        } else {
            list.push((name, bytes));
        }
    }
    list
}
