//! Executes the commands of a pass.

use super::{COUNTERS_BYTES, ENDS, Executor, READINGS_BYTES, STOPPED_COUNT};
use crate::engine::{EngineError, PassReport, PhotonEnds};
use crate::kernels::records::Dispatch;
use crate::plan::{Buffer, Command, Kernel, Over, Stage, Step};
use std::collections::BTreeMap;

/// Repair of what a driver leaves undone.
pub trait Repair {
    /// Repairs the results of `step`, which has just run. Returns the number of rays traced.
    ///
    /// # Errors
    /// If the driver left loops unfinished that cannot be repaired.
    fn after_step(&self, executor: &mut Executor, step: &Step) -> Result<u64, EngineError>;

    /// Returns true if a pass with stopped loops may be complete with smaller batches.
    fn allows_retry(&self) -> bool;
}

/// Counts of one tile's commands.
#[derive(Default)]
struct Tile {
    /// Number of batches, one record count each.
    batches: usize,
    /// Number of photons of each batch so far.
    photons: Vec<u32>,
    /// Number of records of each batch.
    records: Vec<u32>,
    eye_paths: u64,
    rays: u64,
    eye_rays: u64,
    ends: PhotonEnds,
    /// Number of invocations that the driver stopped and that were not retraced.
    stopped: u32,
    /// Number of rays of retraced paths.
    retraced: u64,
    /// The same for eye paths, set once these are complete.
    retraced_eyes: Option<u64>,
}

impl Tile {
    fn new(batches: usize) -> Self {
        Self { batches, ..Self::default() }
    }

    /// Size of the tile's readings in bytes.
    fn bytes(&self) -> u64 {
        READINGS_BYTES + 4 * self.batches as u64
    }

    /// Stores the counters, the ray count after the eye paths, and each batch's records.
    fn read(&mut self, words: &[u32]) {
        let wide = |at: usize| u64::from(words[at]) | u64::from(words[at + 1]) << 32;
        self.rays = wide(1) + self.retraced;
        self.eye_rays = match self.retraced_eyes {
            Some(retraced) => wide(COUNTERS_BYTES as usize / 4) + retraced,
            None => 0,
        };
        self.stopped = words[STOPPED_COUNT];
        self.ends = PhotonEnds::of([words[ENDS], words[ENDS + 1], words[ENDS + 2]].map(u64::from));
        self.records = words[READINGS_BYTES as usize / 4..][..self.batches].to_vec();
    }

    /// Returns true if a batch of several photons left more records than the capacity.
    fn overflows(&self, capacity: u32) -> bool {
        let mut batches = self.photons.iter().zip(&self.records);
        batches.any(|(photons, records)| *records > capacity && *photons > 1)
    }
}

impl Executor {
    /// Starts or ends the measurement of each kernel, by the device's clock if it has one.
    pub(in super::super) fn measure(&mut self, on: bool) -> Result<(), EngineError> {
        self.stamped = self.recorder.stamp(&self.gpu, on)?;
        if on {
            self.clock.enable();
        }
        Ok(())
    }

    /// Submits the recorded commands and updates the statistics and the pace.
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

    /// Runs a step, kernel by kernel if their times are measured and the device has no clock.
    fn run(&mut self, step: &Step) -> Result<(), EngineError> {
        let kernels: Vec<_> = self.plan.lowered(step).collect();
        for (kernel, dispatch) in kernels {
            if self.stamped || !self.clock.is_enabled() {
                self.record(kernel, step.chunk, &dispatch)?;
                continue;
            }
            self.flush()?;
            self.clock.begin(kernel.stem());
            self.record(kernel, step.chunk, &dispatch)?;
            self.flush()?;
            self.clock.end();
        }
        Ok(())
    }

    /// Records a kernel in as many dispatches as the pace requires.
    fn record(&mut self, kernel: Kernel, chunk: u32, whole: &Dispatch) -> Result<(), EngineError> {
        let Dispatch { mut first, end, .. } = *whole;
        // a single workgroup must see all blocks
        let indivisible = kernel.info().over == Over::Blocks;
        let granule = kernel.info().workgroup_items;
        while first < end {
            let fit = self.pace.fit(kernel, end - first);
            if fit == 0 || self.recorder.is_full() {
                self.flush()?;
                // after a commit the whole pass must reach the film
                if !self.partial {
                    self.plan.cancel.check()?;
                }
                continue;
            }
            let items =
                if indivisible { end } else { fit.next_multiple_of(granule).min(end - first) };
            let dispatch = Dispatch { first, end: first + items, ..*whole };
            let group = &self.groups[&(kernel, chunk)];
            self.recorder.dispatch(&self.gpu, &self.programs[&kernel], group, &dispatch);
            self.pace.record(kernel, items, end - whole.first);
            first += items;
        }
        Ok(())
    }

