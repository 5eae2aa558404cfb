//! A pass as a list of commands that engines execute.

use super::super::kernels::records::Dispatch;
use super::super::real::Real;
use super::buffer::Buffer;
use super::features::Feature;
use super::kernel::{Kernel, Over, SCAN_BLOCK};
use super::{Plan, key_bits};
use crate::scene::settings::{Method, Radius};
use bytemuck::Zeroable;
use std::collections::BTreeSet;
use std::ops::Range;

/// Command to an engine.
#[allow(clippy::large_enum_variant)] // lists of commands are short
#[derive(Clone, Copy, Debug)]
pub enum Command {
    /// Fills a chunk's `gathered` with zeros.
    ClearGathered {
        /// Index of the chunk.
        chunk: u32,
    },
    /// Fills the counters with zeros.
    ClearCounters,
    /// Sets the record count in the counters to zero.
    ClearRecords,
    /// Runs a stage.
    Run(Step),
    /// Reads the number of rays so far, which are those of eye paths.
    ReadEyeRays,
    /// Reads the number of records that a batch left. If it exceeds the capacity, the pass is
    /// discarded and run again with smaller batches.
    ReadRecords {
        /// Number of photons in the batch.
        photons: u32,
    },
    /// Reads the counters and decides whether the pass is kept. The commands that follow add to
    /// the results of earlier passes, so the pass must not be abandoned after this.
    Commit,
}

/// Stage of a pass.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// Traces eye paths to visible points.
    EyeTrace,
    /// Traces eye paths for the AOVs.
    AovTrace,
    /// Traces photons to records.
    PhotonTrace,
    /// Sorts the records into the grid.
    BuildGrid,
    /// Gathers photons at visible points.
    Gather,
    /// Adds the photons' radiance to the layers, by photon class.
    ResolveParts,
    /// Adds the pass to the film.
    Resolve,
}

impl Stage {
    /// Kernels that implement the stage on a GPU or a software driver.
    pub const fn kernels(self) -> &'static [Kernel] {
        match self {
            Self::EyeTrace => &[Kernel::EyeTrace],
            Self::AovTrace => &[Kernel::AovTrace],
            Self::PhotonTrace => &[Kernel::PhotonTrace],
            Self::BuildGrid => &[
                Kernel::GridCount,
                Kernel::GridScanReduce,
                Kernel::GridScanSums,
                Kernel::GridScan,
                Kernel::GridScatter,
                Kernel::GridSort,
                Kernel::GridSortLong,
            ],
            Self::Gather => &[Kernel::Gather],
            Self::ResolveParts => &[Kernel::ResolveParts],
            Self::Resolve => &[Kernel::Resolve],
        }
    }
}

/// One run of a stage over `dispatch.first..dispatch.end`.
#[derive(Clone, Copy, Debug)]
pub struct Step {
    /// Stage to run.
    pub stage: Stage,
    /// Chunk whose buffers it uses.
    pub chunk: u32,
    /// Parameters of the run.
    pub dispatch: Dispatch,
}

/// Width of grid cells in mean radii: smaller cells increase the number of rows visited, larger
/// ones the number of photons tested in vain.
const CELL_RADII: f64 = 1.2;
/// The same for caustic photons with a separate grid: outside of caustics they are sparse, so
/// visiting rows dominates.
const SPARSE_RADII: f64 = 3.0;

