//! A pass as data: a list of commands over declared buffers and kernels, which engines execute.
//!
//! The image is divided into chunks of visible points and the photons into batches, so that no
//! buffer exceeds a device's binding limit. Chunks do not change the result; batches only change
//! the grouping of the sum over photons, and are the same for every engine. If memory is scarce,
//! chunks become tiles, which use one set of buffers in turn.

mod buffer;
mod commands;
pub mod features;
pub mod film_readback;
mod kernel;
pub mod layers;
mod memory;
mod scale;

use super::kernels::bytes::{FILM_BYTES, STATISTICS_BYTES};
use super::kernels::records::{CONTINUED, FOCUSED, FilmPixel};
use super::lights::LightKind;
use super::math::pixel_filter::FilterKind;
use super::pack::{Objects, PackedScene};
use super::pilots::{Probe, probe};
use super::real::Real;
use super::tables::{Camera, Light, SceneTables};
use crate::engine::{Cancel, EngineError, State};
use crate::film::{ErrorMap, Picture, Rejections};
use crate::prepare::radius::Automatic;
use crate::scene::settings::{Method, Radius, RenderSettings};
use crate::scene::{Aov, Aovs, Film};
use features::{Feature, Features};
use film_readback::Readout;
use glam::DVec3;

pub use buffer::{Buffer, BufferInfo, Cleared, Extent};
pub use commands::{Command, Stage, Step};
pub use kernel::{Access, Kernel, KernelInfo, Over, SCAN_BLOCK, SORT_BUCKETS, Use};
pub use memory::{BufferPlace, scene_bytes, scene_tables};
pub use scale::global_scale_sq;

/// Greatest size of a storage binding that every device supports, bytes (WebGPU's default limit).
pub const BINDING_LIMIT: u64 = 128 << 20;
/// Greatest number of visible points in a chunk.
const CHUNK_POINTS: u32 = 1 << 20;
/// Greatest number of records that a batch may store.
const CAPACITY_MAX: u32 = 1 << 22;
/// Number of grid buckets per record of the capacity: with fewer, readers meet more photons of
/// other rows.
const BUCKETS: u32 = 2;

/// Plan of a render: one scene with one set of settings.
#[derive(Clone, Debug)]
pub struct Plan {
    /// Features that the scene and the settings require.
    pub features: Features,
    /// Settings, with a chosen radius in place of "auto".
    pub settings: RenderSettings,
    /// Number of pixels per row of the render window.
    pub width: u32,
    /// Number of pixels of the window.
    pub pixels: u32,
    /// First pixel of the window, as an index into the full image.
    pub window_first: u32,
    /// AOVs to compute in addition to radiance.
    pub aovs: Aovs,
    /// See [`Dispatch::continued`](super::kernels::records::Dispatch::continued).
    pub continued: u32,
    /// Number of visible points per pixel.
    pub eye_samples: u32,
    /// Number of visible points per chunk, a multiple of `eye_samples`.
    pub chunk_points: u32,
    /// True if chunks are tiles: each in turn goes through all steps of a pass and reuses the
    /// buffers of the previous one for temporary data.
    pub tiled: bool,
    /// Number of photons per batch.
    pub batch_photons: u32,
    /// Capacity of the record buffers.
    pub capacity: u32,
    /// Number of buckets of the hash grid, a power of two.
    pub buckets: u32,
    /// Results of the probe of the scene before planning.
    pub probe: Probe,
    /// Radius of the first class of photons over [`RenderSettings::radius`]:
    /// [`RenderSettings::indirect_radius`] if all stored photons have been scattered by diffuse
    /// surfaces, else one.
    pub widening: f64,
    /// World point at the origin of scene space.
    pub center: DVec3,
    /// Maps references to shapes of the scene file, if requested.
    pub objects: Objects,
    /// World units per scene unit.
    pub unit: f64,
    /// Factor from scene radiance to world radiance.
    pub radiance_unit: f64,
    /// Greatest luminance that eye paths may meet after they were scattered, world units.
    pub glint: f64,
    /// Number of the render's first pass; pass numbers count from it.
    pub first_pass: u32,
    /// Number of passes in the film when the engine took over a saved state.
    pub taken_over: u32,
    /// Cancellation flag, checked between the steps of a pass and on GPUs between submissions.
    pub cancel: Cancel,
}

