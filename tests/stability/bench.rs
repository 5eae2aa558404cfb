//! What the rows measure with: pictures, rays and film folds on the CPU and on the software driver.

use std::path::PathBuf;

use bytemuck::{cast_slice, pod_collect_to_vec};
use caustica::cpu::CpuEngine;
use caustica::engine::Engine;
use caustica::features::Features;
use caustica::film::Picture;
use caustica::gpu::compose::compose_from;
use caustica::gpu::fragments::{FRAGMENTS, Fragment};
use caustica::gpu::layout::{SceneTables, long_tables};
use caustica::gpu::program::Program;
use caustica::gpu::recorder::Recorder;
use caustica::gpu::{AdapterChoice, Gpu, GpuEngine};
use caustica::kernels::records::{Dispatch, FilmPixel, Gathered, Statistics, VisiblePoint};
use caustica::kernels::resolve::resolve;
use caustica::pack::{Packed, pack};
use caustica::plan::{Kernel, Plan};
use caustica::scene::{self, Scene};
use caustica::settings::RenderSettings;
use caustica::shapes::intersect::intersect_scene;
use caustica::shapes::ray::{NONE, Ray};
use caustica::shapes::surface::surface_at;
use caustica::tables;
use glam::Vec3;
use rayon::prelude::*;

/// A device to measure on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum On {
    Cpu,
    Software,
}

/// A device, and whether there is time for large samples.
pub struct Bench {
    pub on: On,
    pub long: bool,
}

/// Where a ray met a scene.
#[derive(Clone, Copy, Debug)]
pub struct Found {
    /// Distance, in scene units.
    pub t: f32,
    /// What was met, or [`NONE`].
    pub reference: u32,
    /// Point on the surface.
    pub position: Vec3,
    /// Bound of its distance from the true surface.
    pub error: f32,
    /// Unit normal of the surface.
    pub normal: Vec3,
}

impl Found {
    pub fn is_hit(&self) -> bool {
        self.reference != NONE
    }
}

/// The scene that `text` describes; files that it names are relative to [`folder`].
pub fn parse(text: &str) -> Scene {
    match scene::parse(&folder().join("scene.toml"), text.as_bytes()) {
        Ok(loaded) => loaded.scene,
        Err(errors) => panic!("{errors:?}\n{text}"),
    }
}

/// A folder for generated files.
pub fn folder() -> PathBuf {
    let folder = std::env::temp_dir().join("caustica-stability");
    std::fs::create_dir_all(&folder).expect("a temporary folder");
    folder
}

impl Bench {
    /// `few` in tests, `many` for the table.
    pub fn samples(&self, few: u32, many: u32) -> u32 {
        if self.long { many } else { few }
    }

    pub fn packed(&self, text: &str) -> Packed {
        let scene = parse(text);
        pack(&scene, scene.film.width, scene.film.height).expect("a scene that packs")
    }

    /// The picture after `settings.passes` passes.
    pub fn render(&self, text: &str, settings: &RenderSettings) -> Picture {
        self.render_packed(self.packed(text), settings)
    }

    pub fn render_packed(&self, packed: Packed, settings: &RenderSettings) -> Picture {
        let plan = Plan::new(&packed, settings);
        let mut engine: Box<dyn Engine> = match self.on {
            On::Cpu => Box::new(CpuEngine::new(packed, plan)),
            On::Software => {
                Box::new(GpuEngine::new(&AdapterChoice::Software, &packed, plan).expect("the software driver"))
            }
        };
        for _ in 0..settings.passes {
            engine.pass().expect("a pass");
        }
        engine.picture().expect("a picture")
    }

    /// The nearest hits of rays.
    pub fn trace(&self, scene: &tables::Scene, rays: &[Ray]) -> Vec<Found> {
        match self.on {
            On::Cpu => rays.par_iter().map(|ray| trace(scene, ray)).collect(),
            On::Software => trace_on_driver(scene, rays),
        }
    }

