//! Devices that fail at every request in turn.
//!
//! Theory: the saved state of a render consists of whole passes, and the result of a pass depends
//! on its number only. So whichever request fails and in whichever way, the next device ends with
//! the bits of a render without failures. Without a next device, a later render can resume from the
//! saved state to the same bits.

mod device;
mod engine;

use std::sync::atomic::AtomicBool;
use std::time::Duration;

use crate::support::bits;
use caustica::low_level::device::{Candidates, Wanted, open};
use caustica::low_level::engine::{Engine, EngineError, State};
use caustica::low_level::kernels::bytes::FILM_BYTES;
use caustica::low_level::memory::Memory;
use caustica::low_level::render::failover::Failover;
use caustica::low_level::render::{Broken, Kept, Outcome, Progress, Saving, Session, Stop, resume};
use caustica::low_level::scene::settings::{Method, Radius, RadiusRule, RenderSettings};
use caustica::low_level::scene::{self, Aovs, Loaded};
use engine::{FAULTS, Fault, Step, candidate, script, successor};

/// Enough passes for an error estimate during the render.
const PASSES: u32 = 5;

fn loaded(change: fn(&mut RenderSettings)) -> Loaded {
    let mut loaded = scene::load("scenes/cornell.toml".as_ref()).unwrap();
    (loaded.scene.film.width, loaded.scene.film.height) = (12, 8);
    loaded.scene.film.aovs = Aovs::parse("all").unwrap();
    loaded.settings.photons = 400;
    loaded.settings.radius = Radius::Pixels(2.0);
    change(&mut loaded.settings);
    loaded
}

fn stop() -> Stop {
    // the target error is never reached, so that no request depends on a clock
    Stop { passes: PASSES, time: None, target_error: Some(1e-9) }
}

/// How often the engine's state is copied.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Copies {
    /// After each pass.
    Always,
    /// Only after a failure.
    Never,
}

/// Renders on these devices, from the state `from`. Also returns the last saved state.
fn render(
    loaded: &Loaded,
    candidates: Candidates,
    copies: Copies,
    from: (&State, Progress),
) -> (Result<Outcome, Broken>, Vec<State>) {
    let mut saved = Vec::new();
    let mut candidates = candidates;
    let memory = Memory::default();
    let never = AtomicBool::new(false);
    let opened = match candidates.open(&loaded.scene, &loaded.settings, &memory, &mut |_, _| ()) {
        Ok(opened) => opened,
        Err(error) => return (Err(Broken { error, kept: None }), saved),
    };
    let mut next = |_: &EngineError, _: &State| -> Option<Result<Box<dyn Engine>, EngineError>> {
        let (_, opened) = candidates.next(&loaded.scene, &loaded.settings, &memory)?;
        Some(opened.map(|opened| opened.engine))
    };
    let mut engines = Failover::new(opened.engine, &mut next);
    let mut save = |state: State, _: &Progress| {
        saved.push(state.clone());
        state
    };
    let every = Duration::ZERO;
    let saving = (copies == Copies::Always).then_some(Saving { every, save: &mut save });
    let session = Session {
        state: from.0,
        progress: from.1,
        interrupted: &never,
        observer: &mut |_| (),
        watchers: &mut [],
        saving,
    };
    let outcome = resume(&mut engines, session);
    (outcome, saved)
}

fn begin(
    loaded: &Loaded,
    candidates: Candidates,
    copies: Copies,
) -> (Result<Outcome, Broken>, Vec<State>) {
    render(loaded, candidates, copies, (&State::before(0), Progress::before(stop())))
}

/// Describes the difference of two outcomes. Ignores times, and the eye paths of fixed visible
/// points, which each device traces again.
fn difference(a: &Outcome, b: &Outcome) -> Option<&'static str> {
    let counts = |p: &Progress| (p.passes, p.photons, p.ends, p.radius.to_bits());
    if bits(&a.picture) != bits(&b.picture) {
        return Some("the picture");
    }
    if a.errors != b.errors {
        return Some("what it says of its error");
    }
    if a.layers != b.layers {
        return Some("the layers");
    }
    if a.rejections != b.rejections {
        return Some("what was left out");
    }
    if counts(&a.progress) != counts(&b.progress) {
        return Some("the counts");
    }
    let fixed = a.progress.eye_paths != u64::from(PASSES) * a.picture.rgb.len() as u64;
    let rays = |p: &Progress| (p.eye_paths, p.rays);
    (!fixed && rays(&a.progress) != rays(&b.progress)).then_some("the rays")
}

/// The requests of a render without failures.
fn steps(loaded: &Loaded, copies: Copies) -> (Outcome, Vec<Step>) {
    let script = script(None);
    let (outcome, _) = begin(loaded, Candidates::from_list([candidate(&script)]), copies);
    (outcome.unwrap(), script.take().asked)
}

type Change = fn(&mut RenderSettings);

const CHANGES: [(&str, Change); 3] = [
    ("sppm", |_| ()),
    ("ppm, local", |s| (s.method, s.radius_rule) = (Method::Ppm, RadiusRule::Local)),
    ("path", |s| s.method = Method::Path),
];

