//! The loop over passes: stop conditions, progress, and what is saved when something ends it early.

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use crate::engine::{Engine, EngineError, PassReport, PhotonEnds};
use crate::film::estimate::LEAST_PASSES;
use crate::film::exr_file::Channel;
use crate::film::{ErrorMap, Picture, Rejections, RelativeError};

/// When to stop; whichever comes first. At least one pass is made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stop {
    /// After this many passes.
    pub passes: u32,
    /// No pass is begun after this time.
    pub time: Option<Duration>,
    /// Once the stated relative error (see [`RelativeError::stated`]) is no larger.
    pub target_error: Option<f64>,
}

/// How far a render is, after a pass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress {
    /// Where it will stop.
    pub stop: Stop,
    /// Passes made.
    pub passes: u32,
    /// Photon paths emitted.
    pub photons: u64,
    /// Eye paths traced.
    pub eye_paths: u64,
    /// Rays traced.
    pub rays: u64,
    /// How the photon paths ended.
    pub ends: PhotonEnds,
    /// Gather radius of the last pass in scene units, mean over the visible points.
    pub radius: f64,
    /// Since the first pass began; of a render that was gone on from, that of all its parts together.
    pub elapsed: Duration,
    /// The newest estimate of the picture's error; none in the first passes.
    pub error: Option<RelativeError>,
}

impl Progress {
    /// Before the first pass.
    pub fn before(stop: Stop) -> Self {
        Self {
            stop,
            passes: 0,
            photons: 0,
            eye_paths: 0,
            rays: 0,
            ends: PhotonEnds::default(),
            radius: 0.0,
            elapsed: Duration::ZERO,
            error: None,
        }
    }

    /// Rays per second so far.
    pub fn rays_per_second(&self) -> f64 {
        self.rays as f64 / self.elapsed.as_secs_f64().max(1e-9)
    }

    /// Share of the work that is done, in [0, 1].
    pub fn share(&self) -> f64 {
        let passes = f64::from(self.passes) / f64::from(self.stop.passes.max(1));
        let time =
            self.stop.time.map_or(0.0, |time| self.elapsed.as_secs_f64() / time.as_secs_f64().max(1e-9));
        // the error of progressive photon mapping falls as N^(-1/3) (Kaplanyan & Dachsbacher 2013), or a little faster
        let error = match (self.stop.target_error, self.error) {
            (Some(target), Some(error)) => (target / error.stated).powi(3),
            _ => 0.0,
        };
        passes.max(time).max(error).min(1.0)
    }

    /// Time left if the passes go on as they did.
    pub fn remaining(&self) -> Duration {
        let share = self.share();
        let seconds = self.elapsed.as_secs_f64() * (1.0 - share) / share.max(1e-9);
        Duration::try_from_secs_f64(seconds).unwrap_or(Duration::MAX)
    }

    fn add(&mut self, report: &PassReport, elapsed: Duration) {
        self.passes += 1;
        self.photons = self.photons.saturating_add(report.photons);
        self.eye_paths = self.eye_paths.saturating_add(report.eye_paths);
        self.rays = self.rays.saturating_add(report.rays);
        self.ends.add(&report.ends);
        self.radius = report.radius;
        self.elapsed = elapsed;
    }

    fn reached(&self) -> bool {
        let (target, error) = (self.stop.target_error, self.error);
        target.zip(error).is_some_and(|(target, error)| error.stated <= target)
    }
}

/// Why a render ended.
#[derive(Debug)]
pub enum Ending {
    /// All passes are made.
    Passes,
    /// The time is up.
    Time,
    /// The stated error is no larger than the one aimed at.
    TargetError,
    /// The user asked for it.
    Interrupted,
    /// The engine failed after at least one pass.
    Failed(EngineError),
}

/// A picture, and how it came about.
#[derive(Debug)]
pub struct Outcome {
    /// The estimate.
    pub picture: Picture,
    /// What it says of its own error; none for fewer passes than an estimate needs.
    pub errors: Option<ErrorMap>,
    /// What the film asks for beside radiance.
    pub layers: Vec<Channel>,
    /// What was left out of it.
    pub rejections: Rejections,
    /// The state after the picture's last pass.
    pub progress: Progress,
    /// Why there were no more passes.
    pub ending: Ending,
}

