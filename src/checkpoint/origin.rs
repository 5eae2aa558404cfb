//! Which render a checkpoint is of.

use serde::{Deserialize, Serialize};

use crate::device::Opened;
use crate::engine::Space;
use crate::render::identity::{Identity, program};
use crate::scene::settings::RenderSettings;
use crate::scene::{Aovs, Film, Scene, ToneMap};

/// What a picture is made from.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Origin {
    /// The program; see [`crate::render::identity::program`].
    pub version: String,
    /// The scene's name.
    pub scene: String,
    /// The scene file's text.
    pub scene_text: String,
    /// Digests of the scene.
    pub identity: Identity,
    /// The materials' names, in the order of their numbers.
    pub materials: Vec<String>,
    /// Pixels per row of the whole picture.
    pub width: u32,
    /// Rows of the whole picture.
    pub height: u32,
    /// The part of it that is rendered: columns x0 to x1 and rows y0 to y1, x1 and y1 left out;
    /// `None` is all.
    pub window: Option<[u32; 4]>,
    /// What is found in addition to radiance.
    pub aovs: Aovs,
    /// What tells its numbers in those of the world.
    pub space: Space,
    /// All settings, with a radius in the place of "auto". The number of passes is where the render
    /// was to end.
    pub settings: RenderSettings,
    /// The device's name; of merged ones the names of all.
    pub device: String,
    /// Exposure of tone-mapped pictures in stops.
    pub exposure: f64,
    /// Curve of tone-mapped pictures.
    pub tonemap: ToneMap,
}

impl Origin {
    /// That of a render by an engine for a scene, which was read from a file of this text.
    pub fn of(opened: &Opened, scene: &Scene, scene_text: &str) -> Self {
        let Film { width, height, exposure, tonemap, aovs, window } = scene.film;
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

    /// The film.
    pub fn film(&self) -> Film {
        let Self { width, height, exposure, tonemap, aovs, window, .. } = *self;
        Film { width, height, exposure, tonemap, aovs, window }
    }

    /// Columns and rows that are rendered.
    pub fn window_size(&self) -> [u32; 2] {
        match self.window {
            Some([x0, y0, x1, y1]) => [x1.saturating_sub(x0), y1.saturating_sub(y0)],
            None => [self.width, self.height],
        }
    }
}
