//! Device selection: lists the devices, resolves a request, and creates an engine on a device.

mod candidates;

use thiserror::Error;

use crate::cpu::CpuEngine;
use crate::double;
use crate::engine::{Engine, EngineError, Space};
use crate::gpu::{self, AdapterChoice, AdapterKind, AdapterSummary, GpuEngine};
use crate::kernels::records::VisiblePoint;
use crate::memory::{self, Memory, can_be_had, total};
use crate::pack::PackedScene;
use crate::pilots::{self, prepare, probe};
use crate::plan::{self, BufferPlace, Plan};
use crate::prepare::radius::Automatic;
use crate::scene::Scene;
use crate::scene::settings::{Method, Radius, RenderSettings};

pub use candidates::{Candidate, Candidates};

/// Number of visible points per tile if a GPU runs out of memory with the whole image.
const SMALL_TILE: u32 = 1 << 16;
/// Greatest number of visible points of an image, whose indices are 32 bits wide.
const POINTS_MAX: u64 = 1 << 31;

/// Requested device.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Wanted {
    /// A hardware GPU, else the CPU, which is several times faster than a software driver.
    Auto,
    /// The first hardware GPU.
    Gpu,
    /// The first software driver, such as lavapipe.
    Software,
    /// The Rust engine.
    Cpu,
    /// The Rust engine in f64.
    CpuDouble,
    /// First device whose name contains this text, ignoring case.
    Named(String),
}

/// Parses a `--device` value; an unknown word is taken as a name.
pub fn parse(text: &str) -> Wanted {
    match text.to_ascii_lowercase().as_str() {
        "auto" => Wanted::Auto,
        "gpu" => Wanted::Gpu,
        "software" => Wanted::Software,
        "cpu" => Wanted::Cpu,
        "cpu-f64" => Wanted::CpuDouble,
        _ => Wanted::Named(text.to_owned()),
    }
}

/// Type of a device.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DeviceKind {
    /// A hardware GPU.
    Gpu,
    /// A driver that runs shaders on the CPU.
    Software,
    /// The Rust engine.
    Cpu,
    /// The Rust engine in f64: the same passes with the same random numbers, to measure the error
    /// of f32.
    CpuDouble,
}

impl DeviceKind {
    /// `--device` word of the kind.
    pub fn word(self) -> &'static str {
        match self {
            Self::Gpu => "gpu",
            Self::Software => "software",
            Self::Cpu => "cpu",
            Self::CpuDouble => "cpu-f64",
        }
    }

    /// Width of the kernels' floating-point numbers, bits.
    pub fn bits(self) -> u32 {
        if self == Self::CpuDouble { 64 } else { 32 }
    }
}

/// Device that can render.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DeviceInfo {
    /// Name, as printed and as accepted by `--device`.
    pub name: String,
    /// Type of the device.
    pub kind: DeviceKind,
    /// Driver and its version; for the CPU, the number of threads.
    pub driver: String,
    /// Limits that renders depend on: description, and a number or size in bytes.
    pub limits: Vec<(String, u64)>,
}

/// Engine that is ready to run passes.
pub struct Opened {
    /// The engine.
    pub engine: Box<dyn Engine>,
    /// Name of its device.
    pub name: String,
    /// Type of its device.
    pub kind: DeviceKind,
    /// Reason for choosing this device.
    pub why: String,
    /// Settings in force: as requested, with a chosen radius in place of "auto".
    pub settings: RenderSettings,
    /// Measures taken to fit into memory, if any.
    pub cut: Option<String>,
    /// Explanation of the automatically chosen radius; `None` if the settings fix it or it is
    /// unused.
    pub radius: Option<Automatic>,
    /// Converts scene units to world units.
    pub space: Space,
    /// Kinds of light that the image and its error estimate may lack, if any.
    pub warnings: Vec<String>,
}

