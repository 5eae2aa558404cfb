//! Theory: the pixels of the test engine's image equal its pass count, and the totals are the sums
//! over its reports.

use std::sync::atomic::Ordering;

use super::keep::Keep;
use super::*;
use crate::engine::{EngineError, PassReport, PhotonEnds};
use crate::film::estimate::{LEAST_PASSES, PixelError};

/// Test engine whose pixels equal the number of completed passes. It fails in pass `fails_in`; its
/// state can be read afterwards only if `survives` is set.
struct Counter {
    passes: u32,
    fails_in: u32,
    survives: bool,
    lost: bool,
    pictures_taken: u32,
    errors_taken: u32,
    states_taken: u32,
}

const NEVER: u32 = u32::MAX;

fn counter(fails_in: u32, survives: bool) -> Counter {
    Counter {
        passes: 0,
        fails_in,
        survives,
        lost: false,
        pictures_taken: 0,
        errors_taken: 0,
        states_taken: 0,
    }
}

impl Engine for Counter {
    fn device(&self) -> &str {
        "counter"
    }

    fn pass(&mut self) -> Result<PassReport, EngineError> {
        if self.passes + 1 == self.fails_in {
            self.lost = !self.survives;
            return Err(EngineError::DeviceLost(format!("in pass {}", self.fails_in)));
        }
        self.passes += 1;
        let i = u64::from(self.passes);
        Ok(PassReport {
            photons: 10,
            records: 3,
            eye_paths: 7,
            rays: 100 * i,
            eye_rays: 0,
            ends: PhotonEnds::default(),
            radius: 1.0 / i as f64,
        })
    }

    fn errors(&mut self) -> Result<ErrorMap, EngineError> {
        let deviations = [1.0 / f64::from(self.passes); 2];
        let pixel = PixelError { luminance: 0.99_f64.sqrt(), deviations, ..PixelError::default() };
        self.errors_taken += 1;
        Ok(ErrorMap { width: 2, pixels: vec![pixel; 2], glint: 0.0 })
    }

    fn rejections(&mut self) -> Result<Rejections, EngineError> {
        Ok(Rejections { photons: u64::from(self.passes), ..Rejections::default() })
    }

    fn picture(&mut self) -> Result<Picture, EngineError> {
        self.pictures_taken += 1;
        Ok(Picture::from_fn(2, 1, |_, _| [self.passes as f32; 3]))
    }

    fn layers(&mut self) -> Result<Vec<Channel>, EngineError> {
        Ok(Vec::new())
    }

    fn can_be_lost(&self) -> bool {
        true
    }

    fn save(&mut self) -> Result<State, EngineError> {
        self.states_taken += 1;
        if self.lost {
            return Err(EngineError::DeviceLost("nothing to save".into()));
        }
        Ok(State { passes: self.passes, ..State::default() })
    }

    fn restore(&mut self, state: &State) -> Result<(), EngineError> {
        self.passes = state.passes;
        Ok(())
    }
}

fn passes(passes: u32) -> Stop {
    Stop { passes, time: None, target_error: None }
}

fn run(engine: &mut Counter, stop: Stop, keep: Keep) -> Result<Outcome, Broken> {
    let (state, interrupted) = (State::default(), AtomicBool::new(false));
    let session = Session {
        state: &state,
        progress: Progress::before(stop),
        interrupted: &interrupted,
        observer: &mut |_| (),
        watchers: &mut [],
        saving: None,
    };
    Run::new(session, keep).execute(&mut Single(engine), None)
}

type Save<'a> = &'a mut dyn FnMut(State, &Progress) -> State;

/// Resumes a render at `progress`, and saves it if `save` is given.
fn resumed(
    engine: &mut Counter,
    progress: Progress,
    every: Duration,
    save: Option<Save>,
) -> Result<Outcome, Broken> {
    let state = State { passes: progress.passes, ..State::default() };
    let interrupted = AtomicBool::new(false);
    let session = Session {
        state: &state,
        progress,
        interrupted: &interrupted,
        observer: &mut |_| (),
        watchers: &mut [],
        saving: save.map(|save| Saving { every, save }),
    };
    resume(&mut Single(engine), session)
}