/// Every request of the first device fails in every way, and the second device continues.
#[test]
fn the_next_device_ends_in_the_same_bits() {
    for (name, change) in CHANGES {
        let loaded = loaded(change);
        let without_copies = (name == "sppm").then_some(Copies::Never);
        for copies in [Copies::Always].into_iter().chain(without_copies) {
            let (whole, steps) = steps(&loaded, copies);
            for step in
                [Step::Open, Step::Restore, Step::Pass, Step::Errors, Step::Results, Step::Layers]
            {
                assert!(steps.contains(&step), "{step:?} is never asked for");
            }
            assert_eq!(steps.contains(&Step::Save), copies == Copies::Always);
            for (number, step) in steps.iter().enumerate() {
                for fault in FAULTS {
                    let script = script(Some((number, fault)));
                    let devices = Candidates::from_list([candidate(&script), successor()]);
                    let (outcome, _) = begin(&loaded, devices, copies);
                    let reported =
                        format!("{name}, {copies:?}: {fault:?} at step {number}, {step:?}");
                    let outcome = outcome.unwrap_or_else(|broken| panic!("{reported}: {broken}"));
                    assert_eq!(difference(&whole, &outcome), None, "{reported}");
                }
            }
        }
    }
}

/// Two devices fail one after the other.
#[test]
fn the_third_device_too() {
    let loaded = loaded(|_| ());
    let (whole, steps) = steps(&loaded, Copies::Always);
    for first in (0..steps.len()).step_by(2) {
        for second in 0..4 {
            let scripts = [first, second].map(|number| script(Some((number, Fault::Lost))));
            let devices = Candidates::from_list([
                candidate(&scripts[0]),
                candidate(&scripts[1]),
                successor(),
            ]);
            let outcome = begin(&loaded, devices, Copies::Always).0.unwrap();
            assert_eq!(difference(&whole, &outcome), None, "at steps {first} and {second}");
        }
    }
}

/// Without a next device, a later render resumes to the same bits, and at most the current pass is
/// lost.
#[test]
fn what_is_left_can_be_gone_on_from() {
    for (name, change) in CHANGES {
        let loaded = loaded(change);
        let (whole, steps) = steps(&loaded, Copies::Always);
        for (number, step) in steps.iter().enumerate() {
            for fault in FAULTS {
                let script = script(Some((number, fault)));
                let (outcome, saved) =
                    begin(&loaded, Candidates::from_list([candidate(&script)]), Copies::Always);
                let reported = format!("{name}: {fault:?} at step {number}, {step:?}");
                let Err(Broken { error, kept }) = outcome else {
                    panic!("{reported}: did not fail")
                };
                assert_eq!(error.is_of_device(), fault != Fault::Unable, "{reported}: {error}");
                let made = passes_before(&steps, number);
                let Some(kept) = kept else {
                    assert!(made <= 1, "{reported}: {made} passes are lost");
                    assert!(saved.is_empty(), "{reported}");
                    continue;
                };
                let Kept { state, progress } = *kept;
                assert_eq!(state.passes, progress.passes, "{reported}");
                assert!(
                    made <= progress.passes + 1,
                    "{reported}: {} of {made} passes are left",
                    progress.passes
                );
                assert!(saved.last() == Some(&state), "{reported}: what is left is saved");
                let rest = Candidates::from_list([successor()]);
                let outcome = render(&loaded, rest, Copies::Never, (&state, progress)).0.unwrap();
                assert_eq!(difference(&whole, &outcome), None, "{reported}");
            }
        }
    }
}

/// Number of passes before a request.
fn passes_before(steps: &[Step], number: usize) -> u32 {
    steps[..number].iter().filter(|step| **step == Step::Pass).count() as u32
}

/// The comparison detects a pass that is rendered twice or not at all, and a changed bit.
#[test]
fn planted_differences_are_found() {
    let loaded = loaded(|_| ());
    let whole = steps(&loaded, Copies::Never).0;
    // a state that claims one pass less than it holds, as a careless engine would save it
    let mut opened = open(&Wanted::Cpu, &loaded.scene, &loaded.settings).unwrap();
    for _ in 0..3 {
        opened.engine.pass().unwrap();
    }
    let state = opened.engine.save().unwrap();
    let go_on = |state: &State| {
        let progress = Progress { passes: state.passes, ..Progress::before(stop()) };
        render(&loaded, Candidates::from_list([successor()]), Copies::Never, (state, progress))
            .0
            .unwrap()
    };
    let same = |outcome: &Outcome| outcome.picture == whole.picture;
    assert!(same(&go_on(&state)));
    assert!(!same(&go_on(&State { passes: 2, ..state.clone() })), "a pass twice");
    assert!(!same(&go_on(&State { passes: 4, ..state.clone() })), "a pass left out");
    let mut bit = state.clone();
    bit.film.iter_mut().skip(1).step_by(FILM_BYTES).for_each(|byte| *byte ^= 1);
    assert!(!same(&go_on(&bit)), "a bit of each pixel");
    let mut counts = go_on(&state);
    (counts.errors, counts.rejections) = (whole.errors.clone(), whole.rejections);
    assert_eq!(difference(&whole, &counts), Some("the counts"), "those of three passes");
}
