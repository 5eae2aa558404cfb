//! A pass as data: a list of commands over declared buffers and kernels, which engines execute.
//!
//! The picture is cut into chunks of visible points and the photons into batches, so that no buffer
//! passes a device's binding limit. Neither changes a result but for the grouping of the photons'
//! sum, and batches are the same for every engine. Where memory is scarce chunks become tiles,
//! which take turns with one set of buffers.

mod buffer;
mod commands;
pub mod features;
pub mod film_readback;
mod kernel;
pub mod layers;
mod memory;
mod scale;

use super::kernels::bytes::{FILM_BYTES, STATISTICS_BYTES};
use super::kernels::records::FilmPixel;
use super::pack::{Objects, Packed};
use super::pilots::{Probe, probe};
use super::real::Real;
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

/// Bytes that one storage binding may have on every device (WebGPU's default limit).
pub const BINDING_LIMIT: u64 = 128 << 20;
/// Most visible points in a chunk.
const CHUNK_POINTS: u32 = 1 << 20;
/// Most records that a batch may store.
const CAPACITY_MAX: u32 = 1 << 22;
/// Buckets of the grid for every record that there may be: fewer, and readers meet more photons of
/// other rows.
const BUCKETS: u32 = 2;

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
    /// What is found in addition to radiance.
    pub aovs: Aovs,
    /// Visible points per pixel.
    pub eye_samples: u32,
    /// Visible points per chunk, a multiple of `eye_samples`.
    pub chunk_points: u32,
    /// Whether chunks are tiles: one after another goes through all steps of a pass, with the
    /// buffers of the one before for what lives no longer than that.
    pub tiled: bool,
    /// Photons per batch.
    pub batch_photons: u32,
    /// Records that the buffers hold.
    pub capacity: u32,
    /// Buckets of the hash grid, a power of two.
    pub buckets: u32,
    /// What was found by looking at the scene before planning.
    pub probe: Probe,
    /// Radius of the first class of photons over [`RenderSettings::radius`]: one, or where diffuse
    /// surfaces have scattered all that are stored [`RenderSettings::indirect_radius`].
    pub widening: f64,
    /// The world point at the scene's origin.
    pub center: DVec3,
    /// Which shape of the scene a reference belongs to, where that is asked for.
    pub objects: Objects,
    /// World units in one scene unit.
    pub unit: f64,
    /// Scene radiance times this is world radiance.
    pub radiance_unit: f64,
    /// Luminance of the brightest thing that eye paths may meet by mirrors or through glass, world
    /// units.
    pub glint: f64,
    /// Number of the render's first pass; all others count from there.
    pub first_pass: u32,
    /// Passes that the film held when the engine took over.
    pub taken_over: u32,
    /// Looked at between the steps of a pass, and on GPUs between submissions.
    pub cancel: Cancel,
}

impl Plan {
    /// Probes the scene and plans a render.
    pub fn probed(packed: &Packed, settings: &RenderSettings) -> Self {
        Self::new(packed, settings, probe(packed, settings))
    }

    /// Plans a render. `probe` holds the measurements of the scene with these settings.
    pub fn new(packed: &Packed, settings: &RenderSettings, probe: Probe) -> Self {
        let features = Features::of(&packed.scene, settings);
        let chosen =
            probe.automatic.map_or(settings.radius, |automatic| Radius::Pixels(automatic.pixels));
        let wider = settings.indirect_radius.or(probe.automatic.map(|a| a.indirect)).unwrap_or(1.0);
        let settings =
            &RenderSettings { radius: chosen, indirect_radius: Some(wider), ..settings.clone() };
        let specular = features.has(Feature::Specular);
        let widening = if features.has(Feature::First) { 1.0 } else { wider };
        let camera = &packed.scene.camera;
        let eye_samples = if settings.method == Method::Ppm { settings.eye_samples } else { 1 };
        let (capacity, batch_photons) = batch(settings, &probe);
        Self {
            features,
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
            glint: if specular { packed.brightest } else { 0.0 },
            first_pass: 0,
            taken_over: 0,
            cancel: Cancel::default(),
        }
    }

    /// The same with batches of at most so many photons.
    pub fn with_batch(mut self, photons: u32) -> Self {
        self.settings.batch = Some(photons);
        self.in_batches()
    }

    /// The same with the batches that its settings ask for.
    fn in_batches(mut self) -> Self {
        (self.capacity, self.batch_photons) = batch(&self.settings, &self.probe);
        self.buckets = BUCKETS * self.capacity;
        self
    }

    /// The same for a film: for its window alone, and with what it asks for in addition to
    /// radiance.
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
        // what tells caustics from the rest is their class
        if self.parts_photons() && self.features.has(Feature::First) {
            self.features = self.features.with(Feature::Split);
        }
        self
    }

    /// Whether what photons bring is parted by the way they came.
    pub fn parts_photons(&self) -> bool {
        self.features.has(Feature::Photons)
            && (self.aovs.has(Aov::Caustic) || self.aovs.has(Aov::Indirect))
    }

    /// Plans to go on from `state`.
    ///
    /// # Errors
    /// Where the plan has no use for it.
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

    /// What the film says.
    pub fn readout(&self) -> Readout {
        Readout { width: self.width, unit: self.radiance_unit, glint: self.glint }
    }

    /// Why the radius is what it is, where the settings left it open and photons are gathered at
    /// all.
    pub fn automatic_radius(&self) -> Option<Automatic> {
        self.probe.automatic.filter(|_| self.features.has(Feature::Photons))
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

/// Records that the buffers are to hold, and photons per batch.
fn batch(settings: &RenderSettings, probe: &Probe) -> (u32, u32) {
    let most = settings.batch.unwrap_or(u32::MAX).clamp(1, settings.photons.max(1));
    let wanted = (most as f64 * probe.records_per_photon * 1.25).max(1024.0);
    let capacity = (wanted.min(CAPACITY_MAX as f64) as u32).next_power_of_two().max(SCAN_BLOCK);
    let fit = (capacity as f64 * 0.8 / probe.records_per_photon.max(1e-3)) as u64;
    // a key has 32 bits for (photon of the batch, bounce, class)
    let key_room = 1u64 << (32 - key_bits(settings.max_bounces));
    (capacity, fit.min(key_room).clamp(1, most as u64) as u32)
}

/// Bits that hold a bounce number and a class.
fn key_bits(max_bounces: u32) -> u32 {
    33 - max_bounces.leading_zeros()
}
