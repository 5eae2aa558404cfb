//! An engine that fails where it is told to.

use std::cell::RefCell;
use std::rc::Rc;

use caustica::low_level::device::{self, Candidate, Opened, Wanted};
use caustica::low_level::engine::{Engine, EngineError, PassReport, State};
use caustica::low_level::film::exr_file::Channel;
use caustica::low_level::film::{ErrorMap, Picture, Rejections};
use caustica::low_level::memory::Memory;
use caustica::low_level::scene::Scene;
use caustica::low_level::scene::settings::RenderSettings;

/// What an engine is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    /// To be made.
    Open,
    /// To take over.
    Restore,
    /// A pass.
    Pass,
    /// The picture's error.
    Errors,
    /// What it holds.
    Save,
    /// The picture.
    Results,
    /// What belongs to it.
    Layers,
}

/// How it fails.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    /// The device is gone: from then on nothing is to be had of it.
    Lost,
    /// Once, with all that it holds as it was.
    OutOfMemory,
    /// The pass is made, or half made, and then fails: what it holds is no longer what was counted.
    Late,
    /// The driver does not do what it should, as one that leaves loops unfinished.
    Unable,
}

/// All kinds.
pub const FAULTS: [Fault; 4] = [Fault::Lost, Fault::OutOfMemory, Fault::Late, Fault::Unable];

/// What was asked for, and when to fail.
#[derive(Debug, Default)]
pub struct Script {
    /// Everything that was asked for, in its order.
    pub asked: Vec<Step>,
    /// The request that fails, from 0, and how.
    pub fails: Option<(usize, Fault)>,
    gone: bool,
}

/// A script that engine and test share.
pub type Shared = Rc<RefCell<Script>>;

/// A script that lets the given request fail.
pub fn script(fails: Option<(usize, Fault)>) -> Shared {
    Rc::new(RefCell::new(Script { fails, ..Script::default() }))
}

fn lost() -> EngineError {
    EngineError::DeviceLost("as the test wants it".to_owned())
}

/// Whether the request may be carried out; if not, why, and whether it is carried out all the same.
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

/// The CPU engine, as a device that fails as its script says.
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

/// The CPU engine as it is.
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

    fn save(&mut self) -> Result<State, EngineError> {
        self.carry_out(Step::Save, |engine| engine.save())
    }

    fn restore(&mut self, state: &State) -> Result<(), EngineError> {
        self.carry_out(Step::Restore, |engine| engine.restore(state))
    }
}
