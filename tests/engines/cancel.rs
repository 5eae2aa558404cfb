//! Cancelled passes.

use std::thread;
use std::time::{Duration, Instant};

use caustica::low_level::cpu::CpuEngine;
use caustica::low_level::engine::{Cancel, Engine, EngineError, State};
use caustica::low_level::gpu::GpuEngine;
use caustica::low_level::pack::PackedScene;
use caustica::low_level::plan::Plan;

use super::agreement::photons;
use crate::scenes::{SCENES, planned};
use crate::support::{bits, software};

type Make = fn(&PackedScene, Plan) -> Box<dyn Engine>;

const ENGINES: [(&str, Make); 2] = [
    ("CPU", |packed, plan| Box::new(CpuEngine::new(packed.clone(), plan))),
    ("lavapipe", |packed, plan| Box::new(GpuEngine::new(&software(), packed, plan).unwrap())),
];

#[track_caller]
fn cancelled(name: &str, engine: &mut dyn Engine) {
    match engine.pass() {
        Err(EngineError::Cancelled) => {}
        other => panic!("{name}: {other:?}"),
    }
}

/// Theory: a cancelled pass leaves film, errors and state as they were after the previous pass.
/// Another engine that resumes from there ends with the bits of an uninterrupted render.
#[test]
fn what_was_done_before_stays() {
    let (_, settings, rest) = SCENES[0];
    let (packed, plan) = planned(settings, rest);
    for (name, make) in ENGINES {
        let cancel = Cancel::default();
        let mut engine = make(&packed, Plan { cancel: cancel.clone(), ..plan.clone() });
        let mut whole = make(&packed, plan.clone());
        for _ in 0..2 {
            assert_eq!(engine.pass().unwrap(), whole.pass().unwrap(), "{name}");
        }
        cancel.ask();
        cancelled(name, engine.as_mut());
        // a cancelled plan stays cancelled
        cancelled(name, engine.as_mut());
        assert_eq!(bits(&engine.picture().unwrap()), bits(&whole.picture().unwrap()), "{name}");
        assert_eq!(engine.errors().unwrap().pixels, whole.errors().unwrap().pixels, "{name}");
        let state: State = engine.save().unwrap();
        assert!(state == whole.save().unwrap() && state.passes == 2, "{name}");
        let mut next = make(&packed, plan.clone());
        next.restore(&state).unwrap();
        assert_eq!(next.pass().unwrap(), whole.pass().unwrap(), "{name}");
        assert_eq!(bits(&next.picture().unwrap()), bits(&whole.picture().unwrap()), "{name}");
    }
}

/// Theory: steps of the CPU engine and submissions to a GPU take a fraction of a second. So a pass
/// of a hundred million photons, which takes a minute, ends soon after another thread cancels it.
#[test]
fn a_long_pass_ends_soon() {
    let (_, settings, rest) = SCENES[0];
    let (packed, plan) = planned(settings, rest);
    let long = Plan::probed(&packed, &photons(100_000_000, &plan));
    for (name, make) in ENGINES {
        let cancel = Cancel::default();
        let mut engine = make(&packed, Plan { cancel: cancel.clone(), ..long.clone() });
        let asking = thread::spawn(move || {
            thread::sleep(Duration::from_millis(500));
            cancel.ask();
            Instant::now()
        });
        cancelled(name, engine.as_mut());
        let waited = asking.join().unwrap().elapsed();
        println!("{name}: {waited:?}");
        assert!(waited < Duration::from_secs(4), "{name}: {waited:?}");
        assert_eq!(engine.save().map_or(0, |state| state.passes), 0, "{name}");
    }
}