impl Plan {
    /// Parameters that all dispatches of pass `pass` share.
    pub fn dispatch(&self, pass: u32) -> Dispatch {
        let scale_sq = self.scale_sq(pass);
        let (pixels, units) = match self.settings.radius {
            // unreachable: a plan's settings contain the chosen radius
            Radius::Auto => (1.0, 0.0),
            Radius::Pixels(p) => (p * self.widening, 0.0),
            Radius::Units(u) => (0.0, u * self.widening / self.unit),
        };
        let split = self.features.has(Feature::Split);
        let bounce_shift = if self.continued != 0 { 2 } else { 1 };
        let wider = if split { self.settings.wider() } else { 1.0 };
        let radius = self.widening * self.probe.radius * scale_sq.sqrt();
        let cell = if split { SPARSE_RADII } else { CELL_RADII } * radius;
        let cell_indirect = CELL_RADII * radius * wider;
        Dispatch {
            pass_number: self.first_pass + pass,
            seed: (self.settings.seed ^ (self.settings.seed >> 32)) as u32,
            key_bits: key_bits(self.settings.max_bounces) + bounce_shift - 1,
            continued: self.continued,
            bounce_shift,
            capacity: self.capacity,
            max_bounces: self.settings.max_bounces,
            eye_samples: self.eye_samples,
            strata: strata(self.eye_samples),
            mask: self.buckets - 1,
            inv_cell: (1.0 / cell) as Real,
            scale_sq: scale_sq as Real,
            photons: self.settings.photons as Real,
            alpha: self.settings.alpha as Real,
            radius_pixels: pixels as Real,
            radius_units: units as Real,
            radius_max: (self.widening * self.probe.radius_max) as Real,
            passes_done: pass,
            classes: 1 + split as u32,
            indirect_radius: wider as Real,
            inv_cell_indirect: (1.0 / cell_indirect) as Real,
            window_first: self.window_first,
            window_width: self.width,
            points: crate::math::sobol::points(self.first_pass + pass),
            ..Dispatch::zeroed()
        }
    }

    /// Parameters of a pass for its eye paths. Fixed visible points use those of pass 0, regardless
    /// of the render's first pass.
    fn eye_dispatch(&self, common: Dispatch) -> Dispatch {
        if self.settings.method != Method::Ppm {
            return common;
        }
        let points = crate::math::sobol::points(0);
        Dispatch { pass_number: 0, fixed_points: 1, points, ..common }
    }

    /// Commands of pass `pass` of this render, from 0: one list per tile, or a single list. A batch
    /// has `batch_photons` photons, fewer than planned if a batch overflowed.
    ///
    /// If the photons come in one batch, tiles share its grid. Otherwise each tile traces the
    /// photons again.
    pub fn commands(&self, pass: u32, batch_photons: u32) -> Vec<Vec<Command>> {
        let all = 0..self.chunks();
        let tiles = if self.tiled { all.map(|c| c..c + 1).collect() } else { vec![all] };
        let batches = self.settings.photons.div_ceil(batch_photons.max(1));
        let mut tiles: Vec<_> = tiles
            .into_iter()
            .map(|chunks| {
                let trace = chunks.start == 0 || batches > 1;
                self.tile(pass, batch_photons, chunks, trace)
            })
            .collect();
        if let Some(last) = tiles.last_mut() {
            last.extend(self.aov_steps(pass).into_iter().map(Command::Run));
        }
        tiles
    }

