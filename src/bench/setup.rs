//! Creation of an engine for a benchmark, with the time of each step.

use std::time::Instant;

use serde::Serialize;

use crate::cpu::CpuEngine;
use crate::device::{self, DeviceError, DeviceInfo, DeviceKind};
use crate::double;
use crate::engine::{EngineError, MeasuredEngine};
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
    /// Packing of the scene, including the kd-tree.
    pub pack: f64,
    /// Probing of the scene and planning.
    pub plan: f64,
    /// Creation of the engine: buffers, and kernels on a GPU.
    pub engine: f64,
}

/// An engine of either type.
pub enum Runner {
    /// CPU engine.
    Cpu(Box<dyn MeasuredEngine>),
    /// GPU engine, on hardware or a software driver.
    Gpu(Box<GpuEngine>),
}

impl Runner {
    /// Interface common to all engines.
    pub fn engine(&mut self) -> &mut dyn MeasuredEngine {
        match self {
            Self::Cpu(engine) => engine.as_mut(),
            Self::Gpu(engine) => engine.as_mut(),
        }
    }

    /// Interface specific to GPU engines.
    pub fn gpu(&mut self) -> Option<&mut GpuEngine> {
        match self {
            Self::Cpu(_) => None,
            Self::Gpu(engine) => Some(engine),
        }
    }
}

/// An engine that is ready to render, and its inputs.
pub struct Ready {
    /// Engine.
    pub runner: Runner,
    /// Packed scene in f32, even for the f64 engine.
    pub packed: PackedScene,
    /// Plan in f32, even for the f64 engine.
    pub plan: Plan,
    /// Names and sizes in bytes of the engine's buffers, except those of the scene.
    pub buffers: Vec<(&'static str, u64)>,
    /// Setup times.
    pub seconds: SetupSeconds,
}

/// Creates an engine on `device`. If `compiling` is [`Compiling::OneByOne`], a GPU engine is
/// created a second time, after the setup time was measured, to time the compilation of each
/// kernel.
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
