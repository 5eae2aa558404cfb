//! `caustica info --measure`: time saved by omitting features that a scene does not need.

use caustica::low_level::bench::ablation::{
    Costs, on_cpu, on_gpu, unused, with_all_unused, with_unused,
};
use caustica::low_level::device::{self, DeviceKind};
use caustica::low_level::gpu::AdapterChoice;
use caustica::low_level::pack::PackedScene;
use caustica::low_level::plan::Kernel;
use caustica::low_level::plan::features::Features;
use caustica::low_level::scene::settings::{Method, RenderSettings};
use serde_json::{Map, Value, json};

use super::output::{message, result};
use super::{Done, Failure, hidden};

/// Number of passes; the fastest one counts.
const PASSES: u32 = 5;
/// Kernels whose code depends on the scene.
const KERNELS: [Kernel; 3] = [Kernel::EyeTrace, Kernel::PhotonTrace, Kernel::Gather];

/// Prints a table, or one JSON object per row: the scene as it is, with each unused feature added,
/// and with all of them.
pub fn on_device(
    wanted: &str,
    packed: &PackedScene,
    settings: &RenderSettings,
    json: bool,
) -> Result<Done, Failure> {
    let devices = device::list();
    let wanted = device::parse(wanted);
    let (device, _) = device::pick(&wanted, &devices)?;
    hidden::warn(&wanted);
    if settings.method == Method::Path || device.kind == DeviceKind::CpuDouble {
        return Err(Failure::wrong_use(
            "nothing to measure: path tracing and the f64 engine are not specialized for scenes",
            "measure sppm or ppm on gpu, software or cpu",
        ));
    }
    // a single disc: an added feature may add photons that need a second disc, which changes the
    // rounding of sums
    let settings = &RenderSettings { indirect_radius: Some(1.0), ..settings.clone() };
    let cost = |packed: PackedScene| match device.kind {
        DeviceKind::Cpu => on_cpu(packed, settings, PASSES),
        _ => on_gpu(&AdapterChoice::Named(device.name.clone()), &packed, settings, PASSES),
    };
    if device.kind == DeviceKind::Software
        && std::env::var_os("MESA_SHADER_CACHE_DISABLE").is_none()
    {
        message(
            "warning: Mesa caches compiled shaders; set MESA_SHADER_CACHE_DISABLE=true for true \
             compile times",
        );
    }
    let features = Features::of(&packed.tables, settings);
    let with = |scene| {
        let mut other = packed.clone();
        other.tables = scene;
        other
    };
    let tell = |added: &str, costs: &Costs, plain: &Costs| match json {
        true => result(as_json(&device.name, added, costs, plain)),
        false => result(line(added, costs, plain)),
    };
    if !json {
        result(format_args!("\non {}, fastest of {PASSES} passes:", device.name))?;
        result(heading(device.kind))?;
    }
    let plain = cost(packed.clone())?;
    tell("as it is", &plain, &plain)?;
    for feature in unused(features) {
        let Some(scene) = with_unused(&packed.tables, feature) else { continue };
        tell(&format!("+ {}", feature.name()), &cost(with(scene))?, &plain)?;
    }
    let all = cost(with(with_all_unused(&packed.tables, features)))?;
    tell("+ all of these", &all, &plain)?;
    Ok(Done::Fully)
}

/// Row of the table as JSON; times in seconds, for all kernels of the fastest pass together, and
/// for each kernel whose code depends on the scene.
fn as_json(device: &str, added: &str, costs: &Costs, plain: &Costs) -> Value {
    let kernels = costs.kernels.iter().map(|(name, cost)| {
        (name.to_string(), json!({ "compile_seconds": cost.compile, "seconds": cost.run }))
    });
    json!({
        "event": "measured",
        "device": device,
        "added": added,
        "pass_seconds": costs.pass,
        "kernels": kernels.collect::<Map<_, _>>(),
        "same_bits": costs.picture == plain.picture,
    })
}

fn heading(kind: DeviceKind) -> String {
    let mut line = format!("{:<18}", "");
    if kind != DeviceKind::Cpu {
        for kernel in KERNELS {
            line += &format!("{:>25}", kernel.stem());
        }
    }
    line += &format!("{:>12}", "all kernels");
    if kind != DeviceKind::Cpu {
        line += &format!("{:>12}", "compiling");
    }
    line + &format!("{:>12}", "same bits")
}

/// Row of the table: compile and run times in ms, per kernel and for all kernels.
fn line(name: &str, costs: &Costs, plain: &Costs) -> String {
    let ms = |seconds: f64| format!("{:.1} ms", 1000.0 * seconds);
    let mut line = format!("{name:<18}");
    for kernel in KERNELS.iter().filter_map(|kernel| costs.kernels.get(kernel.stem())) {
        line += &format!("{:>13} {:>11}", format!("c {}", ms(kernel.compile)), ms(kernel.run));
    }
    line += &format!("{:>12}", ms(costs.pass));
    if !costs.kernels.is_empty() {
        line += &format!("{:>12}", ms(costs.kernels.values().map(|cost| cost.compile).sum()));
    }
    let same = if costs.picture == plain.picture { "yes" } else { "no" };
    line + &format!("{same:>12}")
}
