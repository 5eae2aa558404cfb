//! The small picture that is there soon: fewer pixels, fewer photons, by the CPU engine, whose
//! tables need no way to a device and no compiler.

use std::time::{Duration, Instant};

use super::frame::{FrameSlot, Passes, RenderRequest, Setup};
use super::full::bytes;
use super::packed_cache::Ground;
use crate::cpu::CpuEngine;
use crate::engine::{Cancel, EngineError};
use crate::plan::Plan;
use crate::scene::Film;
use crate::scene::settings::RenderSettings;

/// Passes after which a small picture is good enough to wait with.
const PASSES: u32 = 32;
/// A first picture that takes longer is made of fewer pixels the next time; one that takes less
/// than a quarter, of more.
const SLOW: Duration = Duration::from_millis(200);
/// Sides of the picture over those of a small one, at the least and at the most.
const DIVISORS: (u32, u32) = (2, 8);
/// Fewest photons of a pass.
const FEWEST: u32 = 2048;

/// Sides of the picture over those of the small one, as fast as this machine is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Divisor(u32);

impl Default for Divisor {
    fn default() -> Self {
        Self(4)
    }
}

impl Divisor {
    /// Learns from the time that a first picture took.
    pub fn learn(&mut self, took: Duration) {
        let (least, most) = DIVISORS;
        if took > SLOW {
            self.0 = (2 * self.0).min(most);
        } else if 4 * took < SLOW {
            self.0 = (self.0 / 2).max(least);
        }
    }

    /// The small film.
    pub fn film(self, film: &Film) -> Film {
        let side = |pixels: u32| (pixels / self.0).max(pixels.min(16));
        Film { width: side(film.width), height: side(film.height), window: None, ..*film }
    }

    /// Settings for it: as many photons for a pixel. Radii in pixels grow with the pixels, so that
    /// as many photons fall in a disc.
    pub fn settings(self, settings: &RenderSettings) -> RenderSettings {
        let photons = (settings.photons / (self.0 * self.0)).max(settings.photons.min(FEWEST));
        RenderSettings { photons, eye_samples: 1, ..settings.clone() }
    }
}

/// A small picture under way.
pub(super) struct Quick {
    engine: CpuEngine,
    passes: Passes,
}

impl Quick {
    /// Makes the first pass of a small picture and shows it; learns from the time that it took.
    /// `cancel` ends this pass and later ones.
    pub fn first(
        number: u64,
        ground: &mut Ground,
        wish: &RenderRequest,
        divisor: &mut Divisor,
        cancel: &Cancel,
        board: &FrameSlot,
    ) -> Result<Self, EngineError> {
        let begun = Instant::now();
        let film = divisor.film(&wish.film);
        ground.stand(&wish.camera, &film);
        let packed = ground.packed();
        let plan = Plan::new(packed, &divisor.settings(&wish.settings)).on(&film);
        let plan = Plan { cancel: cancel.clone(), ..plan };
        let setup = Setup {
            device: "cpu".to_owned(),
            why: "a small picture".to_owned(),
            settings: plan.settings.clone(),
            bytes: bytes(&packed.scene, &plan),
        };
        let engine = CpuEngine::new(packed.clone(), plan);
        let mut quick = Self { engine, passes: Passes::new(number, true, setup) };
        quick.step(board)?;
        divisor.learn(begun.elapsed());
        Ok(quick)
    }

    /// Makes another pass.
    pub fn step(&mut self, board: &FrameSlot) -> Result<(), EngineError> {
        self.passes.step(&mut self.engine, PASSES, board)
    }

    /// Whether it is good enough.
    pub fn is_done(&self) -> bool {
        self.passes.done >= PASSES
    }
}

/// Theory: a slow machine gets fewer pixels and a fast one more, within bounds, and photons go with
/// the pixels.
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
