//! Conversion of a frame for display: tone-mapped radiance, one of its components, or another
//! channel in false colors with a scale.

use std::num::NonZero;
use std::sync::{Mutex, PoisonError};
use std::thread;

use super::frame::Frame;
use crate::film::exr_file::Channel;
use crate::film::heat::heat;
use crate::film::{Development, Picture};
use crate::math::srgb::srgb_from_linear;
use crate::plan::layers::NO_DEPTH;
use crate::scene::{Aov, Aovs};

/// A view of an image.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum View {
    /// All light, tone-mapped.
    #[default]
    Picture,
    /// Direct lighting, from shadow rays.
    Direct,
    /// Light from photons that no diffuse surface has scattered.
    Caustic,
    /// Light from photons that a diffuse surface has scattered.
    Indirect,
    /// Reflectance of the first hit that is neither mirror nor glass.
    Albedo,
    /// Shading normals; components from -1 to 1 map to black to white.
    Normal,
    /// Distance along the view direction, in scene units.
    Depth,
    /// Gather radius, in scene units.
    Radius,
    /// Photons gathered in the last pass.
    Photons,
    /// Variance of the luminance.
    Variance,
}

impl View {
    /// All views, in the order of their keys.
    pub const ALL: [Self; 10] = [
        Self::Picture,
        Self::Direct,
        Self::Caustic,
        Self::Indirect,
        Self::Albedo,
        Self::Normal,
        Self::Depth,
        Self::Radius,
        Self::Photons,
        Self::Variance,
    ];

    /// Name of the view.
    pub fn word(self) -> &'static str {
        self.aov().map_or("picture", Aov::word)
    }

    /// Channel that it needs in addition to radiance.
    pub fn aov(self) -> Option<Aov> {
        Some(match self {
            Self::Picture => return None,
            Self::Direct => Aov::Direct,
            Self::Caustic => Aov::Caustic,
            Self::Indirect => Aov::Indirect,
            Self::Albedo => Aov::Albedo,
            Self::Normal => Aov::Normal,
            Self::Depth => Aov::Depth,
            Self::Radius => Aov::Radius,
            Self::Photons => Aov::Photons,
            Self::Variance => Aov::Variance,
        })
    }

    /// Channels that the render must provide; variance is always available.
    pub fn aovs(self) -> Aovs {
        self.aov().filter(|aov| *aov != Aov::Variance).into_iter().collect()
    }
}

/// An image for display.
#[derive(Clone, Debug, PartialEq)]
pub struct Shown {
    /// Image width in pixels.
    pub width: u32,
    /// Image height in pixels.
    pub height: u32,
    /// sRGB values, row by row.
    pub rgb: Vec<[u8; 3]>,
    /// Color scale, for a view in false colors.
    pub scale: Option<Scale>,
}

/// Color scale of a view.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scale {
    /// Value at the dark end.
    pub low: f64,
    /// Value at the bright end.
    pub high: f64,
    /// True if equal steps are equal ratios.
    pub logarithmic: bool,
    /// Unit of the values.
    pub unit: &'static str,
}

impl Scale {
    /// Color of a value.
    pub fn color(&self, value: f64) -> [u8; 3] {
        let Self { low, high, logarithmic, .. } = *self;
        let at = |x: f64| if logarithmic { x.max(low).ln() } else { x };
        heat(((at(value) - at(low)) / (at(high) - at(low)).max(1e-300)).clamp(0.0, 1.0))
    }
}

