//! Timing of dispatches by the device's clock, if it supports timestamp queries.

use super::context::Gpu;
use crate::engine::EngineError;
use crate::plan::Kernel;

/// Timestamp queries, two per dispatch: its begin and its end.
pub struct Stamps {
    queries: wgpu::QuerySet,
    resolved: wgpu::Buffer,
    /// Seconds per clock tick.
    period: f64,
    /// Kernels of the dispatches in the submission.
    kernels: Vec<Kernel>,
}

impl Stamps {
    /// Creates queries for at most `dispatches` dispatches per submission; `None` if the device
    /// does not support them.
    pub fn new(gpu: &Gpu, dispatches: u32) -> Result<Option<Self>, EngineError> {
        if !gpu.has_clock() {
            return Ok(None);
        }
        let queries = gpu.device.create_query_set(&wgpu::QuerySetDescriptor {
            label: Some("stamps"),
            ty: wgpu::QueryType::Timestamp,
            count: 2 * dispatches,
        });
        let usage = wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC;
        let resolved = gpu.buffer("stamps", 16 * u64::from(dispatches), usage)?;
        let period = f64::from(gpu.queue.get_timestamp_period()) * 1e-9;
        Ok(Some(Self { queries, resolved, period, kernels: Vec::new() }))
    }

    /// Returns the queries that time the submission's next dispatch.
    pub fn next(&mut self, kernel: Kernel) -> wgpu::ComputePassTimestampWrites<'_> {
        let first = 2 * self.kernels.len() as u32;
        self.kernels.push(kernel);
        wgpu::ComputePassTimestampWrites {
            query_set: &self.queries,
            beginning_of_pass_write_index: Some(first),
            end_of_pass_write_index: Some(first + 1),
        }
    }

    /// Records the copy of the times to a buffer, as the last command of a submission.
    pub fn resolve(&self, encoder: &mut wgpu::CommandEncoder) {
        let count = 2 * self.kernels.len() as u32;
        if count > 0 {
            encoder.resolve_query_set(&self.queries, 0..count, &self.resolved, 0);
        }
    }

    /// Reads the seconds of the dispatches of a completed submission.
    pub fn read(&mut self, gpu: &Gpu) -> Result<Vec<(Kernel, f64)>, EngineError> {
        let kernels = std::mem::take(&mut self.kernels);
        let bytes = gpu.read(&self.resolved, 16 * kernels.len() as u64)?;
        let counts: Vec<u64> = bytemuck::pod_collect_to_vec(&bytes);
        let seconds =
            counts.chunks_exact(2).map(|pair| pair[1].saturating_sub(pair[0]) as f64 * self.period);
        Ok(kernels.into_iter().zip(seconds).collect())
    }
}
