//! A progressive render with snapshots after 1, 2, 4, 8, ... passes and at the end.

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use crate::engine::{Engine, EngineError};
use crate::film::Picture;

/// Intermediate image of a render.
#[derive(Clone, Debug)]
pub struct Snapshot {
    /// Number of passes.
    pub passes: u32,
    /// Render time of the passes in seconds, without reading back and measuring images.
    pub seconds: f64,
    /// Photon paths emitted.
    pub photons: u64,
    /// Rays traced.
    pub rays: u64,
    /// Radiance estimate.
    pub picture: Picture,
}

/// Stop condition of a render.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Until {
    /// Render time in seconds; no pass starts after it.
    Seconds(f64),
    /// Number of passes.
    Passes(u32),
}

/// Renders until the stop condition holds, and calls `take` after each power of two and after the
/// last pass. Returns false if `interrupted` was set; the last snapshot is then missing.
pub fn progressive(
    engine: &mut dyn Engine,
    until: Until,
    interrupted: &AtomicBool,
    take: &mut dyn FnMut(Snapshot),
) -> Result<bool, EngineError> {
    let (mut passes, mut photons, mut rays) = (0u32, 0, 0);
    let mut time = Duration::ZERO;
    loop {
        let start = Instant::now();
        let report = engine.pass()?;
        time += start.elapsed();
        passes += 1;
        photons += report.photons;
        rays += report.rays;
        let last = match until {
            Until::Seconds(seconds) => time.as_secs_f64() >= seconds || passes == u32::MAX,
            Until::Passes(wanted) => passes >= wanted,
        };
        if last || passes.is_power_of_two() {
            take(Snapshot {
                passes,
                seconds: time.as_secs_f64(),
                photons,
                rays,
                picture: engine.picture()?,
            });
        }
        if last {
            return Ok(true);
        }
        if interrupted.load(Ordering::Relaxed) {
            return Ok(false);
        }
    }
}

/// Theory: the test engine writes its pass count to the image, so images show when they were taken.
#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::scripted::Scripted;

    fn run(until: Until, interrupted: bool) -> (bool, Vec<Snapshot>) {
        let mut taken = Vec::new();
        let mut engine = Scripted::new(|passes| {
            std::thread::sleep(Duration::from_millis(100));
            Picture::from_fn(1, 1, |_, _| [passes as f32; 3])
        });
        engine.work = || std::thread::sleep(Duration::from_millis(2));
        let flag = AtomicBool::new(interrupted);
        let whole =
            progressive(&mut engine, until, &flag, &mut |snapshot| taken.push(snapshot)).unwrap();
        (whole, taken)
    }

    #[test]
    fn powers_of_two_and_the_last() {
        let (whole, taken) = run(Until::Passes(11), false);
        assert!(whole);
        assert_eq!(taken.iter().map(|s| s.passes).collect::<Vec<_>>(), [1, 2, 4, 8, 11]);
        assert!(taken.iter().all(
            |s| s.picture.rgb[0][0] == s.passes as f32 && s.photons == 5 * u64::from(s.passes)
        ));
        assert!(taken.windows(2).all(|pair| pair[0].seconds < pair[1].seconds));
        assert_eq!(run(Until::Passes(8), false).1.len(), 4, "the last snapshot is taken once");
    }

    /// Reading images back takes 100 ms each and must not count as render time.
    #[test]
    fn taking_pictures_is_no_rendering() {
        let (_, taken) = run(Until::Seconds(0.05), false);
        let last = taken.last().unwrap();
        assert!(
            last.passes >= 3 && last.seconds < 0.1,
            "{} passes in {} s",
            last.passes,
            last.seconds
        );
    }

    #[test]
    fn an_interrupt_leaves_it_unfinished() {
        let (whole, taken) = run(Until::Passes(5), true);
        assert!(!whole && taken.len() == 1);
    }
}
