//! The WGSL of surfaces of revolution and of the elementary functions: valid, with the layout of
//! the host's structs, and equal to the Rust twin bit for bit on the software driver.

use super::revolution_device::{Device, module};
use crate::revolution::profiles::{Placed, place, profiles, skew};
use crate::revolution::rays::{CLASSES, Random, ray};
use bytemuck::{Pod, Zeroable};
use caustica::low_level::accel::revolution::Placement;
use caustica::low_level::math::FAR;
use caustica::low_level::math::trig::{arctan2, exponential, logarithm, power, sin_cos};
use caustica::low_level::shapes::revolution::{
    Patch, Revolution, intersect_patch, patch_miss, revolution_surface,
};
use glam::Vec3;
use std::mem::offset_of;

/// Rays of each class at each placed profile.
const RAYS: u32 = 1200;

#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct TestRay {
    origin: Vec3,
    t_min: f32,
    direction: Vec3,
    t_max: f32,
}

/// t, theta, tau, steps, position, error, normal, u, v; zeros after a miss's t.
type Answer = [u32; 16];

fn kernel(placed: &Placed) -> String {
    let t = &placed.tables;
    module(&format!(
        "
struct Scene {{ revolutions: array<Revolution, {}>, patches: array<Patch, {}>, profile_points: array<vec2f, {}> }}
struct TestRay {{ origin: vec3f, t_min: f32, direction: vec3f, t_max: f32 }}
@group(0) @binding(0) var<storage, read> scene: Scene;
@group(0) @binding(1) var<storage, read> rays: array<TestRay>;
@group(0) @binding(2) var<storage, read_write> answers: array<array<u32, 16>>;
@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {{
    if id.x >= arrayLength(&rays) {{ return; }}
    let ray = rays[id.x];
    var best = patch_miss();
    best.t = ray.t_max;
    var which = 0u;
    for (var i = 0u; i < {1}u; i++) {{
        let hit = intersect_patch(scene.revolutions[0], scene.patches[i], ray.origin, ray.direction, ray.t_min, best.t);
        if hit.t < best.t {{
            best = hit;
            which = i;
        }}
    }}
    var answer: array<u32, 16>;
    answer[0] = bitcast<u32>(best.t);
    if best.t < ray.t_max {{
        let s = revolution_surface(scene.revolutions[0], scene.patches[which], best.theta, best.tau);
        answer = array<u32, 16>(bitcast<u32>(best.t), bitcast<u32>(best.theta), bitcast<u32>(best.tau), best.steps,
            bitcast<u32>(s.position.x), bitcast<u32>(s.position.y), bitcast<u32>(s.position.z), bitcast<u32>(s.error),
            bitcast<u32>(s.normal.x), bitcast<u32>(s.normal.y), bitcast<u32>(s.normal.z), bitcast<u32>(s.uv.x),
            bitcast<u32>(s.uv.y), 0u, 0u, 0u);
    }}
    answers[id.x] = answer;
}}
",
        t.revolutions.len(),
        t.patches.len(),
        t.profile_points.len()
    ))
}

fn twin(placed: &Placed, ray: &TestRay) -> Answer {
    let t = &placed.tables;
    let mut best = patch_miss();
    best.t = ray.t_max;
    let mut which = 0;
    for (i, patch) in t.patches.iter().enumerate() {
        let revolution = &t.revolutions[0];
        let hit = intersect_patch(
            &t.profile_points,
            revolution,
            patch,
            ray.origin,
            ray.direction,
            ray.t_min,
            best.t,
        );
        if hit.t < best.t {
            best = hit;
            which = i;
        }
    }
    let mut answer = [0; 16];
    answer[0] = best.t.to_bits();
    if best.t < ray.t_max {
        let s = revolution_surface(
            &t.profile_points,
            &t.revolutions[0],
            &t.patches[which],
            best.theta,
            best.tau,
        );
        let floats = [
            best.t,
            best.theta,
            best.tau,
            0.0,
            s.position.x,
            s.position.y,
            s.position.z,
            s.error,
            s.normal.x,
            s.normal.y,
            s.normal.z,
            s.uv.x,
            s.uv.y,
        ];
        answer[..13].copy_from_slice(&floats.map(f32::to_bits));
        answer[3] = best.steps;
    }
    answer
}

