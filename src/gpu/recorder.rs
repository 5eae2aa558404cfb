//! Recording of commands into submissions. Only one submission is in flight at a time, so that its
//! duration can be measured.

use super::context::Gpu;
use super::program::{Program, arrange};
use super::stamps::Stamps;
use crate::engine::EngineError;
use crate::kernels::records::Dispatch;
use crate::plan::Kernel;
use bytemuck::bytes_of;
use std::time::Instant;

/// Greatest number of dispatches in one submission.
const SLOTS: usize = 64;

/// Records one submission after another.
pub struct Recorder {
    /// Parameters of the submission's dispatches, one slot each.
    pub dispatches: wgpu::Buffer,
    stride: usize,
    staged: Vec<u8>,
    encoder: Option<wgpu::CommandEncoder>,
    stamps: Option<Stamps>,
}

impl Recorder {
    /// Creates a recorder without commands.
    pub fn new(gpu: &Gpu) -> Result<Self, EngineError> {
        let alignment = gpu.device.limits().min_uniform_buffer_offset_alignment as usize;
        let stride = size_of::<Dispatch>().next_multiple_of(alignment.max(1));
        let usage = wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST;
        let dispatches = gpu.buffer("dispatches", (SLOTS * stride) as u64, usage)?;
        Ok(Self { dispatches, stride, staged: Vec::new(), encoder: None, stamps: None })
    }

    /// Returns true if no slot is left for another dispatch.
    pub fn is_full(&self) -> bool {
        self.staged.len() >= SLOTS * self.stride
    }

    /// Starts or stops timing every dispatch by the device's clock; returns true if dispatches are
    /// now timed.
    pub fn stamp(&mut self, gpu: &Gpu, on: bool) -> Result<bool, EngineError> {
        self.stamps = if on { Stamps::new(gpu, SLOTS as u32)? } else { None };
        Ok(self.stamps.is_some())
    }

    fn encoder(&mut self, gpu: &Gpu) -> &mut wgpu::CommandEncoder {
        self.encoder.get_or_insert_with(|| gpu.device.create_command_encoder(&Default::default()))
    }

    /// Clears a buffer, or its first `bytes` bytes.
    pub fn clear(&mut self, gpu: &Gpu, buffer: &wgpu::Buffer, bytes: Option<u64>) {
        self.encoder(gpu).clear_buffer(buffer, 0, bytes);
    }

    /// Copies `bytes` bytes from an offset in one buffer to an offset in another.
    pub fn copy(
        &mut self,
        gpu: &Gpu,
        (source, from): (&wgpu::Buffer, u64),
        (target, to): (&wgpu::Buffer, u64),
        bytes: u64,
    ) {
        self.encoder(gpu).copy_buffer_to_buffer(source, from, target, to, bytes);
    }

    /// Records one dispatch; a slot must be free.
    pub fn dispatch(
        &mut self,
        gpu: &Gpu,
        program: &Program,
        group: &wgpu::BindGroup,
        dispatch: &Dispatch,
    ) {
        let offset = self.staged.len();
        self.staged.extend_from_slice(bytes_of(dispatch));
        self.staged.resize(offset + self.stride, 0);
        let items = (dispatch.end - dispatch.first).div_ceil(program.kernel.info().workgroup_items);
        let (columns, rows) = arrange(items);
        let Self { encoder, stamps, .. } = self;
        let encoder =
            encoder.get_or_insert_with(|| gpu.device.create_command_encoder(&Default::default()));
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some(program.kernel.stem()),
            timestamp_writes: stamps.as_mut().map(|stamps| stamps.next(program.kernel)),
        });
        pass.set_pipeline(&program.pipeline);
        pass.set_bind_group(0, group, &[offset as u32]);
        pass.dispatch_workgroups(columns, rows, 1);
    }

    /// Submits the recorded commands and waits for them; returns the seconds this took.
    pub fn finish(&mut self, gpu: &Gpu) -> Result<f64, EngineError> {
        let begun = Instant::now();
        if !self.submit(gpu) {
            return Ok(0.0);
        }
        gpu.wait()?;
        Ok(begun.elapsed().as_secs_f64())
    }

    /// Submits the recorded commands; returns false if there were none.
    pub fn submit(&mut self, gpu: &Gpu) -> bool {
        let Some(mut encoder) = self.encoder.take() else {
            return false;
        };
        if let Some(stamps) = &self.stamps {
            stamps.resolve(&mut encoder);
        }
        gpu.write(&self.dispatches, &self.staged);
        self.staged.clear();
        gpu.queue.submit([encoder.finish()]);
        true
    }

    /// Seconds of each dispatch of the last submission by the device's clock; empty if dispatches
    /// are not timed.
    pub fn stamped(&mut self, gpu: &Gpu) -> Result<Vec<(Kernel, f64)>, EngineError> {
        self.stamps.as_mut().map_or(Ok(Vec::new()), |stamps| stamps.read(gpu))
    }
}