/// How often the picture is copied to the host, since a device that is lost takes its buffers along.
#[derive(Clone, Copy)]
struct Keep {
    /// Time between copies.
    every: Duration,
    /// At least so many times the time that a copy takes.
    times_cost: u32,
}

const KEEP: Keep = Keep { every: Duration::from_secs(10), times_cost: 20 };

/// Where a render is kept, so that it can be gone on from.
pub struct Saving<'a> {
    /// Time between two calls.
    pub every: Duration,
    /// Keeps what [`Engine::save`] gives. Called between passes, and at the end unless the engine failed.
    pub save: &'a mut dyn FnMut(&mut dyn Engine, &Progress) -> Result<(), EngineError>,
}

/// Makes passes until a stop condition holds or `interrupted` is set, which ends it after the pass in hand; calls
/// `observer` after each. Fails only where there is no picture to give; an engine that fails later gives the picture
/// of the passes before, or the last one kept of them.
pub fn render(
    engine: &mut dyn Engine,
    stop: Stop,
    interrupted: &AtomicBool,
    observer: &mut dyn FnMut(&Progress),
) -> Result<Outcome, EngineError> {
    resume(engine, Progress::before(stop), interrupted, observer, None)
}

/// The same from where `progress` is, with an engine that holds its passes, saved now and then. Time counts on. With nothing left
/// to do it makes no pass.
pub fn resume(
    engine: &mut dyn Engine,
    progress: Progress,
    interrupted: &AtomicBool,
    observer: &mut dyn FnMut(&Progress),
    saving: Option<Saving>,
) -> Result<Outcome, EngineError> {
    render_keeping(engine, progress, interrupted, observer, saving, KEEP)
}

fn render_keeping(
    engine: &mut dyn Engine,
    mut progress: Progress,
    interrupted: &AtomicBool,
    observer: &mut dyn FnMut(&Progress),
    mut saving: Option<Saving>,
    keep: Keep,
) -> Result<Outcome, EngineError> {
    let start = Instant::now();
    let (stop, before) = (progress.stop, progress.elapsed);
    let elapsed = || before + start.elapsed();
    let mut kept: Option<Kept> = None;
    let mut next_keep = before + keep.every;
    let mut next_save = saving.as_ref().map(|saving| before.saturating_add(saving.every));
    let mut estimates = Estimates::after(progress.passes);
    if progress.passes == 0 {
        progress.add(&engine.pass()?, elapsed());
    }
    let ending = loop {
        if estimates.due(&progress) {
            let begun = Instant::now();
            match engine.errors() {
                Ok(errors) => progress.error = Some(errors.relative()),
                Err(error) => break Ending::Failed(error),
            }
            estimates.made(&progress, begun.elapsed());
        }
        observer(&progress);
        if interrupted.load(Ordering::Relaxed) {
            break Ending::Interrupted;
        }
        if progress.reached() {
            break Ending::TargetError;
        }
        if progress.passes >= stop.passes {
            break Ending::Passes;
        }
        if stop.time.is_some_and(|time| progress.elapsed >= time) {
            break Ending::Time;
        }
        if progress.elapsed >= next_keep {
            match take(engine, progress) {
                Ok(taken) => kept = Some(taken),
                Err(error) => break Ending::Failed(error),
            }
            let cost = elapsed() - progress.elapsed;
            next_keep = elapsed() + keep.every.max(keep.times_cost * cost);
        }
        if let Some(saving) = &mut saving
            && next_save.is_some_and(|next| progress.elapsed >= next)
        {
            if let Err(error) = (saving.save)(engine, &progress) {
                break Ending::Failed(error);
            }
            next_save = Some(elapsed().saturating_add(saving.every));
        }
        match engine.pass() {
            Ok(report) => progress.add(&report, elapsed()),
            Err(error) => break Ending::Failed(error),
        }
    };
    // what an engine holds that failed in the middle of a pass is no whole number of passes
    let ending = match (ending, saving) {
        (Ending::Failed(error), _) => Ending::Failed(error),
        (ending, None) => ending,
        (ending, Some(saving)) => (saving.save)(engine, &progress).map_or_else(Ending::Failed, |()| ending),
    };
    match (take(engine, progress), ending) {
        (Ok(taken), ending) => Ok(taken.outcome(ending)),
        (Err(_), Ending::Failed(error)) | (Err(error), _) => match kept {
            Some(kept) => Ok(kept.outcome(Ending::Failed(error))),
            None => Err(error),
        },
    }
}

