//! The kd-tree's WGSL twins: valid, and equal to Rust bit for bit on the software driver.

use crate::brute_force::*;
use bytemuck::{Pod, Zeroable};
use caustica::low_level::accel::kdtree::build;
use caustica::low_level::shapes::kdtree::MAX_DEPTH;
use caustica::low_level::shapes::ray::{Hit, Ray};
use caustica::low_level::shapes::table::NONE;
use caustica::low_level::shapes::triangle::Triangle;
use glam::Vec3;
use wgpu::util::DeviceExt;

/// The test kernel's module.
fn shader() -> String {
    let parts = [
        include_str!("trace.wgsl"),
        include_str!("../../../shaders/shapes/ray.wgsl"),
        include_str!("../../../shaders/shapes/triangle.wgsl"),
        include_str!("../../../shaders/shapes/kdtree.wgsl"),
    ];
    let text = parts.concat();
    assert!(
        text.contains(&format!("const MAX_DEPTH: u32 = {MAX_DEPTH}u;")),
        "both twins have the same stack"
    );
    text
}

fn validated(text: &str) -> Result<(), String> {
    let module = naga::front::wgsl::parse_str(text).map_err(|e| e.emit_to_string(text))?;
    naga::valid::Validator::new(
        naga::valid::ValidationFlags::all(),
        naga::valid::Capabilities::empty(),
    )
    .validate(&module)
    .map(|_| ())
    .map_err(|e| e.emit_to_string(text))
}

#[test]
fn wgsl_is_valid() {
    let text = shader();
    assert_eq!(validated(&text), Ok(()));
    assert!(
        validated(&text.replace("var waiting = 0u;", "var waiting = 0.0;")).is_err(),
        "planted"
    );
}

#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct World {
    bounds_min: Vec3,
    ray_count: u32,
    bounds_max: Vec3,
    primitive_size: f32,
}

struct Gpu {
    device: wgpu::Device,
    queue: wgpu::Queue,
}

impl Gpu {
    /// The software Vulkan driver; fails the test where there is none.
    fn software() -> Gpu {
        let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle();
        descriptor.backends = wgpu::Backends::VULKAN;
        let instance = wgpu::Instance::new(descriptor);
        let adapter = pollster::block_on(instance.enumerate_adapters(wgpu::Backends::VULKAN))
            .into_iter()
            .find(|a| a.get_info().device_type == wgpu::DeviceType::Cpu)
            .expect("no software Vulkan driver: install mesa-vulkan-drivers");
        println!("adapter: {} ({})", adapter.get_info().name, adapter.get_info().driver_info);
        let (device, queue) =
            pollster::block_on(adapter.request_device(&wgpu::DeviceDescriptor::default()))
                .expect("a device");
        Gpu { device, queue }
    }

