//! Devices that match a request, in the order of trial: if one fails, the next may continue.

use std::collections::VecDeque;

use super::{DeviceError, DeviceInfo, DeviceKind, Opened, Wanted, cpu, list, pick, start};
use crate::engine::EngineError;
use crate::memory::Memory;
use crate::scene::Scene;
use crate::scene::settings::{Method, RenderSettings};

/// Creates an engine for a scene.
type Open = Box<dyn FnOnce(&Scene, &RenderSettings, &Memory) -> Result<Opened, EngineError>>;

/// Device that may be tried.
pub struct Candidate {
    name: String,
    open: Open,
}

impl Candidate {
    /// Creates a candidate from the caller's function, such as one for an engine that fails
    /// deliberately.
    pub fn new(
        name: impl Into<String>,
        open: impl FnOnce(&Scene, &RenderSettings, &Memory) -> Result<Opened, EngineError> + 'static,
    ) -> Self {
        Self { name: name.into(), open: Box::new(open) }
    }

    /// Name of the device.
    pub fn name(&self) -> &str {
        &self.name
    }

    fn of(device: &DeviceInfo, why: String) -> Self {
        let device = device.clone();
        Self::new(device.name.clone(), move |scene, settings, memory| {
            log::info!("{} [{}] {} ({why})", device.name, device.kind.word(), device.driver);
            start(&device, why, scene, settings, memory)
        })
    }
}

/// Devices that have not been tried yet, in the order of trial.
pub struct Candidates(VecDeque<Candidate>);

impl Candidates {
    /// Devices that match a request: one, or for `auto` all hardware GPUs and then the CPU in f32,
    /// which is faster than a software driver.
    pub fn of(wanted: &Wanted, settings: &RenderSettings) -> Result<Self, DeviceError> {
        let path = Self::is_path_on_cpu(wanted, settings);
        let wanted = if path { &Wanted::Cpu } else { wanted };
        // do not list devices unnecessarily: drivers take a while to respond and may write to
        // standard error
        let devices = match wanted {
            Wanted::Cpu => vec![cpu(DeviceKind::Cpu)],
            Wanted::CpuDouble => vec![cpu(DeviceKind::CpuDouble)],
            _ => list(),
        };
        for DeviceInfo { name, kind, driver, .. } in &devices {
            log::debug!("there is {name} [{}] {driver}", kind.word());
        }
        let (first, why) = pick(wanted, &devices)?;
        let why = if path { "auto: path tracing runs on the CPU".to_owned() } else { why };
        let mut candidates = vec![Candidate::of(first, why)];
        if *wanted == Wanted::Auto {
            candidates.extend(successors(first, &devices).into_iter().map(|next| {
                Candidate::of(next, "auto: the next after one that failed".to_owned())
            }));
        }
        Ok(Self(candidates.into()))
    }

    /// Returns true if `auto` takes the CPU regardless of other devices, since path tracing runs
    /// only there.
    pub fn is_path_on_cpu(wanted: &Wanted, settings: &RenderSettings) -> bool {
        settings.method == Method::Path && *wanted == Wanted::Auto
    }

    /// Creates the list from the given candidates, in their order.
    pub fn from_list(candidates: impl IntoIterator<Item = Candidate>) -> Self {
        Self(candidates.into_iter().collect())
    }

    /// Opens an engine on the next candidate and returns it with the candidate's name; `None` if
    /// none is left.
    pub fn next(
        &mut self,
        scene: &Scene,
        settings: &RenderSettings,
        memory: &Memory,
    ) -> Option<(String, Result<Opened, EngineError>)> {
        let Candidate { name, open } = self.0.pop_front()?;
        Some((name, open(scene, settings, memory)))
    }

    /// Opens an engine on the first candidate that can render the scene; `refused` receives the
    /// errors of those before it.
    ///
    /// # Errors
    /// The error of the last candidate, or an error in the scene, which would occur on every
    /// device.
    pub fn open(
        &mut self,
        scene: &Scene,
        settings: &RenderSettings,
        memory: &Memory,
        refused: &mut dyn FnMut(&str, &EngineError),
    ) -> Result<Opened, EngineError> {
        let mut last = EngineError::Unsupported("there is no device to try".to_owned());
        while let Some((name, opened)) = self.next(scene, settings, memory) {
            match opened {
                Ok(opened) => return Ok(opened),
                Err(error) if error.is_of_scene() || self.0.is_empty() => return Err(error),
                Err(error) => {
                    refused(&name, &error);
                    last = error;
                }
            }
        }
        Err(last)
    }
}

/// Devices that `auto` tries after the first: other hardware GPUs, then the CPU. There is none
/// after the CPU.
fn successors<'a>(first: &DeviceInfo, devices: &'a [DeviceInfo]) -> Vec<&'a DeviceInfo> {
    let of_kind = |kind| {
        devices.iter().filter(move |device| device.kind == kind && first.kind == DeviceKind::Gpu)
    };
    let others = of_kind(DeviceKind::Gpu).filter(|device| device.name != first.name);
    others.chain(of_kind(DeviceKind::Cpu)).collect()
}

/// Theory: after a GPU come the other GPUs and the CPU, once each; after the CPU comes nothing.
#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_is_tried_once() {
        let device = |name: &str, kind| DeviceInfo {
            name: name.into(),
            kind,
            driver: String::new(),
            limits: Vec::new(),
        };
        let all = [
            device("A", DeviceKind::Gpu),
            device("llvmpipe", DeviceKind::Software),
            device("B", DeviceKind::Gpu),
            device("cpu", DeviceKind::Cpu),
            device("cpu-f64", DeviceKind::CpuDouble),
        ];
        let names = |first: usize| -> Vec<&str> {
            successors(&all[first], &all).iter().map(|device| device.name.as_str()).collect()
        };
        assert_eq!(names(0), ["B", "cpu"]);
        assert_eq!(names(2), ["A", "cpu"]);
        assert!(names(3).is_empty());
    }
}