/// Failure to create an engine.
#[derive(Debug, Error)]
pub enum DeviceError {
    /// No device matches the request.
    #[error("there is no device `{wanted}`")]
    NoSuchDevice {
        /// The request, as written.
        wanted: String,
        /// Names of the available devices.
        available: Vec<String>,
    },
    /// The device cannot render the scene.
    #[error(transparent)]
    Engine(#[from] EngineError),
}

/// All devices; the CPU comes last, in f32 and in f64.
pub fn list() -> Vec<DeviceInfo> {
    let adapters = gpu::list().into_iter().filter(AdapterSummary::fits).map(|a| DeviceInfo {
        name: a.name.clone(),
        kind: if a.kind == AdapterKind::Software { DeviceKind::Software } else { DeviceKind::Gpu },
        driver: format!("{}, {}", a.backend, a.driver),
        limits: vec![
            ("bytes in a binding".to_owned(), a.binding_bytes),
            ("bytes in a buffer".to_owned(), a.buffer_bytes),
            ("storage buffers in a kernel".to_owned(), a.storage_buffers as u64),
            ("invocations in a workgroup".to_owned(), a.workgroup_invocations as u64),
        ],
    });
    adapters.chain([cpu(DeviceKind::Cpu), cpu(DeviceKind::CpuDouble)]).collect()
}

fn cpu(kind: DeviceKind) -> DeviceInfo {
    DeviceInfo {
        name: kind.word().to_owned(),
        kind,
        driver: format!("{} threads", rayon::current_num_threads()),
        limits: Vec::new(),
    }
}

/// Device that matches a request, and the reason for the choice.
pub fn pick<'a>(
    wanted: &Wanted,
    devices: &'a [DeviceInfo],
) -> Result<(&'a DeviceInfo, String), DeviceError> {
    let of_kind = |kind| devices.iter().find(|device| device.kind == kind);
    let (found, why) = match wanted {
        Wanted::Gpu => (of_kind(DeviceKind::Gpu), "asked for"),
        Wanted::Software => (of_kind(DeviceKind::Software), "asked for"),
        Wanted::Cpu => (of_kind(DeviceKind::Cpu), "asked for"),
        Wanted::CpuDouble => (of_kind(DeviceKind::CpuDouble), "asked for"),
        Wanted::Named(name) => {
            let name = name.to_lowercase();
            (
                devices.iter().find(|device| device.name.to_lowercase().contains(&name)),
                "asked for by name",
            )
        }
        Wanted::Auto => match of_kind(DeviceKind::Gpu) {
            Some(device) => (Some(device), "auto: a hardware GPU"),
            None => (
                of_kind(DeviceKind::Cpu),
                "auto: no hardware GPU; software drivers are slower than the CPU engine",
            ),
        },
    };
    match found {
        Some(device) => Ok((device, why.to_owned())),
        None => Err(DeviceError::NoSuchDevice {
            wanted: match wanted {
                Wanted::Auto => "auto".to_owned(),
                Wanted::Gpu => DeviceKind::Gpu.word().to_owned(),
                Wanted::Software => DeviceKind::Software.word().to_owned(),
                Wanted::Cpu => DeviceKind::Cpu.word().to_owned(),
                Wanted::CpuDouble => DeviceKind::CpuDouble.word().to_owned(),
                Wanted::Named(name) => name.clone(),
            },
            available: devices.iter().map(|device| device.name.clone()).collect(),
        }),
    }
}

/// Creates an engine for a scene on the requested device; for `auto`, on the first that can render
/// it. Path tracing runs only on the CPU, so `auto` then takes it.
pub fn open(
    wanted: &Wanted,
    scene: &Scene,
    settings: &RenderSettings,
) -> Result<Opened, DeviceError> {
    let mut candidates = Candidates::of(wanted, settings)?;
    Ok(candidates.open(scene, settings, &Memory::default(), &mut |name, error| {
        log::warn!("{name} cannot render this: {error}");
    })?)
}