/// Number of answers that differ in any bit.
fn differing(a: &[Answer], b: &[Answer]) -> usize {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).filter(|(a, b)| a != b).count()
}

// Theory: both use only operations that IEEE 754 rounds in one way, in the same order, so every bit
// agrees.
#[test]
fn wgsl_gives_the_twins_bits() {
    let device = Device::open();
    let (mut total, mut hits) = (0, 0);
    for placement in [Placement::default(), skew()] {
        for profile in profiles() {
            let placed = place(&profile, &placement);
            let mut random = Random(7);
            let rays: Vec<TestRay> = CLASSES
                .iter()
                .flat_map(|&class| (0..RAYS).map(move |_| class))
                .map(|class| {
                    let (origin, direction) = ray(&placed, class, &mut random);
                    TestRay { origin, t_min: 0.0, direction, t_max: FAR }
                })
                .collect();
            let mut scene: Vec<u8> = bytemuck::cast_slice(&placed.tables.revolutions).to_vec();
            scene.extend_from_slice(bytemuck::cast_slice(&placed.tables.patches));
            scene.extend_from_slice(bytemuck::cast_slice(&placed.tables.profile_points));
            scene.resize(scene.len().next_multiple_of(16), 0);
            let start = std::time::Instant::now();
            let size = (rays.len() * size_of::<Answer>()) as u64;
            let bytes = device.run(
                &kernel(&placed),
                &[&scene, bytemuck::cast_slice(&rays)],
                size,
                rays.len() as u32,
            );
            println!("{}: {:.1?}", placed.name, start.elapsed());
            let gpu: Vec<Answer> = bytemuck::pod_collect_to_vec(&bytes);
            let mut cpu: Vec<Answer> = rays.iter().map(|r| twin(&placed, r)).collect();
            for (i, (a, b)) in gpu.iter().zip(&cpu).enumerate().filter(|(_, (a, b))| a != b).take(3)
            {
                println!(
                    "{} ray {i}: {:?} against {:?}",
                    placed.name,
                    a.map(f32::from_bits),
                    b.map(f32::from_bits)
                );
            }
            assert_eq!(
                differing(&gpu, &cpu),
                0,
                "{} of {} rays at {}",
                differing(&gpu, &cpu),
                rays.len(),
                placed.name
            );
            total += rays.len();
            hits += cpu.iter().filter(|a| f32::from_bits(a[0]) < FAR).count();
            // The comparison detects one bit.
            cpu[5][0] ^= 1;
            assert_eq!(differing(&gpu, &cpu), 1);
        }
    }
    println!("{total} rays, {hits} hits: the same bits");
    assert!(total >= 100_000 && hits > total / 4);
}

