//! Prediction of time and error from the first two passes, which are regular passes of the render.

use std::time::Instant;

use crate::engine::{Engine, EngineError, PassReport, State};
use crate::film::exr_file::Channel;
use crate::film::{ErrorMap, Picture, Rejections};
use crate::render::quality::one_pass_error;

/// Measurements of the first two passes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Calibration {
    /// Seconds per pass: the minimum of both, since the first may include one-time setup.
    pub seconds_per_pass: f64,
    /// relMSE of an image of one pass.
    pub one_pass: f64,
}

/// Engine wrapper that reports a [`Calibration`] after the second pass. It does not change images.
pub struct Calibrating<'a> {
    inner: &'a mut dyn Engine,
    passes: u32,
    seconds: f64,
    first: Option<Picture>,
    tell: &'a mut dyn FnMut(&Calibration),
}

impl<'a> Calibrating<'a> {
    /// Wraps an engine that has not rendered any pass.
    pub fn new(inner: &'a mut dyn Engine, tell: &'a mut dyn FnMut(&Calibration)) -> Self {
        Self { inner, passes: 0, seconds: f64::MAX, first: None, tell }
    }
}

impl Engine for Calibrating<'_> {
    fn device(&self) -> &str {
        self.inner.device()
    }

    fn pass(&mut self) -> Result<PassReport, EngineError> {
        let start = Instant::now();
        let report = self.inner.pass()?;
        self.passes = self.passes.saturating_add(1);
        if self.passes <= 2 {
            self.seconds = self.seconds.min(start.elapsed().as_secs_f64());
            let picture = self.inner.picture()?;
            match self.first.take() {
                None => self.first = Some(picture),
                Some(first) => {
                    // the sizes are equal, so this fails only without pixels or for values that
                    // are not finite
                    if let Ok(one_pass) = one_pass_error(&first, &picture) {
                        (self.tell)(&Calibration { seconds_per_pass: self.seconds, one_pass });
                    }
                }
            }
        }
        Ok(report)
    }

    fn picture(&mut self) -> Result<Picture, EngineError> {
        self.inner.picture()
    }

    fn errors(&mut self) -> Result<ErrorMap, EngineError> {
        self.inner.errors()
    }

    fn rejections(&mut self) -> Result<Rejections, EngineError> {
        self.inner.rejections()
    }

    fn layers(&mut self) -> Result<Vec<Channel>, EngineError> {
        self.inner.layers()
    }

    fn results(&mut self) -> Result<(Picture, Rejections), EngineError> {
        self.inner.results()
    }

    fn gathered(&mut self) -> Result<u64, EngineError> {
        self.inner.gathered()
    }

    fn can_be_lost(&self) -> bool {
        self.inner.can_be_lost()
    }

    fn go_on(&mut self, state: &State, error: EngineError) -> Result<(), EngineError> {
        self.inner.go_on(state, error)
    }

    fn save(&mut self) -> Result<State, EngineError> {
        self.inner.save()
    }

    fn restore(&mut self, state: &State) -> Result<(), EngineError> {
        self.inner.restore(state)
    }
}

/// Theory: an engine whose passes have the values 1, 3, 1, 3, ... has the mean 2 after two passes;
/// each pass deviates by 1 from it.
#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    struct Alternating {
        sum: f32,
        passes: u32,
    }

    impl Engine for Alternating {
        fn device(&self) -> &str {
            "alternating"
        }

        fn pass(&mut self) -> Result<PassReport, EngineError> {
            std::thread::sleep(Duration::from_millis(5));
            self.sum += if self.passes.is_multiple_of(2) { 1.0 } else { 3.0 };
            self.passes += 1;
            Ok(PassReport { photons: 5, ..PassReport::default() })
        }

        fn errors(&mut self) -> Result<ErrorMap, EngineError> {
            Ok(ErrorMap::default())
        }

        fn rejections(&mut self) -> Result<Rejections, EngineError> {
            Ok(Rejections::default())
        }

        fn picture(&mut self) -> Result<Picture, EngineError> {
            Ok(Picture::from_fn(4, 4, |_, _| [self.sum / self.passes as f32; 3]))
        }
    }

    #[test]
    fn two_passes_tell_once_and_are_kept() {
        let mut inner = Alternating { sum: 0.0, passes: 0 };
        let mut told = Vec::new();
        let mut tell = |calibration: &Calibration| told.push(*calibration);
        let mut engine = Calibrating::new(&mut inner, &mut tell);
        for _ in 0..4 {
            assert_eq!(engine.pass().unwrap().photons, 5);
        }
        assert_eq!(engine.picture().unwrap().rgb[0][0], 2.0);
        let [Calibration { seconds_per_pass, one_pass }] = told[..] else { panic!("{told:?}") };
        // twice (1 - 2)^2 / (2^2 + 0.01)
        assert!((one_pass - 2.0 / 4.01).abs() < 1e-6, "{one_pass}");
        assert!(seconds_per_pass >= 0.005, "{seconds_per_pass}");
        assert_eq!(inner.passes, 4, "no extra passes");
    }
}