impl Plan {
    /// Probes the scene and plans a render.
    pub fn probed(packed: &PackedScene, settings: &RenderSettings) -> Self {
        Self::new(packed, settings, probe(packed, settings))
    }

    /// Plans a render. `probe` holds the measurements of the scene with these settings.
    pub fn new(packed: &PackedScene, settings: &RenderSettings, probe: Probe) -> Self {
        let features = Features::of(&packed.tables, settings);
        let chosen =
            probe.automatic.map_or(settings.radius, |automatic| Radius::Pixels(automatic.pixels));
        let wider = settings.indirect_radius.or(probe.automatic.map(|a| a.indirect)).unwrap_or(1.0);
        let settings =
            &RenderSettings { radius: chosen, indirect_radius: Some(wider), ..settings.clone() };
        let found = features.has(Feature::Specular) || features.has(Feature::Continued);
        let widening = if features.has(Feature::First) { 1.0 } else { wider };
        let camera = &packed.tables.camera;
        let eye_samples = if settings.method == Method::Ppm { settings.eye_samples } else { 1 };
        let (capacity, batch_photons) = batch(settings, &probe);
        Self {
            features,
            continued: continued(&packed.tables, features),
            settings: settings.clone(),
            width: camera.width,
            pixels: camera.width * camera.height,
            window_first: 0,
            aovs: Aovs::default(),
            eye_samples,
            chunk_points: CHUNK_POINTS / eye_samples * eye_samples,
            tiled: false,
            batch_photons,
            capacity,
            buckets: BUCKETS * capacity,
            probe,
            widening,
            center: packed.center,
            objects: packed.objects.clone(),
            unit: packed.unit,
            radiance_unit: packed.radiance_unit,
            glint: if found { packed.brightest * filter_peak(camera) } else { 0.0 },
            first_pass: 0,
            taken_over: 0,
            cancel: Cancel::default(),
        }
    }

    /// Returns the plan with batches of at most `photons` photons.
    pub fn with_batch(mut self, photons: u32) -> Self {
        self.settings.batch = Some(photons);
        self.in_batches()
    }

    /// Recomputes the batches from the plan's settings.
    fn in_batches(mut self) -> Self {
        (self.capacity, self.batch_photons) = batch(&self.settings, &self.probe);
        self.buckets = BUCKETS * self.capacity;
        self
    }

    /// Restricts the plan to the film's window and adds the film's AOVs.
    pub fn on(mut self, film: &Film) -> Self {
        if let Some([x0, y0, x1, y1]) = film.window {
            self.window_first = y0 * film.width + x0;
            self.width = x1 - x0;
            self.pixels = (x1 - x0) * (y1 - y0);
        }
        self.aovs = film.aovs;
        if self.aovs.has(Aov::Direct) && self.settings.method != Method::Path {
            self.features = self.features.with(Feature::DirectLayer);
        }
        // the photon class distinguishes caustics from the rest
        if self.parts_photons() && self.features.has(Feature::First) {
            self.features = self.features.with(Feature::Split);
        }
        self
    }

    /// Returns true if photons are accumulated separately by class.
    pub fn parts_photons(&self) -> bool {
        self.features.has(Feature::Photons)
            && (self.aovs.has(Aov::Caustic) || self.aovs.has(Aov::Indirect))
    }

