//! Identity of the render that a checkpoint belongs to.

use serde::{Deserialize, Serialize};

use crate::device::Opened;
use crate::engine::Space;
use crate::render::identity::{Identity, program};
use crate::scene::settings::RenderSettings;
use crate::scene::{Aovs, Film, Scene, ToneMap};

/// Scene, settings and device of a render.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Origin {
    /// Program version; see [`crate::render::identity::program`].
    pub version: String,
    /// Scene name.
    pub scene: String,
    /// Text of the scene file.
    pub scene_text: String,
    /// Digests of the scene.
    pub identity: Identity,
    /// Material names, indexed by material ID.
    pub materials: Vec<String>,
    /// Pixels per row of the whole image.
    pub width: u32,
    /// Rows of the whole image.
    pub height: u32,
    /// Crop window `[x0, y0, x1, y1]`: columns `x0..x1`, rows `y0..y1`; `None` for the whole image.
    pub window: Option<[u32; 4]>,
    /// Layers rendered in addition to radiance.
    pub aovs: Aovs,
    /// Conversion of scene units to world units.
    pub space: Space,
    /// All settings, with "auto" radii resolved. The number of passes is the planned one.
    pub settings: RenderSettings,
    /// Device name; for merged checkpoints, the names of all devices.
    pub device: String,
    /// Exposure of tone-mapped images in stops.
    pub exposure: f64,
    /// Tone curve of tone-mapped images.
    pub tonemap: ToneMap,
}

impl Origin {
    /// Identity of a render of `scene`, parsed from `scene_text`, on an opened device.
    pub fn of(opened: &Opened, scene: &Scene, scene_text: &str) -> Self {
        let Film { width, height, exposure, tonemap, aovs, window, filter: _ } = scene.film;
        Self {
            version: program(),
            scene: scene.name.clone(),
            scene_text: scene_text.to_owned(),
            identity: Identity::of(scene),
            materials: scene.materials.iter().map(|material| material.name.clone()).collect(),
            width,
            height,
            window,
            aovs,
            space: opened.space,
            settings: opened.settings.clone(),
            device: opened.name.clone(),
            exposure,
            tonemap,
        }
    }

    /// Film settings of the render, without the pixel filter, which is part of the identity.
    pub fn film(&self) -> Film {
        let Self { width, height, exposure, tonemap, aovs, window, .. } = *self;
        Film { width, height, exposure, tonemap, aovs, window, ..Film::default() }
    }

    /// Number of rendered columns and rows.
    pub fn window_size(&self) -> [u32; 2] {
        match self.window {
            Some([x0, y0, x1, y1]) => [x1.saturating_sub(x0), y1.saturating_sub(y0)],
            None => [self.width, self.height],
        }
    }
}