/// Which passes are followed by an estimate of the error. Each reads the film and takes about as long as a picture.
struct Estimates {
    next: u32,
    spent: Duration,
}

/// Estimates take at most this share of the time.
const ESTIMATES_SHARE: u32 = 50;

impl Estimates {
    /// Those still to come after so many passes; also the one after the last of them, which may not have been made.
    fn after(passes: u32) -> Self {
        let places = std::iter::successors(Some(LEAST_PASSES), |place| Some(following(*place)));
        let next = places.into_iter().find(|place| *place >= passes || *place == u32::MAX);
        Self { next: next.unwrap_or(u32::MAX), spent: Duration::ZERO }
    }

    /// With a target the passes depend on their number alone, since the picture's bits may not depend on a clock.
    fn due(&self, progress: &Progress) -> bool {
        let cheap = || self.spent * ESTIMATES_SHARE <= progress.elapsed;
        progress.passes >= self.next && (progress.stop.target_error.is_some() || cheap())
    }

    fn made(&mut self, progress: &Progress, cost: Duration) {
        self.next = following(progress.passes);
        self.spent += cost;
    }
}

/// Passes at the estimate after the one at `passes`.
fn following(passes: u32) -> u32 {
    passes.saturating_add((passes / 8).max(1))
}

/// A picture with what belongs to it.
struct Kept {
    picture: Picture,
    errors: Option<ErrorMap>,
    layers: Vec<Channel>,
    rejections: Rejections,
    progress: Progress,
}

impl Kept {
    fn outcome(self, ending: Ending) -> Outcome {
        let Self { picture, errors, layers, rejections, progress } = self;
        Outcome { picture, errors, layers, rejections, progress, ending }
    }
}

fn take(engine: &mut dyn Engine, mut progress: Progress) -> Result<Kept, EngineError> {
    let (picture, rejections) = engine.results()?;
    let errors = match progress.passes {
        LEAST_PASSES.. => Some(engine.errors()?),
        _ => None,
    };
    progress.error = errors.as_ref().map(ErrorMap::relative);
    Ok(Kept { picture, errors, layers: engine.layers()?, rejections, progress })
}