    /// Continues from `state`.
    ///
    /// # Errors
    /// The state does not fit the plan.
    pub fn take_over(&mut self, state: &State) -> Result<(), EngineError> {
        let local = self.features.has(Feature::Local) && self.settings.method != Method::Path;
        if local && state.first_pass > 0 {
            let text = "under the local rule a pass needs the photon counts of all before it: start with pass 0";
            return Err(EngineError::Unsupported(text.into()));
        }
        let points = if local { self.pixels as usize * self.eye_samples as usize } else { 0 };
        let wanted = (
            8 * size_of::<Real>() as u32,
            self.pixels as usize * FILM_BYTES,
            points * STATISTICS_BYTES,
        );
        if state.passes > 0 && (state.bits, state.film.len(), state.statistics.len()) != wanted {
            let text = "the checkpoint has a different image size, radius rule or precision";
            return Err(EngineError::Unsupported(text.into()));
        }
        if state.passes > 0 && self.lacks_layers(&state.layers) {
            let text = "the checkpoint lacks layers that this render needs";
            return Err(EngineError::Unsupported(text.into()));
        }
        (self.first_pass, self.taken_over) = (state.first_pass, state.passes);
        Ok(())
    }

    /// Conversion of the film to results in world units.
    pub fn readout(&self) -> Readout {
        Readout { width: self.width, unit: self.radiance_unit, glint: self.glint }
    }

    /// Explanation of the automatically chosen radius; `None` if the settings fix it or no photons
    /// are gathered.
    pub fn automatic_radius(&self) -> Option<Automatic> {
        self.probe.automatic.filter(|_| self.features.has(Feature::Photons))
    }

    /// Number of chunks of the image.
    pub fn chunks(&self) -> u32 {
        let points = self.pixels as u64 * self.eye_samples as u64;
        points.div_ceil(self.chunk_points as u64) as u32
    }

    /// First visible point of a chunk, and their number.
    pub fn chunk(&self, chunk: u32) -> (u32, u32) {
        let first = chunk * self.chunk_points;
        (first, (self.pixels * self.eye_samples - first).min(self.chunk_points))
    }

    /// Image in a film, in world units.
    pub fn picture(&self, film: &[FilmPixel]) -> Picture {
        self.readout().picture(film)
    }

    /// Error estimate of a film after `passes` passes, in world units.
    pub fn errors(&self, film: &[FilmPixel], passes: u32) -> ErrorMap {
        self.readout().errors(film, passes)
    }

    /// Counts of the passes that were left out of the image in a film.
    pub fn rejections(&self, film: &[FilmPixel]) -> Rejections {
        self.readout().rejections(film)
    }
}

/// Greatest weight of a sample in the pixel filter.
fn filter_peak(camera: &Camera) -> f64 {
    match FilterKind::of(camera.filter_kind) {
        FilterKind::Pixel | FilterKind::Box | FilterKind::Tent | FilterKind::Gaussian => 1.0,
        FilterKind::Mitchell => (f64::from(camera.filter_size) / 3.0).powi(2),
    }
}

/// See [`Dispatch::continued`](super::kernels::records::Dispatch::continued).
fn continued(scene: &SceneTables, features: Features) -> u32 {
    if !features.has(Feature::Continued) {
        return 0;
    }
    // without shadow rays, photons carry the light of lamps, too
    if !features.has(Feature::Specular) && features.has(Feature::Sampled) {
        return CONTINUED;
    }
    let extended = |light: &Light| LightKind::of(light.kind).is_extended();
    if scene.lights.iter().all(extended) { CONTINUED } else { CONTINUED | FOCUSED }
}

/// Capacity of the record buffers, and number of photons per batch.
fn batch(settings: &RenderSettings, probe: &Probe) -> (u32, u32) {
    let most = settings.batch.unwrap_or(u32::MAX).clamp(1, settings.photons.max(1));
    let wanted = (most as f64 * probe.records_per_photon * 1.25).max(1024.0);
    let capacity = (wanted.min(CAPACITY_MAX as f64) as u32).next_power_of_two().max(SCAN_BLOCK);
    let fit = (capacity as f64 * 0.8 / probe.records_per_photon.max(1e-3)) as u64;
    // a key has 32 bits for (photon of the batch, bounce, class)
    let key_room = 1u64 << (32 - key_bits(settings.max_bounces));
    (capacity, fit.min(key_room).clamp(1, most as u64) as u32)
}

/// Number of bits that store a bounce number and a class.
fn key_bits(max_bounces: u32) -> u32 {
    33 - max_bounces.leading_zeros()
}
