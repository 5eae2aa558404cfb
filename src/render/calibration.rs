//! Prediction of time and error from the first two passes, which are regular passes of the render.

use std::time::Duration;

use super::Watcher;
use super::quality::one_pass_error;
use crate::engine::{Engine, EngineError};
use crate::film::Picture;

/// Measurements of the first two passes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Calibration {
    /// Seconds per pass: the minimum of both, since the first may include one-time setup.
    pub seconds_per_pass: f64,
    /// relMSE of an image of one pass.
    pub one_pass: f64,
}

/// Reports a [`Calibration`] after the second pass of a render.
pub struct Calibrating<'a> {
    seconds: f64,
    first: Option<Picture>,
    report: &'a mut dyn FnMut(&Calibration),
}

impl<'a> Calibrating<'a> {
    /// Calls `report` once, if the render starts with its first pass.
    pub fn new(report: &'a mut dyn FnMut(&Calibration)) -> Self {
        Self { seconds: f64::MAX, first: None, report }
    }
}

impl Watcher for Calibrating<'_> {
    fn after_pass(
        &mut self,
        passes: u32,
        time: Duration,
        engine: &mut dyn Engine,
    ) -> Result<(), EngineError> {
        match passes {
            1 => {
                self.seconds = time.as_secs_f64();
                self.first = Some(engine.picture()?);
            }
            2 => {
                self.seconds = self.seconds.min(time.as_secs_f64());
                let picture = engine.picture()?;
                // the sizes are equal, so this fails only without pixels or for values that are
                // not finite
                if let Some(Ok(one_pass)) =
                    self.first.take().map(|first| one_pass_error(&first, &picture))
                {
                    (self.report)(&Calibration { seconds_per_pass: self.seconds, one_pass });
                }
            }
            _ => {}
        }
        Ok(())
    }
}

/// Theory: the passes of the test engine show 1, 3, 1, 3, ..., so the mean after two passes is 2,
/// and a single pass differs from it by 1.
#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::State;
    use crate::engine::scripted::Scripted;
    use crate::render::{Progress, Session, Single, Stop, resume};
    use std::sync::atomic::AtomicBool;

    fn alternating(passes: u32) -> Picture {
        let sum = 2 * passes - passes % 2;
        Picture::from_fn(4, 4, |_, _| [sum as f32 / passes as f32; 3])
    }

    #[test]
    fn two_passes_calibrate_once() {
        let mut engine = Scripted::new(alternating);
        engine.work = || std::thread::sleep(Duration::from_millis(5));
        let mut reported = Vec::new();
        let mut report = |calibration: &Calibration| reported.push(*calibration);
        let mut calibrating = Calibrating::new(&mut report);
        let session = Session {
            state: &State::default(),
            progress: Progress::before(Stop { passes: 4, time: None, target_error: None }),
            interrupted: &AtomicBool::new(false),
            observer: &mut |_| (),
            watchers: &mut [&mut calibrating],
            saving: None,
        };
        let outcome = resume(&mut Single(&mut engine), session).unwrap();
        assert_eq!(outcome.picture.rgb[0][0], 2.0);
        let [Calibration { seconds_per_pass, one_pass }] = reported[..] else {
            panic!("{reported:?}")
        };
        // (1 - 2)^2 / (2^2 + 0.01), twice
        assert!((one_pass - 2.0 / 4.01).abs() < 1e-6, "{one_pass}");
        assert!(seconds_per_pass >= 0.005, "{seconds_per_pass}");
        assert_eq!(engine.passes, 4, "no extra pass");
    }
}