/// Error and recovered pass count of a failed render.
fn left(outcome: Result<Outcome, Broken>) -> (String, Option<u32>) {
    let Broken { error, kept } = outcome.unwrap_err();
    let passes = kept.map(|kept| {
        assert_eq!(kept.progress.passes, kept.state.passes);
        kept.progress.passes
    });
    (error.to_string(), passes)
}

fn shown(outcome: &Outcome) -> f32 {
    outcome.picture.rgb[1][2]
}

#[test]
fn makes_all_passes_and_adds_them_up() {
    let mut seen = Vec::new();
    let mut engine = counter(NEVER, true);
    let outcome = render(&mut engine, passes(5), &AtomicBool::new(false), &mut |p| {
        seen.push((p.passes, p.share()))
    })
    .unwrap();
    assert!(matches!(outcome.ending, Ending::Passes));
    assert_eq!(shown(&outcome), 5.0);
    let p = outcome.progress;
    assert_eq!((p.passes, p.photons, p.eye_paths, p.rays, p.radius), (5, 50, 35, 1500, 0.2));
    assert_eq!(seen, [(1, 0.2), (2, 0.4), (3, 0.6), (4, 0.8), (5, 1.0)]);
    assert_eq!(p.remaining(), Duration::ZERO);
}

#[test]
fn an_interrupt_ends_it_after_the_pass_in_hand() {
    let interrupted = AtomicBool::new(false);
    let mut observer = |p: &Progress| interrupted.store(p.passes == 3, Ordering::Relaxed);
    let outcome =
        render(&mut counter(NEVER, true), passes(100), &interrupted, &mut observer).unwrap();
    assert!(matches!(outcome.ending, Ending::Interrupted));
    assert_eq!((shown(&outcome), outcome.progress.passes), (3.0, 3));
    // an interrupt before the first pass still yields an image
    let outcome =
        render(&mut counter(NEVER, true), passes(100), &AtomicBool::new(true), &mut |_| ())
            .unwrap();
    assert_eq!(shown(&outcome), 1.0);
}

#[test]
fn time_ends_it_between_passes() {
    let stop = Stop { passes: u32::MAX, time: Some(Duration::from_millis(20)), target_error: None };
    let mut slow = |_: &Progress| std::thread::sleep(Duration::from_millis(8));
    let outcome =
        render(&mut counter(NEVER, true), stop, &AtomicBool::new(false), &mut slow).unwrap();
    assert!(matches!(outcome.ending, Ending::Time));
    assert!((2..=4).contains(&outcome.progress.passes), "{:?}", outcome.progress);
    assert_eq!(outcome.progress.share(), 1.0);
    let none = Stop { passes: 9, time: Some(Duration::ZERO), target_error: None };
    assert_eq!(shown(&run(&mut counter(NEVER, true), none, KEEP).unwrap()), 1.0);
}

/// The error after N passes is 1 / N. A target of 0.05 takes 20 passes, or one or two more if no
/// estimate is due then.
#[test]
fn an_error_ends_it() {
    let stop = Stop { passes: u32::MAX, time: None, target_error: Some(0.05) };
    let mut engine = counter(NEVER, true);
    let outcome = run(&mut engine, stop, KEEP).unwrap();
    assert!(matches!(outcome.ending, Ending::TargetError));
    assert!((20..=22).contains(&outcome.progress.passes), "{:?}", outcome.progress);
    assert!(outcome.progress.error.unwrap().stated <= 0.05 && outcome.errors.is_some());
    assert_eq!(outcome.progress.share(), 1.0);
    // after each of passes 4 to 16, after 18, 20 and perhaps 22, and once more at the end
    assert!(engine.errors_taken <= 16, "{}", engine.errors_taken);
    // without an estimate the render cannot end: three passes are never enough
    let eager = Stop { target_error: Some(1.0), ..stop };
    assert_eq!(run(&mut counter(NEVER, true), eager, KEEP).unwrap().progress.passes, LEAST_PASSES);
    // a lower pass limit takes effect first
    let few = Stop { passes: 8, ..stop };
    assert!(matches!(run(&mut counter(NEVER, true), few, KEEP).unwrap().ending, Ending::Passes));
    let fewer = run(&mut counter(NEVER, true), Stop { passes: 3, ..stop }, KEEP).unwrap();
    assert!(fewer.errors.is_none() && fewer.progress.error.is_none());
}

