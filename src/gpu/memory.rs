//! Buffers on the device: checked against its limits before they are made, filled and read back.

use super::context::{AdapterKind, Gpu};
use crate::engine::EngineError;
use crate::memory::available;
use wgpu::BufferUsages;

/// Bytes of one step of reading back.
const READ_BYTES: u64 = 16 << 20;

impl Gpu {
    /// Most bytes of a storage buffer.
    pub fn binding_limit(&self) -> u64 {
        self.summary.binding_bytes.min(self.summary.buffer_bytes)
    }

    /// Whether buffers of these sizes can be had: each by itself, and on a software driver, which
    /// commits memory lazily and never says no, all of them together. `mend` says which setting to
    /// change.
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

    /// A storage buffer of at least `bytes` bytes, filled with zeros.
    pub fn storage(&self, label: &str, bytes: u64) -> Result<wgpu::Buffer, EngineError> {
        let usage = BufferUsages::STORAGE | BufferUsages::COPY_SRC | BufferUsages::COPY_DST;
        self.buffer(label, bytes, usage)
    }

    /// A buffer of at least `bytes` bytes, filled with zeros.
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

    /// A storage buffer that holds `content`.
    pub fn upload(&self, label: &str, content: &[u8]) -> Result<wgpu::Buffer, EngineError> {
        let buffer = self.storage(label, content.len() as u64)?;
        self.write(&buffer, content);
        Ok(buffer)
    }

    /// Writes `content`, whole words, at the buffer's start.
    pub fn write(&self, buffer: &wgpu::Buffer, content: &[u8]) {
        if !content.is_empty() {
            self.queue.write_buffer(buffer, 0, content);
        }
    }

    /// The first `bytes` bytes, whole words, of a buffer.
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
            // a failure shows in `wait` and in the view below
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
