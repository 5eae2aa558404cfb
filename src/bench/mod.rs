//! Benchmark of a device with a scene: kernel times and rates, compile times, memory, cost of
//! splitting submissions, and time to error. All devices report the same figures.
//!
//! [`setup`] creates an engine, [`device_report`] runs passes on it, [`work`] counts their
//! operations, [`to_error`] compares a render with a reference, [`spread`] summarizes repeated
//! measurements, and [`machine`] describes the host.

pub mod ablation;
pub mod machine;
pub mod setup;
pub mod spread;
pub mod to_error;
pub mod work;

use std::collections::BTreeMap;
use std::time::{Duration, Instant};

use serde::Serialize;

use crate::device::{DeviceError, DeviceInfo, DeviceKind};
use crate::engine::{EngineError, PassReport};
use crate::gpu::program::Compiling;
use crate::plan::Plan;
use crate::scene::Scene;
use crate::scene::settings::{Method, RenderSettings};
use setup::{Ready, SetupSeconds};
use spread::Spread;
use to_error::Approach;
use work::Work;

/// Parameters of a benchmark.
#[derive(Clone, Debug, PartialEq)]
pub struct Conduct {
    /// Number of warm-up passes; at least one.
    pub warm_up: u32,
    /// Number of measured rounds: a pass with timed kernels, and a regular pass for each slice.
    pub passes: u32,
    /// Time limit; no round starts after it.
    pub time: Option<Duration>,
    /// Target times of a GPU submission in seconds, infinite for no splitting; 50 ms if empty. The
    /// main figures use the first. The CPU engine renders as many passes, so that passes are the
    /// same on all devices.
    pub slices: Vec<f64>,
}

/// Benchmark figures of a device for one scene.
#[derive(Clone, Debug, Serialize)]
pub struct DeviceReport {
    /// Device name.
    pub name: String,
    /// Device kind, as a value of `--device`.
    pub kind: &'static str,
    /// Graphics API, driver and version; for the CPU, the number of threads.
    pub driver: String,
    /// Effective settings, with "auto" radii resolved.
    pub settings: RenderSettings,
    /// Source of the kernel times.
    pub clock: &'static str,
    /// Number of warm-up passes.
    pub warm_up: u32,
    /// Seconds of the setup steps.
    pub setup: SetupSeconds,
    /// Seconds to compile each kernel, one after another; empty on the CPU.
    pub compile: BTreeMap<&'static str, Compile>,
    /// Seconds of the first pass, which is not part of other figures.
    pub first_pass: f64,
    /// Seconds per pass.
    pub pass: Spread,
    /// Rates of a pass by wall-clock time.
    pub rates: BTreeMap<&'static str, f64>,
    /// Seconds per pass with timed kernels.
    pub timed_pass: Spread,
    /// Seconds per timed pass outside of kernels.
    pub rest: Spread,
    /// Figures of each kernel, by name.
    pub kernels: BTreeMap<&'static str, KernelReport>,
    /// Operations of the last timed pass; the number of gathered photons is the median over all
    /// timed passes.
    pub work: Work,
    /// Figures for each slice; empty on the CPU.
    pub slices: Vec<SliceReport>,
    /// Memory use.
    pub memory: Memory,
    /// Convergence to the reference, if there is one.
    pub to_error: Vec<Approach>,
}

/// Seconds to prepare a kernel.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Compile {
    /// Composition and validation of the shader, until it is passed to the driver.
    pub checking: f64,
    /// Time in the driver, until the kernel has run with no work items.
    pub driver: f64,
}

/// Figures of one kernel.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct KernelReport {
    /// Seconds per pass.
    pub seconds: Spread,
    /// Fraction of the time of all kernels, computed from the medians.
    pub share: f64,
    /// Operations per second, computed from the median.
    pub rates: BTreeMap<&'static str, f64>,
}

/// Figures for one target time of submissions.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SliceReport {
    /// Target time of a submission in seconds; `None` for no splitting.
    pub slice: Option<f64>,
    /// Seconds per pass.
    pub pass: Spread,
    /// Mean number of submissions per pass.
    pub submissions: f64,
    /// Seconds of the longest submission.
    pub longest: f64,
    /// Kernels in the longest submission.
    pub longest_kernels: Vec<&'static str>,
    /// Relative increase of the median time over that of unsplit passes; `None` if those were not
    /// measured.
    pub loss: Option<f64>,
}

