//! CPU engine: executes a plan on vectors in memory, with rayon. Needs no adapter.

mod photons;
mod tasks;

use super::kernels::aov_trace::AovPixel;
use super::kernels::bytes::{
    aovs_of, film_bytes, film_of, parts_of, statistics_bytes, statistics_of,
};
use super::kernels::grid_build::{
    RecordList, SortedRecords, grid_count, grid_scan, grid_scatter, grid_sort,
};
use super::kernels::path_trace::path_trace;
use super::kernels::records::*;
use super::kernels::resolve::{Estimate, fold, resolve};
use super::kernels::resolve_parts::{PartsPixel, resolve_parts};
use super::math::is_finite;
use super::pack::PackedScene;
use super::plan::features::Feature;
use super::plan::layers::LayerInputs as Layers;
use super::plan::{Buffer, Command, Kernel, Plan, Stage, Step};
use super::real::{ENGINE, Real};
use crate::engine::{Cancel, Engine, EngineError, MeasuredEngine, PassReport, PhotonEnds, State};
use crate::film::exr_file::Channel;
use crate::film::{ErrorMap, Picture, Rejections};
use crate::scene::settings::Method;
use crate::telemetry::clock::{Clock, KernelSeconds};
use bytemuck::Zeroable;
use photons::trace_photons;
use rayon::prelude::*;
use std::ops::Range;
use std::sync::Arc;
use tasks::{EYE_TASK, EyePaths, GATHER_TASK, Gathers, trace_aovs};

/// Engine that renders one scene on the processor's cores.
pub struct CpuEngine {
    packed: Arc<PackedScene>,
    plan: Plan,
    passes_done: u32,
    visible_points: Vec<VisiblePoint>,
    gathered: Vec<Gathered>,
    statistics: Vec<Statistics>,
    film: Vec<FilmPixel>,
    aovs: Vec<AovPixel>,
    parts: Vec<PartsPixel>,
    records: Vec<RecordList>,
    /// Number of records before each part of the buckets.
    part_starts: Vec<u32>,
    starts: Vec<u32>,
    sorted: SortedRecords,
    device: String,
    clock: Clock,
    /// Vector instructions of the processor.
    arch: pulp::Arch,
}

/// Reason why a pass did not reach the film.
enum Unfinished {
    /// A batch left more records than the capacity.
    Overflow,
    /// The pass was cancelled.
    Cancelled,
}

impl CpuEngine {
    /// Creates an engine for one scene and plan.
    pub fn new(packed: impl Into<Arc<PackedScene>>, plan: Plan) -> Self {
        let points = (plan.pixels * plan.eye_samples) as usize;
        let photons = plan.features.has(Feature::Photons);
        let buckets = if photons { plan.buckets as usize } else { 0 };
        let path = plan.settings.method == Method::Path;
        let points_kept = if path { 0 } else { points };
        let held = |buffer| match (path, plan.is_reused(buffer)) {
            (true, _) => 0,
            (false, true) => plan.chunk(0).1 as usize,
            (false, false) => points,
        };
        Self {
            passes_done: 0,
            visible_points: vec![VisiblePoint::zeroed(); held(Buffer::VisiblePoints)],
            gathered: vec![Gathered::zeroed(); held(Buffer::Gathered)],
            statistics: vec![
                Statistics::zeroed();
                if plan.features.has(Feature::Local) { points_kept } else { 0 }
            ],
            film: vec![FilmPixel::zeroed(); plan.pixels as usize],
            aovs: vec![
                AovPixel::zeroed();
                if plan.aovs.are_traced() { plan.pixels as usize } else { 0 }
            ],
            parts: vec![
                PartsPixel::zeroed();
                if plan.parts_photons() { plan.pixels as usize } else { 0 }
            ],
            records: Vec::new(),
            part_starts: Vec::new(),
            starts: vec![0; buckets + 1],
            sorted: SortedRecords::default(),
            device: format!("{ENGINE}, {} threads", rayon::current_num_threads()),
            clock: Clock::default(),
            arch: pulp::Arch::new(),
            packed: packed.into(),
            plan,
        }
    }

    fn photon_pass(&mut self, report: &mut PassReport) -> Result<(), EngineError> {
        let mut batch = self.plan.batch_photons;
        loop {
            *report =
                PassReport { photons: self.plan.settings.photons as u64, ..PassReport::default() };
            match self.execute(batch, report) {
                Ok(()) => return Ok(()),
                // discard a pass that overflowed and run it again with batches half as large
                Err(Unfinished::Overflow) => batch = (batch / 2).max(1),
                Err(Unfinished::Cancelled) => return Err(EngineError::Cancelled),
            }
        }
    }

