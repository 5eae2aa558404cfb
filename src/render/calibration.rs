//! What the first two passes tell about those to come. They are passes of the render like all
//! others.

use std::time::Instant;

use crate::engine::{Engine, EngineError, PassReport, State};
use crate::film::exr_file::Channel;
use crate::film::{ErrorMap, Picture, Rejections};
use crate::render::quality::one_pass_error;

/// What two passes told.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Calibration {
    /// Seconds for a pass, the less of both: the first may wait for what is made but once.
    pub seconds_per_pass: f64,
    /// relMSE of a picture of one pass.
    pub one_pass: f64,
}

/// An engine that tells after its second pass. The pictures are those of the engine within.
pub struct Calibrating<'a> {
    inner: &'a mut dyn Engine,
    passes: u32,
    seconds: f64,
    first: Option<Picture>,
    tell: &'a mut dyn FnMut(&Calibration),
}

impl<'a> Calibrating<'a> {
    /// Watches an engine that has made no pass.
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
                    // Pictures of one engine have one size; without pixels there is nothing to
                    // tell.
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

/// Theory: an engine whose passes show 1, 3, 1, 3, ... has the mean 2 after two; a pass is off by 1
/// there.
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
        // (1 - 2)^2 / (2^2 + 0.01), twice.
        assert!((one_pass - 2.0 / 4.01).abs() < 1e-6, "{one_pass}");
        assert!(seconds_per_pass >= 0.005, "{seconds_per_pass}");
        assert_eq!(inner.passes, 4, "none was made beside");
    }
}
