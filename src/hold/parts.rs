//! Renders in independent parts.

use thiserror::Error;

use super::truth::Blocks;
use crate::device::{self, DeviceError, Wanted};
use crate::engine::EngineError;
use crate::film::Picture;
use crate::scene::Scene;
use crate::settings::{Method, RenderSettings};

/// No render to hold.
#[derive(Debug, Error)]
pub enum HoldError {
    /// No engine for the scene on this device.
    #[error(transparent)]
    Device(#[from] DeviceError),
    /// The engine failed in a pass.
    #[error(transparent)]
    Engine(#[from] EngineError),
    /// Film and blocks do not fit.
    #[error("a film of {0}x{1} pixels does not divide into the truth's blocks")]
    Size(u32, u32),
}

/// A picture and the parts it is the mean of.
#[derive(Clone, Debug)]
pub struct Rendered {
    /// The mean of all parts.
    pub picture: Picture,
    /// Block means of each part. Their errors are uncorrelated: a pass's estimate is unbiased (but for the radius)
    /// whatever the passes before it were.
    pub parts: Vec<Blocks>,
}

/// Renders `scene` on the device that is wanted, over `width * height` blocks. The parts are the passes, taken from
/// the running mean `m_n` as `n m_n - (n - 1) m_(n-1)`. PPM's passes share their eye paths; there each part is a
/// render of `settings.passes` with a seed of its own, `ppm_parts` of them.
///
/// # Errors
/// When the scene does not run on the device or its film does not divide into the blocks.
pub fn render_parts(
    wanted: &Wanted,
    scene: &Scene,
    settings: &RenderSettings,
    ppm_parts: u32,
    (width, height): (u32, u32),
) -> Result<Rendered, HoldError> {
    let film = &scene.film;
    let blocks = |picture: &Picture| {
        Blocks::of(picture, width, height).ok_or(HoldError::Size(film.width, film.height))
    };
    let mut parts = Vec::new();
    if settings.method != Method::Ppm {
        let mut engine = device::open(wanted, scene, settings)?.engine;
        let mut before = Blocks::from_fn(width, height, |_, _| [0.0; 3]);
        for pass in 0..settings.passes {
            engine.pass()?;
            let mean = blocks(&engine.picture()?)?;
            let (n, rgb) = (f64::from(pass), mean.rgb.iter().zip(&before.rgb));
            let part = rgb.map(|(m, b)| [0, 1, 2].map(|c| (n + 1.0) * m[c] - n * b[c])).collect();
            parts.push(Blocks { rgb: part, ..before });
            before = mean;
        }
        return Ok(Rendered { picture: engine.picture()?, parts });
    }
    let mut sum = Picture::from_fn(film.width, film.height, |_, _| [0.0; 3]);
    for part in 0..ppm_parts {
        let settings = RenderSettings { seed: settings.seed + u64::from(part), ..settings.clone() };
        let mut engine = device::open(wanted, scene, &settings)?.engine;
        for _ in 0..settings.passes {
            engine.pass()?;
        }
        let picture = engine.picture()?;
        parts.push(blocks(&picture)?);
        let share = 1.0 / ppm_parts as f32;
        let channels = sum.rgb.as_flattened_mut().iter_mut().zip(picture.rgb.as_flattened());
        channels.for_each(|(sum, value)| *sum += value * share);
    }
    Ok(Rendered { picture: sum, parts })
}
