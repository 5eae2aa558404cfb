//! What is dispatched in a pass, in which order and with which numbers.

use super::super::features::Feature;
use super::super::kernels::records::Dispatch;
use super::super::real::Real;
use super::kernel::{Kernel, SCAN_BLOCK, Step};
use super::{Plan, key_bits};
use crate::settings::{Method, Radius};
use bytemuck::Zeroable;
use std::ops::Range;

/// Grid cells are this many mean radii wide: with smaller ones more rows are visited, with larger
/// ones more photons in vain.
const CELL_RADII: f64 = 1.2;
/// The same for photons that no diffuse surface has scattered, where they are apart: there are few
/// outside of caustics, so that the rows count.
const SPARSE_RADII: f64 = 3.0;

impl Plan {
    /// The numbers that all dispatches of pass `pass` share.
    pub fn dispatch(&self, pass: u32) -> Dispatch {
        let scale_sq = self.scale_sq(pass);
        let (pixels, units) = match self.settings.radius {
            // Never: a plan's settings name what was chosen.
            Radius::Auto => (1.0, 0.0),
            Radius::Pixels(p) => (p * self.widening, 0.0),
            Radius::Units(u) => (0.0, u * self.widening / self.unit),
        };
        let split = self.features.has(Feature::Split);
        let wider = if split { self.settings.wider() } else { 1.0 };
        let radius = self.widening * self.probe.radius * scale_sq.sqrt();
        let cell = if split { SPARSE_RADII } else { CELL_RADII } * radius;
        let cell_indirect = CELL_RADII * radius * wider;
        Dispatch {
            pass_number: self.first_pass + pass,
            seed: (self.settings.seed ^ (self.settings.seed >> 32)) as u32,
            key_bits: key_bits(self.settings.max_bounces),
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
            families: 1 + split as u32,
            indirect_radius: wider as Real,
            inv_cell_indirect: (1.0 / cell_indirect) as Real,
            window_first: self.window_first,
            window_width: self.width,
            points: crate::sobol::points(self.first_pass + pass),
            ..Dispatch::zeroed()
        }
    }

    /// The numbers of a pass for its eye paths: fixed visible points are those of pass 0, whoever
    /// makes the first pass.
    fn eye_dispatch(&self, common: Dispatch) -> Dispatch {
        if self.settings.method != Method::Ppm {
            return common;
        }
        Dispatch { pass_number: 0, points: crate::sobol::points(0), ..common }
    }

    /// Pass `pass` of this render, from 0, with `batch_photons` photons a batch (fewer than planned
    /// when a batch overflowed): all of [`Self::phases`].
    pub fn steps(&self, pass: u32, batch_photons: u32) -> Vec<Step> {
        self.phases(pass, batch_photons).into_iter().flatten().collect()
    }

    /// The same in phases, one or a tile's each. Before the first step of one an engine clears the
    /// `gathered` of its chunks, before each [`Kernel::PhotonTrace`] the record counter. Its steps
    /// from the first [`Kernel::ResolveParts`] or [`Kernel::Resolve`] on add to what passes before
    /// have found. Where photons come in one batch tiles share its grid, else each tile has them
    /// traced anew.
    pub fn phases(&self, pass: u32, batch_photons: u32) -> Vec<Vec<Step>> {
        let all = 0..self.chunks();
        let tiles = if self.tiled { all.map(|c| c..c + 1).collect() } else { vec![all] };
        let batches = self.settings.photons.div_ceil(batch_photons.max(1));
        let mut phases: Vec<_> = tiles
            .into_iter()
            .map(|chunks| {
                let trace = chunks.start == 0 || batches > 1;
                self.phase(pass, batch_photons, chunks, trace)
            })
            .collect();
        if let Some(last) = phases.last_mut() {
            last.extend(self.aov_steps(pass));
        }
        phases
    }

    fn phase(&self, pass: u32, batch_photons: u32, chunks: Range<u32>, trace: bool) -> Vec<Step> {
        let common = self.dispatch(pass);
        let mut steps = Vec::new();
        let mut step = |kernel, chunk, dispatch| steps.push(Step { kernel, chunk, dispatch });
        let over = |end| Dispatch { end, ..common };
        let ppm = self.settings.method == Method::Ppm;
        let eye = self.eye_dispatch(common);
        if !ppm || pass == self.taken_over || self.tiled {
            for c in chunks.clone() {
                let (chunk_first, end) = self.chunk(c);
                step(Kernel::EyeTrace, c, Dispatch { end, chunk_first, ..eye });
            }
        }
        let mut batch_first = 0;
        while self.features.has(Feature::Photons) && batch_first < self.settings.photons {
            let end = (self.settings.photons - batch_first).min(batch_photons);
            if trace {
                step(Kernel::PhotonTrace, 0, Dispatch { end, batch_first, ..common });
                step(Kernel::GridCount, 0, over(self.capacity));
                step(Kernel::GridScanReduce, 0, over(self.buckets));
                step(Kernel::GridScanSums, 0, over(self.buckets / SCAN_BLOCK));
                step(Kernel::GridScan, 0, over(self.buckets));
                step(Kernel::GridScatter, 0, over(self.capacity));
                step(Kernel::GridSort, 0, over(self.buckets));
                step(Kernel::GridSortLong, 0, over(self.buckets));
            }
            for c in chunks.clone() {
                let (chunk_first, end) = self.chunk(c);
                step(Kernel::Gather, c, Dispatch { end, chunk_first, ..common });
            }
            batch_first += end;
        }
        for c in chunks {
            let (chunk_first, points) = self.chunk(c);
            let end = points / self.eye_samples;
            if self.parts_photons() {
                step(Kernel::ResolveParts, c, Dispatch { end, chunk_first, ..common });
            }
            step(Kernel::Resolve, c, Dispatch { end, chunk_first, ..common });
        }
        steps
    }

    /// The steps of [`Kernel::AovTrace`] in pass `pass`, one for each sample of the pixels that the
    /// pass traces eye paths through.
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
            Step { kernel: Kernel::AovTrace, chunk: c, dispatch }
        };
        let samples = 0..self.eye_samples;
        (0..self.chunks())
            .flat_map(|c| samples.clone().map(move |sample| step(c, sample)))
            .collect()
    }
}

/// Columns of the most nearly square arrangement of `n` strata.
fn strata(n: u32) -> u32 {
    (1..=n).filter(|c| n.is_multiple_of(*c) && c * c <= n).max().unwrap_or(1)
}