/// Memory use in bytes.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Memory {
    /// Size of each buffer except those of the scene, summed over all chunks.
    pub buffers: BTreeMap<&'static str, u64>,
    /// Bytes per pixel of the buffers that grow with the image.
    pub per_pixel: f64,
    /// Bytes per photon of a batch of the buffers that grow with the photons.
    pub per_photon: f64,
    /// Bytes of the same buffers per photon record that fits.
    pub per_record: f64,
    /// Peak resident memory of the process from before the setup until after the passes, if known.
    pub peak_resident: Option<u64>,
}

/// Benchmarks a device. For convergence to a reference, see [`to_error::approach`]. `stop` is
/// called after each round; if it returns true, the report covers the rounds so far.
pub fn device_report(
    device: &DeviceInfo,
    scene: &Scene,
    settings: &RenderSettings,
    conduct: &Conduct,
    stop: &dyn Fn() -> bool,
) -> Result<DeviceReport, DeviceError> {
    machine::forget_peak();
    let mut ready = setup::ready(device, scene, settings, Compiling::OneByOne)?;
    let run = run(&mut ready, conduct, stop)?;
    let peak_resident = machine::peak_resident_bytes();
    let work = Work::of(&ready.plan, &run.report, run.gathered);
    let pass = run.slices.first().map(|slice| slice.pass).unwrap_or_default();
    Ok(DeviceReport {
        name: device.name.clone(),
        kind: device.kind.word(),
        driver: device.driver.clone(),
        settings: ready.plan.settings.clone(),
        clock: match ready.runner.gpu() {
            None => "around each kernel",
            Some(gpu) if gpu.has_clock() => "timestamp queries",
            Some(_) => "waiting for each kernel",
        },
        warm_up: conduct.warm_up,
        setup: ready.seconds,
        compile: match ready.runner.gpu() {
            None => BTreeMap::new(),
            Some(gpu) => gpu
                .compile_seconds()
                .iter()
                .map(|(kernel, c)| {
                    (kernel.stem(), Compile { checking: c.checking, driver: c.driver })
                })
                .collect(),
        },
        first_pass: run.first_pass,
        pass,
        rates: pass_rates(&work, pass.median),
        timed_pass: Spread::of(&run.timed),
        rest: Spread::of(&run.rest),
        kernels: kernel_reports(&run.kernels, &work, &ready.plan, ready.runner.gpu().is_some()),
        work,
        slices: if ready.runner.gpu().is_some() { run.slices } else { Vec::new() },
        memory: Memory { peak_resident, ..memory(&ready) },
        to_error: Vec::new(),
    })
}

/// Measurements of the passes.
struct Run {
    first_pass: f64,
    kernels: BTreeMap<&'static str, Vec<f64>>,
    timed: Vec<f64>,
    rest: Vec<f64>,
    slices: Vec<SliceReport>,
    /// Report of the last timed pass.
    report: PassReport,
    /// Median number of photons gathered in a timed pass.
    gathered: u64,
}

fn run(ready: &mut Ready, conduct: &Conduct, stop: &dyn Fn() -> bool) -> Result<Run, EngineError> {
    let runner = &mut ready.runner;
    let slices = match conduct.slices.as_slice() {
        [] => &[crate::gpu::pace::SLICE],
        slices => slices,
    };
    let cpu = runner.gpu().is_none();
    let mut first_pass = 0.0;
    for pass in 0..conduct.warm_up.max(1) {
        set_slice(runner, slices[0]);
        let begun = Instant::now();
        runner.engine().pass()?;
        if pass == 0 {
            first_pass = begun.elapsed().as_secs_f64();
        }
    }
    let begun = Instant::now();
    let mut kernels: BTreeMap<&'static str, Vec<f64>> = BTreeMap::new();
    let (mut timed, mut rest, mut gathered) = (Vec::new(), Vec::new(), Vec::new());
    let mut plain: Vec<(Vec<f64>, u64, crate::gpu::Submissions)> =
        vec![Default::default(); slices.len()];
    let mut last = PassReport::default();
    for round in 0..conduct.passes.max(1) {
        if round > 0 && (stop() || conduct.time.is_some_and(|time| begun.elapsed() >= time)) {
            break;
        }
        set_slice(runner, slices[0]);
        let start = Instant::now();
        let (report, seconds) = runner.engine().timed_pass()?;
        let whole = start.elapsed().as_secs_f64();
        timed.push(whole);
        rest.push((whole - seconds.values().sum::<f64>()).max(0.0));
        // the CPU engine scans and sorts in a single step
        let skipped = |kernel: &str| {
            cpu && ["grid_scan_reduce", "grid_scan_sums", "grid_sort_long"].contains(&kernel)
        };
        for (kernel, seconds) in seconds.into_iter().filter(|(kernel, _)| !skipped(kernel)) {
            kernels.entry(kernel).or_default().push(seconds);
        }
        last = report;
        gathered.push(runner.engine().gathered()?);
        for (slice, (passes, count, longest)) in slices.iter().zip(&mut plain) {
            set_slice(runner, *slice);
            runner.gpu().map(|gpu| gpu.take_submissions());
            let start = Instant::now();
            runner.engine().pass()?;
            passes.push(start.elapsed().as_secs_f64());
            if let Some(made) = runner.gpu().map(|gpu| gpu.take_submissions()) {
                *count += made.count;
                if made.longest_seconds > longest.longest_seconds {
                    *longest = made;
                }
            }
        }
    }
    let unsplit = slices.iter().position(|slice| slice.is_infinite());
    let whole = unsplit.map(|at| Spread::of(&plain[at].0).median);
    let report =
        |(slice, (passes, count, longest)): (&f64, &(Vec<f64>, u64, crate::gpu::Submissions))| {
            let pass = Spread::of(passes);
            SliceReport {
                slice: slice.is_finite().then_some(*slice),
                submissions: *count as f64 / passes.len() as f64,
                longest: longest.longest_seconds,
                longest_kernels: longest.longest.iter().map(|kernel| kernel.stem()).collect(),
                loss: whole.map(|whole| pass.median / whole - 1.0),
                pass,
            }
        };
    let slices = slices.iter().zip(&plain).map(report).collect();
    gathered.sort_unstable();
    let gathered = gathered[gathered.len() / 2];
    Ok(Run { first_pass, kernels, timed, rest, slices, report: last, gathered })
}