    fn input<T: Pod>(&self, data: &[T]) -> wgpu::Buffer {
        self.device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: None,
            contents: bytemuck::cast_slice(data),
            usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC,
        })
    }

    fn read<T: Pod>(&self, source: &wgpu::Buffer) -> Vec<T> {
        let target = self.device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: source.size(),
            usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let mut encoder =
            self.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        encoder.copy_buffer_to_buffer(source, 0, &target, 0, source.size());
        self.queue.submit([encoder.finish()]);
        target.map_async(wgpu::MapMode::Read, .., |done| done.expect("mapped"));
        self.device.poll(wgpu::PollType::wait_indefinitely()).expect("the device answers");
        let bytes = target.get_mapped_range(..).expect("mapped");
        bytemuck::pod_collect_to_vec(&bytes[..])
    }

    /// Nearest hits and shadows of `rays`, written to poisoned buffers.
    fn trace(&self, text: &str, inputs: &[wgpu::Buffer; 5], rays: usize) -> (Vec<Hit>, Vec<u32>) {
        let hits = self.input(&vec![0xdead_beef_u32; 4 * rays]);
        let shadows = self.input(&vec![0xdead_beef_u32; rays]);
        let module = self.device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("trace"),
            source: wgpu::ShaderSource::Wgsl(text.into()),
        });
        let pipeline = self.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some("trace"),
            layout: None,
            module: &module,
            entry_point: Some("trace"),
            compilation_options: Default::default(),
            cache: None,
        });
        let entries: Vec<_> = inputs
            .iter()
            .chain([&hits, &shadows])
            .enumerate()
            .map(|(i, b)| wgpu::BindGroupEntry {
                binding: i as u32,
                resource: b.as_entire_binding(),
            })
            .collect();
        let group = self.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout: &pipeline.get_bind_group_layout(0),
            entries: &entries,
        });
        let mut encoder =
            self.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        {
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
            pass.set_pipeline(&pipeline);
            pass.set_bind_group(0, &group, &[]);
            pass.dispatch_workgroups(rays.div_ceil(64) as u32, 1, 1);
        }
        let start = std::time::Instant::now();
        self.queue.submit([encoder.finish()]);
        let answer = (self.read(&hits), self.read(&shadows));
        let seconds = start.elapsed().as_secs_f64();
        println!("{:.3} M rays/s, nearest and any", 2.0 * rays as f64 / seconds * 1e-6);
        answer
    }
}

/// Theory: both twins execute the same IEEE operations in the same order, so every bit of every hit
/// agrees, including ties in t.
#[test]
fn device_gives_the_same_bits() {
    let gpu = Gpu::software();
    let mut mesh = displaced_torus(120, 60);
    // Flat grids on top, with triangles in splitting planes.
    for (_, prims) in
        scenes().into_iter().filter(|s| s.0.starts_with("lattice") || s.0.starts_with("every"))
    {
        mesh.extend(prims.iter().filter_map(|p| match p {
            caustica::low_level::accel::kdtree::Primitive::Triangle(t) => Some(*t),
            caustica::low_level::accel::kdtree::Primitive::Box(_) => None,
        }));
    }
    let prims = prims(&mesh);
    let tree = build(&prims);
    let rays: Vec<Ray> = rays(&prims, &tree.view(), 100_000, &mut Rng(21));
    let view = tree.view();
    let world = World {
        bounds_min: view.bounds_min,
        ray_count: rays.len() as u32,
        bounds_max: view.bounds_max,
        primitive_size: view.primitive_size,
    };
    let triangles: Vec<Triangle> = mesh.iter().map(|t| triangle(*t)).collect();
    let inputs = [
        gpu.input(&[world]),
        gpu.input(view.nodes),
        gpu.input(view.refs),
        gpu.input(&triangles),
        gpu.input(&rays),
    ];
    let (hits, shadows) = gpu.trace(&shader(), &inputs, rays.len());
    let different = rays
        .iter()
        .zip(hits.iter().zip(&shadows))
        .filter(|(ray, (hit, shadow))| {
            let twin = closest(&prims, &view, ray);
            bytemuck::bytes_of(&twin) != bytemuck::bytes_of(*hit)
                || **shadow != u32::from(twin.reference != NONE)
        })
        .count();
    let found = hits.iter().filter(|h| h.reference != NONE).count();
    println!("{different} of {} rays differ, {found} hits", rays.len());
    assert_eq!(different, 0);
    assert!(found > rays.len() / 4 && found < rays.len());
    // Planted error: triangles moved by one unit in the last place.
    let mut moved = triangles.clone();
    moved.iter_mut().for_each(|t| t.p0.x = t.p0.x.next_up());
    let (hits, _) = gpu.trace(
        &shader(),
        &[
            gpu.input(&[world]),
            gpu.input(view.nodes),
            gpu.input(view.refs),
            gpu.input(&moved),
            gpu.input(&rays),
        ],
        rays.len(),
    );
    let different =
        rays.iter().zip(&hits).filter(|(r, h)| closest(&prims, &view, r) != **h).count();
    assert!(different > 0, "planted");
}