#[test]
fn a_failure_leaves_the_passes_before() {
    for k in 2..6 {
        let left = left(run(&mut counter(k, true), passes(8), KEEP));
        assert_eq!(left, (format!("the device was lost: in pass {k}"), Some(k - 1)));
    }
}

#[test]
fn a_lost_device_leaves_what_was_kept() {
    let always = Keep { every: Duration::ZERO, times_cost: 0 };
    let lost = |keep| left(run(&mut counter(6, false), passes(8), keep));
    assert_eq!(lost(always), ("the device was lost: in pass 6".to_owned(), Some(5)));
    // without a copy nothing is recovered, and the first failure is reported
    assert_eq!(lost(KEEP), ("the device was lost: in pass 6".to_owned(), None));
    assert_eq!(left(run(&mut counter(1, true), passes(8), KEEP)).1, None);
}

#[test]
fn short_renders_read_the_picture_once() {
    let mut engine = counter(NEVER, true);
    run(&mut engine, passes(50), KEEP).unwrap();
    assert_eq!((engine.pictures_taken, engine.states_taken), (1, 0));
}

/// With an interval of zero, the state is saved between all passes and at the end.
#[test]
fn saved_between_passes_and_at_the_end() {
    let saved_at = |fails_in: u32, every: Duration, from: u32| {
        let mut saved = Vec::new();
        let mut save = |state: State, progress: &Progress| {
            saved.push(progress.passes);
            // state and progress agree
            assert_eq!(state.passes, progress.passes);
            state
        };
        let mut engine = counter(fails_in, true);
        let progress = Progress { passes: from, ..Progress::before(passes(4)) };
        let outcome = resumed(&mut engine, progress, every, Some(&mut save));
        let made = outcome
            .map_or_else(|broken| broken.kept.unwrap().progress.passes, |o| o.progress.passes);
        (saved, made, engine.passes)
    };
    assert_eq!(saved_at(NEVER, Duration::ZERO, 0), (vec![1, 2, 3, 4], 4, 4));
    assert_eq!(saved_at(NEVER, Duration::MAX, 0), (vec![4], 4, 4));
    assert_eq!(saved_at(3, Duration::ZERO, 0), (vec![1, 2], 2, 2), "failed pass not saved");
    assert_eq!(saved_at(NEVER, Duration::ZERO, 2), (vec![2, 3, 4], 4, 4));
    assert_eq!(saved_at(NEVER, Duration::ZERO, 4), (vec![4], 4, 4), "no further pass");
}

/// A device failure saves the passes that were not saved before.
#[test]
fn a_failure_saves_what_is_kept() {
    let mut saved = Vec::new();
    let mut save = |state: State, _: &Progress| {
        saved.push(state.passes);
        state
    };
    let progress = Progress::before(passes(4));
    let outcome = resumed(&mut counter(4, true), progress, Duration::MAX, Some(&mut save));
    assert_eq!(left(outcome).1, Some(3));
    assert_eq!(saved, [3]);
}

/// Time and totals accumulate across sessions.
#[test]
fn a_resumed_render_counts_on() {
    let hour = Duration::from_secs(3600);
    let stop = Stop { passes: u32::MAX, time: Some(hour), target_error: None };
    let begun = Progress { passes: 3, photons: 30, elapsed: hour, ..Progress::before(stop) };
    let mut engine = counter(NEVER, true);
    let outcome = resumed(&mut engine, begun, Duration::MAX, None).unwrap();
    assert!(matches!(outcome.ending, Ending::Time) && outcome.progress.passes == 3);
    let longer = Progress { stop: passes(5), ..begun };
    let outcome = resumed(&mut engine, longer, Duration::MAX, None).unwrap();
    assert_eq!((outcome.progress.passes, outcome.progress.photons), (5, 50));
    assert!(outcome.progress.elapsed >= hour);
}
