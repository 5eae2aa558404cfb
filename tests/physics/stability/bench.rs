//! The measuring tools of the rows: images, rays and film folds on the CPU and on the software
//! driver.

use std::cell::{OnceCell, RefCell};
use std::collections::HashMap;
use std::path::PathBuf;
use std::rc::Rc;

use bytemuck::{Zeroable, cast_slice, pod_collect_to_vec};
use caustica::low_level::cpu::CpuEngine;
use caustica::low_level::engine::Engine;
use caustica::low_level::film::Picture;
use caustica::low_level::geometry::intersect::intersect_scene;
use caustica::low_level::geometry::surface::surface_at;
use caustica::low_level::gpu::compose::{Shader, compose, compose_from};
use caustica::low_level::gpu::fragments::{Fragment, fragments};
use caustica::low_level::gpu::layout::{SceneLayout, long_tables};
use caustica::low_level::gpu::program::Program;
use caustica::low_level::gpu::recorder::Recorder;
use caustica::low_level::gpu::{AdapterChoice, Gpu, GpuEngine};
use caustica::low_level::kernels::gather::gather;
use caustica::low_level::kernels::grid_build::{
    SortedRecords, build_grid, record_bucket, record_code,
};
use caustica::low_level::kernels::records::{
    Dispatch, FilmPixel, Gathered, PhotonRecord, Statistics, VisiblePoint,
};
use caustica::low_level::kernels::resolve::resolve;
use caustica::low_level::pack::PackedScene;
use caustica::low_level::pilots::prepare;
use caustica::low_level::plan::features::{Feature, Features};
use caustica::low_level::plan::{Buffer, Kernel, Plan};
use caustica::low_level::scene::settings::RenderSettings;
use caustica::low_level::scene::{self, Scene};
use caustica::low_level::shapes::ray::Ray;
use caustica::low_level::shapes::table::NONE;
use caustica::low_level::tables;
use glam::Vec3;
use rayon::prelude::*;

/// A device to measure on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum On {
    Cpu,
    Software,
}

/// A device, and whether to use large samples.
pub struct Bench {
    pub on: On,
    pub long: bool,
    driver: OnceCell<Driver>,
}

/// The software driver with its compiled kernels, by their text.
struct Driver {
    gpu: Gpu,
    programs: RefCell<HashMap<String, Rc<Program>>>,
}

/// A hit of a ray.
#[derive(Clone, Copy, Debug)]
pub struct Found {
    /// Distance, in scene units.
    pub t: f32,
    /// The primitive, or [`NONE`].
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

/// Parses the scene `text`; its files are relative to [`folder`].
pub fn parse(text: &str) -> Scene {
    match scene::parse(&folder().join("scene.toml"), text.as_bytes()) {
        Ok(loaded) => loaded.scene,
        Err(errors) => panic!("{errors:?}\n{text}"),
    }
}

/// The errors of the scene `text`.
pub fn parse_errors(text: &str) -> Vec<String> {
    let errors = scene::parse(&folder().join("scene.toml"), text.as_bytes()).err();
    errors.into_iter().flat_map(|e| e.errors).map(|e| e.message().to_owned()).collect()
}

/// A folder for generated files.
pub fn folder() -> PathBuf {
    let folder = std::env::temp_dir().join("caustica-stability");
    std::fs::create_dir_all(&folder).expect("a temporary folder");
    folder
}

impl Driver {
    fn program(&self, kernel: Kernel, features: &Features, shader: Shader) -> Rc<Program> {
        let known = self.programs.borrow().get(&shader.source).cloned();
        known.unwrap_or_else(|| {
            let source = shader.source.clone();
            let program = Program::of_shader(&self.gpu, kernel, features, shader)
                .expect("a kernel that compiles");
            let program = Rc::new(program);
            self.programs.borrow_mut().insert(source, program.clone());
            program
        })
    }
}

impl Bench {
    pub fn new(on: On, long: bool) -> Self {
        Self { on, long, driver: OnceCell::new() }
    }

    fn driver(&self) -> &Driver {
        self.driver.get_or_init(|| Driver {
            gpu: Gpu::open(&AdapterChoice::Software).expect("the software driver"),
            programs: RefCell::default(),
        })
    }

    /// Returns `few` in tests and `many` for the table.
    pub fn samples(&self, few: u32, many: u32) -> u32 {
        if self.long { many } else { few }
    }

    pub fn packed(&self, text: &str) -> PackedScene {
        let scene = parse(text);
        prepare(&scene, scene.film.width, scene.film.height).expect("a scene that packs")
    }

    /// The picture after `settings.passes` passes.
    pub fn render(&self, text: &str, settings: &RenderSettings) -> Picture {
        self.render_packed(self.packed(text), settings)
    }