#[test]
fn elementary_functions_give_the_twins_bits() {
    let source = module(
        "
struct Scene { patches: array<Patch, 1>, profile_points: array<vec2f, 1> }
@group(0) @binding(0) var<storage, read> scene: Scene;
@group(0) @binding(1) var<storage, read> arguments: array<vec2f>;
@group(0) @binding(2) var<storage, read_write> answers: array<array<f32, 6>>;
@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= arrayLength(&arguments) { return; }
    let a = arguments[id.x] + vec2f(f32(scene.patches[0].revolution));
    let sc = sin_cos(a.x);
    answers[id.x] = array<f32, 6>(sc.x, sc.y, arctan2(a.x, a.y), exponential(a.y), logarithm(a.x), power(abs(a.x), a.y));
}
",
    );
    let mut random = Random(3);
    let arguments: Vec<[f32; 2]> = (0..100_000)
        .map(|i| match i {
            0 => [0.0, 0.0],
            1 => [0.0, -1.0],
            _ => [
                (10f64.powf(random.signed() * 4.0) * random.signed()) as f32,
                (100.0 * random.signed()) as f32,
            ],
        })
        .collect();
    let twin = |[x, y]: [f32; 2]| {
        let (s, c) = sin_cos(x);
        [s, c, arctan2(x, y), exponential(y), logarithm(x), power(x.abs(), y)].map(f32::to_bits)
    };
    let cpu: Vec<[u32; 6]> = arguments.iter().map(|&a| twin(a)).collect();
    let size = (arguments.len() * 24) as u64;
    let scene = [0u8; size_of::<Patch>() + 16];
    let bytes = Device::open().run(
        &source,
        &[&scene, bytemuck::cast_slice(&arguments)],
        size,
        arguments.len() as u32,
    );
    let gpu: Vec<[u32; 6]> = bytemuck::pod_collect_to_vec(&bytes);
    let wrong: Vec<usize> = (0..cpu.len()).filter(|&i| cpu[i] != gpu[i]).collect();
    for &i in wrong.iter().take(3) {
        println!(
            "{:?}: {:?} {:?}",
            arguments[i],
            gpu[i].map(f32::from_bits),
            cpu[i].map(f32::from_bits)
        );
    }
    for (k, name) in
        ["sin", "cos", "arctan2", "exponential", "logarithm", "power"].iter().enumerate()
    {
        println!("{name}: {} differ", (0..cpu.len()).filter(|&i| cpu[i][k] != gpu[i][k]).count());
    }
    assert!(wrong.is_empty(), "{} of {} differ", wrong.len(), cpu.len());
}

/// Offsets of a struct's members in the module, by name.
fn offsets(module: &naga::Module, name: &str) -> Vec<(String, u32)> {
    let found = module.types.iter().find_map(|(_, t)| match &t.inner {
        naga::TypeInner::Struct { members, .. } if t.name.as_deref() == Some(name) => Some(members),
        _ => None,
    });
    let members = found.unwrap_or_else(|| panic!("no struct {name}"));
    members.iter().map(|m| (m.name.clone().unwrap_or_default(), m.offset)).collect()
}

macro_rules! same_layout {
    ($module:expr, $type:ident { $($field:ident),* }) => {{
        let host = vec![$((stringify!($field).to_string(), offset_of!($type, $field) as u32)),*];
        assert_eq!(offsets($module, stringify!($type)), host);
    }};
}

#[test]
fn wgsl_is_valid_and_laid_out_like_the_host() {
    let source = kernel(&place(&profiles()[3], &skew()));
    let module = naga::front::wgsl::parse_str(&source)
        .unwrap_or_else(|e| panic!("{}", e.emit_to_string(&source)));
    naga::valid::Validator::new(
        naga::valid::ValidationFlags::all(),
        naga::valid::Capabilities::empty(),
    )
    .validate(&module)
    .unwrap_or_else(|e| panic!("{}", e.emit_to_string(&source)));
    same_layout!(
        &module,
        Revolution {
            x_axis,
            scale,
            y_axis,
            inv_scale,
            z_axis,
            segments,
            center,
            material,
            light,
            uv,
            padding
        }
    );
    same_layout!(
        &module,
        Patch {
            revolution,
            segment,
            first_point,
            degree,
            origin,
            axis,
            r_min,
            r_max,
            y_min,
            y_max,
            phi_min,
            phi_max,
            slope,
            length,
            t0,
            t1,
            wobble,
            step_tolerance
        }
    );
    // A member moved by four bytes is detected.
    let moved = source.replace("    scale: f32,\n    y_axis", "    y_axis");
    let moved = naga::front::wgsl::parse_str(&moved).map(|m| offsets(&m, "Revolution"));
    assert!(moved.map_or(true, |o| o != offsets(&module, "Revolution")));
}
