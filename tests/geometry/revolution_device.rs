//! Runs one WGSL kernel on a Vulkan adapter, preferably a software one.

use wgpu::util::DeviceExt;

/// Declarations that the files under test need.
pub const PRELUDE: &str = "
const FAR: f32 = 1e30;
const TAU: f32 = 6.28318530717959;
fn unit(v: vec3f) -> vec3f {
    return v * (1.0 / sqrt(dot(v, v)));
}
";

/// The WGSL files under test.
pub const FILES: &[&str] = &[
    include_str!("../../shaders/math/trig.wgsl"),
    include_str!("../../shaders/shapes/revolution_profile.wgsl"),
    include_str!("../../shaders/shapes/revolution_roots.wgsl"),
    include_str!("../../shaders/shapes/revolution.wgsl"),
];

/// Joins the prelude, the files and a kernel's text into one module.
pub fn module(kernel: &str) -> String {
    format!("{PRELUDE}{}{kernel}", FILES.concat())
}

/// A device and its queue.
pub struct Device {
    device: wgpu::Device,
    queue: wgpu::Queue,
}

impl Device {
    /// Panics when there is no adapter: a test that needs one must not pass without.
    pub fn open() -> Self {
        let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle();
        descriptor.backends = wgpu::Backends::VULKAN;
        let instance = wgpu::Instance::new(descriptor);
        let mut adapters = pollster::block_on(instance.enumerate_adapters(wgpu::Backends::VULKAN));
        adapters.sort_by_key(|a| a.get_info().device_type != wgpu::DeviceType::Cpu);
        let adapter = adapters
            .into_iter()
            .next()
            .expect("a Vulkan adapter (apt install mesa-vulkan-drivers)");
        let info = adapter.get_info();
        println!("adapter: {} ({})", info.name, info.driver_info);
        let (device, queue) =
            pollster::block_on(adapter.request_device(&wgpu::DeviceDescriptor::default()))
                .expect("a device");
        Self { device, queue }
    }

    /// Runs entry point `main` (workgroups of 64) of `source` over `count` invocations. Bindings:
    /// the inputs in order, read-only; then the output of `size` bytes, poisoned before.
    pub fn run(&self, source: &str, inputs: &[&[u8]], size: u64, count: u32) -> Vec<u8> {
        let module = self.device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: None,
            source: wgpu::ShaderSource::Wgsl(source.into()),
        });
        let pipeline = self.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: None,
            layout: None,
            module: &module,
            entry_point: Some("main"),
            compilation_options: Default::default(),
            cache: None,
        });
        let buffer = |contents: &[u8], usage| {
            self.device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
                label: None,
                contents,
                usage,
            })
        };
        let mut buffers: Vec<wgpu::Buffer> =
            inputs.iter().map(|b| buffer(b, wgpu::BufferUsages::STORAGE)).collect();
        let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC;
        buffers.push(buffer(&vec![0xcd; size as usize], usage));
        let entries: Vec<wgpu::BindGroupEntry<'_>> = buffers
            .iter()
            .enumerate()
            .map(|(i, b)| wgpu::BindGroupEntry {
                binding: i as u32,
                resource: b.as_entire_binding(),
            })
            .collect();
        let layout = &pipeline.get_bind_group_layout(0);
        let group = self.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout,
            entries: &entries,
        });
        let back = self.device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size,
            usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let mut encoder = self.device.create_command_encoder(&Default::default());
        {
            let mut pass = encoder.begin_compute_pass(&Default::default());
            pass.set_pipeline(&pipeline);
            pass.set_bind_group(0, &group, &[]);
            pass.dispatch_workgroups(count.div_ceil(64), 1, 1);
        }
        encoder.copy_buffer_to_buffer(&buffers[buffers.len() - 1], 0, &back, 0, size);
        self.queue.submit([encoder.finish()]);
        back.slice(..).map_async(wgpu::MapMode::Read, |r| r.expect("the buffer maps"));
        self.device.poll(wgpu::PollType::wait_indefinitely()).expect("the device finishes");
        back.slice(..).get_mapped_range().expect("the buffer is mapped").to_vec()
    }
}
