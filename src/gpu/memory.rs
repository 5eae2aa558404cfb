//! Buffers on the device: checked against its limits before allocation, written and read back.

use super::context::{AdapterKind, Gpu};
use crate::engine::EngineError;
use crate::memory::available;
use wgpu::BufferUsages;

/// Size of one read-back step, bytes.
const READ_BYTES: u64 = 16 << 20;

impl Gpu {
    /// Greatest size of a storage buffer, bytes.
    pub fn binding_limit(&self) -> u64 {
        self.summary.binding_bytes.min(self.summary.buffer_bytes)
    }

    /// Checks that buffers of these sizes can be allocated: each one on all devices, and all
    /// together on a software driver, which commits memory lazily and never refuses. `mend` names
    /// the setting to change.
    pub fn check_sizes(&self, sizes: &[(&str, u64)], mend: &str) -> Result<(), EngineError> {
        let too_large = |what: &str, needed, limit| EngineError::TooLarge {
            what: what.to_owned(),
            needed,
            device: self.summary.name.clone(),
            limit,
            mend: mend.to_owned(),
        };
        for &(what, needed) in sizes {
            if needed > self.binding_limit() {
                return Err(too_large(what, needed, self.binding_limit()));
            }
        }
        let total = sizes.iter().map(|(_, bytes)| bytes).sum();
        match available() {
            Some((limit, _)) if self.summary.kind == AdapterKind::Software && total > limit => {
                Err(too_large("the render", total, limit))
            }
            _ => Ok(()),
        }
    }

    /// Allocates a storage buffer of at least `bytes` bytes, filled with zeros.
    pub fn storage(&self, label: &str, bytes: u64) -> Result<wgpu::Buffer, EngineError> {
        let usage = BufferUsages::STORAGE | BufferUsages::COPY_SRC | BufferUsages::COPY_DST;
        self.buffer(label, bytes, usage)
    }

    /// Allocates a buffer of at least `bytes` bytes, filled with zeros.
    pub fn buffer(
        &self,
        label: &str,
        bytes: u64,
        usage: BufferUsages,
    ) -> Result<wgpu::Buffer, EngineError> {
        let size = bytes.next_multiple_of(16).max(16);
        self.check_sizes(&[(label, size)], "make the picture or the scene smaller")?;
        let descriptor =
            wgpu::BufferDescriptor { label: Some(label), size, usage, mapped_at_creation: false };
        let buffer = self.device.create_buffer(&descriptor);
        self.check()?;
        Ok(buffer)
    }

    /// Allocates a storage buffer with the given contents.
    pub fn upload(&self, label: &str, content: &[u8]) -> Result<wgpu::Buffer, EngineError> {
        let buffer = self.storage(label, content.len() as u64)?;
        self.write(&buffer, content);
        Ok(buffer)
    }

    /// Writes `content`, a whole number of words, to the start of the buffer.
    pub fn write(&self, buffer: &wgpu::Buffer, content: &[u8]) {
        if !content.is_empty() {
            self.queue.write_buffer(buffer, 0, content);
        }
    }

    /// Reads the first `bytes` bytes, a whole number of words, of a buffer.
    pub fn read(&self, buffer: &wgpu::Buffer, bytes: u64) -> Result<Vec<u8>, EngineError> {
        let mut out = Vec::new();
        out.try_reserve_exact(bytes as usize)
            .map_err(|_| EngineError::OutOfMemory(format!("{bytes} bytes to read back into")))?;
        if bytes == 0 {
            return Ok(out);
        }
        let usage = BufferUsages::MAP_READ | BufferUsages::COPY_DST;
        let staging = self.buffer("reading", bytes.min(READ_BYTES), usage)?;
        while (out.len() as u64) < bytes {
            let size = (bytes - out.len() as u64).min(READ_BYTES);
            let mut encoder = self.device.create_command_encoder(&Default::default());
            encoder.copy_buffer_to_buffer(buffer, out.len() as u64, &staging, 0, size);
            self.queue.submit([encoder.finish()]);
            // a failure surfaces in `wait` and in the view below
            staging.map_async(wgpu::MapMode::Read, ..size, |_| ());
            self.wait()?;
            let view = staging
                .get_mapped_range(..size)
                .map_err(|e| EngineError::DeviceLost(e.to_string()))?;
            out.extend_from_slice(&view);
            drop(view);
            staging.unmap();
        }
        Ok(out)
    }
}
