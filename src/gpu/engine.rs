//! Carries out the steps of a plan, pass by pass.

use super::context::{AdapterChoice, AdapterKind, AdapterSummary, Gpu};
use super::layout::{Member, SceneTables, long_tables};
use super::mend::{mend_aovs, mend_photons, mend_points};
use super::pace::Pace;
use super::program::{Compiling, Program, make_programs, workgroup_items};
use super::recorder::Recorder;
use crate::clock::{Clock, KernelSeconds};
use crate::engine::{Engine, EngineError, LayerState, PassReport, PhotonEnds, State};
use crate::film::exr_file::Channel;
use crate::film::{ErrorMap, Picture, Rejections};
use crate::kernels::bytes::{AOV_BYTES, FILM_BYTES, PARTS_BYTES, STATISTICS_BYTES};
use crate::kernels::records::{Dispatch, FilmPixel, Gathered};
use crate::layers::Found;
use crate::pack::Packed;
use crate::plan::{Kernel, Plan, Step};
use crate::settings::Method;
use crate::stage::stage;
use crate::tables::Scene;
use std::collections::BTreeMap;
use std::time::Instant;

/// Buffers of which each chunk of visible points has its own.
const CHUNK_BUFFERS: [&str; 6] = ["visible_points", "gathered", "film", "statistics", "aovs", "parts"];
/// Bytes of `counters`: records of the batch, the pass's rays in two words, invocations that the driver stopped, photons by
/// how they ended, and one unused.
const COUNTERS_BYTES: u64 = 32;
/// What is read back of a pass: the counters, their two words of rays before the first photon, and each batch's records.
const READINGS_BYTES: u64 = COUNTERS_BYTES + 8;
/// The word of the invocations that the driver stopped.
const STOPPED_COUNT: usize = 3;
/// The first word of the photons' ends.
const ENDS: usize = 4;
/// What to change when the device is too small.
const MEND: &str = "make the picture smaller, or take --device cpu";

/// Passes over one scene on a GPU or a software driver.
pub struct GpuEngine {
    gpu: Gpu,
    plan: Plan,
    passes_done: u32,
    recorder: Recorder,
    pace: Pace,
    programs: BTreeMap<Kernel, Program>,
    /// Of the struct that the programs know the scene's short tables by.
    members: Vec<Member>,
    /// By kernel and chunk (0 where it has none).
    groups: BTreeMap<(Kernel, u32), wgpu::BindGroup>,
    shared: BTreeMap<&'static str, wgpu::Buffer>,
    chunks: Vec<BTreeMap<&'static str, wgpu::Buffer>>,
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

/// What an engine is made of that another may have had before.
struct Kept {
    gpu: Gpu,
    pace: Pace,
    programs: BTreeMap<Kernel, Program>,
}

/// What it took to make a kernel ready.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CompileSeconds {
    /// To put its shader together, check it and hand it to the driver.
    pub checking: f64,
    /// Of the driver, until the kernel had run over nothing.
    pub driver: f64,
}

impl CompileSeconds {
    /// Both.
    pub fn total(&self) -> f64 {
        self.checking + self.driver
    }
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

/// Records of each batch, rays and photons' ends of a pass, and invocations that the driver stopped.
struct Counted {
    records: Vec<u32>,
    rays: u64,
    eye_rays: u64,
    ends: PhotonEnds,
    stopped: u32,
}

impl GpuEngine {
    /// An engine for one scene and plan on the adapter of `choice`.
    pub fn new(choice: &AdapterChoice, packed: &Packed, plan: Plan) -> Result<Self, EngineError> {
        Self::with(choice, packed, plan, Compiling::Together)
    }

    /// The same, more slowly: the kernels are made ready one after another, so that [`Self::compile_seconds`] can tell.
    pub fn measured(choice: &AdapterChoice, packed: &Packed, plan: Plan) -> Result<Self, EngineError> {
        Self::with(choice, packed, plan, Compiling::OneByOne)
    }