/// Converts a frame for display, in the given color scale or its own. Returns `None` if the frame
/// lacks the channel, such as the variance before pass 4.
pub fn show(
    frame: &Frame,
    view: View,
    development: &Development,
    scale: Option<Scale>,
) -> Option<Shown> {
    let Picture { width, height, .. } = frame.picture;
    let of = |rgb, scale| Some(Shown { width, height, rgb, scale });
    let plane = |name: &str| {
        let named = |channel: &&Channel| channel.name == name;
        frame.layers.iter().find(named).map(|channel| channel.plane.values.as_slice())
    };
    let triple = |names: [&str; 3], color: &(dyn Fn([f64; 3]) -> [u8; 3] + Sync)| {
        let [r, g, b] = names.map(plane);
        let (r, g, b) = (r?, g?, b?);
        Some(mapped(r.len(), |i| color([r[i], g[i], b[i]])))
    };
    let light = |rgb: [f64; 3]| development.bytes(rgb.map(|x| x as f32));
    let byte = |x: f64| (255.0 * x.clamp(0.0, 1.0)).round() as u8;
    match view {
        View::Picture => of(developed(&frame.picture, development), None),
        View::Direct => of(triple(["direct.R", "direct.G", "direct.B"], &light)?, None),
        View::Caustic => of(triple(["caustic.R", "caustic.G", "caustic.B"], &light)?, None),
        View::Indirect => of(triple(["indirect.R", "indirect.G", "indirect.B"], &light)?, None),
        View::Albedo => {
            let color = |rgb: [f64; 3]| rgb.map(|x| byte(srgb_from_linear(x.clamp(0.0, 1.0))));
            of(triple(["albedo.R", "albedo.G", "albedo.B"], &color)?, None)
        }
        View::Normal => {
            let color = |n: [f64; 3]| n.map(|x| byte(0.5 + 0.5 * x));
            of(triple(["normal.X", "normal.Y", "normal.Z"], &color)?, None)
        }
        View::Depth => {
            // pixels without a hit count as infinitely far
            let values = plane("depth.Z")?;
            let far = values.iter().filter(|z| **z < NO_DEPTH).fold(0.0f64, |far, z| far.max(*z));
            let near = values.iter().fold(far, |near, z| near.min(*z));
            let own = Scale { low: near, high: far, logarithmic: true, unit: "units" };
            let scale = scale.unwrap_or(own);
            of(colors(values, &scale), Some(scale))
        }
        View::Radius | View::Photons => {
            let (name, unit) =
                if view == View::Radius { ("radius.Y", "units") } else { ("photons.Y", "photons") };
            let values = plane(name)?;
            let own = || Scale { low: 0.0, high: high(values), logarithmic: false, unit };
            let scale = scale.unwrap_or_else(own);
            of(colors(values, &scale), Some(scale))
        }
        View::Variance => {
            let variance = frame.errors.as_ref()?.variance();
            let high = high(&variance.values);
            let own = Scale { low: 1e-6 * high, high, logarithmic: true, unit: "(W/sr/m²)²" };
            let scale = scale.unwrap_or(own);
            of(colors(&variance.values, &scale), Some(scale))
        }
    }
}

/// Tone-mapped display values of an image.
pub fn developed(picture: &Picture, development: &Development) -> Vec<[u8; 3]> {
    mapped(picture.rgb.len(), |i| development.bytes(picture.rgb[i]))
}

/// Computes colors by index on separate threads: the render threads may be busy for a whole pass,
/// and the window must not wait for them.
fn mapped(count: usize, color: impl Fn(usize) -> [u8; 3] + Sync) -> Vec<[u8; 3]> {
    const LEAST: usize = 1 << 14;
    let threads = thread::available_parallelism().map_or(1, NonZero::get);
    let chunk = count.div_ceil(threads).max(LEAST);
    let mut colors = vec![[0; 3]; count];
    let parts = Mutex::new(colors.chunks_mut(chunk).enumerate());
    let next = || parts.lock().unwrap_or_else(PoisonError::into_inner).next();
    let work = || {
        while let Some((number, part)) = next() {
            part.iter_mut().enumerate().for_each(|(i, rgb)| *rgb = color(number * chunk + i));
        }
    };
    thread::scope(|scope| {
        // if the system refuses a thread, the other threads do its part, including this one
        let started =
            (1..count.div_ceil(chunk)).map(|_| thread::Builder::new().spawn_scoped(scope, work));
        let _started: Vec<_> = started.flatten().collect();
        work();
    });
    colors
}

fn colors(values: &[f64], scale: &Scale) -> Vec<[u8; 3]> {
    mapped(values.len(), |i| scale.color(values[i]))
}

/// The 99.5th percentile of the finite values; above zero.
fn high(values: &[f64]) -> f64 {
    let mut sorted: Vec<f64> = values.iter().copied().filter(|x| x.is_finite()).collect();
    if sorted.is_empty() {
        return 1.0;
    }
    let at = sorted.len() - 1 - sorted.len() / 200;
    let (_, high, _) = sorted.select_nth_unstable_by(at, f64::total_cmp);
    if *high > 0.0 { *high } else { sorted.iter().fold(0.0f64, |most, x| most.max(*x)).max(1e-30) }
}