    pub fn render_packed(&self, packed: PackedScene, settings: &RenderSettings) -> Picture {
        let plan = Plan::probed(&packed, settings);
        let mut engine: Box<dyn Engine> = match self.on {
            On::Cpu => Box::new(CpuEngine::new(packed, plan)),
            On::Software => Box::new(
                GpuEngine::new(&AdapterChoice::Software, &packed, plan)
                    .expect("the software driver"),
            ),
        };
        for _ in 0..settings.passes {
            engine.pass().expect("a pass");
        }
        engine.picture().expect("a picture")
    }

    /// The nearest hits of rays.
    pub fn trace(&self, scene: &tables::SceneTables, rays: &[Ray]) -> Vec<Found> {
        match self.on {
            On::Cpu => rays.par_iter().map(|ray| trace(scene, ray)).collect(),
            On::Software => trace_on_driver(self.driver(), scene, rays),
        }
    }

    /// Folds passes into one pixel whose one visible point gathers the same in all of them:
    /// `resolve` under the local rule.
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
        let gpu = &self.driver().gpu;
        let mut recorder = Recorder::new(gpu).expect("a recorder");
        let features = Features::default().with(Feature::Local);
        let shader =
            compose(Kernel::Resolve, &features, &SceneLayout::default()).expect("composed");
        let program = self.driver().program(Kernel::Resolve, &features, shader);
        let upload = |buffer: Buffer, bytes: &[u8]| {
            (buffer, gpu.upload(buffer.name(), bytes).expect("a buffer"))
        };
        let buffers = [
            upload(Buffer::VisiblePoints, bytemuck::bytes_of(&point)),
            upload(Buffer::Gathered, bytemuck::bytes_of(&gathered)),
            upload(Buffer::Statistics, bytemuck::bytes_of(&statistics)),
            upload(Buffer::Film, bytemuck::bytes_of(&film)),
        ];
        let find =
            |which: Buffer| buffers.iter().find(|(buffer, _)| *buffer == which).map(|(_, b)| b);
        let group = program.bind(gpu, &recorder.dispatches, find).expect("bound");
        for d in passes {
            if recorder.is_full() {
                recorder.finish(gpu).expect("done");
            }
            recorder.dispatch(gpu, &program, &group, &Dispatch { first: 0, end: 1, ..*d });
        }
        recorder.finish(gpu).expect("done");
        let read = |i: usize, bytes| gpu.read(&buffers[i].1, bytes).expect("read");
        let stats: Vec<Statistics> = pod_collect_to_vec(&read(2, size_of::<Statistics>() as u64));
        let pixels: Vec<FilmPixel> = pod_collect_to_vec(&read(3, size_of::<FilmPixel>() as u64));
        (stats[0], pixels[0])
    }
}

impl Bench {
    /// The sums that points gather from records in the grid of `dispatch`.
    pub fn gather(
        &self,
        dispatch: &Dispatch,
        points: &[VisiblePoint],
        records: &[PhotonRecord],
    ) -> Vec<Gathered> {
        let mut sum = vec![Gathered::zeroed(); points.len()];
        let d = Dispatch { first: 0, end: points.len() as u32, eye_samples: 1, ..*dispatch };
        let mut left = vec![records];
        while let Some(records) = left.pop() {
            let (starts, coded, sorted) = binned(&d, records);
            if self.on == On::Cpu {
                for (point, gathered) in points.iter().zip(&mut sum) {
                    gather(&[], &[], &d, point, d.scale_sq, &starts, &sorted, gathered);
                }
            } else if !gather_on_driver(self.driver(), &d, points, &starts, &coded, &mut sum) {
                // like the engine, split into smaller batches if the driver stops a loop
                let (first, second) = records.split_at(records.len() / 2);
                left.extend([second, first]);
            }
        }
        sum
    }
}

/// The start of each bucket, and the records in order as the driver and as the CPU read them.
fn binned(d: &Dispatch, records: &[PhotonRecord]) -> (Vec<u32>, Vec<PhotonRecord>, SortedRecords) {
    let coded = |record: &PhotonRecord| PhotonRecord { key: record_code(d, record), ..*record };
    let mut ordered = records.to_vec();
    ordered.sort_by_key(|record| record_bucket(d, record));
    let (starts, sorted) = build_grid(d, records.to_vec());
    (starts, ordered.iter().map(coded).collect(), sorted)
}

