//! Adapters, selection of one, and an open device that reports failures as errors instead of
//! panicking.

use super::visible::adapters;
use crate::engine::EngineError;
use std::sync::{Arc, Mutex, PoisonError};

/// Type of an adapter.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum AdapterKind {
    /// Discrete graphics card.
    Discrete,
    /// GPU integrated with the processor.
    Integrated,
    /// A share of a GPU in a virtual machine.
    Virtual,
    /// Hardware of unknown type.
    Other,
    /// A driver that runs shaders on the CPU, such as lavapipe.
    Software,
}

/// Properties of an adapter that are known before opening it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AdapterSummary {
    /// Name.
    pub name: String,
    /// Type of the adapter.
    pub kind: AdapterKind,
    /// Graphics interface: vulkan, metal, dx12, ...
    pub backend: String,
    /// Driver and version.
    pub driver: String,
    /// Greatest size of a storage binding, bytes.
    pub binding_bytes: u64,
    /// Greatest size of a buffer, bytes.
    pub buffer_bytes: u64,
    /// Greatest number of storage buffers that a kernel can bind.
    pub storage_buffers: u32,
    /// Greatest number of invocations in a workgroup.
    pub workgroup_invocations: u32,
}

impl AdapterSummary {
    /// Returns true if the kernels can run: 8 storage buffers and workgroups of 256 invocations.
    pub fn fits(&self) -> bool {
        self.storage_buffers >= 8 && self.workgroup_invocations >= 256
    }
}

/// Criterion that selects the adapter to open.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum AdapterChoice {
    /// The first hardware GPU.
    Hardware,
    /// The first software driver.
    Software,
    /// First adapter whose name contains this text, ignoring case.
    Named(String),
}

impl AdapterChoice {
    fn takes(&self, summary: &AdapterSummary) -> bool {
        match self {
            Self::Hardware => summary.kind != AdapterKind::Software,
            Self::Software => summary.kind == AdapterKind::Software,
            Self::Named(name) => holds(&summary.name, name),
        }
    }
}

pub(super) fn holds(text: &str, part: &str) -> bool {
    text.to_lowercase().contains(&part.to_lowercase())
}

pub(super) fn summarize(adapter: &wgpu::Adapter) -> AdapterSummary {
    let info = adapter.get_info();
    let limits = adapter.limits();
    let kind = match info.device_type {
        wgpu::DeviceType::DiscreteGpu => AdapterKind::Discrete,
        wgpu::DeviceType::IntegratedGpu => AdapterKind::Integrated,
        wgpu::DeviceType::VirtualGpu => AdapterKind::Virtual,
        wgpu::DeviceType::Cpu => AdapterKind::Software,
        wgpu::DeviceType::Other => AdapterKind::Other,
    };
    AdapterSummary {
        name: info.name,
        kind,
        backend: info.backend.to_string(),
        driver: format!("{} {}", info.driver, info.driver_info).trim().to_owned(),
        binding_bytes: limits.max_storage_buffer_binding_size,
        buffer_bytes: limits.max_buffer_size,
        storage_buffers: limits.max_storage_buffers_per_shader_stage,
        workgroup_invocations: limits.max_compute_invocations_per_workgroup,
    }
}

/// Adapters that the kernels can run on, hardware first, restricted by `WGPU_BACKEND` and
/// `WGPU_ADAPTER_NAME`.
pub fn list() -> Vec<AdapterSummary> {
    adapters().iter().map(|(_, summary)| summary.clone()).collect()
}

/// Failures since the last check, and whether the device is permanently lost.
#[derive(Debug, Default)]
struct Failures {
    first: Option<EngineError>,
    lost: Option<String>,
}

type Failure = Arc<Mutex<Failures>>;

/// Open device.
pub struct Gpu {
    /// wgpu's device.
    pub device: wgpu::Device,
    /// Its queue.
    pub queue: wgpu::Queue,
    /// Properties of its adapter.
    pub summary: AdapterSummary,
    failure: Failure,
}

impl Gpu {
    /// Opens the adapter of `choice` with the adapter's limits.
    pub fn open(choice: &AdapterChoice) -> Result<Self, EngineError> {
        let found = adapters().iter().find(|(_, summary)| choice.takes(summary));
        let (adapter, summary) = found.ok_or_else(|| {
            EngineError::Unsupported(format!("there is no adapter for {choice:?}"))
        })?;
        let descriptor = wgpu::DeviceDescriptor {
            label: Some("caustica"),
            // timestamp queries, if supported, for timed passes
            required_features: adapter.features() & wgpu::Features::TIMESTAMP_QUERY,
            required_limits: adapter.limits(),
            ..Default::default()
        };
        let (device, queue) = pollster::block_on(adapter.request_device(&descriptor))
            .map_err(|e| EngineError::DeviceLost(format!("{} does not open: {e}", summary.name)))?;
        let failure = Failure::default();
        let uncaptured = failure.clone();
        device.on_uncaptured_error(Arc::new(move |error| {
            record(&uncaptured, as_engine_error(&error))
        }));
        let lost = failure.clone();
        device.set_device_lost_callback(move |_, message| {
            record(&lost, EngineError::DeviceLost(message))
        });
        Ok(Self { device, queue, summary: summary.clone(), failure })
    }

    /// Returns true if the device has a clock that can time kernels.
    pub fn has_clock(&self) -> bool {
        self.device.features().contains(wgpu::Features::TIMESTAMP_QUERY)
    }

    /// Returns the failure since the last check, if any. A lost device stays lost.
    pub fn check(&self) -> Result<(), EngineError> {
        let mut failures = self.failure.lock().unwrap_or_else(PoisonError::into_inner);
        let lost = failures.lost.clone().map(EngineError::DeviceLost);
        lost.or(failures.first.take()).map_or(Ok(()), Err)
    }

    /// Makes the driver lose the device, as in a reset; for tests.
    pub fn lose(&self) {
        self.device.destroy();
    }

    /// Waits until all submitted work is complete.
    pub fn wait(&self) -> Result<(), EngineError> {
        let polled = self.device.poll(wgpu::PollType::wait_indefinitely());
        self.check()?;
        polled.map(|_| ()).map_err(|e| EngineError::DeviceLost(e.to_string()))
    }
}

/// Stores the first failure; later ones are its consequences.
fn record(failure: &Failure, error: EngineError) {
    let mut failures = failure.lock().unwrap_or_else(PoisonError::into_inner);
    if let EngineError::DeviceLost(text) = &error {
        failures.lost.get_or_insert_with(|| text.clone());
    }
    failures.first.get_or_insert(error);
}

fn as_engine_error(error: &wgpu::Error) -> EngineError {
    match error {
        wgpu::Error::OutOfMemory { .. } => EngineError::OutOfMemory(error.to_string()),
        wgpu::Error::Validation { description, .. } => EngineError::Shader(description.clone()),
        wgpu::Error::Internal { description, .. } => EngineError::DeviceLost(description.clone()),
    }
}
