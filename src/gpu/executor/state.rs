//! Reading, saving and restoring the state of an executor.

use super::Executor;
use crate::engine::{EngineError, LayerState, State};
use crate::kernels::records::{FilmPixel, Gathered};
use crate::plan::layers::LayerInputs;
use crate::plan::{Buffer, Extent, Plan};

impl Executor {
    /// Contents of a buffer of the plan (of chunk `chunk` if it is per chunk), for tests.
    pub fn content(&self, buffer: Buffer, chunk: u32) -> Result<Vec<u8>, EngineError> {
        let found = self
            .chunks
            .get(chunk as usize)
            .and_then(|own| own.get(&buffer))
            .or_else(|| self.shared.get(&buffer));
        found.map_or(Ok(Vec::new()), |buffer| self.gpu.read(buffer, buffer.size()))
    }

    /// Reads the state after the passes so far.
    pub(in super::super) fn state(&self) -> Result<State, EngineError> {
        Ok(State {
            first_pass: self.plan.first_pass,
            passes: self.passes_done,
            bits: 8 * size_of::<f32>() as u32,
            film: self.read_chunks(Buffer::Film)?,
            statistics: self.read_chunks(Buffer::Statistics)?,
            layers: self.with_found(|plan, found| plan.layer_state(found))?,
        })
    }

    /// Continues from a saved state.
    pub(in super::super) fn take_over(&mut self, state: &State) -> Result<(), EngineError> {
        self.plan.take_over(state)?;
        self.passes_done = state.passes;
        let LayerState { aovs, parts, counts, .. } = &state.layers;
        let gathered: Vec<_> = counts
            .iter()
            .map(|count| Gathered { count: *count, ..bytemuck::Zeroable::zeroed() })
            .collect();
        let gathered = bytemuck::cast_slice(&gathered);
        for (which, bytes) in [
            (Buffer::Film, &state.film[..]),
            (Buffer::Statistics, &state.statistics),
            (Buffer::Aovs, aovs),
            (Buffer::Parts, parts),
            (Buffer::Gathered, gathered),
        ] {
            for (number, chunk) in (0..).zip(&self.chunks) {
                if let (Some(buffer), Some(part)) =
                    (chunk.get(&which), bytes.get(self.place(which, number)))
                {
                    self.gpu.write(buffer, part);
                }
            }
        }
        self.gpu.check()
    }

    /// Reads back the inputs of the layers and passes them to `make`; returns the default if there
    /// are no AOVs.
    pub(in super::super) fn with_found<T: Default>(
        &self,
        make: impl Fn(&Plan, &LayerInputs) -> T,
    ) -> Result<T, EngineError> {
        if self.plan.aovs.is_empty() {
            return Ok(T::default());
        }
        let samples = self.plan.eye_samples;
        let found = LayerInputs {
            aovs: &self.chunked(Buffer::Aovs, samples)?,
            parts: &self.chunked(Buffer::Parts, samples)?,
            gathered: &self.gathered_points()?,
            statistics: &self.chunked(Buffer::Statistics, 1)?,
            passes: self.passes_done,
        };
        Ok(make(&self.plan, &found))
    }

    /// Reads the sums that the visible points gathered in the last pass.
    pub(in super::super) fn gathered_points(&self) -> Result<Vec<Gathered>, EngineError> {
        self.chunked(Buffer::Gathered, 1)
    }

    /// Reads the film.
    pub(in super::super) fn film(&self) -> Result<Vec<FilmPixel>, EngineError> {
        self.chunked(Buffer::Film, self.plan.eye_samples)
    }

    /// Reads a buffer of all chunks, with one item per `samples` visible points; empty if there is
    /// no such buffer.
    fn chunked<T: bytemuck::Pod>(
        &self,
        buffer: Buffer,
        samples: u32,
    ) -> Result<Vec<T>, EngineError> {
        self.check_whole()?;
        let mut all = Vec::new();
        for (number, chunk) in (0..).zip(&self.chunks) {
            if let Some(own) = chunk.get(&buffer) {
                let items = self.plan.chunk(number).1 / samples;
                let bytes = self.gpu.read(own, items as u64 * size_of::<T>() as u64)?;
                all.extend(bytemuck::pod_collect_to_vec::<u8, T>(&bytes));
            }
        }
        Ok(all)
    }

    /// Reads all chunks' parts of a buffer in sequence; empty if the plan has no such buffer.
    fn read_chunks(&self, buffer: Buffer) -> Result<Vec<u8>, EngineError> {
        self.check_whole()?;
        let mut bytes = Vec::new();
        for (number, chunk) in (0..).zip(&self.chunks) {
            if let Some(own) = chunk.get(&buffer) {
                bytes.extend(self.gpu.read(own, self.place(buffer, number).len() as u64)?);
            }
        }
        Ok(bytes)
    }

    /// Byte range of a chunk's part within the whole buffer.
    fn place(&self, buffer: Buffer, chunk: u32) -> std::ops::Range<usize> {
        let (first, points) = self.plan.chunk(chunk);
        let info = buffer.info();
        let per = if info.extent == Extent::Pixels { self.plan.eye_samples } else { 1 };
        let at = |point: u32| (point / per) as usize * info.element_bytes;
        at(first)..at(first + points)
    }

    /// Fails if the buffers contain a partial pass.
    fn check_whole(&self) -> Result<(), EngineError> {
        if self.partial {
            let text = format!("{} failed in the middle of adding up a pass", self.device);
            return Err(EngineError::DeviceLost(text));
        }
        Ok(())
    }
}
