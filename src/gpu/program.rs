//! Compiled kernel: its pipeline and its bindings.

use super::compose::{Shader, causes, compose};
use super::context::Gpu;
use super::layout::{Bound, SceneLayout, bindings};
use crate::engine::EngineError;
use crate::kernels::records::Dispatch;
use crate::plan::features::Features;
use crate::plan::{Buffer, Kernel};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc;
use std::time::Instant;

/// Compiled kernel.
pub struct Program {
    /// Kernel that was compiled.
    pub kernel: Kernel,
    pub(super) pipeline: wgpu::ComputePipeline,
    layout: wgpu::BindGroupLayout,
    bindings: Vec<Bound>,
}

impl Program {
    /// Composes and compiles `kernel`.
    pub fn new(
        gpu: &Gpu,
        kernel: Kernel,
        features: &Features,
        scene: &SceneLayout,
    ) -> Result<Self, EngineError> {
        let shader =
            compose(kernel, features, scene).map_err(|e| EngineError::Shader(e.to_string()))?;
        Self::of_shader(gpu, kernel, features, shader)
    }

    /// Compiles a shader that has the entry point and the bindings of `kernel`.
    pub fn of_shader(
        gpu: &Gpu,
        kernel: Kernel,
        features: &Features,
        shader: Shader,
    ) -> Result<Self, EngineError> {
        let bindings = bindings(kernel, *features);
        let stem = kernel.stem();
        let scope = gpu.device.push_error_scope(wgpu::ErrorFilter::Validation);
        let entries: Vec<_> = (0..).zip(&bindings).map(|(i, b)| layout_entry(i, b)).collect();
        let layout = gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some(stem),
            entries: &entries,
        });
        let pipeline_layout = gpu.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some(stem),
            bind_group_layouts: &[Some(&layout)],
            immediate_size: 0,
        });
        let module = gpu.device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some(stem),
            source: wgpu::ShaderSource::Wgsl(shader.source.as_str().into()),
        });
        let pipeline = gpu.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some(stem),
            layout: Some(&pipeline_layout),
            module: &module,
            entry_point: Some(stem),
            compilation_options: wgpu::PipelineCompilationOptions {
                // each kernel writes its workgroup memory before reading it
                zero_initialize_workgroup_memory: false,
                ..Default::default()
            },
            cache: None,
        });
        match pollster::block_on(scope.pop()) {
            Some(error) => Err(EngineError::Shader(match shader.validate() {
                // names file and line
                Err(fault) => fault.to_string(),
                Ok(_) => format!("{stem}: {}", causes(&error)),
            })),
            None => gpu.check().map(|()| Self { kernel, pipeline, layout, bindings }),
        }
    }

    /// Binds the buffers that `buffer` returns; `dispatches` holds the parameters of the
    /// dispatches.
    pub fn bind<'a>(
        &self,
        gpu: &Gpu,
        dispatches: &wgpu::Buffer,
        buffer: impl Fn(Buffer) -> Option<&'a wgpu::Buffer>,
    ) -> Result<wgpu::BindGroup, EngineError> {
        let mut entries = Vec::new();
        for (number, binding) in (0..).zip(&self.bindings) {
            let resource = match binding {
                Bound::Dispatch => wgpu::BindingResource::Buffer(wgpu::BufferBinding {
                    buffer: dispatches,
                    offset: 0,
                    size: wgpu::BufferSize::new(size_of::<Dispatch>() as u64),
                }),
                Bound::Storage(used) => match buffer(used.buffer) {
                    Some(buffer) => buffer.as_entire_binding(),
                    None => {
                        let text =
                            format!("{} has no buffer `{}`", self.kernel.stem(), binding.name());
                        return Err(EngineError::Shader(text));
                    }
                },
            };
            entries.push(wgpu::BindGroupEntry { binding: number, resource });
        }
        let group = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some(self.kernel.stem()),
            layout: &self.layout,
            entries: &entries,
        });
        gpu.check().map(|()| group)
    }
}

/// Scheduling of compilation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Compiling {
    /// Several threads in parallel.
    Together,
    /// One kernel after another, so that each can be timed.
    OneByOne,
}

/// Composes and compiles kernels, and passes each to `take` as soon as it is ready, with the
/// seconds that this took.
pub fn make_programs(
    gpu: &Gpu,
    kernels: &[Kernel],
    features: &Features,
    scene: &SceneLayout,
    compiling: Compiling,
    mut take: impl FnMut(Program, f64) -> Result<(), EngineError>,
) -> Result<(), EngineError> {
    let make = |kernel: &Kernel| {
        let begun = Instant::now();
        Program::new(gpu, *kernel, features, scene)
            .map(|made| (made, begun.elapsed().as_secs_f64()))
    };
    if compiling == Compiling::OneByOne {
        return kernels
            .iter()
            .try_for_each(|kernel| make(kernel).and_then(|(made, time)| take(made, time)));
    }
    let threads = std::thread::available_parallelism().map_or(1, |n| n.get()).min(kernels.len());
    let next = AtomicUsize::new(0);
    let (sender, receiver) = mpsc::channel();
    let compile = |sender: mpsc::Sender<_>| {
        while let Some(kernel) = kernels.get(next.fetch_add(1, Ordering::Relaxed)) {
            // the receiver is gone after a failure
            if sender.send(make(kernel)).is_err() {
                break;
            }
        }
    };
    let compile = &compile;
    std::thread::scope(|scope| {
        let started = (0..threads).filter(|_| {
            let sender = sender.clone();
            std::thread::Builder::new().spawn_scoped(scope, move || compile(sender)).is_ok()
        });
        // compile on this thread if the system provides no other
        if started.count() == 0 {
            compile(sender.clone());
        }
        drop(sender);
        receiver.into_iter().try_for_each(|made| made.and_then(|(made, time)| take(made, time)))
    })
}

/// Columns and rows of `groups` workgroups, at most 65535 in a row; surplus invocations do nothing.
pub fn arrange(groups: u32) -> (u32, u32) {
    const ROW: u32 = 65535;
    let rows = groups.div_ceil(ROW).max(1);
    (groups.div_ceil(rows).max(1), rows)
}

fn layout_entry(binding: u32, bound: &Bound) -> wgpu::BindGroupLayoutEntry {
    let (ty, has_dynamic_offset) = match bound {
        Bound::Dispatch => (wgpu::BufferBindingType::Uniform, true),
        Bound::Storage(used) => {
            (wgpu::BufferBindingType::Storage { read_only: used.is_read_only() }, false)
        }
    };
    wgpu::BindGroupLayoutEntry {
        binding,
        visibility: wgpu::ShaderStages::COMPUTE,
        ty: wgpu::BindingType::Buffer { ty, has_dynamic_offset, min_binding_size: None },
        count: None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every arrangement holds all groups, respects the limit and wastes less than a row.
    #[test]
    fn arrangements() {
        for groups in [0, 1, 65535, 65536, 131_070, 131_071, 1 << 22, u32::MAX / 64] {
            let (columns, rows) = arrange(groups);
            assert!((1..=65535).contains(&columns) && (1..=65535).contains(&rows));
            let all = columns as u64 * rows as u64;
            assert!(all >= groups as u64 && all < groups as u64 + rows as u64 + 1, "{groups}");
        }
    }
}
