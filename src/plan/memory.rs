//! Memory requirement of a plan, and division of a plan so that it fits a limit.

use super::super::kernels::bytes::{FILM_BYTES, STATISTICS_BYTES};
use super::super::kernels::records::PhotonRecord;
use super::super::real::{Real, Vec4};
use super::super::tables::SceneTables;
use super::buffer::Buffer;
use super::features::Feature;
use super::kernel::SCAN_BLOCK;
use super::{CHUNK_POINTS, Plan};
use crate::engine::EngineError;
use crate::film::estimate::PixelError;
use crate::memory::{Memory, OverBudget, Part, total};
use crate::scene::settings::Method;

/// Least number of visible points in a tile: with fewer, a device is idle between steps.
const LEAST_TILE: u32 = 1 << 14;
/// Number of batches up to which smaller batches cost less than more tiles.
const MANY_BATCHES: u32 = 16;
/// Bytes per pixel of a channel of an image file in preparation.
const CHANNEL_BYTES: u64 = 8;
/// Greatest number of bytes read back from a device in one step.
const READING_BYTES: u64 = 16 << 20;

const SCENE: &str = "take coarser meshes or smaller textures";
const PICTURE: &str = "make the picture smaller by --size, or render parts of it by --crop";
const SAMPLES: &str = "lower --eye-samples or --size, or take --radius-rule global";
const LAYERS: &str = "ask for fewer layers by --aov, or make the picture smaller by --size";
const PHOTONS: &str = "lower --photons, or trace them in smaller batches by --batch";

/// Location of a plan's buffers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BufferPlace {
    /// In the program's memory: the CPU engine.
    Program {
        /// True if the film is copied for checkpoints.
        saves: bool,
    },
    /// On a device with a driver; the program keeps copies of scene and film.
    Device {
        /// True if the device's memory is main memory.
        in_main_memory: bool,
    },
}

impl Plan {
    /// Bytes by purpose, on the device and in the program together, for a scene whose tables take
    /// `scene` bytes.
    pub fn memory(&self, scene: u64, place: BufferPlace) -> Vec<Part> {
        let pixels = u64::from(self.pixels);
        let buffers = self.buffers();
        let bytes = |buffer: Buffer| {
            buffers.iter().find(|(other, _)| *other == buffer).map_or(0, |(_, bytes)| *bytes)
        };
        let path = self.settings.method == Method::Path;
        // sizes of per-chunk buffers are those of the largest chunk: scale to the whole image
        let points = pixels * u64::from(self.eye_samples);
        let whole = |buffer: Buffer| match self.is_reused(buffer) {
            true => bytes(buffer),
            false => (bytes(buffer) as f64 * points as f64 / f64::from(self.chunk(0).1.max(1)))
                .ceil() as u64,
        };
        let visible = if path { 0 } else { whole(Buffer::VisiblePoints) + whole(Buffer::Gathered) };
        let statistics = if self.features.has(Feature::Local) && !path {
            points * STATISTICS_BYTES as u64
        } else {
            0
        };
        let film = pixels * FILM_BYTES as u64;
        let layers = whole(Buffer::Aovs) + whole(Buffer::Parts);
        let device = matches!(place, BufferPlace::Device { .. });
        // the state that a render resumes from is stored twice, unless the engine cannot lose it
        // and saves no checkpoints
        let copies = if place == (BufferPlace::Program { saves: false }) { 1 } else { 2 };
        let records = if device {
            [
                Buffer::Records,
                Buffer::Sorted,
                Buffer::Order,
                Buffer::Counts,
                Buffer::Starts,
                Buffer::BlockSums,
            ]
            .map(bytes)
            .iter()
            .sum()
        } else if self.features.has(Feature::Photons) && !path {
            let sorted = 6 * size_of::<Real>() + 4 + size_of::<Vec4>();
            let list = size_of::<PhotonRecord>() + 4;
            u64::from(self.capacity) * (sorted + list) as u64 + u64::from(self.buckets) * 4
        } else {
            0
        };
        // image and error estimate, plus the film during its transfer from the device or the
        // channels during theirs to a file
        let channels = (8 + 3 * self.aovs.iter().count() as u64) * CHANNEL_BYTES;
        let on_its_way = if device { channels.max(FILM_BYTES as u64) } else { channels };
        let result = pixels * (12 + size_of::<PixelError>() as u64 + on_its_way);
        let part = |what, bytes, mend| Part { what, bytes, mend };
        let parts = [
            part("the scene", if device { 2 * scene } else { scene }, SCENE),
            part("the film, and any copy of it", copies * film, PICTURE),
            part("radii of visible points, and any copy", copies * statistics, SAMPLES),
            part("layers, and any copy", copies * layers, LAYERS),
            part("visible points", visible, if self.eye_samples > 1 { SAMPLES } else { PICTURE }),
            part("photons", records, PHOTONS),
            part("the finished picture", result, PICTURE),
            part("reading back", if device { film.min(READING_BYTES) } else { 0 }, PICTURE),
        ];
        parts.into_iter().filter(|part| part.bytes > 0).collect()
    }

