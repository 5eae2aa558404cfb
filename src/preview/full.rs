//! The full-size render on the requested device, in a separate thread, until it is done or
//! cancelled.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::thread::{self, JoinHandle};
use std::time::Duration;

use super::frame::{FrameSlot, Passes, RenderRequest, Setup};
use super::packed_cache::Prepared;
use crate::cpu::CpuEngine;
use crate::device::{self, DeviceError, DeviceKind, Wanted};
use crate::double;
use crate::engine::{Cancel, Engine, EngineError};
use crate::gpu::{AdapterChoice, GpuEngine};
use crate::plan::Plan;
use crate::scene::settings::Method;
use crate::tables::SceneTables;

/// Time that an idle thread sleeps before it checks for changes.
const NAP: Duration = Duration::from_millis(50);

/// Controls of the render thread.
#[derive(Default)]
struct Control {
    ended: AtomicBool,
    made: AtomicBool,
    paused: AtomicBool,
    cancel: Cancel,
    passes: AtomicU32,
}

/// A full-size render in progress.
pub struct Full {
    control: Arc<Control>,
    thread: JoinHandle<Option<Box<GpuEngine>>>,
}

impl Full {
    /// Starts to render `wish` with a copy of `ground`; `spare` is a GPU engine that can be reused.
    pub fn start(
        number: u64,
        prepared: Prepared,
        request: RenderRequest,
        spare: Option<Box<GpuEngine>>,
        slot: Arc<FrameSlot>,
    ) -> Self {
        let control = Arc::new(Control::default());
        control.passes.store(request.settings.passes, Ordering::Relaxed);
        let own = control.clone();
        let thread = thread::spawn(move || match make(&prepared, &request, &own.cancel, spare) {
            Ok((engine, setup)) => {
                drop(prepared);
                own.made.store(true, Ordering::Relaxed);
                rendered(engine, Passes::new(number, false, setup), &own, number, &slot)
            }
            Err(error) => {
                slot.fail(number, message(&error));
                None
            }
        });
        Self { control, thread }
    }

    /// Sets the number of passes.
    pub fn set_passes(&self, passes: u32) {
        self.control.passes.store(passes, Ordering::Relaxed);
        self.thread.thread().unpark();
    }

    /// Pauses after the current pass, or continues.
    pub fn pause(&self, paused: bool) {
        self.control.paused.store(paused, Ordering::Relaxed);
        self.thread.thread().unpark();
    }

    /// Ends the render and cancels the current pass.
    pub fn end(&self) {
        self.control.ended.store(true, Ordering::Relaxed);
        self.control.cancel.ask();
        self.thread.thread().unpark();
    }

    /// Returns whether the engine is ready, so that the small preview can stop.
    pub fn is_made(&self) -> bool {
        self.control.made.load(Ordering::Relaxed)
    }

    /// Returns whether [`Self::join`] returns at once.
    pub fn is_finished(&self) -> bool {
        self.thread.is_finished()
    }

    /// Waits for the end; returns an engine that the next render can reuse.
    pub fn join(self) -> Option<Box<GpuEngine>> {
        self.thread.join().unwrap_or_default()
    }
}

enum Running {
    Cpu(Box<CpuEngine>),
    Double(Box<double::cpu::CpuEngine>),
    Gpu(Box<GpuEngine>),
}

fn rendered(
    mut running: Running,
    mut passes: Passes,
    control: &Control,
    number: u64,
    slot: &FrameSlot,
) -> Option<Box<GpuEngine>> {
    let engine: &mut dyn Engine = match &mut running {
        Running::Cpu(engine) => engine.as_mut(),
        Running::Double(engine) => engine.as_mut(),
        Running::Gpu(engine) => engine.as_mut(),
    };
    while !control.ended.load(Ordering::Relaxed) {
        let last = control.passes.load(Ordering::Relaxed);
        if passes.done >= last || control.paused.load(Ordering::Relaxed) {
            thread::park_timeout(NAP);
        } else {
            match passes.step(engine, last, slot) {
                Ok(()) | Err(EngineError::Cancelled) => {}
                Err(error) => {
                    // do not reuse a lost device
                    slot.fail(number, error.to_string());
                    return None;
                }
            }
        }
    }
    match running {
        Running::Gpu(engine) => Some(engine),
        _ => None,
    }
}

fn make(
    prepared: &Prepared,
    request: &RenderRequest,
    cancel: &Cancel,
    spare: Option<Box<GpuEngine>>,
) -> Result<(Running, Setup), DeviceError> {
    let path = request.settings.method == Method::Path && request.device == Wanted::Auto;
    let wanted = if path { &Wanted::Cpu } else { &request.device };
    let devices = device::list();
    let (device, why) = device::pick(wanted, &devices)?;
    let prepared = prepared.settled(&request.camera, &request.film)?;
    device::check_points(device, prepared.scene(), &request.settings)?;
    let packed = prepared.packed();
    let plan = Plan {
        cancel: cancel.clone(),
        ..Plan::probed(packed, &request.settings).on(&request.film)
    };
    let setup = Setup {
        device: device.name.clone(),
        why,
        settings: plan.settings.clone(),
        bytes: bytes(&packed.tables, &plan),
    };
    let engine = match device.kind {
        DeviceKind::Cpu => Running::Cpu(Box::new(CpuEngine::new(packed.clone(), plan))),
        DeviceKind::CpuDouble => {
            let (packed, plan) = device::in_double(prepared.scene(), packed, &request.settings)?;
            let plan = double::plan::Plan { cancel: cancel.clone(), ..plan };
            Running::Double(Box::new(double::cpu::CpuEngine::new(packed, plan)))
        }
        _ => Running::Gpu(Box::new(match spare {
            Some(spare) if spare.adapter().name == device.name => spare.renewed(packed, plan)?,
            _ => GpuEngine::new(&AdapterChoice::Named(device.name.clone()), packed, plan)?,
        })),
    };
    Ok((engine, setup))
}

/// Bytes of a scene's tables and of a plan's buffers.
pub(super) fn bytes(scene: &SceneTables, plan: &Plan) -> u64 {
    crate::gpu::sizes(plan, scene).iter().map(|(_, bytes)| bytes).sum()
}

fn message(error: &DeviceError) -> String {
    match error {
        DeviceError::NoSuchDevice { available, .. } => {
            format!("{error}; available: {}", available.join(", "))
        }
        DeviceError::Engine(_) => error.to_string(),
    }
}