/// Theory: an engine that counts its passes into the picture shows by the picture alone how many were made, and the
/// totals are the sums over its reports.
#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::estimate::PixelError;

    /// Each pixel of its picture is the number of passes made. It fails in pass `fails_in`, and after that gives its
    /// picture only if `survives`.
    struct Counter {
        passes: u32,
        fails_in: u32,
        survives: bool,
        pictures_taken: u32,
        errors_taken: u32,
    }

    const NEVER: u32 = u32::MAX;

    fn counter(fails_in: u32, survives: bool) -> Counter {
        Counter { passes: 0, fails_in, survives, pictures_taken: 0, errors_taken: 0 }
    }

    impl Engine for Counter {
        fn device(&self) -> &str {
            "counter"
        }

        fn pass(&mut self) -> Result<PassReport, EngineError> {
            if self.passes + 1 == self.fails_in {
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
            Ok(ErrorMap { width: 2, pixels: vec![pixel; 2] })
        }

        fn rejections(&mut self) -> Result<Rejections, EngineError> {
            Ok(Rejections { photons: u64::from(self.passes), ..Rejections::default() })
        }

        fn picture(&mut self) -> Result<Picture, EngineError> {
            self.pictures_taken += 1;
            if self.passes + 1 >= self.fails_in && !self.survives {
                return Err(EngineError::DeviceLost("no picture".into()));
            }
            Ok(Picture::from_fn(2, 1, |_, _| [self.passes as f32; 3]))
        }
    }

    fn passes(passes: u32) -> Stop {
        Stop { passes, time: None, target_error: None }
    }

    fn run(engine: &mut Counter, stop: Stop, keep: Keep) -> Result<Outcome, EngineError> {
        render_keeping(engine, Progress::before(stop), &AtomicBool::new(false), &mut |_| (), None, keep)
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
        let outcome = render(&mut counter(NEVER, true), passes(100), &interrupted, &mut observer).unwrap();
        assert!(matches!(outcome.ending, Ending::Interrupted));
        assert_eq!((shown(&outcome), outcome.progress.passes), (3.0, 3));
        // One that comes before the first pass still leaves a picture.
        let outcome =
            render(&mut counter(NEVER, true), passes(100), &AtomicBool::new(true), &mut |_| ()).unwrap();
        assert_eq!(shown(&outcome), 1.0);
    }

    #[test]
    fn time_ends_it_between_passes() {
        let stop = Stop { passes: u32::MAX, time: Some(Duration::from_millis(20)), target_error: None };
        let mut slow = |_: &Progress| std::thread::sleep(Duration::from_millis(8));
        let outcome = render(&mut counter(NEVER, true), stop, &AtomicBool::new(false), &mut slow).unwrap();
        assert!(matches!(outcome.ending, Ending::Time));
        assert!((2..=4).contains(&outcome.progress.passes), "{:?}", outcome.progress);
        assert_eq!(outcome.progress.share(), 1.0);
        let none = Stop { passes: 9, time: Some(Duration::ZERO), target_error: None };
        assert_eq!(shown(&run(&mut counter(NEVER, true), none, KEEP).unwrap()), 1.0);
    }

    /// The error after N passes is 1 / N, so that 0.05 takes 20 passes, or one or two more where no estimate comes then.
    #[test]
    fn an_error_ends_it() {
        let stop = Stop { passes: u32::MAX, time: None, target_error: Some(0.05) };
        let mut engine = counter(NEVER, true);
        let outcome = run(&mut engine, stop, KEEP).unwrap();
        assert!(matches!(outcome.ending, Ending::TargetError));
        assert!((20..=22).contains(&outcome.progress.passes), "{:?}", outcome.progress);
        assert!(outcome.progress.error.unwrap().stated <= 0.05 && outcome.errors.is_some());
        assert_eq!(outcome.progress.share(), 1.0);
        // after 4 to 16 passes one by one, then after 18, 20 and perhaps 22, and once more at the end
        assert!(engine.errors_taken <= 16, "{}", engine.errors_taken);
        // no estimate, no end: three passes never are enough
        let eager = Stop { target_error: Some(1.0), ..stop };
        assert_eq!(run(&mut counter(NEVER, true), eager, KEEP).unwrap().progress.passes, LEAST_PASSES);
        // passes come first where they are fewer
        let few = Stop { passes: 8, ..stop };
        assert!(matches!(run(&mut counter(NEVER, true), few, KEEP).unwrap().ending, Ending::Passes));
        let fewer = run(&mut counter(NEVER, true), Stop { passes: 3, ..stop }, KEEP).unwrap();
        assert!(fewer.errors.is_none() && fewer.progress.error.is_none());
    }

    #[test]
    fn a_failure_saves_the_passes_before() {
        for k in 2..6 {
            let outcome = run(&mut counter(k, true), passes(8), KEEP).unwrap();
            assert!(matches!(outcome.ending, Ending::Failed(EngineError::DeviceLost(_))));
            assert_eq!((shown(&outcome), outcome.progress.passes), ((k - 1) as f32, k - 1));
        }
    }

    #[test]
    fn a_lost_device_leaves_the_last_kept_picture() {
        // Kept after passes 1 to 4; the fifth picture is refused since pass 6 is the one that fails.
        let always = Keep { every: Duration::ZERO, times_cost: 0 };
        let outcome = run(&mut counter(6, false), passes(8), always).unwrap();
        assert!(
            matches!(&outcome.ending, Ending::Failed(EngineError::DeviceLost(_))),
            "{:?}",
            outcome.ending
        );
        assert_eq!((shown(&outcome), outcome.progress.passes), (4.0, 4));
        // With nothing kept there is nothing to give, and the first failure is the one told.
        let error = run(&mut counter(6, false), passes(8), KEEP).unwrap_err();
        assert_eq!(error.to_string(), "the device was lost: in pass 6");
        assert!(run(&mut counter(1, true), passes(8), KEEP).is_err());
    }

    #[test]
    fn short_renders_read_the_picture_once() {
        let mut engine = counter(NEVER, true);
        run(&mut engine, passes(50), KEEP).unwrap();
        assert_eq!(engine.pictures_taken, 1);
    }

    /// With no time between them it is saved after each pass that another one follows, and at the end.
    #[test]
    fn saved_between_passes_and_at_the_end() {
        let saved_at = |fails_in: u32, every: Duration, from: u32| {
            let mut saved = Vec::new();
            let mut save = |engine: &mut dyn Engine, progress: &Progress| {
                saved.push(progress.passes);
                // the engine holds what the progress says
                assert_eq!(engine.picture().unwrap().rgb[0][0], progress.passes as f32);
                Ok(())
            };
            let mut engine = Counter { passes: from, ..counter(fails_in, true) };
            let progress = Progress { passes: from, ..Progress::before(passes(4)) };
            let saving = Saving { every, save: &mut save };
            let outcome =
                resume(&mut engine, progress, &AtomicBool::new(false), &mut |_| (), Some(saving)).unwrap();
            (saved, outcome.progress.passes, engine.passes)
        };
        assert_eq!(saved_at(NEVER, Duration::ZERO, 0), (vec![1, 2, 3, 4], 4, 4));
        assert_eq!(saved_at(NEVER, Duration::MAX, 0), (vec![4], 4, 4));
        assert_eq!(saved_at(3, Duration::ZERO, 0), (vec![1, 2], 2, 2), "nothing of a pass that failed");
        assert_eq!(saved_at(NEVER, Duration::ZERO, 2), (vec![2, 3, 4], 4, 4));
        assert_eq!(saved_at(NEVER, Duration::ZERO, 4), (vec![4], 4, 4), "no pass beyond");
    }

    #[test]
    fn what_cannot_be_saved_for_want_of_the_engine_ends_it() {
        let mut save = |_: &mut dyn Engine, _: &Progress| Err(EngineError::DeviceLost("saving".into()));
        let saving = Saving { every: Duration::ZERO, save: &mut save };
        let mut engine = counter(NEVER, true);
        let progress = Progress::before(passes(4));
        let outcome =
            resume(&mut engine, progress, &AtomicBool::new(false), &mut |_| (), Some(saving)).unwrap();
        assert!(matches!(outcome.ending, Ending::Failed(EngineError::DeviceLost(_))));
        assert_eq!(outcome.progress.passes, 1);
    }

    /// Time and totals count on.
    #[test]
    fn a_resumed_render_counts_on() {
        let hour = Duration::from_secs(3600);
        let stop = Stop { passes: u32::MAX, time: Some(hour), target_error: None };
        let begun = Progress { passes: 3, photons: 30, elapsed: hour, ..Progress::before(stop) };
        let mut engine = Counter { passes: 3, ..counter(NEVER, true) };
        let flag = AtomicBool::new(false);
        let outcome = resume(&mut engine, begun, &flag, &mut |_| (), None).unwrap();
        assert!(matches!(outcome.ending, Ending::Time) && outcome.progress.passes == 3);
        let longer = Progress { stop: passes(5), ..begun };
        let outcome = resume(&mut engine, longer, &flag, &mut |_| (), None).unwrap();
        assert_eq!((outcome.progress.passes, outcome.progress.photons), (5, 50));
        assert!(outcome.progress.elapsed >= hour);
    }

    /// Estimates come after the passes after which they would have come without a stop.
    #[test]
    fn estimates_keep_their_places() {
        let places: Vec<u32> =
            std::iter::successors(Some(LEAST_PASSES), |p| Some(following(*p))).take(60).collect();
        for passes in 0..places[50] {
            let next = places.iter().find(|place| **place >= passes);
            assert_eq!(Some(&Estimates::after(passes).next), next, "{passes}");
        }
        assert_eq!(Estimates::after(u32::MAX).next, u32::MAX);
    }
}
