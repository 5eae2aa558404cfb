//! An engine for a bench, with the seconds that each step to it took.

use std::time::Instant;

use serde::Serialize;

use crate::cpu::CpuEngine;
use crate::device::{self, DeviceError, DeviceInfo, DeviceKind};
use crate::double;
use crate::engine::{Engine, EngineError};
use crate::gpu::program::Compiling;
use crate::gpu::{AdapterChoice, GpuEngine};
use crate::pack::PackedScene;
use crate::pilots::prepare;
use crate::plan::Plan;
use crate::scene::Scene;
use crate::scene::settings::RenderSettings;

/// Seconds of the steps from a scene to an engine.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct SetupSeconds {
    /// The scene into tables, with its kd-tree.
    pub pack: f64,
    /// The look at the scene and the plan.
    pub plan: f64,
    /// The engine: buffers, and on a GPU the kernels.
    pub engine: f64,
}

/// An engine of one kind or the other.
pub enum Runner {
    /// On the processor.
    Cpu(Box<dyn Engine>),
    /// On a GPU or a software driver.
    Gpu(Box<GpuEngine>),
}

impl Runner {
    /// What all engines have.
    pub fn engine(&mut self) -> &mut dyn Engine {
        match self {
            Self::Cpu(engine) => engine.as_mut(),
            Self::Gpu(engine) => engine.as_mut(),
        }
    }

    /// What those on a GPU have.
    pub fn gpu(&mut self) -> Option<&mut GpuEngine> {
        match self {
            Self::Cpu(_) => None,
            Self::Gpu(engine) => Some(engine),
        }
    }
}

/// An engine, ready for passes, and what it was made of.
pub struct Ready {
    /// The engine.
    pub runner: Runner,
    /// The tables, in f32 whatever the device.
    pub packed: PackedScene,
    /// The plan, in f32 whatever the device.
    pub plan: Plan,
    /// Bytes of the engine's buffers beside the scene's, by name.
    pub buffers: Vec<(&'static str, u64)>,
    /// What it took.
    pub seconds: SetupSeconds,
}

/// Makes an engine on `device`, and if kernels are to be compiled one by one, after its time was
/// taken another.
pub fn ready(
    device: &DeviceInfo,
    scene: &Scene,
    settings: &RenderSettings,
    compiling: Compiling,
) -> Result<Ready, DeviceError> {
    device::check_points(device, scene, settings)?;
    let (width, height) = (scene.film.width, scene.film.height);
    let (packed, pack_seconds) =
        timed(|| prepare(scene, width, height).map_err(EngineError::from))?;
    let (plan, plan_seconds) = timed(|| Ok(Plan::probed(&packed, settings)))?;
    let mut buffers: Vec<_> =
        plan.buffers().into_iter().map(|(b, bytes)| (b.name(), bytes)).collect();
    let choice = AdapterChoice::Named(device.name.clone());
    let (runner, engine) = timed(|| match device.kind {
        DeviceKind::Cpu => Ok(Runner::Cpu(Box::new(CpuEngine::new(packed.clone(), plan.clone())))),
        DeviceKind::CpuDouble => {
            let packed = double::pilots::prepare(scene, width, height)?;
            let plan = double::plan::Plan::probed(&packed, settings);
            buffers = plan.buffers().into_iter().map(|(b, bytes)| (b.name(), bytes)).collect();
            Ok(Runner::Cpu(Box::new(double::cpu::CpuEngine::new(packed, plan))))
        }
        DeviceKind::Gpu | DeviceKind::Software => {
            GpuEngine::new(&choice, &packed, plan.clone()).map(|made| Runner::Gpu(Box::new(made)))
        }
    })?;
    let runner = match runner {
        Runner::Gpu(made) if compiling == Compiling::OneByOne => {
            drop(made);
            Runner::Gpu(Box::new(GpuEngine::measured(&choice, &packed, plan.clone())?))
        }
        runner => runner,
    };
    let seconds = SetupSeconds { pack: pack_seconds, plan: plan_seconds, engine };
    Ok(Ready { runner, packed, plan, buffers, seconds })
}

fn timed<T>(make: impl FnOnce() -> Result<T, EngineError>) -> Result<(T, f64), EngineError> {
    let begun = Instant::now();
    let made = make()?;
    Ok((made, begun.elapsed().as_secs_f64()))
}
