//! Renders split into independent parts.

use thiserror::Error;

use super::reference::Blocks;
use crate::device::{self, DeviceError, Wanted};
use crate::engine::EngineError;
use crate::film::Picture;
use crate::scene::Scene;
use crate::scene::settings::RenderSettings;

/// Reason why a render cannot be validated.
#[derive(Debug, Error)]
pub enum HoldError {
    /// The device has no engine for the scene.
    #[error(transparent)]
    Device(#[from] DeviceError),
    /// The engine failed in a pass.
    #[error(transparent)]
    Engine(#[from] EngineError),
    /// The film size is not a multiple of the number of blocks.
    #[error("a film of {0}x{1} pixels does not divide into the reference's blocks")]
    Size(u32, u32),
}

/// An image and the parts whose mean it is.
#[derive(Clone, Debug)]
pub struct Rendered {
    /// Mean of all parts.
    pub picture: Picture,
    /// Block means of each part.
    pub parts: Vec<Blocks>,
}

/// Renders `scene` `renders` times with different seeds on the `wanted` device, and averages each
/// render over `width * height` blocks. Passes cannot serve as parts: those of PPM share their eye
/// paths, and those of SPPM share a low-discrepancy sequence in the pixel.
///
/// # Errors
/// If the scene does not run on the device, or the film size is not a multiple of the number of
/// blocks.
pub fn render_parts(
    wanted: &Wanted,
    scene: &Scene,
    settings: &RenderSettings,
    renders: u32,
    (width, height): (u32, u32),
) -> Result<Rendered, HoldError> {
    let film = &scene.film;
    let mut parts = Vec::new();
    let mut sum = Picture::from_fn(film.width, film.height, |_, _| [0.0; 3]);
    for part in 0..renders {
        let settings = RenderSettings { seed: settings.seed + u64::from(part), ..settings.clone() };
        let mut engine = device::open(wanted, scene, &settings)?.engine;
        for _ in 0..settings.passes {
            engine.pass()?;
        }
        let picture = engine.picture()?;
        parts.push(
            Blocks::of(&picture, width, height).ok_or(HoldError::Size(film.width, film.height))?,
        );
        let share = 1.0 / renders as f32;
        let channels = sum.rgb.as_flattened_mut().iter_mut().zip(picture.rgb.as_flattened());
        channels.for_each(|(sum, value)| *sum += value * share);
    }
    Ok(Rendered { picture: sum, parts })
}
