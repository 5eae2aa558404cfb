//! A pass as data: which kernels run, over how many items, with which buffers and numbers. Engines carry it out.
//!
//! The picture is cut into chunks of visible points and the photons into batches, so that no buffer passes a
//! device's binding limit. Neither changes a result but for the grouping of the photons' sum, and batches are the
//! same for every engine.

use super::features::Features;
use super::kernels::aov_trace::AovPixel;
use super::kernels::bytes::{FILM_BYTES, STATISTICS_BYTES};
use super::kernels::records::*;
use super::kernels::resolve_parts::PartsPixel;
use super::pack::{Objects, Packed};
use super::probe::{Probe, probe};
use super::readout::Readout;
use super::real::Real;
use crate::engine::{EngineError, State};
use crate::film::{ErrorMap, Picture, Rejections};
use crate::radius::Automatic;
use crate::scene::{Aov, Aovs, Film};
use crate::settings::{Method, Radius, RadiusRule, RenderSettings};
use crate::stage::stage;
use bytemuck::Zeroable;
use glam::DVec3;

/// A kernel: the stem of its shader file, of its Rust twin and its entry point.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Kernel {
    /// Eye paths to visible points.
    EyeTrace,
    /// Eye paths to what a picture shows beside radiance.
    AovTrace,
    /// Photon paths to records.
    PhotonTrace,
    /// Records per bucket.
    GridCount,
    /// Sums of blocks of buckets.
    GridScanReduce,
    /// Exclusive prefix sums of the blocks' sums.
    GridScanSums,
    /// Exclusive prefix sums of the buckets.
    GridScan,
    /// Records into bucket order.
    GridScatter,
    /// Each short bucket into the order of its keys.
    GridSort,
    /// Each long one.
    GridSortLong,
    /// Density estimates.
    Gather,
    /// What photons bring, by the way they came.
    ResolveParts,
    /// Estimates into the film.
    Resolve,
}

/// Buckets that one workgroup of the scan kernels covers; the same number of blocks is the most there may be.
pub const SCAN_BLOCK: u32 = 4096;
/// Buckets that one workgroup of [`Kernel::GridSortLong`] looks through.
pub const SORT_BUCKETS: u32 = 256;
/// Bytes that one storage binding may have on every device (WebGPU's default limit).
pub const BINDING_LIMIT: u64 = 128 << 20;
/// Most visible points in a chunk.
const CHUNK_POINTS: u32 = 1 << 20;
/// Most records that a batch may store.
const CAPACITY_MAX: u32 = 1 << 22;
/// Grid cells are this many mean radii wide.
const CELL_RADII: f64 = 2.0;

impl Kernel {
    /// All kernels, in the order of a pass.
    pub const ALL: [Self; 13] = [
        Self::EyeTrace,
        Self::AovTrace,
        Self::PhotonTrace,
        Self::GridCount,
        Self::GridScanReduce,
        Self::GridScanSums,
        Self::GridScan,
        Self::GridScatter,
        Self::GridSort,
        Self::GridSortLong,
        Self::Gather,
        Self::ResolveParts,
        Self::Resolve,
    ];