    /// Divides the plan so that it fits: the image into tiles, which changes no bit, and, if that
    /// is not enough and `memory` permits it, the photons into smaller batches, which changes the
    /// rounding of their sums. [`Self::settings`] then contain the batch size.
    ///
    /// # Errors
    /// No division fits.
    pub fn within(
        mut self,
        scene: u64,
        place: BufferPlace,
        memory: &Memory,
    ) -> Result<Self, EngineError> {
        let Some((limit, of)) =
            memory.limit(place != BufferPlace::Device { in_main_memory: false })
        else {
            return Ok(self);
        };
        let fits = |plan: &Self| total(&plan.memory(scene, place)) <= limit;
        if fits(&self) {
            return Ok(self);
        }
        let gathers = self.features.has(Feature::Photons) && self.settings.method != Method::Path;
        let (planned, whole) = (self.settings.batch, self.batch_photons);
        // first keep the batches, then make some smaller in large tiles, since each tile traces the
        // photons of smaller batches again
        let rounds: &[u32] =
            if memory.cuts_batches() && gathers { &[1, MANY_BATCHES, u32::MAX] } else { &[1] };
        for most in rounds {
            let mut points = CHUNK_POINTS;
            loop {
                self.settings.batch = planned;
                self = self.in_tiles(points).in_batches();
                while !fits(&self)
                    && self.capacity > SCAN_BLOCK
                    && 2 * (whole / self.batch_photons) <= *most
                {
                    let half = (self.batch_photons / 2).max(1);
                    self = self.with_batch(half);
                }
                if fits(&self) {
                    return Ok(self);
                }
                points = self.chunk(0).1 / 2;
                if points < LEAST_TILE / 2 {
                    break;
                }
            }
        }
        Err(OverBudget::new(&self.memory(scene, place), (limit, of)).into())
    }

    /// Returns the plan with the image in tiles of about `points` visible points, of which one at a
    /// time is on the device.
    pub fn in_tiles(self, points: u32) -> Self {
        let chunk_points = (points / self.eye_samples).max(1) * self.eye_samples;
        Self { tiled: true, chunk_points, ..self }
    }

    /// Number of batches in a pass.
    pub fn batches(&self) -> u32 {
        if self.features.has(Feature::Photons) {
            self.settings.photons.div_ceil(self.batch_photons)
        } else {
            0
        }
    }
}

/// Name and bytes of every table of a packed scene.
pub fn scene_tables(scene: &SceneTables) -> Vec<(&'static str, u64)> {
    fn bytes<T>(table: &[T]) -> u64 {
        size_of_val(table) as u64
    }
    vec![
        ("spheres", bytes(&scene.spheres)),
        ("rectangles", bytes(&scene.rectangles)),
        ("discs", bytes(&scene.discs)),
        ("cuboids", bytes(&scene.cuboids)),
        ("planes", bytes(&scene.planes)),
        ("revolutions", bytes(&scene.revolutions)),
        ("patches", bytes(&scene.patches)),
        ("profile_points", bytes(&scene.profile_points)),
        ("unbounded", bytes(&scene.unbounded)),
        ("materials", bytes(&scene.materials)),
        ("textures", bytes(&scene.textures)),
        ("lights", bytes(&scene.lights)),
        ("distributions", bytes(&scene.distributions)),
        ("cells", bytes(&scene.cells)),
        ("nodes", bytes(&scene.nodes)),
        ("refs", bytes(&scene.refs)),
        ("triangles", bytes(&scene.triangles)),
        ("attributes", bytes(&scene.attributes)),
        ("outlines", bytes(&scene.outlines)),
        ("texels", bytes(&scene.texels)),
    ]
}

/// Total bytes of all tables.
pub fn scene_bytes(scene: &SceneTables) -> u64 {
    scene_tables(scene).iter().map(|(_, bytes)| bytes).sum()
}