    fn with(
        choice: &AdapterChoice,
        packed: &Packed,
        plan: Plan,
        compiling: Compiling,
    ) -> Result<Self, EngineError> {
        if plan.settings.method == Method::Path {
            return Err(EngineError::Unsupported(
                "path tracing runs on the CPU alone: take --device cpu".into(),
            ));
        }
        let kept = Kept { gpu: Gpu::open(choice)?, pace: Pace::default(), programs: BTreeMap::new() };
        Self::on(kept, packed, plan, compiling)
    }

    /// An engine for another scene, camera or plan on the device of this one, which keeps its programs where the new ones
    /// would be the same.
    pub fn renewed(self, packed: &Packed, plan: Plan) -> Result<Self, EngineError> {
        let same =
            self.plan.features == plan.features && self.members == SceneTables::new(&packed.scene).members;
        Self::on(self.kept(same), packed, plan, Compiling::Together)
    }

    /// What another engine can have of this one, whose buffers are given back first.
    fn kept(self, programs_too: bool) -> Kept {
        let programs = if programs_too { self.programs } else { BTreeMap::new() };
        Kept { gpu: self.gpu, pace: self.pace, programs }
    }

    fn on(kept: Kept, packed: &Packed, plan: Plan, compiling: Compiling) -> Result<Self, EngineError> {
        let Kept { gpu, pace, programs } = kept;
        let scene = SceneTables::new(&packed.scene);
        gpu.check_sizes(&sizes(&plan, &packed.scene), MEND)?;
        let recorder = Recorder::new(&gpu)?;
        let mut shared = BTreeMap::from([("scene", gpu.upload("scene", &scene.bytes)?)]);
        for (name, _, content) in long_tables(&packed.scene) {
            if !content.is_empty() {
                shared.insert(name, gpu.upload(name, content)?);
            }
        }
        let mut chunks = vec![BTreeMap::new(); plan.chunks() as usize];
        for (name, bytes) in plan.buffers() {
            if CHUNK_BUFFERS.contains(&name) {
                for (chunk, buffers) in (0..).zip(&mut chunks) {
                    buffers.insert(name, gpu.storage(name, chunk_bytes(&plan, bytes, chunk))?);
                }
            } else {
                shared.insert(name, gpu.storage(name, bytes)?);
            }
        }
        let readings = gpu.storage("readings", READINGS_BYTES)?;
        let mut engine = Self {
            scene: (gpu.summary.kind == AdapterKind::Software).then(|| packed.scene.clone()),
            device: gpu.summary.name.clone(),
            gpu,
            passes_done: 0,
            recorder,
            pace,
            programs: BTreeMap::new(),
            members: scene.members.clone(),
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
        engine.compile(&scene, compiling, programs)?;
        Ok(engine)
    }

    /// The content of a buffer of the plan (a chunk's, if it is one of those), for tests.
    pub fn content(&self, name: &str, chunk: u32) -> Result<Vec<u8>, EngineError> {
        let buffer =
            self.chunks.get(chunk as usize).and_then(|own| own.get(name)).or_else(|| self.shared.get(name));
        buffer.map_or(Ok(Vec::new()), |buffer| self.gpu.read(buffer, buffer.size()))
    }

    /// Makes the kernels of the plan ready, some of which are `kept`. Each other one runs once over nothing, since some drivers
    /// compile at the first run, and do so while the next kernels are checked.
    fn compile(
        &mut self,
        scene: &SceneTables,
        compiling: Compiling,
        kept: BTreeMap<Kernel, Program>,
    ) -> Result<(), EngineError> {
        let _stage = stage("compile");
        let steps = self.plan.steps(0, self.plan.batch_photons);
        let needed = |kernel: &Kernel| steps.iter().any(|step| step.kernel == *kernel);
        let missing: Vec<Kernel> =
            Kernel::ALL.into_iter().filter(|k| needed(k) && !kept.contains_key(k)).collect();
        let Self { gpu, plan, recorder, programs, groups, shared, chunks, compile_seconds, .. } = self;
        let mut take = |program: Program, checking: Option<f64>| {
            let begun = Instant::now();
            for (number, own) in (0..).zip(chunks.iter()) {
                let Some(step) = steps.iter().find(|s| (s.kernel, s.chunk) == (program.kernel, number))
                else {
                    continue;
                };
                let buffer = |name: &str| own.get(name).or_else(|| shared.get(name));
                let group = program.bind(gpu, &recorder.dispatches, buffer)?;
                if number == 0 && checking.is_some() {
                    let nothing = Dispatch { first: 0, end: 0, ..step.dispatch };
                    recorder.dispatch(gpu, &program, &group, &nothing);
                    recorder.submit(gpu);
                }
                groups.insert((program.kernel, number), group);
            }
            if let (Compiling::OneByOne, Some(checking)) = (compiling, checking) {
                gpu.wait()?;
                let driver = begun.elapsed().as_secs_f64();
                compile_seconds.insert(program.kernel, CompileSeconds { checking, driver });
            }
            match checking {
                Some(seconds) => log::debug!("{}: checked in {seconds:.3} s", program.kernel.stem()),
                None => log::debug!("{}: kept", program.kernel.stem()),
            }
            programs.insert(program.kernel, program);
            Ok(())
        };
        kept.into_values().filter(|program| needed(&program.kernel)).try_for_each(|kept| take(kept, None))?;
        make_programs(gpu, &missing, &plan.features, scene, compiling, |program, checking| {
            take(program, Some(checking))
        })?;
        self.gpu.wait()
    }

    /// What each kernel took to be made ready, if this was [measured](Self::measured).
    pub fn compile_seconds(&self) -> &BTreeMap<Kernel, CompileSeconds> {
        &self.compile_seconds
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

    /// Whether [`Engine::timed_pass`] reads the device's own clock. If not, it waits for each kernel, and the times hold
    /// the way to the device and back.
    pub fn has_clock(&self) -> bool {
        self.gpu.has_clock()
    }

    /// Submits what was recorded.
    fn flush(&mut self) -> Result<(), EngineError> {
        let seconds = self.recorder.finish(&self.gpu)?;
        if self.stamped {
            for (kernel, seconds) in self.recorder.stamped(&self.gpu)? {
                self.clock.add(kernel.stem(), seconds);
            }
        }
        if seconds > 0.0 {
            self.submissions.count += 1;
        }
        if seconds > self.submissions.longest_seconds {
            self.submissions.longest_seconds = seconds;
            self.submissions.longest = self.pace.kernels().collect();
        }
        self.pace.learn(seconds);
        Ok(())
    }

    /// Runs a step, by itself if its time is asked for and the device has no clock.
    fn run(&mut self, step: &Step) -> Result<(), EngineError> {
        if self.stamped || !self.clock.is_wound() {
            return self.record(step);
        }
        self.flush()?;
        self.clock.begin(step.kernel.stem());
        self.record(step)?;
        self.flush()?;
        self.clock.end();
        Ok(())
    }

    /// Records a step in as many dispatches as the pace asks for.
    fn record(&mut self, step: &Step) -> Result<(), EngineError> {
        let Dispatch { mut first, end, .. } = step.dispatch;
        let whole = step.kernel == Kernel::GridScanSums;
        let granule = workgroup_items(step.kernel);
        while first < end {
            let fit = self.pace.fit(step.kernel, end - first);
            if fit == 0 || self.recorder.is_full() {
                self.flush()?;
                continue;
            }
            let items = if whole { end } else { fit.next_multiple_of(granule).min(end - first) };
            let dispatch = Dispatch { first, end: first + items, ..step.dispatch };
            let group = &self.groups[&(step.kernel, step.chunk)];
            self.recorder.dispatch(&self.gpu, &self.programs[&step.kernel], group, &dispatch);
            self.pace.record(step.kernel, items);
            first += items;
        }
        Ok(())
    }

    /// The steps of a pass up to `Resolve`, which do not touch what passes before have found.
    fn trace(&mut self, steps: &[Step]) -> Result<Counted, EngineError> {
        let batches = steps.iter().filter(|s| s.kernel == Kernel::PhotonTrace).count() as u64;
        let bytes = READINGS_BYTES + 4 * batches;
        if self.readings.size() < bytes {
            self.readings = self.gpu.storage("readings", bytes)?;
        }
        for chunk in &self.chunks {
            self.recorder.clear(&self.gpu, &chunk["gathered"], None);
        }
        self.recorder.clear(&self.gpu, &self.shared["counters"], None);
        let mut offset = READINGS_BYTES;
        let (mut mended, mut mended_eyes) = (0, 0);
        for step in steps {
            if step.kernel == Kernel::PhotonTrace {
                self.recorder.clear(&self.gpu, &self.shared["counters"], Some(4));
            }
            self.run(step)?;
            mended += self.mend(step)?;
            if step.kernel == Kernel::EyeTrace {
                mended_eyes = mended;
                self.recorder.copy(
                    &self.gpu,
                    (&self.shared["counters"], 4),
                    (&self.readings, COUNTERS_BYTES),
                    8,
                );
            }
            if step.kernel == Kernel::PhotonTrace {
                self.recorder.copy(&self.gpu, (&self.shared["counters"], 0), (&self.readings, offset), 4);
                offset += 4;
            }
        }
        let counters = &self.shared["counters"];
        self.recorder.copy(&self.gpu, (counters, 0), (&self.readings, 0), COUNTERS_BYTES);
        self.flush()?;
        let words: Vec<u32> = bytemuck::pod_collect_to_vec(&self.gpu.read(&self.readings, bytes)?);
        let wide = |at: usize| words[at] as u64 | (words[at + 1] as u64) << 32;
        let rays = wide(1) + mended;
        // a pass that traces no eye path leaves what stood here
        let eyes = steps.iter().any(|step| step.kernel == Kernel::EyeTrace);
        let eye_rays = if eyes { wide(COUNTERS_BYTES as usize / 4) + mended_eyes } else { 0 };
        let ends = PhotonEnds::of([words[ENDS], words[ENDS + 1], words[ENDS + 2]].map(u64::from));
        let records = words[READINGS_BYTES as usize / 4..].to_vec();
        Ok(Counted { records, rays, eye_rays, ends, stopped: words[3] })
    }

    /// Traces again, on the CPU, the paths of a step that a software driver stopped; the number of their rays.
    fn mend(&mut self, step: &Step) -> Result<u64, EngineError> {
        if self.scene.is_none() || !matches!(step.kernel, Kernel::EyeTrace | Kernel::PhotonTrace) {
            return Ok(0);
        }
        self.flush()?;
        let counters = &self.shared["counters"];
        let mut words: Vec<u32> = bytemuck::pod_collect_to_vec(&self.gpu.read(counters, COUNTERS_BYTES)?);
        let Some(scene) = self.scene.as_ref().filter(|_| words[3] > 0) else {
            return Ok(0);
        };
        let sampled = self.plan.features.has("sampled");
        let (mended, rays) = if step.kernel == Kernel::EyeTrace {
            let buffer = &self.chunks[step.chunk as usize]["visible_points"];
            mend_points(&self.gpu, scene, &step.dispatch, sampled, buffer)?
        } else {
            let mended =
                mend_photons(&self.gpu, scene, &step.dispatch, sampled, &self.shared["records"], words[0])?;
            words[0] = mended.records;
            for (word, count) in words[ENDS..].iter_mut().zip(mended.ends) {
                *word += count;
            }
            (mended.photons, mended.rays)
        };
        // what is left are loops of the batches before, for which the pass is run again
        words[3] -= mended.min(words[3]);
        self.gpu.write(counters, bytemuck::cast_slice(&words));
        Ok(rays)
    }
}

impl GpuEngine {
    /// Traces again, on the CPU, the samples of a step that a software driver stopped; fails where there is another driver.
    fn mend_aovs(&mut self, step: &Step) -> Result<(), EngineError> {
        if step.kernel != Kernel::AovTrace {
            return Ok(());
        }
        self.flush()?;
        let counters = &self.shared["counters"];
        let mut words: Vec<u32> = bytemuck::pod_collect_to_vec(&self.gpu.read(counters, COUNTERS_BYTES)?);
        if words[STOPPED_COUNT] == 0 {
            return Ok(());
        }
        let Some(scene) = &self.scene else {
            return Err(self.unfinished());
        };
        let sampled = self.plan.features.has("sampled") && self.plan.features.has("direct_layer");
        mend_aovs(&self.gpu, scene, &step.dispatch, sampled, &self.chunks[step.chunk as usize]["aovs"])?;
        words[STOPPED_COUNT] = 0;
        self.gpu.write(counters, bytemuck::cast_slice(&words));
        Ok(())
    }

    fn unfinished(&self) -> EngineError {
        EngineError::Unsupported(format!("{} leaves long loops unfinished; take --device cpu", self.device))
    }
}

/// Whether a kernel adds to what passes before have found, so that it must not run in a pass that is thrown away.
fn adds_up(kernel: Kernel) -> bool {
    matches!(kernel, Kernel::ResolveParts | Kernel::Resolve | Kernel::AovTrace)
}

/// Bytes of a chunk's buffer, from those of the largest one.
fn chunk_bytes(plan: &Plan, largest: u64, chunk: u32) -> u64 {
    largest * plan.chunk(chunk).1 as u64 / plan.chunk(0).1.max(1) as u64
}

/// Name and bytes of everything that will be allocated.
pub fn sizes(plan: &Plan, scene: &Scene) -> Vec<(&'static str, u64)> {
    let mut list = vec![("scene", SceneTables::new(scene).bytes.len() as u64)];
    list.extend(long_tables(scene).map(|(name, _, content)| (name, content.len() as u64)));
    for (name, bytes) in plan.buffers() {
        if CHUNK_BUFFERS.contains(&name) {
            list.extend((0..plan.chunks()).map(|chunk| (name, chunk_bytes(plan, bytes, chunk))));
        } else {
            list.push((name, bytes));
        }
    }
    list
}

impl Engine for GpuEngine {
    fn device(&self) -> &str {
        &self.device
    }

    fn pass(&mut self) -> Result<PassReport, EngineError> {
        let pass = self.passes_done;
        let mut batch = self.plan.batch_photons;
        loop {
            let steps = self.plan.steps(pass, batch);
            let (resolve, trace): (Vec<_>, Vec<_>) = steps.into_iter().partition(|s| adds_up(s.kernel));
            let counted = self.trace(&trace)?;
            let photons = trace.iter().filter(|s| s.kernel == Kernel::PhotonTrace).map(|s| s.dispatch.end);
            let overflow = |(photons, records): (u32, &u32)| *records > self.plan.capacity && photons > 1;
            let overflows = photons.zip(&counted.records).any(overflow);
            if counted.stopped > 0 && (batch == 1 || self.scene.is_none()) {
                return Err(self.unfinished());
            }
            if overflows || counted.stopped > 0 {
                // thrown away and run again with batches half as large, which also shortens the loops over photons
                batch = (batch / 2).max(1);
                continue;
            }
            for step in &resolve {
                self.run(step)?;
                self.mend_aovs(step)?;
            }
            self.flush()?;
            self.passes_done += 1;
            let eye_paths =
                trace.iter().filter(|s| s.kernel == Kernel::EyeTrace).map(|s| s.dispatch.end as u64);
            return Ok(PassReport {
                photons: self.plan.settings.photons as u64,
                records: counted.records.iter().map(|r| *r as u64).sum(),
                eye_paths: eye_paths.sum(),
                rays: counted.rays,
                eye_rays: counted.eye_rays,
                ends: counted.ends,
                radius: self.plan.radius(pass),
            });
        }
    }

    fn timed_pass(&mut self) -> Result<(PassReport, KernelSeconds), EngineError> {
        self.stamped = self.recorder.stamp(&self.gpu, true)?;
        self.clock.wind();
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
        Ok(State {
            first_pass: self.plan.first_pass,
            passes: self.passes_done,
            bits: 8 * size_of::<f32>() as u32,
            film: self.read_chunks("film")?,
            statistics: self.read_chunks("statistics")?,
            layers: self.with_found(|plan, found| plan.layer_state(found))?,
        })
    }

    fn restore(&mut self, state: &State) -> Result<(), EngineError> {
        self.plan.take_over(state)?;
        self.passes_done = state.passes;
        let LayerState { aovs, parts, counts, .. } = &state.layers;
        let gathered: Vec<_> =
            counts.iter().map(|count| Gathered { count: *count, ..bytemuck::Zeroable::zeroed() }).collect();
        let gathered = bytemuck::cast_slice(&gathered);
        for (name, bytes) in [
            ("film", &state.film[..]),
            ("statistics", &state.statistics),
            ("aovs", aovs),
            ("parts", parts),
            ("gathered", gathered),
        ] {
            for (number, chunk) in (0..).zip(&self.chunks) {
                if let (Some(buffer), Some(part)) = (chunk.get(name), bytes.get(self.place(name, number))) {
                    self.gpu.write(buffer, part);
                }
            }
        }
        self.gpu.check()
    }

    fn layers(&mut self) -> Result<Vec<Channel>, EngineError> {
        self.with_found(|plan, found| plan.layers(found))
    }

    fn gathered(&mut self) -> Result<u64, EngineError> {
        let gathered: Vec<Gathered> = self.chunked("gathered", 1)?;
        Ok(gathered.iter().map(|gathered| u64::from(gathered.count)).sum())
    }
}

impl GpuEngine {
    /// The film, read back.
    fn film(&self) -> Result<Vec<FilmPixel>, EngineError> {
        self.chunked("film", self.plan.eye_samples)
    }

    /// What `make` makes of what is found beside radiance, which is read back; its default where nothing is asked for.
    fn with_found<T: Default>(&self, make: impl Fn(&Plan, &Found) -> T) -> Result<T, EngineError> {
        if self.plan.aovs.is_empty() {
            return Ok(T::default());
        }
        let samples = self.plan.eye_samples;
        let found = Found {
            aovs: &self.chunked("aovs", samples)?,
            parts: &self.chunked("parts", samples)?,
            gathered: &self.chunked("gathered", 1)?,
            statistics: &self.chunked("statistics", 1)?,
            passes: self.passes_done,
        };
        Ok(make(&self.plan, &found))
    }

    /// What all chunks hold in a buffer of theirs, an item for each `samples` visible points; nothing where there is no such
    /// buffer.
    fn chunked<T: bytemuck::Pod>(&self, name: &str, samples: u32) -> Result<Vec<T>, EngineError> {
        let mut all = Vec::new();
        for (number, chunk) in (0..).zip(&self.chunks) {
            if let Some(buffer) = chunk.get(name) {
                let items = self.plan.chunk(number).1 / samples;
                let bytes = self.gpu.read(buffer, items as u64 * size_of::<T>() as u64)?;
                all.extend(bytemuck::pod_collect_to_vec::<u8, T>(&bytes));
            }
        }
        Ok(all)
    }

    /// All chunks' parts of a buffer, one after another; nothing where the plan has no such buffer.
    fn read_chunks(&self, name: &str) -> Result<Vec<u8>, EngineError> {
        let mut bytes = Vec::new();
        for (number, chunk) in (0..).zip(&self.chunks) {
            if let Some(buffer) = chunk.get(name) {
                bytes.extend(self.gpu.read(buffer, self.place(name, number).len() as u64)?);
            }
        }
        Ok(bytes)
    }

    /// Where a chunk's part of a buffer stands among those of all.
    fn place(&self, name: &str, chunk: u32) -> std::ops::Range<usize> {
        let (first, points) = self.plan.chunk(chunk);
        let samples = self.plan.eye_samples;
        let (first, end, size) = match name {
            "film" => (first / samples, (first + points) / samples, FILM_BYTES),
            "aovs" => (first / samples, (first + points) / samples, AOV_BYTES),
            "parts" => (first / samples, (first + points) / samples, PARTS_BYTES),
            "gathered" => (first, first + points, size_of::<Gathered>()),
            _ => (first, first + points, STATISTICS_BYTES),
        };
        first as usize * size..end as usize * size
    }
}