    /// File stem and entry point.
    pub fn stem(self) -> &'static str {
        match self {
            Self::EyeTrace => "eye_trace",
            Self::AovTrace => "aov_trace",
            Self::PhotonTrace => "photon_trace",
            Self::GridCount => "grid_count",
            Self::GridScanReduce => "grid_scan_reduce",
            Self::GridScanSums => "grid_scan_sums",
            Self::GridScan => "grid_scan",
            Self::GridScatter => "grid_scatter",
            Self::GridSort => "grid_sort",
            Self::GridSortLong => "grid_sort_long",
            Self::Gather => "gather",
            Self::ResolveParts => "resolve_parts",
            Self::Resolve => "resolve",
        }
    }

    /// The buffers it binds beside the scene's (see [`Plan::buffers`]) and whether it writes them.
    pub fn buffers(self, features: &Features) -> Vec<(&'static str, bool)> {
        let mut list = match self {
            Self::EyeTrace => vec![("visible_points", true), ("counters", true)],
            Self::AovTrace => vec![("aovs", true), ("counters", true)],
            Self::PhotonTrace => vec![("records", true), ("counters", true)],
            Self::GridCount => vec![("records", false), ("counters", true), ("counts", true)],
            Self::GridScanReduce => vec![("counts", true), ("block_sums", true)],
            Self::GridScanSums => vec![("block_sums", true)],
            Self::GridScan => vec![("counts", true), ("block_sums", true), ("starts", true)],
            Self::GridScatter => {
                vec![
                    ("records", false),
                    ("counters", true),
                    ("counts", true),
                    ("starts", false),
                    ("order", true),
                ]
            }
            Self::GridSort => {
                vec![("records", false), ("starts", false), ("order", true), ("sorted", true)]
            }
            Self::GridSortLong => vec![
                ("records", false),
                ("counters", true),
                ("starts", false),
                ("order", true),
                ("sorted", true),
            ],
            Self::Gather => {
                vec![
                    ("visible_points", false),
                    ("counters", true),
                    ("starts", false),
                    ("sorted", false),
                    ("gathered", true),
                ]
            }
            Self::ResolveParts => vec![("visible_points", false), ("gathered", false), ("parts", true)],
            Self::Resolve => vec![("visible_points", false), ("gathered", false), ("film", true)],
        };
        if features.has("local") && matches!(self, Self::Gather | Self::ResolveParts | Self::Resolve) {
            list.push(("statistics", self == Self::Resolve));
        }
        list
    }

    /// Whether it reads the flattened scene.
    pub fn reads_scene(self) -> bool {
        matches!(self, Self::EyeTrace | Self::AovTrace | Self::PhotonTrace)
    }
}

/// One dispatch of a kernel over `dispatch.first..dispatch.end`.
#[derive(Clone, Copy, Debug)]
pub struct Step {
    /// What runs.
    pub kernel: Kernel,
    /// Which chunk's `visible_points`, `gathered`, `statistics` and `film` it binds.
    pub chunk: u32,
    /// Its numbers. Kernels over records run over the whole capacity and stop at the count in `counters`.
    pub dispatch: Dispatch,
}

/// What a render of one scene with one set of settings does.
#[derive(Clone, Debug)]
pub struct Plan {
    /// What the scene and the settings need.
    pub features: Features,
    /// The settings, with a radius in the place of "auto".
    pub settings: RenderSettings,
    /// Pixels per row of the window that is rendered.
    pub width: u32,
    /// Pixels of the window.
    pub pixels: u32,
    /// The window's first pixel, counted in the whole picture.
    pub window_first: u32,
    /// What is found beside radiance.
    pub aovs: Aovs,
    /// Visible points per pixel.
    pub eye_samples: u32,
    /// Visible points per chunk, a multiple of `eye_samples`.
    pub chunk_points: u32,
    /// Photons per batch.
    pub batch_photons: u32,
    /// Records that the buffers hold.
    pub capacity: u32,
    /// Buckets of the hash grid, a power of two.
    pub buckets: u32,
    /// What was found by looking at the scene before planning.
    pub probe: Probe,
    /// Radius of the first family of photons over [`RenderSettings::radius`]: one, or where diffuse surfaces have scattered
    /// all that are stored [`RenderSettings::indirect_radius`].
    pub widening: f64,
    /// The world point at the scene's origin.
    pub center: DVec3,
    /// Which shape of the scene a reference belongs to, where that is asked for.
    pub objects: Objects,
    /// World units in one scene unit.
    pub unit: f64,
    /// Scene radiance times this is world radiance.
    pub radiance_unit: f64,
    /// Number of the render's first pass; all others count from there.
    pub first_pass: u32,
    /// Passes that the film held when the engine took over.
    pub taken_over: u32,
}