    /// Folds one pass after another into one pixel with one visible point that gathers the same in all of them: `resolve`
    /// under the local rule.
    pub fn resolve(
        &self,
        point: VisiblePoint,
        gathered: Gathered,
        mut statistics: Statistics,
        mut film: FilmPixel,
        passes: &[Dispatch],
    ) -> (Statistics, FilmPixel) {
        if self.on == On::Cpu {
            for d in passes {
                let stats = Some(std::slice::from_mut(&mut statistics));
                resolve(d, &[point], &[gathered], stats, &mut film);
            }
            return (statistics, film);
        }
        let gpu = Gpu::open(&AdapterChoice::Software).expect("the software driver");
        let mut recorder = Recorder::new(&gpu).expect("a recorder");
        let features = Features::from(["local"]);
        let program = Program::new(&gpu, Kernel::Resolve, &features, &SceneTables::default()).expect("resolve");
        let upload = |name, bytes: &[u8]| (name, gpu.upload(name, bytes).expect("a buffer"));
        let buffers = [
            upload("visible_points", bytemuck::bytes_of(&point)),
            upload("gathered", bytemuck::bytes_of(&gathered)),
            upload("statistics", bytemuck::bytes_of(&statistics)),
            upload("film", bytemuck::bytes_of(&film)),
        ];
        let find = |name: &str| buffers.iter().find(|(n, _)| *n == name).map(|(_, b)| b);
        let group = program.bind(&gpu, &recorder.dispatches, find).expect("bound");
        for d in passes {
            if recorder.is_full() {
                recorder.finish(&gpu).expect("done");
            }
            recorder.dispatch(&gpu, &program, &group, &Dispatch { first: 0, end: 1, ..*d });
        }
        recorder.finish(&gpu).expect("done");
        let read = |i: usize, bytes| gpu.read(&buffers[i].1, bytes).expect("read");
        let stats: Vec<Statistics> = pod_collect_to_vec(&read(2, size_of::<Statistics>() as u64));
        let pixels: Vec<FilmPixel> = pod_collect_to_vec(&read(3, size_of::<FilmPixel>() as u64));
        (stats[0], pixels[0])
    }
}

fn trace(scene: &tables::Scene, ray: &Ray) -> Found {
    let hit = intersect_scene(scene, ray);
    let mut found =
        Found { t: hit.t, reference: hit.reference, position: Vec3::ZERO, error: 0.0, normal: Vec3::ZERO };
    if found.is_hit() {
        let s = surface_at(scene, ray, &hit);
        found = Found { position: s.position, error: s.error, normal: s.normal, ..found };
    }
    found
}

fn trace_on_driver(scene: &tables::Scene, rays: &[Ray]) -> Vec<Found> {
    let gpu = Gpu::open(&AdapterChoice::Software).expect("the software driver");
    let mut recorder = Recorder::new(&gpu).expect("a recorder");
    let features = Features::of(scene, &RenderSettings::default());
    let tables = SceneTables::new(scene);
    let kernel = Kernel::EyeTrace;
    let swapped = |f: &Fragment| match f.path {
        "kernels/eye_trace.wgsl" => Fragment { text: include_str!("trace.wgsl"), ..*f },
        _ => *f,
    };
    let fragments: Vec<Fragment> = FRAGMENTS.iter().map(swapped).collect();
    let shader = compose_from(&fragments, kernel, &features, &tables).expect("composed");
    let program = Program::of_shader(&gpu, kernel, &features, shader).expect("compiled");
    let given = |ray: &Ray| VisiblePoint {
        position: ray.origin,
        radius: ray.t_min,
        weight: ray.direction,
        alpha: ray.t_max,
        ..VisiblePoint::default()
    };
    let mut out = Vec::new();
    // a binding holds 128 MiB
    for rays in rays.chunks(1 << 20) {
        let points: Vec<VisiblePoint> = rays.iter().map(given).collect();
        let mut buffers = vec![
            ("scene", gpu.upload("scene", &tables.bytes).expect("a buffer")),
            ("visible_points", gpu.upload("visible_points", cast_slice(&points)).expect("a buffer")),
            ("counters", gpu.storage("counters", 16).expect("a buffer")),
        ];
        for (name, _, content) in long_tables(scene) {
            if !content.is_empty() {
                buffers.push((name, gpu.upload(name, content).expect("a buffer")));
            }
        }
        let find = |name: &str| buffers.iter().find(|(n, _)| *n == name).map(|(_, b)| b);
        let group = program.bind(&gpu, &recorder.dispatches, find).expect("bound");
        let end = rays.len() as u32;
        recorder.dispatch(&gpu, &program, &group, &Dispatch { first: 0, end, ..Dispatch::default() });
        recorder.finish(&gpu).expect("done");
        let bytes = gpu.read(&buffers[1].1, (rays.len() * size_of::<VisiblePoint>()) as u64).expect("read");
        let answers: Vec<VisiblePoint> = pod_collect_to_vec(&bytes);
        assert!(answers.iter().all(|a| a.stopped == 0), "the driver stopped a loop");
        out.extend(answers.iter().map(|a| Found {
            t: a.radius,
            reference: a.normal,
            position: a.position,
            error: a.radiance.z,
            normal: a.weight,
        }));
    }
    out
}