    fn execute(&mut self, batch: u32, report: &mut PassReport) -> Result<(), Unfinished> {
        let tiles = self.plan.commands(self.passes_done, batch);
        let mut cancel = self.plan.cancel.clone();
        for (number, commands) in tiles.into_iter().enumerate() {
            let mut tile = PassReport::default();
            for command in commands {
                cancel.check().map_err(|_| Unfinished::Cancelled)?;
                match command {
                    Command::ClearGathered { chunk } => {
                        let place = self.place(Buffer::Gathered, chunk);
                        self.gathered[place].par_iter_mut().for_each(|g| *g = Gathered::zeroed());
                    }
                    Command::ClearCounters => tile = PassReport::default(),
                    Command::ClearRecords => {
                        self.records.iter_mut().for_each(|list| list.records.clear());
                    }
                    Command::Run(step) => self.run(&step, &cancel, &mut tile)?,
                    Command::ReadEyeRays => tile.eye_rays = tile.rays,
                    Command::ReadRecords { photons } => {
                        let records = self.records.iter().map(|list| list.records.len() as u64);
                        let records = records.sum::<u64>();
                        tile.records += records;
                        if records > u64::from(self.plan.capacity) && photons > 1 {
                            return Err(Unfinished::Overflow);
                        }
                    }
                    Command::Commit => cancel = Cancel::default(),
                }
                // a cancelled step may have skipped its last tasks
                cancel.check().map_err(|_| Unfinished::Cancelled)?;
            }
            report.eye_paths += tile.eye_paths;
            report.rays += tile.rays;
            report.eye_rays += tile.eye_rays;
            // tiles trace the same photons, so count them once
            if number == 0 {
                report.ends = tile.ends;
                report.records = tile.records;
            }
        }
        Ok(())
    }

    /// Range of a chunk's visible points in a buffer.
    fn place(&self, buffer: Buffer, chunk: u32) -> Range<usize> {
        let (first, points) = self.plan.chunk(chunk);
        let first = if self.plan.is_reused(buffer) { 0 } else { first as usize };
        first..first + points as usize
    }

    /// Runs a step. Long steps skip the tasks that have not started when `cancel` is requested.
    fn run(
        &mut self,
        step: &Step,
        cancel: &Cancel,
        tile: &mut PassReport,
    ) -> Result<(), Unfinished> {
        let sampled = self.plan.features.has(Feature::Sampled);
        let local = self.plan.features.has(Feature::Local);
        let chunk = self.place(Buffer::Statistics, step.chunk);
        let (seen, found) = (
            self.place(Buffer::VisiblePoints, step.chunk),
            self.place(Buffer::Gathered, step.chunk),
        );
        let scene = &self.packed.tables;
        let d = &step.dispatch;
        if let [kernel] = step.stage.kernels() {
            self.clock.begin(kernel.stem());
        }
        match step.stage {
            Stage::EyeTrace => {
                tile.eye_paths += d.end as u64;
                let rays = self.visible_points[seen]
                    .par_chunks_mut(EYE_TASK)
                    .enumerate()
                    .map(|(task, points)| {
                        let first = (task * EYE_TASK) as u32;
                        self.arch.dispatch(EyePaths { scene, dispatch: d, sampled, first, points })
                    })
                    .sum::<u64>();
                tile.rays += rays;
            }
            Stage::PhotonTrace => {
                let (rays, ends) =
                    trace_photons(self.arch, scene, d, sampled, cancel, &mut self.records);
                tile.rays += rays;
                tile.ends.add(&PhotonEnds::of(ends));
            }
            Stage::BuildGrid => {
                self.clock.begin(Kernel::GridCount.stem());
                grid_count(d, &mut self.records);
                self.clock.begin(Kernel::GridScan.stem());
                self.part_starts = grid_scan(&self.records);
                self.clock.begin(Kernel::GridScatter.stem());
                grid_scatter(d, &mut self.records);
                self.clock.begin(Kernel::GridSort.stem());
                let (starts, sorted) = (&mut self.starts, &mut self.sorted);
                grid_sort(d, &self.records, &self.part_starts, starts, sorted);
            }
            Stage::Gather => {
                let points = self.visible_points[seen].par_chunks(GATHER_TASK);
                let gathered = self.gathered[found].par_chunks_mut(GATHER_TASK);
                let mut statistics =
                    self.statistics.get(chunk).unwrap_or_default().chunks(GATHER_TASK);
                let statistics: Vec<_> = (0..points.len()).map(|_| statistics.next()).collect();
                gathered.zip(points).zip(statistics).for_each(
                    |((gathered, points), statistics)| {
                        let (starts, sorted) = (&self.starts, &self.sorted);
                        if cancel.is_asked() {
                            return;
                        }
                        self.arch.dispatch(Gathers {
                            materials: &scene.materials,
                            outlines: &scene.outlines,
                            dispatch: d,
                            points,
                            statistics,
                            starts,
                            sorted,
                            gathered,
                        });
                    },
                );
            }
            Stage::AovTrace => trace_aovs(scene, d, &self.plan.features, &mut self.aovs),
            Stage::ResolveParts => {
                let samples = d.eye_samples as usize;
                let pixels = d.chunk_first as usize / samples..chunk.end / samples;
                let parts = self.parts[pixels].par_iter_mut().enumerate();
                parts.for_each(|(i, parts)| {
                    let at = |start: usize| start + i * samples..start + (i + 1) * samples;
                    let statistics = self.statistics.get(at(chunk.start)).filter(|_| local);
                    let points = &self.visible_points[at(seen.start)];
                    resolve_parts(d, points, &self.gathered[at(found.start)], statistics, parts);
                });
            }
            Stage::Resolve => {
                let samples = d.eye_samples as usize;
                let pixels = d.chunk_first as usize / samples..chunk.end / samples;
                let film = self.film[pixels].par_iter_mut();
                let points = self.visible_points[seen].par_chunks(samples);
                let gathered = self.gathered[found].par_chunks(samples);
                let work = film.zip(points).zip(gathered);
                if local {
                    let statistics = self.statistics[chunk].par_chunks_mut(samples);
                    work.zip(statistics).for_each(|(((f, p), g), s)| resolve(d, p, g, Some(s), f));
                } else {
                    work.for_each(|((f, p), g)| resolve(d, p, g, None, f));
                }
            }
        }
        Ok(())
    }