impl Plan {
    /// Plans a render.
    pub fn new(packed: &Packed, settings: &RenderSettings) -> Self {
        let _stage = stage("plan");
        let features = Features::of(&packed.scene, settings);
        let probe = probe(packed, settings);
        let chosen = probe.automatic.map_or(settings.radius, |automatic| Radius::Pixels(automatic.pixels));
        let wider = settings.indirect_radius.or(probe.automatic.map(|a| a.indirect)).unwrap_or(1.0);
        let settings = &RenderSettings { radius: chosen, indirect_radius: Some(wider), ..settings.clone() };
        let widening = if features.has("first") { 1.0 } else { wider };
        let camera = &packed.scene.camera;
        let eye_samples = if settings.method == Method::Ppm { settings.eye_samples } else { 1 };
        let wanted = (settings.photons as f64 * probe.records_per_photon * 1.25).max(1024.0);
        let capacity = (wanted.min(CAPACITY_MAX as f64) as u32).next_power_of_two().max(SCAN_BLOCK);
        let fit = (capacity as f64 * 0.8 / probe.records_per_photon.max(1e-3)) as u64;
        // a key has 32 bits for (photon of the batch, bounce, family)
        let key_room = 1u64 << (32 - key_bits(settings.max_bounces));
        Self {
            features,
            settings: settings.clone(),
            width: camera.width,
            pixels: camera.width * camera.height,
            window_first: 0,
            aovs: Aovs::default(),
            eye_samples,
            chunk_points: CHUNK_POINTS / eye_samples * eye_samples,
            batch_photons: fit.min(key_room).clamp(1, settings.photons as u64) as u32,
            capacity,
            buckets: capacity,
            probe,
            widening,
            center: packed.center,
            objects: packed.objects.clone(),
            unit: packed.unit,
            radiance_unit: packed.radiance_unit,
            first_pass: 0,
            taken_over: 0,
        }
    }

    /// The same for a film: for its window alone, and with what it asks for beside radiance.
    pub fn on(mut self, film: &Film) -> Self {
        if let Some([x0, y0, x1, y1]) = film.window {
            self.window_first = y0 * film.width + x0;
            self.width = x1 - x0;
            self.pixels = (x1 - x0) * (y1 - y0);
        }
        self.aovs = film.aovs;
        if self.aovs.has(Aov::Direct) && self.settings.method != Method::Path {
            self.features = self.features.with("direct_layer");
        }
        // what tells caustics from the rest is their family
        if self.parts_photons() && self.features.has("first") {
            self.features = self.features.with("split");
        }
        self
    }

    /// Whether what photons bring is parted by the way they came.
    pub fn parts_photons(&self) -> bool {
        self.features.has("photons") && (self.aovs.has(Aov::Caustic) || self.aovs.has(Aov::Indirect))
    }

    /// Plans to go on from `state`.
    ///
    /// # Errors
    /// Where the plan has no use for it.
    pub fn take_over(&mut self, state: &State) -> Result<(), EngineError> {
        let local = self.features.has("local") && self.settings.method != Method::Path;
        if local && state.first_pass > 0 {
            let text =
                "under the local rule a pass needs the photon counts of all before it: start with pass 0";
            return Err(EngineError::Unsupported(text.into()));
        }
        let points = if local { self.pixels as usize * self.eye_samples as usize } else { 0 };
        let wanted =
            (8 * size_of::<Real>() as u32, self.pixels as usize * FILM_BYTES, points * STATISTICS_BYTES);
        if state.passes > 0 && (state.bits, state.film.len(), state.statistics.len()) != wanted {
            let text = "what is to be gone on from is of another picture size, radius rule or precision";
            return Err(EngineError::Unsupported(text.into()));
        }
        if state.passes > 0 && self.lacks_layers(&state.layers) {
            let text = "what is to be gone on from lacks the layers that are asked for";
            return Err(EngineError::Unsupported(text.into()));
        }
        (self.first_pass, self.taken_over) = (state.first_pass, state.passes);
        Ok(())
    }

    /// What the film says.
    pub fn readout(&self) -> Readout {
        Readout { width: self.width, unit: self.radiance_unit }
    }

    /// Why the radius is what it is, where the settings left it open and photons are gathered at all.
    pub fn told_radius(&self) -> Option<Automatic> {
        self.probe.automatic.filter(|_| self.features.has("photons"))
    }

    /// Number of chunks.
    pub fn chunks(&self) -> u32 {
        let points = self.pixels as u64 * self.eye_samples as u64;
        points.div_ceil(self.chunk_points as u64) as u32
    }

