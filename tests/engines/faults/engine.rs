//! An engine that fails at a chosen request.

use std::cell::RefCell;
use std::rc::Rc;

use caustica::low_level::device::{self, Candidate, Opened, Wanted};
use caustica::low_level::engine::{Engine, EngineError, PassReport, State};
use caustica::low_level::film::exr_file::Channel;
use caustica::low_level::film::{ErrorMap, Picture, Rejections};
use caustica::low_level::memory::Memory;
use caustica::low_level::scene::Scene;
use caustica::low_level::scene::settings::RenderSettings;

/// A request to an engine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    /// Creation.
    Open,
    /// Restoring a state.
    Restore,
    /// A pass.
    Pass,
    /// The error map.
    Errors,
    /// Saving the state.
    Save,
    /// The image.
    Results,
    /// The layers.
    Layers,
}

/// The kind of failure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    /// The device is lost: all later requests fail as well.
    Lost,
    /// A single failure that leaves the state intact.
    OutOfMemory,
    /// The pass is executed, wholly or partly, and then fails: the state no longer matches the
    /// count of passes.
    Late,
    /// The driver misbehaves, like one that leaves loops unfinished.
    Unable,
}

/// All kinds of failure.
pub const FAULTS: [Fault; 4] = [Fault::Lost, Fault::OutOfMemory, Fault::Late, Fault::Unable];

/// The requests so far, and the one that fails.
#[derive(Debug, Default)]
pub struct Script {
    /// All requests, in order.
    pub asked: Vec<Step>,
    /// Index of the failing request, and the kind of failure.
    pub fails: Option<(usize, Fault)>,
    gone: bool,
}

/// A script shared by the engine and the test.
pub type Shared = Rc<RefCell<Script>>;

/// Makes a script in which the given request fails.
pub fn script(fails: Option<(usize, Fault)>) -> Shared {
    Rc::new(RefCell::new(Script { fails, ..Script::default() }))
}

fn lost() -> EngineError {
    EngineError::DeviceLost("as the test wants it".to_owned())
}

/// Records a request. If it fails, the error comes with a flag: whether to execute the request all
/// the same.
fn ask(script: &Shared, step: Step) -> Result<(), (EngineError, bool)> {
    let mut script = script.borrow_mut();
    let number = script.asked.len();
    script.asked.push(step);
    if script.gone {
        return Err((lost(), false));
    }
    match script.fails {
        Some((fails, fault)) if fails == number => Err(match fault {
            Fault::Lost => {
                script.gone = true;
                (lost(), false)
            }
            Fault::OutOfMemory => {
                (EngineError::OutOfMemory("as the test wants it".to_owned()), false)
            }
            Fault::Late => (lost(), true),
            Fault::Unable => {
                (EngineError::Unsupported("loops are left unfinished".to_owned()), false)
            }
        }),
        _ => Ok(()),
    }
}

/// The CPU engine as a device that fails as its script says.
pub fn candidate(script: &Shared) -> Candidate {
    let script = script.clone();
    Candidate::new(
        "a faulty device",
        move |scene: &Scene, settings: &RenderSettings, memory: &Memory| {
            ask(&script, Step::Open).map_err(|(error, _)| error)?;
            let mut opened = sound(scene, settings, memory)?;
            opened.engine = Box::new(Faulty { inner: opened.engine, script });
            opened.name = "a faulty device".to_owned();
            Ok(opened)
        },
    )
}

/// The CPU engine without failures.
pub fn successor() -> Candidate {
    Candidate::new("cpu", sound)
}

pub fn sound(scene: &Scene, settings: &RenderSettings, _: &Memory) -> Result<Opened, EngineError> {
    device::open(&Wanted::Cpu, scene, settings).map_err(|error| match error {
        device::DeviceError::Engine(error) => error,
        other => panic!("{other}"),
    })
}

struct Faulty {
    inner: Box<dyn Engine>,
    script: Shared,
}

impl Faulty {
    fn carry_out<T>(
        &mut self,
        step: Step,
        work: impl FnOnce(&mut dyn Engine) -> Result<T, EngineError>,
    ) -> Result<T, EngineError> {
        match ask(&self.script, step) {
            Ok(()) => work(self.inner.as_mut()),
            Err((error, late)) => {
                if late {
                    work(self.inner.as_mut())?;
                }
                Err(error)
            }
        }
    }
}

impl Engine for Faulty {
    fn device(&self) -> &str {
        "a faulty device"
    }

    fn pass(&mut self) -> Result<PassReport, EngineError> {
        self.carry_out(Step::Pass, |engine| engine.pass())
    }

    fn picture(&mut self) -> Result<Picture, EngineError> {
        self.carry_out(Step::Results, |engine| engine.picture())
    }

    fn errors(&mut self) -> Result<ErrorMap, EngineError> {
        self.carry_out(Step::Errors, |engine| engine.errors())
    }

    fn rejections(&mut self) -> Result<Rejections, EngineError> {
        self.carry_out(Step::Results, |engine| engine.rejections())
    }

    fn results(&mut self) -> Result<(Picture, Rejections), EngineError> {
        self.carry_out(Step::Results, |engine| engine.results())
    }

    fn layers(&mut self) -> Result<Vec<Channel>, EngineError> {
        self.carry_out(Step::Layers, |engine| engine.layers())
    }

    fn can_be_lost(&self) -> bool {
        true
    }

    fn save(&mut self) -> Result<State, EngineError> {
        self.carry_out(Step::Save, |engine| engine.save())
    }

    fn restore(&mut self, state: &State) -> Result<(), EngineError> {
        self.carry_out(Step::Restore, |engine| engine.restore(state))
    }
}
