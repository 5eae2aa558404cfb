//! A real device that is lost during a render.

use caustica::low_level::device::{Candidate, Candidates, Opened};
use caustica::low_level::engine::{Engine, EngineError, MeasuredEngine, PassReport, State};
use caustica::low_level::film::exr_file::Channel;
use caustica::low_level::film::{ErrorMap, Picture, Rejections};
use caustica::low_level::gpu::GpuEngine;
use caustica::low_level::memory::Memory;
use caustica::low_level::pilots::prepare;
use caustica::low_level::plan::Plan;
use caustica::low_level::scene::settings::RenderSettings;
use caustica::low_level::scene::{Loaded, Scene};

use super::engine::{sound, successor};
use super::{Copies, begin, difference, loaded, steps};
use crate::support::software;

fn on_driver(scene: &Scene, settings: &RenderSettings) -> GpuEngine {
    let packed = prepare(scene, scene.film.width, scene.film.height).unwrap();
    let plan = Plan::probed(&packed, settings).on(&scene.film);
    GpuEngine::new(&software(), &packed, plan).unwrap()
}

/// Lavapipe, which is lost before it executes a request.
struct Losing {
    inner: GpuEngine,
    requests_left: u32,
}

impl Losing {
    fn ask(&mut self) -> &mut GpuEngine {
        if self.requests_left == 0 {
            self.inner.lose();
        }
        self.requests_left = self.requests_left.saturating_sub(1);
        &mut self.inner
    }
}

impl Engine for Losing {
    fn device(&self) -> &str {
        self.inner.device()
    }

    fn pass(&mut self) -> Result<PassReport, EngineError> {
        self.ask().pass()
    }

    fn picture(&mut self) -> Result<Picture, EngineError> {
        self.ask().picture()
    }

    fn errors(&mut self) -> Result<ErrorMap, EngineError> {
        self.ask().errors()
    }

    fn rejections(&mut self) -> Result<Rejections, EngineError> {
        self.ask().rejections()
    }

    fn results(&mut self) -> Result<(Picture, Rejections), EngineError> {
        self.ask().results()
    }

    fn layers(&mut self) -> Result<Vec<Channel>, EngineError> {
        self.ask().layers()
    }

    fn can_be_lost(&self) -> bool {
        true
    }

    fn save(&mut self) -> Result<State, EngineError> {
        self.ask().save()
    }

    fn restore(&mut self, state: &State) -> Result<(), EngineError> {
        self.ask().restore(state)
    }
}

fn losing(requests: u32) -> Candidate {
    Candidate::new("lavapipe", move |scene: &Scene, settings: &RenderSettings, memory: &Memory| {
        let opened = sound(scene, settings, memory)?;
        let inner = on_driver(scene, settings);
        Ok(Opened { engine: Box::new(Losing { inner, requests_left: requests }), ..opened })
    })
}

/// A lost device reports the loss at every request, and never returns stale data.
#[test]
fn a_lost_device_says_so() {
    let Loaded { scene, settings, .. } = loaded(|_| ());
    let mut engine = on_driver(&scene, &settings);
    engine.pass().unwrap();
    let state = engine.save().unwrap();
    engine.lose();
    for _ in 0..2 {
        let errors = [
            engine.pass().err(),
            engine.picture().err(),
            engine.errors().err(),
            engine.rejections().err(),
            engine.results().err(),
            engine.save().err(),
            engine.restore(&state).err(),
            engine.gathered().err(),
            engine.content(caustica::low_level::plan::Buffer::Film, 0).err(),
        ];
        for (number, error) in errors.iter().enumerate() {
            assert!(
                matches!(error, Some(EngineError::DeviceLost(_))),
                "request {number}: {error:?}"
            );
        }
    }
}

/// The CPU resumes from the state that was saved.
#[test]
fn the_cpu_goes_on_from_lavapipe() {
    let loaded = loaded(|_| ());
    let (whole, steps) = steps(&loaded, Copies::Always);
    for requests in 0..steps.len() as u32 - 1 {
        let devices = Candidates::from_list([losing(requests), successor()]);
        let outcome = begin(&loaded, devices, Copies::Always).0.unwrap();
        assert_eq!(difference(&whole, &outcome), None, "taken away before request {requests}");
    }
}