    /// First visible point of a chunk and their number.
    pub fn chunk(&self, chunk: u32) -> (u32, u32) {
        let first = chunk * self.chunk_points;
        (first, (self.pixels * self.eye_samples - first).min(self.chunk_points))
    }

    /// Squared radius in pass `pass` of this render over the squared start radius; the local rule's is the plan's guess,
    /// which only sets the cell size.
    pub fn scale_sq(&self, pass: u32) -> f64 {
        match self.settings.radius_rule {
            RadiusRule::Fixed => 1.0,
            _ => global_scale_sq(self.first_pass as u64 + pass as u64 + 1, self.settings.alpha),
        }
    }

    /// The numbers that all dispatches of pass `pass` share.
    pub fn dispatch(&self, pass: u32) -> Dispatch {
        let scale_sq = self.scale_sq(pass);
        let (pixels, units) = match self.settings.radius {
            // Never: a plan's settings name what was chosen.
            Radius::Auto => (1.0, 0.0),
            Radius::Pixels(p) => (p * self.widening, 0.0),
            Radius::Units(u) => (0.0, u * self.widening / self.unit),
        };
        let split = self.features.has("split");
        let wider = if split { self.settings.wider() } else { 1.0 };
        let cell = CELL_RADII * self.widening * self.probe.radius * scale_sq.sqrt();
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
            inv_cell_indirect: (1.0 / (cell * wider)) as Real,
            window_first: self.window_first,
            window_width: self.width,
            points: crate::sobol::points(self.first_pass + pass),
            ..Dispatch::zeroed()
        }
    }

    /// The numbers of a pass for its eye paths: fixed visible points are those of pass 0, whoever makes the first pass.
    fn eye_dispatch(&self, common: Dispatch) -> Dispatch {
        if self.settings.method != Method::Ppm {
            return common;
        }
        Dispatch { pass_number: 0, points: crate::sobol::points(0), ..common }
    }

    /// Pass `pass` of this render, from 0, with `batch_photons` photons a batch (fewer than planned when a batch overflowed). Before its
    /// first step an engine clears `gathered`, before each [`Kernel::PhotonTrace`] the record counter. The steps from the
    /// first [`Kernel::ResolveParts`] or [`Kernel::Resolve`] on add to what passes before have found.
    pub fn steps(&self, pass: u32, batch_photons: u32) -> Vec<Step> {
        let common = self.dispatch(pass);
        let mut steps = Vec::new();
        let mut step = |kernel, chunk, dispatch| steps.push(Step { kernel, chunk, dispatch });
        let over = |end| Dispatch { end, ..common };
        let ppm = self.settings.method == Method::Ppm;
        let eye = self.eye_dispatch(common);
        if !ppm || pass == self.taken_over {
            for c in 0..self.chunks() {
                let (chunk_first, end) = self.chunk(c);
                step(Kernel::EyeTrace, c, Dispatch { end, chunk_first, ..eye });
            }
        }
        let mut batch_first = 0;
        while self.features.has("photons") && batch_first < self.settings.photons {
            let end = (self.settings.photons - batch_first).min(batch_photons);
            step(Kernel::PhotonTrace, 0, Dispatch { end, batch_first, ..common });
            step(Kernel::GridCount, 0, over(self.capacity));
            step(Kernel::GridScanReduce, 0, over(self.buckets));
            step(Kernel::GridScanSums, 0, over(self.buckets / SCAN_BLOCK));
            step(Kernel::GridScan, 0, over(self.buckets));
            step(Kernel::GridScatter, 0, over(self.capacity));
            step(Kernel::GridSort, 0, over(self.buckets));
            step(Kernel::GridSortLong, 0, over(self.buckets));
            for c in 0..self.chunks() {
                let (chunk_first, end) = self.chunk(c);
                step(Kernel::Gather, c, Dispatch { end, chunk_first, ..common });
            }
            batch_first += end;
        }
        for c in 0..self.chunks() {
            let (chunk_first, points) = self.chunk(c);
            let end = points / self.eye_samples;
            if self.parts_photons() {
                step(Kernel::ResolveParts, c, Dispatch { end, chunk_first, ..common });
            }
            step(Kernel::Resolve, c, Dispatch { end, chunk_first, ..common });
        }
        steps.extend(self.aov_steps(pass));
        steps
    }

    /// The steps of [`Kernel::AovTrace`] in pass `pass`, one for each sample of the pixels that the pass traces eye paths
    /// through.
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
        (0..self.chunks()).flat_map(|c| samples.clone().map(move |sample| step(c, sample))).collect()
    }

    /// Name and bytes of every buffer beside the scene's; those of chunks for the largest chunk.
    pub fn buffers(&self) -> Vec<(&'static str, u64)> {
        let points = self.chunk(0).1 as u64;
        let pixels = points / self.eye_samples as u64;
        let records = self.capacity as u64;
        let mut list = vec![
            ("visible_points", points * size_of::<VisiblePoint>() as u64),
            ("film", pixels * size_of::<FilmPixel>() as u64),
            ("gathered", points * size_of::<Gathered>() as u64),
            ("counters", 32),
        ];
        if self.features.has("local") {
            list.push(("statistics", points * size_of::<Statistics>() as u64));
        }
        if self.aovs.are_traced() {
            list.push(("aovs", pixels * size_of::<AovPixel>() as u64));
        }
        if self.parts_photons() {
            list.push(("parts", pixels * size_of::<PartsPixel>() as u64));
        }
        if self.features.has("photons") {
            list.extend([
                ("records", records * size_of::<PhotonRecord>() as u64),
                ("sorted", records * size_of::<PhotonRecord>() as u64),
                ("order", records * 4),
                ("counts", self.buckets as u64 * 4),
                ("starts", (self.buckets as u64 + 1) * 4),
                ("block_sums", (self.buckets / SCAN_BLOCK + 1) as u64 * 4),
            ]);
        }
        list
    }

    /// Typical gather radius of pass `pass` in world units; of the first family, where there are two.
    pub fn radius(&self, pass: u32) -> f64 {
        self.widening * self.probe.radius * self.scale_sq(pass).sqrt() * self.unit
    }

    /// The picture that a film holds, in world units.
    pub fn picture(&self, film: &[FilmPixel]) -> Picture {
        self.readout().picture(film)
    }

    /// What a film after `passes` passes says of its error, in world units.
    pub fn errors(&self, film: &[FilmPixel], passes: u32) -> ErrorMap {
        self.readout().errors(film, passes)
    }

    /// What was left out of the picture that a film holds.
    pub fn rejections(&self, film: &[FilmPixel]) -> Rejections {
        self.readout().rejections(film)
    }
}