    /// Executes a pass with `batch` photons per batch. Returns `None` if the pass is discarded
    /// because records did not fit or the driver stopped long loops.
    pub(in super::super) fn execute(
        &mut self,
        batch: u32,
        repair: &dyn Repair,
    ) -> Result<Option<PassReport>, EngineError> {
        self.plan.cancel.check()?;
        let pass = self.passes_done;
        let mut report = PassReport {
            photons: self.plan.settings.photons as u64,
            radius: self.plan.radius(pass),
            ..PassReport::default()
        };
        for (number, commands) in self.plan.commands(pass, batch).into_iter().enumerate() {
            let batches = commands.iter().filter(|c| matches!(c, Command::ReadRecords { .. }));
            let mut tile = Tile::new(batches.count());
            self.provide_readings(tile.bytes())?;
            for command in &commands {
                if !self.command(command, &mut tile, batch, repair)? {
                    return Ok(None);
                }
            }
            self.flush()?;
            report.eye_paths += tile.eye_paths;
            report.rays += tile.rays;
            report.eye_rays += tile.eye_rays;
            // tiles trace the same photons, so count them once
            if number == 0 {
                report.records = tile.records.iter().map(|records| u64::from(*records)).sum();
                report.ends = tile.ends;
            }
        }
        self.partial = false;
        Ok(Some(report))
    }

    /// Executes one command. Returns false if the pass must be discarded.
    fn command(
        &mut self,
        command: &Command,
        tile: &mut Tile,
        batch: u32,
        repair: &dyn Repair,
    ) -> Result<bool, EngineError> {
        match command {
            Command::ClearGathered { chunk } => {
                let gathered = buffer(&self.shared, &self.chunks, Buffer::Gathered, *chunk);
                self.recorder.clear(&self.gpu, gathered, None);
            }
            Command::ClearCounters => {
                self.recorder.clear(&self.gpu, &self.shared[&Buffer::Counters], None);
            }
            Command::ClearRecords => {
                self.recorder.clear(&self.gpu, &self.shared[&Buffer::Counters], Some(4));
            }
            Command::Run(step) => {
                self.run(step)?;
                tile.retraced += repair.after_step(self, step)?;
                if step.stage == Stage::EyeTrace {
                    tile.eye_paths += u64::from(step.dispatch.end);
                }
            }
            Command::ReadEyeRays => {
                self.read_counters(4..12, COUNTERS_BYTES);
                tile.retraced_eyes = Some(tile.retraced);
            }
            Command::ReadRecords { photons } => {
                self.read_counters(0..4, READINGS_BYTES + 4 * tile.photons.len() as u64);
                tile.photons.push(*photons);
            }
            Command::Commit => {
                self.read_counters(0..COUNTERS_BYTES, 0);
                self.flush()?;
                let bytes = self.gpu.read(&self.readings, tile.bytes())?;
                tile.read(&bytemuck::pod_collect_to_vec(&bytes));
                // tiles before this one have already been added to the film
                if tile.stopped > 0 && (batch == 1 || !repair.allows_retry() || self.partial) {
                    return Err(self.unfinished());
                }
                if tile.overflows(self.plan.capacity) || tile.stopped > 0 {
                    return Ok(false);
                }
                self.partial = true;
            }
        }
        Ok(true)
    }

    /// Makes the buffer of readings at least `bytes` large.
    fn provide_readings(&mut self, bytes: u64) -> Result<(), EngineError> {
        if self.readings.size() < bytes {
            self.readings = self.gpu.storage("readings", bytes)?;
        }
        Ok(())
    }

    /// Records a copy of a byte range of the counters to an offset in the readings.
    fn read_counters(&mut self, bytes: std::ops::Range<u64>, to: u64) {
        let source = (&self.shared[&Buffer::Counters], bytes.start);
        let size = bytes.end - bytes.start;
        self.recorder.copy(&self.gpu, source, (&self.readings, to), size);
    }

    /// Waits for the recorded commands, and reads the counters.
    pub(in super::super) fn counters(&mut self) -> Result<Vec<u32>, EngineError> {
        self.flush()?;
        let bytes = self.gpu.read(&self.shared[&Buffer::Counters], COUNTERS_BYTES)?;
        Ok(bytemuck::pod_collect_to_vec(&bytes))
    }

    /// Replaces the counters.
    pub(in super::super) fn set_counters(&mut self, words: &[u32]) {
        self.gpu.write(&self.shared[&Buffer::Counters], bytemuck::cast_slice(words));
    }

    /// Buffer of a chunk, or the shared buffer if there is no such one.
    pub(in super::super) fn buffer(&self, which: Buffer, chunk: u32) -> &wgpu::Buffer {
        buffer(&self.shared, &self.chunks, which, chunk)
    }

    /// Error if loops were stopped and cannot be repaired.
    pub(in super::super) fn unfinished(&self) -> EngineError {
        EngineError::Unsupported(format!(
            "{} leaves long loops unfinished; take --device cpu",
            self.device
        ))
    }
}

/// Buffer of a chunk, or the shared buffer if there is no such one.
fn buffer<'a>(
    shared: &'a BTreeMap<Buffer, wgpu::Buffer>,
    chunks: &'a [BTreeMap<Buffer, wgpu::Buffer>],
    which: Buffer,
    chunk: u32,
) -> &'a wgpu::Buffer {
    chunks.get(chunk as usize).and_then(|own| own.get(&which)).unwrap_or_else(|| &shared[&which])
}