    fn tile(&self, pass: u32, batch_photons: u32, chunks: Range<u32>, trace: bool) -> Vec<Command> {
        let common = self.dispatch(pass);
        let eye = self.eye_dispatch(common);
        let mut commands = Vec::new();
        // clear a buffer that tiles reuse once per tile
        let cleared = match (self.is_reused(Buffer::Gathered), chunks.start) {
            (true, _) => chunks.clone(),
            (false, 0) => 0..self.chunks(),
            (false, _) => 0..0,
        };
        commands.extend(cleared.map(|chunk| Command::ClearGathered { chunk }));
        commands.push(Command::ClearCounters);
        let run = |commands: &mut Vec<Command>, stage, chunk, dispatch| {
            commands.push(Command::Run(Step { stage, chunk, dispatch }));
        };
        let ppm = self.settings.method == Method::Ppm;
        if !ppm || pass == self.taken_over || self.tiled {
            for c in chunks.clone() {
                let (chunk_first, end) = self.chunk(c);
                run(&mut commands, Stage::EyeTrace, c, Dispatch { end, chunk_first, ..eye });
            }
            commands.push(Command::ReadEyeRays);
        }
        let mut batch_first = 0;
        while self.features.has(Feature::Photons) && batch_first < self.settings.photons {
            let end = (self.settings.photons - batch_first).min(batch_photons);
            if trace {
                commands.push(Command::ClearRecords);
                let dispatch = Dispatch { end, batch_first, ..common };
                run(&mut commands, Stage::PhotonTrace, 0, dispatch);
                commands.push(Command::ReadRecords { photons: end });
                run(&mut commands, Stage::BuildGrid, 0, common);
            }
            for c in chunks.clone() {
                let (chunk_first, end) = self.chunk(c);
                run(&mut commands, Stage::Gather, c, Dispatch { end, chunk_first, ..common });
            }
            batch_first += end;
        }
        commands.push(Command::Commit);
        for c in chunks {
            let (chunk_first, points) = self.chunk(c);
            let end = points / self.eye_samples;
            let dispatch = Dispatch { end, chunk_first, ..common };
            if self.parts_photons() {
                run(&mut commands, Stage::ResolveParts, c, dispatch);
            }
            run(&mut commands, Stage::Resolve, c, dispatch);
        }
        commands
    }

    /// AOV stages of pass `pass`, one per chunk and eye sample. Empty without AOVs, and under PPM
    /// after the first pass, which reuses the visible points.
    pub fn aov_steps(&self, pass: u32) -> Vec<Step> {
        let ppm = self.settings.method == Method::Ppm;
        if !self.aovs.are_traced() || ppm && pass > 0 {
            return Vec::new();
        }
        let common = self.eye_dispatch(self.dispatch(pass));
        let step = |c, sample| {
            let (chunk_first, points) = self.chunk(c);
            let end = points / self.eye_samples;
            let passes_done = common.passes_done * self.eye_samples + sample;
            let dispatch = Dispatch { end, chunk_first, passes_done, ..common };
            Step { stage: Stage::AovTrace, chunk: c, dispatch }
        };
        let samples = 0..self.eye_samples;
        (0..self.chunks())
            .flat_map(|c| samples.clone().map(move |sample| step(c, sample)))
            .collect()
    }

    /// Kernels and dispatches that implement a step on a GPU or a software driver.
    pub fn lowered(&self, step: &Step) -> impl Iterator<Item = (Kernel, Dispatch)> {
        let (dispatch, capacity, buckets) = (step.dispatch, self.capacity, self.buckets);
        step.stage.kernels().iter().map(move |kernel| {
            let end = match kernel.info().over {
                Over::VisiblePoints | Over::Pixels | Over::Photons => dispatch.end,
                Over::Records => capacity,
                Over::Buckets => buckets,
                Over::Blocks => buckets / SCAN_BLOCK,
            };
            (*kernel, Dispatch { end, ..dispatch })
        })
    }

    /// Steps of a pass, without the other commands.
    pub fn steps(&self, pass: u32) -> Vec<Step> {
        let commands = self.commands(pass, self.batch_photons).into_iter().flatten();
        let step = |command| match command {
            Command::Run(step) => Some(step),
            Command::ClearGathered { .. }
            | Command::ClearCounters
            | Command::ClearRecords
            | Command::ReadEyeRays
            | Command::ReadRecords { .. }
            | Command::Commit => None,
        };
        commands.filter_map(step).collect()
    }

    /// Kernels that the plan needs, with the chunks they run on.
    pub fn kernels(&self) -> BTreeSet<(Kernel, u32)> {
        let kernels = |step: Step| step.stage.kernels().iter().map(move |k| (*k, step.chunk));
        self.steps(0).into_iter().flat_map(kernels).collect()
    }
}

/// Number of columns in the most nearly square arrangement of `n` strata.
fn strata(n: u32) -> u32 {
    (1..=n).filter(|c| n.is_multiple_of(*c) && c * c <= n).max().unwrap_or(1)
}