fn set_slice(runner: &mut setup::Runner, seconds: f64) {
    if let Some(gpu) = runner.gpu() {
        gpu.set_slice(seconds);
    }
}

fn pass_rates(work: &Work, seconds: f64) -> BTreeMap<&'static str, f64> {
    let per_second = |count: u64| count as f64 / seconds.max(1e-9);
    BTreeMap::from([
        ("passes_per_second", per_second(1)),
        ("rays_per_second", per_second(work.eye_rays + work.photon_rays)),
        ("photons_per_second", per_second(work.photons)),
        ("eye_paths_per_second", per_second(work.eye_paths)),
        ("paths_per_second", per_second(work.photons + work.eye_paths)),
    ])
}

fn kernel_reports(
    kernels: &BTreeMap<&'static str, Vec<f64>>,
    work: &Work,
    plan: &Plan,
    gpu: bool,
) -> BTreeMap<&'static str, KernelReport> {
    let spreads: BTreeMap<_, _> =
        kernels.iter().map(|(name, seconds)| (*name, Spread::of(seconds))).collect();
    let all: f64 = spreads.values().map(|spread| spread.median).sum();
    let report = |(name, seconds): (&&'static str, &Spread)| {
        let counts = work.counts(plan, name, gpu).into_iter();
        let rates = counts.map(|(rate, count)| (rate, count / seconds.median.max(1e-9))).collect();
        let share = seconds.median / all.max(1e-12);
        (*name, KernelReport { seconds: *seconds, share, rates })
    };
    spreads.iter().map(report).collect()
}

/// Buffers that grow with the image. Each chunk has separate ones.
const OF_THE_PICTURE: [&str; 4] = ["visible_points", "gathered", "film", "statistics"];

fn memory(ready: &Ready) -> Memory {
    let plan = &ready.plan;
    // path tracing uses only the film
    let path = plan.settings.method == Method::Path;
    let largest = f64::from(plan.chunk(0).1);
    let chunks = f64::from(plan.pixels) * f64::from(plan.eye_samples) / largest;
    let (mut picture, mut photons) = (0.0, 0.0);
    let mut buffers = BTreeMap::new();
    for &(name, bytes) in ready.buffers.iter().filter(|(name, _)| !path || *name == "film") {
        let of_the_picture = OF_THE_PICTURE.contains(&name);
        let all = if of_the_picture { bytes as f64 * chunks } else { bytes as f64 };
        *(if of_the_picture { &mut picture } else { &mut photons }) += all;
        buffers.insert(name, all.round() as u64);
    }
    Memory {
        buffers,
        per_pixel: picture / f64::from(plan.pixels),
        per_photon: photons / f64::from(plan.batch_photons.max(1)),
        per_record: photons / f64::from(plan.capacity.max(1)),
        peak_resident: None,
    }
}

/// Returns true if a device supports the method.
pub fn can_run(device: &DeviceInfo, settings: &RenderSettings) -> bool {
    settings.method != Method::Path
        || matches!(device.kind, DeviceKind::Cpu | DeviceKind::CpuDouble)
}
