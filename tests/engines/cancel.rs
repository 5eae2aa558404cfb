//! Passes that are given up on request.

use std::thread;
use std::time::{Duration, Instant};

use caustica::low_level::cpu::CpuEngine;
use caustica::low_level::engine::{Cancel, Engine, EngineError, State};
use caustica::low_level::film::Picture;
use caustica::low_level::gpu::GpuEngine;
use caustica::low_level::pack::Packed;
use caustica::low_level::plan::Plan;

use super::agreement::photons;
use crate::scenes::{SCENES, planned};

type Make = fn(&Packed, Plan) -> Box<dyn Engine>;

const ENGINES: [(&str, Make); 2] = [
    ("CPU", |packed, plan| Box::new(CpuEngine::new(packed.clone(), plan))),
    ("lavapipe", |packed, plan| {
        Box::new(GpuEngine::new(&crate::support::software(), packed, plan).unwrap())
    }),
];

fn bits(picture: &Picture) -> Vec<[u32; 3]> {
    picture.rgb.iter().map(|rgb| rgb.map(f32::to_bits)).collect()
}

#[track_caller]
fn cancelled(name: &str, engine: &mut dyn Engine) {
    match engine.pass() {
        Err(EngineError::Cancelled) => {}
        other => panic!("{name}: {other:?}"),
    }
}

/// Theory: a pass that is given up leaves the film, the errors and the state of the passes before
/// it, and another engine that goes on from there ends in the bits of a render that was never
/// interrupted.
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
        // once asked for it stays so
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

/// Theory: steps of the CPU engine and submissions to a GPU take a fraction of a second, so that a
/// pass of a hundred million photons, which takes a minute, ends soon after another thread asks for
/// it.
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