    fn path_pass(&mut self, report: &mut PassReport) {
        self.clock.begin("path_trace");
        let d = self.plan.dispatch(self.passes_done);
        let sampled = self.plan.features.has(Feature::Sampled);
        let scene = &self.packed.tables;
        report.eye_paths = self.film.len() as u64;
        report.rays = self
            .film
            .par_iter_mut()
            .enumerate()
            .map(|(pixel, film)| {
                let (radiance, rays) = path_trace(scene, &d, sampled, pixel as u32);
                let cause = if is_finite(radiance) { ACCEPTED } else { REJECTED_EYE };
                fold(&d, cause, Estimate { radiance, bias_probe: 0.0, halves: 0.0 }, film);
                rays as u64
            })
            .sum();
        report.eye_rays = report.rays;
        for step in self.plan.aov_steps(self.passes_done) {
            self.clock.begin(Kernel::AovTrace.stem());
            trace_aovs(scene, &step.dispatch, &self.plan.features, &mut self.aovs);
        }
    }
}

impl CpuEngine {
    /// Inputs of the layers.
    fn found(&self) -> Layers<'_> {
        let Self { aovs, parts, gathered, statistics, passes_done, .. } = self;
        Layers { aovs, parts, gathered, statistics, passes: *passes_done }
    }
}

impl Engine for CpuEngine {
    fn device(&self) -> &str {
        &self.device
    }

    fn pass(&mut self) -> Result<PassReport, EngineError> {
        let mut report = PassReport::default();
        if self.plan.settings.method == Method::Path {
            self.plan.cancel.check()?;
            self.path_pass(&mut report);
        } else {
            self.photon_pass(&mut report)?;
            report.radius = self.plan.radius(self.passes_done);
        }
        self.clock.end();
        self.passes_done += 1;
        Ok(report)
    }

    fn picture(&mut self) -> Result<Picture, EngineError> {
        Ok(self.plan.picture(&self.film))
    }

    fn errors(&mut self) -> Result<ErrorMap, EngineError> {
        Ok(self.plan.errors(&self.film, self.passes_done))
    }

    fn rejections(&mut self) -> Result<Rejections, EngineError> {
        Ok(self.plan.rejections(&self.film))
    }

    fn can_be_lost(&self) -> bool {
        false
    }

    fn save(&mut self) -> Result<State, EngineError> {
        Ok(State {
            first_pass: self.plan.first_pass,
            passes: self.passes_done,
            bits: 8 * size_of::<Real>() as u32,
            film: film_bytes(&self.film),
            statistics: statistics_bytes(&self.statistics),
            layers: self.plan.layer_state(&self.found()),
        })
    }

    fn restore(&mut self, state: &State) -> Result<(), EngineError> {
        self.plan.take_over(state)?;
        if state.passes > 0 {
            self.passes_done = state.passes;
            self.film = film_of(&state.film);
            self.statistics = statistics_of(&state.statistics);
            if !self.aovs.is_empty() {
                self.aovs = aovs_of(&state.layers.aovs);
            }
            if !self.parts.is_empty() {
                self.parts = parts_of(&state.layers.parts);
            }
            for (gathered, count) in self.gathered.iter_mut().zip(&state.layers.counts) {
                gathered.count = *count;
            }
        }
        Ok(())
    }

    fn layers(&mut self) -> Result<Vec<Channel>, EngineError> {
        Ok(self.plan.layers(&self.found()))
    }
}

impl MeasuredEngine for CpuEngine {
    fn timed_pass(&mut self) -> Result<(PassReport, KernelSeconds), EngineError> {
        self.clock.enable();
        let report = self.pass();
        let seconds = self.clock.take();
        Ok((report?, seconds))
    }

    fn gathered(&mut self) -> Result<u64, EngineError> {
        if self.plan.is_reused(Buffer::Gathered) {
            return Err(EngineError::Unsupported(
                "what tiles have gathered is not kept".to_owned(),
            ));
        }
        Ok(self.gathered.par_iter().map(|gathered| u64::from(gathered.count)).sum())
    }
}