/// Returns false, and adds nothing, if the driver stopped a loop.
fn gather_on_driver(
    driver: &Driver,
    d: &Dispatch,
    points: &[VisiblePoint],
    starts: &[u32],
    sorted: &[PhotonRecord],
    sum: &mut [Gathered],
) -> bool {
    let gpu = &driver.gpu;
    let mut recorder = Recorder::new(gpu).expect("a recorder");
    let shader =
        compose(Kernel::Gather, &Features::default(), &SceneLayout::default()).expect("composed");
    let program = driver.program(Kernel::Gather, &Features::default(), shader);
    let upload = |buffer: Buffer, bytes: &[u8]| {
        (buffer, gpu.upload(buffer.name(), bytes).expect("a buffer"))
    };
    let buffers = [
        upload(Buffer::VisiblePoints, cast_slice(points)),
        upload(Buffer::Counters, &[0; 32]),
        upload(Buffer::Starts, cast_slice(starts)),
        upload(Buffer::Sorted, cast_slice(sorted)),
        upload(Buffer::Gathered, cast_slice(sum)),
    ];
    let find = |which: Buffer| buffers.iter().find(|(buffer, _)| *buffer == which).map(|(_, b)| b);
    let group = program.bind(gpu, &recorder.dispatches, find).expect("bound");
    recorder.dispatch(gpu, &program, &group, d);
    recorder.finish(gpu).expect("done");
    let counters: Vec<u32> = pod_collect_to_vec(&gpu.read(&buffers[1].1, 16).expect("read"));
    if counters[3] > 0 {
        return false;
    }
    let bytes = gpu.read(&buffers[4].1, size_of_val(sum) as u64).expect("read");
    sum.copy_from_slice(&pod_collect_to_vec::<u8, Gathered>(&bytes));
    true
}

fn trace(scene: &tables::SceneTables, ray: &Ray) -> Found {
    let hit = intersect_scene(scene, ray);
    let mut found = Found {
        t: hit.t,
        reference: hit.reference,
        position: Vec3::ZERO,
        error: 0.0,
        normal: Vec3::ZERO,
    };
    if found.is_hit() {
        let s = surface_at(scene, ray, &hit);
        found = Found { position: s.position, error: s.error, normal: s.normal, ..found };
    }
    found
}

fn trace_on_driver(driver: &Driver, scene: &tables::SceneTables, rays: &[Ray]) -> Vec<Found> {
    let gpu = &driver.gpu;
    let mut recorder = Recorder::new(gpu).expect("a recorder");
    let features = Features::of(scene, &RenderSettings::default());
    let tables = SceneLayout::new(scene);
    let kernel = Kernel::EyeTrace;
    let swapped = |f: &Fragment| match f.path {
        "kernels/eye_trace.wgsl" => Fragment { text: include_str!("trace.wgsl"), ..*f },
        _ => *f,
    };
    let fragments: Vec<Fragment> = fragments().iter().map(swapped).collect();
    let shader = compose_from(&fragments, kernel, &features, &tables).expect("composed");
    let program = driver.program(kernel, &features, shader);
    let given = |ray: &Ray| VisiblePoint {
        position: ray.origin,
        radius: ray.t_min,
        weight: ray.direction,
        alpha: ray.t_max,
        ..VisiblePoint::zeroed()
    };
    let mut out = Vec::new();
    // a binding holds 128 MiB
    for rays in rays.chunks(1 << 20) {
        let points: Vec<VisiblePoint> = rays.iter().map(given).collect();
        let mut buffers = vec![
            (Buffer::Scene, gpu.upload("scene", &tables.bytes).expect("a buffer")),
            (
                Buffer::VisiblePoints,
                gpu.upload("visible_points", cast_slice(&points)).expect("a buffer"),
            ),
            (Buffer::Counters, gpu.storage("counters", 32).expect("a buffer")),
        ];
        for (buffer, content) in long_tables(scene) {
            if !content.is_empty() {
                buffers.push((buffer, gpu.upload(buffer.name(), content).expect("a buffer")));
            }
        }
        let find =
            |which: Buffer| buffers.iter().find(|(buffer, _)| *buffer == which).map(|(_, b)| b);
        let group = program.bind(gpu, &recorder.dispatches, find).expect("bound");
        let end = rays.len() as u32;
        recorder.dispatch(gpu, &program, &group, &Dispatch { first: 0, end, ..Dispatch::zeroed() });
        recorder.finish(gpu).expect("done");
        let bytes =
            gpu.read(&buffers[1].1, (rays.len() * size_of::<VisiblePoint>()) as u64).expect("read");
        let answers: Vec<VisiblePoint> = pod_collect_to_vec(&bytes);
        // like the engine, trace again the rays that the driver stopped
        out.extend(rays.iter().zip(&answers).map(|(ray, a)| match a.state {
            0 => Found {
                t: a.radius,
                reference: a.normal,
                position: a.position,
                error: a.radiance.z,
                normal: a.weight,
            },
            _ => trace(scene, ray),
        }));
    }
    out
}
