//! The small preview image: fewer pixels and photons, rendered by the CPU engine, which needs no
//! upload to a device and no shader compiler.

use std::time::{Duration, Instant};

use super::frame::{FrameSlot, Passes, RenderRequest, Setup};
use super::full::bytes;
use super::packed_cache::Prepared;
use crate::cpu::CpuEngine;
use crate::engine::{Cancel, EngineError};
use crate::plan::Plan;
use crate::scene::Film;
use crate::scene::settings::RenderSettings;

/// Number of passes of a small image.
const PASSES: u32 = 32;
/// Target time of the first small image. If it takes longer, the next one has fewer pixels; if it
/// takes less than a quarter, more.
const SLOW: Duration = Duration::from_millis(200);
/// Minimum and maximum ratio of the full image's side lengths to those of the small one.
const DIVISORS: (u32, u32) = (2, 8);
/// Minimum number of photons per pass.
const FEWEST: u32 = 2048;

/// Ratio of the full image's side lengths to those of the small one, adapted to the speed of this
/// machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Divisor(u32);

impl Default for Divisor {
    fn default() -> Self {
        Self(4)
    }
}

impl Divisor {
    /// Adapts to the time that the first pass of a small image took.
    pub fn learn(&mut self, took: Duration) {
        let (least, most) = DIVISORS;
        if took > SLOW {
            self.0 = (2 * self.0).min(most);
        } else if 4 * took < SLOW {
            self.0 = (self.0 / 2).max(least);
        }
    }

    /// Film of the small image.
    pub fn film(self, film: &Film) -> Film {
        let side = |pixels: u32| (pixels / self.0).max(pixels.min(16));
        Film { width: side(film.width), height: side(film.height), window: None, ..*film }
    }

    /// Settings of the small image, with the same number of photons per pixel. Radii in pixels grow
    /// with the pixels, so that a disc gathers the same number of photons.
    pub fn settings(self, settings: &RenderSettings) -> RenderSettings {
        let photons = (settings.photons / (self.0 * self.0)).max(settings.photons.min(FEWEST));
        RenderSettings { photons, eye_samples: 1, ..settings.clone() }
    }
}

/// A small image in progress.
pub(super) struct Quick {
    engine: CpuEngine,
    passes: Passes,
}

impl Quick {
    /// Renders the first pass of a small image, publishes it, and adapts `divisor` to the time that
    /// it took. `cancel` cancels this pass and later ones.
    pub fn first(
        number: u64,
        prepared: &mut Prepared,
        request: &RenderRequest,
        divisor: &mut Divisor,
        cancel: &Cancel,
        slot: &FrameSlot,
    ) -> Result<Self, EngineError> {
        let begun = Instant::now();
        let film = divisor.film(&request.film);
        prepared.stand(&request.camera, &film);
        let packed = prepared.packed();
        let plan = Plan::probed(packed, &divisor.settings(&request.settings)).on(&film);
        let plan = Plan { cancel: cancel.clone(), ..plan };
        let setup = Setup {
            device: "cpu".to_owned(),
            why: "a small image".to_owned(),
            settings: plan.settings.clone(),
            bytes: bytes(&packed.tables, &plan),
        };
        let engine = CpuEngine::new(packed.clone(), plan);
        let mut quick = Self { engine, passes: Passes::new(number, true, setup) };
        quick.step(slot)?;
        divisor.learn(begun.elapsed());
        Ok(quick)
    }

    /// Renders another pass.
    pub fn step(&mut self, slot: &FrameSlot) -> Result<(), EngineError> {
        self.passes.step(&mut self.engine, PASSES, slot)
    }

    /// Returns whether all passes are done.
    pub fn is_done(&self) -> bool {
        self.passes.done >= PASSES
    }
}

/// Theory: a slow machine gets fewer pixels and a fast one more, within bounds, and the number of
/// photons follows the number of pixels.
#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn divisors_follow_the_machine() {
        let mut divisor = Divisor::default();
        let at = |ms| Duration::from_millis(ms);
        divisor.learn(at(100));
        assert_eq!(divisor, Divisor(4), "as it should be");
        for (took, divisors) in [(500, [8, 8, 8]), (1, [4, 2, 2])] {
            assert_eq!(
                divisors,
                divisors.map(|_| {
                    divisor.learn(at(took));
                    divisor.0
                })
            );
        }
    }

    #[test]
    fn small_films_hold_something() {
        let film = crate::scene::load("scenes/cornell.toml".as_ref()).unwrap().scene.film;
        let small = |width, height| {
            let film = Divisor(4).film(&Film { width, height, ..film });
            (film.width, film.height)
        };
        assert_eq!(small(640, 480), (160, 120));
        assert_eq!((small(1, 1), small(20, 4000)), ((1, 1), (16, 1000)));
        let settings = RenderSettings { photons: 262_144, ..RenderSettings::default() };
        assert_eq!(Divisor(4).settings(&settings).photons, 16384);
        let few = RenderSettings { photons: 100, ..settings };
        assert_eq!(Divisor(4).settings(&few).photons, 100);
    }
}