/// Fails if an image has more visible points than can be indexed.
pub fn check_points(
    device: &DeviceInfo,
    scene: &Scene,
    settings: &RenderSettings,
) -> Result<(), EngineError> {
    let film = &scene.film;
    let samples = if settings.method == Method::Ppm { settings.eye_samples as u64 } else { 1 };
    let points = film.width as u64 * film.height as u64 * samples;
    if points > POINTS_MAX {
        let bytes = match device.kind {
            DeviceKind::CpuDouble => size_of::<double::kernels::records::VisiblePoint>(),
            _ => size_of::<VisiblePoint>(),
        } as u64;
        return Err(EngineError::TooLarge {
            what: format!("a picture of {} x {} pixels", film.width, film.height),
            needed: points * bytes,
            device: device.name.clone(),
            limit: POINTS_MAX * bytes,
            mend: "make width, height or eye_samples smaller".to_owned(),
        });
    }
    Ok(())
}

fn start(
    device: &DeviceInfo,
    why: String,
    scene: &Scene,
    settings: &RenderSettings,
    memory: &Memory,
) -> Result<Opened, EngineError> {
    check_points(device, scene, settings)?;
    let film = &scene.film;
    let packed = prepare(scene, film.width, film.height)?;
    let warnings = packed.warnings(scene, settings);
    let opened = |engine, settings, radius, space, cut| Opened {
        warnings: warnings.clone(),
        engine,
        name: device.name.clone(),
        kind: device.kind,
        why,
        settings,
        cut,
        radius,
        space,
    };
    if device.kind == DeviceKind::CpuDouble {
        let (wide, plan) = in_double(scene, &packed, settings)?;
        let tables = plan::scene_bytes(&packed.tables) + double::plan::scene_bytes(&wide.tables);
        let place = double::plan::BufferPlace::Program { saves: memory.saves };
        let plan = plan.within(tables, place, memory)?;
        let cut = cut(plan.tiled, plan.chunks(), plan.settings.batch, settings.batch);
        let (settings, automatic, space) =
            (plan.settings.clone(), plan.automatic_radius(), plan.space());
        return Ok(opened(
            Box::new(double::cpu::CpuEngine::new(wide, plan)),
            settings,
            automatic,
            space,
            cut,
        ));
    }
    let plan = Plan::new(&packed, settings, probe(&packed, settings)).on(film).within(
        plan::scene_bytes(&packed.tables),
        place(device.kind, memory),
        memory,
    )?;
    let cut = cut(plan.tiled, plan.chunks(), plan.settings.batch, settings.batch);
    let (settings, automatic, space) =
        (plan.settings.clone(), plan.automatic_radius(), plan.space());
    hold(&plan, &packed.tables, place(device.kind, memory))?;
    let engine: Box<dyn Engine> = match device.kind {
        DeviceKind::Cpu => Box::new(CpuEngine::new(packed, plan)),
        _ => Box::new(on_gpu(&AdapterChoice::Named(device.name.clone()), &packed, plan)?),
    };
    Ok(opened(engine, settings, automatic, space, cut))
}

/// Fails if the CPU engine could run out of memory for its buffers during a render.
fn hold(
    plan: &Plan,
    scene: &crate::tables::SceneTables,
    place: BufferPlace,
) -> Result<(), EngineError> {
    let parts = plan.memory(plan::scene_bytes(scene), place);
    match place {
        BufferPlace::Program { .. } if !can_be_had(total(&parts)) => {
            let largest =
                parts.iter().max_by_key(|part| part.bytes).map_or("nothing", |part| part.what);
            let needed = memory::words(total(&parts));
            Err(EngineError::OutOfMemory(format!(
                "{needed} for the render, most of it for {largest}"
            )))
        }
        _ => Ok(()),
    }
}

/// Location of the buffers of a device of this kind.
fn place(kind: DeviceKind, memory: &Memory) -> BufferPlace {
    match kind {
        DeviceKind::Cpu | DeviceKind::CpuDouble => BufferPlace::Program { saves: memory.saves },
        DeviceKind::Software => BufferPlace::Device { in_main_memory: true },
        DeviceKind::Gpu => BufferPlace::Device { in_main_memory: false },
    }
}