/// Bits that hold a bounce number and a family.
fn key_bits(max_bounces: u32) -> u32 {
    33 - max_bounces.leading_zeros()
}

/// Columns of the most nearly square arrangement of `n` strata.
fn strata(n: u32) -> u32 {
    (1..=n).filter(|c| n.is_multiple_of(*c) && c * c <= n).max().unwrap_or(1)
}

/// `r_i^2 / r_1^2 = prod_{k=1}^{i-1} (k + alpha) / (k + 1)` (Knaus & Zwicker 2011, eq. 20), in closed form
/// through the gamma function for large `i`.
pub fn global_scale_sq(i: u64, alpha: f64) -> f64 {
    const DIRECT: u64 = 256;
    let head: f64 = (1..i.min(DIRECT)).map(|k| (k as f64 + alpha) / (k as f64 + 1.0)).product();
    if i <= DIRECT {
        return head;
    }
    // Gamma(i + a) / Gamma(i + 1) over the same at i = DIRECT
    let ratio = |x: f64| ln_gamma(x + alpha) - ln_gamma(x + 1.0);
    head * (ratio(i as f64) - ratio(DIRECT as f64)).exp()
}

/// Stirling's series; good to 1e-15 relative for x >= 100.
fn ln_gamma(x: f64) -> f64 {
    let r = 1.0 / x;
    (x - 0.5) * x.ln() - x + 0.918_938_533_204_672_7 + r / 12.0 - r * r * r / 360.0 + r.powi(5) / 1260.0
}