/// Creates an engine on a GPU; if its memory does not suffice, in tiles.
fn on_gpu(
    choice: &AdapterChoice,
    packed: &PackedScene,
    plan: Plan,
) -> Result<GpuEngine, EngineError> {
    let tiled = (!plan.tiled).then(|| plan.clone().in_tiles(SMALL_TILE));
    match (GpuEngine::new(choice, packed, plan), tiled) {
        (Err(EngineError::OutOfMemory(text)), Some(tiled)) => {
            log::warn!("out of memory: {text}; once more in {} tiles", tiled.chunks());
            GpuEngine::new(choice, packed, tiled)
        }
        (made, _) => made,
    }
}

/// Describes the measures taken so that a plan fits, if any.
fn cut(tiled: bool, tiles: u32, batch: Option<u32>, asked: Option<u32>) -> Option<String> {
    let smaller = batch.filter(|_| batch != asked);
    let batches = smaller.map_or(String::new(), |photons| {
        format!(", photons in batches of {photons}, which rounds their sums otherwise")
    });
    let cut = tiled.then(|| format!("rendered in {tiles} tiles to save memory{batches}"));
    if let Some(cut) = &cut {
        log::info!("{cut}");
    }
    cut
}

/// Scene and plan of the f64 engine; `single` is the scene packed in f32.
pub fn in_double(
    scene: &Scene,
    single: &PackedScene,
    settings: &RenderSettings,
) -> Result<(double::pack::PackedScene, double::plan::Plan), EngineError> {
    let film = &scene.film;
    // take learned and automatic values from the f32 engine, so that both render the same
    let packed =
        double::pilots::prepare_like(scene, film.width, film.height, &pilots::learned(single))?;
    let settings = &match settings.radius {
        Radius::Auto => Plan::probed(single, settings).settings,
        _ => settings.clone(),
    };
    let plan = double::plan::Plan::probed(&packed, settings).on(film);
    Ok((packed, plan))
}

/// Theory: the order of preference is hardware, then the CPU, regardless of the order of the list.
#[cfg(test)]
mod tests {
    use super::*;

    fn device(name: &str, kind: DeviceKind) -> DeviceInfo {
        DeviceInfo { name: name.into(), kind, driver: String::new(), limits: Vec::new() }
    }

    fn picked(wanted: &str, devices: &[DeviceInfo]) -> Option<String> {
        pick(&parse(wanted), devices).ok().map(|(device, _)| device.name.clone())
    }

    #[test]
    fn preference_and_names() {
        let all = [
            device("cpu", DeviceKind::Cpu),
            device("llvmpipe (LLVM 15)", DeviceKind::Software),
            device("NVIDIA X", DeviceKind::Gpu),
            device("Radeon Y", DeviceKind::Gpu),
            device("cpu-f64", DeviceKind::CpuDouble),
        ];
        let is = |wanted, devices: &[DeviceInfo], name: &str| {
            assert_eq!(picked(wanted, devices).as_deref(), Some(name), "{wanted}");
        };
        is("auto", &all, "NVIDIA X");
        is("auto", &all[..2], "cpu");
        is("auto", &all[..1], "cpu");
        is("gpu", &all, "NVIDIA X");
        is("Software", &all, "llvmpipe (LLVM 15)");
        is("cpu", &all, "cpu");
        is("cpu-f64", &all, "cpu-f64");
        is("radeon", &all, "Radeon Y");
        assert_eq!(picked("gpu", &all[..2]), None);
        let Err(DeviceError::NoSuchDevice { wanted, available }) = pick(&parse("Arc"), &all[..2])
        else {
            panic!("there is no Arc");
        };
        assert_eq!((wanted.as_str(), available.len()), ("Arc", 2));
    }
}
